"""Rewards that floating point cannot add up: whoever adds them says so in one sentence."""

from __future__ import annotations

from pathlib import Path

import pytest
from support.sessions import babyrobot

import babyrobot_levels as brl

SENTENCE = "rewards of up to 1e+308 are too large to add up; use at most 1e+140"

LEVEL = "version: 1\nsize: [9, 9]\nskid: 0.5\nrewards: {step: -1e308, exit: 1e308}\n"


@pytest.fixture
def level(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("level.yaml").write_text(LEVEL, "utf-8")


@pytest.mark.parametrize(
    "command",
    [
        "solve level.yaml",
        "solve level.yaml --within 9",
        "score best level.yaml",
        "score random level.yaml",
        "preview level.yaml --values",
        "share level.yaml --link https://example.org/page.html",
        "sheet level.yaml --key -o sheet.pdf",
    ],
)
@pytest.mark.usefixtures("level")
def test_commands_that_solve_a_level_end_with_a_sentence(command: str) -> None:
    result = babyrobot(*command.split())
    assert result.status != 0
    assert result.err.startswith(f"error: {SENTENCE}\n")


@pytest.mark.usefixtures("level")
def test_show_and_lint_go_on() -> None:
    shown = babyrobot("show", "level.yaml", status=0).out
    assert f"best_return:   none: {SENTENCE}\n" in shown
    assert f"level.yaml:4:10: warning BR504: {SENTENCE}\n" in babyrobot("lint", "level.yaml").out


@pytest.mark.parametrize(
    "fields",
    [
        {"areas": [{"at": [1, 1], "reward": 1e308}]},
        {"areas": [{"at": [1, 1], "reward": -1e308, "skid": 0.5}], "rewards": {"step": 1e308}},
        {"rewards": {"closer": -1e308, "farther": 1e308}},
    ],
)
def test_also_rewards_of_other_fields(fields: dict[str, object]) -> None:
    level = brl.load({"version": 1, "size": [4, 4], **fields})
    with pytest.raises(brl.EpisodeTooLongError, match="are too large to add up"):
        brl.solve(level)
    with pytest.raises(brl.EpisodeTooLongError, match="are too large to add up"):
        brl.evaluate(level, "random")
    assert level.to_svg()


def test_the_largest_rewards_are_added_up() -> None:
    level = brl.load(
        {"version": 1, "size": [3, 1], "skid": 0.5, "rewards": {"step": -1e140, "exit": 1e140}}
    )
    assert -1e142 < brl.solve(level).expected_return < 1e140
    assert brl.return_distribution(level, "best").standard_deviation < 1e142
