"""Several robots on a page: two sets of keys, the optimum as a partner, and valid plays."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.combinations import swept
from support.playground import FAST, Playground

import babyrobot_levels as brl
from babyrobot_levels.agents.verify import verify_play
from babyrobot_levels.analysis.guides import guide_of
from babyrobot_levels.render.page import link_fragment

LETTERS, ARROWS = " wdsa", [" ", "ArrowUp", "ArrowRight", "ArrowDown", "ArrowLeft"]

TEAM: dict[str, Any] = {
    "version": 1,
    "size": [3, 3],
    "robots": [{"name": "red", "start": [0, 0]}, {"name": "blue", "start": [0, 2]}],
    "exit": [2, 1],
    "puddles": [{"at": [1, 1], "size": "large"}],
    "items": [{"name": "key", "at": [1, 0]}],
    "movers": [{"name": "guard", "path": [[2, 2], [2, 1], [2, 0]], "back": True}],
    "rewards": {"meet": -2},
    "hit": {"reward": -3},
    "max_steps": 12,
    "display": FAST,
}


def downloaded(ground: Playground, folder: Path) -> brl.Play:
    with ground.page.expect_download() as download:
        ground.page.get_by_role("button", name="Download").click()
    download.value.save_as(folder / "page.brlplay")
    return brl.read_plays(folder / "page.brlplay")[-1]


@pytest.mark.parametrize("arrived", swept(["stay"], ["leave"]))
def test_two_players_on_one_keyboard(ground: Playground, tmp_path: Path, arrived: str) -> None:
    level = brl.load({**TEAM, "team": {"arrived": arrived}})
    random, states = np.random.default_rng(3), set()
    ground.open(level, guide=guide_of(level, brl.solve(level)))
    for episode in range(6):
        while ground.page.locator("#result").is_hidden():
            red, blue = random.integers(5, size=2)
            if red and not blue:
                # The space bar is everybody's: it counts for who is asked.
                ground.press(LETTERS[red], " ")
            else:
                ground.press(*(ARROWS[blue], LETTERS[red])[:: 1 if blue else -1])
            if ground.page.locator("#message").inner_text().endswith("?"):
                states.add(ground.state)
            ground.wait_until_still()
        play = downloaded(ground, tmp_path)
        assert (play.seed, verify_play(play).fault) == (str(episode), None)
        ground.press("n")
    assert len(states) > 5
    assert ground.faults == []


def test_the_optimum_is_a_partner(ground: Playground, tmp_path: Path) -> None:
    level = brl.load("two-pads")
    level = level.replace(display={**level.display.model_dump(), "robot": {"speed": 100}})
    solution = brl.solve(level)
    ground.open(level, guide=guide_of(level, solution))
    ground.page.locator("#hands").get_by_text("blue").click()
    env = level.make(observation="index")
    state, _ = env.reset(seed=0)
    is_over = False
    while not is_over:
        actions = level.compile().robot_actions(solution.policy.ravel()[state])
        ground.page.locator("#stage").focus()
        ground.press(ARROWS[actions[0]])
        state, _, terminated, truncated, _ = env.step(actions)
        is_over = terminated or truncated
        ground.wait_until_still()
    assert ground.page.locator("#result-title").inner_text() == "Best possible!"
    assert verify_play(downloaded(ground, tmp_path)).regret == 0.0
    # Undo, hint and looking around speak of each robot.
    ground.press("z", "h")
    assert ground.message == "Hint: blue moves east."
    ground.press("r", "h")
    assert ground.message == "Hint: red moves east, blue moves east."
    ground.press("l")
    assert ground.message.startswith("Red is at [")
    assert ground.faults == []


def test_a_tap_moves_the_robot_that_is_asked(ground: Playground) -> None:
    ground.open(brl.load(TEAM))
    stage = ground.page.locator("#stage svg")
    box = stage.bounding_box()
    assert box is not None
    side = box["width"] / 3
    for x, y in ((1, 0), (1, 2)):
        ground.page.mouse.click(
            box["x"] + side * (x + 0.5), box["y"] + box["height"] / 3 * (y + 0.5)
        )
    assert ground.number("steps") == 1
    assert ground.message.startswith("Red moved east, Blue moved east")


def test_a_link_to_several_robots_is_refused_by_a_page_of_one(ground: Playground) -> None:
    team = brl.load("two-pads")
    ground.open(brl.load("final-maze"))
    ground.follow(link_fragment(team, team))
    notice = ground.page.locator("#notice").inner_text()
    assert notice.startswith("This link is to a level with several robots")
    ground.open(team)
    ground.follow(link_fragment(team, team))
    assert ground.page.locator("#notice").is_hidden()
    assert ground.faults == []
