"""`babyrobot schema`: the JSON schemas, and how level files refer to theirs."""

from __future__ import annotations

import json
import os
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from babyrobot_levels.cli.console import ForceOption, OutputOption, save, write

SCHEMA_PATH = Path("schemas", "level.schema.json")


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
    text = schema_text(name)
    if output is None:
        write(text)
    else:
        save(output, text, force=force)


def schema_text(name: str) -> str:
    """Return a schema as the text of a file."""
    from babyrobot_levels.language.json_schema import SCHEMAS

    return json.dumps(SCHEMAS[name](), indent=2, ensure_ascii=False) + "\n"


def schema_for(path: Path) -> str | None:
    """Return how a level file refers to its schema, None where the project has none.

    Args:
        path: the file, which need not exist.

    Returns:
        The relative path of `schemas/level.schema.json` in the nearest folder around the file
        that has one. A path of this machine would be wrong on every other one.
    """
    from babyrobot_levels.text.files import is_file

    folder = Path(os.path.abspath(path)).parent  # noqa: PTH100  (a circle of links has no end)
    for parent in (folder, *folder.parents):
        if is_file(parent / SCHEMA_PATH):
            return Path(os.path.relpath(parent / SCHEMA_PATH, folder)).as_posix()
    return None
