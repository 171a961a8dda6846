"""Grids of the literature on partial observation, with the figures that were published."""

from __future__ import annotations

from collections.abc import Hashable

import pytest
from extensions.sight.cases import blind, walls

import babyrobot_levels as brl
from babyrobot_levels.extensions.sight.sights import Sensor
from babyrobot_levels.extensions.sight.solve import solve_sight

STEPS = {"step": -1, "exit": -1}
"""Rewards that count steps."""

MAZE = """
+---+---+---+---+---+
| S   S   S   S   S |
+   +---+   +---+   +
| S |###| S |###| S |
+   +---+   +---+   +
"""
ROW = """\
| S |###| S |###| S |
+   +---+   +---+   +
"""
END = """\
| S |###| E |###| S |
+---+---+---+---+---+
"""


@pytest.mark.slow
@pytest.mark.parametrize(
    ("drawing", "steps"),
    [
        # The maze of McCallum, with 11 cells, as in Littman, Cassandra and Kaelbling (1995),
        # "Learning policies for partially observable environments: scaling up", and with 14.
        # PRISM's regression tests have these results (prism-tests/functionality/verify/pomdps,
        # maze.prism.props: 4.3; maze2.prism.props: [5.69230763, 5.692307692307692]).
        (MAZE.lstrip() + END, 4.3),
        (MAZE.lstrip() + ROW + END, 5.692307692307692),
    ],
    ids=["11 cells", "14 cells"],
)
def test_a_maze_of_which_one_sees_the_walls(drawing: str, steps: float) -> None:
    level = brl.load({"version": 1, "map": drawing, "rewards": STEPS})
    found = solve_sight(level, walls, actions="moves")
    assert found.is_exact
    assert found.upper == pytest.approx(-steps, abs=1e-12)
    check_few(level, walls, -steps)


def check_few(level: brl.Level, sight: Sensor, optimum: float) -> None:
    """Check that bounds are on both sides of an optimum, however few beliefs are explored."""
    for beliefs in range(12):
        few = solve_sight(level, sight, actions="moves", beliefs=beliefs)._search.found
        assert few.lower <= optimum + 1e-9
        assert few.upper >= optimum - 1e-9


def grid(side: int) -> brl.Level:
    """Return a grid without walls, whose exit is in a corner; episodes begin anywhere else."""
    last = side - 1
    cells = [[x, y] for y in range(side) for x in range(side) if (x, y) != (last, last)]
    fields = {"size": [side, side], "start": cells, "exit": [last, last], "rewards": STEPS}
    return brl.load({"version": 1, **fields})


@pytest.mark.slow
def test_a_grid_of_which_one_sees_nothing_but_the_exit() -> None:
    # Norman, Parker and Zou (2017), "Verification and control of partially observable
    # probabilistic systems", after Littman, Cassandra and Kaelbling. PRISM's regression test
    # 3x3grid.prism.props has the bounds [2.8496, 2.875].
    found = solve_sight(grid(3), blind, actions="moves")
    assert found.is_exact
    assert found.upper == pytest.approx(-2.875, abs=1e-12)
    check_few(grid(3), blind, -2.875)


def t_maze(length: int) -> brl.Level:
    """Return the T-maze of Bakker (2001), "Reinforcement learning with long short-term memory".

    The exit is on one side of the end of a corridor, and gives 4; the other side ends the episode
    as well. Standing still and walls cost 0.1.
    """
    sides = [[length, 0], [length, 2]]
    return brl.load(
        {
            "version": 1,
            "size": [length + 1, 3],
            "start": [0, 1],
            "exit_one_of": sides,
            "blocked": [{"at": [0, y], "size": [length, 1]} for y in (0, 2)],
            "areas": [{"at": at, "ends": True, "reward": -0.1} for at in sides],
            "rewards": {"step": 0, "exit": 4, "stay": -0.1, "bump": -0.1},
        }
    )


def sign(level: brl.Level, state: int) -> Hashable:
    """Show the walls, and in the first cell of the corridor on which side the exit is."""
    configuration, cell = divmod(state, level.size[0] * level.size[1])
    return walls(level, state), configuration if cell == level.size[0] else None


def test_who_remembers_a_sign_reaches_all_and_others_half() -> None:
    # 4 for the right side, which a sign tells; else (4 - 0.1) / 2.
    assert solve_sight(t_maze(10), sign).lower == pytest.approx(4, abs=1e-12)
    found = solve_sight(t_maze(10), walls)
    assert (found.lower, found.upper) == pytest.approx((1.95, 1.95), abs=1e-12)
    assert found.cost == pytest.approx((2.05, 2.05), abs=1e-12)


def detectors(level: brl.Level, state: int) -> Hashable:
    """Show whether there is a wall in the west and in the east."""
    x, y = level.compile().cell(state)
    _, east, _, west = level.grid().open[y, x].tolist()
    return east, west


WORLD = """
+---+---+---+---+
| S   S   S   E |
+   +---+   +   +
| S |###| S   T |
+   +---+   +   +
| S   S   S   S |
+---+---+---+---+
"""


@pytest.mark.slow
def test_the_4x3_world_with_two_detectors() -> None:
    # Russell and Norvig, with the sensors of Parr and Russell (1995), "Approximating optimal
    # policies for partially observable stochastic domains": who knows the start gets by with them.
    level = brl.load("russell-norvig-4x3")
    found = solve_sight(level, detectors)
    assert found.is_exact
    assert found.lower == pytest.approx(brl.solve(level).expected_return, abs=1e-9)
    level = brl.load(
        {
            "version": 1,
            "map": WORLD.lstrip(),
            "legend": {"T": {"reward": -1, "ends": True}},
            "skid": {"probability": 0.2, "to": "sides"},
            "rewards": {"step": -0.04, "exit": 1},
        }
    )
    lost = solve_sight(level, detectors, discount=0.95, gap=0.01)
    assert lost.gap <= 0.01
    assert lost.upper < lost.full
