"""Learn: the algorithms of a page give Python's numbers, and can be stepped, run and told."""

from __future__ import annotations

import re
from typing import Any
from urllib.parse import parse_qsl

import pytest
from playwright.sync_api import Page, expect
from support.learned import LEARNED, runs_of
from support.places import DOCS
from support.playground import FAST, Playground

import babyrobot_levels as brl
from babyrobot_levels.analysis.guides import guide_of
from babyrobot_levels.analysis.solver.optimum import solve
from babyrobot_levels.library.catalogue import levels, load
from babyrobot_levels.library.level import Level
from babyrobot_levels.render.page import link_fragment, page_data

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


@pytest.mark.sweep
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
        data = page_data(level, turns=True)
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
    held = page.locator("#held dd")
    assert held.all_inner_texts() == ["nothing"]
    ground.press("ArrowDown")
    assert held.all_inner_texts() == ["key"]
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
    assert ground.page.locator("#policy-name").inner_text() == "Optimal actions"
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
    expect(python).to_contain_text("# Something was changed")
    page.locator("[data-option=discount]").fill("0.9")
    assert numbers(page).startswith("Episode 0")
    expect(python).to_contain_text("discount=0.9,")
    expect(python).not_to_contain_text("# Something was changed")


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
    level: Level = load("cliff-walking").replace(display=FAST)
    ground.open(level, **options)
    assert ground.page.locator("#learn-on").is_visible() == learns
    ground.press("e")
    assert ground.page.locator("#learn").is_visible() == learns
    if learns:
        assert texts(ground.page) == []
        ground.press("ArrowRight")
        assert texts(ground.page) == ["0"]
        assert ground.page.locator("#signs").is_visible()


def test_a_robot_that_turns_learns_where_it_looks(ground: Playground) -> None:
    page = learn(ground, "frozen-lake", turns=True)
    page.select_option("[data-option=algorithm]", "value_iteration")
    page.locator("#stage").focus()
    ground.press(*6 * ["ArrowDown"], "ArrowRight")
    assert run_of(page)["actions"] == "turns"
    *_, sweep = brl.value_iteration("frozen-lake", actions="turns", max_sweeps=6)
    # The picture has the values for the heading of the state that was updated.
    goes_on = ~load("frozen-lake").compile().is_terminal
    shown = sweep.values[0].ravel()[goes_on].tolist()
    assert list(map(float, texts(page))) == pytest.approx(shown, abs=0.006)
    assert ground.message.startswith("V([0, 0] looking north) ← max(left 0, right 0.0041")
    page.select_option("[data-option=algorithm]", "q_learning")
    assert not page.get_by_label("Exploring starts").is_visible()
    page.locator("#stage").focus()
    ground.press("ArrowRight")
    assert re.match(r"Q\(\[0, 0\] looking east, (left|right|forward)\)", ground.message)
    ground.press("e", "ArrowLeft")
    assert ground.message.startswith("Turned left")
    ground.open(load("frozen-lake"), learn=True)
    ground.follow("learn=sarsa&actions=turns")
    assert run_of(ground.page) == {"learn": "sarsa"}


def run_of(page: Page) -> dict[str, str]:
    """Return what the address tells of the run, beside the level."""
    fragment = page.evaluate("location.hash").lstrip("#")
    return dict(parse_qsl(fragment[fragment.index("learn=") :]))


