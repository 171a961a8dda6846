"""Learn: the algorithms of a page give Python's numbers, and can be stepped, run and told."""

from __future__ import annotations

import re
from typing import Any

import pytest
from playwright.sync_api import Page, expect
from support.learned import LEARNED, runs_of
from support.playground import FAST, Playground

from babyrobot_levels.analysis.guides import guide_of
from babyrobot_levels.analysis.solver.optimum import solve
from babyrobot_levels.library.catalogue import levels, load
from babyrobot_levels.library.level import Level
from babyrobot_levels.render.page import page_data

MOST_STATES = 400
"""Of the levels that are learned: with more, all tests together take minutes."""

MINUS = "\N{MINUS SIGN}"


def learn(ground: Playground, name: str, **options: Any) -> Page:
    """Open a level of the gallery, and begin to learn it."""
    level = load(name).replace(display=FAST)
    ground.open(level, guide=guide_of(level), **options)
    ground.press("e")
    return ground.page


def numbers(page: Page) -> str:
    return page.locator("#learn-numbers").inner_text()


def texts(page: Page) -> list[str]:
    """Return the values that the picture shows."""
    shown = page.locator("#values text").all_text_contents()
    return [text.replace(MINUS, "-") for text in shown if text]


def test_all_levels_are_learned_as_python_learns_them(ground: Playground) -> None:
    ground.open(load("final-maze"))
    learned = 0
    for info in levels():
        level = load(info.name)
        if level.has_random_maze:
            level = level.with_maze_seed(0)
        if level.compile().num_states > MOST_STATES:
            continue
        runs = list(runs_of(level, all_starts=not level.has_things))
        data = page_data(level)
        found = ground.page.evaluate(LEARNED, [data, runs])
        for run, (number, values, returns) in zip(runs, found, strict=True):
            told = info.name, run["options"]
            assert number == run["number"], told
            assert values == pytest.approx(list(map(float, run["values"])), abs=1e-9), told
            assert run["returns"] is None or returns == pytest.approx(run["returns"]), told
        learned += 1
    assert learned > 50


def test_the_sweeps_of_the_book_number_by_number(ground: Playground) -> None:
    page = learn(ground, "gridworld-4-1")
    page.select_option("[data-option=algorithm]", "policy_evaluation")
    page.select_option("[data-option=policy]", "uniform")
    ground.press("ArrowDown")
    assert set(texts(page)) == {"-1"}
    ground.press("ArrowDown")
    assert texts(page)[:3] == ["-1.75", "-2", "-2"]
    ground.press("ArrowDown", "ArrowRight")
    assert texts(page)[:3] == ["-3.06", "-2.94", "-3"]
    told = "V([1, 0]) ← mean(north -3.44, east -3.94, south -3.87, west -1) = -3.06"
    assert ground.message.replace(MINUS, "-") == told
    assert page.locator("#spoken").inner_text().startswith("V([1, 0]) becomes mean(")
    page.locator("#learn-speed").fill("4")
    page.locator("#stage").focus()
    ground.press(" ")
    expect(page.locator("#message")).to_contain_text("Nothing changes any more", timeout=60_000)
    assert texts(page)[:3] == ["-14", "-20", "-22"]


def test_sarsa_keeps_clear_of_the_cliff_and_q_learning_does_not(ground: Playground) -> None:
    page = learn(ground, "cliff-walking")
    for algorithm, is_near in (("q_learning", True), ("sarsa", False)):
        page.select_option("[data-option=algorithm]", algorithm)
        page.locator("#learn-speed").fill("4")
        page.locator("#stage").focus()
        ground.press(" ")
        told = re.compile(r"Episode ([5-9]\d\d|\d{4,}) ")
        expect(page.locator("#learn-numbers")).to_have_text(told, timeout=60_000)
        ground.press(" ")
        # At the start of the row along the cliff, east is the way along it.
        along = page.evaluate("learning.learner.best(24).includes(1)")
        assert along == is_near


