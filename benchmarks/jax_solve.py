"""Solving many levels in JAX in one call, beside jaxdp, and `brl.solve` and `brl.score` level by
level.

    python benchmarks/jax_solve.py

All solve the same mazes of 8×8 cells with puddles, which are compiled before. `brl.solve` is exact
to rounding in 64 bits. JAX iterates in 32 bits, until no value changes, or as often as an episode
has steps; how far it is from `brl.solve` stands below the table. Regret is that of the random
policy; besides, `brl.score` returns its success and its steps.

jaxdp (tried: 0.4.0) has transitions as dense arrays, actions x states x states. Its value
iteration goes over all levels with `jax.vmap`, also until no value changes.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import report
from solve import level_of, maze
from timing import Comparison, Measure, compare_in_turns, installed, needing

import babyrobot_levels as brl

LEVELS = 1000
FEW = 200
"""How many the peer with dense arrays gets, 33 MB of them."""
SIZE = (8, 8)
DISCOUNT = 0.9
WITHIN = 100
"""After how many steps episodes are truncated, for regret."""

AIM = 1.5
"""How many times as fast as level by level all levels in one call have to be."""


def mazes(count: int) -> list[brl.Level]:
    """Return different mazes with puddles, compiled."""
    return [level_of(maze(SIZE, seed)) for seed in range(count)]


def optima(levels: Sequence[brl.Level]) -> Callable[[], Any]:
    """Return a compiled call that returns the optimal returns of levels."""
    import jax

    import babyrobot_levels.jax as brl_jax

    _, params = brl_jax.make(levels)
    solve = jax.jit(lambda params: brl_jax.optimum(params, discount=DISCOUNT).returns)
    return lambda: jax.block_until_ready(solve(params))


def regrets(levels: Sequence[brl.Level]) -> Callable[[], Any]:
    """Return a compiled call that returns the regret of the random policy in levels."""
    import jax

    import babyrobot_levels.jax as brl_jax

    _, params = brl_jax.make(levels)
    policy = brl_jax.random_policy(params)
    regret = jax.jit(partial(brl_jax.regret, within=WITHIN))
    return lambda: jax.block_until_ready(regret(params, policy))


def dense(level: brl.Level) -> tuple[Any, Any, Any, Any]:
    """Return transition `[action, next, state]`, reward `[action, state, next]`, start and ends."""
    mdp = level.compile()
    states, actions = mdp.num_states, mdp.num_actions
    transition = np.zeros((actions, states, states), np.float32)
    action, state = np.indices((actions, states))[:, :, :, None]
    np.add.at(
        transition, (action, mdp.next_state.swapaxes(0, 1), state), mdp.probability.swapaxes(0, 1)
    )
    mean = (mdp.probability * mdp.reward).sum(axis=2).T
    ends = np.unique(mdp.next_state[mdp.terminal])
    transition[:, :, ends] = 0
    transition[:, ends, ends] = 1
    mean[:, ends] = 0
    reward = np.broadcast_to(mean[:, :, None], transition.shape).astype(np.float32)
    terminal = np.zeros(states, np.float32)
    terminal[ends] = 1
    return transition, reward, mdp.start.astype(np.float32), terminal


def iterated(levels: Sequence[brl.Level]) -> Callable[[], Any]:
    """Return a compiled call of jaxdp that returns the optimal returns of levels."""
    import chex
    import jax
    from jaxdp import MDP, ValueIteration

    fields = ("transition", "reward", "initial", "terminal")
    arrays = (jax.numpy.asarray(np.stack(each)) for each in zip(*map(dense, levels), strict=True))
    worlds = MDP(**dict(zip(fields, arrays, strict=True)))
    planner = ValueIteration(gamma=DISCOUNT)

    def optimum(world: Any) -> Any:
        def sweep(carry: Any) -> Any:
            state = carry[1]
            return state.v_val, planner.update(world, state)

        state = planner.init(world)
        first = (state.v_val + 1, state)
        found = jax.lax.while_loop(lambda carry: (carry[0] != carry[1].v_val).any(), sweep, first)
        return found[1].v_val @ world.initial

    solve = jax.jit(jax.vmap(optimum))
    # Checks of values in compiled code would cost it time.
    chex.disable_asserts()
    try:
        solve(worlds)
    finally:
        chex.enable_asserts()
    return lambda: jax.block_until_ready(solve(worlds))


def rate_of(call: Callable[[], Any], count: int) -> Measure:
    """Return a measure of the levels per second of a call, the first of which is not measured."""
    call()

    def measure() -> float:
        begin = time.perf_counter()
        call()
        return count / (time.perf_counter() - begin)

    return measure


def measured(compiled: Callable[[Any], Callable[[], Any]], levels: Sequence[brl.Level]) -> Measure:
    """Return a measure of the levels per second of a call that has to be compiled."""
    return rate_of(compiled(levels), len(levels))


def solved(levels: Sequence[brl.Level]) -> list[float]:
    """Return the optimal return of each level."""
    return [brl.solve(level, DISCOUNT).expected_return for level in levels]


def scored(levels: Sequence[brl.Level]) -> list[float]:
    """Return the regret of the random policy in each level."""
    return [score.regret for score in brl.score(levels, "random", within=WITHIN)]


def compare(count: int, levels: int = LEVELS) -> Iterator[Comparison]:
    """Yield how many optima, and how many regrets, are computed per second."""
    made = mazes(levels)
    versions = installed("babyrobot-levels", "jax", "jaxdp", "numpy", "scipy")
    few = made[:FEW]
    yield compare_in_turns(
        f"levels per second, {len(few):,} mazes of 8x8",
        {"brl_jax.optimum": needing("jax gymnax", partial(measured, optima, few))},
        {"jaxdp.ValueIteration": needing("jax jaxdp", partial(measured, iterated, few))},
        count,
        aims={("brl_jax.optimum", "jaxdp.ValueIteration"): AIM},
        versions=versions,
    )
    for name, ours, peer, theirs in (
        ("brl_jax.optimum", optima, "brl.solve", solved),
        ("brl_jax.regret", regrets, "brl.score", scored),
    ):
        found = compare_in_turns(
            f"levels per second, {levels:,} mazes of 8x8",
            {name: needing("jax gymnax", partial(measured, ours, made))},
            {peer: rate_of(partial(theirs, made), levels)},
            count,
            aims={(name, peer): AIM},
            versions=versions,
        )
        if found.missing:
            yield found
        else:
            error = np.max(np.abs(np.asarray(ours(made)()) - np.asarray(theirs(made))))
            yield replace(found, note=f"{name}: at most {error:.1e} from {peer}")


if __name__ == "__main__":
    report.main(__doc__, compare)
