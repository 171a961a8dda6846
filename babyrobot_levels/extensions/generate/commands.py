"""`babyrobot generate`: many levels that meet given conditions."""

from __future__ import annotations

import inspect
import math
import re
import shlex
from collections.abc import Callable, Mapping
from contextlib import closing
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, get_args

import typer

import babyrobot_levels as brl
from babyrobot_levels.cli.app import INTERRUPTED
from babyrobot_levels.cli.console import FINDINGS, fail, flag, note, value_option, write
from babyrobot_levels.cli.inputs import load_level
from babyrobot_levels.cli.parallel import (
    JobsOption,
    RayAddressOption,
    RayOption,
    Workers,
    map_all,
    track,
)
from babyrobot_levels.language.cells import Algorithm
from babyrobot_levels.language.suite import Place, SuiteFields
from babyrobot_levels.text.diagnostics import one_line
from babyrobot_levels.text.scalars import resolve

if TYPE_CHECKING:
    from babyrobot_levels.extensions.generate.batch import Batch, Target
    from babyrobot_levels.language.suite import SuiteFields

MAX_FILES = 1_000_000

_NUMBER = r"[0-9]{1,9}(?:\.[0-9]{1,9})?"
_SIZE = re.compile(r"([0-9]{1,5})[xX×,]([0-9]{1,5})")

RANGE = "A..B"
"""How help shows a number or a range."""

# An enum, because typer takes no lists of literals.
AlgorithmName = StrEnum(  # type: ignore[misc]
    "AlgorithmName", {name.upper().replace("-", "_"): name for name in get_args(Algorithm)}
)

_CONDITIONS: dict[str, tuple[Any, str | None, str]] = {
    "count": (int, "N", "Number of levels."),
    "size": (str, "SIZE", "Width and height, or a range of them: 8x5, 6x6..12x12.  [default: 8x5]"),
    "algorithm": (
        list[AlgorithmName],
        "A",
        "Maze algorithm; if repeated, one of them is drawn for each level.  [default: depth-first]",
    ),
    "loops": (str, "R", "Share of dead ends to open: 0.5, 0..1."),
    "puddles": (str, RANGE, "Number of puddles: 3, 0..4."),
    "wind": (str, RANGE, "Number of rows and columns with wind: 2, 0..3."),
    "keys": (str, RANGE, "Number of keys, all needed: 1, 1..3."),
    "doors": (str, RANGE, "Number of locked doors.  [default: one for each key]"),
    "coins": (str, RANGE, "Number of coins: 3, 0..4."),
    "guards": (str, RANGE, "Number of guards on patrol: 1, 0..2."),
    "boxes": (str, RANGE, "Number of boxes, each with a target, in place of an exit: 2, 1..3."),
    "detour": (
        str,
        RANGE,
        "Steps that doors, guards and wind add to the shortest path: 10.., 6..12.",
    ),
    "path_length": (
        str,
        RANGE,
        "Length of the shortest path to the exit, with open doors: 20..30, 20.., 18.",
    ),
    "dead_ends": (str, RANGE, "Number of cells with exactly one open side: 5..8."),
    "difficulty": (str, RANGE, "Difficulty, as in `babyrobot show`: 4..6."),
    "expect": (
        list[str],
        f"METRIC={RANGE}",
        "What must be true of each level, as `expect` of level files; may be repeated: "
        "best_steps=20..30, needs=key, success=0.8...  [default: success=1]",
    ),
    "start": (Place, None, "Position of the start.  [default: corner]"),
    "exit": (Place, None, "Position of the exit.  [default: corner]"),
    "rewards": (
        str,
        "NAME=NUMBER,…",
        "Rewards of a step, as in level files: step=-0.1,exit=10.  [default: step=-1,exit=0]",
    ),
    "hit": (
        float,
        "NUMBER",
        "Reward of meeting a guard, which ends the episode.  [default: below any way to the exit]",
    ),
    "discount": (float, "D", "Discount factor of the levels.  [default: 1]"),
    "max_steps": (int, "N", "Number of steps after which episodes are truncated."),
    "theme": (
        str,
        "THEME",
        "Theme: default, babyrobot, black_orange, blue_green, dark, green, high_contrast or print.",
    ),
    "seed": (int, "S", "Random seed: the same seed generates the same files.  [default: 0]"),
    "split": (
        str,
        "NAME=SHARE,…",
        "Split the levels into folders that share no maze: train=0.8,test=0.2.",
    ),
}
"""The options that state conditions: their types, how help shows values, and their texts."""


