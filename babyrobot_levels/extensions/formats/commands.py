"""`babyrobot import` and `babyrobot export`: worlds of other programs."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from babyrobot_levels.cli.console import (
    FINDINGS,
    ForceOption,
    OutputOption,
    fail,
    not_one_of,
    note,
    put,
    save,
    value_option,
)
from babyrobot_levels.cli.inputs import (
    LevelArgument,
    MazeSeedOption,
    ResetSeedOption,
    SightOption,
    ViewRadiusOption,
    check_name,
    json_mapping,
    load_level,
    sight_options,
    with_seed,
)
from babyrobot_levels.cli.parallel import working
from babyrobot_levels.cli.pictures import picture
from babyrobot_levels.cli.reporting import read_path, shown_name
from babyrobot_levels.extensions.formats import formats
from babyrobot_levels.extensions.formats.formats import FORMATS, MODELS, PARTIAL
from babyrobot_levels.extensions.formats.reading import (
    UnknownFormatError,
    format_of,
    is_environment,
    world_of_id,
)
from babyrobot_levels.text.diagnostics import one_line
from babyrobot_levels.text.errors import BabyRobotError
from babyrobot_levels.text.files import schema_for
from babyrobot_levels.text.source import SourceFile
from babyrobot_levels.text.words import listed

if TYPE_CHECKING:
    from babyrobot_levels.extensions.formats.conversion import Lost, World

MAX_REPORTED = 40
"""The largest number of losses that are reported."""

PICTURES = ("png", "svg")
"""The formats of pictures that levels are exported to."""

TARGETS = [*(name for name, each in FORMATS.own.items() if each.is_written), *MODELS, *PICTURES]
"""The formats of the package that levels are exported to."""

_SUFFIXES = [*formats.SUFFIXES, *(f".{name}" for name in PICTURES)]


def _world_format(word: str) -> str:
    return word if word in FORMATS else not_one_of(word, FORMATS)


def _export_format(word: str) -> str:
    is_known = word in PICTURES or formats.is_written(word)
    return word if is_known else not_one_of(word, [*formats.written(), *PICTURES])


StrictOption = Annotated[
    bool, typer.Option("--strict", help="Write nothing if anything would be lost.")
]


def report_losses(lost: Sequence[Lost], *, strict: bool) -> None:
    """Report on standard error what is lost; end the command if it is `strict`."""
    for each in lost[:MAX_REPORTED]:
        note(f"{'error' if strict else 'warning'}: {one_line(str(each))}")
    if len(lost) > MAX_REPORTED:
        note(f"… and {len(lost) - MAX_REPORTED} more")
    if lost and strict:
        raise typer.Exit(FINDINGS)


def import_level(
    file: Annotated[
        Path,
        typer.Argument(
            metavar="FILE",
            help="File to convert, `-` for standard input, or the id of an environment of "
            "MiniGrid or of a FrozenLake.",
        ),
    ],
    world_format: Annotated[
        str | None,
        value_option(
            "FORMAT",
            f"Format of the file: {', '.join(FORMATS.own)}.  [default: detected]",
            "--from",
            parser=_world_format,
        ),
    ] = None,
    output: OutputOption = None,
    name: Annotated[
        str | None,
        value_option(
            "N",
            "Name of the level: lower-case letters, digits and `-`.  [default: that of the file]",
        ),
    ] = None,
    seed: ResetSeedOption = None,
    kwargs: Annotated[
        str | None, value_option("JSON", "Keyword arguments of an environment.")
    ] = None,
    slippery: Annotated[
        bool | None,
        typer.Option(
            "--slippery/--no-slippery",
            help="Whether a FrozenLake map is slippery, if it does not say so.  "
            "[default: slippery]",
            show_default=False,
        ),
    ] = None,
    strict: StrictOption = False,
    force: ForceOption = False,
) -> None:
    """Convert a file or an environment of another program to a level file.

    Reads FORMATS. With the package `minigrid` it also makes and resets an environment of MiniGrid
    and reads its grid. What a level cannot express is reported on standard error.

    Examples:

      babyrobot import setup.py -o levels/setup.yaml

      babyrobot import lake.txt --no-slippery

      babyrobot import maze.txt --from maze-dataset -o levels/maze.yaml

      babyrobot export four-rooms --to minigrid | babyrobot import -

      babyrobot import --from minigrid MiniGrid-DoorKey-8x8-v0 --seed 3 -o door-key.yaml

      babyrobot import FrozenLake-v1 --kwargs '{"map_name": "8x8"}'
    """
    from babyrobot_levels.extensions.formats.conversion import ConversionError, file_text
    from babyrobot_levels.language.names import slug

    if name is not None:
        check_name(name)
    path = output or Path(f"{name or 'level'}.yaml")
    title = name or slug(file.stem) or "imported"
    try:
        world = (
            _environment(str(file), seed or 0, kwargs, slippery)
            if _is_environment(file, world_format)
            else _converted(file, world_format, slippery, seed, kwargs)
        )
        text = file_text(
            world, schema=schema_for(path), name=name, title=title.replace("-", " ").capitalize()
        )
    except ConversionError as error:
        message, here = str(error), one_line(shown_name(str(file)))
        # Messages about a place in the text begin with it.
        note(message if message.startswith(f"{here}:") else f"{here}: error: {message}")
        raise typer.Exit(FINDINGS) from None
    report_losses(world.lost, strict=strict)
    put(text, output, force=force)


*_FIRST, _LAST = (each.texts for each in FORMATS.own.values())
import_level.__doc__ = (import_level.__doc__ or "").replace(
    "FORMATS", f"{', '.join(_FIRST)}, and {_LAST}"
)


def _is_environment(file: Path, chosen: str | None) -> bool:
    """Return whether the argument is the id of an environment, and not a file."""
    name = str(file)
    if chosen == "minigrid":
        return re.fullmatch(r"([\w.]+:)?[\w./-]+-v\d+", name) is not None and not file.exists()
    return chosen in (None, "frozen-lake") and is_environment(name)


def _environment(env_id: str, seed: int, kwargs: str | None, slippery: bool | None) -> World:
    """Return the world of an environment."""
    _check_slippery(slippery, (), env_id)
    return world_of_id(env_id, seed, None if kwargs is None else json_mapping(kwargs))


def _converted(
    file: Path,
    world_format: str | None,
    slippery: bool | None,
    seed: int | None,
    kwargs: str | None,
) -> World:
    """Return the world of a file."""
    if seed is not None or kwargs is not None:
        fail(
            "--seed and --kwargs are for environments",
            "for example `babyrobot import MiniGrid-DoorKey-8x8-v0 --seed 3`",
        )
    source = _source(file)
    name = world_format or _guessed(source)
    _check_slippery(slippery, FORMATS[name].keywords, name)
    return FORMATS[name].read(source, slippery=slippery, folder=file.parent)


def _check_slippery(slippery: bool | None, keywords: Sequence[str], name: str) -> None:
    """Refuse --slippery where it means nothing."""
    if slippery is not None and "slippery" not in keywords:
        known = listed([each.texts for each in FORMATS.values() if "slippery" in each.keywords])
        fail(f"--slippery and --no-slippery are for {known}, not for {name}")


def _source(file: Path) -> SourceFile:
    from babyrobot_levels.text.errors import LevelError

    try:
        return read_path(file)
    except LevelError as error:
        diagnostic = error.diagnostics[0]
        if diagnostic.code == "BR101":
            fail(f"{file}: {diagnostic.message}")
        # It may be a picture, or a compressed file.
        help_text = "see `babyrobot import --help` for the formats; all of them are UTF-8 text"
        if diagnostic.code == "BR102":
            diagnostic = replace(diagnostic, help=help_text)
        raise LevelError([diagnostic]) from None


def _guessed(source: SourceFile) -> str:
    try:
        return format_of(source)
    except UnknownFormatError as error:
        message, _, help_text = str(error).partition("\n  help: ")
        if error.found:
            help_text = "add " + " or ".join(f"--from {each}" for each in error.found)
        fail(message, help_text.replace("give its format,", "add --from with"))


def export_level(
    level: LevelArgument,
    to: Annotated[
        str | None,
        value_option(
            "FORMAT",
            f"Output format: {', '.join(TARGETS)}.  "
            f"[default: by the suffix of the file, {listed(_SUFFIXES, 'or')}]",
            "--to",
            parser=_export_format,
        ),
    ] = None,
    output: OutputOption = None,
    maze_seed: MazeSeedOption = None,
    sight: SightOption = None,
    view_radius: ViewRadiusOption = None,
    strict: StrictOption = False,
    force: ForceOption = False,
) -> None:
    """Convert a level to the format of another program or of a model checker, or to a picture.

    What the format cannot express is reported on standard error, by the names of the fields. The
    formats of POMDPs hold what an agent observes: --sight, by default `view`.

    Examples:

      babyrobot export frozen-lake --to frozen-lake -o lake.json

      babyrobot export glass-wall -o glass-wall.tmj

      babyrobot export random-maze --maze-seed 7 --to sokoban

      babyrobot export final-maze -o final-maze.prism

      babyrobot export shell-game --sight view --view-radius 1 -o shell-game.pomdp
    """
    chosen = to or _by_suffix(output)
    if chosen not in PARTIAL and (sight or view_radius):
        fail(f"--sight and --view-radius are for {listed([*PARTIAL])}, not for {chosen}")
    seen = sight_options(sight or "view", view_radius) if chosen in PARTIAL else {}
    loaded = with_seed(load_level(level), maze_seed)
    made: str | bytes
    beside: Mapping[str, bytes] = {}
    if chosen in PICTURES:
        with working("drawing") as report:
            made = picture(loaded, chosen, {}, report)
    else:
        try:
            conversion = formats.converted(loaded, chosen, **seen)
        except ImportError as error:
            fail(*str(error).split(": ", 1))
        except BabyRobotError:
            raise
        except (ValueError, TypeError) as error:
            fail(str(error))
        report_losses(conversion.warnings, strict=strict)
        made, beside = conversion.content, conversion.beside
    for name, data in beside.items():
        if output is not None:
            save(output.parent / name, data, force=force)
        else:
            note(f"note: {name}, the picture of the tiles, is only written with -o FILE")
    put(made, output, chosen.upper(), force=None if chosen in PICTURES else force)


def _by_suffix(output: Path | None) -> str:
    suffix = output.suffix.lower() if output is not None else ""
    name = suffix[1:] if suffix[1:] in PICTURES else formats.format_for(suffix)
    if name is None:
        known = ", ".join([*formats.written(), *PICTURES])
        fail("the output format is missing", f"add --to with one of {known}")
    return name
