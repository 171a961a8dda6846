"""A page as a game: undo, hints, the same luck and new luck, the trail, and how it ended."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any
from unittest.mock import ANY

import numpy as np
import pytest
from playwright.sync_api import Page, expect
from support.combinations import swept
from support.playground import FAST, KEYS, Playground, level

from babyrobot_levels.analysis.guides import guide_of
from babyrobot_levels.analysis.solver.optimum import solve
from babyrobot_levels.library.catalogue import load
from babyrobot_levels.library.level import Level
from babyrobot_levels.render.page import link_fragment, page_data
from babyrobot_levels.render.page_format import CHEER
from babyrobot_levels.render.scene.layout import CELL

MINUS = "\N{MINUS SIGN}"


def named(name: str) -> Level:
    return load(name).replace(display=FAST)


def play(ground: Playground, world: Level, **options: Any) -> None:
    ground.open(world, guide=guide_of(world), **options)


def shown(ground: Playground) -> tuple[Any, ...]:
    """Return all that the page shows of the state at hand."""
    ground.wait_until_still()
    told = [ground.page.locator(place).inner_html() for place in ("#things", "#movers", "#held")]
    trail = ground.page.locator("#walked").inner_html()
    return ground.state, ground.number("steps"), ground.number("return"), *told, trail


def card(ground: Playground) -> dict[str, str]:
    """Return what the card of the result tells."""
    names = ground.page.locator("#result-facts dt").all_inner_texts()
    return dict(zip(names, ground.page.locator("#result-facts dd").all_inner_texts(), strict=True))


def stars(ground: Playground) -> str | None:
    return ground.page.locator("#stars").get_attribute("aria-label")


# -- undo --------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", swept(["ice-vault"], ["frozen-lake"]))
def test_undo_goes_back_and_the_same_action_has_the_same_outcome(
    name: str, ground: Playground
) -> None:
    ground.open(named(name), seed=3)
    chosen = np.random.default_rng(2)
    for _ in range(12):
        before = shown(ground)
        key = KEYS[int(chosen.integers(5))]
        ground.press(key)
        after, message = shown(ground), ground.message
        ground.press("z")
        assert shown(ground) == before
        ground.press(key)
        assert (shown(ground), ground.message) == (after, message)
        if ground.page.locator("#result").is_visible():
            ground.press("n")


def test_a_diagonal_move_is_blocked_by_a_wall(ground: Playground) -> None:
    ground.open(level(size=[3, 3], moves=8))
    ground.press("7", "3")
    assert ground.number("steps") == 2
    assert ground.state == 4


def test_undo_goes_back_to_the_start_and_no_further(ground: Playground) -> None:
    ground.open(level(size=[4, 1]))
    first = shown(ground)
    ground.press("d", "a", "d", "z", "z", "z")
    assert shown(ground) == first
    ground.press("z")
    assert ground.message == "There is no action to undo."
    assert shown(ground) == first


def test_undo_takes_an_end_back_and_is_told(ground: Playground) -> None:
    ground.open(level(size=[3, 1], areas=[{"at": [0, 0], "ends": True}], start=[1, 0]))
    ground.press("a")
    expect(ground.page.locator("#result")).to_be_visible()
    ground.page.get_by_role("button", name="Undo").click()
    expect(ground.page.locator("#result")).to_be_hidden()
    assert ground.message == "Undone: back at [1, 0] after 0 steps."
    ground.press("d")
    assert card(ground)["Help"] == "1 undo"


# -- hints -------------------------------------------------------------------------------------


def test_hints_lead_to_the_exit_as_the_optimal_policy_does(ground: Playground) -> None:
    world = named("four-rooms")
    best = solve(world)
    policy = best.policy.ravel().tolist()
    play(ground, world)
    steps = 0
    while not ground.page.locator("#result").is_visible():
        action = policy[ground.state] + best.first_action
        ground.press("h")
        side = ["stay", "move north", "move east", "move south", "move west"][action]
        assert ground.message == f"Hint: {side}."
        expect(ground.page.locator("#hinted path")).to_be_visible()
        assert ground.page.locator(".hinted").get_attribute("data-action") == str(action)
        # Asking again in the same place counts once.
        ground.press("h", KEYS[action])
        assert ground.page.locator(".hinted, #hinted path").count() == 0
        steps += 1
    assert ground.number("steps") == steps
    assert card(ground)["Help"] == f"{steps} hints"
    # A return means the same everywhere: here it is discounted.
    assert card(ground)["Return"] == "0.25"
    expect(ground.page.locator("#best")).to_have_text("0.25 within 1,000 steps")
    assert ground.page.locator("#return-name").inner_text() == "Return, discount 0.9"
    assert stars(ground) == "3 of 3 stars"
    ground.press("h")
    assert ground.message == "There is no hint: the episode has ended."


def test_hints_are_for_a_robot_that_turns_too(ground: Playground) -> None:
    world = level(size=[3, 1], heading="N")
    play(ground, world, turns=True)
    ground.press("h")
    assert ground.message == "Hint: turn right."
    ground.press("d", "h")
    assert ground.message == "Hint: move forward."


# -- luck --------------------------------------------------------------------------------------


def test_the_same_luck_and_new_luck_are_seeds(ground: Playground) -> None:
    world = named("frozen-lake")
    env = world.make(observation="index", actions="all")
    ground.open(world, seed=7)

    def states() -> list[int]:
        states = [ground.state]
        for key in ["d", "s"] * 4:
            ground.press(key)
            states.append(ground.state)
        return states

    def wanted(seed: int) -> list[int]:
        states, is_over = [env.reset(seed=seed)[0]], False
        for action in [2, 3] * 4:
            if not is_over:
                state, _, terminated, truncated, _ = env.step(action)
                is_over = terminated or truncated
            states.append(state)
        return states

    seed = ground.page.locator("#seed")
    assert states() == wanted(7)
    ground.press("r")
    expect(seed).to_have_value("7")
    assert states() == wanted(7)
    ground.press("n")
    expect(seed).to_have_value("8")
    assert states() == wanted(8)
    assert wanted(8) != wanted(7)


# -- the result --------------------------------------------------------------------------------


@pytest.mark.sweep
def test_the_optimal_policy_has_all_stars_whatever_chance_does(ground: Playground) -> None:
    world = named("final-maze")
    best = solve(world, within="max_steps").expected_return
    play(ground, world)
    seen = set()
    for seed in range(4):
        if seed:
            ground.press("n")
        ground.press("p")
        expect(ground.page.locator("#watch")).to_have_attribute("aria-pressed", "false")
        told = card(ground)
        total = ground.number("return")
        luck = round(total - best, 2)
        assert told["Return"] == ground.page.locator("#return").inner_text()
        assert told["Decisions"] == "cost 0"
        assert told["Luck"] == f"{luck:+g}".replace("-", MINUS)
        # The robot has earned them, and not who watched.
        expect(ground.page.locator("#stars")).to_be_hidden()
        seen.add(total)
    assert len(seen) > 1


def test_without_chance_there_is_no_luck(ground: Playground) -> None:
    play(ground, level(size=[3, 1]))
    ground.press("d", "a", "d", "d")
    assert card(ground) == {"Return": f"{MINUS}3", "Decisions": "cost 2", "Luck": "0"}


def test_stars_are_given_as_the_card_says(ground: Playground) -> None:
    world = level(size=[3, 1], max_steps=20)
    guide = guide_of(world)
    assert guide.random_return is not None
    most = 0.1 * (guide.expected_return - guide.random_return)
    play(ground, world)
    for detours in range(3):
        ground.press("r", *["d", "a"] * detours, "d", "d")
        cost = 2 * detours
        assert stars(ground) == f"{3 if cost == 0 else 2 if cost <= most else 1} of 3 stars"
    # No star for waiting until the time is over.
    ground.press("r", *[" "] * 20)
    assert (ground.kind, stars(ground)) == ("time", "0 of 3 stars")
    ground.page.get_by_text("three for nothing wasted").click()
    expect(ground.page.locator("#result-help")).to_contain_text(
        "Luck does not count, only your decisions."
    )


def test_a_win_is_told_in_one_sentence(ground: Playground) -> None:
    play(ground, level(size=[3, 1]))
    title = ground.page.locator("#result-title")
    ground.press("d", "d")
    expect(title).to_have_text("Best possible!")
    assert ground.message == f"Exit reached after 2 steps! Return {MINUS}1."
    ground.press("r", "d", "a", "d", "d")
    expect(title).to_have_text("2 steps more than needed")
    play(ground, level(size=[3, 1], rewards={"step": -1, "exit": 5}, discount=0.5))
    ground.press("a", "d", "d")
    expect(title).to_have_text("1.75 more than needed")


def tap(ground: Playground, x: int, y: int) -> None:
    """Click the middle of a cell."""
    box = ground.page.locator("#stage > svg").bounding_box()
    assert box is not None
    data = json.loads(ground.page.locator("#data").inner_text())
    scale = box["width"] / data["picture"]["width"]
    at = (data["margin"] + CELL * (place + 0.5) for place in (x, y))
    left, top = (scale * each for each in at)
    ground.page.mouse.click(box["x"] + left, box["y"] + top)


def test_a_click_leads_along_a_free_way(ground: Playground) -> None:
    walls: Any = [{"at": [0, 0], "side": "E", "length": 2}]
    hole = {"at": [2, 2], "ends": True, "reward": -9}
    world = level(size=[4, 3], walls=walls, areas=[hole], exit=[3, 0], display=FAST)
    play(ground, world)
    tap(ground, 0, 0)
    assert ground.number("steps") == 0
    tap(ground, 3, 2)
    expect(ground.page.locator("#robot")).to_have_attribute("data-state", "11")
    # Round the wall, and not through the hole.
    assert ground.number("steps") == 7
    tap(ground, 3, 0)
    expect(ground.page.locator("#result-title")).to_contain_text("steps more than needed")


def test_nothing_is_walked_where_no_way_is_free(ground: Playground) -> None:
    key = {"items": [{"name": "key", "at": [0, 1]}]}
    doors = [{"at": [1, 0], "side": "E", "length": 2, "needs": "key"}]
    play(ground, level(size=[4, 2], exit=[3, 0], doors=doors, **key))
    tap(ground, 3, 1)
    assert ground.message == "There is no free way to [3, 1]."
    assert ground.number("steps") == 0
    tap(ground, 0, 1)
    assert "Took the key" in ground.message


def test_escape_stops_the_walk(ground: Playground) -> None:
    play(ground, level(size=[40, 1]))
    tap(ground, 38, 0)
    # It may have gone several steps already.
    expect(ground.page.locator("#steps")).to_have_text(re.compile(r"[1-9]"))
    ground.press("Escape")
    ground.wait_until_still()
    steps = ground.number("steps")
    assert 0 < steps < 38
    ground.page.wait_for_timeout(600)
    assert ground.number("steps") == steps


LAKE = {"areas": [{"label": "hole", "at": [2, 0], "ends": True, "reward": -9}], "start": [1, 0]}
NIGHT = {
    "movers": [{"name": "guard", "path": [[2, 0], [1, 0]], "back": True}],
    "hit": {"reward": -9},
}


@pytest.mark.parametrize(
    ("fields", "keys", "cause"),
    [
        (LAKE, "d", "Hole at [2, 0]"),
        (NIGHT, "d", "Hit by the guard"),
        ({"max_steps": 2}, "  ", "Time limit reached"),
        ({"start": [2, 0]}, "d", "Exit reached!"),
    ],
)
def test_what_ended_an_episode_is_told_until_the_next_one(
    fields: Any, keys: str, cause: str, ground: Playground
) -> None:
    ground.open(level(size=[4, 1], **fields))
    for more in range(3):
        ground.press(*keys if more == 0 else "d")
        expect(ground.page.locator("#result-title")).to_have_text(cause)
        assert cause.rstrip("!") in ground.message
    ground.press("r")
    expect(ground.page.locator("#result")).to_be_hidden()


@pytest.mark.parametrize(
    ("fields", "kind"),
    [
        ({"areas": [{"at": [1, 0], "ends": True, "reward": 5}]}, "good"),
        ({"areas": [{"at": [1, 0], "ends": True, "reward": -5}]}, "over"),
        ({"areas": [{"at": [1, 0], "ends": True, "reward": 0}]}, "over"),
        ({"exit": "none", "areas": [{"at": [1, 0], "ends": True, "reward": -1}]}, "good"),
        ({"exit": [1, 0]}, "exit"),
    ],
)
def test_an_end_is_good_or_bad_by_what_it_pays(fields: Any, kind: str, ground: Playground) -> None:
    ground.open(level(size=[3, 1], **fields))
    ground.press("d")
    ground.wait_until_still()
    assert ground.kind == kind
    cheers = ground.page.locator("#robot use").get_attribute("href") == f"#pose-{CHEER}-0"
    assert cheers == (kind != "over")


# -- sound -------------------------------------------------------------------------------------

HEARD = """() => {
  window.heard = [];
  window.OscillatorNode = class extends OscillatorNode {
    constructor(audio, options) { super(audio, options); heard.push(options.frequency); }
  };
}"""


def test_nothing_is_heard_until_sound_is_switched_on_which_is_remembered(
    ground: Playground,
) -> None:
    world = level(size=[3, 1])
    ground.open(world)
    ground.page.evaluate(HEARD)
    ground.press("a", "d")
    assert ground.page.evaluate("heard") == []
    ground.page.get_by_label("Sound", exact=True).check()
    ground.page.evaluate("heard.length = 0")
    ground.press("w", "d")
    bump, *rising = ground.page.evaluate("heard")
    assert bump < rising[0]
    assert rising == sorted(rising)
    ground.open(world)
    assert ground.page.get_by_label("Sound", exact=True).is_checked()


# -- the trail ---------------------------------------------------------------------------------


def test_the_trail_is_where_the_robot_was(ground: Playground) -> None:
    ground.open(level(size=[4, 2], warps=[{"at": [2, 0], "to": [3, 1]}]))
    walked, jumped = (ground.page.locator("#walked path").nth(each) for each in (0, 1))

    def lines() -> tuple[int, int]:
        ground.wait_until_still()
        found = [path.get_attribute("d") or "" for path in (walked, jumped)]
        return found[0].count("M"), found[1].count("M")

    assert lines() == (0, 0)
    ground.press("d", "w")
    assert lines() == (1, 0)
    ground.press("d")
    assert lines() == (1, 1)
    ground.press("z")
    assert lines() == (1, 0)
    expect(ground.page.locator("#walked")).to_have_css("display", "inline")
    ground.page.get_by_label("Trail").uncheck()
    expect(ground.page.locator("#walked")).to_have_css("display", "none")
    # The switch does not keep the keys.
    ground.press("d")
    assert ground.number("steps") == 3
    ground.press("r")
    assert lines() == (0, 0)


# -- without answers, and old links ------------------------------------------------------------


def test_a_page_without_answers_is_played_without_them(page: Page, tmp_path: Path) -> None:
    path = tmp_path / "homework.html"
    path.write_text(named("final-maze").to_html(answers=False), "utf-8")
    page.goto(path.as_uri())
    page.wait_for_selector("body.ready")
    for name in ("#watch", "#hint", "#show-values", "#show-policy", "#best"):
        expect(page.locator(name)).to_be_hidden()
    for key in ("h", "p", "v", "b", "d", "a", "z"):
        page.keyboard.press(key)
    assert page.locator("#steps").inner_text() == "1"
    assert page.locator("#values *, #policy *, #hinted *").count() == 0


def test_the_card_of_a_level_without_answers_tells_the_return(ground: Playground) -> None:
    ground.open(level(size=[2, 1]))
    ground.press("d", "h")
    assert card(ground) == {"Return": "0"}
    expect(ground.page.locator("#stars")).to_be_hidden()


OLD = {
    1: "brl1.39.evzwKUNNSbD04wRubyrB49sY7GMMd4KioTa2FgA~1.436.qpG299WZQU7GIBBGr9K4loQyw0zZehNoce"
    "UVvLsD4v8XpLW1xuiSBpikQ3nfS-8gfsp_NPZxXOgLib5jl2pLCM8xMHDExUV0PHstOTtoD9b5OfBsjY_eTeDZax"
    "tnszgdgSRbe7YIayrC6go-Q0VzkYpraWxA95mKpt7K3LaSmNAaMjVue5vfE-S0vgD5cepTNHGT5eC6XWLabE9XIS"
    "jfxVEGEuru1Voue9IlU-oy-i24wZ9D21WXHUj0RNE42OToalJkFIiYgjJOJU8VWwUlDoZOoeiaPIeBRMCTiwxIuw"
    "ZP0v4fl-HvwhwOoPwrOufAtYbz3Wrq4Q6Y2yKpCaLXL6KBIqDSFUtZAot_1VKG5PLkyiAZSQ7YWNteR9-2K_W07k"
    "ypvgBu15ID-lGLz5V6f5m9ZDMdTTa4mWwOhwDzfwhuWmLjw-sb",
    2: "brl1.70.nFFslkNNSbD04wRubyrB49sY7GNwms8Dxgk4cQC7hKAUAWxW5UKcDk2GIHEdRDTVxtYCAA~2.1342.Em"
    "rl7M1awW7bMAz9FaPnCLBIyZKv-42gh1RJsKLOZehlHfrv46MUW06dLm2HNJjnRrREyTLNRz56AuIfWtF4H44L-j"
    "LQ1y6i2tamB27TvksphBRD24fNPu25fXCbdkMkDRt4u2mJqNtvQ7snZ6Pfb-K-DbFzNSpy5YI_gor0FVR0c1Q8Ab"
    "oTVDyB0HnmWoPiIgjOYe70yMB4BEtk0-FdYPQ6tddU6auIJy_BpYDXuXbRjxbP3rUlgGxL61pIxjeHY6u16SoP2m"
    "lapx5IMjunYcNnoY4vALp_YZeGIzV0TTH_vHkhbCnPriU3uZtqmSMP0DahHTRVSMwNjKOhgLNGQRILJeR2RmUmi0"
    "3ubtBfdzcYvSZJhfbHBZXlIS9jyjPLja44dVg5V6aOV5u5sueORKfVlFk6BknlJb_PfzTKcf64RX2ot-jigWHVxU"
    "8N7BHA54HhwnFfm6W84LEhT4N1TrbUBvAbtrEOZyak6ngANhqIyGSpyb0NuhuRWoczuht0lzhdXnxp6wgaje5kY6"
    "42c8jxKmburzXx-BzZQbGFRrCHyvs4OYsqmK9SijgTnpuItNVA4BJ6yM8GwyCrLVmJHgtK4uiAgtJ76oDWb9CHGZ"
    "STzNE4C6ozgJ2RcwKBJwYja3dGhbIMcHouX4cAPeRno8PkeDkYosbzYEGl-XDIAwffGi--0ct6_aDU1PHJ2xEyvn"
    "0xkg7HW1mL5OeufuV7X5ZCBINyCqlOrE604rcIjQpBDlKjrdwroUcDAMYwOWpTAcMsQJ4ivKjYn1ikJ-MlgYhK1s"
    "bRat7k6DDriBWxmG1sOjYdyzlhp8S3il-ORoVJCXTq83UIGHSltKhvVAYWUBbnBytvifw_5IGDI-PoYKnpu4Gj4V"
    "ACIhxzV_WNi7GrSLeyFpJYrazF5sfbl7XY3lhYI2Zkl6AWYGjgmViEk59iYCpzsj28n3gYNWLm2mx6URs4BYPahg"
    "V97ZzYjloNno6_RbPhG7KacDtG0082E77JZHi0GM1Gf5U4GNlIjv4vZHJmjMX96lTDR_mKUUGFq7I9Q5BHUmoG80"
    "KC63rtUFc9FooLcz1LhYZlRcvFh7kmi7s5ugA-p-rc3aGQgbLM4t35NneYlVrO3N6kaOn2zmg6X1yZVL25v2VdxZ"
    "b-F900UkuoYDMl1jE2Ok8hj05kN_jVb_FPC9j7jjqfZTH5bUVWId17_jl-cfGkn3_lr0zG72GOrd1uq1-zPO1-39"
    "Upo0ZNU9KITbuveJ01duhev7Uo6h-fd4dJPdSd12aLtrTLH66MgscEomutiX5ocyr-Or20f2qNEzVT6JeRa8tXSM"
    "sonyLrjgrolKSzd69_AQ",
}
"""Links of the first pages, to a row of three cells: with a puddle, and with a key."""


@pytest.mark.parametrize("version", [1, 2])
def test_old_links_play(version: int, ground: Playground) -> None:
    ground.open(level(size=[2, 2]))
    ground.follow(OLD[version])
    expect(ground.page.locator("#notice")).to_be_hidden()
    expect(ground.page.locator("h1")).to_have_text("Before")
    needs = " It needs key." if version == 2 else ""
    assert ground.message == f"Move the robot to an exit.{needs}"
    ground.press("h")
    assert ground.message == "Hint: move east."
    ground.press("p")
    expect(ground.page.locator("#message")).to_have_attribute("data-kind", "exit")
    # They lack the values.
    assert card(ground) == {"Return": ground.page.locator("#return").inner_text(), "Help": ANY}
    expect(ground.page.locator("#stars")).to_be_hidden()


def test_a_link_has_the_result_of_a_page(ground: Playground) -> None:
    world = level(size=[3, 1], heading="N", puddles=[{"at": [1, 0], "size": "large"}])
    guide = guide_of(world)
    assert guide.turning is not None
    ground.open(level(size=[2, 2]))
    ground.follow(link_fragment(world, world, guide))
    known = ground.page.evaluate("() => [game.data.returns, game.data.turns.returns]")
    own = json.loads(json.dumps(page_data(world, guide=guide)))
    assert known == [own["returns"], own["turns"]["returns"]]
    assert known[0]["best"] > known[1]["best"]