def with_conditions(command: Callable[..., None]) -> Callable[..., None]:
    """Give a command that takes any keywords the options that state conditions, as its second."""
    signature = inspect.signature(command, eval_str=True)
    first, *others = (
        each for each in signature.parameters.values() if each.kind != each.VAR_KEYWORD
    )
    options = [
        first.replace(name=name, annotation=Annotated[kind | None, value_option(metavar, text)])
        for name, (kind, metavar, text) in _CONDITIONS.items()
    ]
    parameters = [first, *options, *others]
    command.__annotations__ = {each.name: each.annotation for each in parameters}
    command.__signature__ = signature.replace(parameters=parameters)  # type: ignore[attr-defined]
    return command


@with_conditions
def generate(
    suite: Annotated[
        str | None,
        typer.Argument(
            metavar="[SUITE]",
            help="Name or file of a suite, in place of the options up to --split.",
            show_default=False,
        ),
    ] = None,
    base: Annotated[
        str | None,
        value_option(
            "LEVEL", "Mutate this level instead of growing mazes: its name or file.", "--from"
        ),
    ] = None,
    edits: Annotated[
        str | None,
        value_option(RANGE, "Number of random edits, with --from: 3, 1..5.  [default: 1]"),
    ] = None,
    names: Annotated[
        str | None,
        value_option(
            "PATTERN",
            "Names of the levels, with {index} for the number or {index:02} for two digits.  "
            "[default: level-{index:05}]",
            "--name",
        ),
    ] = None,
    title: Annotated[
        str | None,
        value_option("PATTERN", "Titles of the levels, such as 'Maze {index}'.  [default: none]"),
    ] = None,
    first: Annotated[
        int,
        typer.Option(
            min=0, max=1_000_000, metavar="N", help="Index of the first level in names and titles."
        ),
    ] = 0,
    output: Annotated[
        Path, typer.Option("--output", "-o", metavar="DIR", help="Folder to write to.")
    ] = Path("levels"),
    exclude: Annotated[
        list[Path] | None,
        value_option(
            "DIR", "Skip levels that are the same MDP as one in this folder; may be repeated."
        ),
    ] = None,
    resume: Annotated[
        bool,
        flag("--resume", "Keep existing levels of the same call, and generate the missing ones."),
    ] = False,
    force: Annotated[bool, flag("--force", "Overwrite existing files.")] = False,
    keep_going: Annotated[
        bool, flag("--keep-going", "Leave out levels that cannot be made.")
    ] = False,
    jobs: JobsOption = None,
    ray: RayOption = False,
    ray_address: RayAddressOption = None,
    **conditions: Any,
) -> None:
    """Generate levels that meet conditions: solvable, all different, reproducible by a seed.

    Conditions are given by options, or by the file of a suite. Level number i depends on the seed
    and on i alone, so more levels can be added later (a higher --count with --resume).

    Exits with status 1 if a condition cannot be met, and reports how close the candidates came.

    Examples:

      babyrobot generate --count 20 -o mazes

      babyrobot generate --count 100 --size 6x6..9x9 --path-length 20.. --seed 7 -o long-ways

      babyrobot generate --count 10 --size 9x9 --keys 2 --coins 3 --detour 12.. -o locked

      babyrobot generate --count 200 --split train=0.8,test=0.2 -o data

      babyrobot generate small-mazes --count 100 -o data

      babyrobot generate --from final-maze --edits 1..5 --count 20 -o mutants
    """
    from babyrobot_levels.extensions.generate.batch import Target

    if suite is not None and suite.isdecimal():
        fail(f"{suite} is no suite", "give the size as --size 8x5, and the number as --count N")
    if conditions["size"]:
        conditions["size"] = re.sub("[X×]", "x", conditions["size"])
    workers = Workers(jobs, ray, ray_address)
    if output.exists() and not output.is_dir():
        fail(f"{output} is not a folder")
    if any(output.resolve().is_relative_to(folder.resolve()) for folder in exclude or []):
        fail("--exclude contains the folder to write to", "write to another folder")
    excluded = _digests_in(exclude or [], workers)
    if edits is not None and base is None:
        fail("--edits needs a level to edit", "add --from LEVEL")
    batch = _batch(suite, conditions, excluded, names, title, first, base, edits)
    target = Target(batch, output, resume, force)
    try:
        _write(target, workers, keep_going=keep_going)
    except brl.FolderError as error:
        fail(str(error), error.help)


