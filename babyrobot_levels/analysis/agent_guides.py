"""What a page shows of an agent: its policy, where it is not optimal, and what that costs."""

from collections.abc import Iterator
from contextlib import suppress
from typing import Any

import numpy as np

from babyrobot_levels.analysis.guides import overlay_of
from babyrobot_levels.analysis.solver.evaluation import evaluation_of
from babyrobot_levels.analysis.solver.horizon import worth_within
from babyrobot_levels.analysis.solver.occupancy import occupancy
from babyrobot_levels.analysis.solver.policies import StateSpace, read_policy, space_of
from babyrobot_levels.analysis.solver.results import TURNS, EpisodeTooLongError, Solution
from babyrobot_levels.mdp.actions import Action
from babyrobot_levels.mdp.gridworld import GridWorld
from babyrobot_levels.mdp.tables import Flags, Floats
from babyrobot_levels.render.page_agent import Difference, PageAgent
from babyrobot_levels.render.page_format import rounded
from babyrobot_levels.render.scene.layout import Overlay
from babyrobot_levels.render.words.phrases import counted, limited, percent

MAX_DIFFERENCES = 30
"""The most states in which an agent differs that a page lists."""

_EQUAL, _ROUND = 1e-9, 1e-6
"""The share of a return up to which another one is equal, and a sum of costs is the regret."""


def weights_of_moves(level: GridWorld, policy: Any) -> Floats:
    """Return the probabilities of a policy of moves, in the order of `Action`, `[states, actions]`.

    Args:
        level: the level.
        policy: as `evaluate` takes it, for a robot that does not turn.

    Raises:
        ValueError: it is none, or one of a robot that turns, or one for each step.
    """
    if getattr(policy, "actions", None) == TURNS:
        raise ValueError("a film or a page cannot show a robot that turns; give a policy of moves")
    if getattr(policy, "policies", None) is not None:
        raise ValueError(
            "this policy changes with the step, and a page or a film shows one for all steps: "
            "give that of `brl.solve(level)`, or one of its `policies`"
        )
    table = getattr(policy, "policy", policy)
    if isinstance(table, np.ndarray) and table.dtype.kind == "f" and np.isnan(table).any():
        raise ValueError("this policy has no action in some states, and cannot be followed there")
    mdp, shape = level.compile(), np.shape(table)
    is_of_moves = len(shape) > 1 and shape[-1] == level.moves and shape != mdp.shape
    weights = read_policy(policy, space_of(level, "moves" if is_of_moves else "all"))
    return np.pad(weights, ((0, 0), (mdp.num_actions - weights.shape[1], 0)))


def page_agent(
    level: GridWorld, policy: Any, solution: Solution | None, best: float | None = None
) -> PageAgent:
    """Return what a page shows of an agent.

    Args:
        level: the level.
        policy: as `evaluate` takes it, for a robot that does not turn. The probabilities of a state
            may be nan, where the policy is not known: there it is optimal.
        solution: the solution of the level; None for a page that does not know the optimum.
        best: the optimal return within the level's limit, if it has one; nan if it is not known.

    Raises:
        ValueError: the policy is none for the level.
    """
    space = space_of(level, "all")
    weights, known = _known(level, policy)
    if solution is None:
        weights[~known] = 0.0
        return PageAgent(weights.tolist(), _overlay(level, space, policy=weights))
    weights[~known] = np.eye(weights.shape[1])[solution.policy.ravel()[~known]]
    return _beside(space, weights, solution, best)


def _known(level: GridWorld, policy: Any) -> tuple[Floats, Flags]:
    """Return a policy, and in which states it is known, `[states]`."""
    known = np.ones(level.compile().num_states, bool)
    if isinstance(policy, np.ndarray) and policy.dtype.kind == "f" and policy.ndim > 1:
        is_known = np.asarray(~np.isnan(policy).any(axis=-1))
        if is_known.size == known.size:
            known = is_known.ravel()
            policy = np.where(is_known[..., np.newaxis], policy, 1.0 / policy.shape[-1])
    return weights_of_moves(level, policy), known


