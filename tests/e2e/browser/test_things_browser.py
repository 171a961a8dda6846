"""Levels with things in a real browser: they are played as the environment plays them."""

from __future__ import annotations

import copy
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from itertools import compress
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import expect
from support.codes import played
from support.combinations import swept
from support.playground import KEYS, Playground, guide
from support.vault import vault

from babyrobot_levels.analysis.guides import guide_of
from babyrobot_levels.library.catalogue import load
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.actions import Turn
from babyrobot_levels.render.page import link_fragment, page_data

VAULT = vault()
LOOKING = vault(heading="S")
TURN_KEYS = {Turn.LEFT: "ArrowLeft", Turn.RIGHT: "ArrowRight", Turn.FORWARD: "ArrowUp"}
MINUS = "\N{MINUS SIGN}"


def held(ground: Playground) -> list[str]:
    """Return what is held, and which switches are on, as the page tells it."""
    return ground.page.locator("#held dd:not(.none)").all_inner_texts()


def corners(ground: Playground, place: str) -> list[list[int]]:
    """Return the columns and rows of the cells in which elements are: of doors the left one."""
    found: list[list[int]] = ground.page.evaluate(
        """(place) => {
          const svg = document.querySelector("#stage svg").getBoundingClientRect();
          const size = svg.width / document.querySelector("#stage svg").viewBox.baseVal.width;
          return [...document.querySelectorAll(place)].map((element) => {
            const box = element.getBoundingClientRect();
            return [(box.left + box.right) / 2 - svg.left, (box.top + box.bottom) / 2 - svg.top]
              .map((middle) => Math.floor((middle / size - 4) / 64));
          });
        }""",
        place,
    )
    return found


# -- episodes ----------------------------------------------------------------------------------


def test_a_seed_and_the_same_actions_give_the_environments_episodes(ground: Playground) -> None:
    seed, env = 2**40 + 7, VAULT.make(observation="index", actions="all")
    ground.open(VAULT, seed=seed)
    state, info = env.reset(seed=seed)
    assert ground.state == state
    chosen = np.random.default_rng(3)
    hits, most, total = 0, 0, 0.0
    for _ in range(90):
        # More often to the east and to the south, so that something happens.
        action = int(chosen.choice([0, 1, 2, 2, 3, 3, 4]))
        state, reward, terminated, _, info = env.step(action)
        ground.press(KEYS[action])
        total += float(reward)
        assert ground.state == state
        assert ground.number("return") == pytest.approx(total, abs=0.006)
        assert ("Hit by the" in ground.message) == info["hit"] == (ground.kind == "hit")
        names = [*compress(env.unwrapped.item_names, info["held"])]  # type: ignore[attr-defined]
        assert [name for name in held(ground) if name != "lever"] == names
        hits, most = hits + info["hit"], max(most, len(names))
        if terminated:
            total, seed = 0.0, seed + 1
            state, info = env.reset(seed=seed)
            ground.press("n")
            assert ground.state == state
    assert hits > 0
    assert most > 0


def test_a_robot_that_turns_has_the_environments_episodes_too(ground: Playground) -> None:
    env = LOOKING.make(observation="index", actions="turns")
    mdp = LOOKING.compile().turning("S")
    ground.open(LOOKING, turns=True, seed=8)
    seed = 8
    state, _ = env.reset(seed=seed)
    chosen = np.random.default_rng(5)
    for _ in range(60):
        action = int(chosen.choice([0, 1, 2, 2, 2]))
        state, _, terminated, _, _ = env.step(action)
        ground.press(TURN_KEYS[Turn(action)])
        assert ground.page.evaluate("() => [game.state, game.number]") == [
            mdp.configuration(state) * mdp.cells + state % mdp.cells,
            state,
        ]
        if terminated:
            seed += 1
            state, _ = env.reset(seed=seed)
            ground.press("n")
    # Keys without a meaning for this robot do nothing.
    steps = ground.number("steps")
    ground.press("ArrowDown", " ", "s")
    assert ground.number("steps") == steps


