"""Rollouts of agents with memory, which play one episode after the other in an environment."""

from typing import Any, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.envs.engine.state import Record
from babyrobot_levels.envs.single import LevelEnv
from babyrobot_levels.library.level import Level


@runtime_checkable
class Player(Protocol):
    """An agent with memory: it is told when an episode begins."""

    def reset(self) -> None:
        """Forget the episode before."""

    def act(self, observation: Any, mask: Any) -> Any:
        """Return the action for the next observation of an episode; the mask is that of `info`."""


def follow(
    agent: Player,
    level: Level,
    record: Record,
    masks: NDArray[np.int8],
    seed: int | None,
    limit: int,
    **options: Any,
) -> None:
    """Fill a record with what an agent does, environment by environment.

    Args:
        agent: the agent.
        level: the level.
        record: the transitions, `[steps, envs]`.
        masks: the action masks before the actions, int8 `[steps, envs, actions]`.
        seed: a number that seeds the environments; None for an unpredictable one.
        limit: the number of steps after which episodes are truncated.
        options: the arguments of `LevelEnv`.
    """
    env = LevelEnv(level, **options)
    steps, size = record.rewards.shape
    for column, start in enumerate(np.random.SeedSequence(seed).generate_state(size).tolist()):
        observation, info = env.reset(seed=start)
        agent.reset()
        taken = 0
        for row in range(steps):
            at, before = (row, column), env.state
            action = agent.act(observation, info["action_mask"])
            masks[at] = info["action_mask"]
            # Refuses what is no action.
            observation, reward, terminated, _, info = env.step(action)
            taken += 1
            record.observations[at], record.actions[at], record.rewards[at] = (
                before,
                int(action),
                reward,
            )
            record.terminations[at], record.truncations[at] = terminated, taken >= limit
            record.next_observations[at] = env.state
            if terminated or taken >= limit:
                observation, info = env.reset()
                agent.reset()
                taken = 0
