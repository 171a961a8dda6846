"""A page of a level, open in a browser: pressed keys, and what is seen then."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

from playwright.sync_api import Page, expect

from babyrobot_levels.analysis.solver.optimum import solve
from babyrobot_levels.library.level import Level
from babyrobot_levels.render.page import Guide, to_html
from babyrobot_levels.render.scene.layout import Overlay

KEYS = [" ", "ArrowUp", "ArrowRight", "ArrowDown", "ArrowLeft"]
"""The keys of the actions."""


FAST = {"robot": {"speed": 100}}
"""A robot that is not waited for."""


def level(**fields: Any) -> Any:
    """Return a level whose robot is fast."""
    return Level.from_fields({"version": 1, "display": FAST, **fields})


def guide(world: Any, actions: str = "all") -> Guide:
    """Return the solution of a level as a page shows it: also where it differs by states."""
    solution = solve(world, actions=actions)
    policy = solution.policy.ravel().tolist()
    parts = None
    if world.has_things or actions == "turns":

        def parts(configuration: int | None, heading: int | None) -> Overlay:
            part = solution.at(configuration or 0, "NESW"[heading] if heading is not None else None)
            return _overlay(part)

    return Guide(policy, replace(_overlay(solution), parts=parts), solution.expected_return)


def _overlay(solution: Any) -> Overlay:
    values, policy = solution.values, solution.policy
    if values.ndim > 2:
        return Overlay()
    actions = [[() if best < 0 else (best,) for best in row] for row in policy.tolist()]
    shown = [[None if math.isnan(value) else value for value in row] for row in values.tolist()]
    return Overlay(values=shown, actions=actions)


class Playground:
    """A page of a level that is open in the browser."""

    def __init__(self, page: Page, folder: Path, has_scripts: bool = True) -> None:
        self.page, self._path, self.has_scripts = page, folder / "page.html", has_scripts
        self.faults: list[str] = []
        page.on("console", lambda message: self.faults.append(message.text))
        page.on("pageerror", lambda error: self.faults.append(str(error)))
        page.on("request", lambda request: self._note(request.url))

    def _note(self, address: str) -> None:
        if not address.startswith(("file:", "data:", "blob:")):
            self.faults.append(f"asks for {address}")

    def open(self, world: Any, **options: Any) -> None:
        self._path.write_text(to_html(world, **options), encoding="utf-8")
        self.page.goto(self.address)
        if self.has_scripts:
            self.page.wait_for_selector("body.ready")

    def follow(self, fragment: str) -> None:
        """Open a link to the page, and wait until its level is there, or what is wrong with it."""
        self.page.goto("about:blank")
        self.page.goto(f"{self.address}#{fragment}")
        self.page.wait_for_selector("body.ready")

    @property
    def address(self) -> str:
        return self._path.as_uri()

    def press(self, *keys: str) -> None:
        for key in keys:
            self.page.keyboard.press(key)

    @property
    def state(self) -> int:
        return int(self.page.locator("#robot").get_attribute("data-state") or -1)

    @property
    def message(self) -> str:
        return self.page.locator("#message").inner_text()

    @property
    def kind(self) -> str | None:
        return self.page.locator("#message").get_attribute("data-kind")

    def number(self, name: str) -> float:
        return float(self.page.locator(f"#{name}").inner_text().replace("\N{MINUS SIGN}", "-"))

    @property
    def corner(self) -> tuple[float, float]:
        """The place of the robot, in cells."""
        left, top = self.page.evaluate(
            "() => { const m = document.querySelector('#robot').transform.baseVal[0].matrix;"
            " return [m.e, m.f] }"
        )
        margin = 3  # That of the theme: half of the border, rounded up.
        return (left - margin) / 64, (top - margin) / 64

    def wait_until_there(self) -> None:
        x, y = self.state % 4, self.state // 4
        left, top = 64 * x + 3, 64 * y + 3
        place = f"translate({left:.2f} {top:.2f})"
        expect(self.page.locator("#robot")).to_have_attribute("transform", place)

    def wait_until_still(self) -> None:
        """Wait until nothing moves any more."""
        self.page.wait_for_function("() => picture.running === null")
