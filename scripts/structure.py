"""Print how the package is built: its rooms, their imports, its sizes, the route of a load.

Usage: python scripts/structure.py [CHECKOUT]

A room is a folder or a loose module at the top of the package. Everything is read from the
sources, imports inside functions and for type checkers included; only the stops of
`babyrobot_levels.load` come from running it once, with the libraries of this Python.
The picture of ARCHITECTURE.md is made from it by `python scripts/renew.py`.
"""

from __future__ import annotations

import argparse
import ast
import json
import os
import statistics
import subprocess
import sys
import textwrap
import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from xml.sax.saxutils import escape

PACKAGE = "babyrobot_levels"
LEVEL = "final-maze"

DOORS = {"load": "library.catalogue", "solve": "analysis.solver.optimum", "validate": "cli.check"}
"""Modules whose functions much of the rest begins with."""

Graph = Mapping[str, Iterable[str]]


@dataclass(frozen=True)
class Structure:
    """The modules of the package in a checkout, by their names inside it."""

    checkout: Path

    @cached_property
    def modules(self) -> dict[str, Path]:
        """Each module's file. A folder is named like its `__init__`, the package `__init__`."""
        root = self.checkout / PACKAGE
        return {
            ".".join(path.relative_to(root).with_suffix("").parts).removesuffix(".__init__"): path
            for path in sorted(root.rglob("*.py"))
        }

    @cached_property
    def lines(self) -> dict[str, int]:
        """The number of lines of each module."""
        return {
            name: len(path.read_text("utf-8").splitlines()) for name, path in self.modules.items()
        }

    @cached_property
    def imports(self) -> dict[str, set[str]]:
        """The modules of the package that each one imports, wherever in its file."""
        return {name: self._imports(tree) - {name} for name, tree in self._trees().items()}

    @cached_property
    def needs(self) -> dict[str, set[str]]:
        """The same without what only type checkers import."""
        trees = {name: _Running().visit(tree) for name, tree in self._trees().items()}
        return {name: self._imports(tree) - {name} for name, tree in trees.items()}

    def reach(self, door: str) -> set[str]:
        """Return the modules that whoever changes a module has to know: all that it needs.

        The root is none of them: it imports a name when that is used.
        """
        found, waiting = set(), [door]
        while waiting:
            name = waiting.pop()
            if name not in found:
                found.add(name)
                waiting += self.needs[name] - {"__init__"}
        return found

    def _trees(self) -> dict[str, ast.Module]:
        return {name: ast.parse(path.read_text("utf-8")) for name, path in self.modules.items()}

    def _imports(self, tree: ast.AST) -> set[str]:
        named = (name for node in ast.walk(tree) for name in _imported(node))
        return {module for module in map(self._module, named) if module}

    def _module(self, name: str) -> str | None:
        """Return the module that `name` lies in, or None if it is not one of the package's."""
        first, _, inside = name.partition(".")
        if first != PACKAGE:
            return None
        while inside and inside not in self.modules:
            inside = inside.rpartition(".")[0]
        return inside or "__init__"

    @cached_property
    def rooms(self) -> dict[str, list[str]]:
        """The modules of each room. `__init__` and `__main__` belong to none."""
        rooms: dict[str, list[str]] = {}
        for name in self.modules:
            if name not in ("__init__", "__main__"):
                rooms.setdefault(room_of(name), []).append(name)
        return rooms

    @cached_property
    def arrows(self) -> dict[str, set[str]]:
        """The rooms that each room imports from."""
        found: dict[str, set[str]] = {room: set() for room in self.rooms}
        for name, targets in self.imports.items():
            if room_of(name) in self.rooms:
                found[room_of(name)] |= {room_of(each) for each in targets} & set(self.rooms)
        return {room: targets - {room} for room, targets in found.items()}

    @cached_property
    def floors(self) -> dict[str, int]:
        """The floor of each room, from 1: one above the highest room that it imports from.

        Rooms that import one another in a circle share a floor.
        """
        floors: dict[str, int] = {}
        for circle in components(self.arrows):
            below = {each for room in circle for each in self.arrows[room]} - set(circle)
            floor = 1 + max((floors[each] for each in below), default=0)
            floors |= dict.fromkeys(circle, floor)
        return floors

    @cached_property
    def circles(self) -> list[list[str]]:
        """The largest sets of modules that all import one another, directly or by others."""
        return [circle for circle in components(self.imports) if len(circle) > 1]

    @cached_property
    def order(self) -> list[list[str]]:
        """The rooms from the ground up, those without an order side by side.

        It is the one declared for import-linter, or else that of the floors.
        """
        project = tomllib.loads((self.checkout / "pyproject.toml").read_text("utf-8"))
        for contract in project["tool"].get("importlinter", {}).get("contracts", []):
            if contract["type"] == "layers":
                layers = [layer.replace("|", " ").split() for layer in contract["layers"]]
                return [layer for layer in reversed(layers) if layer != ["__main__"]]
        by_floor: dict[int, list[str]] = {}
        for room, floor in self.floors.items():
            by_floor.setdefault(floor, []).append(room)
        return [by_floor[floor] for floor in sorted(by_floor)]

    def stops(self) -> list[tuple[str, str]]:
        """Load a level and return each way in which one module calls another, in order."""
        environment = os.environ | {"PYTHONPATH": str(self.checkout)}
        done = subprocess.run(
            [sys.executable, "-c", _ROUTE.format(package=PACKAGE, level=LEVEL)],
            cwd=self.checkout,
            env=environment,
            capture_output=True,
            text=True,
            check=True,
        )
        names = {str(path.resolve()): name for name, path in self.modules.items()}
        return [(names[caller], names[called]) for caller, called in json.loads(done.stdout)]

    def climbs(self, stops: Iterable[tuple[str, str]]) -> list[tuple[str, str]]:
        """Return those of `stops` that go from a room to one above it."""
        rank = {room: number for number, layer in enumerate(self.order) for room in layer}
        rank["__init__"] = rank["__main__"] = len(rank)
        return [
            (caller, called)
            for caller, called in stops
            if rank[room_of(called)] > rank[room_of(caller)]
        ]


