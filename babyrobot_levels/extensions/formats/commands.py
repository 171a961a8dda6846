"""`babyrobot import` and `babyrobot export`: worlds of other programs."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NoReturn

import typer

from babyrobot_levels.cli.console import (
    FINDINGS,
    ForceOption,
    OutputOption,
    fail,
    not_one_of,
    note,
    output_option,
    put,
    quoted,
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
    folder_for,
    json_mapping,
    load_level,
    sight_options,
    with_seed,
)
from babyrobot_levels.cli.parallel import JobsOption, Workers, map_all, working
from babyrobot_levels.cli.pictures import picture
from babyrobot_levels.cli.reporting import STANDARD_INPUT, path_bytes, shown_name
from babyrobot_levels.extensions.formats import formats
from babyrobot_levels.extensions.formats.conversion import ConversionError, file_text
from babyrobot_levels.extensions.formats.formats import FORMATS, MODELS, PARTIAL, Format
from babyrobot_levels.extensions.formats.many import Outcome, free_places, losses, worker
from babyrobot_levels.extensions.formats.reading import (
    UnknownFormatError,
    format_of,
    is_environment,
    is_level,
    world_of_id,
)
from babyrobot_levels.extensions.formats.sources import Found, decoded, found_in, is_archive, single
from babyrobot_levels.language.fields import MAX_ROBOTS
from babyrobot_levels.language.names import slug
from babyrobot_levels.text.diagnostics import one_line
from babyrobot_levels.text.errors import BabyRobotError, LevelError
from babyrobot_levels.text.files import SUFFIXES, is_folder, schema_for, write_text
from babyrobot_levels.text.source import SourceFile, with_schema
from babyrobot_levels.text.words import listed

if TYPE_CHECKING:
    from babyrobot_levels.extensions.formats.conversion import Lost, World
    from babyrobot_levels.parallel.executor import Result

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
    if f".{word}" in SUFFIXES:
        _refuse_level_file()
    is_known = word in PICTURES or formats.is_written(word)
    return word if is_known else not_one_of(word, [*formats.written(), *PICTURES])


def _refuse_level_file() -> NoReturn:
    fail("YAML is what level files are", "to write one: babyrobot share LEVEL -o FILE.yaml")


StrictOption = Annotated[
    bool, typer.Option("--strict", help="Write nothing if anything would be lost.")
]


def report_losses(lost: Sequence[tuple[str, Lost]], *, strict: bool) -> None:
    """Report on standard error what is lost of which file; end the command if it is `strict`."""
    for file, each in lost[:MAX_REPORTED]:
        severity = "error" if strict else "warning"
        note(f"{each.place(file)}{severity}: {one_line(str(each))}")
    if len(lost) > MAX_REPORTED:
        note(f"… and {len(lost) - MAX_REPORTED} more")
    if lost and strict:
        raise typer.Exit(FINDINGS)


def import_level(
    files: Annotated[
        list[Path],
        typer.Argument(
            metavar="FILE",
            help="File to convert, `-` for standard input, or the id of an environment of "
            "MiniGrid or of a FrozenLake; or several files, folders and zip files.",
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
    output: Annotated[
        Path | None,
        output_option(
            "Write to this file; several levels to this folder.  [default: -, standard output]"
        ),
    ] = None,
    number: Annotated[
        int | None, value_option("N", "Which world of a file with several.", min=1)
    ] = None,
    robots: Annotated[
        int | None,
        value_option(
            "N", "The first N of MovingAI's scenarios as one level.", min=2, max=MAX_ROBOTS
        ),
    ] = None,
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
    jobs: JobsOption = None,
    force: ForceOption = False,
) -> None:
    """Convert files or an environment of other programs to level files.

    Reads FORMATS. With the package `minigrid` it also makes and resets an environment of MiniGrid
    and reads its grid. What a level cannot express is reported on standard error. Of folders, zip
    files and files with several worlds, all levels are written to the folder of -o.

    Examples:

      babyrobot import setup.py -o levels/setup.yaml

      babyrobot import lake.txt --no-slippery

      babyrobot import maze.txt --from maze-dataset -o levels/maze.yaml

      babyrobot import mazes.zip -o levels/mazes

      babyrobot import collection.txt --number 7

      babyrobot export four-rooms --to minigrid | babyrobot import -

      babyrobot import --from minigrid MiniGrid-DoorKey-8x8-v0 --seed 3 -o door-key.yaml

      babyrobot import FrozenLake-v1 --kwargs '{"map_name": "8x8"}'
    """
    if name is not None:
        check_name(name)
    file = files[0]
    if _is_environment(file, world_format) and len(files) == 1:
        world = _or_end(file, partial(_environment, str(file), seed or 0, kwargs, slippery))
    elif seed is not None or kwargs is not None:
        fail(
            "--seed and --kwargs are for environments",
            "for example `babyrobot import MiniGrid-DoorKey-8x8-v0 --seed 3`",
        )
    elif len(files) > 1 or is_folder(file) or is_archive(file):
        if number is not None or name is not None or robots is not None:
            fail("--number, --robots and --name are for a single level")
        _import_all(files, output, worker(world_format, slippery, strict=strict), jobs, force=force)
        return
    else:
        source = _source(file)
        entry = _or_end(file, partial(_entry, source, world_format, slippery))
        count = len(_or_end(file, partial(entry.parts, source)))
        is_one = number is not None or robots is not None
        if not is_one and count > 1 and output is not None and file != STANDARD_INPUT:
            work = worker(world_format, slippery, strict=strict)
            _import_all(files, output, work, jobs, force=force)
            return
        if not is_one and count > 1:
            fail(
                f"{one_line(shown_name(file))} has {count} worlds",
                "choose one with --number N, or write all with -o FOLDER",
            )
        if number is not None and robots is not None:
            fail("--number and --robots do not go together")
        read = partial(
            entry.read, number=number, robots=robots, slippery=slippery, folder=file.parent
        )
        world = _or_end(file, partial(read, source))
    path = output or Path(f"{name or 'level'}.yaml")
    title = (name or slug(file.stem) or "imported").replace("-", " ").capitalize()
    text = _or_end(file, partial(file_text, world, schema=schema_for(path), name=name, title=title))
    report_losses([(world.file, each) for each in world.lost], strict=strict)
    put(text, output, force=force)


def _or_end(file: Path, function: Callable[[], Result]) -> Result:
    """Return the result of a function; end the command if a world is refused."""
    try:
        return function()
    except UnknownFormatError as error:
        message, _, help_text = str(error).partition("\n  help: ")
        if error.found:
            help_text = "add " + " or ".join(f"--from {each}" for each in error.found)
        fail(message, help_text.replace("give its format,", "add --from with"))
    except ConversionError as error:
        message, here = str(error), one_line(shown_name(str(file)))
        # Messages about a place in the text begin with it.
        note(message if message.startswith(f"{here}:") else f"{here}: error: {message}")
        raise typer.Exit(FINDINGS) from None


def _import_all(
    paths: Sequence[Path],
    output: Path | None,
    work: Callable[[Found], Outcome],
    jobs: int | None,
    *,
    force: bool,
) -> None:
    """Write the levels of files, folders and zip files to a folder, and a summary."""
    if output is None:
        last = quoted(paths[-1]) if paths[1:] and not paths[-1].exists() else "FOLDER"
        fail("several levels are written to a folder", f"give one with -o {last}")
    found: list[Found] = []
    for path in paths:
        many = is_folder(path) or is_archive(path)
        found += _or_end(path, partial(list, found_in(path))) if many else [single(path)]
    outcomes = map_all(work, found, Workers(jobs), "importing")
    folder = folder_for(output)
    schema = schema_for(folder / "level.yaml")
    levels, kept = free_places(outcomes), 0
    for place, text in levels.items():
        path = folder / place.with_name(f"{place.name}.yaml")
        if path.exists() and not force:
            note(f"{path}: error: it already exists (--force overwrites it)")
            continue
        write_text(path, with_schema(text, schema_for(path) if schema else None), sync=False)
        kept += 1
    for outcome in outcomes:
        for reason in outcome.refused:
            note(reason if reason.startswith(outcome.name) else f"{outcome.name}: error: {reason}")
    report_losses(losses(outcomes), strict=False)
    unknown = [one_line(outcome.name) for outcome in outcomes if outcome.is_unknown]
    if unknown:
        more = f" and {len(unknown) - 3} more" if len(unknown) > 3 else ""
        note(f"note: in no known format: {', '.join(unknown[:3])}{more}")
    refused = sum(len(outcome.refused) for outcome in outcomes) + len(levels) - kept
    parts = [
        f"wrote {_counted(kept, 'level')} of {_counted(len(outcomes), 'file')} to {folder}",
        *(f"{refused} refused", f"{len(unknown)} in no known format"),
    ]
    note(", ".join(part for part in parts if not part.startswith("0 ")))
    if refused or not kept:
        raise typer.Exit(FINDINGS)


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


def _entry(source: SourceFile, chosen: str | None, slippery: bool | None) -> Format:
    """Return the format of a text."""
    name = chosen if chosen and not is_level(source) else format_of(source)
    _check_slippery(slippery, FORMATS[name].keywords, name)
    return FORMATS[name]


def _counted(count: int, what: str) -> str:
    return f"{count} {what}{'s' * (count != 1)}"


def _check_slippery(slippery: bool | None, keywords: Sequence[str], name: str) -> None:
    """Refuse --slippery where it means nothing."""
    if slippery is not None and "slippery" not in keywords:
        known = listed([each.texts for each in FORMATS.values() if "slippery" in each.keywords])
        fail(f"--slippery and --no-slippery are for {known}, not for {name}")


def _source(file: Path) -> SourceFile:
    try:
        return _or_end(file, partial(decoded, path_bytes(file), shown_name(file)))
    except LevelError as error:
        diagnostic = error.diagnostics[0]
        if diagnostic.code == "BR101":
            named = "an environment is named with its version, such as FrozenLake-v1"
            fail(f"{file}: {diagnostic.message}", None if file.suffix else named)
        # It may be a picture, or a compressed file.
        help_text = "it reads texts and zip files: `babyrobot import --help` names the formats"
        if diagnostic.code == "BR102":
            diagnostic = replace(diagnostic, help=help_text)
        raise LevelError([diagnostic]) from None


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
    suffix = output.suffix.lower()[1:] if output else ""
    if suffix in PICTURES and suffix != chosen:
        fail(f"{output} is no file of the format {chosen}", "leave out --to, or name another file")
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
        report_losses([("", each) for each in conversion.warnings], strict=strict)
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
    if name is None and suffix in SUFFIXES:
        _refuse_level_file()
    if name is None:
        known = ", ".join([*formats.written(), *PICTURES])
        fail("the output format is missing", f"add --to with one of {known}")
    return name
