"""Systems of linear equations of many levels, solved side by side."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
from jax import Array, lax

ITERATIONS = 1000
"""The most iterations until a solution is refined."""

ROUNDS = 6
"""How often a solution is refined at most."""

_CONVERGED = 100
"""The largest residual of a solution, as a multiple of its rounding error."""


def solve(
    apply: Callable[[Array], Array], right: Array, group: Array, count: int
) -> tuple[Array, Array]:
    """Solve independent systems of linear equations, whose unknowns stand one after the other.

    Args:
        apply: multiplies unknowns, `[unknowns]`, with the matrices.
        right: the right sides, `[unknowns]`. Unknowns of rows of the identity matrix whose right
            sides are 0 stay 0.
        group: int32 `[unknowns]`, ascending: the number of each unknown's system.
        count: how many systems there are.

    Returns:
        The solutions, `[unknowns]`, and which systems have converged, `[count]`.
    """

    def dot(first: Array, second: Array) -> Array:
        return jax.ops.segment_sum(first * second, group, count, indices_are_sorted=True)

    def converged(found: Array, size: Array) -> Array:
        rounding = _CONVERGED * jnp.finfo(right.dtype).eps
        return size <= rounding**2 * dot(found, found)

    def refined(carry: Any) -> Any:
        rounds, found, residual, size, _ = carry
        # From a vector without structure: a residual of few entries may be orthogonal to the next.
        shadow = jax.random.normal(jax.random.key(rounds), right.shape, right.dtype)
        closer = found + _correction(apply, residual, shadow, group, dot)
        left = right - apply(closer)
        now = dot(left, left)
        better = now < size
        found = jnp.where(better[group], closer, found)
        residual = jnp.where(better[group], left, residual)
        after = jnp.where(better, now, size)
        return rounds + 1, found, residual, after, (now < size / 4) | ~converged(found, after)

    def going(carry: Any) -> Any:
        return (carry[0] < ROUNDS) & carry[-1].any()

    size = dot(right, right)
    start = 0, jnp.zeros_like(right), right, size, size > 0
    _, found, _, size, _ = lax.while_loop(going, refined, start)
    return found, converged(found, size)


def _correction(apply: Any, residual: Array, shadow: Array, group: Array, dot: Any) -> Array:
    """Return what solves the systems with these right sides roughly, by the method BiCGSTAB."""
    goal = jnp.finfo(residual.dtype).eps * dot(residual, residual)

    def step(carry: Any) -> Any:
        number, found, left, direction, past, size = carry
        ahead = apply(direction)
        length = _ratio(past, dot(shadow, ahead))
        half = left - length[group] * ahead
        after = apply(half)
        damping = _ratio(dot(after, half), dot(after, after))
        more = length[group] * direction + damping[group] * half
        rest = half - damping[group] * after
        now = dot(shadow, rest)
        turn = _ratio(now, past) * _ratio(length, damping)
        direction_now = rest + turn[group] * (direction - damping[group] * ahead)
        # Those that are good enough stay as they are.
        going = size > goal
        at = going[group]
        return (
            number + 1,
            jnp.where(at, found + more, found),
            jnp.where(at, rest, left),
            jnp.where(at, direction_now, direction),
            jnp.where(going, now, past),
            jnp.where(going, dot(rest, rest), size),
        )

    def going(carry: Any) -> Any:
        return (carry[0] < ITERATIONS) & (carry[-1] > goal).any()

    size = dot(residual, residual)
    past = dot(shadow, residual)
    start = 0, jnp.zeros_like(residual), residual, residual, past, size
    found: Array = lax.while_loop(going, step, start)[1]
    return found


def _ratio(part: Array, whole: Array) -> Array:
    """Return a quotient, 0 where it does not exist."""
    return jnp.where(whole != 0, part / jnp.where(whole != 0, whole, 1), 0)
