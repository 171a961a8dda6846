"""Learning while one draws: what is learned is kept while the level changes."""

from __future__ import annotations

import re

import pytest
from playwright.sync_api import Page, expect
from support.editors import OpenEditor
from support.jupyter import until

from babyrobot_levels.library.catalogue import load

pytestmark = pytest.mark.slow

MAZE = load("dyna-maze").to_yaml()
PHONE = {"viewport": {"width": 390, "height": 844}, "has_touch": True}


def learn(page: Page) -> None:
    """Open the panel, choose the highest speed, and give the keys to the picture."""
    page.get_by_role("tab", name="Learn").click()
    page.get_by_role("slider", name="Speed").fill("4")
    page.get_by_role("slider", name="Planning steps").fill("10")
    page.locator(".stage").focus()


def values(page: Page) -> list[str]:
    return page.locator("#values text").all_text_contents()


def told(page: Page) -> tuple[int, float]:
    """Return the number of episodes so far, and the value of the start."""
    found = re.match(r"Episode (\d+) · value at the start ([\d.]+)", numbers(page))
    assert found is not None
    return int(found[1]), float(found[2])


def numbers(page: Page) -> str:
    return page.locator("#learn-numbers").inner_text()


def test_a_run_goes_on_while_a_wall_is_drawn_and_undone(editor_page: OpenEditor) -> None:
    editor = editor_page(MAZE)
    page = editor.page
    learn(page)
    # A way is found again that is seldom tried, however fast or slow episodes pass.
    page.get_by_role("slider", name="Exploration").fill("1")
    page.locator(".stage").focus()
    run = page.get_by_role("button", name="Stop")
    page.keyboard.press("q")
    until(lambda: told(page)[1] > 0.4, "the way is found")
    for _ in range(4):
        page.keyboard.press("ArrowDown")
    page.keyboard.press("ArrowRight")
    # Of the two ways, the shorter one is closed, and open again.
    for keys, exact in (["m", "ArrowDown", "Shift+ArrowRight"], "0.46"), (["Control+z"], "0.51"):
        number, _ = told(page)
        for key in keys:
            page.keyboard.press(key)
        expect(page.locator("#learn-numbers")).to_contain_text(f"exact {exact}")
        expect(run).to_have_attribute("aria-pressed", "true")
        assert told(page)[0] >= number
        assert told(page)[1] > 0.3
        expect(page.locator("#learn-numbers")).to_contain_text(f"value at the start {exact}")


def test_values_stay_with_their_cells(editor_page: OpenEditor) -> None:
    editor = editor_page(MAZE)
    page = editor.page
    learn(page)
    page.get_by_role("slider", name="Initial values").fill("2")
    page.locator(".stage").focus()
    page.keyboard.type("uuu.")
    before = values(page)
    assert len(set(before)) > 5
    page.keyboard.press("Shift+ArrowRight")
    expect(page.locator("#spoken")).to_have_text("What was learned of 46 states is kept.")
    assert values(page) == before
    page.keyboard.press("4")
    page.keyboard.press("Space")
    until(lambda: values(page) == ["", *before[1:]], "a blocked cell has no value")
    page.keyboard.press("Control+z")
    until(lambda: values(page) == ["2", *before[1:]], "it begins anew")
    expect(page.locator("#message")).to_contain_text("45 states is kept, and 1 are new.")
    page.keyboard.press("Alt+ArrowRight")
    until(lambda: len(values(page)) == 60, "there is one more column")
    rows = [values(page)[row : row + 9] for row in range(0, 60, 10)]
    assert [text for row in rows for text in row] == ["2", *before[1:]]


def test_errors_hold_a_run_up_until_they_are_corrected(editor_page: OpenEditor) -> None:
    editor = editor_page(MAZE)
    page = editor.page
    learn(page)
    page.keyboard.press("q")
    until(lambda: told(page)[0] > 10, "it runs")
    text = page.get_by_label("Level file")
    text.fill(MAZE + "\nexit: [")
    expect(page.get_by_role("button", name="Run")).to_be_disabled()
    expect(page.get_by_text("learning goes on once they are corrected")).to_be_visible()
    number, _ = told(page)
    assert told(page) == (number, told(page)[1])
    text.fill(MAZE)
    expect(page.get_by_role("button", name="Stop")).to_be_enabled()
    until(lambda: told(page)[0] > number, "it goes on")


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("version: 1\nsize: [71, 71]\n", "Only levels of up to 5000 states are learned here"),
        (load("random-maze").to_yaml(), "Each episode has another maze"),
    ],
)
def test_why_a_level_is_not_learned(editor_page: OpenEditor, text: str, reason: str) -> None:
    page = editor_page(text).page
    page.locator(".stage").focus()
    page.keyboard.press("q")
    expect(page.get_by_role("tabpanel", name="Learn")).to_contain_text(reason)
    expect(page.locator(".said")).to_contain_text(reason)
    expect(page.locator("#learn")).to_be_hidden()


def test_another_panel_has_what_is_exact_and_what_is_learned_comes_back(
    editor_page: OpenEditor,
) -> None:
    editor = editor_page(MAZE, **PHONE)
    page = editor.page
    learn(page)
    page.keyboard.type("u.")
    before, learned = numbers(page), values(page)
    page.get_by_role("tab", name="Level").click()
    assert values(page) == []
    expect(page.get_by_role("button", name="Optimal actions")).to_have_attribute(
        "aria-pressed", "false"
    )
    page.get_by_role("tab", name="Learn").click()
    expect(page.get_by_role("button", name="Greedy actions")).to_have_attribute(
        "aria-pressed", "true"
    )
    assert (numbers(page), values(page)) == (before, learned)


def test_another_level_is_learned_anew_and_is_a_program(editor_page: OpenEditor) -> None:
    editor = editor_page(MAZE)
    page = editor.page
    learn(page)
    page.keyboard.press("u")
    page.get_by_text("This run in Python").click()
    expect(page.locator("#learn-python")).to_contain_text('brl.load("brl1.')
    page.get_by_role("button", name="Open another level").click()
    page.get_by_role("dialog").get_by_role("button", name="The first key").click()
    expect(page.locator("#learn-numbers")).to_contain_text("Episode 0")
    expect(page.get_by_role("slider", name="Discount")).to_have_value("1")


@pytest.mark.parametrize(
    ("fields", "exact"),
    [("size: [2, 1]", "0"), ("size: [3, 1]\nexit: none\nrewards: {step: -1}", "−Infinity")],
)
def test_levels_of_one_value_and_of_infinite_ones(
    editor_page: OpenEditor, fields: str, exact: str
) -> None:
    page = editor_page(f"version: 1\n{fields}\n").page
    page.locator(".stage").focus()
    page.keyboard.type("qq.u")
    expect(page.locator("#learn-numbers")).to_contain_text(f"exact {exact}")
    page.get_by_role("tab", name="Level").click()
    page.get_by_role("tab", name="Learn").click()
    expect(page.locator("#values text").first).not_to_be_empty()
    lines = page.locator(".charts path").evaluate_all("all => all.map((each) => each.outerHTML)")
    assert len(lines) > 1
    assert "NaN" not in "".join(lines)
