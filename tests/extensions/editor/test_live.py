"""What is shown while one draws, in a real browser: answers, findings, play and policies."""

from __future__ import annotations

import re
from typing import Any

import pytest
from playwright.sync_api import Locator, expect
from support.editors import EditorPage, OpenEditor
from support.hands import Finger, Mouse

from babyrobot_levels.extensions.editor import answers

pytestmark = pytest.mark.slow

LEVEL = "version: 1\nsize: [4, 2]\nstart: [0, 0]\nexit: [3, 1]\nmax_steps: 100\n"


def part(editor: EditorPage, name: str) -> Locator:
    """Return a part of the editor by its class."""
    return editor.page.locator(f".{name}")


def press(editor: EditorPage, *keys: str) -> None:
    """Press keys while the picture has the focus."""
    for key in keys:
        part(editor, "stage").press(key)


def middle(editor: EditorPage, x: int, y: int) -> tuple[float, float]:
    """Return the point of the window that is the middle of a cell."""
    return Mouse(editor).at(x + 0.5, y + 0.5)


def test_the_best_return_follows_what_is_drawn(editor_page: OpenEditor) -> None:
    editor = editor_page(LEVEL)
    expect(part(editor, "best-return")).to_have_text("−3")
    expect(editor.page.locator("#values")).to_be_hidden()
    press(editor, "v", "b")
    expect(editor.page.locator("#values")).to_be_visible()
    expect(editor.page.locator("#policy")).to_be_visible()
    press(editor, "2", "ArrowRight", "Space")
    expect(part(editor, "change")).to_have_text(re.compile(r"cells? changed"))
    # What is shown stays so in the next picture.
    expect(editor.page.locator("#values")).to_be_visible()
    expect(part(editor, "changed").locator("path")).to_have_count(1)
    press(editor, "v")
    expect(editor.page.locator("#values")).to_be_hidden()


