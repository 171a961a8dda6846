"""Recording: a wrapper that appends each episode of an environment to a file."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import gymnasium
from gymnasium.utils import RecordConstructorArgs
from gymnasium.wrappers import TimeLimit

from babyrobot_levels.envs.single import LevelEnv
from babyrobot_levels.language.play import MAX_STEPS, PlayError, program
from babyrobot_levels.library.level import Level
from babyrobot_levels.scoring.plays.files import Play, append_play, check_appendable
from babyrobot_levels.scoring.plays.verify import return_of


class RecordPlay(gymnasium.Wrapper[Any, Any, Any, Any], RecordConstructorArgs):
    """Appends each episode of an environment to a file, as a line, when it ends.

    An episode that `reset` or `close` ends before its end is recorded as unfinished, unless no step
    was taken. The observation may be any; wrappers that change actions or rewards must be around
    this one and not in it.
    """

    __module__ = "babyrobot_levels"

    def __init__(self, env: gymnasium.Env[Any, Any], path: str | os.PathLike[str]):
        """Wrap an environment.

        Args:
            env: an environment of this package: of a level or a suite.
            path: the file, such as `ada.brlplay`, which may have plays already.

        Raises:
            TypeError: it is no environment of this package, or actions or rewards are changed in
                it.
            OSError: the file cannot be written.
            PlayError: the last line of the file is cut off.
        """
        RecordConstructorArgs.__init__(self, path=str(path))
        super().__init__(env)
        if not isinstance(env.unwrapped, LevelEnv):
            raise TypeError(
                f"RecordPlay records environments of levels, not {type(env.unwrapped).__name__}"
            )
        self._base: LevelEnv = env.unwrapped
        self._limit: int | None = None
        while isinstance(env, gymnasium.Wrapper):
            if isinstance(env, gymnasium.ActionWrapper | gymnasium.RewardWrapper):
                raise TypeError(
                    f"{type(env).__name__} changes actions or rewards; wrap the environment in "
                    "RecordPlay first"
                )
            if isinstance(env, TimeLimit):
                limits = [self._limit, env._max_episode_steps]
                self._limit = min(limit for limit in limits if limit is not None)
            env = env.env
        self._path = Path(path)
        check_appendable(self._path)
        self._coded: tuple[Level, str] | None = None
        self._begin(None, chosen=False)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Any, dict[str, Any]]:
        """Start an episode; the one before is recorded if it did not end."""
        observation, info = super().reset(seed=seed, options=options)
        self._write()
        # Where the seed gives the level, too, the same seed gives another episode in the level.
        is_own = not {"maze_seed", "level_index"} & info.keys()
        self._begin(seed if is_own else None, chosen=(options or {}).get("start") is not None)
        return observation, info

    def step(self, action: Any) -> tuple[Any, Any, bool, bool, dict[str, Any]]:
        """Take an action, and record the episode if it ends.

        Raises:
            PlayError: the episode is longer than a play can be.
        """
        found = super().step(action)
        _, reward, terminated, truncated, _ = found
        if self._is_over:
            # Nothing counts after the end.
            return found
        if len(self._actions) == MAX_STEPS:
            raise PlayError(f"a play has at most {MAX_STEPS:,} steps; set a time limit")
        self._actions.append(int(action))
        self._rewards.append(float(reward))
        self._states.append(self._base.state)
        if terminated or truncated:
            is_late = len(self._actions) == self._limit
            self._write("terminated" if terminated else "truncated" if is_late else "unfinished")
        return found

    def close(self) -> None:
        """Close the environment; an episode that did not end is recorded."""
        self._write()
        super().close()

    def _begin(self, seed: int | None, *, chosen: bool) -> None:
        self._level = self._base.level
        self._seed = None if seed is None else str(seed)
        self._start = "chosen" if chosen else "drawn"
        self._states = [self._base.state]
        self._actions: list[int] = []
        self._rewards: list[float] = []
        self._is_over = False

    def _write(self, end: str = "unfinished") -> None:
        """Append the episode, unless that is done, or it has no step."""
        if self._is_over or not self._actions:
            return
        self._is_over = True
        level = self._level
        if self._coded is None or self._coded[0] is not level:
            self._coded = level, level.share_code()
        play = Play.model_validate(
            {
                "name": level.name,
                "digest": level.digest,
                "code": self._coded[1],
                "action_set": self._base.action_set,
                "discount": level.discount,
                "max_steps": self._limit,
                "seed": self._seed,
                "seed_kind": "environment",
                "start": self._start,
                "states": self._states,
                "actions": self._actions,
                "rewards": self._rewards,
                "return": return_of(self._rewards, level.discount),
                "end": end,
                "made_by": program(),
            }
        )
        append_play(self._path, play)
