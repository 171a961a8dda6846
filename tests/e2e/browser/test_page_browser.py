"""Pages in a real browser: a level is played as the environment plays it, and runs nothing else."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from playwright.sync_api import Browser, Page, expect
from support.combinations import swept
from support.playground import KEYS, Playground, guide, level

from babyrobot_levels.render.page import to_html

WORLD = level(size=[4, 3], walls=[{"at": [1, 0], "side": "E"}])


# -- playing -----------------------------------------------------------------------------------


def test_arrow_keys_letters_and_buttons_move_the_robot(ground: Playground) -> None:
    ground.open(WORLD)
    assert ground.state == 0
    for key, state in (("ArrowRight", 1), ("ArrowDown", 5), ("A", 4), ("w", 0)):
        ground.press(key)
        assert ground.state == state
        ground.wait_until_there()
    assert (ground.number("steps"), ground.number("return")) == (4, -4)
    assert ground.message == "Moved north to [0, 0]: \N{MINUS SIGN}1"
    for name, state in (("East", 1), ("South", 5), ("Stay", 5), ("West", 4), ("North", 0)):
        ground.page.get_by_role("button", name=name, exact=True).click()
        assert ground.state == state


def test_walls_stop_him_and_it_costs(ground: Playground) -> None:
    ground.open(WORLD)
    ground.press("ArrowUp")
    assert (ground.state, ground.number("steps"), ground.kind) == (0, 1, "bump")
    assert ground.message == "Blocked by a wall to the north: \N{MINUS SIGN}1"
    ground.press("ArrowRight", "ArrowRight", "ArrowRight")
    assert (ground.state, ground.number("return")) == (1, -4)
    ground.wait_until_there()


def test_the_exit_ends_it_and_retry_begins_again(ground: Playground) -> None:
    ground.open(WORLD)
    ground.press("s", "s", "d", "d", "d")
    assert (ground.state, ground.kind) == (11, "exit")
    assert "Exit reached after 5 steps! Return \N{MINUS SIGN}4." in ground.message
    ground.press("ArrowUp")
    assert (ground.state, ground.number("steps")) == (11, 5)
    ground.press("r")
    assert (ground.state, ground.number("steps"), ground.number("return")) == (0, 0, 0)
    ground.press("d")
    assert ground.state == 1
    ground.page.get_by_role("button", name="Retry").click()
    assert ground.state == 0


def test_other_ends(ground: Playground) -> None:
    pit = level(size=[3, 1], areas=[{"at": [1, 0], "ends": True, "reward": -9}], max_steps=2)
    ground.open(pit)
    ground.press("d")
    assert (ground.state, ground.kind, ground.number("return")) == (1, "over", -9)
    ground.press("r", " ", "ArrowUp")
    assert (ground.kind, ground.message) == (
        "time",
        "Blocked by a wall to the north: \N{MINUS SIGN}1. "
        "Time limit reached after 2 steps. Return \N{MINUS SIGN}2.",
    )
    ground.press("d")
    assert ground.state == 0


# -- chance ------------------------------------------------------------------------------------

WET = level(
    size=[4, 3],
    start=[[0, 0], [3, 0], [0, 2]],
    exit=[3, 2],
    puddles=[{"at": [1, 1], "size": "large"}, {"at": [2, 1], "size": "large"}],
    skid={"probability": 0.3, "to": "others"},
    walls=[{"at": [1, 0], "side": "E", "pass": 0.5}],
)


@pytest.mark.parametrize("seed", swept([2**40 + 7], [0]))
def test_a_seed_and_the_same_actions_give_the_environments_episode(
    seed: int, ground: Playground
) -> None:
    env = WET.make(observation="index")
    ground.open(WET, seed=seed)
    chosen = np.random.default_rng(1)
    state, _ = env.reset(seed=seed)
    assert ground.state == state
    skids = episodes = 0
    total = 0.0
    for _ in range(120):
        action = int(chosen.integers(5))
        state, reward, terminated, truncated, info = env.step(action)
        ground.press(KEYS[action])
        total += float(reward)
        skids += bool(info["skidded"])
        assert ground.state == state
        assert ground.number("return") == pytest.approx(total, abs=0.006)
        if terminated or truncated:
            episodes += 1
            total = 0.0
            seed += 1
            state, _ = env.reset(seed=seed)
            ground.press("n")
            assert ground.state == state
    assert skids > 10
    assert episodes > 0


def test_keys_that_are_typed_into_the_seed_do_not_walk(ground: Playground) -> None:
    ground.open(WORLD)
    ground.page.locator("#seed").focus()
    ground.press("ArrowRight", "d", "r")
    assert ground.number("steps") == 0


# -- watching ----------------------------------------------------------------------------------


def test_the_best_policy_walks_the_environments_episode(ground: Playground) -> None:
    world = level(size=[4, 3], skid={"probability": 0.4}, maze={"seed": 2, "loops": 1})
    best = guide(world)
    env = world.make(observation="index")
    state, _ = env.reset(seed=11)
    steps, total, is_over = 0, 0.0, False
    while not is_over:
        state, reward, is_over, _, _ = env.step(best.policy[state])
        steps, total = steps + 1, total + float(reward)
    ground.open(world, guide=best, seed=11)
    ground.press("p")
    expect(ground.page.locator("#message")).to_have_attribute("data-kind", "exit")
    assert (ground.number("steps"), ground.number("return")) == (steps, total)
    watch = ground.page.get_by_role("button", name="Watch the optimal policy")
    expect(watch).to_have_attribute("aria-pressed", "false")
    # Once more, from the start.
    watch.click()
    expect(watch).to_have_attribute("aria-pressed", "true")
    assert ground.number("steps") <= 1


def test_a_random_walk_is_the_action_spaces(ground: Playground) -> None:
    world = level(size=[3, 1])
    env = world.make(observation="index")
    env.reset(seed=6)
    env.action_space.seed(6)
    steps, is_over = 0, False
    while not is_over:
        _, _, is_over, _, _ = env.step(env.action_space.sample())
        steps += 1
    ground.open(world, policy="random", seed=6)
    ground.page.get_by_role("button", name="Watch the random policy").click()
    expect(ground.page.locator("#message")).to_have_attribute("data-kind", "exit")
    assert ground.number("steps") == steps


def test_who_takes_a_step_takes_over(ground: Playground) -> None:
    world = level(size=[4, 3], display={"robot": {"speed": 0.1}})
    ground.open(world, guide=guide(world))
    ground.press("p")
    expect(ground.page.locator("#steps")).to_have_text("1")
    ground.press("ArrowLeft")
    expect(ground.page.locator("#watch")).to_have_attribute("aria-pressed", "false")
    assert ground.number("steps") == 2


# -- looks -------------------------------------------------------------------------------------


def test_he_glides_and_looks_where_he_goes(ground: Playground) -> None:
    ground.open(level(size=[4, 3], display={"robot": {"speed": 0.5}}))
    sprite = ground.page.locator("#robot use")
    standing = sprite.get_attribute("href")
    ground.press("d")
    ground.page.wait_for_function(
        "() => { const x = document.querySelector('#robot').transform.baseVal[0].matrix.e;"
        " return x > 10 && x < 60 }"
    )
    assert sprite.get_attribute("href") != standing
    ground.wait_until_there()
    assert ground.corner == (1, 0)


def test_values_and_best_moves_are_switched(ground: Playground) -> None:
    ground.open(WORLD, guide=guide(WORLD), values=True)
    values, moves = ground.page.locator("#values"), ground.page.locator("#policy")
    expect(values).to_be_visible()
    expect(moves).to_be_hidden()
    ground.press("v", "b")
    expect(values).to_be_hidden()
    expect(moves).to_be_visible()
    button = ground.page.get_by_role("button", name="Optimal actions")
    expect(button).to_have_attribute("aria-pressed", "true")
    button.click()
    expect(moves).to_be_hidden()


def test_arrow_keys_do_not_scroll_the_page(ground: Playground) -> None:
    ground.page.set_viewport_size({"width": 390, "height": 400})
    ground.open(WORLD)
    ground.press(*["ArrowDown"] * 6, *[" "] * 3)
    assert ground.page.evaluate("() => window.scrollY") == 0


def test_it_follows_light_and_dark(browser: Browser, tmp_path: Path) -> None:
    grounds = []
    for scheme in ("light", "dark"):
        context = browser.new_context(color_scheme=scheme)
        ground = Playground(context.new_page(), tmp_path)
        ground.open(WORLD)
        grounds.append(
            ground.page.evaluate("() => getComputedStyle(document.body).backgroundColor")
        )
        context.close()
    assert grounds[0] != grounds[1]


def test_without_scripts_there_is_the_picture(browser: Browser, tmp_path: Path) -> None:
    context = browser.new_context(java_script_enabled=False)
    ground = Playground(context.new_page(), tmp_path, has_scripts=False)
    ground.open(WORLD)
    expect(ground.page.locator("#stage svg[role=img]")).to_be_visible()
    expect(ground.page.get_by_text("Playing this level needs JavaScript")).to_be_visible()
    context.close()


# -- hostile levels ----------------------------------------------------------------------------


def test_a_hostile_level_runs_nothing(ground: Playground) -> None:
    evil = (
        "</title></script></style></svg><script>window.hacked = 1</script>"
        "<img src=x onerror='window.hacked = 2'><svg onload='window.hacked = 3'>"
        "<!--<script>\"';window.hacked=4//"
    )
    world = level(
        size=[4, 3],
        title=evil,
        description=evil,
        author=evil,
        source=evil,
        license=evil,
        areas=[{"at": [1, 1], "label": evil, "color": "rgb(1, 2, 3)"}],
    )
    ground.open(world, guide=guide(world))
    ground.press("d", "v", "b", "p")
    expect(ground.page.locator("#message")).to_have_attribute("data-kind", "exit")
    assert ground.page.evaluate("() => window.hacked") is None
    assert ground.page.locator("img").count() == 0
    assert ground.page.locator("h1").inner_text() == evil


def test_what_gets_in_all_the_same_is_not_run(page: Page, tmp_path: Path) -> None:
    """The page's policy is a second wall behind the first: escaping."""
    path = tmp_path / "page.html"
    injected = "<script>window.hacked = 1</script><img src='http://127.0.0.1:9/x.png'>"
    path.write_text(to_html(WORLD).replace("<header>", f"<header>{injected}"), encoding="utf-8")
    refused: list[str] = []
    page.on("console", lambda message: refused.append(message.text))
    page.goto(path.as_uri())
    page.keyboard.press("d")
    assert page.locator("#steps").inner_text() == "1"
    assert page.evaluate("() => window.hacked") is None
    assert sum("Content Security Policy" in text for text in refused) == 2


