"""Levels on a page that are played through a sight: what the page knows, and what it hides."""

from __future__ import annotations

import json
import re
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.sessions import environment, run_here

import babyrobot_levels as brl
from babyrobot_levels.extensions.sight.page import page_sight

FOGGY: Any = {"sight": "view", "view_radius": 1}


def worth(name: str, data: dict[str, Any], steps: int) -> float:
    """Return what the agent of a page earns in a level within some steps, by its graph alone."""
    level = brl.load(name)
    mdp = level.compile()

    def following(pairs: list[int], state: int) -> int:
        return dict(zip(pairs[::2], pairs[1::2], strict=True))[data["shown"][state]]

    @cache
    def value(state: int, node: int, left: int) -> float:
        action, *after = data["nodes"][node]
        assert action >= 0, "all beliefs are explored"
        total = 0.0
        for chance, to, reward, is_over in zip(
            *(table[state, action].tolist() for table in (mdp.probability, mdp.next_state)),
            mdp.reward[state, action].tolist(),
            mdp.terminal[state, action].tolist(),
            strict=True,
        ):
            if chance and (is_over or left == 1):
                total += chance * reward
            elif chance:
                ahead = value(to, following(after[action], to), left - 1)
                total += chance * (reward + level.discount * ahead)
        return total

    starts = np.flatnonzero(mdp.start).tolist()
    chances = [float(mdp.start[start]) for start in starts]
    roots = [following(data["roots"], start) for start in starts]
    return sum(
        chance * value(start, root, steps)
        for chance, start, root in zip(chances, starts, roots, strict=True)
    )


@pytest.mark.slow
@pytest.mark.parametrize("name", ["shell-game", "three-gems", "red-blue-doors"])
def test_the_agent_of_a_page_earns_the_optimum_of_the_sight(name: str) -> None:
    found = brl.solve(name, **FOGGY)
    assert found.is_exact
    data = page_sight(brl.load(name), **FOGGY).data
    assert worth(name, data, 200) == pytest.approx(found.lower)


@pytest.mark.slow
def test_cells_are_seen_as_the_view_shows_them() -> None:
    level = brl.load("shell-game")
    data = page_sight(level, "view", view_radius=2).data
    env: Any = level.make(observation="view", view_radius=2)
    view, _ = env.reset(seed=0)
    number = data["field"][env.unwrapped.state]
    steps = np.array(data["fields"][number]).reshape(-1, 2)
    wanted = np.argwhere(view[..., 0] == 1)[:, ::-1] - 2
    assert {*map(tuple, steps.tolist())} == {*map(tuple, wanted.tolist())}
    assert page_sight(level, "position").data["fields"] == [[0, 0]]
    assert "fields" not in page_sight(level, "planes").data


def data_of(page: str) -> dict[str, Any]:
    match = re.search(r'<script type="application/json" id="data">(.*?)</script>', page, re.DOTALL)
    assert match is not None
    data: dict[str, Any] = json.loads(match[1])
    return data


@pytest.mark.slow
def test_a_page_with_a_sight_knows_nothing_of_who_sees_everything() -> None:
    data = data_of(brl.load("shell-game").to_html(**FOGGY))
    assert (data["walker"], data["policy"], data["alt"]) == ("sight", None, "")
    assert data["best"] == "\N{MINUS SIGN}6 without a limit"
    assert not {"returns", "marks"} & {*data}


def test_without_answers_the_best_agent_is_not_in_the_page() -> None:
    data = data_of(brl.load("shell-game").to_html(answers=False, **FOGGY))
    assert (data["walker"], data["best"]) == (None, "")
    assert {*data["sight"]} == {"shown", "field", "fields"}


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"view_radius": 1}, "view_radius is for a sight"),
        ({"sight": "view", "values": True}, "values is of one who sees everything"),
        ({"sight": "view", "policy": "random"}, "policy is of one who sees everything"),
        ({"sight": "text-view"}, "what environments show, such as 'view'"),
        ({"sight": "vew"}, "did you mean `view`"),
    ],
)
def test_what_does_not_go_together_is_refused(options: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        brl.load("shell-game").to_html(**options)


def test_a_level_with_very_many_states_is_refused() -> None:
    with pytest.raises(ValueError, match="22,500 states is too large for a page with a sight"):
        page_sight(brl.load({"version": 1, "size": [150, 150]}), "position")
    with pytest.raises(brl.LevelError, match="only for levels with one"):
        page_sight(brl.load("two-pads"))


@pytest.mark.slow
def test_the_command_makes_such_a_page(here: Path) -> None:
    command = ["preview", "shell-game", "--sight", "view", "--view-radius", "1", "-o", "fog.html"]
    assert run_here(command, environment(here)).status == 0
    assert "sight" in data_of(Path("fog.html").read_text("utf-8"))
    for wrong, told in (
        (["--view-radius", "1", "-o", "a.html"], "--view-radius is for --sight"),
        (["--sight", "view", "-o", "a.png"], "--sight is for"),
        (["--sight", "view", "--values", "-o", "a.html"], "values is of one who sees everything"),
    ):
        done = run_here(["preview", "shell-game", *wrong], environment(here))
        assert (done.status, told in done.err) == (2, True), done.err
