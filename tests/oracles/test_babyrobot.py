"""PyPI babyrobot 1.0.40 as an oracle: `oracles/babyrobot.json` is what it makes of our levels."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest
from support.each import for_each
from support.places import TESTS
from support.worlds import level_of

import babyrobot_levels as brl
from babyrobot_levels.mdp.grid import Grid

RECORD = json.loads((TESTS / "oracles" / "babyrobot.json").read_text(encoding="utf-8"))

VALUES = json.loads((TESTS / "oracles" / "babyrobot_values.json").read_text(encoding="utf-8"))


def open_sides(grid: Grid, *, with_glass: bool = False) -> str:
    """Return a hex digit per cell, as the record has them."""
    bits = bytearray(grid.open_bits)
    if with_glass:
        for cell, side in grid.glass:
            bits[cell] |= 1 << "NESW".index(side)
    return "".join(f"{cell:x}" for cell in bits)


def test_the_record_is_there() -> None:
    assert RECORD["package"] == "babyrobot 1.0.40"
    assert len(RECORD["mazes"]) == 150
    assert len(RECORD["levels"]) == 200
    assert sum(len(level["transitions"]) for level in RECORD["levels"]) == 23_879


@for_each("maze", RECORD["mazes"], ids=lambda maze: f"{maze['size']}-{maze['seed']}")
def test_mazes_are_equal_wall_for_wall(maze: dict[str, Any]) -> None:
    world = {"version": 1, "size": maze["size"], "start": maze["start"], "exit": "none"}
    grid = level_of({**world, "maze": {"seed": maze["seed"]}}).grid()
    assert open_sides(grid) == maze["open"]


@pytest.mark.slow
@for_each("number", range(200))
def test_levels_are_equal(number: int) -> None:
    record = RECORD["levels"][number]
    level = level_of(record["level"])
    grid, mdp = level.grid(), level.compile()
    # The package has nothing to say of cells where the episode is over.
    shown = [
        "0" if over else digit
        for digit, over in zip(open_sides(grid, with_glass=True), mdp.is_terminal, strict=True)
    ]
    assert "".join(shown) == record["open"]
    for key, transitions in record["transitions"].items():
        x, y, action = map(int, key.split(","))
        expected: dict[tuple[int, float], float] = {}
        for probability, (to_x, to_y), reward in transitions:
            outcome = (to_y * grid.width + to_x, reward)
            expected[outcome] = expected.get(outcome, 0) + probability
        found = {
            (state, reward): probability
            for probability, state, reward, _ in mdp.outcomes(y * grid.width + x, action)
        }
        assert found == pytest.approx({o: p for o, p in expected.items() if p > 1e-12}, abs=1e-9)


# -- value iteration -------------------------------------------------------------------------


@pytest.mark.slow
@for_each("world", VALUES["worlds"], ids=lambda world: str(world["discount"]))
def test_solutions_are_those_of_its_value_iteration(world: dict[str, Any]) -> None:
    solution = brl.solve(level_of(world["level"]), world["discount"])
    assert VALUES["threshold"] == 1e-9
    np.testing.assert_allclose(solution.values, world["values"], rtol=0, atol=1e-6)


def test_the_values_are_of_many_worlds_and_all_discounts() -> None:
    assert len(VALUES["worlds"]) == 60
    assert {world["discount"] for world in VALUES["worlds"]} == {0.5, 0.9, 0.97, 1.0}
    assert sum(len(world["level"]["puddles"]) for world in VALUES["worlds"]) > 500
