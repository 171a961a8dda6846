"""Valid levels as large as they may be are compiled in time that grows with their cells only."""

from __future__ import annotations

import random
import time
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.combinations import swept
from support.work import counted_calls

import babyrobot_levels as brl
from babyrobot_levels.mdp.states import reach_of

SIDE = 1024
WHOLE = {"version": 1, "size": [SIDE, SIDE]}


def long_walls(**more: Any) -> dict[str, Any]:
    rng = random.Random(0)
    places = [[rng.randrange(24), rng.randrange(SIDE - 1)] for _ in range(3000)]
    return {**WHOLE, "walls": [{"at": at, "side": "S", "length": 1000, **more} for at in places]}


def strong_wind() -> dict[str, Any]:
    rng = random.Random(0)
    blows = {side: [rng.randrange(SIDE + 1) for _ in range(SIDE)] for side in ("east", "south")}
    return {**WHOLE, "wind": blows}


def many_exits() -> dict[str, Any]:
    rng = random.Random(0)
    cells = {(rng.randrange(SIDE), rng.randrange(1, SIDE)) for _ in range(33_000)}
    return {**WHOLE, "exit": [[*cell] for cell in sorted(cells)], "rewards": {"closer": 1}}


def one_exit() -> dict[str, Any]:
    return {**WHOLE, "rewards": {"closer": 1, "farther": -2}}


@pytest.mark.parametrize(
    "make", swept([many_exits], [long_walls, strong_wind, many_exits, one_exit])
)
def test_large_levels_are_compiled_soon(make: Any) -> None:
    level, plain = brl.load(make()), brl.load(WHOLE)
    begin = time.process_time()
    plain.compile()
    usual = time.process_time() - begin
    begin = time.process_time()
    level.compile()
    # What was quadratic took 10 to 60 times as long as an empty level.
    assert time.process_time() - begin < 5 * usual + 1


def test_long_walls_are_laid_at_once() -> None:
    for level in (brl.load(long_walls()), brl.load(long_walls(**{"pass": 0.0}))):
        with counted_calls() as work:
            level.grid()
        # Of 3,000 walls, 1,000 cells long each.
        assert work.calls < 100_000, work


@pytest.mark.parametrize("maze", swept([None], [{"seed": 1}]))
def test_ways_through_large_levels_are_found_soon(maze: Any) -> None:
    level = brl.load({**WHOLE, **({"maze": maze} if maze else {})})
    level.grid()
    begin = time.process_time()
    mdp = level.compile()
    usual = time.process_time() - begin
    begin = time.process_time()
    ways = reach_of(level, mdp)
    # With a list for each cell and a loop over them it took more than ten times as long.
    assert time.process_time() - begin < 5 * usual + 1
    assert ways.steps[-1] == ways.to_exit[0] >= 2 * (SIDE - 1)
    assert all(ways.steps[other] == 1 for other in ways.successors[0])


@given(
    st.tuples(st.integers(1, 9), st.integers(1, 9)).flatmap(
        lambda size: st.tuples(
            st.just(size),
            st.sets(
                st.tuples(st.integers(0, size[0] - 1), st.integers(0, size[1] - 1)), min_size=1
            ),
        )
    )
)
@settings(deadline=None, max_examples=200)
def test_distances_are_those_to_the_nearest_exit(
    world: tuple[tuple[int, int], set[tuple[int, int]]],
) -> None:
    from babyrobot_levels.mdp.compiler.terrain import build_terrain

    (width, height), exits = world
    starts = [(x, y) for x in range(width) for y in range(height) if (x, y) not in exits]
    if not starts:
        return
    fields = {"size": [width, height], "exit": sorted(exits), "start": [starts[0]]}
    level = brl.load({"version": 1, **fields, "rewards": {"closer": 1}})
    terrain = build_terrain(level, level.grid())
    assert terrain.distance is not None
    expected = [
        min((x - right) ** 2 + (y - down) ** 2 for right, down in exits)
        for y in range(height)
        for x in range(width)
    ]
    assert np.array_equal(terrain.distance, expected)