@pytest.mark.parametrize("actions", swept(["turns"], ["all"]))
def test_the_optimal_policy_has_the_environments_episode(actions: str, ground: Playground) -> None:
    best = replace(guide(LOOKING), turning=guide(LOOKING, "turns"))
    known = best if actions == "all" else best.turning
    assert known is not None
    env = LOOKING.make(observation="index", actions=actions)
    state, _ = env.reset(seed=4)
    steps, total, is_over = 0, 0.0, False
    while not is_over:
        state, reward, is_over, _, info = env.step(known.policy[state])
        steps, total = steps + 1, total + float(reward)
    ground.open(LOOKING, guide=best, seed=4, turns=actions == "turns")
    ground.press("p")
    expect(ground.page.locator("#watch")).to_have_attribute("aria-pressed", "false")
    assert (ground.number("steps"), ground.number("return")) == (steps, total)
    assert ground.kind == ("hit" if info["hit"] else "exit")


# -- what is told and shown --------------------------------------------------------------------

HALL = Level.from_fields(
    {
        "version": 1,
        "size": [4, 2],
        "exit": [3, 0],
        "exit_needs": ["key", "lever"],
        "items": [{"name": "key", "at": [1, 0], "reward": 3}],
        "doors": [{"at": [2, 0], "side": "E", "needs": "key", "unless": "lever"}],
        "switches": [{"name": "lever", "at": [0, 1]}],
        "movers": [{"name": "guard", "path": [[2, 1], [3, 1]], "back": True}],
        "display": {"robot": {"speed": 100}},
    }
)


def test_what_happens_to_things_is_told_and_shown(ground: Playground) -> None:
    ground.open(HALL)
    assert ground.message == "Move the robot to the exit."
    assert held(ground) == []
    pictures = [corners(ground, f"#things > g:nth-child({number})") for number in (3, 4)]
    assert pictures == [[[1, 0]], [[2, 0]]]
    assert corners(ground, "#movers > g") == [[2, 1]]
    door = ground.page.locator("#things > g:nth-child(4)")
    closed = door.inner_html()
    ground.press("d")
    assert ground.message == "Moved east to [1, 0]: +3. Took the key. The door east of [2, 0] opens"
    assert held(ground) == ["key"]
    ground.wait_until_still()
    assert ground.page.locator("#things > g:nth-child(3) use").count() == 0
    assert door.inner_html() != closed
    assert corners(ground, "#movers > g") == [[3, 1]]
    ground.press("s", "a")
    assert ground.message == (
        f"Moved west to [0, 1]: {MINUS}1. The lever is on. The door east of [2, 0] closes. "
        "The exit is open"
    )
    assert sorted(held(ground)) == ["key", "lever"]


def test_a_closed_door_is_not_a_wall(ground: Playground) -> None:
    ground.open(HALL)
    ground.page.evaluate("() => { game.state = 2 }")
    ground.press("d")
    assert ground.message == f"Blocked by the closed door to the east: {MINUS}1"
    assert ground.kind == "bump"


def test_a_mover_glides_beside_the_robot_and_makes_room_for_it(ground: Playground) -> None:
    ground.open(HALL.replace(hit={"ends": False}))
    size = "() => document.querySelector('#movers use').getBoundingClientRect().width"
    alone = ground.page.evaluate(size)
    # It meets the robot in [2, 1]: there and back again takes two steps.
    ground.press("s", "d", "d", " ")
    assert "Hit by the guard" in ground.message
    ground.wait_until_still()
    assert ground.page.evaluate(size) < 0.8 * alone


