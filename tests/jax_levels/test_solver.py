"""Solving in JAX: what the exact solver says, for all levels in one call."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import assume, given, settings
from support.jax_walks import POOL
from support.playing import CORNERS
from support.worlds import World, worlds

import babyrobot_levels as brl
import babyrobot_levels.jax as brl_jax
from babyrobot_levels.mdp.tables import Mdp

LEVELS = [
    *POOL,
    *(brl.Level.from_fields(world) for name, world in CORNERS.items() if "random" not in name),
]
SOLVER_NAMES = {"valid": "all", "moves": "moves", "turns": "turns"}
"""Sets of actions of environments, and what the solver calls them."""

FEW = 150
"""Levels with more states take the exact solver long."""

MAZES = [
    brl.Level.from_fields(
        {"version": 1, "size": [4, 4], "maze": {"seed": seed}, "max_steps": 10 + 5 * seed}
    )
    for seed in range(6)
]


@contextmanager
def precision(is_x64: bool) -> Iterator[float]:
    """Compute in float64 or in float32; yield what errors may be, as a share of values."""
    before = jax.config.read("jax_enable_x64")
    jax.config.update("jax_enable_x64", is_x64)
    try:
        yield 1e-10 if is_x64 else 1e-5
    finally:
        jax.config.update("jax_enable_x64", before)


def error(found: Any, wanted: Any) -> float:
    """Return the largest difference, as a share of the largest value; states without any are 0."""
    wanted = np.where(np.isnan(wanted), 0.0, wanted)
    scale = np.abs(wanted).max(initial=1.0)
    return float(np.abs(found - wanted).max(initial=0.0) / scale)


def errors(params: Any, found: Any, wanted: list[Any]) -> list[float]:
    """Return the error of each level's values and return."""
    values = np.split(np.asarray(found.values), np.asarray(params.offset[1:-1]))
    return [
        error(np.append(own, start), np.append(result.values, result.expected_return))
        for own, start, result in zip(values, np.asarray(found.returns), wanted, strict=True)
    ]


# -- the same as the exact solver ------------------------------------------------------------


@pytest.mark.filterwarnings("ignore:with this policy")
@pytest.mark.parametrize(
    ("actions", "is_x64", "arguments"),
    [
        pytest.param("valid", False, {"within": "max_steps"}, marks=pytest.mark.sweep),
        pytest.param("moves", False, {"discount": 0.95}, marks=pytest.mark.sweep),
        ("turns", True, {"within": 9, "discount": 0.9}),
        ("valid", True, {}),
    ],
)
def test_values_are_those_of_the_exact_solver(
    actions: str, is_x64: bool, arguments: dict[str, Any]
) -> None:
    given = arguments | {"actions": SOLVER_NAMES[actions]}
    # Without a time limit, some levels are infinitely good or bad: they have tests of their own.
    levels = [
        level
        for level in LEVELS
        if level.compile().num_states < FEW
        and (level.max_steps is not None or "within" not in arguments)
        and (arguments or np.isfinite(brl.evaluate(level, "random").expected_return))
    ]
    assert len(levels) > 30
    best = [brl.solve(level, **given) for level in levels]
    chance = [brl.evaluate(level, "random", **given) for level in levels]
    with precision(is_x64) as most:
        _, params = brl_jax.make(levels, actions=actions)
        assert max(errors(params, brl_jax.optimum(params, **arguments), best)) < most
        policy = brl_jax.random_policy(params)
        worth = brl_jax.evaluate(params, policy, **arguments)
        assert max(errors(params, worth, chance)) < most
        regret = np.asarray(brl_jax.regret(params, policy, **arguments))
        # Sums on a GPU have no fixed order.
        difference = brl_jax.optimum(params, **arguments).returns - worth.returns - regret
        assert np.all(np.abs(difference) <= most * np.maximum(1, np.abs(worth.returns)))
        if "within" in arguments:
            return
        # A policy of the exact solver, whatever it is where the episode is over.
        exact = np.concatenate([np.asarray(solution.policy).ravel() for solution in best])
        own = brl_jax.optimum(params, **arguments).actions
        # Of one type, for which `evaluate` is compiled once.
        for taken in (exact.astype(own.dtype), own):
            worth = brl_jax.evaluate(params, taken, **arguments)
            assert max(errors(params, worth, best)) < most


SCORED = ("final-maze", "frozen-lake", "first-key", "cliff-walking", "ice-rink", "night-watch")


