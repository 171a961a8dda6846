"""Files that ask for too much: each as large as a level file may be, or nearly."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator

MIB = 1 << 20
HUGE = "size: [1024, 1024]\n"


def level(text: str) -> bytes:
    """Return a level of the language's version 1."""
    return b"version: 1\n" + text.encode()


def entries(field: str, entry: str, count: int, before: str = "") -> bytes:
    """Return a level with a list of the same entry, `count` times."""
    return level(f"{before}{field}:\n" + f"- {entry}\n" * count)


def listed(field: str, values: Iterable[str], before: str = "") -> bytes:
    """Return a level with a list of entries."""
    return level(f"{before}{field}:\n" + "".join(f"- {value}\n" for value in values))


def cell(number: int) -> str:
    """Return a cell of the largest grid, counted row by row from below the first row."""
    return f"[{number % 1024}, {number // 1024 + 1}]"


def cells(count: int) -> str:
    """Return a list of cells, the first row's first."""
    return "[" + ",".join(cell(number - 1024) for number in range(count)) + "]"


def drawing(
    width: int, height: int, mark: Callable[[int, int], str], wall: str = " ", floor: str = "   "
) -> bytes:
    """Return a level that is drawn, with the same wall between all cells."""
    lines = []
    for y in range(height):
        lines.append("+" + "+".join(["---" if y == 0 else floor] * width) + "+")
        lines.append("|" + wall.join(f" {mark(x, y)} " for x in range(width)) + "|")
    lines.append("+" + "+".join(["---"] * width) + "+")
    return level("map: |\n" + "".join(f"  {line}\n" for line in lines))


def start_and(other: str) -> Callable[[int, int], str]:
    """Return marks with a start in the corner, and something else everywhere."""
    return lambda x, y: "S" if x == y == 0 else other


def on_grid(width: int, number: int) -> str:
    """Return a cell of a grid of some width, counted row by row."""
    return f"[{number % width}, {number // width}]"


def named(width: int, count: int, first: int = 1) -> Iterator[str]:
    """Return entries of items or switches in the first cells of a grid of some width."""
    return (f"{{name: i{n}, at: {on_grid(width, n)}}}" for n in range(first, first + count))


def pairs_of_cells(count: int) -> Iterator[str]:
    """Return movers that walk at random, each between two cells."""
    return (f"{{within: {{at: [{2 * n}, 1], size: [2, 1]}}}}" for n in range(count))


def bomb() -> bytes:
    """Return aliases of aliases: 4 to the power of 20 values."""
    lines = ["a: &a [x, x]"]
    for number in range(20):
        this, before = chr(98 + number), chr(97 + number)
        lines.append(f"{this}: &{this} [*{before}, *{before}, *{before}, *{before}]")
    return "\n".join(lines).encode()


def warps(goals: Callable[[int], int], count: int, before: str = HUGE) -> bytes:
    """Return a level of warps, each given by where it leads."""
    values = (f"{{at: {cell(n)}, to: {cell(goals(n))}}}" for n in range(count))
    return listed("warps", values, before)


