"""`babyrobot generate`: many levels that meet given conditions."""

from __future__ import annotations

import os
import re
import shlex
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from babyrobot_levels.cli.console import FINDINGS, fail, note, write
from babyrobot_levels.cli.new_level import Algorithm
from babyrobot_levels.cli.parallel import MAX_JOBS, WORTH_IT, JobsOption, map_all, track
from babyrobot_levels.text.diagnostics import one_line

if TYPE_CHECKING:
    from babyrobot_levels.generate.folder import Target
    from babyrobot_levels.generate.order import Order
    from babyrobot_levels.generate.search import StarvedError
    from babyrobot_levels.generate.suites import Suite
    from babyrobot_levels.language.looks import Theme
    from babyrobot_levels.language.suite import SuiteFields

INTERRUPTED = 130
"""Exit status: somebody pressed Ctrl-C."""

MAX_FILES = 1_000_000


class Place(StrEnum):
    """Where a start or an exit is."""

    CORNER = "corner"
    RANDOM = "random"
    FARTHEST = "farthest"


def generate(
    suite: Annotated[
        str | None,
        typer.Argument(
            metavar="[SUITE]",
            help="A suite's name or file, in the place of what it says.",
            show_default=False,
        ),
    ] = None,
    count: Annotated[
        int | None,
        typer.Option(metavar="N", help="How many levels.", show_default=False),
    ] = None,
    size: Annotated[
        str | None,
        typer.Option(
            metavar="SIZE",
            help="Width and height, or a range: 8x5, 6x6..12x12.  [default: 8x5]",
            show_default=False,
        ),
    ] = None,
    algorithm: Annotated[
        list[Algorithm] | None,
        typer.Option(
            metavar="A",
            help="How mazes are grown; given several times, one is drawn for each level.  "
            "[default: depth-first]",
            show_default=False,
        ),
    ] = None,
    loops: Annotated[
        str | None,
        typer.Option(
            metavar="R", help="The share of dead ends to open up: 0.5, 0..1.", show_default=False
        ),
    ] = None,
    puddles: Annotated[
        str | None,
        typer.Option(metavar="A..B", help="How many puddles: 3, 0..4.", show_default=False),
    ] = None,
    path_length: Annotated[
        str | None,
        typer.Option(
            metavar="A..B",
            help="How many steps a shortest walk to the exit takes: 20..30, 20.., 18.",
            show_default=False,
        ),
    ] = None,
    dead_ends: Annotated[
        str | None,
        typer.Option(
            metavar="A..B", help="How many cells have exactly one open side.", show_default=False
        ),
    ] = None,
    difficulty: Annotated[
        str | None,
        typer.Option(
            metavar="A..B", help="How hard the levels are (see `show`).", show_default=False
        ),
    ] = None,
    start: Annotated[
        Place | None,
        typer.Option(help="Where the robot starts.  [default: corner]", show_default=False),
    ] = None,
    exit_: Annotated[
        Place | None,
        typer.Option("--exit", help="Where the exit is.  [default: corner]", show_default=False),
    ] = None,
    theme: Annotated[
        str | None,
        typer.Option(
            metavar="THEME", help="The theme: default, black_orange, …", show_default=False
        ),
    ] = None,
    seed: Annotated[
        int | None,
        typer.Option(
            metavar="S",
            help="What everything is drawn from; the same seed gives the same files.  [default: 0]",
            show_default=False,
        ),
    ] = None,
    split: Annotated[
        str | None,
        typer.Option(
            metavar="NAME=R,…",
            help="Write folders that share no maze: train=0.8,test=0.2.",
            show_default=False,
        ),
    ] = None,
    names: Annotated[
        str | None,
        typer.Option(
            "--name",
            metavar="PATTERN",
            help="What the levels are called.  [default: level-{index:05}]",
            show_default=False,
        ),
    ] = None,
    output: Annotated[
        Path,
        typer.Option("--output", "-o", metavar="DIR", help="The folder to write to."),
    ] = Path("levels"),
    exclude: Annotated[
        list[Path] | None,
        typer.Option(
            metavar="DIR",
            help="No game that is in this folder; may be repeated.",
            show_default=False,
        ),
    ] = None,
    resume: Annotated[
        bool, typer.Option("--resume", help="Go on where a call with the same order stopped.")
    ] = False,
    force: Annotated[bool, typer.Option("--force", help="Overwrite files.")] = False,
    jobs: JobsOption = None,
) -> None:
    """Write levels to order: solvable, no two the same game, the same for the same seed.

    A suite file may state the order in the place of options. Level i is drawn from the seed and i
    alone, so that more levels can be ordered later (--count with --resume).

    Ends with status 1 if the order cannot be met: then it says which condition starves.

    Examples:

      babyrobot generate --count 20 -o mazes

      babyrobot generate --count 100 --size 6x6..9x9 --path-length 20.. --seed 7 -o long-ways

      babyrobot generate --count 1000 --split train=0.8,test=0.2 -o data

      babyrobot generate small-mazes -o data
    """
    from babyrobot_levels.generate.folder import FolderError, Target

    words = Words(
        count=count,
        size=size,
        algorithm=tuple(map(str, algorithm or ())),
        loops=loops,
        puddles=puddles,
        path_length=path_length,
        dead_ends=dead_ends,
        difficulty=difficulty,
        start=start,
        exit=exit_,
        theme=theme,
        seed=seed,
        split=split,
    )
    if output.exists() and not output.is_dir():
        fail(f"{output} is no folder")
    if any(output.resolve().is_relative_to(folder.resolve()) for folder in exclude or []):
        fail("--exclude names the folder to write to")
    order = _order(suite, words, names, _games_in(exclude or [], jobs))
    target = Target(order, output, resume, force)
    try:
        _write(target, jobs)
    except FolderError as error:
        fail(str(error), error.help)


