"""The textbook levels: they cite their sources, and have the tables and values published there."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping, Sequence
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.envs.toy_text.frozen_lake import generate_random_map
from numpy.typing import NDArray
from support.each import for_each
from support.places import GALLERY_FOLDER
from support.worlds import World, level_of

from babyrobot_levels.analysis.solver.evaluation import evaluate, success_within
from babyrobot_levels.analysis.solver.optimum import solve
from babyrobot_levels.library.catalogue import load
from babyrobot_levels.library.level import Level
from babyrobot_levels.library.search_path import gallery_folder, yaml_files
from babyrobot_levels.mdp.tables import Mdp

Cell = tuple[int, int]
Outcome = tuple[float, int, float, bool]
Values = NDArray[np.float64]

FOLDER = GALLERY_FOLDER / "textbook"

SUTTON_BARTO = "Sutton and Barto, Reinforcement Learning: An Introduction (2nd edition, 2018)"
RUSSELL_NORVIG = (
    "Russell and Norvig, Artificial Intelligence: A Modern Approach (3rd edition, 2010)"
)
ROOMS = (
    "Sutton, Precup and Singh, Between MDPs and semi-MDPs: A framework for temporal abstraction "
    "in reinforcement learning, Artificial Intelligence 112 (1999), pages 181-211, Figure 2"
)
SOURCES = {
    "cliff-walking": f"{SUTTON_BARTO}, Example 6.6; Gymnasium 1.4, CliffWalking-v1",
    "cliff-walking-slippery": "Gymnasium 1.4, CliffWalkingSlippery-v1 "
    "(CliffWalking-v1 with is_slippery=True)",
    "dyna-maze": f"{SUTTON_BARTO}, Example 8.1",
    "four-rooms": f"{ROOMS} (moves made deterministic)",
    "four-rooms-slippery": ROOMS,
    "frozen-lake": "Gymnasium 1.4, FrozenLake-v1 (map 4x4, slippery)",
    "frozen-lake-8x8": "Gymnasium 1.4, FrozenLake8x8-v1 (map 8x8, slippery)",
    "frozen-lake-8x8-dry": "Gymnasium 1.4, FrozenLake8x8-v1 with is_slippery=False (map 8x8)",
    "frozen-lake-dry": "Gymnasium 1.4, FrozenLake-v1 with is_slippery=False (map 4x4)",
    "gridworld-3-5": f"{SUTTON_BARTO}, Example 3.5",
    "gridworld-4-1": f"{SUTTON_BARTO}, Example 4.1",
    "russell-norvig-4x3": f"{RUSSELL_NORVIG}, Figure 17.1",
    "windy-gridworld": f"{SUTTON_BARTO}, Example 6.5",
    "windy-gridworld-king": f"{SUTTON_BARTO}, Exercise 6.9",
    "windy-gridworld-stochastic": f"{SUTTON_BARTO}, Exercise 6.10",
}
BOOKS = {
    "sutton-barto": "Sutton and Barto",
    "gymnasium": "Gymnasium",
    "russell-norvig": "Russell and Norvig",
}


def state(mdp: Mdp, cell: Cell) -> int:
    return cell[1] * mdp.width + cell[0]


def fewest_steps(mdp: Mdp, start: Cell, end: Cell) -> int:
    """Return how many moves at least lead from cell to cell."""
    onward = np.zeros((mdp.num_states, mdp.num_states), dtype=bool)
    for here, move, outcome in np.argwhere(mdp.probability[:, 1:] > 0):
        onward[here, mdp.next_state[here, 1 + move, outcome]] = True
    found, queue = {state(mdp, start): 0}, deque([state(mdp, start)])
    while queue:
        here = queue.popleft()
        for there in np.flatnonzero(onward[here]).tolist():
            if there not in found:
                found[there] = found[here] + 1
                queue.append(there)
    return found[state(mdp, end)]


def assert_table(values: Values, published: Sequence[Sequence[float]], decimals: int) -> None:
    """Compare values with those of a book, row by row, as exactly as the book prints them."""
    found = values.reshape(np.shape(published))
    np.testing.assert_allclose(found, published, rtol=0, atol=0.5 * 10**-decimals + 1e-9)


# -- what they say -------------------------------------------------------------------------


def test_the_folder_holds_the_levels_with_the_tag() -> None:
    assert {path.stem for path in FOLDER.iterdir()} == set(SOURCES)
    gallery = [load(path) for path in yaml_files(gallery_folder()) if path.parent.name != "suites"]
    assert {level.name for level in gallery if "textbook" in level.tags} == set(SOURCES)


@pytest.mark.parametrize("name", SOURCES)
def test_it_cites_its_source(name: str) -> None:
    level = load(name)
    assert level.source == SOURCES[name]
    tagged = {book for book in BOOKS if book in level.tags}
    assert tagged == {book for book, words in BOOKS.items() if words in SOURCES[name]}


# -- Gymnasium -----------------------------------------------------------------------------

LAKE_MOVES = {0: "west", 1: "south", 2: "east", 3: "north"}
CLIFF_MOVES = {0: "north", 1: "east", 2: "south", 3: "west"}
OURS = {"north": 0, "east": 1, "south": 2, "west": 3}


def merged(outcomes: Sequence[Outcome]) -> dict[tuple[int, float, bool], float]:
    """Return the probability of each distinct outcome; those that cannot happen are dropped."""
    result: dict[tuple[int, float, bool], float] = {}
    for probability, there, reward, terminal in outcomes:
        if probability > 0:
            key = (int(there), float(reward), bool(terminal))
            result[key] = result.get(key, 0.0) + float(probability)
    return result


def assert_equal_tables(level: Level, env: Any, moves: Mapping[int, str], but: set[int]) -> None:
    """Compare every entry of the two tables, except those of the states in `but`."""
    ours, theirs = level.compile().to_toy_text(first_action=1), env.unwrapped.P
    assert ours.keys() == set(theirs)
    for here in ours.keys() - but:
        assert len(theirs[here]) == len(ours[here]) == 4
        for move, word in moves.items():
            expected = merged(theirs[here][move])
            found = merged(ours[here][OURS[word]])
            assert found == pytest.approx(expected, abs=1e-12), (here, word)


@pytest.mark.parametrize(
    ("name", "peer", "options", "moves", "but"),
    [
        ("frozen-lake", "FrozenLake-v1", {}, LAKE_MOVES, set()),
        ("frozen-lake-dry", "FrozenLake-v1", {"is_slippery": False}, LAKE_MOVES, set()),
        ("frozen-lake-8x8", "FrozenLake8x8-v1", {}, LAKE_MOVES, set()),
        ("frozen-lake-8x8-dry", "FrozenLake8x8-v1", {"is_slippery": False}, LAKE_MOVES, set()),
        # Gymnasium's table of the cliff goes on behind the goal, where no episode does.
        ("cliff-walking", "CliffWalking-v1", {}, CLIFF_MOVES, {47}),
        ("cliff-walking-slippery", "CliffWalkingSlippery-v1", {}, CLIFF_MOVES, {47}),
        ("cliff-walking-slippery", "CliffWalking-v1", {"is_slippery": True}, CLIFF_MOVES, {47}),
    ],
)
def test_it_is_the_game_of_gymnasium(
    name: str, peer: str, options: dict[str, bool], moves: Mapping[int, str], but: set[int]
) -> None:
    env: Any = gymnasium.make(peer, **options)
    level = load(name)
    assert_equal_tables(level, env, moves, but)
    np.testing.assert_array_equal(level.compile().start, env.unwrapped.initial_state_distrib)
    assert env.spec is not None
    # Gymnasium has none for Cliff Walking.
    assert level.max_steps == env.spec.max_episode_steps or env.spec.max_episode_steps is None


@pytest.mark.parametrize("is_slippery", [True, False])
@for_each("size", range(2, 9))
@pytest.mark.parametrize(
    ("seed", "rate", "schedule"),
    [(1, 1 / 3, (1, 0, 0)), (2, 0.8, (10, -5, -0.1)), (3, 0.0, (2, -1, 0.5)), (4, 1.0, (1, 0, 0))],
)
def test_random_lakes(
    size: int, seed: int, rate: float, schedule: tuple[float, float, float], is_slippery: bool
) -> None:
    rows = generate_random_map(size=size, p=0.7, seed=seed)
    env = gymnasium.make(
        "FrozenLake-v1",
        desc=rows,
        is_slippery=is_slippery,
        success_rate=rate,
        reward_schedule=schedule,
    )
    level = level_of(lake(rows, 1 - rate if is_slippery else 0.0, *schedule))
    assert_equal_tables(level, env, LAKE_MOVES, but=set())


def lake(rows: Sequence[str], skid: float, goal: float, hole: float, ice: float) -> World:
    """Return a map of Frozen Lake as a level: holes are areas that end the episode."""
    cells = {(x, y): char for y, row in enumerate(rows) for x, char in enumerate(row)}
    return {
        "version": 1,
        "size": [len(rows[0]), len(rows)],
        "start": next(list(cell) for cell, char in cells.items() if char == "S"),
        "exit": [list(cell) for cell, char in cells.items() if char == "G"],
        "areas": [
            {"at": list(cell), "ends": True, "reward": hole}
            for cell, char in cells.items()
            if char == "H"
        ],
        "skid": {"probability": skid, "to": "sides"},
        "rewards": {"step": ice, "exit": goal},
    }


def test_frozen_lake_is_crossed_14_times_in_17_by_those_who_have_time() -> None:
    solution = solve("frozen-lake")
    assert solution.expected_return == pytest.approx(14 / 17, abs=1e-12)
    assert solution.exit_probability == pytest.approx(14 / 17, abs=1e-12)


def test_frozen_lake_within_its_hundred_steps() -> None:
    # The same moves all the time: those that are best for discount 0.99. (West and east are equally
    # good on the cell between two holes, and lead to the same.)
    steady = success_within("frozen-lake", solve("frozen-lake", 0.99))
    assert steady == pytest.approx(0.740165, abs=1e-6)
    # The best that can be done by counting the steps that are left.
    hurried = solve("frozen-lake", within="max_steps").expected_return
    assert hurried == pytest.approx(0.744190, abs=1e-6)


def test_the_large_lake_has_a_safe_way() -> None:
    assert solve("frozen-lake-8x8").expected_return == pytest.approx(1, abs=1e-6)


@pytest.mark.parametrize(("name", "size"), [("frozen-lake-dry", 4), ("frozen-lake-8x8-dry", 8)])
def test_the_dry_lakes_are_crossed_on_a_shortest_path(name: str, size: int) -> None:
    mdp = load(name).compile()
    assert fewest_steps(mdp, (0, 0), (size - 1, size - 1)) == 2 * (size - 1)
    assert solve(name, 0.9).expected_return == pytest.approx(0.9 ** (2 * size - 3), abs=1e-12)


# -- Sutton and Barto ----------------------------------------------------------------------


def test_gridworld_3_5() -> None:
    level = load("gridworld-3-5")
    assert (level.size, level.exit, level.discount) == ((5, 5), "none", 0.9)
    figure_3_2 = [
        [3.3, 8.8, 4.4, 5.3, 1.5],
        [1.5, 3.0, 2.3, 1.9, 0.5],
        [0.1, 0.7, 0.7, 0.4, -0.4],
        [-1.0, -0.4, -0.4, -0.6, -1.2],
        [-1.9, -1.3, -1.2, -1.4, -2.0],
    ]
    figure_3_5 = [
        [22.0, 24.4, 22.0, 19.4, 17.5],
        [19.8, 22.0, 19.8, 17.8, 16.0],
        [17.8, 19.8, 17.8, 16.0, 14.4],
        [16.0, 17.8, 16.0, 14.4, 13.0],
        [14.4, 16.0, 14.4, 13.0, 11.7],
    ]
    at_random = evaluate(level, "uniform", actions="moves")
    assert_table(at_random.values, figure_3_2, 1)
    assert_table(solve(level, actions="moves").values, figure_3_5, 1)


def test_gridworld_4_1() -> None:
    level = load("gridworld-4-1")
    assert set(level.exits) == {(0, 0), (3, 3)}
    assert len(level.starts) == 14
    figure_4_1 = [
        [0, -14, -20, -22],
        [-14, -18, -20, -20],
        [-20, -20, -18, -14],
        [-22, -20, -14, 0],
    ]
    assert_table(evaluate(level, "uniform", actions="moves").values, figure_4_1, 9)


def test_windy_gridworld_takes_fifteen_steps() -> None:
    level = load("windy-gridworld")
    assert (level.size, level.start, level.exit) == ((10, 7), (0, 3), (7, 3))
    assert level.wind is not None
    assert level.wind.north == (0, 0, 0, 1, 1, 1, 2, 2, 1, 0)
    mdp = level.compile()
    assert fewest_steps(mdp, (0, 3), (7, 3)) == 15
    for actions in ("all", "moves"):
        solution = solve(level, actions=actions)
        assert solution.expected_return == pytest.approx(-15, abs=1e-10)
        assert solution.expected_steps == pytest.approx(15, abs=1e-10)


def test_king_s_moves_take_seven_steps_and_keep_the_wind() -> None:
    windy, king, gusty = (load(f"windy-gridworld{name}") for name in ("", "-king", "-stochastic"))
    assert king.replace(moves=4).digest == windy.digest
    assert king.wind is not None
    varying = king.wind.model_copy(update={"varies": True})
    assert king.replace(wind=varying).digest == gusty.digest
    assert fewest_steps(king.compile(), (0, 3), (7, 3)) == 7
    assert solve(king).expected_return == pytest.approx(-7, abs=1e-10)


def test_cliff_walking_costs_thirteen_along_the_edge() -> None:
    solution = solve("cliff-walking", actions="moves")
    assert solution.expected_return == pytest.approx(-13, abs=1e-10)
    north, east, south = 0, 1, 2
    assert solution.policy[3, 0] == north
    assert solution.policy[2].tolist() == [east] * 11 + [south]


def test_on_the_slippery_cliff_one_keeps_away_from_the_edge() -> None:
    # Along the edge one would slip down a third of the time: going north never does.
    solution = solve("cliff-walking-slippery", actions="moves")
    assert solution.policy[2, 1:11].tolist() == [0] * 10


def test_the_dyna_maze_takes_fourteen_steps() -> None:
    level = load("dyna-maze")
    assert (level.size, level.start, level.exit) == ((9, 6), (0, 2), (8, 0))
    column = {(2, 1), (2, 2), (2, 3)}
    assert blocked(level.draw()) == column | {(5, 4)} | {(7, 0), (7, 1), (7, 2)}
    mdp = level.compile()
    assert fewest_steps(mdp, (0, 2), (8, 0)) == 14
    assert level.discount == 0.95
    assert solve(level).expected_return == pytest.approx(0.95**13, abs=1e-12)


def blocked(drawn: str) -> set[Cell]:
    """Return the blocked cells of a drawing."""
    rows = drawn.splitlines()[1::2]
    columns = range((len(rows[0]) - 1) // 4)
    return {(x, y) for y, row in enumerate(rows) for x in columns if row[4 * x + 2] == "#"}


# -- Russell and Norvig --------------------------------------------------------------------


def test_the_4x3_world() -> None:
    level = load("russell-norvig-4x3")
    assert (level.size, level.start, level.exit) == ((4, 3), (0, 2), (3, 0))
    mdp = level.compile()
    # A state's utility in the book counts the reward of being there, which is not the step's.
    solution = solve(level, actions="moves")
    figure_17_3 = {
        (0, 0): 0.812,
        (1, 0): 0.868,
        (2, 0): 0.918,
        (0, 1): 0.762,
        (2, 1): 0.660,
        (0, 2): 0.705,
        (1, 2): 0.655,
        (2, 2): 0.611,
        (3, 2): 0.388,
    }
    free = [cell for cell in np.ndindex(4, 3) if not mdp.is_terminal[state(mdp, cell)]]
    assert set(free) == set(figure_17_3)
    for cell, utility in figure_17_3.items():
        x, y = cell
        assert solution.values[y, x] - 0.04 == pytest.approx(utility, abs=0.0005), cell
    # At the bottom, the famous policy goes left and round, away from the bad end.
    assert solution.policy[2].tolist() == [0, 3, 3, 3]
    # Once an exit is reached, nothing more comes; the step that leads there gives 1 or -1.
    assert merged(mdp.outcomes(state(mdp, (2, 1)), 2)) == pytest.approx(
        {
            (state(mdp, (3, 1)), -1.0, True): 0.8,
            (state(mdp, (2, 0)), -0.04, False): 0.1,
            (state(mdp, (2, 2)), -0.04, False): 0.1,
        }
    )


# -- four rooms ----------------------------------------------------------------------------

HALLWAYS = {(5, 2), (1, 5), (8, 6), (5, 9)}


@pytest.mark.parametrize("name", ["four-rooms", "four-rooms-slippery"])
def test_four_rooms(name: str) -> None:
    level = load(name)
    assert (level.size, level.start, level.exit) == ((11, 11), (0, 0), (8, 6))
    assert level.discount == 0.9
    walls = blocked(level.draw())
    assert 11 * 11 - len(walls) == 104
    between = (
        {(5, y) for y in range(11)} | {(x, 5) for x in range(5)} | {(x, 6) for x in range(6, 11)}
    )
    assert walls == between - HALLWAYS
    mdp = level.compile()
    assert fewest_steps(mdp, (0, 0), (8, 6)) == 14
    assert fewest_steps(mdp, (0, 0), (1, 5)) == 6
    assert fewest_steps(mdp, (0, 0), (5, 9)) == 14
    assert fewest_steps(mdp, (10, 10), (8, 6)) == 6
    assert fewest_steps(mdp, (10, 0), (0, 10)) == 20


def test_the_four_rooms_differ_in_what_a_move_does() -> None:
    dry, wet = load("four-rooms"), load("four-rooms-slippery")
    assert dry.draw() == wet.draw()
    middle, corner, east = (2, 2), (0, 0), 2
    mdp = dry.compile()
    assert solve(dry).expected_return == pytest.approx(0.9**13, abs=1e-12)
    assert mdp.outcomes(state(mdp, middle), east) == [(1, state(mdp, (3, 2)), 0, False)]
    mdp = wet.compile()
    assert merged(mdp.outcomes(state(mdp, middle), east)) == pytest.approx(
        {
            (state(mdp, (3, 2)), 0.0, False): 2 / 3,
            (state(mdp, (2, 1)), 0.0, False): 1 / 9,
            (state(mdp, (2, 3)), 0.0, False): 1 / 9,
            (state(mdp, (1, 2)), 0.0, False): 1 / 9,
        }
    )
    # Whoever would go into a wall stays.
    assert merged(mdp.outcomes(state(mdp, corner), east)) == pytest.approx(
        {
            (state(mdp, (1, 0)), 0.0, False): 2 / 3,
            (state(mdp, (0, 1)), 0.0, False): 1 / 9,
            (state(mdp, (0, 0)), 0.0, False): 2 / 9,
        }
    )