@pytest.mark.parametrize(("within", "limit"), [("max_steps", 400), (None, None)])
def test_success_and_advantage_are_those_of_scores(within: str | None, limit: int | None) -> None:
    levels = [brl.load(name).replace(max_steps=limit) for name in SCORED]
    with precision(is_x64=True):
        _, params = brl_jax.make(levels)
        # Other actions in other states, and some never: the advantages of steps differ.
        policy = np.random.default_rng(0).dirichlet(
            np.full(params.num_actions, 0.5), params.num_states
        )
        worth = brl_jax.evaluate(params, policy, within=within)
        gains = brl_jax.positive_advantage(params, policy, within=within)
        for number, level in enumerate(levels):
            own = policy[params.offset[number] : params.offset[number + 1]]
            score = brl.score(level, own, positive_advantage=True)[0]
            found = [float(each[number]) for each in (worth.success, worth.learnability, gains)]
            wanted = [score.success, score.learnability, score.positive_advantage]
            assert found == pytest.approx(wanted, rel=1e-9, abs=1e-12)
    success = np.asarray(worth.success)
    assert success.min() < 0.2 < success.max(), success


LARGE = {"version": 1, "size": [4, 4], "start": [[0, 0], [1, 0], [2, 0]], "exit": "none"}
ROOM = [
    LARGE | {"skid": {"probability": 0.5, "to": "others"}, "wind": {"north": [1, 0, 0, 0]}},
    LARGE | {"walls": [{"at": [0, 0], "side": "S", "pass": 0.5, "length": 4}]},
]
"""Levels with as many states, starts and outcomes as random ones can have."""


@pytest.mark.sweep
@settings(max_examples=30, deadline=None)
@given(world=worlds(4))
@pytest.mark.filterwarnings("ignore:with this policy")
def test_values_of_random_levels(world: World) -> None:
    level = brl.Level.from_fields(world)
    with precision(is_x64=True) as most:
        try:
            params = random_levels().load(level)
        except ValueError:
            assume(False)
        for arguments in ({"within": 6}, {"discount": 0.9}, {}):
            try:
                solution = brl.solve(level, **arguments)
                chance = brl.evaluate(level, "random", **arguments)
            except brl.UndefinedReturnError:
                continue
            best = brl_jax.optimum(params, **arguments)
            check(best, solution, most)
            worth = brl_jax.evaluate(params, brl_jax.random_policy(params), **arguments)
            check(worth, chance, most)
            if "within" not in arguments:
                check(brl_jax.evaluate(params, best.actions, **arguments), solution, most)


@cache
def random_levels() -> Any:
    return brl_jax.make(LARGE, room_for=ROOM)[0]


def check(found: Any, wanted: Any, most: float) -> None:
    """Compare values of a level, of which some may be infinite."""
    values = np.append(wanted.expected_return, wanted.values)
    own = np.append(found.returns, found.values[: wanted.values.size])
    endless = np.isinf(values)
    assert error(own[~endless], values[~endless]) < most
    for one, other in zip(own[endless], values[endless], strict=True):
        assert np.isnan(one) or one == other


# -- the same as by hand ---------------------------------------------------------------------


def expectation(mdp: Mdp, state: int, steps: int, policy: Any) -> float:
    """Return the expected return by following all outcomes; the best one without a policy."""
    if not steps:
        return 0.0
    found = [
        sum(
            chance * (reward + (0.0 if over else expectation(mdp, after, steps - 1, policy)))
            for chance, after, reward, over in mdp.outcomes(state, action)
        )
        for action in range(mdp.num_actions)
    ]
    return max(found) if policy is None else float(np.dot(policy[state], found))


def test_values_within_a_few_steps_are_expectations_over_all_that_can_happen() -> None:
    level = brl.Level.from_fields(
        {
            "version": 1,
            "size": [2, 2],
            "skid": {"probability": 0.25, "to": "others"},
            "areas": [{"at": [1, 0], "reward": -3}],
        }
    )
    mdp, _, params = level.compile(), *brl_jax.make(level)
    policy = np.random.default_rng(0).dirichlet(np.ones(5), 4)
    best = brl_jax.optimum(params, within=4)
    worth = brl_jax.evaluate(params, policy.astype(np.float32), within=4)
    for state in range(4):
        assert best.values[state] == pytest.approx(expectation(mdp, state, 4, None), rel=1e-5)
        assert worth.values[state] == pytest.approx(expectation(mdp, state, 4, policy), rel=1e-5)


# -- loops without end -----------------------------------------------------------------------


def test_a_policy_that_never_ends_is_infinitely_bad_in_its_level_alone() -> None:
    shut_in = CORNERS["a start that is shut in"]
    _, params = brl_jax.make([MAZES[0], shut_in, MAZES[1]])
    solutions = [brl.solve(level) for level in (MAZES[0], MAZES[1])]
    best = np.asarray(brl_jax.optimum(params).returns)
    assert best[[0, 2]].tolist() == [solution.expected_return for solution in solutions]
    assert np.isnan(best[1])
    stays = jnp.zeros(params.num_states, jnp.int32)
    worth = brl_jax.evaluate(params, stays)
    assert np.isneginf(worth.returns).all()
    assert (np.asarray(worth.values) <= 0).all()
    assert np.asarray(brl_jax.regret(params, stays))[[0, 2]].tolist() == [np.inf, np.inf]


