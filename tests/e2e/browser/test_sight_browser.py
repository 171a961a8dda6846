"""A page that is played through a sight: fog, shades of what may be, and the best agent."""

from __future__ import annotations

import pytest
from playwright.sync_api import expect
from support.playground import Playground

import babyrobot_levels as brl
from babyrobot_levels.extensions.sight.page import page_sight

SHELLS = brl.load("shell-game").replace(display={"robot": {"speed": 100}})


@pytest.fixture(autouse=True)
def foggy(ground: Playground) -> None:
    ground.open(SHELLS, sight=page_sight(SHELLS, "view", view_radius=1))


def covered(ground: Playground, x: int, y: int) -> bool:
    """Return whether the middle of a cell is in the fog."""
    return bool(
        ground.page.evaluate(
            """([x, y]) => {
                const fog = document.querySelector("#fog");
                const point = fog.ownerSVGElement.createSVGPoint();
                const { margin } = JSON.parse(document.querySelector("#data").textContent);
                const cell = 64;
                [point.x, point.y] = [margin + (x + 0.5) * cell, margin + (y + 0.5) * cell];
                return !fog.closest(".hidden") && fog.isPointInFill(point);
            }""",
            [x, y],
        )
    )


def test_what_is_not_seen_is_in_fog(ground: Playground) -> None:
    assert not covered(ground, 3, 3)
    assert covered(ground, 0, 0)
    ground.page.mouse.move(0, 0)
    picture = ground.page.locator("#stage > svg").bounding_box()
    assert picture is not None
    ground.page.mouse.move(picture["x"] + 20, picture["y"] + 20)
    expect(ground.page.locator("#cell")).to_be_hidden()
    expect(ground.page.get_by_role("button", name="Look around")).to_be_hidden()


def test_what_may_be_is_shown_when_one_asks(ground: Playground) -> None:
    shades = ground.page.locator("#belief text")
    expect(shades.first).to_be_hidden()
    ground.press("k")
    expect(shades.first).to_be_visible()
    assert shades.all_text_contents() == 3 * ["exit", "33 %"]
    expect(ground.page.locator("#sure")).to_contain_text("33 % sure")
    expect(ground.page.get_by_role("button", name="What may be")).to_have_attribute(
        "aria-pressed", "true"
    )


def test_the_best_agent_is_watched_to_the_end_and_the_fog_lifts(ground: Playground) -> None:
    ground.press("p")
    expect(ground.page.locator("#result")).to_be_visible(timeout=20_000)
    assert ground.kind == "exit"
    assert not covered(ground, 0, 3)
    ground.press("r")
    assert covered(ground, 0, 0)
