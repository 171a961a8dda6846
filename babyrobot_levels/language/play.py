"""The fields of a play: an episode in a level, as one line of a `.brlplay` file.

A line is a JSON object whose last field is `checksum`, the CRC-32 of all bytes of the line before
`,"checksum"`, as eight hexadecimal digits. So it does not matter how numbers are written.
"""

import json
import re
import zlib
from functools import cache
from importlib.metadata import version
from typing import Annotated, Any, Literal, NoReturn, Self

from pydantic import (
    Field,
    StrictInt,
    StrictStr,
    StringConstraints,
    ValidationError,
    model_validator,
)

from babyrobot_levels.language.base import Model, Number
from babyrobot_levels.language.share_code import MAX_CHARACTERS
from babyrobot_levels.text.errors import BabyRobotError

FORMAT = "babyrobot-levels play"

MAX_STEPS = 100_000
"""The most steps of a play."""

MAX_LINE = MAX_CHARACTERS + (4 << 20)
"""The most bytes of a line."""

_END = re.compile(rb',"checksum":"([0-9a-f]{8})"\}\s*\Z')

Digest = Annotated[StrictStr, StringConstraints(pattern=r"^sha256:[0-9a-f]{64}$")]
SeedText = Annotated[StrictStr, StringConstraints(pattern=r"^[0-9]{1,40}$")]
_State = Annotated[StrictInt, Field(ge=0, lt=2**31)]
_Action = Annotated[StrictInt, Field(ge=0, lt=5**4)]
_Count = Annotated[StrictInt, Field(ge=0, lt=2**31)]
_Short = Annotated[StrictStr, StringConstraints(max_length=200)]


class PlayError(BabyRobotError, ValueError, public=True):
    """A file of plays, or a line of it, that cannot be read."""


class NoPlaysError(PlayError, FileNotFoundError):
    """There is no file of plays."""


class PlayFields(Model):
    """An episode in a level: what was done, and what came of it."""

    format: Literal["babyrobot-levels play"] = "babyrobot-levels play"
    """What the line is."""
    format_version: Literal[1] = 1
    """The version of the format."""
    name: _Short | None
    """The name of the level."""
    digest: Digest
    """The digest of the level."""
    code: Annotated[StrictStr, StringConstraints(max_length=MAX_CHARACTERS)]
    """The share code of the level; its maze has a seed."""
    action_set: Literal["all", "moves", "turns"]
    """Which actions the robot has, and how they are numbered: `moves` leaves `stay` out."""
    discount: Annotated[Number, Field(gt=0, le=1)]
    """The factor by which each further reward counts less in `return`."""
    max_steps: Annotated[StrictInt, Field(ge=1)] | None
    """The number of steps after which the episode is truncated; null for no limit."""
    seed: SeedText | None
    """The seed of the episode, in decimal digits; null where it is unknown."""
    seed_kind: Literal["environment", "page"]
    """What drew the outcomes: `env.reset(seed=…)` of the level, or a page that plays it."""
    start: Literal["drawn", "chosen"]
    """Whether the level's distribution of starts gave the first state, or the player chose it."""
    states: Annotated[list[_State], Field(min_length=2, max_length=MAX_STEPS + 1)]
    """The state at the start and after each step, numbered as in the compiled tables."""
    actions: Annotated[list[_Action], Field(min_length=1, max_length=MAX_STEPS)]
    """The action of each step; of several robots, the number of their joint action."""
    rewards: Annotated[list[Number], Field(min_length=1, max_length=MAX_STEPS)]
    """The reward of each step."""
    return_: Number = Field(alias="return")
    """The discounted sum of the rewards."""
    end: Literal["terminated", "truncated", "unfinished"]
    """How the episode ended; only after `terminated`, the last step led to a terminal state."""
    hints: _Count = 0
    """How many hints the player asked for, as the game tells."""
    undone: _Count = 0
    """How many steps the player took back, as the game tells."""
    watched: _Count = 0
    """How many steps the policy took that the player watched, as the game tells."""
    player: _Short | None = None
    """Who played, as the page was told; null where it was not."""
    made_by: _Short
    """The program that wrote the line, with its version."""

    @model_validator(mode="after")
    def _as_long(self) -> Self:
        if not len(self.states) - 1 == len(self.actions) == len(self.rewards):
            raise ValueError(
                f"{len(self.actions):,} actions need as many rewards and one more state, not "
                f"{len(self.rewards):,} rewards and {len(self.states):,} states"
            )
        return self

    @property
    def steps(self) -> int:
        """The number of steps."""
        return len(self.actions)

    def to_line(self) -> str:
        """Return the play as a line of a file, without the end of the line."""
        data = self.model_dump(by_alias=True)
        text = json.dumps(data, separators=(",", ":"), allow_nan=False)[:-1]
        return f'{text},"checksum":"{zlib.crc32(text.encode("ascii")):08x}"}}'

    @classmethod
    def from_line(cls, line: bytes) -> Self:
        """Return the play of a line.

        Raises:
            PlayError: the line is damaged, cut off, or no play of this version.
        """
        if len(line) > MAX_LINE:
            raise PlayError(f"the line is longer than {MAX_LINE:,} bytes")
        found = _END.search(line)
        if found is None:
            raise PlayError("the line is cut off, or is no play: it does not end with a checksum")
        body = line[: found.start()]
        if int(found[1], 16) != zlib.crc32(body):
            raise PlayError("the line is damaged: its checksum is wrong")
        try:
            data = json.loads(body + b"}", parse_constant=_refuse)
        except (ValueError, RecursionError):
            raise PlayError("the line is not JSON") from None
        if not isinstance(data, dict) or data.get("format") != FORMAT:
            raise PlayError("the line is JSON, but no play")
        version = data.get("format_version")
        if isinstance(version, int) and version > 1:
            raise PlayError(
                f"the play has version {version} of the format, and this babyrobot-levels reads "
                "version 1; a newer one may read it"
            )
        try:
            return cls.model_validate(data)
        except ValidationError as error:
            raise PlayError(_described(error)) from None


@cache
def program() -> str:
    """Return the name and the version of this package, for `made_by`."""
    return f"babyrobot-levels {version('babyrobot-levels')}"


def _refuse(constant: str) -> NoReturn:
    raise ValueError(f"{constant} is no number of JSON")


def _described(error: ValidationError) -> str:
    first: Any = error.errors(include_url=False)[0]
    place = "/".join(map(str, first["loc"]))[:100]
    reason = str(first["msg"]).removeprefix("Value error, ")
    return (
        f"the play is invalid at {place!r}: {reason}" if place else f"the play is invalid: {reason}"
    )
