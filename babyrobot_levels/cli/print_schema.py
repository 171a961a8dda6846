"""`babyrobot schema`: the JSON schemas, for editors and other tools."""

from __future__ import annotations

import json
from enum import StrEnum
from typing import Annotated

import typer

from babyrobot_levels.cli.console import ForceOption, OutputOption, save, write


class SchemaName(StrEnum):
    """What there is a schema of."""

    LEVEL = "level"
    PACK = "pack"
    SUITE = "suite"
    THEME = "theme"


def print_schema(
    name: Annotated[
        SchemaName, typer.Argument(metavar="NAME", help="`level`, `pack`, `suite` or `theme`.")
    ] = SchemaName.LEVEL,
    output: OutputOption = None,
    force: ForceOption = False,
) -> None:
    """Print the JSON schema of level, suite or theme files, or of the `pack.yaml` of packs.

    Examples:

      babyrobot schema level -o schemas/level.schema.json
    """
    text = schema_text(name)
    if output is None:
        write(text)
    else:
        save(output, text, force=force)


def schema_text(name: str) -> str:
    """Return a schema as it stands in a file."""
    from babyrobot_levels.language.json_schema import SCHEMAS

    return json.dumps(SCHEMAS[name](), indent=2, ensure_ascii=False) + "\n"
