"""Pages for everybody: what is read out, keys that can be turned off, colours and contrast."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Browser, expect
from support.playground import Playground, guide, level

from babyrobot_levels.library.catalogue import load

WORLD = level(size=[4, 3], title="Two walls", walls=[{"at": [1, 0], "side": "E"}])


def spoken(ground: Playground) -> str:
    return ground.page.get_by_role("status").inner_text().replace("\N{NO-BREAK SPACE}", "")


# -- roles and names ---------------------------------------------------------------------------


def test_what_is_on_the_page_has_roles_and_names(ground: Playground) -> None:
    world = load("final-maze")
    ground.open(world, guide=guide(world))
    page = ground.page
    stage = page.get_by_role("application", name="The final maze")
    expect(stage).to_have_attribute("aria-roledescription", "grid world")
    picture = stage.get_by_role("img", name="The final maze")
    expect(picture).to_have_count(1)
    for place in (stage, picture):
        expect(place).to_have_accessible_description(re.compile("8 columns and 5 rows.*exit"))
    expect(page.get_by_role("group", name="Actions")).to_have_count(1)
    expect(page.get_by_role("group", name="Zoom").get_by_role("button")).to_have_count(3)
    for name in ("East", "Stay", "Undo", "Hint", "Retry", "New luck", "Look around"):
        expect(page.get_by_role("button", name=re.compile(f"^{name}"))).to_have_count(1)
    expect(page.get_by_role("textbox", name="Seed")).to_have_value("0")
    unnamed = page.evaluate(
        """() => [...document.querySelectorAll("button, input, summary")].filter((control) =>
          !control.ariaLabel && !control.textContent.trim() && !control.labels?.length).length"""
    )
    assert unnamed == 0


def test_the_keyboard_reaches_the_picture_first_and_then_the_controls(ground: Playground) -> None:
    ground.open(WORLD, guide=guide(WORLD))
    ground.press("Tab")
    reached = []
    for _ in range(12):
        reached.append(
            ground.page.evaluate(
                "() => document.activeElement.id || document.activeElement.dataset.control"
            )
        )
        width = ground.page.evaluate("() => getComputedStyle(document.activeElement).outlineWidth")
        assert width == "3px"
        ground.press("Tab")
    pad = ["north", "west", "stay", "east", "south"]
    assert reached == ["stage", *pad, "undo", "hint", "retry", "new-luck", "watch", "learn-on"]


# -- speech ------------------------------------------------------------------------------------


def test_each_step_is_told_with_the_closed_sides(ground: Playground) -> None:
    ground.open(WORLD)
    ground.press("d")
    assert spoken(ground) == ("Moved east to [1, 0]: \N{MINUS SIGN}1. Closed: north and east.")
    ground.press("s")
    assert spoken(ground) == "Moved south to [1, 1]: \N{MINUS SIGN}1. No side is closed."
    # What is said twice is another text, or it would not be read out again.
    texts = []
    for _ in range(2):
        ground.press(" ")
        texts.append(ground.page.get_by_role("status").text_content())
    assert texts[0] != texts[1]


def test_what_is_around_the_robot_is_told_on_demand(ground: Playground) -> None:
    ground.open(WORLD)
    ground.press("d", "l")
    around = (
        "The robot is at [1, 0]. Closed: north and east. "
        "The exit is 2 columns east and 2 rows south. The level has 4 columns and 3 rows."
    )
    assert spoken(ground) == ground.message == around
    ground.press("s")
    ground.page.get_by_role("button", name="Look around").click()
    assert "No side is closed. The exit is 2 columns east and 1 row south." in spoken(ground)


def test_a_robot_that_turns_is_told_where_it_looks(ground: Playground) -> None:
    ground.open(level(size=[4, 3], heading="E", exit=[0, 0], start=[3, 2]), turns=True)
    ground.press("l")
    assert "The robot is at [3, 2] and faces east." in spoken(ground)
    assert "The exit is 3 columns west and 2 rows north." in spoken(ground)


def test_a_locked_exit_is_not_told_as_one(ground: Playground) -> None:
    world = level(
        size=[3, 1],
        exit=[2, 0],
        exit_needs=["key"],
        items=[{"name": "key", "at": [1, 0], "shape": "key"}],
    )
    ground.open(world)
    ground.press("l")
    assert "exit" not in spoken(ground)
    ground.press("d", "l")
    assert "The exit is 1 column east." in spoken(ground)


# -- closed sides ------------------------------------------------------------------------------


def test_closed_sides_are_told_by_more_than_a_colour(ground: Playground) -> None:
    ground.open(WORLD)
    style = "button => getComputedStyle(button).border{}Width"
    north, west = (
        ground.page.get_by_role("button", name=f"{side}, closed") for side in ("North", "West")
    )
    assert north.evaluate(style.format("Top")) == "6px"
    assert west.evaluate(style.format("Left")) == "6px"
    assert west.evaluate(style.format("Top")) == "1px"
    # To try a closed side is an action: it costs a step.
    north.click()
    assert (ground.kind, ground.number("steps")) == ("bump", 1)
    ground.press("s", "s", "d", "d", "d")
    assert ground.kind == "exit"
    expect(ground.page.get_by_role("button", name="North")).to_have_count(0)


# -- keys --------------------------------------------------------------------------------------


def test_keys_that_are_characters_can_be_turned_off(ground: Playground) -> None:
    ground.open(WORLD, guide=guide(WORLD))
    ground.page.get_by_text("Keys", exact=True).click()
    ground.page.get_by_role("checkbox", name="shortcuts").uncheck()
    ground.page.locator("#stage").focus()
    ground.press("d", " ", "p", "v", "+", "l", "n")
    assert ground.number("steps") == 0
    assert ground.page.locator("#seed").input_value() == "0"
    ground.press("ArrowRight")
    assert ground.number("steps") == 1
    ground.page.get_by_role("checkbox", name="shortcuts").check()
    ground.press("s")
    assert ground.number("steps") == 2


# -- looks -------------------------------------------------------------------------------------


CONTRASTS = """() => {
  const channels = (color) => color.match(/[0-9.]+/g).map(Number);
  const luminance = (color) => {
    const parts = channels(color).slice(0, 3).map((part) => part / 255).map((part) =>
      (part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4));
    return 0.2126 * parts[0] + 0.7152 * parts[1] + 0.0722 * parts[2];
  };
  const opaque = (color) => (channels(color)[3] ?? 1) === 1;
  const groundOf = (place) => {
    const color = getComputedStyle(place).backgroundColor;
    return opaque(color) ? color : groundOf(place.parentElement);
  };
  const texts = [...document.querySelectorAll("main *")].filter((place) =>
    !place.closest("#stage, #map") && place.checkVisibility() &&
    [...place.childNodes].some((node) => node.nodeType === 3 && node.data.trim()));
  return texts.map((place) => {
    const pair = [getComputedStyle(place).color, groundOf(place)].map(luminance);
    const contrast = (Math.max(...pair) + 0.05) / (Math.min(...pair) + 0.05);
    return [place.textContent.trim().slice(0, 30), contrast];
  });
}"""


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_texts_of_the_page_can_be_read(scheme: Any, ground: Playground) -> None:
    world = load("treasure-chests")
    ground.page.emulate_media(color_scheme=scheme)
    ground.open(world, guide=guide(world), values=True)
    ground.page.get_by_text("Keys", exact=True).click()
    found = ground.page.evaluate(CONTRASTS)
    for keys in ("wwwwdddddd", "ArrowUp"):
        ground.press(*([keys] if keys == "ArrowUp" else keys))
        found += ground.page.evaluate(CONTRASTS)
    assert len(found) > 60
    assert [pair for pair in found if pair[1] < 4.5] == []


def test_the_users_own_colours_are_kept_apart(browser: Browser, tmp_path: Path) -> None:
    context = browser.new_context(forced_colors="active")
    ground = Playground(context.new_page(), tmp_path)
    ground.open(WORLD, guide=guide(WORLD))
    ground.press("v")
    grounds = [
        ground.page.locator(f"#show-{name}").evaluate(
            "button => getComputedStyle(button).backgroundColor"
        )
        for name in ("values", "policy")
    ]
    assert grounds[0] != grounds[1]
    north = ground.page.locator("[data-control=north]")
    assert north.evaluate("button => getComputedStyle(button).borderTopWidth") == "6px"
    # The picture keeps its own colours, by which it is told.
    fills = ground.page.locator("#stage svg rect").evaluate_all(
        "shapes => shapes.map((shape) => [shape.getAttribute('fill'), "
        "getComputedStyle(shape).fill])"
    )
    for written, shown in [pair for pair in fills if len(pair[0]) == 7]:
        red, green, blue = (int(written[at : at + 2], 16) for at in (1, 3, 5))
        assert shown == f"rgb({red}, {green}, {blue})"
    assert ground.faults == []
    context.close()


def test_who_wants_no_motion_sees_no_gliding(browser: Browser, tmp_path: Path) -> None:
    context = browser.new_context(reduced_motion="reduce", viewport={"width": 390, "height": 700})
    ground = Playground(context.new_page(), tmp_path)
    ground.open(level(size=[60, 40], display={"robot": {"speed": 0.01}}))
    for _ in range(12):
        ground.press("ArrowRight")
        ground.wait_until_still()
    # Neither the robot nor the window glides: both are there at once.
    seen = ground.page.evaluate(
        """() => {
          const frame = document.querySelector("#stage").getBoundingClientRect();
          const robot = document.querySelector("#robot").getBoundingClientRect();
          return robot.left > frame.left && robot.right < frame.right;
        }"""
    )
    assert seen
    assert ground.corner == (12, 0)
    context.close()