_ROUTE = """
import json, os, sys
import {package}

# Another level first: what is imported on the way is no part of it.
{package}.load("cliff-walking")
home = os.path.dirname(os.path.realpath({package}.__file__)) + os.sep
stops = {{}}

def counts(frame):
    # Not what tells of wrong calls around a function.
    code = frame.f_code
    return code.co_filename.startswith(home) and code.co_qualname != "telling.<locals>.checked"

def follow(frame, event, _):
    if event != "call" or not counts(frame):
        return
    caller = frame.f_back
    while caller and not counts(caller):
        caller = caller.f_back
    if caller and caller.f_code.co_filename != frame.f_code.co_filename:
        stops[caller.f_code.co_filename, frame.f_code.co_filename] = None

load = {package}.load
sys.setprofile(follow)
load({level!r})
sys.setprofile(None)
print(json.dumps(list(stops)))
"""


def room_of(module: str) -> str:
    """Return the room that a module lies in."""
    return module.partition(".")[0]


class _Running(ast.NodeTransformer):
    """Leaves out what is for type checkers alone."""

    def visit_If(self, node: ast.If) -> ast.AST:
        if "TYPE_CHECKING" in ast.unparse(node.test):
            node.body = [ast.Pass()]
        return self.generic_visit(node)


def _imported(node: ast.AST) -> list[str]:
    if isinstance(node, ast.Import):
        return [alias.name for alias in node.names]
    if isinstance(node, ast.ImportFrom):
        return [f"{node.module}.{alias.name}" for alias in node.names]
    return []