def test_values_are_those_of_the_configuration_at_hand(ground: Playground) -> None:
    best = guide(HALL)
    ground.open(HALL, guide=best, values=True)
    shown = ground.page.locator("#values text")

    def texts(configuration: int) -> list[str]:
        rows = best.overlay.at(configuration).values
        assert rows is not None
        numbers = [value for row in rows for value in row if value is not None]
        return [f"{value:.2f}".rstrip("0").rstrip(".").replace("-", MINUS) for value in numbers]

    first = ground.state // 8
    assert sorted(shown.all_text_contents()) == sorted(texts(first))
    ground.press("d")
    ground.wait_until_still()
    second = ground.state // 8
    assert second != first
    assert sorted(shown.all_text_contents()) == sorted(texts(second))
    # Hidden values follow when they are shown again.
    ground.press("v", "s")
    ground.wait_until_still()
    ground.press("v")
    assert sorted(shown.all_text_contents()) == sorted(texts(ground.state // 8))


def test_answers_are_shown_for_what_is_chosen_to_be_held(ground: Playground) -> None:
    level = load("first-key")
    ground.open(level, guide=guide_of(level))
    sets, hatched = ground.page.locator("#sets"), ground.page.locator("#never path")
    nothing, key = (sets.get_by_role("radio", name=name) for name in ("Nothing", "key"))
    expect(sets).to_be_hidden()
    expect(hatched.first).to_be_hidden()
    ground.press("v")
    expect(nothing).to_be_checked()
    expect(sets).to_contain_text("Hatched: cannot occur with nothing held.")
    # Behind the door, and where the key lies.
    expect(hatched).to_have_count(7)
    nothing.focus()
    ground.press("ArrowRight")
    expect(key).to_be_checked()
    expect(hatched).to_have_count(0)
    assert "Hatched" not in sets.inner_text()
    assert ground.number("steps") == 0
    # The next step shows what is held now, and whoever points at a set goes on playing.
    sets.get_by_text("Nothing").click()
    ground.press("ArrowUp")
    assert ground.number("steps") == 1
    sets.get_by_text("key").click()
    ground.press("ArrowLeft", "ArrowLeft")
    expect(key).to_be_checked()
    ground.press("z")
    expect(nothing).to_be_checked()
    expect(hatched).to_have_count(7)
    assert ground.faults == []


def test_turning_is_switched_on_and_off(ground: Playground) -> None:
    best = replace(guide(LOOKING), turning=guide(LOOKING, "turns"))
    ground.open(LOOKING, guide=best)
    switch = ground.page.get_by_role("button", name="The robot turns")
    expect(switch).to_have_attribute("aria-pressed", "false")
    returns = [ground.page.locator("#best").inner_text()]
    ground.press("t")
    expect(switch).to_have_attribute("aria-pressed", "true")
    returns.append(ground.page.locator("#best").inner_text())
    assert returns[0] != returns[1]
    expect(ground.page.get_by_role("button", name="Optimal actions")).to_be_hidden()
    expect(ground.page.get_by_role("button", name="South")).to_be_hidden()
    ground.page.get_by_role("button", name="Turn left").click()
    assert ground.message.startswith("Turned left")
    ground.page.get_by_role("button", name="Forward").click()
    assert ground.message.startswith("Moved east to [1, 0]")
    switch.click()
    assert ground.number("steps") == 0
    ground.press("s")
    assert ground.message.startswith("Moved south to [0, 1]")


def test_a_robot_without_a_policy_for_turning_can_turn(ground: Playground) -> None:
    ground.open(LOOKING, guide=guide(LOOKING))
    expect(ground.page.locator("#watch")).to_be_visible()
    ground.press("t")
    for name in ("#watch", "#show-values", "#show-policy"):
        expect(ground.page.locator(name)).to_be_hidden()
    ground.press("p", "v", "ArrowLeft")
    assert ground.message.startswith("Turned left")
    ground.press("t")
    expect(ground.page.locator("#watch")).to_be_visible()


# -- links -------------------------------------------------------------------------------------


def test_a_link_shows_things_and_forgets_them_again(ground: Playground) -> None:
    plain = Level.from_fields({"version": 1, "size": [4, 3], "title": "Plain"})
    ground.open(plain)
    expect(ground.page.locator("#held")).to_be_hidden()
    ground.follow(link_fragment(LOOKING, LOOKING))
    expect(ground.page.locator("#notice")).to_be_hidden()
    assert ground.page.title() == "The vault"
    expect(ground.page.locator("#held")).to_be_visible()
    expect(ground.page.locator("#turning")).to_be_visible()
    ground.press("d", "d", "d")
    assert held(ground) == ["coin"]
    ground.page.evaluate("() => { location.hash = '' }")
    expect(ground.page.locator("h1")).to_have_text("Plain")
    expect(ground.page.locator("#held")).to_be_hidden()
    expect(ground.page.locator("#turning")).to_be_hidden()


@cache
def page_of_vault() -> Any:
    """Return the data of a page, which takes seconds: tests that need it ask for it."""
    return page_data(LOOKING, guide=replace(guide(LOOKING), turning=guide(LOOKING, "turns")))


def thing_of(data: Any, name: str) -> int:
    """Return the number of a thing."""
    return [thing["name"] for thing in data["things"]].index(name)


def field(value: Any, *route: Any) -> Callable[[Any], None]:
    def put(data: Any) -> None:
        inner = data
        for key in route[:-1]:
            inner = inner[thing_of(data, key) if inner is data["things"] else key]
        inner[route[-1]] = value

    return put


HOSTILE: dict[str, Callable[[Any], object]] = {
    "things that are none": field({}, "things"),
    "a thing of another kind": field("script", "things", "lever", "kind"),
    "a name that is none": field(["x"], "things", "key", "name"),
    "fewer configurations": lambda data: data["things"][0]["values"].pop(),
    "more configurations than there are states": lambda data: [
        thing["values"].extend([0] * 200_000) for thing in data["things"]
    ],
    "values above the last": field(2, "things", "key", "values", 0),
    "phases above the last": field(4, "things", "guard", "values", 0),
    "places of movers off the grid": field([35], "things", "guard", "cells", 0),
    "places of items off the grid": field([35], "things", "coin", "cells", 0),
    "fewer places than values": lambda data: data["things"][thing_of(data, "key")]["cells"].pop(),
    "looks that are not there": field([10**6], "things", "key", "looks", 0),
    "movers without a look": field([], "things", "guard", "looks", 0),
    "labels that are not there": field(10**6, "things", "bat", "label"),
    "icons that are texts": field(["0", 0, 0, 1], "things", "key", "icon"),
    "exits off the grid": field([35], "things", "exit", "exits", 0),
    "needs that are none": field([{}], "things", "exit", "needs"),
    "looks that are no shapes": field([[0, 0, [[9, 0, 0]]]], "picture", "looks", 0),
    "marks that are not there": field(10**6, "marks", "values", 0),
    "marks of fewer states": lambda data: data["marks"]["policy"].pop(),
    "hits by a third mover": lambda data: data["rows"][0].__setitem__(4, 18),
    "a heading that is none": field(4, "turns", "heading"),
    "a policy of turns too short": lambda data: data["turns"]["policy"].pop(),
}


@pytest.mark.sweep
def test_what_are_no_things_is_not_shown(ground: Playground) -> None:
    ground.open(Level.from_fields({"version": 1, "size": [4, 3], "title": "Plain"}))
    # Otherwise the page would pass that shows nothing.
    whole = page_of_vault()
    ground.follow(played(whole))
    expect(ground.page.locator("#notice")).to_be_hidden()
    assert ground.page.title() == "The vault"
    for name, spoil in HOSTILE.items():
        data = copy.deepcopy(whole)
        spoil(data)
        assert data != whole, name
        ground.follow(played(data))
        notice = ground.page.locator("#notice")
        expect(notice, name).to_contain_text("its content is not a level")
        assert ground.page.title() == "Plain", name