# -- one after the other -----------------------------------------------------------------------


def test_a_page_leads_on_and_keeps_what_is_reached(ground: Playground) -> None:
    row = level(name="row", size=[4, 1])
    ground.open(row, next_page="two.html", previous_page="zero.html")
    page, onwards = ground.page, ground.page.locator("#result .onwards")
    names = [link.get_attribute("href") for link in page.get_by_label("Levels").locator("a").all()]
    assert names == ["zero.html", "two.html"]
    expect(onwards).to_be_hidden()
    expect(page.locator("#progress")).to_be_hidden()
    ground.press("d", "d", "d")
    expect(onwards).to_be_visible()
    assert (onwards.text_content(), onwards.get_attribute("href")) == (
        "Next level Enter",
        ground.address.rpartition("/")[0] + "/two.html",
    )
    page.reload()
    expect(page.locator("#progress")).to_have_text("Your best return: \N{MINUS SIGN}2")
    stored = page.evaluate("JSON.parse(localStorage.getItem('babyrobot:progress'))")
    assert stored == {row.digest: {"solved": True, "best": -2}}
    # The last one leads nowhere; a page alone keeps nothing.
    for options in ({"previous_page": "zero.html"}, {}):
        page.evaluate("localStorage.clear()")
        ground.open(row, **options)
        ground.press("d", "d", "d")
        expect(page.locator("#result")).to_be_visible()
        expect(page.get_by_role("link", name="Next level")).to_have_count(0)
        kept = page.evaluate("localStorage.getItem('babyrobot:progress')")
        assert (kept is not None) == bool(options)