def _batch(
    suite: str | None,
    conditions: dict[str, Any],
    excluded: frozenset[str],
    names: str | None,
    title: str | None,
    first: int,
    base: str | None,
    edits: str | None,
) -> Batch:
    from babyrobot_levels.extensions.generate.batch import Batch, Original, is_pattern, is_title
    from babyrobot_levels.extensions.generate.generate import described
    from babyrobot_levels.suites.sources import name_pattern

    own: dict[str, Any] = {}
    original, parents = None, frozenset[str]()
    if base is not None:
        _check_mutants(suite, conditions)
        level, own = load_level(base), {"--from": base, "--edits": edits or "1"}
        original = Original.of(level, _range("edits", own["--edits"]))
        parents = frozenset([level.digest])
    if suite is None:
        if conditions["count"] is None:
            fail("the number of levels is missing", "add --count N, or the name of a suite")
        description = command_line(conditions, own or {"--size": "8x5"})
        # All metrics may be expected of mutants, as of levels with things.
        fields = suite_of({**conditions, "guards": "1"} if own else conditions)
    else:
        fields = _suite_named(suite, conditions)
        description = described(fields)
    if fields.count > MAX_FILES:
        fail(f"--count must be at most {MAX_FILES:,}, not {fields.count:,}")
    pattern = names or name_pattern(fields)
    if not is_pattern(pattern):
        fail(f"--name: invalid pattern {pattern!r}", "expected a name such as 'maze-{index:02}'")
    if title is not None and not is_title(title):
        fail(f"--title: invalid pattern {title!r}", "expected a text such as 'Maze {index}'")
    if excluded:
        description += f", without {len(excluded):,} games"
    batch = Batch(fields, pattern, description, excluded | parents, first, title, original)
    try:
        maker = batch.maker()
        if original is None:
            maker.draw(0, 0)
    except brl.LevelError as error:
        # Only the theme can be wrong: the files must be valid wherever they are.
        fail(error.diagnostics[0].message, error.diagnostics[0].help)
    except ValueError as error:
        fail(f"--{error}")
    return batch


def _check_mutants(suite: str | None, conditions: dict[str, Any]) -> None:
    """End the command if mutants of a level cannot meet a condition."""
    from babyrobot_levels.extensions.generate.mutation import MUTANT_FIELDS

    known = {*map(option, MUTANT_FIELDS), "--count"}
    wrong = [name for name in given_options(conditions) if name not in known]
    if suite is not None or wrong:
        what = wrong[0] if wrong else "a suite"
        fail(f"{what} cannot be combined with --from", "leave out one of the two")


def _suite_named(suite: str, conditions: dict[str, Any]) -> SuiteFields:
    """Return a suite's fields, with the given count."""
    from babyrobot_levels.extensions.generate.generate import fields_to_generate

    if given := [name for name in given_options(conditions) if name != "--count"]:
        fail(f"{given[0]} cannot be combined with a suite", "leave out one of the two")
    loaded = brl.load_suite(suite)
    fields = loaded.fields
    if not isinstance(fields, SuiteFields):
        fail(
            f"{fields.name or 'the suite'} lists its levels, so there is nothing to generate",
            "generate a suite that grows mazes, or copy the files of these levels",
        )
    try:
        return fields_to_generate(fields, loaded.folder, conditions["count"])
    except ValueError as error:
        fail(f"--{error}")


