"""Pictures of scores."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

import babyrobot_levels as brl

NAMES = ["frozen-lake", "first-key"]


def test_a_picture_has_a_bar_for_each_level(tmp_path: Path) -> None:
    scores = brl.score(NAMES, "random")
    svg = scores.to_svg(tmp_path / "scores.svg")
    assert (tmp_path / "scores.svg").read_text(encoding="utf-8") == svg
    assert all(f">{text}</text>" in svg for text in [*NAMES, "random 0", "optimum 1", "0.00"])
    assert scores.to_png(tmp_path / "scores.png").startswith(b"\x89PNG")
    assert (tmp_path / "scores.png").exists()
    bundle = scores._repr_mimebundle_()
    assert bundle["image/svg+xml"].startswith("<svg")
    assert bundle["text/plain"] == repr(scores)


def score_of(share: float, half: float = 0.0) -> brl.LevelScore:
    return brl.LevelScore(
        level=f"level {share}", digest="", expected_return=share, optimum=1.0, random=0.0,
        share=share, regret=1 - share, success=0.0, steps=1.0, within=None, discount=1.0,
        episodes=int(half > 0), low=share - half, high=share + half,
    )  # fmt: skip


def test_bars_are_as_long_as_the_shares() -> None:
    from babyrobot_levels.render.scene.shapes import Path as Line
    from babyrobot_levels.render.scene.shapes import Rect

    shares = [0.5, 1.0, -0.25, -7.0, math.nan]
    scene = brl.Scores([score_of(share) for share in shares])._scene()
    bars = [shape for shape in scene.shapes[1:] if isinstance(shape, Rect)]
    lines = [shape for shape in scene.shapes if isinstance(shape, Line)]
    zero, one = (line.commands[0][1][0] for line in lines)
    assert [bar.width / (one - zero) for bar in bars] == pytest.approx([0.5, 1.0, 0.25, 1.0])
    assert [bar.x for bar in bars[:2]] == [zero, zero]
    assert [bar.x + bar.width for bar in bars[2:]] == pytest.approx([zero, zero])


def test_intervals_are_drawn() -> None:
    exact, estimated = score_of(0.5), score_of(0.5, half=0.1)
    assert exact.share_interval == (0.5, 0.5)
    assert estimated.share_interval == pytest.approx((0.4, 0.6))
    pictures = [brl.Scores([each]).to_svg() for each in (exact, estimated)]
    assert pictures[0].count("<path") + 3 == pictures[1].count("<path")


def test_the_picture_of_one_level_tells_its_returns_and_shows_a_share_of_zero() -> None:
    svg = brl.score("frozen-lake", "random").to_svg()
    assert "Return 0.01134; optimum 0.7442, random 0.01134" in svg
    assert 'width="4"' in svg  # the bar


def test_of_many_levels_the_lowest_are_shown() -> None:
    svg = brl.Scores([score_of(number / 200) for number in range(150)]).to_svg()
    assert "the lowest 100 of 150 levels" in svg
    assert "level 0.0<" in svg
    assert "level 0.7<" not in svg
