"""Files of plays: `Play`, and reading and appending the lines of a `.brlplay` file."""

from __future__ import annotations

import os
from functools import lru_cache
from pathlib import Path

from babyrobot_levels.language.play import MAX_LINE, PlayError, PlayFields
from babyrobot_levels.library.level import Level
from babyrobot_levels.library.reading import load_code
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
        actions: the action of each step, `[steps]`.
        rewards: the reward of each step, `[steps]`.
        return_: the discounted sum of the rewards.
        end: `"terminated"`, `"truncated"` or `"unfinished"`.
        hints: how many hints the player asked for, as the page tells.
        undone: how many steps the player took back, as the page tells.
        watched: how many steps the policy took that the player watched, as the page tells.
        made_by: the program that wrote it.
    """

    __module__ = "babyrobot_levels"

    @property
    def level(self) -> Level:
        """The level of the share code, which need not be the one of the digest: see `brl.replay`.

        Raises:
            LevelError: the code is damaged, or its level is not valid.
        """
        return _level_of(self.code)

    def __repr__(self) -> str:
        return (
            f"<Play of {self.name or self.digest[:15]!r}: {self.steps} steps, "
            f"return {self.return_:g}, {self.end}>"
        )

    __str__ = __repr__


@lru_cache(maxsize=64)
def _level_of(code: str) -> Level:
    return load_code(code)


def read_plays(path: str | os.PathLike[str]) -> list[Play]:
    """Return the plays of a `.brlplay` file. They are not verified; see `brl.replay`.

    Args:
        path: the file: one play per line, at most 100,000, and at most 64 MiB.

    Raises:
        OSError: the file cannot be read.
        PlayError: it is too large, or one of its lines is damaged or no play; the message begins
            with `file:line`.
    """
    plays: list[Play] = []
    with open_regular(Path(path)) as file:
        if os.fstat(file.fileno()).st_size > MAX_BYTES:
            raise PlayError(f"{path}: the file is larger than {MAX_BYTES >> 20} MiB")
        for number, line in enumerate(iter(lambda: file.readline(MAX_LINE + 1), b""), 1):
            if number > MAX_PLAYS:
                raise PlayError(f"{path}:{number}: the file has more than {MAX_PLAYS:,} plays")
            try:
                plays.append(Play.from_line(line))
            except PlayError as error:
                raise PlayError(f"{path}:{number}: {error}") from None
    if not plays:
        raise PlayError(f"{path}: the file is empty")
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
