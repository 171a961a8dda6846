"""What `import` and `export` share: the formats by name, and telling what was lost."""

from __future__ import annotations

from collections.abc import Sequence
from enum import StrEnum
from typing import TYPE_CHECKING, Annotated

import typer

from babyrobot_levels.cli.console import FINDINGS, note
from babyrobot_levels.text.diagnostics import one_line

if TYPE_CHECKING:
    from babyrobot_levels.convert.conversion import Lost

MAX_TOLD = 40
"""Of more losses than this, only so many are told."""


class WorldFormat(StrEnum):
    """The formats that worlds are read from and written to."""

    BABYROBOT = "babyrobot"
    FROZEN_LAKE = "frozen-lake"
    MAZE_MAP = "maze-map"
    MAZE_DATASET = "maze-dataset"
    MINIGRID = "minigrid"
    SOKOBAN = "sokoban"
    TILED = "tiled"


StrictOption = Annotated[
    bool, typer.Option("--strict", help="Write nothing if there is anything that would be lost.")
]


def tell_losses(lost: Sequence[Lost], *, strict: bool) -> None:
    """Tell on standard error what could not come along; end the command if it is `strict`."""
    for each in lost[:MAX_TOLD]:
        note(f"{'error' if strict else 'warning'}: {one_line(str(each))}")
    if len(lost) > MAX_TOLD:
        note(f"… and {len(lost) - MAX_TOLD} more")
    if lost and strict:
        raise typer.Exit(FINDINGS)
