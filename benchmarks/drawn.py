"""Solving 30 large grids drawn at random: `brl.solve` beside the model checker Storm.

    python benchmarks/drawn.py [--seed N] [--largest SIDE] [--rounds N]

Each of ten kinds of grid is drawn three times, 64 to 512 cells wide, with chances, discounts and
rewards at random. Storm's sound engine bounds its error by 1e-9 of a value, its default engine
stops when values change by less than 1e-6. What it takes to compile, write and read levels is not
counted. Ours needs the extra `fast`: it finds values, their bounds and greedy actions. Seconds are
those of the processor, of which other programs take less than of the time.
"""

from __future__ import annotations

import argparse
import statistics
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from random import Random
from typing import Any

import checker
from peers import Peer
from timing import Measure, in_turns

import babyrobot_levels as brl

SIDES = (64, 128, 256, 512)
DISCOUNTS = (1.0, 1.0, 0.9, 0.99, 0.9999)
AIM = 3.0
"""How many times as fast as Storm's sound engine ours is to be."""

Fields = dict[str, Any]


def skid(draw: Random) -> Fields:
    """Return slipperiness of some kind."""
    kind = draw.choice(["sides", "others", "open"])
    return {"probability": round(draw.uniform(0.05, 0.95), 2), "to": kind}


def slippery(draw: Random, side: int) -> Fields:
    """Return an open grid with skids."""
    return {"skid": skid(draw)}


