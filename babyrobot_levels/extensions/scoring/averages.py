"""Scores by the average reward of a step in the long run, in levels that go on for ever."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from babyrobot_levels.agents.agents import Chooser, Table
from babyrobot_levels.agents.policy_tables import policy_of
from babyrobot_levels.analysis.solver.average import (
    AverageSolution,
    evaluate_average,
    solve_average,
)
from babyrobot_levels.analysis.solver.evaluation import episode
from babyrobot_levels.analysis.solver.policies import Policy, StateSpace, read_policy, space_of
from babyrobot_levels.analysis.solver.results import probability
from babyrobot_levels.envs.observations import make_observer
from babyrobot_levels.envs.observations.base import Extent, Observation
from babyrobot_levels.extensions.scoring.results import LevelScore, share
from babyrobot_levels.library.level import Level


def average_scores(
    agent: Table | Chooser,
    levels: Sequence[Level],
    observation: Observation,
    extent: Extent,
    actions: str,
) -> Iterator[LevelScore]:
    """Yield the scores of an agent without memory; errors are those of `score`."""
    for level in levels:
        space = space_of(level, actions)
        best = solve_average(space)
        if isinstance(agent, Table):
            policy = agent.of(level.name, level.digest)
        else:
            policy = policy_of(agent, space, make_observer(level, observation, extent), None)(0)
        is_best = isinstance(policy, str) and policy == "best"
        yield _row(space, best.policy if is_best else policy, best)


def _row(space: StateSpace, policy: Policy, best: AverageSolution) -> LevelScore:
    earned = evaluate_average(space, policy).expected_gain
    chance = evaluate_average(space, "random").expected_gain
    model = space.model()
    steps, success = episode(model.mixed(read_policy(policy, space)[model.states]))
    return LevelScore(
        level=space.level.name or space.level.digest,
        digest=space.level.digest,
        expected_return=earned,
        optimum=best.expected_gain,
        random=chance,
        share=share(earned, chance, best.expected_gain),
        regret=best.expected_gain - earned,
        success=probability(space.at_start(model, success)),
        steps=space.at_start(model, steps),
        within=None,
        discount=1.0,
        episodes=0,
        low=earned,
        high=earned,
    )
