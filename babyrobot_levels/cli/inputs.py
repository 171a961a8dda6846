"""Levels, and other arguments of commands."""

from __future__ import annotations

import json
import re
import sys
import warnings
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Annotated, Any

import typer

import babyrobot_levels as brl
from babyrobot_levels.cli.console import FINDINGS, STANDARD_OUTPUT, fail, note, value_option
from babyrobot_levels.cli.meant import NO_LEVEL
from babyrobot_levels.cli.parallel import Workers, map_all
from babyrobot_levels.cli.reporting import STANDARD_INPUT, findings_text, read_path, summary
from babyrobot_levels.language.names import numbered, slug
from babyrobot_levels.text.diagnostics import one_line
from babyrobot_levels.text.files import RESERVED, make_folder

LevelArgument = Annotated[
    str,
    typer.Argument(
        metavar="LEVEL",
        help="A name, PACK/NAME, the path of a file, a share code, or `-` for standard input.",
    ),
]

MazeSeedOption = Annotated[
    int | None, value_option("N", "Seed for the maze of a level with a random maze.")
]
ResetSeedOption = Annotated[
    int | None,
    value_option("N", "Seed of the reset of an environment of MiniGrid.  [default: 0]", min=0),
]
SightOption = Annotated[
    str | None,
    value_option(
        "NAMES",
        "What the agent observes, such as `view`, if it does not see everything: the names of "
        "observations, with commas, or `text-map`, `text-view`, `text-words`.",
        "--sight",
    ),
]
ViewRadiusOption = Annotated[
    int | None,
    value_option("N", "How many cells the sight `view` shows in each direction.", min=1, max=15),
]
RuntimeOption = Annotated[
    Path | None,
    value_option(
        "FOLDER",
        "Take Python for browsers from this folder.  [default: fetched by npm and pip, 8 MB]",
        "--runtime",
    ),
]


def sight_options(sight: str, view_radius: int | None) -> dict[str, Any]:
    """Return what --sight and --view-radius say, as `brl.solve` takes it."""
    names = tuple(sight.split(",")) if "," in sight else sight
    return {"sight": names, **({} if view_radius is None else {"view_radius": view_radius})}


def check_name(name: str) -> None:
    """End the command if a level cannot have a name in its file."""
    if slug(name) != name:
        good = slug(Path(name).stem if name.endswith((".yaml", ".yml")) else name)
        fail(
            f"invalid level name {name!r}: use lower-case letters and digits, joined by `-`",
            f"for example {good!r}" if good else None,
        )


def load_level(text: str) -> brl.Level:
    """Return the level that an argument names."""
    from babyrobot_levels.language.share_code import is_code

    if text == str(STANDARD_INPUT):
        return _read_level()
    if ("\n" in text and not is_code(text)) or NO_LEVEL.fullmatch(text):
        raise brl.LevelNotFoundError(text)
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        level = brl.load(text)
    for each in told:
        # What a file of another program says, and a level does not.
        note(f"warning: {one_line(str(each.message))}")
    return level


def file_of(text: str) -> Path:
    """Return the file of the level that an argument names, for commands that watch it."""
    from babyrobot_levels.language.share_code import is_code
    from babyrobot_levels.library.catalogue import find, looks_like_path

    if text == str(STANDARD_INPUT) or is_code(text):
        fail("--watch needs a level in a file", "give its name or its path")
    return Path(text) if looks_like_path(text) else find(text)


def load_two(one: str, other: str) -> tuple[brl.Level, brl.Level]:
    """Return the levels that two arguments name; one of them may be standard input."""
    if one == other == str(STANDARD_INPUT):
        fail("only one of the two levels can be standard input")
    return load_level(one), load_level(other)


def configuration_of(level: brl.Level, held: str) -> int:
    """Return the configuration that `--held` names: just these things held, or on."""
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


def _read_level() -> brl.Level:
    """Return the level on standard input."""
    from babyrobot_levels.library.level import load_source

    return load_source(read_path(STANDARD_INPUT))


def with_seed(level: brl.Level, maze_seed: int | None) -> brl.Level:
    """Return a level with the maze of a seed, which is required if its maze is random."""
    if level.has_random_maze:
        if maze_seed is None:
            fail("the maze of this level is random", "choose one with --maze-seed N")
        return level.with_maze_seed(maze_seed)
    if maze_seed is not None:
        fail("the level's maze is not random", "leave out --maze-seed")
    return level