def test_what_takes_longer_follows_when_one_pauses(
    editor_page: OpenEditor, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(answers, "BUDGET", 0.0)
    editor = editor_page(LEVEL)
    expect(part(editor, "best-return")).to_have_text("−3")
    press(editor, "2", "ArrowRight", "Space")
    expect(part(editor, "best-return")).to_have_text("…")
    expect(part(editor, "best-return")).not_to_have_text("…")
    assert editor.session.answers.optimum is not None


def test_a_click_brings_what_it_changed_and_shows_it(editor_page: OpenEditor) -> None:
    editor = editor_page(LEVEL)
    mouse = Mouse(editor)
    mouse.choose("small")
    for x, told in ((1, "1 small puddle"), (2, "2 small puddles")):
        with editor.page.expect_response("**/message") as replied:
            mouse.paint((x, 0))
        reply = replied.value.json()
        assert "changes" in reply
        assert "state" not in reply
        expect(part(editor, "stage")).to_have_accessible_description(re.compile(told))
    # What is refused, since the text was changed by others, shows that text.
    editor.session.type(LEVEL)
    with editor.page.expect_response("**/message") as replied:
        editor.page.mouse.click(*middle(editor, 2, 1))
    assert "changes" in replied.value.json()
    expect(part(editor, "stage")).not_to_have_accessible_description(re.compile("puddle"))


def test_findings_and_unreachable_cells_are_marked_where_they_are(editor_page: OpenEditor) -> None:
    walls = "walls:\n- {at: [3, 0], side: W}\n- {at: [3, 0], side: S}\n- {at: [1, 0], side: N}\n"
    editor = editor_page(LEVEL.replace("max_steps: 100\n", "") + walls)
    expect(part(editor, "finding-mark")).to_have_count(2)
    expect(part(editor, "unreachable").locator("path")).not_to_have_count(0)
    editor.page.mouse.move(*middle(editor, 3, 0))
    expect(part(editor, "finding-note")).to_contain_text("cannot be reached")
    editor.page.mouse.move(*middle(editor, 2, 1))
    expect(part(editor, "finding-note")).to_be_hidden()
    # The keyboard's cursor tells the same.
    press(editor, "ArrowRight")
    expect(part(editor, "finding-note")).to_contain_text("no effect")


def test_playing_has_the_same_luck_each_time_and_leaves_no_trail(editor_page: OpenEditor) -> None:
    slippery = LEVEL + "puddles:\n- {at: [0, 0], size: large}\n- {at: [1, 0], size: large}\n"
    editor = editor_page(slippery)

    def played() -> list[Any]:
        told = []
        for _ in range(6):
            press(editor, "ArrowRight")
            told.append(part(editor, "episode-told").text_content())
        return told

    press(editor, "p")
    first = played()
    press(editor, "r")
    assert played() == first
    press(editor, "n")
    expect(part(editor, "episode")).to_contain_text("Seed1")
    press(editor, "ArrowRight", "p")
    expect(part(editor, "playing")).to_be_hidden()
    expect(editor.page.locator("#walked")).to_have_count(0)
    editor.page.get_by_role("button", name="Policy", exact=True).click()
    expect(editor.page.locator("#walked")).to_have_count(0)
    assert editor.session.text == slippery


def test_an_episode_ends_with_its_result(editor_page: OpenEditor) -> None:
    editor = editor_page(LEVEL)
    editor.page.get_by_role("button", name="Play", exact=True).click()
    for name in ("East", "East", "East", "South"):
        editor.page.get_by_role("button", name=name, exact=True).click()
    expect(part(editor, "episode-told")).to_contain_text("Exit reached after 4 steps! Return −3.")
    assert editor.session.text == LEVEL


@pytest.mark.parametrize("kind", [Mouse, Finger])
def test_swipes_move_the_robot(kind: type[Mouse | Finger], editor_page: OpenEditor) -> None:
    editor = editor_page(LEVEL, **kind.context)
    press(editor, "p")
    kind(editor).drag(middle(editor, 1, 0), middle(editor, 2, 0))
    expect(part(editor, "episode-told")).to_have_text("Moved east to [1, 0]: −1")


def test_a_finger_draws_a_policy_and_a_second_one_ends_that(editor_page: OpenEditor) -> None:
    editor = editor_page(LEVEL, **Finger.context)
    finger, arrows = Finger(editor), part(editor, "drawn-policy").locator("path")
    editor.page.get_by_role("button", name="Policy", exact=True).tap()
    finger.drag(*(middle(editor, *cell) for cell in ((0, 0), (3, 0), (3, 1))))
    expect(arrows).to_have_count(5)
    finger.touch("touchStart", middle(editor, 0, 1))
    finger.touch("touchMove", middle(editor, 2, 1))
    expect(arrows).to_have_count(8)
    finger.touch("touchStart", middle(editor, 2, 1), middle(editor, 0, 0))
    finger.touch("touchEnd")
    expect(arrows).to_have_count(5)


def test_a_policy_drawn_by_hand_has_its_exact_worth(editor_page: OpenEditor) -> None:
    editor = editor_page(LEVEL)
    editor.page.get_by_role("button", name="Policy", exact=True).click()
    random = part(editor, "worth").locator("dd").first
    expect(random).not_to_have_text("−3 within 100 steps")
    Mouse(editor).drag(*(middle(editor, *cell) for cell in ((0, 0), (3, 0), (3, 1))))
    expect(random).to_have_text("−3 within 100 steps")
    expect(part(editor, "worth")).to_contain_text("Reaches an exit100 %")
    arrows = part(editor, "drawn-policy").locator("path")
    expect(arrows).to_have_count(5)
    # A click turns an arrow, and the level changes below them.
    editor.page.mouse.click(*middle(editor, 1, 0))
    expect(random).not_to_have_text("−3 within 100 steps")
    press(editor, "Control+z")
    editor.page.get_by_role("button", name="Edit", exact=True).click()
    press(editor, "2", "ArrowDown", "Space")
    expect(editor.page.locator(".editor")).to_have_attribute("data-revision", re.compile("[^1]"))
    expect(arrows).to_have_count(0)
    editor.page.get_by_role("button", name="Policy", exact=True).click()
    expect(arrows).to_have_count(5)
    assert "puddles" in editor.session.text


def test_a_policy_is_drawn_by_what_is_held(editor_page: OpenEditor) -> None:
    editor = editor_page(
        "version: 1\nsize: [3, 1]\nstart: [1, 0]\nexit_needs: key\nmax_steps: 20\n"
        "items:\n  - {name: key, at: [0, 0]}\n"
    )
    page, worth = editor.page, part(editor, "worth").locator("dd")
    page.get_by_role("button", name="Policy", exact=True).click()
    # For anything, then for what is held: that counts there.
    press(editor, "ArrowRight", "Shift+ArrowLeft", "Shift+ArrowRight", "Shift+ArrowRight")
    expect(worth.nth(2)).to_have_text("worse")
    page.get_by_role("button", name="Nothing").click()
    press(editor, "ArrowLeft", "Shift+ArrowLeft")
    expect(worth.nth(0)).to_have_text("−2 within 20 steps")
    expect(worth.nth(2)).to_have_text("as good as the best")
    arrow = part(editor, "drawn-policy").locator("path").nth(1)
    assert "rotate(270)" in (arrow.get_attribute("transform") or "")
    page.get_by_role("button", name="key", exact=True).click()
    assert "rotate(90)" in (arrow.get_attribute("transform") or "")
    editor.page.get_by_role("button", name="Clear").click()
    expect(worth.nth(2)).to_have_text("no better")
    page.get_by_role("button", name="Anything").click()
    page.get_by_role("button", name="Take the optimal actions").click()
    expect(worth.nth(2)).to_have_text("as good as the best")
    # Editing again, nothing is held.
    page.get_by_role("button", name="key", exact=True).click()
    page.get_by_role("button", name="Edit", exact=True).click()
    expect(page.locator("#things use")).not_to_have_count(0)


def test_answers_are_shown_for_what_is_chosen_to_be_held(editor_page: OpenEditor) -> None:
    editor = editor_page(
        "version: 1\nsize: [4, 1]\nstart: [1, 0]\nmax_steps: 20\n"
        "items:\n  - {name: key, at: [0, 0]}\ndoors:\n  - {at: [1, 0], side: E, needs: key}\n"
    )
    page, sets = editor.page, part(editor, "sets")
    hatched = page.locator("#never path")
    expect(sets).to_be_hidden()
    press(editor, "v")
    expect(sets).to_contain_text("Hatched: cannot occur with nothing held.")
    expect(hatched).to_have_count(3)
    sets.get_by_text("key").click()
    expect(hatched).to_have_count(0)
    # What is chosen stays so while one edits, and other modes have their own.
    press(editor, "2", "ArrowRight", "ArrowRight", "Space")
    expect(part(editor, "change")).to_have_text(re.compile(r"cells? changed"))
    expect(sets.get_by_role("radio", name="key")).to_be_checked()
    expect(hatched).to_have_count(0)
    page.get_by_role("button", name="Policy", exact=True).click()
    expect(sets.get_by_role("radio")).to_have_count(0)
    expect(sets).to_have_text("Hatched: cannot occur with what is held.")
    expect(hatched).to_have_count(3)
    page.get_by_role("button", name="Edit", exact=True).click()
    expect(sets.get_by_role("radio", name="key")).to_be_checked()
    expect(hatched).to_have_count(0)
