"""Optimal values beside those found by other means, on random levels and on known ones."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import gymnasium
import numpy as np
import pytest
from hypothesis import assume, event, given
from hypothesis import strategies as st
from hypothesis.strategies import DrawFn
from support.chains import all_totals, dense, states_of, value_iteration
from support.each import for_each
from support.playing import GALLERY
from support.worlds import World, level_of, worlds

from babyrobot_levels.analysis.solver import linear, model
from babyrobot_levels.analysis.solver.evaluation import (
    evaluate,
    evaluation_of,
    success_within,
)
from babyrobot_levels.analysis.solver.optimum import solve
from babyrobot_levels.analysis.solver.results import Solution, UndefinedReturnError
from babyrobot_levels.library.catalogue import load

FIRST = {"all": 0, "moves": 1}


def assert_sound(level: Any, solution: Solution) -> None:
    """Check what each solution promises of itself."""
    mdp = level.compile()
    if solution.actions == "turns":
        mdp = mdp.turning(level.heading)
    shape, over = mdp.shape, mdp.is_terminal.reshape(mdp.shape)
    assert solution.values.shape == solution.policy.shape == shape
    blocked = np.broadcast_to(level.grid().blocked, shape)
    has_value = ~np.isnan(solution.values)
    if not level.has_things:
        assert (has_value == ~blocked).all()
    assert not (has_value & blocked).any()
    assert has_value[~over].all()
    assert (solution.values[over & has_value] == 0).all()
    assert (solution.policy[over] == -1).all()
    assert not solution.greedy[over].any()
    states = np.unravel_index(states_of(mdp), shape)
    assert solution.greedy[(*states, solution.policy[states])].all()
    finite = solution.values[np.isfinite(solution.values)]
    assert solution.residual <= 1e-11 * (1 + np.abs(finite).max(initial=0))
    best = solution.action_values[states].max(axis=1)
    np.testing.assert_allclose(best, solution.values[states], rtol=1e-9, atol=1e-10)
    found = evaluation_of(level, solution, solution.discount, solution.actions)
    np.testing.assert_allclose(found.values, solution.values, rtol=1e-8, atol=1e-8)
    assert found.expected_steps == pytest.approx(solution.expected_steps)
    assert found.exit_probability == pytest.approx(solution.exit_probability)


@contextmanager
def as_if_large(large: bool) -> Iterator[None]:
    """Let even the smallest level be solved by the means for large ones."""
    with pytest.MonkeyPatch.context() as patch:
        if large:
            patch.setattr(linear, "DENSE_STATES", 0)
            patch.setattr(model, "DENSE_STATES", 0)
        yield


@given(
    worlds(6), st.sampled_from([0.3, 0.9, 0.97]), st.sampled_from(["all", "moves"]), st.booleans()
)
def test_discounted_values_are_those_of_value_iteration(
    world: World, discount: float, actions: str, large: bool
) -> None:
    level = level_of(world)
    with as_if_large(large):
        solution = solve(level, discount, actions=actions)
    expected = value_iteration(*dense(level.compile(), FIRST[actions]), discount)[:-1]
    found = np.where(level.compile().is_terminal, 0.0, solution.values.ravel())
    np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-8)
    assert_sound(level, solution)


@st.composite
def rooms(draw: DrawFn) -> World:
    """Draw a few cells with rewards around zero, so that all kinds of loops come about."""
    width, height = draw(st.sampled_from([(2, 1), (3, 1), (4, 1), (5, 1), (2, 2), (3, 2), (6, 1)]))
    cells = [[x, y] for y in range(height) for x in range(width)]
    few = st.sampled_from([-2, -1, -1, -1, 0, 0, 0.1, 1])
    traits = st.fixed_dictionaries(
        {"at": st.sampled_from(cells[:-1])},
        optional={"reward": few, "skid": st.sampled_from([0, 0.25, 0.5, 1])},
    )
    ends = draw(st.lists(st.sampled_from(cells[1:-1]), max_size=1)) if len(cells) > 3 else []
    world: World = {
        "version": 1,
        "size": [width, height],
        "areas": [
            *draw(st.lists(traits, max_size=4)),
            *({"at": cell, "ends": True, "reward": draw(few)} for cell in ends),
        ],
        "skid": {"probability": draw(st.sampled_from([0, 0.5])), "to": "sides"},
        "rewards": {"step": draw(few), "exit": draw(st.sampled_from([0, 1, 3, -1, -5]))}
        | draw(st.fixed_dictionaries({}, optional={"stay": few, "bump": few}))
        | draw(st.sampled_from([{}, {}, {"closer": 1, "farther": -1}])),
    }
    if draw(st.booleans()):
        x = draw(st.integers(0, width - 1))
        side = draw(st.sampled_from("ES" if x < width - 1 else "S"))
        if side == "E" or height > 1:
            world["walls"] = [{"at": [x, 0], "side": side, "pass": draw(st.sampled_from([0, 0.5]))}]
    if draw(st.booleans()) and len(cells) > 2:
        goal = draw(st.sampled_from([*cells[:-1], "start"]))
        warp = {"at": cells[1], "to": goal, "when": "leave", "reward": draw(few)}
        world["warps"] = [warp] if cells[1] not in ends else []
    return world


@given(rooms() | worlds(3), st.sampled_from(["all", "moves"]), st.booleans())
def test_totals_are_the_best_of_all_policies(world: World, actions: str, large: bool) -> None:
    with as_if_large(large):
        check_totals(world, actions)


def check_totals(world: World, actions: str) -> None:
    level = level_of(world)
    states = states_of(level.compile())
    assume(len(states) <= (4 if actions == "all" else 5))
    totals, unclear = all_totals(*dense(level.compile(), FIRST[actions]), states)
    clear = np.where(unclear, -np.inf, totals).max(axis=0)
    try:
        solution = solve(level, 1.0, actions=actions)
    except UndefinedReturnError as error:
        event("no total")
        x, y = error.cell
        assert unclear[:, states.index(y * level.size[0] + x)].any()
        return
    found = solution.values.ravel()[states]
    kind = "inf" if np.isposinf(found).any() else "-inf" if np.isneginf(found).any() else "finite"
    event(f"{kind}{' and cancelling loops' if unclear.any() else ''}")
    np.testing.assert_allclose(found, clear, rtol=1e-8, atol=1e-8)
    assert_sound(level, solution)


@pytest.mark.parametrize(("actions", "discount"), [("all", 1.0), ("moves", 0.95)])
@for_each("name", sorted(GALLERY))
def test_the_gallery_can_be_solved(name: str, actions: str, discount: float) -> None:
    level = load(GALLERY[name])
    if level.has_random_maze:
        level = level.with_maze_seed(5)
    if name == "gridworld-3-5" and discount == 1:
        assert solve(level, 1.0).unbounded.all()
        return
    assert_sound(level, solve(level, discount, actions=actions))


@given(st.integers(1, 12), st.integers(1, 12), st.integers(0, 999), st.sampled_from([0, 0.5, 1]))
def test_without_chance_the_best_way_is_the_shortest(
    width: int, height: int, seed: int, loops: float
) -> None:
    assume(width * height > 1)
    level = level_of(
        {"version": 1, "size": [width, height], "maze": {"seed": seed, "loops": loops}}
    )
    steps = np.where(level.compile().is_terminal, 0, -1)
    is_open = level.grid().open.reshape(-1, 4)
    ring = np.flatnonzero(level.compile().is_terminal).tolist()
    for state in ring:
        for side, there in enumerate((state - width, state + 1, state + width, state - 1)):
            if is_open[state, side] and steps[there] < 0:
                steps[there] = steps[state] + 1
                ring.append(there)
    solution = solve(level)
    # All steps but the last one, onto the exit, cost 1.
    assert (solution.values.ravel() == np.where(steps > 0, 1 - steps, 0)).all()
    assert solution.expected_steps == steps[0]
    assert solution.exit_probability == 1
    assert evaluate(level, solution).expected_return == solution.expected_return


def test_a_large_level_with_chance() -> None:
    level = level_of(
        {
            "version": 1,
            "size": [20, 20],
            "maze": {"seed": 4, "loops": 1},
            "skid": {"probability": 0.2, "to": "others"},
            "areas": [{"at": [5, 5], "size": [10, 3], "reward": -3, "skid": 0.6}],
        }
    )
    for discount in (1.0, 0.99):
        solution = solve(level, discount)
        expected = value_iteration(*dense(level.compile(), 0), discount)[:-1]
        np.testing.assert_allclose(solution.values.ravel(), expected, rtol=1e-9)
        assert_sound(level, solution)


# -- textbooks -------------------------------------------------------------------------------


def test_windy_gridworld_takes_fifteen_steps() -> None:
    for actions in ("all", "moves"):
        solution = solve("windy-gridworld", actions=actions)
        assert solution.expected_return == pytest.approx(-15, abs=1e-10)
        assert solution.expected_steps == pytest.approx(15, abs=1e-10)


def test_cliff_walking_takes_the_edge() -> None:
    solution = solve("cliff-walking", actions="moves")
    assert solution.expected_return == pytest.approx(-13, abs=1e-10)
    assert solution.policy[2, :11].tolist() == [1] * 11


def test_gridworld_3_5() -> None:
    # Sutton and Barto, figures 3.2 and 3.5, printed to one digit.
    best = [
        [22.0, 24.4, 22.0, 19.4, 17.5],
        [19.8, 22.0, 19.8, 17.8, 16.0],
        [17.8, 19.8, 17.8, 16.0, 14.4],
        [16.0, 17.8, 16.0, 14.4, 13.0],
        [14.4, 16.0, 14.4, 13.0, 11.7],
    ]
    even = [
        [3.3, 8.8, 4.4, 5.3, 1.5],
        [1.5, 3.0, 2.3, 1.9, 0.5],
        [0.1, 0.7, 0.7, 0.4, -0.4],
        [-1.0, -0.4, -0.4, -0.6, -1.2],
        [-1.9, -1.3, -1.2, -1.4, -2.0],
    ]
    assert np.abs(solve("gridworld-3-5", actions="moves").values - best).max() < 0.0501
    found = evaluate("gridworld-3-5", "uniform", 0.9, actions="moves")
    assert np.abs(found.values - even).max() < 0.0501


def test_gridworld_4_1() -> None:
    world = {"version": 1, "size": [4, 4], "start": [1, 0], "exit": [[0, 0], [3, 3]]}
    found = evaluate({**world, "rewards": {"exit": -1}}, "uniform", 1.0, actions="moves")
    expected = [[0, -14, -20, -22], [-14, -18, -20, -20], [-20, -20, -18, -14], [-22, -20, -14, 0]]
    np.testing.assert_allclose(found.values, expected, atol=1e-10)
    assert found.expected_steps == pytest.approx(14)


def test_the_4_by_3_world_of_russell_and_norvig() -> None:
    # There, a state's utility counts its own reward; here, a step has that of where it leads. So
    # a cell's value is its utility plus 0.04, and the ends give what their cells give.
    world = {
        "version": 1,
        "size": [4, 3],
        "start": [0, 2],
        "exit": "none",
        "blocked": [{"at": [1, 1]}],
        "areas": [
            {"at": [3, 0], "ends": True, "reward": 1},
            {"at": [3, 1], "ends": True, "reward": -1},
        ],
        "skid": {"probability": 0.2, "to": "sides"},
        "rewards": {"step": -0.04},
    }
    utilities = [[0.812, 0.868, 0.918], [0.762, np.nan, 0.660], [0.705, 0.655, 0.611, 0.388]]
    solution = solve(world, actions="moves")
    for row, expected in zip(solution.values, utilities, strict=True):
        np.testing.assert_allclose(row[: len(expected)] - 0.04, expected, atol=0.000501)
    assert solution.expected_return == pytest.approx(0.705 + 0.04, abs=0.0005)
    # The famous policy: at the bottom, go left and round, away from the bad end.
    assert solution.policy[2].tolist() == [0, 3, 3, 3]


# -- Gymnasium's own tables ------------------------------------------------------------------


def tables_of(env: Any) -> tuple[Any, Any]:
    """Return Gymnasium's tables as `dense` returns ours."""
    table = env.unwrapped.P
    size, actions = len(table) + 1, len(table[0])
    steps, rewards = np.zeros((actions, size, size)), np.zeros((actions, size))
    steps[:, -1, -1] = 1.0
    for state, choices in table.items():
        for action, outcomes in choices.items():
            for probability, goal, reward, over in outcomes:
                steps[action, state, size - 1 if over else goal] += probability
                rewards[action, state] += probability * reward
    return steps, rewards