def _order(suite: str | None, words: Words, names: str | None, excluded: frozenset[str]) -> Order:
    from babyrobot_levels.generate.order import DEFAULT_NAMES, Order, is_pattern
    from babyrobot_levels.text.errors import LevelError

    if suite is None:
        if words.count is None:
            fail("how many levels?", "say it with --count N, or name a suite")
        fields, told, pattern = suite_of(words), words.told(), DEFAULT_NAMES
    else:
        fields, pattern = _suite_named(suite, words)
        told = f"suite {fields.name or 'without a name'}, seed {fields.seed}"
    if fields.count > MAX_FILES:
        fail(f"{fields.count:,} levels are too many files", f"ask for at most {MAX_FILES:,}")
    pattern = names or pattern
    if not is_pattern(pattern):
        fail(f"--name: {pattern!r} is no pattern of names", "for example 'maze-{index:05}'")
    if excluded:
        told += f", without {len(excluded):,} games"
    order = Order(fields, pattern, told, excluded)
    try:
        order.maker().draw(0, 0)
    except LevelError as error:
        # All that can be wrong is the theme: the files must be valid wherever they are.
        fail(error.diagnostics[0].message, error.diagnostics[0].help)
    return order


def _suite_named(suite: str, words: Words) -> tuple[SuiteFields, str]:
    """Return a suite's fields, with the count if one is given, and what its levels are called."""
    from babyrobot_levels.generate.suites import load_suite, name_pattern
    from babyrobot_levels.language.plain_data import plain
    from babyrobot_levels.library.reading import suite_from_mapping

    given = [name for name in words.given() if name != "--count"]
    if given:
        fail(f"the suite says what {given[0]} says", "leave out one of the two")
    loaded = load_suite(suite)
    changes: dict[str, Any] = {} if words.count is None else {"count": words.count}
    theme = _theme_beside(loaded)
    if theme is not None:
        changes["theme"] = plain(theme)
    fields = loaded.fields
    if changes:
        fields = suite_from_mapping({**plain(fields), "name": fields.name, **changes})
    return fields, name_pattern(fields)


def _theme_beside(suite: Suite) -> Theme | None:
    """Return the theme that stands beside a suite's file: its levels carry it with them."""
    from babyrobot_levels.language.looks import BUILTIN_THEMES
    from babyrobot_levels.language.themes import read_theme, theme_folders

    name, folder = suite.fields.theme, suite.folder
    if not isinstance(name, str) or name in BUILTIN_THEMES or folder is None:
        return None
    return read_theme(name, theme_folders(folder))[0]


def _games_in(folders: list[Path], jobs: int | None) -> frozenset[str]:
    """Return the digests of all levels in some folders."""
    from babyrobot_levels.library.search_path import yaml_files

    for folder in folders:
        if not folder.is_dir():
            fail(f"--exclude: {folder} is no folder")
    files = [path for folder in folders for path in yaml_files(folder, all_of_them=True)]
    found = map_all(digest_of, files, jobs, "reading")
    return frozenset(digest for digest in found if digest is not None)


def digest_of(path: Path) -> str | None:
    """Return the digest of a file's level, None for suites, faulty levels, and random mazes."""
    from babyrobot_levels.library.reading import read_file

    level = read_file(path)[0]
    return None if level is None or level.has_random_maze else level.digest


def _write(target: Target, jobs: int | None) -> None:
    """Write the files, and tell what was written."""
    from babyrobot_levels.generate.search import StarvedError

    count = target.order.suite.count
    if jobs is None:
        jobs = (os.cpu_count() or 1) if count >= WORTH_IT else 1
    jobs = min(jobs, MAX_JOBS)
    there = written = 0
    try:
        for is_new in track(target.write(jobs), count, "generating"):
            written += is_new
            there += not is_new
    except StarvedError as error:
        note(_starved(error, from_options=target.order.told.startswith("babyrobot")))
        note(f"  {target.there():,} of {count:,} levels are in {target.folder}")
        raise typer.Exit(FINDINGS) from None
    except KeyboardInterrupt:
        note(f"stopped: {target.there():,} of {count:,} levels are in {target.folder}")
        note("  help: the same call with --resume goes on")
        raise typer.Exit(INTERRUPTED) from None
    write(_summary(target, written, there))