def _digests_in(folders: list[Path], workers: Workers) -> frozenset[str]:
    """Return the digests of all levels in some folders."""
    from babyrobot_levels.library.search_path import yaml_files

    for folder in folders:
        if not folder.is_dir():
            fail(f"--exclude: {folder} is not a folder")
    files = [path for folder in folders for path in yaml_files(folder, all_of_them=True)]
    found = map_all(digest_of, files, workers, "reading")
    return frozenset(digest for digest in found if digest is not None)


def digest_of(path: Path) -> str | None:
    """Return the digest of a file's level, None for suites, invalid levels and random mazes."""
    from babyrobot_levels.library.level import load_file

    try:
        level = load_file(path)
    except brl.LevelError:
        return None
    return None if level.has_random_maze else level.digest


def _write(target: Target, workers: Workers, *, keep_going: bool) -> None:
    """Write the files, and report the number."""
    count = target.batch.suite.count
    kept = written = 0
    errors: list[Exception] = []
    try:
        with closing(target.write(workers.executor(count), keep_going=True)) as levels:
            for level in track(levels, count, "generating"):
                written += level.is_new
                kept += not (level.is_new or level.error)
                if level.error is not None:
                    note(f"level {level.index}: {_reason(target, level.error)}")
                    errors.append(level.error)
                    if not keep_going:
                        break
    except KeyboardInterrupt:
        note(f"stopped: {target.there():,} of {count:,} levels are in {target.folder}")
        note("  help: continue with the same call and --resume")
        raise typer.Exit(INTERRUPTED) from None
    if errors and not keep_going:
        note(f"  {target.there():,} of {count:,} levels are in {target.folder}")
        _note_help(target, errors[0])
    else:
        write(_summary(target, written, kept, len(errors)))
    if errors:
        raise typer.Exit(FINDINGS)


def _reason(target: Target, error: Exception) -> str:
    """Return why a level could not be made."""
    if isinstance(error, brl.UnsatisfiableError):
        return _unmet(error, from_options=target.batch.description.startswith("babyrobot"))
    return (
        str(error) if isinstance(error, brl.BabyRobotError) else f"{type(error).__name__}: {error}"
    )


def _note_help(target: Target, error: Exception) -> None:
    needs, help_text = getattr(error, "needs", None), getattr(error, "help", None)
    if help_text:
        note(f"  help: {help_text}")
    elif str(error).startswith("expect success 1:"):
        note("  help: the best policy has to win: change what steps, hits and exits pay")
    elif needs is not None:
        note(f"  help: use a larger size, for example {_grown(target.batch.suite, needs)}")


def _unmet(error: brl.UnsatisfiableError, *, from_options: bool) -> str:
    """Return which condition was not met: by its option, or by its field in a suite."""
    text = str(error)
    if not from_options:
        return text
    names = "|".join(SuiteFields.model_fields)
    text = re.sub(rf"(^|(?<=met ))({names})\b", lambda found: option(found[2]), text)
    return re.sub(r"(--expect \w+) ", r"\1=", text)


def _grown(suite: SuiteFields, factor: float) -> str:
    """Return a size that is larger by a factor, as it is typed."""
    from babyrobot_levels.language.base import MAX_SIZE

    return "x".join(str(min(MAX_SIZE, math.ceil(factor * cells))) for cells in suite.largest)


def _summary(target: Target, written: int, kept: int, left_out: int) -> str:
    text = f"wrote {written:,} level{'s' * (written != 1)} to {one_line(str(target.folder))}"
    if kept:
        text += f"; kept {kept:,}"
    if left_out:
        text += f"; left out {left_out:,}"
    if splits := target.sizes():
        text += ": " + ", ".join(f"{size:,} in {name}" for name, size in splits.items())
    return text + "\n"


# -- options --------------------------------------------------------------------------------


def given_options(typed: Mapping[str, Any]) -> dict[str, Any]:
    """Return the values that were given, by option."""
    return {option(name): value for name, value in typed.items() if value not in (None, [])}


