"""Sixty valid levels, or nearly, each of which asks for as much as it can of something."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator
from typing import Any

from support.hostile import VALID, drawing, entries, level, start_and

HUGE = [1024, 1024]
Fields = dict[str, Any]


def grid(columns: int, rows: int | None = None, **fields: Any) -> Callable[[], bytes]:
    """Return what makes a level of so many cells."""
    data = {"version": 1, "size": [columns, rows or columns], **fields}
    return lambda: json.dumps(data).encode()


def cell(width: int, number: int) -> list[int]:
    """Return a cell of a grid of some width, counted row by row."""
    return [number % width, number // width]


def chain(numbers: range, **more: Any) -> list[Fields]:
    """Return warps in a grid 100 wide, each of which leads to the next cell of those given."""
    return [{"at": cell(100, n), "to": cell(100, n + numbers.step), **more} for n in numbers]


def keys(width: int, count: int, first: int = 1) -> list[Fields]:
    """Return items, one a cell."""
    return [{"name": f"i{n}", "at": cell(width, n)} for n in range(first, first + count)]


def doors(count: int, needs: Callable[[int], list[str]]) -> list[Fields]:
    """Return doors in a corridor, each behind the item of its number."""
    return [{"at": [n, 0], "side": "E", "needs": needs(n)} for n in range(1, count + 1)]


def wanderer(columns: int, rows: int | None = None, at: tuple[int, int] = (0, 0)) -> Fields:
    """Return a mover that walks at random in a rectangle."""
    return {"within": {"at": [*at], "size": [columns, rows or columns]}}


def guard(length: int, row: int) -> Fields:
    """Return a mover on a path with so many places in turn."""
    there = [[x, row] for x in range(length // 2 + 1)]
    back = there[-2:0:-1] if length % 2 == 0 else there[-1:0:-1]
    return {"path": [*there, *back]}


def aliases(field: str, entry: str, count: int, before: str) -> bytes:
    """Return a level with one entry and aliases of it."""
    return level(f"{before}{field}:\n- &a {entry}\n" + "- *a\n" * count)


def scattered(width: int, height: int, count: int) -> Iterable[list[int]]:
    """Return cells without the corners, far from each other."""
    inner = (width * height - 2) // count
    return (cell(width, 1 + n * inner) for n in range(count))


def _worst() -> Iterator[tuple[str, Callable[[], bytes]]]:
    # Chains.
    for count in (1_000, 2_000, 9_997):
        yield f"{count:,} warps in a chain", grid(100, warps=chain(range(1, 1 + count)))
    yield "9,997 warps, last first", grid(100, warps=chain(range(9_998, 1, -1)))
    yield "9,000 warps on leaving", grid(100, warps=chain(range(1, 9_001), when="leave"))
    yield "10,000 warps in 1024x1024", VALID["a chain of warps, last first"]
    yield "390 items in a corridor", VALID["items in a corridor"]
    yield (
        "300 doors, a key each",
        grid(602, 1, items=keys(602, 300), doors=doors(300, lambda n: [f"i{n}"])),
    )
    yield (
        "300 doors that need all keys so far",
        grid(
            302,
            1,
            items=keys(302, 300),
            doors=doors(300, lambda n: [f"i{k}" for k in range(1, n + 1)]),
        ),
    )
    yield (
        "13 switches",
        grid(10, switches=[{"name": f"s{n}", "at": cell(10, 7 * n + 3)} for n in range(13)]),
    )
    yield (
        "300 needs of the exit",
        grid(302, 1, items=keys(302, 300), exit_needs=[f"i{n}" for n in range(1, 301)]),
    )
    # Aliases.
    whole = "{at: [0, 0], size: [1024, 1024], reward: -2, skid: 0.1}"
    yield (
        "15 aliases of an area over 1024x1024",
        lambda: aliases("areas", whole, 15, "size: [1024, 1024]\n"),
    )
    yield (
        "11,000 aliases of a wall",
        lambda: aliases(
            "walls", "{at: [9, 0], side: E, length: 1000}", 11_000, "size: [1024, 1024]\n"
        ),
    )
    yield "11,000 blocked columns", VALID["narrow blocked columns"]
    # Products.
    yield "a mover in 30x30", grid(30, movers=[wanderer(30)])
    yield "a mover in 20x20 with skids", grid(20, movers=[wanderer(20)], skid=0.2)
    yield "two movers in 6x6", grid(6, movers=[wanderer(6), wanderer(6)])
    yield (
        "three movers in 2x2, in 40x40",
        grid(40, movers=[wanderer(2, 2, (4 * n, 9)) for n in range(3)]),
    )
    yield (
        "guards on paths of 7, 11 and 13",
        grid(40, movers=[guard(length, row) for row, length in enumerate((7, 11, 13), 2)]),
    )
    yield "10,000 movers that stand still", grid(99, movers=[{"path": [[9, 9]]}] * 10_000)
    yield "15 items in 8x4", grid(8, 4, items=keys(8, 15))
    yield (
        "9 items in one of 2 places",
        grid(
            8,
            items=[
                {"name": f"i{n}", "one_of": [cell(8, 3 * n + 1), cell(8, 3 * n + 2)]}
                for n in range(9)
            ],
        ),
    )
    yield "1,024 drawn exits in 44x44", grid(44, exit_one_of=[cell(44, n) for n in range(1, 1025)])
    yield (
        "an item in one of 190 cells",
        grid(100, items=[{"name": "key", "one_of": [cell(100, 9 + 17 * n) for n in range(190)]}]),
    )
    # Doors, walls, ends.
    yield "a door of 1,024 sides", grid(1024, doors=[{"at": [0, 0], "side": "E", "length": 1024}])
    yield (
        "500 doors of 1,000 sides",
        grid(1024, doors=[{"at": [2 * n, 0], "side": "E", "length": 1000} for n in range(500)]),
    )
    yield "13,000 doors", VALID["13,000 doors"]
    yield (
        "200 starts of a warp",
        grid(200, 100, start=[[n, 1] for n in range(200)], warps=[{"at": [5, 5], "to": "start"}]),
    )
    yield ("16,000 starts", grid(1024, start=[*scattered(1024, 1024, 16_000)]))
    yield (
        "16,000 starts and 16,000 exits",
        grid(
            1024,
            start=[cell(1024, n) for n in range(16_000)],
            exit=[cell(1024, n) for n in range(500_000, 516_000)],
        ),
    )
    yield (
        "16,000 exits, and shaping",
        grid(1024, exit=[*scattered(1024, 1024, 16_000)], rewards={"closer": 1, "farther": -2}),
    )
    # Chance.
    yield "a maze of 1024x1024 with skids", grid(1024, maze={"seed": 1}, skid=0.2)
    yield "1024x1024", grid(1024)
    yield "1024x1024 with wind", grid(1024, wind={"north": [1023] * 1024})
    yield "512x512 with skids", grid(512, skid={"probability": 0.3, "to": "sides"})
    yield (
        "a maze of 600x600 that takes a walk",
        grid(600, maze={"seed": 1, "algorithm": "aldous-broder"}),
    )
    yield "glass and puddles, drawn", lambda: drawing(330, 330, start_and("o"), ":", "---")
    yield "a corridor that leads back", grid(60, 1, skid={"probability": 0.9, "to": "others"})
    # Numbers.
    yield "rewards that do not add up", grid(9, skid=0.5, rewards={"step": -1e308, "exit": 1e308})
    yield "9,000,000 steps of 4,900 cells", grid(70, skid=0.3, max_steps=9_000_000)
    yield (
        "9,000 areas with labels",
        lambda: entries(
            "areas", "{at: [5, 5], label: xxxxxxxxxx, reward: -3}", 9_000, "size: [99, 99]\n"
        ),
    )
    yield from _worst_of_several_robots()
    yield from _worst_of_boxes()
    yield from _worst_of_chances()
    yield from _worst_of_texts()


def robots(count: int, side: int, **fields: Any) -> Callable[[], bytes]:
    """Return what makes a square with so many robots in the first row."""
    team = [{"name": f"r{n}", "start": [n, 0]} for n in range(count)]
    return grid(side, robots=team, **fields)


def _worst_of_several_robots() -> Iterator[tuple[str, Callable[[], bytes]]]:
    yield "two robots in 13x13", robots(2, 13)
    yield "two robots in 8x8 with skids", robots(2, 8, skid={"probability": 0.3, "to": "sides"})
    yield "two robots in 100x100", robots(2, 100)
    yield "three robots in 4x4", robots(3, 4, team={"meet": "pass"})
    yield (
        "four robots in 4x2",
        grid(4, 2, robots=[{"name": f"r{n}", "start": [n, 0], "exit": [n, 1]} for n in range(4)]),
    )
    yield (
        "two robots, 4 items and a mover",
        robots(2, 6, items=keys(6, 4, 20), movers=[wanderer(2, 1, (3, 4))]),
    )


def _worst_of_boxes() -> Iterator[tuple[str, Callable[[], bytes]]]:
    def boxes(side: int, count: int, **fields: Any) -> Callable[[], bytes]:
        places = [{"at": [1 + n % (side - 2), 1 + n // (side - 2)]} for n in range(count)]
        goals = [{"at": [n, side - 1]} for n in range(count)]
        return grid(side, boxes=places, targets=goals, **fields)

    yield "a box in 38x38", boxes(38, 1)
    yield "three boxes in 8x8", boxes(8, 3)
    yield "two boxes in 9x9 with skids", boxes(9, 2, skid={"probability": 0.3, "to": "sides"})
    yield "100 boxes in 128x128", boxes(128, 100)


def _worst_of_chances() -> Iterator[tuple[str, Callable[[], bytes]]]:
    yield (
        "16,000 weighted starts",
        grid(
            1024,
            start=[*scattered(1024, 1024, 16_000)],
            start_weights=[1 + n % 100 for n in range(16_000)],
        ),
    )
    yield (
        "1,000 warps by chance in a chain",
        grid(100, warps=chain(range(1, 1_001), probability=0.999)),
    )
    yield (
        "a warp to 200 weighted cells",
        grid(
            70,
            warps=[
                {
                    "at": [5, 5],
                    "to": [cell(70, 17 * n) for n in range(25, 225)],
                    "weights": [1 + n % 100 for n in range(200)],
                }
            ],
        ),
    )
    yield (
        "512x512 with varying wind",
        grid(512, wind={"north": [3] * 512, "east": [2] * 512, "probability": 0.5, "varies": True}),
    )
    yield (
        "300x300 with skids in varying wind",
        grid(300, skid=0.3, wind={"north": [1023] * 300, "east": [9] * 300, "varies": True}),
    )
    yield (
        "16,000 exits that pay their areas",
        grid(
            1024,
            exit=[*scattered(1024, 1024, 16_000)],
            rewards={"exit": "cell"},
            areas=[{"at": [0, 0], "size": [1024, 1024], "reward": n} for n in range(15)],
        ),
    )


def _worst_of_texts() -> Iterator[tuple[str, Callable[[], bytes]]]:
    yield "a title of 1,000,000 characters", grid(5, title="<&" * 500_000)
    yield "45,000 tags", grid(5, tags=[f"tag-{n}" for n in range(45_000)])
    yield "a description of 250,000 lines", grid(5, description="x\n" * 250_000)
    yield (
        "90 characters in a drawing of 340x340",
        lambda: (
            drawing(340, 340, start_and_letters)
            + (
                "legend:\n"
                + "".join(
                    f"  {each}: {{label: x{each}, reward: -{n}}}\n"
                    for n, each in enumerate(LETTERS)
                )
            ).encode()
        ),
    )
    yield "a random maze of 1024x1024", grid(1024, maze={"seed": "random"})


LETTERS = "abcdfghijklmnpqrstuvwxyzABCDFGHIJKLMNPQRTUVWXYZ123456789"


def start_and_letters(x: int, y: int) -> str:
    """Return marks of areas, no two alike side by side, with a start in the corner."""
    return "S" if x == y == 0 else LETTERS[(x + 7 * y) % len(LETTERS)]


WORST = dict(_worst())
"""The levels by what they have much of."""