@pytest.mark.parametrize("name", ["", "frozen-lake"])
def test_the_address_is_a_link_to_the_run(name: str, ground: Playground) -> None:
    """It keeps the level of the page's link, if there is one."""
    page = learn(ground, "cliff-walking")
    level = link_fragment(load(name), load(name), guide_of(load(name))) if name else ""
    if name:
        ground.follow(level)
        ground.press("e")
    before = page.evaluate("history.length")
    assert page.evaluate("location.hash") == f"#{level}{'&' if name else ''}learn=q_learning"
    page.select_option("[data-option=algorithm]", "sarsa")
    page.locator("[data-option=step_size]").fill("0.25")
    page.locator("[data-option=initial]").fill("-5")
    page.locator("[data-option=n_steps]").fill("4")
    page.locator("#stage").focus()
    ground.press("n", "ArrowDown")
    given = {"learn": "sarsa", "step_size": "0.25", "initial": "-5", "n_steps": "4", "seed": "1"}
    assert run_of(page) == given
    assert page.evaluate("history.length") == before
    page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    page.get_by_role("button", name="Copy link").click()
    expect(page.locator("#message")).to_have_text("Copied.")
    link = page.evaluate("navigator.clipboard.readText()")
    assert link == page.url
    shown = texts(page)

    ground.follow(link.partition("#")[2])
    assert page.title() == ("Frozen Lake" if name else "Cliff Walking")
    assert (run_of(page), set(texts(page))) == (given, {"-5"})
    ground.press("ArrowDown")
    assert texts(page) == shown
    ground.press("e")
    assert page.evaluate("location.hash") == (level and f"#{level}")


WRONG = {
    "learn=": {"learn": "q_learning"},
    "learn=<script>&policy=__proto__&actions=": {"learn": "q_learning"},
    "learn=sarsa&step_size=7&epsilon=-1": {"learn": "sarsa", "step_size": "1", "epsilon": "0"},
    "learn=sarsa&n_steps=1e9&seed=-1": {"learn": "sarsa", "n_steps": "16"},
    "learn=sarsa&n_steps=NaN&discount=Infinity&initial=1e999": {"learn": "sarsa"},
    "learn=sarsa&learn=%E0%A4%A&step_size=&seed=" + "9" * 41: {"learn": "sarsa"},
    "learn=sarsa&exploring_starts=yes&toString=1": {"learn": "sarsa"},
    "learn%3Dsarsa%26seed%3D8": {"learn": "sarsa", "seed": "8"},
}
"""What links tell, and what is taken from it."""


def test_what_a_link_tells_wrongly_is_as_usual_or_within_bounds(ground: Playground) -> None:
    learn(ground, "cliff-walking")
    for fragment, told in WRONG.items():
        ground.follow(fragment)
        assert run_of(ground.page) == told, fragment
        ground.press("ArrowDown")
        assert numbers(ground.page).startswith("Episode 1"), fragment


def test_pages_that_do_not_learn_ignore_what_a_link_tells(ground: Playground) -> None:
    ground.open(load("frozen-lake"))
    ground.follow("learn=sarsa")
    assert not ground.page.locator("#learn").is_visible()
    assert not ground.page.locator("#notice").is_visible()
    ground.open(load("first-key"), learn=True)
    ground.follow("learn=q_learning&exploring_starts=true")
    assert run_of(ground.page) == {"learn": "q_learning"}


WORKSHEET = DOCS / "watch-it-learn.md"


@pytest.mark.sweep
def test_the_pages_of_the_worksheet_open_as_it_says(ground: Playground) -> None:
    addresses = re.findall(r"`([\w-]+)\.html#(learn=[^`]+)`", WORKSHEET.read_text("utf-8"))
    assert len(addresses) == 7
    for name, fragment in addresses:
        ground.open(load(name), learn=True)
        ground.follow(fragment)
        assert ground.page.evaluate("location.hash") == f"#{fragment}"
    ground.open(load("dyna-maze"), learn=True)
    ground.follow("learn=q_learning&planning_steps=50")
    ground.press(*3 * ["ArrowDown"])
    assert "value at the start 0," in numbers(ground.page)
    ground.press("ArrowDown")
    assert "value at the start 0.000" in numbers(ground.page)


def test_larger_levels_say_so(ground: Playground) -> None:
    level = Level.from_fields({"version": 1, "size": [100, 60]})
    ground.open(level, learn=True)
    ground.press("e")
    told = "Only levels of up to 5000 states are learned here; this one has 6000."
    assert ground.message == told
    assert not ground.page.locator("#learn").is_visible()