def command_line(typed: Mapping[str, Any], first: Mapping[str, Any]) -> str:
    """Return the call that generates the same levels, as a line for a shell.

    Args:
        typed: the values that were given, by the names of parameters.
        first: what the line begins with, by option, unless another value was given.
    """
    given = {**first, **given_options(typed), "--seed": typed["seed"] or 0}
    del given["--count"]
    if "--split" in given:
        # The splits depend on the number of levels.
        given = {"--count": typed["count"], **given}
    words = []
    for name, value in given.items():
        for each in value if isinstance(value, list) else (value,):
            text = str(each)
            words += [
                name,
                shlex.quote(text.removesuffix(".0") if isinstance(each, float) else text),
            ]
    return " ".join(["babyrobot", "generate", *words])


def option(field: str) -> str:
    """Return the option for a field of a suite."""
    return "--" + {"splits": "split", "maze": "loops"}.get(field, field).replace("_", "-")


def suite_of(typed: Mapping[str, Any]) -> SuiteFields:
    """Return the suite that options describe; end the command if they are wrong."""
    from babyrobot_levels.language.validation import route_of, validate

    data: dict[str, Any] = {"version": 1, "kind": "suite"}
    for name, value in typed.items():
        if value in (None, []):
            continue
        if name in ("algorithm", "loops"):
            maze = data.setdefault("maze", {})
            maze[name] = [*map(str, value)] if name == "algorithm" else _range(name, value)
        elif name == "size":
            data[name] = _sizes(value)
        elif name == "split":
            data["splits"] = _numbers(name, value, "train=0.8,test=0.2")
        elif name == "rewards":
            data[name] = _numbers(name, value, "step=-1,exit=10")
        elif name == "expect":
            data[name] = _facts(value)
        elif name == "hit":
            data[name] = {"reward": value}
        else:
            is_range = _CONDITIONS[name][1] == RANGE
            data[name] = _range(name, value) if is_range else value
    suite, problems = validate(data, SuiteFields)
    if suite is None:
        field, message = str(route_of(problems[0])[0]), problems[0].message
        message = re.sub(r"^`[^`]*` (?=must )", "", message)
        told = problems[0].help
        fail(
            f"{option(field)}: {message}",
            told and told.replace(": ", "=") if field == "rewards" else told,
        )
    return suite


def _sizes(text: str) -> Any:
    least, dots, most = text.partition("..")
    if not dots:
        return _size(text, text)
    return {"min": _size(least, text), "max": _size(most, text)}


def _size(part: str, text: str) -> list[int]:
    match = _SIZE.fullmatch(part)
    if not match:
        fail(f"--size: invalid size {text!r}", "expected 8x5, or a range such as 6x6..12x12")
    return [int(match[1]), int(match[2])]


def _range(name: str, text: str) -> Any:
    """Return a number, or a range as it is written."""
    from babyrobot_levels.language.ranges import ends

    if ends(text):
        return text
    if not re.fullmatch(_NUMBER, text):
        fail(f"{option(name)}: invalid range {text!r}", "expected 20..30, 20, 20.. or ..30")
    return resolve(text)


def _facts(texts: list[str]) -> dict[str, Any]:
    """Return what is stated of metrics, by their names."""
    facts: dict[str, Any] = {}
    for text in texts:
        metric, _, value = text.partition("=")
        if not metric or not value or metric in facts:
            fail(f"--expect: invalid value {text!r}", "expected one METRIC=RANGE for each metric")
        facts[metric] = value.split(",") if metric == "needs" else resolve(value)
    return facts


def _numbers(name: str, text: str, example: str) -> dict[str, float]:
    """Return numbers by their names."""
    numbers: dict[str, float] = {}
    for part in text.split(","):
        key, _, number = part.strip().partition("=")
        if not re.fullmatch(f"-?{_NUMBER}", number) or not key or key in numbers:
            fail(
                f"{option(name)}: invalid value {text!r}",
                f"expected {_CONDITIONS[name][1]}, for example {example}",
            )
        numbers[key] = float(number)
    return numbers