OURS = [4, 3, 2, 1]
"""Our numbers of Frozen Lake's actions: west, south, east, north."""


@pytest.mark.parametrize("discount", [1.0, 0.99])
def test_frozen_lake_has_the_values_of_gymnasiums_tables(discount: float) -> None:
    steps, rewards = tables_of(gymnasium.make("FrozenLake-v1"))
    solution = solve("frozen-lake", discount)
    expected = value_iteration(steps, rewards, discount)[:-1]
    np.testing.assert_allclose(solution.values.ravel(), expected, atol=1e-9)
    if discount == 1:
        assert solution.expected_return == pytest.approx(14 / 17, abs=1e-12)
        assert solution.exit_probability == pytest.approx(14 / 17, abs=1e-12)


def test_success_within_a_hundred_steps_on_gymnasiums_tables() -> None:
    steps, rewards = tables_of(gymnasium.make("FrozenLake-v1"))
    solution = solve("frozen-lake")
    # Where the episode is over, whatever is done leads back for nothing.
    rows = [OURS.index(a) if a > 0 else 0 for a in [*solution.policy.ravel().tolist(), 0]]
    chain, reward = steps[rows, np.arange(17)], rewards[rows, np.arange(17)]
    for count in (0, 5, 6, 100, 1000):
        expected, here = 0.0, np.eye(17)[0]
        for _ in range(count):
            expected, here = expected + float(here @ reward), here @ chain
        assert success_within("frozen-lake", solution, count) == pytest.approx(expected, abs=1e-12)
    # The lake's own limit is 100 steps.
    limited = success_within("frozen-lake", solution)
    assert limited == success_within("frozen-lake", solution, 100)
    assert limited == pytest.approx(0.7401648977587, abs=1e-12)


@pytest.mark.parametrize("discount", [1.0, 0.9])
@pytest.mark.parametrize("is_slippery", [False, True])
def test_cliff_walking_has_the_values_of_gymnasiums_tables(
    is_slippery: bool, discount: float
) -> None:
    steps, rewards = tables_of(gymnasium.make("CliffWalking-v1", is_slippery=is_slippery))
    # Gymnasium's table goes on behind the goal, where no episode does.
    steps[:, 47], rewards[:, 47] = np.eye(49)[48], 0.0
    level = load("cliff-walking")
    if is_slippery:
        level = level.replace(skid={"probability": 2 / 3, "to": "sides"})
    solution = solve(level, discount, actions="moves")
    expected = value_iteration(steps, rewards, discount)[:-1]
    # Nobody can stand on the cliff, but both tables say what would happen.
    np.testing.assert_allclose(solution.values.ravel(), expected, atol=1e-7, rtol=1e-9)