LevelsArgument = Annotated[
    list[str],
    typer.Argument(
        metavar="LEVEL",
        help="A name, PACK/NAME, the path of a file, a share code, or `-` for standard input; "
        "several of these; folders of level files and packs; or one suite.",
    ),
]
SplitOption = Annotated[str | None, value_option("NAME", "Only this split of a suite.")]


def is_one_level(words: Sequence[str]) -> bool:
    """Return whether arguments name one level, and no folder, pack or suite."""
    from babyrobot_levels.library.catalogue import folder_named, suite_path

    if len(words) != 1 or _is_input(words[0]) or NO_LEVEL.fullmatch(words[0]):
        return len(words) == 1
    return suite_path(words[0]) is None and folder_named(words[0]) is None


def names_levels(word: str) -> bool:
    """Return whether an argument names a level, folder, pack or suite that exists."""
    try:
        return not is_one_level([word]) or load_level(word) is not None
    except brl.BabyRobotError:
        return False


def levels_named(words: Sequence[str], split: str | None = None) -> brl.Suite | list[Any]:
    """Return the levels that arguments name: a suite, or what `load` takes for each level.

    Args:
        words: the arguments.
        split: the part of a suite that is meant; None for all of it.
    """
    found = [(word, _named(word)) for word in words]
    for word, suite in found:
        if not isinstance(suite, brl.Suite):
            continue
        if len(words) > 1:
            fail(f"{word} is a suite, which stands alone", "leave out the other arguments")
        try:
            return suite if split is None else suite.split(split)
        except ValueError as error:
            fail(str(error))
    if split is not None:
        fail("--split is a part of a suite, and this is none")
    return [level for _, levels in found for level in levels]


def valid_levels(
    levels: list[Any], what: str, *, jobs: int | None = None, keep_going: bool | None = None
) -> tuple[list[Any], int]:
    """Return levels without the files that have errors, and the number of these.

    The errors of all files are reported, as by `babyrobot validate`. Without `keep_going`, they
    end the command.

    Args:
        levels: the levels, as `levels_named` returns them.
        what: what the command writes, for the note that it is not written.
        jobs: the number of processes.
        keep_going: whether to go on without them; None where there is no such option.
    """
    from babyrobot_levels.cli.check import errors_of

    files = [each for each in levels if isinstance(each, Path)]
    found = dict(zip(files, map_all(errors_of, files, Workers(jobs), "checking"), strict=True))
    broken = {file: errors for file, errors in found.items() if errors}
    if not broken:
        return levels, 0
    diagnostics = [each for errors in broken.values() for each in errors]
    report = findings_text(diagnostics, sys.stderr)
    sys.stderr.write(f"{report}\n{summary(diagnostics, len(files))}\n")
    if not keep_going:
        others = "" if keep_going is None else ", or leave them out with --keep-going"
        note(f"no {what} written: fix the errors first{others}")
        raise typer.Exit(FINDINGS)
    return [each for each in levels if each not in broken], len(broken)


def names_of_files(levels: Iterator[brl.Level]) -> Iterator[tuple[str, brl.Level]]:
    """Yield each level with a name for a file, which none before it has."""
    taken = set(RESERVED)
    for level in levels:
        base = re.sub(r"[^\w-]+", "-", level.name or "").strip("-") or "level"
        name = next(each for each in numbered(base) if each.casefold() not in taken)
        taken.add(name.casefold())
        yield name, level


def is_folder(output: Path) -> bool:
    """Return whether a path to write to is a folder, or will be: a file would have a suffix."""
    is_file = output == STANDARD_OUTPUT or output.suffix != "" or output.exists()
    return output.is_dir() or not is_file


def folder_for(output: Path) -> Path:
    """Return the folder to which files of several levels are written, made if there is none."""
    if not is_folder(output):
        fail(f"{output} is not a folder", "several levels are written to one: -o FOLDER")
    make_folder(output)
    return output


def _is_input(word: str) -> bool:
    """Return whether an argument is a level itself: standard input, or what holds its text."""
    return word == str(STANDARD_INPUT) or "\n" in word


def _named(word: str) -> brl.Suite | list[Any]:
    """Return what an argument names: a suite, or what `load` takes for each level."""
    from babyrobot_levels.suites.suite import named_levels

    if _is_input(word) or NO_LEVEL.fullmatch(word):
        return [load_level(word)]
    try:
        return named_levels(word)  # type: ignore[return-value]
    except brl.BabyRobotError:
        raise
    except ValueError as error:
        fail(str(error))
