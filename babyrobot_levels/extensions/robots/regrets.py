"""How far a team is from its optimum, and what each robot loses by what it does itself."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from html import escape
from typing import Any

import numpy as np

from babyrobot_levels.analysis.solver.evaluation import chain_values
from babyrobot_levels.analysis.solver.optimum import optimum_of
from babyrobot_levels.analysis.solver.policies import StateSpace, read_policy, space_of
from babyrobot_levels.analysis.solver.results import check_discount
from babyrobot_levels.mdp.actions import NUM_ACTIONS
from babyrobot_levels.mdp.gridworld import LevelLike, world_of
from babyrobot_levels.mdp.states import state_text
from babyrobot_levels.mdp.tables import Floats, Mdp
from babyrobot_levels.text.words import Telling

_EQUAL = 1e-9
"""The share of a return by which it may differ from another one that is equal."""


@dataclass(frozen=True)
class RobotRegret(Telling, public=True):
    """What one robot gets, and could get, while the others do as they do.

    Attributes:
        name: its name.
        expected_return: what it can expect to get.
        best_return: what it could expect with the policy that is best for it, while those of the
            others stay as they are.
        regret: the difference: what it loses by its own choices.
        team_return: what the team could expect, if this robot alone chose what is best for all.
        team_regret: what the team loses by the choices of this robot, while those of the others
            stay as they are.
    """

    name: str
    expected_return: float
    best_return: float
    regret: float
    team_return: float
    team_regret: float


@dataclass(frozen=True)
class TeamScore(Telling, public=True):
    """How good the policies of several robots are together.

    Attributes:
        expected_return: what the team can expect: the sum of what all robots get, times the weight
            of each.
        best_return: the optimum of the team.
        regret: the difference.
        coordination: the part of it that no robot could save alone: `best_return` less the largest
            `team_return` of a robot.
        robots: what each robot gets and could get.
        is_equilibrium: whether no robot could get more by choosing otherwise alone.
        discount: the factor by which each further reward counts less.
    """

    expected_return: float
    best_return: float
    regret: float
    coordination: float
    robots: tuple[RobotRegret, ...]
    is_equilibrium: bool
    discount: float

    def _repr_mimebundle_(self, include: Any = None, exclude: Any = None) -> dict[str, Any]:
        heads = ("robot", "return", "best answer", "regret", "team's loss by it")
        rows = [
            (each.name, each.expected_return, each.best_return, each.regret, each.team_regret)
            for each in self.robots
        ]
        rows.append(("team", self.expected_return, self.best_return, self.regret, self.regret))
        body = "".join(
            f"<tr>{''.join(f'<td>{escape(_cell(cell))}</td>' for cell in row)}</tr>" for row in rows
        )
        head = "".join(f"<th>{each}</th>" for each in heads)
        table = f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"
        return {"text/html": table, "text/plain": repr(self)}


def _cell(value: str | float) -> str:
    return value if isinstance(value, str) else f"{value:.6g}"


def score_team(
    level: LevelLike,
    policies: Any,
    discount: float | None = None,
    *,
    weights: Sequence[float] | None = None,
) -> TeamScore:
    """Return how far several robots are from the optimum of the team, and whose loss it is.

    All is exact: it is computed by the tables of the level.

    Args:
        level: a name, a path, a mapping or a `Level` with several robots.
        policies: either what all do together: a `Solution`, `"best"`, `"random"`, `"uniform"`, or
            an array of joint actions or of their probabilities as `brl.evaluate` takes it. Or a
            list with what each robot does: arrays `[states]` of its actions, or `[states, 5]` of
            their probabilities; `"random"` stands for all that are allowed, evenly.
        discount: above 0 and at most 1; by default, the level's.
        weights: how much what each robot gets counts for the team, in the order of the level; by
            default, 1 for each. What a robot itself gets is not weighted.

    Raises:
        LevelNotFoundError: there is no such level.
        LevelError: the level is not valid, or has one robot.
        ValueError: another argument has an invalid value.
        UndefinedReturnError: there is no discount, and rewards cancel out in a loop without end.
        EpisodeTooLongError: there is no discount, and on average it takes more than 10^10 steps to
            end.
    """
    world = world_of(level)
    if not world.robots:
        raise ValueError("the level has one robot; `brl.evaluate` tells how good a policy is")
    factor = check_discount(discount, world.discount)
    space = space_of(world, "all", factor)
    counts = _counts(space, weights)
    space = replace(space, mdp=_weighted(space.mdp, counts))
    joint = _joint_weights(space, policies)
    expected = _returns(space, joint, factor)
    total = float(counts @ expected)
    model = space.model()
    best = space.at_start(model, optimum_of(model, space, factor).found.values)
    robots = tuple(
        _regret(space, joint, number, share, total, factor) for number, share in enumerate(expected)
    )
    slack = _EQUAL * max(1.0, abs(best), *(abs(each.best_return) for each in robots))
    return TeamScore(
        expected_return=total,
        best_return=best,
        regret=best - total,
        coordination=best - max(each.team_return for each in robots),
        robots=robots,
        is_equilibrium=all(each.regret <= slack for each in robots),
        discount=factor,
    )


def _joint_weights(space: StateSpace, policies: Any) -> Floats:
    """Return the probability of each joint action, `[states, joint actions]`."""
    mdp = space.mdp
    is_list = isinstance(policies, Sequence) and not isinstance(policies, str)
    if not is_list or len(policies) != mdp.num_robots:
        if is_list:
            names = ", ".join(robot.name for robot in space.level.robots)
            raise ValueError(
                f"there are {len(policies)} policies for {mdp.num_robots} robots: {names}"
            )
        return read_policy(policies, space)
    joint = np.ones((mdp.num_states, 1))
    for number, policy in enumerate(policies):
        own = _own_weights(space, policy, number)
        joint = (joint[:, :, None] * own[:, None, :]).reshape(mdp.num_states, -1)
    joint[mdp.is_terminal] = 0.0
    return joint


def _own_weights(space: StateSpace, policy: Any, number: int) -> Floats:
    """Return the probability of each action of one robot, `[states, 5]`."""
    mdp, name = space.mdp, space.level.robots[number].name
    states = np.flatnonzero(~mdp.is_terminal)
    masks = mdp.action_mask.reshape(mdp.num_states, *[NUM_ACTIONS] * mdp.num_robots)
    others = tuple(axis for axis in range(1, masks.ndim) if axis != number + 1)
    allowed = masks.max(axis=others).astype(float)
    if isinstance(policy, str) and policy == "random":
        even: Floats = allowed / allowed.sum(axis=1, keepdims=True)
        return even
    table = np.asarray(policy)
    weights = np.zeros((mdp.num_states, NUM_ACTIONS))
    if table.size == mdp.num_states and table.dtype.kind in "iu":
        chosen = table.ravel()[states]
        if (wrong := (chosen < 0) | (chosen >= NUM_ACTIONS)).any():
            at = state_text(space.level.things(), mdp, int(states[wrong][0]))
            raise ValueError(
                f"the action of {name} at {at} is {int(chosen[wrong][0])}; actions are 0 to 4"
            )
        weights[states, chosen] = 1.0
        return weights
    if table.size == weights.size and table.dtype.kind == "f":
        weights[states] = table.reshape(weights.shape)[states]
        total = weights[states].sum(axis=1)
        # Comparisons with nan are false.
        if not ((weights >= 0).all() and (np.abs(total - 1) <= 1e-6).all()):
            raise ValueError(f"the probabilities of {name} must not be negative and add up to 1")
        weights[states] /= total[:, None]
        return weights
    given = f"an array of shape {list(table.shape)}" if table.ndim else repr(policy)
    raise ValueError(
        f"the policy of {name} is an array [{mdp.num_states}] of actions, or "
        f"[{mdp.num_states}, {NUM_ACTIONS}] of probabilities, or 'random', not {given}"
    )


def _returns(space: StateSpace, weights: Floats, discount: float) -> list[float]:
    """Return what each robot can expect to get."""
    found = []
    for count in np.eye(space.mdp.num_robots):
        own = replace(space, mdp=_weighted(space.mdp, count))
        model = own.model()
        chain = model.mixed(weights[model.states])
        found.append(own.at_start(model, chain_values(chain, discount, own)))
    return found


def _counts(space: StateSpace, weights: Sequence[float] | None) -> Floats:
    """Return how much what each robot gets counts for the team, `[robots]`."""
    robots = space.mdp.num_robots
    counts = np.ones(robots) if weights is None else np.asarray(weights)
    is_numbers = counts.shape == (robots,) and counts.dtype.kind in "iuf"
    if not is_numbers or not np.isfinite(counts).all() or counts.min() < 0:
        raise ValueError(f"weights are {robots} numbers, one for each robot and none below 0")
    return counts.astype(float)


def _weighted(mdp: Mdp, counts: Floats) -> Mdp:
    """Return the tables in which rewards are the sum of what robots get, each times its count."""
    assert mdp.shares is not None
    return replace(mdp, reward=mdp.shares @ counts)


def _regret(
    space: StateSpace, weights: Floats, number: int, expected: float, total: float, discount: float
) -> RobotRegret:
    """Return what one robot, and the team by it, loses while the others do as they do."""
    best, team = (
        _best_answer(replace(space, mdp=mdp), weights, number, discount)
        for mdp in (_weighted(space.mdp, np.eye(space.mdp.num_robots)[number]), space.mdp)
    )
    return RobotRegret(
        name=space.level.robots[number].name,
        expected_return=expected,
        best_return=best,
        regret=best - expected,
        team_return=team,
        team_regret=team - total,
    )


def _best_answer(space: StateSpace, weights: Floats, number: int, discount: float) -> float:
    """Return the best return of one robot that knows what the others do in each state."""
    alone = replace(space, mdp=_answered(space.mdp, weights, number))
    model = alone.model()
    return alone.at_start(model, optimum_of(model, alone, discount).found.values)


def _answered(mdp: Mdp, weights: Floats, number: int) -> Mdp:
    """Return the tables for the actions of one robot, with those of the others drawn.

    Its outcomes are those of all joint actions with its own, each as likely as the others choose
    it, whatever this robot does itself by its policy.
    """
    robots, width = mdp.num_robots, mdp.probability.shape[2]
    shape = mdp.num_states, *[NUM_ACTIONS] * robots

    def by_own(table: Any) -> Any:
        """Return a table `[states, joint, …]` as `[states, own, others, …]`."""
        more = table.shape[2:]
        moved = np.moveaxis(table.reshape(*shape, *more), number + 1, 1)
        return moved.reshape(mdp.num_states, NUM_ACTIONS, -1, *more)

    # What the others do: the joint probabilities without the robot's own action.
    others = by_own(weights[:, :, None])[..., 0].sum(axis=1)
    total = others.sum(axis=1, keepdims=True)
    others = np.divide(others, total, out=np.zeros_like(others), where=total > 0)
    others[mdp.is_terminal, 0] = 1.0
    chances = by_own(mdp.probability) * others[:, None, :, None]
    flat = mdp.num_states, NUM_ACTIONS, chances.shape[2] * width
    return replace(
        mdp,
        probability=chances.reshape(flat),
        next_state=np.ascontiguousarray(by_own(mdp.next_state).reshape(flat)),
        reward=np.ascontiguousarray(by_own(mdp.reward).reshape(flat)),
        terminal=np.ascontiguousarray(by_own(mdp.terminal).reshape(flat)),
        action_mask=by_own(mdp.action_mask[:, :, None])[..., 0].max(axis=2),
        intended_next_state=np.zeros((mdp.num_states, NUM_ACTIONS), np.int32),
        obstruction=np.zeros((mdp.num_states, NUM_ACTIONS), np.int8),
        shares=None,
    )
