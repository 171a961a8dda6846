"""Agents from files, and pictures of scores."""

from __future__ import annotations

import io
import json
import math
import pickle
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.sessions import environment, run_here

import babyrobot_levels as brl
from babyrobot_levels.agents.agents import AgentError, load_model, load_policy

NAMES = ["frozen-lake", "first-key"]


class Bomb:
    """What no reader may unpickle."""

    def __reduce__(self) -> tuple[Any, ...]:
        return Path("ran").touch, ()


def header(shape: str) -> bytes:
    """Return a `.npy` file that has nothing but its header."""
    text = f"{{'descr': '<i8', 'fortran_order': False, 'shape': {shape}}}".ljust(117) + "\n"
    return b"\x93NUMPY\1\0" + len(text).to_bytes(2, "little") + text.encode()


def zipped(data: bytes) -> bytes:
    """Return a `.npz` file of one array."""
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("maze.npy", data)
    return stream.getvalue()


def test_policies_come_back(tmp_path: Path) -> None:
    policies: dict[str, Any] = {name: brl.solve(name).policy for name in NAMES}
    np.save(tmp_path / "one.npy", policies["frozen-lake"])
    np.savez(tmp_path / "all.npz", **policies)
    lists = {name: policy.tolist() for name, policy in policies.items()}
    (tmp_path / "all.json").write_text(json.dumps(lists))
    (tmp_path / "one.json").write_text(json.dumps(lists["frozen-lake"]))
    expected = brl.score(NAMES, policies)
    for name in ("all.npz", "all.json"):
        assert [*brl.score(NAMES, load_policy(tmp_path / name))] == [*expected]
    for name in ("one.npy", "one.json"):
        assert brl.score(NAMES[0], load_policy(tmp_path / name))[0] == expected[0]


def test_the_output_of_solve_is_a_policy(tmp_path: Path) -> None:
    arguments = ["solve", "frozen-lake", "--within", "max_steps", "--format", "json"]
    (tmp_path / "solved.json").write_text(run_here(arguments, environment(tmp_path)).out)
    policy = load_policy(tmp_path / "solved.json")
    policies = brl.solve("frozen-lake", within="max_steps").policies
    assert policies is not None
    assert np.array_equal(policy, policies)


@pytest.mark.parametrize(
    ("name", "data"),
    [
        ("bomb.npy", None),
        ("bomb.npz", pickle.dumps(Bomb())),
        ("empty.npy", b""),
        ("text.json", b"hello"),
        ("deep.json", b"[" * 100_000),
        ("ragged.json", b"[[1, 2], [3]]"),
        ("words.json", b'[["north"]]'),
        ("number.json", b'{"policy": "best"}'),
        ("zip.npz", b"PK\3\4 and no more"),
        ("claims.npy", header("(100000000000,)")),
        ("claims.npz", zipped(header("(100000, 100000, 100000)"))),
        ("damaged.npz", zipped(np.arange(999).tobytes()).replace(b"\3", b"\4")),
        ("brackets.npy", header("(((")),
    ],
)
def test_what_is_no_policy_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str, data: bytes | None
) -> None:
    monkeypatch.chdir(tmp_path)
    if data is None:
        np.save(name, np.array([Bomb()], object), allow_pickle=True)
    else:
        Path(name).write_bytes(data)
    with pytest.raises(AgentError, match="policy"):
        load_policy(Path(name))
    assert not Path("ran").exists()


def test_models_say_of_which_class_they_are(tmp_path: Path) -> None:
    path = tmp_path / "model.zip"
    for head in (None, b"hello", b"{}", b'{"policy_class": {"__module__": "os"}}'):
        with zipfile.ZipFile(path, "w") as archive:
            archive.writestr("data" if head else "other", head or b"")
        with pytest.raises(AgentError, match="is not a model of Stable-Baselines3 or sb3-contrib"):
            load_model(path)


def test_a_model_is_not_loaded_without_trust(tmp_path: Path) -> None:
    with zipfile.ZipFile(tmp_path / "model.zip", "w") as archive:
        archive.writestr("data", b'{"policy_class": {"__module__": "os"}}')
    model = str(tmp_path / "model.zip")
    result = run_here(["score", model, "maze"], environment(tmp_path))
    assert result.status == 2
    assert "loading a model can run any code" in result.err
    trusted = run_here(["score", model, "maze", "--trust"], environment(tmp_path))
    assert "is not a model" in trusted.err


@pytest.mark.libraries
@pytest.mark.parametrize("name", ["PPO", "A2C", "DQN", "MaskablePPO", "QRDQN"])
def test_models_come_back(tmp_path: Path, name: str) -> None:
    import sb3_contrib
    import stable_baselines3

    library = stable_baselines3 if hasattr(stable_baselines3, name) else sb3_contrib
    model = getattr(library, name)("MlpPolicy", brl.load("frozen-lake").make(), seed=3)
    model.save(tmp_path / "model.zip")
    loaded = load_model(tmp_path / "model.zip")
    assert [*brl.score("frozen-lake", loaded)] == [*brl.score("frozen-lake", model)]


# -- pictures --------------------------------------------------------------------------------


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