BROKEN: dict[str, tuple[str, Callable[[], bytes]]] = {
    # The bytes.
    "binary": ("BR102", lambda: bytes(range(256)) * 4000),
    "two MiB": ("BR103", lambda: b"a" * (2 * MIB)),
    # Depth.
    "brackets": ("BR109", lambda: b"[" * 100_000),
    "dashes": ("BR109", lambda: b"- " * 100_000),
    "steps": ("BR109", lambda: "".join(" " * n + "a:\n" for n in range(1440)).encode()),
    # Tags and aliases.
    "tag directives": (
        "BR107",
        lambda: "".join(f"%TAG !a{n}! x\n" for n in range(60_000)).encode() + b"--- x\n",
    ),
    "a bomb of aliases": ("BR108", bomb),
    "anchors": ("BR108", lambda: level("tags: [" + "&a x, " * 90_000 + "*b]")),
    # Numbers and words.
    "numbers": ("BR111", lambda: level("start: [" + ", ".join(["9" * 5000] * 200) + "]")),
    "a hexadecimal number": ("BR111", lambda: level("max_steps: 0x" + "f" * MIB)[:MIB]),
    "a long colour": (
        "BR205",
        lambda: level("areas: [{at: [0, 0], color: 'rgb(" + " " * 900_000 + "'}]"),
    ),
    "a long name": ("BR205", lambda: level("name: " + "a-" * 500_000 + "!\n")),
    # Length.
    "a long line": ("BR201", lambda: level("title: " + "x" * (MIB - 100) + "\nfoo: 1\n")),
    "comments": ("BR202", lambda: b"# x\n" * (MIB // 4 - 3) + b"size: 1\n"),
    "line ends": ("BR201", lambda: b"version: 1" + b"\r" * (MIB - 20) + b"foo: 1\r"),
    "an open list": ("BR104", lambda: level("title: [" + "x, " * 45_000)),
    "documents": ("BR106", lambda: b"---\n" * 200_000),
    # Many values.
    "keys": ("BR108", lambda: "".join(f"k{n}: \n" for n in range(100_000)).encode()[:MIB]),
    "the same key": ("BR105", lambda: level("a: 1\n" * 49_000)),
    "unknown fields": ("BR201", lambda: level("".join(f"fiel{n}: 1\n" for n in range(49_000)))),
    "tags": ("BR207", lambda: level("tags: [" + "A," * 90_000 + "]")),
    # Geometry.
    "starts on blocked cells": (
        "BR302",
        lambda: (
            entries("blocked", "{at: [0, 0], size: [9, 1024]}", 1800, HUGE)
            + f"exit: none\nstart: {cells(25_000)}\n".encode()
        ),
    ),
    "exits on one cell": ("BR305", lambda: level(HUGE + "exit: [" + "[9,9]," * 33_000 + "]")),
    "areas over all": (
        "BR205",
        lambda: entries("areas", "{at: [0, 0], size: [1024, 1024]}", 9_000, HUGE),
    ),
    "warps in one circle": ("BR308", lambda: warps(lambda n: (n + 1) % 10_000, 10_000)),
    "starts on warps": (
        "BR309",
        lambda: warps(
            lambda n: 900_000,
            7_000,
            HUGE + "start: [" + ",".join(cell(n) for n in range(6_999, -1, -1)) + "]\n",
        ),
    ),
    # Things.
    "11,000 items": ("BR404", lambda: listed("items", named(123, 11_000), "size: [123, 123]\n")),
    "items in any order": (
        "BR404",
        lambda: listed("items", named(5, 24), "size: [5, 5]\nexit: none\n"),
    ),
    "12 items and a mover": (
        "BR404",
        lambda: (
            listed("items", named(30, 12, 91), "size: [30, 30]\n")
            + b"movers: [{within: {at: [0, 8], size: [4, 2]}, start: [0, 8]}]\n"
        ),
    ),
    "an item in many cells": (
        "BR404",
        lambda: level(
            "size: [200, 200]\nitems:\n- {name: key, one_of: ["
            + ",".join(on_grid(200, n) for n in range(1, 30_000))
            + "]}\n"
        ),
    ),
    "7 movers": ("BR405", lambda: listed("movers", pairs_of_cells(7), "size: [20, 3]\n")),
    "movers in large rectangles": (
        "BR205",
        lambda: entries("movers", "{within: {at: [0, 0], size: [64, 64]}}", 9_000, HUGE),
    ),
    "names of nothing": (
        "BR321",
        lambda: (
            listed("items", named(123, 5_000), "size: [123, 123]\n")
            + f"exit_needs: [{', '.join(f'j{n}' for n in range(40_000))}]\n".encode()
        ),
    ),
    "long doors": (
        "BR322",
        lambda: entries("doors", "{at: [0, 0], side: S, length: 1024}", 10_000, HUGE),
    ),
    "drawn items on warps": (
        "BR318",
        lambda: (
            drawing(250, 250, start_and("k"))
            + b"legend: {k: {item: key}}\nwarps:\n"
            + "".join(
                f"- {{at: {on_grid(250, n)}, to: [0, 0]}}\n" for n in range(1, 7_000)
            ).encode()
        ),
    ),
    # Drawings.
    "a drawing that is cut off": ("BR312", lambda: drawing(1024, 1024, start_and(" "))[: MIB - 5]),
    "a drawing of one row": (
        "BR312",
        lambda: level("map: |\n  " + "+---" * 130_000 + "\n  " + "|   " * 130_000 + "\n"),
    ),
    "letters that nobody knows": ("BR312", lambda: drawing(360, 360, lambda x, y: "Q")),
    "walls that are not drawn": (
        "BR314",
        lambda: (
            drawing(250, 250, start_and(" "))
            + b"walls:\n"
            + b"- {at: [0, 0], side: S, length: 250, pass: 0.5}\n" * 8000
        ),
    ),
}
"""Files with faults: one that must be told, and the file."""

VALID: dict[str, Callable[[], bytes]] = {
    "many areas, many starts": lambda: (
        entries("areas", "{at: [1023, 1023], ends: true}", 7_000, HUGE)
        + f"exit: none\nstart: {cells(16_000)}\n".encode()
    ),
    "drawn areas, drawn starts": lambda: (
        drawing(350, 350, lambda x, y: "a" if (x + y) % 2 else "S")
        + b"legend: {a: {ends: false}}\n"
    ),
    "narrow blocked columns": lambda: entries(
        "blocked", "{at: [5, 5], size: [1, 1000]}", 11_000, HUGE
    ),
    "a chain of warps, last first": lambda: warps(lambda n: n - 1, 10_000),
    "long walls": lambda: entries("walls", "{at: [1, 0], side: E, length: 1024}", 11_000, HUGE),
    "walls and puddles": lambda: drawing(360, 360, start_and("o"), "|", "---"),
    "13,000 doors": lambda: listed(
        "doors",
        (f"{{at: {on_grid(200, n)}, side: S}}" for n in range(13_000)),
        "size: [200, 200]\n",
    ),
    "16,000 movers that stand still": lambda: entries("movers", "{path: [[1, 1]]}", 16_000),
    "items in a corridor": lambda: listed("items", named(400, 390), "size: [400, 1]\n"),
}
"""Files that are levels, and large."""
