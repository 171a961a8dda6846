"""What people do at the editor with a mouse, with keys, and with fingers."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, ClassVar

from playwright.sync_api import Locator

from babyrobot_levels.library.level import Level
from babyrobot_levels.render.scene.layout import CELL
from support.editors import EditorPage

Point = tuple[float, float]

SIDES: dict[str, Point] = {"N": (0.5, 0), "E": (1, 0.5), "S": (0.5, 1), "W": (0, 0.5)}
"""Where the middles of a cell's sides are in it."""

TOOL_KEYS = {"walls": "1", "small": "2", "large": "3", "select": "9", "stamp": "C"}


class Hand(ABC):
    """Draws in one editor."""

    context: ClassVar[dict[str, Any]] = {}
    """Options of the browser's context in which it draws."""

    def __init__(self, editor: EditorPage) -> None:
        self.editor = editor
        self.page = editor.page

    @property
    def level(self) -> Level:
        """The level at hand."""
        level = self.editor.session.level
        assert level is not None
        return level

    @property
    def size(self) -> tuple[int, int]:
        """Its columns and rows."""
        return self.level.size

    @contextmanager
    def changing(self) -> Iterator[None]:
        """Wait until what is done inside has changed the level, and the picture shows it."""
        revision = self.editor.session.revision
        yield
        self.page.wait_for_function(SHOWS, arg=revision)

    @abstractmethod
    def resize(self, columns: int, rows: int) -> None:
        """Give the level more columns at the right and more rows below."""

    @abstractmethod
    def choose(self, tool: str) -> None:
        """Choose a tool."""

    @abstractmethod
    def draw_wall(self, at: tuple[int, int], side: str, length: int = 1) -> None:
        """Draw along the sides of cells with the tool of walls."""

    @abstractmethod
    def paint(self, *cells: tuple[int, int]) -> None:
        """Use the tool in each of some cells."""

    @abstractmethod
    def copy(self, one: tuple[int, int], other: tuple[int, int]) -> None:
        """Copy the rectangle between two cells."""

    @abstractmethod
    def move(self, cell: tuple[int, int], target: tuple[int, int]) -> None:
        """Drag what stands in a cell to another one."""


class Pointing(Hand):
    """What a mouse and a finger have in common: they point at places of the picture."""

    @abstractmethod
    def drag(self, *points: Point) -> None:
        """Press at the first point of the window, move through the others, and release."""

    @abstractmethod
    def press(self, place: Locator) -> None:
        """Press a button."""

    def at(self, x: float, y: float) -> Point:
        """Return where a point of the grid, in cells, is in the window."""
        svg = self.page.locator(".stage > svg")
        box = svg.bounding_box()
        assert box is not None
        wide = float((svg.get_attribute("viewBox") or "").split()[2])
        margin = (wide - self.size[0] * CELL) / 2
        scale = box["width"] / wide
        return box["x"] + (margin + CELL * x) * scale, box["y"] + (margin + CELL * y) * scale

    def choose(self, tool: str) -> None:
        sheet = self.page.locator(".tool-sheet")
        if sheet.is_visible():
            self.press(sheet)
        self.press(self.page.locator(f"[data-tool={tool}]"))

    def draw_wall(self, at: tuple[int, int], side: str, length: int = 1) -> None:
        dx, dy = SIDES[side]
        x, y = at[0] + dx, at[1] + dy
        along = (length - 1, 0) if side in "NS" else (0, length - 1)
        with self.changing():
            self.drag(self.at(x, y), self.at(x + along[0], y + along[1]))

    def paint(self, *cells: tuple[int, int]) -> None:
        for x, y in cells:
            with self.changing():
                self.drag(self.at(x + 0.5, y + 0.5))

    def copy(self, one: tuple[int, int], other: tuple[int, int]) -> None:
        self.choose("stamp")
        self.drag(*(self.at(x + 0.5, y + 0.5) for x, y in (one, other)))
        self.page.wait_for_function(SAYS, arg="Copied")

    def move(self, cell: tuple[int, int], target: tuple[int, int]) -> None:
        with self.changing():
            self.drag(*(self.at(x + 0.5, y + 0.5) for x, y in (cell, target)))

    def resize(self, columns: int, rows: int) -> None:
        """Drag the handle at the lower right corner, again where the window ends before."""
        window = self.page.viewport_size
        assert window is not None
        while self.size != (columns, rows):
            box = self.page.locator("[data-handle=size][data-way='1 1']").bounding_box()
            assert box is not None
            x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
            wide = self.at(1, 0)[0] - self.at(0, 0)[0]
            to = (
                min(x + wide * (columns - self.size[0]), window["width"] - 1),
                min(y + wide * (rows - self.size[1]), window["height"] - 1),
            )
            with self.changing():
                self.drag((x, y), to)


