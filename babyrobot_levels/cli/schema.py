"""`babyrobot schema`: the JSON schemas."""

from __future__ import annotations

from enum import StrEnum
from typing import Annotated

import typer

from babyrobot_levels.cli.console import ForceOption, OutputOption, save, write


class SchemaName(StrEnum):
    """Kinds of files that have a schema."""

    LEVEL = "level"
    PACK = "pack"
    PLAY = "play"
    SUITE = "suite"
    THEME = "theme"


def print_schema(
    name: Annotated[
        SchemaName,
        typer.Argument(metavar="NAME", help="`level`, `pack`, `play`, `suite` or `theme`."),
    ] = SchemaName.LEVEL,
    output: OutputOption = None,
    force: ForceOption = False,
) -> None:
    """Print the JSON schema of level, suite or theme files, of `pack.yaml`, or of a play's lines.

    In a folder with `schemas/level.schema.json`, `new-level`, `generate` and `import` let their
    files refer to it, so that editors complete and check them.

    Examples:

      babyrobot schema level -o schemas/level.schema.json
    """
    from babyrobot_levels.language.json_schema import schema_text

    text = schema_text(name)
    if output is None:
        write(text)
    else:
        save(output, text, force=force)
