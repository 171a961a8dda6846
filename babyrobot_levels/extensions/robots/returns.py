"""What several robots get in episodes: that is known without tables, but not the optimum."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Unpack

import numpy as np

from babyrobot_levels.analysis.solver.results import (
    check_count,
    check_discount,
    check_seed,
    check_within,
)
from babyrobot_levels.envs.arguments import (
    ObservationOptions,
    checked_observation,
    takes_observation,
)
from babyrobot_levels.envs.team import TeamEnv
from babyrobot_levels.extensions.robots.seeing import Sights
from babyrobot_levels.library.catalogue import LevelLike, load
from babyrobot_levels.mdp.states import has_succeeded
from babyrobot_levels.text.words import RANDOM, Telling

Agent = Callable[[Any], Any]


@dataclass(frozen=True)
class TeamReturns(Telling, public=True):
    """What several robots got in episodes, on average.

    It says nothing of the optimum, and so has no regret.

    Attributes:
        expected_return: the mean of the team's returns: the sum of what all robots get.
        error: its standard error.
        robots: the mean of what each robot gets, by its name.
        success: the share of episodes in which the robots have done what they are to do.
        steps: the mean number of steps.
        episodes: how many episodes were played.
        discount: the factor by which each further reward counts less.
    """

    expected_return: float
    error: float
    robots: dict[str, float]
    success: float
    steps: float
    episodes: int
    discount: float


@takes_observation
def team_returns(
    level: LevelLike,
    agents: str | Agent | Sequence[str | Agent] = "random",
    *,
    episodes: int = 100,
    seed: int = 0,
    within: int | str = "max_steps",
    discount: float | None = None,
    **options: Unpack[ObservationOptions],
) -> TeamReturns:
    """Play episodes, and return what several robots get on average.

    It takes levels with more joint states than there is room for in tables, too.

    Args:
        level: a name, a path, a mapping or a `Level` with several robots.
        agents: a function from the observation of `TeamEnv` to the action of each robot; or a list
            with what each robot does: a function from what it observes itself, as in
            `brl.parallel_env`, to its action. `"random"` takes any allowed action.
        episodes: how many.
        seed: seeds all chance.
        within: the number of steps after which an episode is over, or `"max_steps"` of the level.
        discount: above 0 and at most 1; by default, the level's.
        options: the observation, and its options, as for `TeamEnv`.

    Raises:
        LevelNotFoundError: there is no such level.
        LevelError: the level is not valid.
        InvalidAction: what an agent returns is no action.
        ValueError: another argument is invalid, or the level has one robot.
    """
    first = check_seed(seed)
    env, count = TeamEnv(level, observation="index"), check_count("episodes", episodes)
    given = load(level)
    limit = check_within(within, given.max_steps)
    assert limit is not None
    factor = check_discount(discount, given.discount)
    act = _player(agents, env, Sights(env, checked_observation(**options)), first)
    returns = np.zeros((count, len(env.robot_names)))
    success, steps = np.zeros(count, bool), np.zeros(count)
    for number in range(count):
        env.reset(seed=first if number == 0 else None)
        for step in range(limit):
            _, _, over, _, info = env.step(act())
            returns[number] += factor**step * info["rewards"]
            if over:
                now = env.level.configuration(env.level.numbering().configuration(env.state))
                success[number] = has_succeeded(env.level, now)
                break
        steps[number] = step + 1
    total = returns.sum(axis=1)
    spread = float(total.std(ddof=1)) if count > 1 else float("nan")
    return TeamReturns(
        expected_return=float(total.mean()),
        error=spread / count**0.5,
        robots=dict(zip(env.robot_names, returns.mean(axis=0).tolist(), strict=True)),
        success=float(success.mean()),
        steps=float(steps.mean()),
        episodes=count,
        discount=factor,
    )


def _player(agents: Any, env: TeamEnv, sights: Sights, seed: int | None) -> Callable[[], Any]:
    """Return a function that returns the action of each robot in the present state.

    Raises:
        ValueError: there is not an agent for each robot.
    """
    if isinstance(agents, str) or callable(agents):
        if callable(agents):
            return lambda: agents(sights.of(0))
        _check_word(agents)
        env.action_space.seed(seed)
        return env.action_space.sample
    if len(agents) != len(env.robot_names):
        raise ValueError(
            f"there are {len(agents)} agents for {len(env.robot_names)} robots: "
            f"{', '.join(env.robot_names)}"
        )
    for agent in agents:
        if not callable(agent):
            _check_word(agent)
    rng = np.random.default_rng(seed)

    def act() -> list[Any]:
        masks = env.robot_masks()
        return [
            agent(sights.of(number)) if callable(agent) else rng.choice(np.flatnonzero(mask))
            for number, (agent, mask) in enumerate(zip(agents, masks, strict=True))
        ]

    return act


def _check_word(agent: Any) -> None:
    if agent != RANDOM:
        raise ValueError(f"an agent is a function of what it observes, or 'random', not {agent!r}")
