"""Pages write episodes as files, which the tables verify."""

from __future__ import annotations

import zlib
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Page
from support.playground import KEYS, Playground

import babyrobot_levels as brl
from babyrobot_levels.agents.verify import verify_play
from babyrobot_levels.analysis.guides import guide_of
from babyrobot_levels.render.page import link_fragment, to_html

TURN_KEYS = ["ArrowLeft", "ArrowRight", "ArrowUp"]


def downloaded(page: Page, folder: Path) -> brl.Play:
    """Return the play of the page's button."""
    with page.expect_download() as download:
        page.get_by_role("button", name="Download").click()
    assert download.value.suggested_filename.endswith(".brlplay")
    path = folder / "page.brlplay"
    download.value.save_as(path)
    (play,) = brl.read_plays(path)
    return play


def walk(ground: Playground, level: brl.Level, actions: str, keys: list[str]) -> int:
    """Play an episode of seed 0 by an optimal policy; return the number of steps."""
    solution = brl.solve(level, actions=actions)
    env = level.make(actions=actions, observation="index")
    state, _ = env.reset(seed=0)
    is_over, steps = False, 0
    while not is_over:
        action = int(solution.policy.ravel()[state])
        ground.press(keys[action])
        state, _, terminated, truncated, _ = env.step(action)
        is_over, steps = terminated or truncated, steps + 1
    env.close()
    return steps


@pytest.mark.parametrize(
    ("name", "actions"),
    [
        ("final-maze", "all"),
        ("frozen-lake", "all"),
        ("first-key", "turns"),
        ("treasure-chests", "all"),
    ],
)
def test_a_play_of_a_page_is_valid(
    ground: Playground, tmp_path: Path, name: str, actions: str
) -> None:
    level = brl.load(name)
    level = level.replace(display={**level.display.model_dump(), "robot": {"speed": 100}})
    ground.open(level, turns=actions == "turns")
    steps = walk(ground, level, actions, TURN_KEYS if actions == "turns" else KEYS)
    play = downloaded(ground.page, tmp_path)
    assert (play.name, play.action_set, play.steps) == (level.name, actions, steps)
    assert (play.seed, play.seed_kind, play.start) == ("0", "page", "drawn")
    assert verify_play(play).fault is None
    path = tmp_path / "env.brlplay"
    env = brl.RecordPlay(play.level.make(actions=actions), path)
    env.reset(seed=int(play.seed or 0))
    for action in play.actions:
        env.step(action)
    env.close()
    (same,) = brl.read_plays(path)
    told = {"states", "actions", "rewards", "return_", "end", "digest", "discount", "max_steps"}
    assert play.model_dump(include=told) == same.model_dump(include=told)


def test_a_watched_policy_is_told(ground: Playground, tmp_path: Path) -> None:
    level = brl.load("maze")
    level = level.replace(display={**level.display.model_dump(), "robot": {"speed": 100}})
    ground.page.goto("about:blank")
    level.to_html(tmp_path / "page.html")
    ground.page.goto((tmp_path / "page.html").as_uri())
    ground.page.wait_for_selector("body.ready")
    ground.press("p")
    ground.page.wait_for_selector("#result:not([hidden])")
    play = downloaded(ground.page, tmp_path)
    assert (play.watched, play.hints) == (play.steps, 0)
    assert verify_play(play).is_valid
    assert f"{play.steps} watched steps" in ground.page.locator("#result-facts").inner_text()