def test_an_episode_is_walked_and_told(ground: Playground) -> None:
    page = learn(ground, "first-key")
    ground.press("ArrowRight")
    assert re.match(r"Q\(\[\d, \d\] with \w+, \w+\) ← 0 \+ 0\.1 · \(", ground.message)
    ground.press("ArrowDown")
    assert numbers(page).startswith("Episode 1 · value at the start")
    assert page.locator("#learn-charts svg").count() == 2
    seed = page.locator("#seed")
    ground.press("n")
    assert (seed.input_value(), numbers(page)[:9]) == ("1", "Episode 0")
    ground.press("ArrowDown")
    first = texts(page)
    ground.press("r", "ArrowDown")
    assert (seed.input_value(), texts(page)) == ("1", first)


def test_the_game_goes_on_where_it_was_left_to_learn(ground: Playground) -> None:
    level = load("frozen-lake").replace(display=FAST)
    ground.open(level, guide=guide_of(level))
    before = page_of_answers(ground)
    ground.press("e", "ArrowDown")
    assert ground.page.locator("#learn").is_visible()
    assert not ground.page.locator(".pad").first.is_visible()
    ground.press("e")
    assert page_of_answers(ground) == before
    assert not ground.page.locator("#learn").is_visible()
    ground.press("v")
    best = round(solve(level).values[0, 0], 2)
    assert str(best) in texts(ground.page)


def page_of_answers(ground: Playground) -> list[str]:
    places = "#heat", "#values", "#policy"
    return [ground.page.locator(place).inner_html() for place in places]


def test_sliders_begin_again_or_change_what_runs(ground: Playground) -> None:
    page = learn(ground, "cliff-walking")
    ground.press("ArrowDown")
    page.locator("#learn details").click()
    python = page.locator("#learn-python")
    expect(python).to_contain_text("step_size=0.1,")
    page.locator("[data-option=step_size]").fill("0.5")
    assert numbers(page).startswith("Episode 1")
    expect(python).to_contain_text("# Sliders were moved")
    page.locator("[data-option=discount]").fill("0.9")
    assert numbers(page).startswith("Episode 0")
    expect(python).to_contain_text("discount=0.9,")
    expect(python).not_to_contain_text("# Sliders were moved")


def test_the_program_gives_the_numbers_of_the_run(ground: Playground) -> None:
    level = load("cliff-walking")
    page = learn(ground, "cliff-walking")
    page.locator("#learn details").click()
    page.locator("#stage").focus()
    ground.press("ArrowDown", "ArrowDown")
    names: dict[str, Any] = {}
    exec(page.locator("#learn-python").inner_text(), names)
    assert names["level"].digest == level.digest
    learned = page.evaluate(
        "learning.learner.problem.states.map((at) => learning.learner.values[at])"
    )
    goes_on = ~level.compile().is_terminal
    assert learned == pytest.approx(names["last"].values.ravel()[goes_on].tolist())


@pytest.mark.parametrize(("options", "learns"), [({}, False), ({"learn": True}, True)])
def test_without_answers_a_page_learns_if_it_may(
    options: dict[str, Any], learns: bool, ground: Playground
) -> None:
    level: Level = load("frozen-lake").replace(display=FAST)
    ground.open(level, **options)
    assert ground.page.locator("#learn-on").is_visible() == learns
    ground.press("e")
    assert ground.page.locator("#learn").is_visible() == learns
    if learns:
        ground.press("ArrowDown")
        assert texts(ground.page)
        assert ground.page.locator("#signs").is_visible()


def test_larger_levels_say_so(ground: Playground) -> None:
    level = Level.from_fields({"version": 1, "size": [100, 60]})
    ground.open(level, learn=True)
    ground.press("e")
    told = "Only levels of up to 5000 states are learned here; this one has 6000."
    assert ground.message == told
    assert not ground.page.locator("#learn").is_visible()