def components(graph: Graph) -> list[list[str]]:
    """Return the strongly connected components of a graph, each after those it leads to."""
    # Tarjan's algorithm. The graph is small enough for recursion.
    numbers: dict[str, int] = {}
    lowest: dict[str, int] = {}
    waiting: list[str] = []
    found: list[list[str]] = []

    def visit(node: str) -> None:
        numbers[node] = lowest[node] = len(numbers)
        waiting.append(node)
        for after in sorted(graph[node]):
            if after not in numbers:
                visit(after)
                lowest[node] = min(lowest[node], lowest[after])
            elif after in waiting:
                lowest[node] = min(lowest[node], numbers[after])
        if lowest[node] == numbers[node]:
            start = waiting.index(node)
            found.append(sorted(waiting[start:]))
            del waiting[start:]

    for node in graph:
        if node not in numbers:
            visit(node)
    return found


# -- the picture -----------------------------------------------------------------------------

HUES = [222, 258, 240, 204, 184, 160, 130, 112, 96, 82, 66, 44, 26, 8, 345, 322, 300, 284, 274, 264]
"""Of the rooms, from the ground up."""

LEFT, RIGHT, TOP = 20, 620, 88
GAP = 14
FIRST_COLUMN, COLUMN = 648, 25


@dataclass(frozen=True)
class Room:
    """A room as the picture shows it."""

    name: str
    text: str
    lines: int
    modules: int
    imports: frozenset[str]


def rooms_to_draw(structure: Structure) -> list[list[Room]]:
    """Return the rooms from the ground up, sizes to the nearest hundred lines."""
    return [[_room(structure, name) for name in layer] for layer in structure.order]


def _room(structure: Structure, name: str) -> Room:
    modules = structure.rooms[name]
    tree = ast.parse(structure.modules[name].read_text("utf-8"))
    return Room(
        name,
        (ast.get_docstring(tree) or "").split("\n\n")[0].replace("`", ""),
        round(sum(structure.lines[each] for each in modules), -2),
        len(modules),
        frozenset(structure.arrows[name]),
    )