class Mouse(Pointing):
    """A mouse."""

    def drag(self, *points: Point) -> None:
        mouse = self.page.mouse
        mouse.move(*points[0])
        mouse.down()
        for point in points[1:]:
            mouse.move(*point, steps=5)
        mouse.up()

    def press(self, place: Locator) -> None:
        place.click()


class Finger(Pointing):
    """A finger on the screen of a phone."""

    context: ClassVar[dict[str, Any]] = {
        "viewport": {"width": 390, "height": 844},
        "has_touch": True,
        "is_mobile": True,
    }

    def __init__(self, editor: EditorPage) -> None:
        super().__init__(editor)
        self.touches = self.page.context.new_cdp_session(self.page)

    def touch(self, kind: str, *points: Point) -> None:
        """Send an event of the screen: where fingers are now."""
        fingers = [{"x": x, "y": y, "id": number} for number, (x, y) in enumerate(points)]
        self.touches.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": fingers})

    def drag(self, *points: Point) -> None:
        before = points[0]
        self.touch("touchStart", before)
        for after in points[1:]:
            for part in (0.25, 0.5, 0.75, 1):
                x, y = (a + part * (b - a) for a, b in zip(before, after, strict=True))
                self.touch("touchMove", (x, y))
            before = after
        self.touch("touchEnd")

    def press(self, place: Locator) -> None:
        place.tap()


class Keys(Hand):
    """A keyboard."""

    def __init__(self, editor: EditorPage) -> None:
        super().__init__(editor)
        self.cursor = (0, 0)

    def type(self, *keys: str) -> None:
        """Press keys, one after the other."""
        for key in keys:
            self.page.keyboard.press(key)

    def go(self, cell: tuple[int, int]) -> None:
        """Move the cursor to a cell."""
        (x, y), (left, top) = cell, self.cursor
        self.type(*["ArrowRight" if x > left else "ArrowLeft"] * abs(x - left))
        self.type(*["ArrowDown" if y > top else "ArrowUp"] * abs(y - top))
        self.cursor = cell

    def resize(self, columns: int, rows: int) -> None:
        for key, count in (
            ("Alt+ArrowRight", columns - self.size[0]),
            ("Alt+ArrowDown", rows - self.size[1]),
        ):
            for _ in range(count):
                with self.changing():
                    self.type(key)

    def choose(self, tool: str) -> None:
        self.type(TOOL_KEYS[tool])

    def draw_wall(self, at: tuple[int, int], side: str, length: int = 1) -> None:
        self.go(at)
        x, y = at
        if length > 1:
            self.type("m")
            self.go((x + length - 1, y) if side in "NS" else (x, y + length - 1))
        arrows = {"N": "Up", "E": "Right", "S": "Down", "W": "Left"}
        with self.changing():
            self.type(f"Shift+Arrow{arrows[side]}")

    def paint(self, *cells: tuple[int, int]) -> None:
        for cell in cells:
            self.go(cell)
            with self.changing():
                self.type("Space")

    def copy(self, one: tuple[int, int], other: tuple[int, int]) -> None:
        self.choose("stamp")
        self.go(one)
        self.type("m")
        self.go(other)
        self.type("Space")
        self.page.wait_for_function(SAYS, arg="Copied")

    def move(self, cell: tuple[int, int], target: tuple[int, int]) -> None:
        self.choose("select")
        self.go(cell)
        self.type("m")
        self.go(target)
        with self.changing():
            self.type("Space")


SHOWS = """(revision) =>
  Number(document.querySelector('#editor').shadowRoot.querySelector('.editor').dataset.revision)
    > revision"""

SAYS = """(words) =>
  document.querySelector('#editor').shadowRoot.querySelector('.said').innerText.startsWith(words)"""