@pytest.mark.parametrize(
    ("name", "changes", "actions"),
    [
        ("frozen-lake", {}, "all"),
        ("final-maze", {"max_steps": None, "discount": 0.99}, "all"),
        ("puddle-test", {"max_steps": None, "heading": "E"}, "turns"),
        ("first-key", {"max_steps": 40}, "turns"),
        ("night-watch", {}, "all"),
    ],
)
def test_pages_grade_decisions_as_python_does(
    ground: Playground, tmp_path: Path, name: str, changes: Any, actions: str
) -> None:
    level = brl.load(name)
    display = {**level.display.model_dump(), "robot": {"speed": 100}}
    level = level.replace(display=display, **changes)
    turns = actions == "turns"
    ground.open(level, guide=guide_of(level, turns=turns), turns=turns)
    # Every other decision is a good one, so that episodes end.
    ground.page.evaluate(
        """() => {
          const random = new Generator("5");
          while (game.end === null && game.steps < 5000) {
            game.step(random.random() < 0.6 ? game.best : random.integer(3));
          }
          show("");
        }"""
    )
    play = downloaded(ground.page, tmp_path)
    verified = verify_play(play)
    told = ground.page.evaluate("() => decisionsOf(game)")
    assert verified.regret > 0
    assert told["cost"] == pytest.approx(verified.regret, rel=1e-9)
    assert told["luck"] == pytest.approx(verified.luck, rel=1e-9, abs=1e-9)
    optimum = brl.score(level, "random", actions=actions)[0].optimum
    assert told["optimum"] == pytest.approx(optimum)


LATE: Any = {"version": 1, "size": [3, 1], "max_steps": 3, "discount": 0.9}


def test_undone_steps_are_no_part_of_a_play(ground: Playground, tmp_path: Path) -> None:
    ground.open(brl.load(LATE))
    ground.press("ArrowUp", "ArrowDown", "z", "ArrowUp", "ArrowRight")
    play = downloaded(ground.page, tmp_path)
    assert (play.actions, play.undone, play.end) == ([1, 1, 2], 1, "truncated")
    assert play.return_ == pytest.approx(-1 - 0.9 - 0.81)
    assert verify_play(play).is_valid


def test_a_linked_level_has_plays_of_its_own(ground: Playground, tmp_path: Path) -> None:
    random = brl.load("random-maze").replace(max_steps=2)
    ground.open(brl.load("final-maze"))
    for level, played in ((brl.load(LATE),) * 2, (random, random.with_maze_seed(5))):
        ground.follow(link_fragment(level, played))
        ground.press("ArrowUp", "ArrowUp", "ArrowUp")
        play = downloaded(ground.page, tmp_path)
        assert play.digest == played.digest
        assert verify_play(play).fault is None


def test_a_page_stays_small() -> None:
    assert len(to_html(brl.load("final-maze")).encode()) < 200_000


def test_a_page_knows_who_plays_and_saves_all_episodes(ground: Playground, tmp_path: Path) -> None:
    page, level = ground.page, brl.load(LATE)
    (tmp_path / "page.html").write_text(level.to_html(), "utf-8")
    address = (tmp_path / "page.html").as_uri()
    page.goto(f"{address}?player=Ada%20%C3%89")
    page.wait_for_selector("body.ready")
    first = zlib.crc32("Ada É".encode())
    page.keyboard.press("ArrowUp")
    page.keyboard.press("ArrowUp")
    page.keyboard.press("ArrowUp")
    # What is undone and played to another end is one episode.
    for key in ("z", "ArrowRight", "n", "ArrowRight", "ArrowRight", "r", "ArrowUp"):
        page.keyboard.press(key)
    page.keyboard.press("ArrowRight")
    page.keyboard.press("ArrowRight")
    with page.expect_download() as download:
        page.get_by_role("button", name="Download 3 plays").click()
    assert download.value.suggested_filename == "Ada-É-Level.brlplay"
    download.value.save_as(tmp_path / "ada.brlplay")
    plays = brl.read_plays(tmp_path / "ada.brlplay")
    assert [play.actions for play in plays] == [[1, 1, 2], [2, 2], [1, 2, 2]]
    assert [play.seed for play in plays] == [str(first), str(first + 1), str(first + 1)]
    assert {play.player for play in plays} == {"Ada É"}
    assert all(verify_play(play).is_valid for play in plays)
    # The device keeps the name that one gives.
    page.get_by_label("Name").fill("Ben")
    page.get_by_label("Name").press("Tab")
    page.goto(address)
    page.wait_for_selector("body.ready")
    assert page.locator("#seed").input_value() == str(zlib.crc32(b"Ben"))