def _starved(error: StarvedError, *, from_options: bool) -> str:
    """Return why an order cannot be met, in the words in which it was given."""
    from babyrobot_levels.language.suite import SuiteFields

    told = str(error)
    if not from_options:
        return told
    names = "|".join(SuiteFields.model_fields)
    return re.sub(rf"(^|(?<=met ))({names})\b", lambda found: option(found[2]), told)


def _summary(target: Target, written: int, there: int) -> str:
    text = f"wrote {written:,} level{'s' * (written != 1)} to {one_line(str(target.folder))}"
    if there:
        text += f"; {there:,} {'were' if there != 1 else 'was'} there"
    splits = target.sizes()
    if splits:
        text += ": " + ", ".join(f"{size:,} in {name}" for name, size in splits.items())
    return text + "\n"


_NUMBER = r"[0-9]{1,9}(?:\.[0-9]{1,9})?"
_SIZE = re.compile(r"([0-9]{1,5})[x,]([0-9]{1,5})")
_RANGE = re.compile(rf"({_NUMBER})?\.\.({_NUMBER})?")


@dataclass(frozen=True, slots=True)
class Words:
    """What a call asks for, as it was typed; None for what it does not say."""

    count: int | None = None
    size: str | None = None
    algorithm: tuple[str, ...] = ()
    loops: str | None = None
    puddles: str | None = None
    path_length: str | None = None
    dead_ends: str | None = None
    difficulty: str | None = None
    start: str | None = None
    exit: str | None = None
    theme: str | None = None
    seed: int | None = None
    split: str | None = None

    def given(self) -> dict[str, Any]:
        """Return what is said, by the names of the options."""
        pairs = ((name, getattr(self, name)) for name in self.__slots__)
        return {option(name): value for name, value in pairs if value not in (None, ())}

    def told(self) -> str:
        """Return the call that asks for the same levels, as a line of a shell."""
        said = {"--size": "8x5", **self.given(), "--seed": self.seed or 0}
        del said["--count"]
        if "--split" in said:
            # Of how many levels there are the splits are shares.
            said = {"--count": self.count, **said}
        words = []
        for name, value in said.items():
            for each in value if isinstance(value, tuple) else (value,):
                words += [name, shlex.quote(str(each))]
        return " ".join(["babyrobot", "generate", *words])


def option(field: str) -> str:
    """Return the option that stands for a field of a suite."""
    return "--" + {"splits": "split", "maze": "loops"}.get(field, field).replace("_", "-")


def suite_of(words: Words) -> SuiteFields:
    """Return the suite that a call asks for; if it asks for what cannot be, say so and end."""
    from babyrobot_levels.language.suite import SuiteFields
    from babyrobot_levels.language.validation import validate

    data: dict[str, Any] = {"version": 1, "kind": "suite", "count": words.count}
    maze: dict[str, Any] = {}
    if words.algorithm:
        maze["algorithm"] = list(words.algorithm)
    if words.loops is not None:
        maze["loops"] = _range("loops", words.loops)
    if maze:
        data["maze"] = maze
    if words.size is not None:
        data["size"] = _sizes(words.size)
    if words.split is not None:
        data["splits"] = _splits(words.split)
    for name in ("puddles", "path_length", "dead_ends", "difficulty"):
        text = getattr(words, name)
        if text is not None:
            data[name] = _range(name, text)
    for name in ("start", "exit", "theme", "seed"):
        if getattr(words, name) is not None:
            data[name] = getattr(words, name)
    suite, problems = validate(data, SuiteFields)
    if suite is None:
        field, message = str(problems[0].route[0]), problems[0].message
        message = re.sub(r"^`[^`]*` (?=must )", "", message)
        fail(f"{option(field)}: {message}", problems[0].help)
    return suite


def _sizes(text: str) -> Any:
    least, dots, most = text.partition("..")
    if not dots:
        return _size(text, text)
    return {"min": _size(least, text), "max": _size(most, text)}


def _size(part: str, text: str) -> list[int]:
    match = _SIZE.fullmatch(part)
    if not match:
        fail(f"--size: {text!r} is no size", "8x5 is one, and 6x6..12x12 a range of them")
    return [int(match[1]), int(match[2])]


def _range(name: str, text: str) -> Any:
    """Return a number, or a mapping with `min` and `max`."""
    match = _RANGE.fullmatch(text)
    if match and (match[1] or match[2]):
        ends = {"min": match[1], "max": match[2]}
        return {end: _plain(value) for end, value in ends.items() if value}
    if not re.fullmatch(_NUMBER, text):
        fail(f"{option(name)}: {text!r} is no range", "20..30 is one; 20, 20.. and ..30 are, too")
    return _plain(text)


def _plain(text: str) -> int | float:
    return float(text) if "." in text else int(text)


def _splits(text: str) -> dict[str, float]:
    shares: dict[str, float] = {}
    for part in text.split(","):
        name, _, share = part.strip().partition("=")
        if not re.fullmatch(_NUMBER, share) or not name or name in shares:
            fail(f"--split: {text!r} names no shares", "train=0.8,test=0.2 does")
        shares[name] = float(share)
    return shares
