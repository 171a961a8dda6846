"""Plays: episodes as lines of a file, read, appended, and recorded from an environment."""

import os
from contextlib import suppress
from functools import lru_cache
from pathlib import Path
from typing import IO, Any
from weakref import WeakValueDictionary

import gymnasium
from gymnasium.utils import RecordConstructorArgs
from gymnasium.wrappers import TimeLimit

from babyrobot_levels.envs.single import LevelEnv
from babyrobot_levels.language.play import (
    MAX_LINE,
    MAX_STEPS,
    NoPlaysError,
    PlayError,
    PlayFields,
    program,
)
from babyrobot_levels.library.level import Level, load_code
from babyrobot_levels.text.errors import LevelError
from babyrobot_levels.text.files import append_line, open_regular

SUFFIX = ".brlplay"

MAX_BYTES = 64 << 20
"""The most bytes of a file."""

MAX_PLAYS = 100_000
"""The most plays of a file."""


class Play(PlayFields):
    """An episode in a level as a file has it; see `brl.read_plays`.

    Attributes:
        name: the name of the level.
        digest: its digest.
        code: its share code.
        action_set: `"all"`, `"moves"` or `"turns"`.
        discount: the factor by which each further reward counts less in `return_`.
        max_steps: the number of steps after which the episode is truncated; None for no limit.
        seed: the seed of the episode, in decimal digits; None where it is unknown.
        seed_kind: `"environment"` or `"page"`.
        start: whether the first state was `"drawn"` or `"chosen"`.
        states: the state at the start and after each step, `[steps + 1]`.
        actions: the action of each step, `[steps]`; of several robots, the number of their joint
            action, as `Mdp.joint_action` gives it.
        rewards: the reward of each step, `[steps]`.
        return_: the discounted sum of the rewards.
        end: `"terminated"`, `"truncated"` or `"unfinished"`.
        hints: how many hints the player asked for, as the game tells.
        undone: how many steps the player took back, as the game tells.
        watched: how many steps the policy took that the player watched, as the game tells.
        player: who played, as the page was told; None where it was not.
        made_by: the program that wrote it.
    """

    __module__ = "babyrobot_levels"

    @property
    def level(self) -> Level:
        """The level of the share code, which need not be the one of the digest: see `brl.replay`.

        Raises:
            LevelError: the code is damaged, or its level is not valid.
        """
        return _at_hand.get(self.code) or _level_of(self.code)

    def __repr__(self) -> str:
        return (
            f"<Play of {self.name or self.digest[:15]!r}: {self.steps} steps, "
            f"return {self.return_:g}, {self.end}>"
        )

    __str__ = __repr__


_at_hand: WeakValueDictionary[str, Level] = WeakValueDictionary()
"""Levels by their share codes, which have their tables already."""


def recognise(level: Level) -> None:
    """Have the plays that are of a level take it as it is, and not compile it again."""
    with suppress(LevelError):
        _at_hand[level.share_code()] = level


@lru_cache(maxsize=64)
def _level_of(code: str) -> Level:
    return load_code(code)


def read_plays(path: str | os.PathLike[str]) -> list[Play]:
    """Return the plays of a `.brlplay` file. They are not verified; see `brl.replay`.

    Args:
        path: the file: one play per line, at most 100,000, and at most 64 MiB.

    Raises:
        OSError: the file cannot be read.
        PlayError: there is none, it is too large, or one of its lines is damaged or no play; the
            message begins with `file:line`.
    """
    try:
        with open_regular(Path(path)) as file:
            if os.fstat(file.fileno()).st_size > MAX_BYTES:
                raise PlayError(f"{path}: the file is larger than {MAX_BYTES >> 20} MiB")
            return plays_in(file, os.fspath(path))
    except FileNotFoundError:
        raise NoPlaysError(f"there is no file {os.fspath(path)!r}") from None


