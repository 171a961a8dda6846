"""The levels that commands take as arguments: names, files, share codes, standard input."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from babyrobot_levels.cli.console import fail
from babyrobot_levels.cli.reporting import STANDARD_INPUT, read_path

if TYPE_CHECKING:
    from babyrobot_levels.library.level import Level

LevelArgument = Annotated[
    str,
    typer.Argument(
        metavar="LEVEL",
        help="A name, PACK/NAME, the path of a file, a share code, or `-` for standard input.",
    ),
]

MazeSeedOption = Annotated[
    int | None,
    typer.Option(
        metavar="N",
        help="Seed for the maze of a level with a random maze.",
        show_default=False,
    ),
]
ResetSeedOption = Annotated[
    int | None,
    typer.Option(
        min=0,
        metavar="N",
        help="Seed of the reset of an environment of MiniGrid.  [default: 0]",
        show_default=False,
    ),
]


def load_level(text: str) -> Level:
    """Return the level that an argument names."""
    from babyrobot_levels.language.share_code import is_code
    from babyrobot_levels.library.catalogue import load
    from babyrobot_levels.text.errors import LevelNotFoundError

    if text == str(STANDARD_INPUT):
        return _read_level()
    if "\n" in text and not is_code(text):
        raise LevelNotFoundError(text)
    return load(text)


def file_of(text: str) -> Path:
    """Return the file of the level that an argument names, for commands that watch it."""
    from babyrobot_levels.language.share_code import is_code
    from babyrobot_levels.library.catalogue import find, looks_like_path

    if text == str(STANDARD_INPUT) or is_code(text):
        fail("--watch needs a level in a file", "give its name or its path")
    return Path(text) if looks_like_path(text) else find(text)


def load_two(one: str, other: str) -> tuple[Level, Level]:
    """Return the levels that two arguments name; one of them may be standard input."""
    if one == other == str(STANDARD_INPUT):
        fail("only one of the two levels can be standard input")
    return load_level(one), load_level(other)


def configuration_of(level: Level, held: str) -> int:
    """Return the configuration that `--held` names: just these items held, and switches on."""
    from babyrobot_levels.analysis import pictures

    try:
        return pictures.configuration_of(level, held)
    except ValueError as error:
        fail(str(error))


def json_mapping(text: str) -> dict[str, Any]:
    """Return the keyword arguments of an environment, which `--kwargs` gives."""
    try:
        keywords = json.loads(text)
    except (ValueError, RecursionError) as error:
        fail(f"--kwargs is not JSON: {error}", "for example '{\"is_slippery\": false}'")
    if not isinstance(keywords, dict):
        fail("--kwargs must be a JSON object", "for example '{\"is_slippery\": false}'")
    return keywords


def _read_level() -> Level:
    """Return the level on standard input."""
    from babyrobot_levels.library.reading import load_source

    return load_source(read_path(STANDARD_INPUT))


def with_seed(level: Level, maze_seed: int | None) -> Level:
    """Return a level with the maze of a seed, which is required if its maze is random."""
    if level.has_random_maze:
        if maze_seed is None:
            fail("the maze of this level is random", "choose one with --maze-seed N")
        return level.with_maze_seed(maze_seed)
    if maze_seed is not None:
        fail("the level's maze is not random", "leave out --maze-seed")
    return level