def test_a_loop_without_rewards_is_worth_nothing() -> None:
    _, params = brl_jax.make({"version": 1, "size": [3, 1], "rewards": {"step": 0, "exit": 1}})
    right, left = np.full((2, 3), [[2], [4]])
    best = brl_jax.optimum(params)
    assert best.returns.tolist() == [1.0]
    # All actions have the same value, but not all of them end.
    assert brl_jax.evaluate(params, best.actions).returns.tolist() == [1.0]
    assert brl_jax.evaluate(params, right).returns.tolist() == [1.0]
    assert brl_jax.evaluate(params, left).returns.tolist() == [0.0]


# -- as functions of JAX ---------------------------------------------------------------------


def test_single_levels_and_many_policies_by_vmap() -> None:
    _, params = brl_jax.make(MAZES)
    together = brl_jax.optimum(params, within="max_steps")
    alone = jax.vmap(lambda one: brl_jax.optimum(one, within="max_steps"))(
        params.take(np.arange(len(MAZES)))
    )
    assert np.array_equal(alone.returns[:, 0], together.returns)
    policies = jnp.stack([brl_jax.random_policy(params), jnp.eye(5)[together.actions]])
    found = jax.jit(jax.vmap(lambda policy: brl_jax.regret(params, policy, within="max_steps")))(
        policies
    )
    assert (np.asarray(found[0]) > 0.5).all()
    scores = brl.score(MAZES, "random", within="max_steps")
    assert error(np.asarray(found[0]), np.array([score.regret for score in scores])) < 1e-5
    assert not np.asarray(found[1]).any()
    known = brl_jax.regret(params, policies[0], within="max_steps", best=together.returns)
    assert np.array_equal(known, found[0])


def test_rounding_of_probabilities_is_scaled_away() -> None:
    _, params = brl_jax.make(MAZES)
    policy = brl_jax.random_policy(params)
    rounded = brl_jax.evaluate(params, 1.001 * policy, within=9)
    exact = brl_jax.evaluate(params, policy, within=9)
    assert np.allclose(rounded.values, exact.values, rtol=1e-5)
    # What is traced cannot be checked.
    twice = jax.jit(lambda policy: brl_jax.evaluate(params, policy, within=9))(2 * policy)
    assert np.array_equal(twice.values, exact.values)


# -- arguments -------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("policy", "arguments", "message"),
    [
        (np.zeros(7, int), {}, r"integers \[96\], .* floats \[96, 5\], .* not .* shape \[7\]"),
        (np.zeros(96), {}, r"not one of float32 and shape \[96\]"),
        (np.zeros((96, 4)), {}, r"shape \[96, 4\]"),
        (np.zeros((96, 5), int), {}, r"not one of int32 and shape \[96, 5\]"),
        (np.zeros(96, int), {"within": 0}, "within must be a number of steps from 1 on"),
        (np.zeros(96, int), {"within": "limit"}, "or 'max_steps', not 'limit'"),
        (np.zeros(96, int), {"discount": 0}, "discount must be above 0 and at most 1, not 0"),
    ],
)
def test_arguments_are_checked_when_a_function_is_compiled(
    policy: Any, arguments: Any, message: str
) -> None:
    _, params = brl_jax.make(MAZES)
    with pytest.raises(ValueError, match=message):
        jax.jit(lambda given: brl_jax.regret(params, given, **arguments))(policy)


@pytest.mark.parametrize(
    ("policy", "message"),
    [
        (np.full(96, 5), r"an action is from 0 to 4, and in state 0 the policy has 5"),
        (np.full(96, -1), r"an action is from 0 to 4, and in state 0 the policy has -1"),
        (np.full((96, 5), 0.4), r"add up to 1, and in state 0 the policy has \[0.4"),
        (np.full((96, 5), np.nan), r"in state 0 the policy has \[nan"),
        (np.tile([2.0, -1, 0, 0, 0], (96, 1)), r"are not below 0, .* has \[2.0, -1.0"),
    ],
)
def test_policies_that_are_none_are_refused(policy: Any, message: str) -> None:
    _, params = brl_jax.make(MAZES)
    with pytest.raises(ValueError, match=message):
        brl_jax.evaluate(params, policy)
    # Where the episode is over, it does not matter what a policy has.
    ends = np.asarray(params.outcome[: params.num_rows]).reshape(96, 5) & 1
    is_over = ends.all(axis=1)
    assert is_over.any()
    right = np.asarray(brl_jax.random_policy(params)) if policy.ndim == 2 else np.zeros(96, int)
    policy = np.where(is_over.reshape(-1, *[1] * (policy.ndim - 1)), policy, right)
    assert np.isfinite(brl_jax.evaluate(params, policy, within=9).returns).all()
