"""Optimal values beside those found by other means, on random levels and on known ones."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

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
from babyrobot_levels.analysis.solver.evaluation import evaluate, evaluation_of
from babyrobot_levels.analysis.solver.optimum import solve
from babyrobot_levels.analysis.solver.results import Solution, UndefinedReturnError
from babyrobot_levels.library.catalogue import load
from babyrobot_levels.mdp.actions import Action

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


@pytest.mark.slow
@pytest.mark.parametrize(("actions", "discount"), [("all", 1.0), ("moves", 0.95)])
@for_each("name", sorted(GALLERY))
def test_the_gallery_can_be_solved(name: str, actions: str, discount: float) -> None:
    # Several robots have all actions.
    is_team = GALLERY[name].parent.name == "robots"
    check_level(name, "all" if is_team else actions, discount)


@for_each("name", ["bat-cave", "frozen-lake-8x8", "glasshouse", "teleport-pads"])
def test_some_of_the_gallery_can_be_solved(name: str) -> None:
    check_level(name, "all", 1.0)


def check_level(name: str, actions: str, discount: float) -> None:
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


@pytest.mark.slow
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


@given(st.integers(1, 12), st.data())
def test_components_do_not_depend_on_what_is_imported(size: int, data: st.DataObject) -> None:
    node = st.integers(0, size - 1)
    edges = data.draw(st.lists(st.tuples(node, node), max_size=3 * size))
    source, target = np.array(sorted(edges), int).reshape(-1, 2).T
    with as_if_large(True):
        by_scipy = model.strong_components(size, source, target)
    with pytest.MonkeyPatch.context() as patch:
        patch.delitem(sys.modules, "scipy.sparse")
        by_numpy = model.strong_components(size, source, target)
    assert by_scipy.tolist() == by_numpy.tolist()


@pytest.mark.parametrize(("more", "is_greedy"), [(5e-10, True), (1.5e-9, False)])
def test_an_action_is_greedy_up_to_a_billionth_of_the_value(more: float, is_greedy: bool) -> None:
    other = {"at": [0, 0], "ends": True, "reward": 1 + more}
    rewards = {"step": 0, "exit": 1}
    fields = {"size": [3, 1], "start": [1, 0], "exit": [2, 0], "areas": [other]}
    solution = solve({"version": 1, "rewards": rewards, **fields})
    assert solution.greedy[0, 1, Action.EAST] == is_greedy
    assert solution.greedy[0, 1, Action.WEST]