def _beside(
    space: StateSpace, weights: Floats, solution: Solution, best: float | None
) -> PageAgent:
    """Return a policy beside the optimum."""
    level, figures = space.level, dict[str, list[str]]()
    if level.max_steps is not None and best is not None and not np.isnan(best):
        with suppress(EpisodeTooLongError):
            limits, discounts = [level.max_steps], [level.discount]
            worth = worth_within([space], limits, discounts, [weights], quick=True)
            figures[_regret(float(worth.returns[0]), best)] = [limited(level.max_steps)]
    values, visits = np.full((2, space.mdp.num_states), np.nan)
    regret = 0.0
    with suppress(ArithmeticError):
        found = evaluation_of(level, weights, level.discount, "all")
        values, regret = found.values, solution.expected_return - found.expected_return
        figure = _regret(found.expected_return, solution.expected_return)
        figures.setdefault(figure, []).append(limited(None))
        visits = occupancy(level, weights).states.ravel()
    wrong, costs = _costs(space, weights, solution)
    (states,) = np.nonzero(wrong.any(axis=1))
    told = [f"{figure} {' and '.join(limits)}." for figure, limits in figures.items()]
    told.append(_told(len(states), int((visits[states] > 0).sum())))
    with np.errstate(invalid="ignore"):
        lost = np.nan_to_num(costs[states] * visits[states], nan=0.0, posinf=np.inf)
    if np.isfinite(lost).all() and regret - lost.sum() > _ROUND * max(
        1.0, abs(solution.expected_return)
    ):
        told.append("Its episodes may go round in circles, at no cost of any single action.")
    order = states[np.lexsort((-costs[states], -lost))]
    fastest = solution.fastest.reshape(weights.shape)
    return PageAgent(
        weights.tolist(),
        _overlay(level, space, values=values, policy=weights),
        _overlay(level, space, values=costs, policy=wrong),
        told,
        [*_differences(space, order[:MAX_DIFFERENCES], weights, fastest, costs, visits)],
        max(0, len(order) - MAX_DIFFERENCES),
    )


def _costs(space: StateSpace, weights: Floats, solution: Solution) -> tuple[Floats, Floats]:
    """Return the probabilities of actions that are not optimal, and what a policy's actions cost.

    These are `[states, actions]`, and `[states]` with nan where all of them are optimal.
    """
    over: Flags = space.mdp.is_terminal | space.without_value
    greedy: Flags = solution.greedy.reshape(weights.shape)
    ahead = solution.action_values.reshape(weights.shape)
    wrong = np.where(greedy | over[:, np.newaxis], 0.0, weights)
    with np.errstate(invalid="ignore"):
        mean = np.where(weights > 0, weights * ahead, 0.0).sum(axis=1)
        return wrong, np.where(wrong.any(axis=1), solution.values.ravel() - mean, np.nan)


def _overlay(level: GridWorld, space: StateSpace, **tables: Floats) -> Overlay:
    found = {
        name: table.reshape(*space.mdp.shape, *table.shape[1:] if name == "policy" else ())
        for name, table in tables.items()
    }
    overlay = overlay_of(level, found)
    assert overlay is not None
    return overlay


def _regret(earned: float, best: float) -> str:
    told, lost = f"Return {rounded(earned)}, optimum {rounded(best)}", best - earned
    if not np.isnan(lost):
        # Both may be infinite.
        told += f": regret {rounded(0.0 if lost <= _EQUAL * max(1.0, abs(best)) else lost)}"
    return told


def _told(count: int, visited: int) -> str:
    if not count:
        return "Each of its actions is optimal without a limit."
    come = f"{visited:,}" if visited else "none"
    return f"Not optimal in {counted(count, 'state')}; its episodes come to {come} of them."


def _differences(
    space: StateSpace, states: Any, weights: Floats, best: Flags, costs: Floats, visits: Floats
) -> Iterator[Difference]:
    for state in states.tolist():
        yield Difference(
            cell=state % space.mdp.cells,
            where=space.text(state),
            action=_actions(weights[state]),
            optimal=" or ".join(_name(action) for action in np.flatnonzero(best[state]).tolist()),
            cost=_figure(costs[state]),
            visits=_figure(visits[state]),
        )


def _figure(value: float) -> str:
    return "\N{EN DASH}" if np.isnan(value) else rounded(float(value))


def _name(action: int) -> str:
    return str(Action(action))


def _actions(weights: Floats) -> str:
    """Return actions with their probabilities, if there is more than one."""
    found = [(_name(action), weights[action]) for action in np.flatnonzero(weights).tolist()]
    if len(found) == 1:
        return found[0][0]
    found.sort(key=lambda each: -each[1])
    return ", ".join(f"{name} {percent(share)}" for name, share in found)