def plays_in(file: IO[bytes], name: str) -> list[Play]:
    """Return the plays of an open file.

    Args:
        file: the file.
        name: what messages call it.

    Raises:
        PlayError: as of `read_plays`.
    """
    plays: list[Play] = []
    for number, line in enumerate(iter(lambda: file.readline(MAX_LINE + 1), b""), 1):
        if number > MAX_PLAYS:
            raise PlayError(f"{name}:{number}: the file has more than {MAX_PLAYS:,} plays")
        try:
            plays.append(Play.from_line(line))
        except PlayError as error:
            raise PlayError(f"{name}:{number}: {error}") from None
    if not plays:
        raise PlayError(f"{name}: the file is empty")
    return plays


def append_play(path: Path, play: PlayFields) -> None:
    """Append a play to a file, which is created if there is none.

    Raises:
        OSError: the file cannot be written.
        PlayError: its last line is cut off.
    """
    _append(path, play.to_line().encode("ascii"))


def check_appendable(path: Path) -> None:
    """Check that plays can be appended to a file, which is created if there is none.

    Raises:
        OSError: the file cannot be written.
        PlayError: its last line is cut off.
    """
    _append(path, b"")


def _append(path: Path, line: bytes) -> None:
    if not append_line(path, line):
        raise PlayError(f"{path}: the last line is cut off; remove it, or use another file")


def return_of(rewards: list[float], discount: float) -> float:
    """Return the discounted sum of rewards."""
    total = 0.0
    for reward in reversed(rewards):
        total = reward + discount * total
    return total


def play_of(level: Level, code: str, *, rewards: list[float], **fields: Any) -> Play:
    """Return an episode of an environment as a play.

    Args:
        level: the level.
        code: its share code.
        rewards: the reward of each step.
        fields: the other fields that do not follow from these.
    """
    return Play.model_validate(
        {
            "name": level.name,
            "digest": level.digest,
            "code": code,
            "discount": level.discount,
            "seed_kind": "environment",
            "rewards": rewards,
            "return": return_of(rewards, level.discount),
            "made_by": program(),
            **fields,
        }
    )


class RecordPlay(gymnasium.Wrapper[Any, Any, Any, Any], RecordConstructorArgs):
    """Appends each episode of an environment to a file, as a line, when it ends.

    An episode that `reset` or `close` ends before its end is recorded as unfinished, unless no step
    was taken. The observation may be any; wrappers that change actions or rewards must be around
    this one and not in it.

    Attributes:
        hints: how many hints were asked for in this episode, which whoever gives them counts.
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
        base = getattr(env, "unwrapped", env)
        if not isinstance(base, LevelEnv):
            what = type(base).__name__
            raise TypeError(f"RecordPlay records environments, as of `level.make()`, not {what}")
        super().__init__(env)
        self._base: LevelEnv = base
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
        self._actions.append(self._base.action_number(action))
        self._rewards.append(float(reward))
        self._states.append(self._base.state)
        if terminated or truncated:
            is_late = len(self._actions) == self._limit
            self._write("terminated" if terminated else "truncated" if is_late else "unfinished")
        return found

    def take_back(self) -> None:
        """Forget the last step, which the environment in it has gone back before; it is counted.

        Raises:
            ValueError: there is no step, or the episode is recorded.
        """
        if self._is_over or not self._actions:
            raise ValueError("there is no step that could be taken back")
        for taken in (self._actions, self._rewards, self._states):
            taken.pop()
        self._undone += 1

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
        self.hints = self._undone = 0

    def _write(self, end: str = "unfinished") -> None:
        """Append the episode, unless that is done, or it has no step."""
        if self._is_over or not self._actions:
            return
        self._is_over = True
        level = self._level
        if self._coded is None or self._coded[0] is not level:
            self._coded = level, level.share_code()
        play = play_of(
            level,
            self._coded[1],
            action_set=self._base.action_set,
            max_steps=self._limit,
            seed=self._seed,
            start=self._start,
            states=self._states,
            actions=self._actions,
            rewards=self._rewards,
            end=end,
            hints=self.hints,
            undone=self._undone,
        )
        append_play(self._path, play)
