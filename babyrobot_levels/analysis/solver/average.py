"""The long-run average reward: the gain of a policy, its bias, and the best of both.

Policy iteration for processes with several recurrent classes (Howard 1960; Puterman, Markov
Decision Processes, 1994, section 9.2). Where an episode is over, the gain is 0.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from babyrobot_levels.analysis.solver.linear import ZERO, cycles, expected_sums, iterate_policies
from babyrobot_levels.analysis.solver.model import Model, closed_classes
from babyrobot_levels.analysis.solver.policies import Policy, StateSpace, read_policy
from babyrobot_levels.analysis.solver.results import ACTION_SETS, EpisodeTooLongError, Result
from babyrobot_levels.mdp.gridworld import GridWorld
from babyrobot_levels.mdp.tables import Flags, Floats, Ints
from babyrobot_levels.text.words import check_choice

CRITERIA = ("return", "average")
"""What can be optimal: the expected return, or the average reward of a step in the long run."""

MAX_ROUNDS = 1000
"""A bound that rounding cannot exceed: a policy that is no better ends the iteration."""

NEARLY_FOR_EVER = 0.999
"""The discount factor of the policy with which the iteration begins."""

ROUNDING = 10 * ZERO
"""Differences by this share of the largest reward, or bias, are rounding."""


@dataclass(frozen=True, eq=False)
class AverageEvaluation(Result, public=True):
    """The long-run average reward of a policy. All arrays are read-only.

    Arrays have the shape of the tables, which is `[height, width]` in what follows: see
    `Evaluation`, also for the numbers of actions.

    Attributes:
        gain: the average reward of a step in the long run from each cell, float64
            `[height, width]`: 0 where the episode is over or surely ends, nan at blocked cells
            and, in a configuration, where no episode can come.
        bias: how much more than the gain of so many steps a cell earns in all, float64
            `[height, width]`; on average 0 over the cells of a loop.
        expected_gain: the expected gain from the level's starts.
        multichain: whether the gain differs between cells in which an episode can be.
        actions: `"all"`, `"moves"` or `"turns"`.
        level: the level.
    """

    gain: Floats
    bias: Floats
    expected_gain: float
    multichain: bool
    actions: str
    level: GridWorld

    @property
    def first_action(self) -> int:
        """The `brl.Action` that is number 0 here: 0 with `"all"`, 1 with `"moves"`."""
        return int(ACTION_SETS[self.actions])

    @property
    def explanation(self) -> str | None:
        """Which gains there are, as a sentence; None where there is one for all cells."""
        if not self.multichain:
            return None
        least, most = np.nanmin(self.gain), np.nanmax(self.gain)
        return (
            "the long-run average reward depends on the cell (the process is multichain): it is "
            f"{least:.6g} to {most:.6g}"
        )

    def __repr__(self) -> str:
        kind = " multichain" if self.multichain else ""
        return f"<{type(self).__name__} expected_gain={self.expected_gain:.6g}{kind}>"


@dataclass(frozen=True, eq=False, repr=False)
class AverageSolution(AverageEvaluation, public=True):
    """The greatest long-run average reward: an `AverageEvaluation` of an optimal policy, and more.

    Attributes:
        greedy: all actions that are optimal but for rounding, bool `[height, width, actions]`.
        policy: one optimal action for each cell, int64 `[height, width]`; -1 at blocked and
            terminal cells.
        iterations: how many policies were evaluated on the way.
        residual: the largest violation of the optimality equation.
    """

    greedy: Flags
    policy: Ints
    iterations: int
    residual: float


def is_average(criterion: str, **others: object) -> bool:
    """Return whether the average reward is asked for, and not the return.

    Args:
        criterion: what shall be optimal.
        others: arguments that are for returns only.

    Raises:
        ValueError: there is no such criterion; or it has no use for one of the others.
    """
    check_choice("criterion", criterion, CRITERIA)
    given = [name for name, value in others.items() if value is not None]
    if criterion == "average" and given:
        raise ValueError(f"`{given[0]}` is for returns, not for the average reward; leave it out")
    return criterion == "average"


def solve_average(space: StateSpace) -> AverageSolution:
    """Return the greatest long-run average reward of a level, and an optimal policy.

    Raises:
        EpisodeTooLongError: it takes more than 10^10 steps on average to come round.
    """
    model, mdp = space.model(), space.mdp
    policy, gain, bias, rounds = _iterated(model)
    ahead = _ahead(model, gain, bias)
    greedy = np.zeros((mdp.num_states, ahead.shape[1]), bool)
    greedy[model.states] = ahead >= (gain + bias - 10 * _slack(model, bias))[:, None]
    chosen = np.full(mdp.num_states, -1)
    chosen[model.states] = policy
    residual = np.abs(gain + bias - ahead.max(axis=1, initial=-np.inf)).max(initial=0.0)
    return AverageSolution(
        **_told(space, model, gain, bias),
        greedy=greedy.reshape(*mdp.shape, -1),
        policy=chosen.reshape(mdp.shape),
        iterations=rounds,
        residual=float(residual),
    )


def evaluate_average(space: StateSpace, policy: Policy) -> AverageEvaluation:
    """Return the long-run average reward of a policy; errors are those of `solve_average`."""
    model = space.model()
    gain, bias = averages(model.mixed(read_policy(policy, space)[model.states]))
    return AverageEvaluation(**_told(space, model, gain, bias))


def _told(space: StateSpace, model: Model, gain: Floats, bias: Floats) -> dict[str, Any]:
    found = gain[np.isin(model.states, space.reached)]
    spread = np.ptp(found) if found.size else 0.0
    return {
        "gain": space.spread(model, gain),
        "bias": space.spread(model, bias),
        "expected_gain": space.at_start(model, gain),
        "multichain": bool(spread > ROUNDING * _largest(model)),
        "actions": space.actions,
        "level": space.level,
    }


# -- a policy ------------------------------------------------------------------------------


def averages(chain: Model) -> tuple[Floats, Floats]:
    """Return the gain and the bias of each state of a chain, `[n]` each.

    Raises:
        EpisodeTooLongError: it takes more than 10^10 steps on average to come round.
    """
    label = closed_classes(chain)
    kept, homes = np.flatnonzero(label >= 0), np.zeros(chain.size, bool)
    homes[kept[np.unique(label[kept], return_index=True)[1]]] = True

    def at_home(chain: Model) -> Floats:
        """Return the average reward of a step between visits of homes, 0 elsewhere."""
        total, steps = cycles(chain, homes).T
        return np.where(homes, total / steps, 0.0)

    gain = _reached(chain, label, homes, at_home(chain))
    less = chain.reward[:, 0] - gain
    bias = np.zeros(chain.size)
    bias[~homes] = expected_sums(chain.restrict(~homes), less[~homes], 1.0)
    shift = _reached(chain, label, homes, at_home(chain.with_rewards(bias[:, None])))
    return gain, bias - shift


def _reached(chain: Model, label: Ints, homes: Flags, values: Floats) -> Floats:
    """Return the expected value of the home that is reached, `[n]`; the end has 0."""
    known, closed = np.append(values, 0.0), label >= 0
    order = np.argsort(label[homes])
    places = np.searchsorted(label[homes], label[closed], sorter=order)
    known[:-1][closed] = values[homes][order][places]
    step = (chain.probability[:, 0] * known[chain.next_state[:, 0]]).sum(axis=1)
    found: Floats = known[:-1]
    found[~closed] = expected_sums(chain.restrict(~closed), step[~closed], 1.0)
    return found


# -- the best ------------------------------------------------------------------------------


def _largest(model: Model) -> float:
    return float(np.abs(model.reward[model.allowed]).max(initial=0.0))


def _slack(model: Model, bias: Floats) -> float:
    return ROUNDING * max(_largest(model), float(np.abs(bias).max(initial=0.0)))


def _gains_ahead(model: Model, gain: Floats) -> Floats:
    """Return the gain after each action, `[n, actions]`; -inf for those that may not be taken."""
    return model.with_rewards(np.where(model.allowed, 0.0, -np.inf)).action_values(gain, 1.0)


def _ahead(model: Model, gain: Floats, bias: Floats) -> Floats:
    """Return reward and bias after the actions that keep the gain, `[n, actions]`; else -inf."""
    keeps = _gains_ahead(model, gain) >= (gain - ROUNDING * _largest(model))[:, None]
    return np.where(keeps, model.action_values(bias, 1.0), -np.inf)


def _iterated(model: Model) -> tuple[Ints, Floats, Floats, int]:
    """Return an optimal policy, its gain and bias, `[n]` each, and how many were evaluated.

    A round improves the gain where it can; only where it can nowhere, the bias.
    """
    rows = np.arange(model.size)
    # What is best of a distant future is nearly best for ever, and found soon.
    policy = iterate_policies(model, NEARLY_FOR_EVER, start=model.reward.argmax(axis=1)).policy
    for rounds in range(1, MAX_ROUNDS + 1):
        gain, bias = averages(model.under(policy))
        ahead, now, slack = _gains_ahead(model, gain), gain, ROUNDING * _largest(model)
        if not (ahead > (now + slack)[:, None]).any():
            ahead, now, slack = _ahead(model, gain, bias), gain + bias, _slack(model, bias)
        best = ahead.argmax(axis=1)
        better = ahead[rows, best] > now + slack
        if not better.any():
            return policy, gain, bias, rounds
        policy = np.where(better, best, policy)
    raise EpisodeTooLongError("rewards differ by too much for the average reward to be found")