def picture(layers: list[list[Room]]) -> str:
    """Return an SVG of the rooms, the first layer at the bottom.

    A vertical line leads into each room that others import. The horizontal line of a room that
    imports it meets that line in a dot.
    """
    rooms = [room for layer in reversed(layers) for room in layer]
    hues = {room.name: hue for room, hue in zip(reversed(rooms), HUES, strict=False)}
    imported = [room.name for room in rooms if any(room.name in each.imports for each in rooms)]
    columns = {name: FIRST_COLUMN + COLUMN * number for number, name in enumerate(imported)}
    tops: dict[str, float] = {}
    heights = {room.name: 34 + room.lines / 110 for room in rooms}
    y: float = TOP
    for room in rooms:
        tops[room.name] = y
        y += heights[room.name] + GAP
    # Where a room's own imports leave it, and where those of others enter it.
    leaves = {name: tops[name] + heights[name] - 13 for name in tops}
    enters = {name: tops[name] + 13 for name in tops}
    ways, lines, dots, boxes = [], [], [], []
    for room in rooms:
        hue, top, height = hues[room.name], tops[room.name], heights[room.name]
        color = f"hsl({hue}, 55%, 45%)"
        boxes.append(
            f'<rect x="{LEFT}" y="{top:.1f}" width="{RIGHT - LEFT}" height="{height:.1f}" rx="9" '
            f'fill="hsl({hue}, 60%, 96%)" stroke="hsl({hue}, 40%, 72%)"/>'
            f'<rect x="{LEFT}" y="{top:.1f}" width="9" height="{height:.1f}" rx="4.5" '
            f'fill="{color}"/>'
        )
        middle = top + height / 2
        boxes.append(
            f'<text class="name" x="{LEFT + 24}" y="{middle + 6:.1f}">{escape(room.name)}</text>'
        )
        rows = _wrapped(room.text)
        for number, row in enumerate(rows):
            at = middle + 4.5 + 17 * (number - (len(rows) - 1) / 2)
            boxes.append(f'<text x="{LEFT + 128}" y="{at:.1f}">{escape(row)}</text>')
        boxes.append(
            f'<text class="size" x="{RIGHT - 16}" y="{middle + 4:.1f}">{room.lines:,}</text>'
        )
        if room.imports:
            end = max(columns[each] for each in room.imports)
            ways.append(f'<path d="M{RIGHT} {leaves[room.name]:.1f}H{end}" class="way"/>')
        if room.name in columns:
            importers = [each.name for each in rooms if room.name in each.imports]
            x, bottom = columns[room.name], enters[room.name]
            start = min(leaves[name] for name in importers)
            lines.append(
                f'<path d="M{x} {start:.1f}V{bottom - 8:.1f}q0 8-8 8H{RIGHT + 8}" stroke="{color}" '
                'class="line"/>'
                f'<path d="M{RIGHT + 1.5} {bottom:.1f}l9-4.5v9z" fill="{color}"/>'
            )
            dots += [
                f'<circle cx="{x}" cy="{leaves[name]:.1f}" r="4.5" fill="{color}"/>'
                for name in importers
            ]
    head = (
        f'<text class="name" x="{LEFT}" y="32">The rooms of {PACKAGE}</text>'
        f'<text x="{LEFT}" y="55">Each imports only rooms below it: a dot on its line is an '
        "import from the room that the arrow enters.</text>"
        f'<text class="size" x="{RIGHT - 16}" y="{TOP - 9}">lines of code</text>'
    )
    drawn = "\n".join([head, *ways, *lines, *dots, *boxes])
    width = max(columns.values(), default=RIGHT) + LEFT
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {y + 6:.0f}" '
        f'width="{width}">\n'
        "<style>text{font:14px system-ui,'DejaVu Sans',sans-serif;fill:#39414d}"
        ".name{font-size:17px;font-weight:600;fill:#161b22}"
        ".size{font-size:12.5px;fill:#6b7480;text-anchor:end}"
        ".way{stroke:#c3c9d1;stroke-width:1.2;fill:none}"
        ".line{stroke-width:2;fill:none}</style>\n"
        f'<rect width="100%" height="100%" fill="#fff"/>\n{drawn}\n</svg>\n'
    )


def _wrapped(text: str, width: int = 54) -> list[str]:
    return textwrap.wrap(text, width)


def main() -> None:
    """Print the structure of a checkout."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument(
        "checkout", nargs="?", type=Path, default=Path(__file__).resolve().parents[1]
    )
    options = parser.parse_args()
    structure = Structure(options.checkout.resolve())
    stops = structure.stops()
    climbs = structure.climbs(stops)
    rows: dict[str, object] = {
        "rooms": len(structure.rooms),
        "floors": max(structure.floors.values()),
        "arrows between rooms": sum(map(len, structure.arrows.values())),
        "imports between modules": sum(map(len, structure.imports.values())),
        "circles": len(structure.circles),
        "modules in circles": sum(map(len, structure.circles)),
        "modules": len(structure.modules),
        "lines": sum(structure.lines.values()),
        "median lines of a module": statistics.median(structure.lines.values()),
        "stops of load": len(stops),
        "modules on the way": len({each for stop in stops for each in stop}),
        "climbs": len(climbs),
    }
    for text, number in rows.items():
        print(f"{text:26}{number:>8,}")
    for what, door in DOORS.items():
        known = structure.reach(door)
        lines = sum(structure.lines[each] for each in known)
        print(f"{what + ' reaches':26}{len(known):>8,} modules, {lines:,} lines")
    for circle in structure.circles:
        print("circle:", ", ".join(circle))
    for caller, called in stops:
        print("climb:" if (caller, called) in climbs else "stop: ", f"{caller} -> {called}")


if __name__ == "__main__":
    main()