def patches(draw: Random, side: int) -> Fields:
    """Return a grid with areas in which the robot skids otherwise, and which cost something."""
    areas = [
        {"at": _cell(draw, side // 2), "size": _size(draw, side), "skid": skid(draw), "reward": -1}
        for _ in range(6)
    ]
    return {"skid": skid(draw), "areas": areas}


def windy(draw: Random, side: int) -> Fields:
    """Return a grid with wind in its columns, skids, and glass."""
    wind = {"north": [draw.choice([0, 0, 1, 2]) for _ in range(side)]}
    glass = [
        {"at": _cell(draw, side - 9), "side": "E", "length": 8, "pass": round(draw.random(), 2)}
        for _ in range(side // 4)
    ]
    return {"wind": wind, "walls": glass, "skid": round(draw.uniform(0.05, 0.5), 2)}


def warped(draw: Random, side: int) -> Fields:
    """Return a grid with warps and puddles."""
    cells = draw.sample([(x, y) for x in range(1, side - 1) for y in range(1, side - 1)], side * 3)
    warps = [{"at": [*at], "to": [*to]} for at, to in zip(cells[:side], cells[side:], strict=False)]
    puddles = [{"at": [*at], "size": draw.choice(["small", "large"])} for at in cells[2 * side :]]
    return {"warps": warps, "puddles": puddles}


def blocked(draw: Random, side: int) -> Fields:
    """Return a grid with blocked cells that no cell lies between, and skids."""
    spots = [
        {"at": [x, y]}
        for x in range(1, side - 1, 2)
        for y in range(1, side - 1, 2)
        if draw.random() < 0.7
    ]
    return {"blocked": spots, "skid": skid(draw)}


def exits(draw: Random, side: int) -> Fields:
    """Return an open grid with several exits far apart, and skids."""
    last = side - 1
    return {"exit": [[last, last], [last, 0], [side // 2, side // 2]], "skid": skid(draw)}


def maze(draw: Random, side: int) -> Fields:
    """Return a maze with loops, and skids."""
    seed, loops = draw.randrange(1000), round(draw.random(), 2)
    return {"maze": {"seed": seed, "loops": loops}, "skid": skid(draw)}


def dry(draw: Random, side: int) -> Fields:
    """Return a maze without chance."""
    return {"maze": {"seed": draw.randrange(1000), "loops": round(draw.random(), 2)}}


def mixed(draw: Random, side: int) -> Fields:
    """Return a grid in which some cells pay and others cost, with a discount."""
    areas = [
        {"at": _cell(draw, side // 2), "size": _size(draw, side), "reward": draw.randint(-5, 3)}
        for _ in range(8)
    ]
    return {"areas": areas, "skid": skid(draw), "discount": draw.choice(DISCOUNTS[2:])}


def stormy(draw: Random, side: int) -> Fields:
    """Return a grid with wind to a side in its rows, and skids to all sides."""
    wind = {"west": [draw.choice([0, 1]) for _ in range(side)]}
    return {"wind": wind, "skid": {"probability": round(draw.uniform(0.05, 0.6), 2), "to": "open"}}


KINDS: tuple[Callable[[Random, int], Fields], ...] = (
    *(slippery, patches, windy, warped, blocked, exits, maze, dry, mixed, stormy),
)


def _cell(draw: Random, below: int) -> list[int]:
    return [draw.randrange(1, below), draw.randrange(1, below)]


def _size(draw: Random, side: int) -> list[int]:
    return [draw.randrange(2, side // 3), draw.randrange(2, side // 3)]


def drawn(seed: int, largest: int) -> Iterator[tuple[str, brl.Level]]:
    """Yield 30 grids with what they are."""
    sides = [side for side in SIDES if side <= largest]
    for number in range(3 * len(KINDS)):
        draw = Random(seed * 1000 + number)
        make, side = KINDS[number % len(KINDS)], sides[(number + number // len(KINDS)) % len(sides)]
        discount = draw.choice(DISCOUNTS)
        fields = {"version": 1, "size": [side, side], "discount": discount, **make(draw, side)}
        level = brl.load(fields)
        name = f"{make.__name__} {side}x{side}"
        yield name if level.discount == 1 else f"{name}, discount {level.discount:g}", level


def measured(storm: Peer, level: brl.Level, folder: Path, rounds: int) -> dict[str, float | str]:
    """Return how many seconds each takes, or why there is no answer."""
    checker.write([level], folder)
    question: dict[str, Any] = {"folder": str(folder), "count": 1, "discount": level.discount}
    question["clock"] = "process_time"
    measures: dict[str, Measure] = {
        "ours": checker.ours([level], level.discount, time.process_time),
        "sound": checker.asking(
            storm, "sound", engine="sound", precision="1/1000000000", **question
        ),
        "default": checker.asking(storm, "default", engine="default", **question),
    }
    rates, missing = in_turns(measures, rounds)
    return {
        name: missing[name] if name in missing else 1 / statistics.median(rates[name])
        for name in measures
    }


def main() -> None:
    """Print a table, and the worst row."""
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument("--seed", type=int, default=0)
    options.add_argument("--largest", type=int, default=512, choices=SIDES)
    options.add_argument("--rounds", type=int, default=3)
    chosen = options.parse_args()
    storm = Peer("stormpy", "peer_storm.py")
    print("| grid | ours, s | Storm sound 1e-9, s | Storm default, s | times as fast as sound |")
    print("|---|---|---|---|---|")
    worst: list[tuple[float, str]] = []
    for name, level in drawn(chosen.seed, chosen.largest):
        with tempfile.TemporaryDirectory() as folder:
            found = measured(storm, level, Path(folder) / "level", chosen.rounds)
        cells = [f"{each:.3f}" if isinstance(each, float) else "-" for each in found.values()]
        ours, sound = found["ours"], found["sound"]
        ratio = sound / ours if isinstance(sound, float) and isinstance(ours, float) else None
        if ratio is not None:
            worst.append((ratio, name))
        print(
            f"| {name} | {' | '.join(cells)} | {'-' if ratio is None else f'{ratio:.1f}'} |",
            flush=True,
        )
    storm.close()
    below = sum(ratio < AIM for ratio, _ in worst)
    print(
        f"\n{below} of {len(worst)} below {AIM:g}; the worst: {min(worst)[1]}, {min(worst)[0]:.1f}"
    )


if __name__ == "__main__":
    main()
