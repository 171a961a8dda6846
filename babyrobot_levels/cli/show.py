"""`babyrobot show` and `babyrobot list`: the facts about levels, and which there are."""

from __future__ import annotations

import math
import sys
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from enum import StrEnum
from functools import partial
from importlib import import_module
from operator import attrgetter
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from babyrobot_levels import __version__
from babyrobot_levels.cli import meant
from babyrobot_levels.cli.console import (
    FormatOption,
    ReportFormat,
    TableFormat,
    TableOption,
    fact_lines,
    fail,
    hanging,
    note,
    quoted,
    short,
    value_option,
    width_of,
    write,
    write_json,
    write_table,
)
from babyrobot_levels.cli.inputs import (
    LevelsArgument,
    SightOption,
    SplitOption,
    ViewRadiusOption,
    load_level,
    sight_options,
)
from babyrobot_levels.cli.many import (
    Columns,
    KeepGoingOption,
    OverwriteOption,
    ResumeOption,
    RowOptions,
    RowsOption,
    levels_for_rows,
    number,
    write_rows,
)
from babyrobot_levels.cli.parallel import JobsOption, RayAddressOption, RayOption, Workers, track
from babyrobot_levels.cli.pictures import text_picture
from babyrobot_levels.cli.reporting import STANDARD_INPUT
from babyrobot_levels.cli.sights import cost_text, sight_solution
from babyrobot_levels.language.metric_names import MAX_SOLVED, METRICS, UNLIMITED
from babyrobot_levels.language.plain_data import json_value
from babyrobot_levels.language.ranges import ends
from babyrobot_levels.library.catalogue import (
    catalogue,
    files_in,
    is_suite_file,
    suite_files,
    suite_path,
)
from babyrobot_levels.library.packs import KnownPack, fields, known_packs, unusable_packs
from babyrobot_levels.library.search_path import PATH_VARIABLE, Place, path_folders
from babyrobot_levels.text.diagnostics import one_line
from babyrobot_levels.text.errors import LevelError
from babyrobot_levels.text.source import printable

if TYPE_CHECKING:
    from babyrobot_levels.language.suite_list import PackFields
    from babyrobot_levels.library.catalogue import LevelInfo
    from babyrobot_levels.library.level import Level
    from babyrobot_levels.suites.suite import Suite


def show(
    levels: LevelsArgument,
    citation: Annotated[
        bool, typer.Option("--cite", help="Print one line to cite: name, versions and digest.")
    ] = False,
    sight: SightOption = None,
    view_radius: ViewRadiusOption = None,
    split: SplitOption = None,
    report_format: TableOption = TableFormat.TEXT,
    output: RowsOption = None,
    resume: ResumeOption = False,
    force: OverwriteOption = False,
    keep_going: KeepGoingOption = False,
    jobs: JobsOption = None,
    ray: RayOption = False,
    ray_address: RayAddressOption = None,
) -> None:
    """Show the facts about a level: texts, numbers, digest, metrics and drawing; or a suite.

    The metrics are those of `brl.metrics` in Python. The ones that need the level to be solved are
    left out above 5,000 cells; with things that have a state, above 5,000 states. Digest and
    metrics are left out above 1,048,576 states times outcomes of an action; --cite has the digest.
    With --sight, `sight_cost` is by how much the best that one can expect who sees everything is
    more than that of one who observes only this, at least and at most.

    Several levels, folders and packs give a row with the metrics of each level; so do the levels
    of a suite with --split, --output or --format csv. Rows do not depend on --jobs. The exit
    status is 1 if a level has an error.

    Examples:

      babyrobot show final-maze

      babyrobot show final-maze --format json

      babyrobot show final-maze --cite

      babyrobot show shell-game --sight view --view-radius 1

      babyrobot show small-mazes

      babyrobot show final-maze frozen-lake

      babyrobot show classics --format csv
    """
    options = RowOptions(
        split, report_format, output, resume, force, keep_going, Workers(jobs, ray, ray_address)
    )
    if view_radius is not None and sight is None:
        fail("--view-radius is for --sight", "add --sight view")
    if sight is not None and citation:
        fail("--cite has no facts for --sight", "leave one of them out")
    if len(levels) == 1 and not options.want_rows:
        suite = None if levels[0] == str(STANDARD_INPUT) else suite_path(levels[0])
        if suite is not None:
            if sight is not None:
                fail("--sight is for levels", "add --split or --format csv: a row for each")
            _show_suite(suite, citation, report_format)
            return
    many = levels_for_rows(levels, options)
    seen = None if sight is None else sight_options(sight, view_radius)
    if many is None:
        _show_one(levels[0], citation, report_format, seen)
    elif citation:
        fail("--cite is for one level")
    else:
        _show_many(many, options, seen)


def _show_many(levels: Suite | list[Any], options: RowOptions, seen: dict[str, Any] | None) -> None:
    """Write the metrics of each level, and what a sight costs there."""
    from babyrobot_levels.agents.many import metrics_many

    names = ("path_length", "dead_ends", "loops", "best_return", "random_return", "difficulty")
    cost = () if seen is None else ("sight_cost",)
    columns = Columns(
        ("index", "name", "digest", *METRICS, *cost, "error"),
        (
            ("states", "states", str),
            *((name, name, number) for name in names),
            *((name, name, _between) for name in cost),
        ),
        "measuring",
    )
    write_rows(partial(metrics_many, max_states=MAX_SOLVED, seen=seen), levels, columns, options)


def _between(bounds: Sequence[float | str]) -> str:
    least, most = map(number, bounds)
    return least if least == most else f"{least} to {most}"


def _show_one(
    level: str, citation: bool, report_format: TableFormat, seen: dict[str, Any] | None
) -> None:
    """Write the facts about one level, and what a sight costs there."""
    loaded = load_level(level)
    if citation:
        cite(loaded, level, as_json=report_format is TableFormat.JSON)
        return
    from babyrobot_levels.analysis.previews import show as facts_of
    from babyrobot_levels.render.words.phrases import with_limit

    facts = facts_of(loaded)
    found = None if seen is None else sight_solution(loaded, **seen)
    if report_format is TableFormat.JSON:
        write_json(facts if found is None else facts | {"sight_cost": json_value(found.cost)})
        return
    texts = {name: printable(text) for name, text in facts.lines().items()}
    if found is not None:
        texts["sight_cost"] = with_limit(cost_text(found), None, loaded.max_steps)
    for name in UNLIMITED:
        if (facts["metrics"] or {}).get(name) is not None:
            texts[name] = with_limit(texts[name], None, loaded.max_steps)
    write(fact_lines(texts))
    if loaded.has_random_maze:
        note("the maze is random: see one with `babyrobot preview LEVEL --maze-seed N`")
    else:
        write("\n" + text_picture(loaded))


def _show_suite(path: Path, citation: bool, report_format: TableFormat) -> None:
    from babyrobot_levels.suites.suite import load_suite

    suite = load_suite(path)
    if citation:
        fail("a suite has no digest to cite", "cite its levels: `brl.load_suite(…)[0].digest`")
    texts = {
        name: getattr(suite.fields, name)
        for name in ("name", "title", "description", "author", "license", "source")
    }
    sizes = suite.split_sizes()
    facts: dict[str, Any] = {
        **texts,
        "tags": list(suite.fields.tags),
        "levels": len(suite),
        "splits": sizes,
        "largest": list(suite.largest),
        "max_steps": suite.max_steps,
    }
    if report_format is TableFormat.JSON:
        write_json(facts)
        return
    from babyrobot_levels.analysis.previews import text_of

    facts["splits"] = ", ".join(f"{name} {count:,}" for name, count in sizes.items())
    write(fact_lines({name: printable(text_of(value)) for name, value in facts.items()}))


def cite(level: Level, argument: str, *, as_json: bool) -> None:
    """Print what a paper needs to identify a level.

    Args:
        level: the level.
        argument: the argument that names it, which is `pack/name` for a level of a pack.
        as_json: whether to print it as JSON.
    """
    from babyrobot_levels.library.citation import citation, cited_name, pack_in

    if level.has_random_maze:
        fail(
            "the maze of this level is random, so it has no digest to cite",
            "cite a level with a fixed maze; `babyrobot resolve --maze-seed N` writes one",
        )
    if as_json:
        pack = pack_in(argument)
        write_json(
            {
                "name": cited_name(level, argument) if level.name is not None else None,
                "pack": None if pack is None else {"name": pack[0], "version": pack[1]},
                "babyrobot_levels": __version__,
                "language": level.version,
                "digest": level.digest,
            }
        )
        return
    write(f"{citation(level, argument)}\n")


class Order(StrEnum):
    """What levels are listed by."""

    NAME = "name"
    SIZE = "size"
    DIFFICULTY = "difficulty"


def list_levels(
    tag: Annotated[
        list[str] | None,
        typer.Option(
            metavar="TAG",
            help="Only levels with this tag; may be repeated, for levels with all of them.",
        ),
    ] = None,
    packs: Annotated[bool, typer.Option("--packs", help="List packs instead of levels.")] = False,
    suites: Annotated[
        bool, typer.Option("--suites", help="List suites instead of levels.")
    ] = False,
    extensions: Annotated[
        bool, typer.Option("--extensions", help="List extensions instead of levels.")
    ] = False,
    difficulty: Annotated[
        str | None,
        value_option(
            "A..B",
            "Only levels of this difficulty, as `babyrobot show` tells it: 3..5, ..4.  Solving "
            "the levels takes a while.",
        ),
    ] = None,
    sort: Annotated[
        Order | None, value_option("KEY", "Sort levels by name, size or difficulty.")
    ] = None,
    report_format: FormatOption = ReportFormat.TEXT,
) -> None:
    """List the levels that have names, the suites, the packs or the extensions.

    Levels are searched in levels/ of the current folder, in the folders of the environment
    variable BABYROBOT_LEVELS, in the gallery that comes with this package, in your own folder, and
    in packs, installed or part of Python packages. The first one of a name is used. gallery/NAME
    is always the gallery's.

    Examples:

      babyrobot list --tag maze

      babyrobot list --difficulty ..5 --sort difficulty

      babyrobot list --packs

      babyrobot list --suites
    """
    others = {"packs": packs, "suites": suites, "extensions": extensions}
    if other := next((name for name, given in others.items() if given), None):
        asked: dict[str, Any] = {"--tag": tag, "--difficulty": difficulty, "--sort": sort}
        asked |= {f"--{name}": given for name, given in others.items() if name != other}
        if what := next((name for name, given in asked.items() if given), None):
            fail(f"{what} cannot be combined with --{other}", f"leave out {what}")
        if other == "extensions":
            list_extensions(report_format)
            return
        (list_packs if packs else list_suites)(report_format)
        _note_all(unusable_packs())
        return
    infos, broken = catalogue()
    wanted = set(tag or ())
    unknown = wanted - (tags := {name for info in infos for name in info.tags})
    infos = [info for info in infos if wanted <= set(info.tags)]
    figures = {}
    if difficulty is not None or sort is Order.DIFFICULTY:
        figures = _difficulties(infos, difficulty)
        infos = [info for info in infos if info.name in figures]
    if sort is Order.SIZE:
        infos.sort(key=lambda info: info.size[0] * info.size[1])
    elif sort is Order.DIFFICULTY:
        infos.sort(key=lambda info: figures[info.name])
    if report_format is ReportFormat.JSON:
        more = {name: {"difficulty": figure} for name, figure in figures.items()}
        write_json([{**info.to_dict(), **more.get(info.name, {})} for info in infos])
    elif infos:
        _write_levels(infos, figures, grouped=sort is None)
    else:
        wishes = [f"the tag {name!r}" for name in tag or ()]
        guess = "".join(meant.tag(name, tags) for name in sorted(unknown))
        note(f"no level has {' and '.join(wishes) or f'a difficulty of {difficulty}'}{guess}")

    if report_format is ReportFormat.TEXT and not tag and sys.stdout.isatty():
        # Only for people: standard error of a pipeline is for errors.
        note("suites:" + hanging(", ".join(sorted(suite_files())), 8))
    _note_all(
        f"{path} is left out because of errors (see `babyrobot validate {quoted(path)}`)"
        for path in broken
    )
    _note_all(
        f"{PATH_VARIABLE} contains {folder}, which is not a readable folder"
        for folder in path_folders()
        if not folder.is_dir()
    )
    _note_all(unusable_packs())


def _note_all(problems: Iterable[str]) -> None:
    for problem in problems:
        note(one_line(problem))


def _difficulties(infos: Sequence[LevelInfo], wanted: str | None) -> dict[str, float]:
    """Return the difficulty of the levels that have one, in a range, by their names."""
    from babyrobot_levels.analysis.metrics import metrics

    bounds = ends(wanted or "")
    if wanted and not bounds:
        fail(f"--difficulty: {wanted!r} is no range", "expected one such as 3..5, ..4 or 6..")
    least, most = bounds.get("min", -math.inf), bounds.get("max", math.inf)
    found = {}
    for info in track(infos, len(infos), "measuring"):
        with suppress(LevelError):  # A random maze has none.
            measured = metrics(load_level(str(info.path)))
            figure = measured.difficulty if measured.states <= MAX_SOLVED else None
            if figure is not None and least <= figure <= most:
                found[info.name] = figure
    return found


def _write_levels(infos: list[LevelInfo], figures: Mapping[str, float], *, grouped: bool) -> None:
    """Write a row for each level; for people, by where levels are from, if that differs."""
    is_shown = width_of(sys.stdout) is not None and grouped
    if is_shown:
        infos = sorted(infos, key=attrgetter("origin"))
    origins = [one_line(info.origin) for info in infos]
    rows = [
        (
            info.name,
            f"{info.size[0]}x{info.size[1]}",
            *([short(figures[info.name])] if figures else []),
            one_line(info.title or ""),
            ", ".join(info.tags),
            *([] if is_shown else [origin]),
        )
        for info, origin in zip(infos, origins, strict=True)
    ]
    more, last = ["DIFFICULTY"] if figures else [], [] if is_shown else ["FROM"]
    heading = ("NAME", "SIZE", *more, "TITLE", "TAGS", *last)
    groups = origins if is_shown and len({*origins}) > 1 else ()
    write_table(heading, rows, ("TITLE", "TAGS", "SIZE"), groups)


@dataclass(frozen=True)
class _Row:
    """A pack, the packs of the same name that it hides, its `pack.yaml`, and its counts."""

    pack: KnownPack
    hides: Sequence[KnownPack]
    fields: PackFields | None
    levels: int
    suites: int

    def to_dict(self) -> dict[str, Any]:
        """Return the row as plain data."""
        texts = ("version", "description", "author", "license", "source")
        return {
            "name": self.pack.name,
            **{name: self.fields and getattr(self.fields, name) for name in texts},
            "levels": self.levels,
            "suites": self.suites,
            **_source(self.pack),
            "hides": [_source(hidden) for hidden in self.hides],
        }

    def cells(self) -> tuple[str, ...]:
        """Return the row as cells of the table."""
        version, description = (
            (self.fields.version, self.fields.description) if self.fields else ("", "")
        )
        counts = (str(self.levels), str(self.suites))
        cells = (self.pack.name, version or "-", *counts, self.pack.origin, description)
        return tuple(map(one_line, cells))


def list_packs(report_format: ReportFormat) -> None:
    """Write the packs, and note which of them are hidden by another one of the same name."""
    named: dict[str, list[KnownPack]] = {}
    for pack in known_packs():
        named.setdefault(pack.name, []).append(pack)
    rows = [_row(*named[name]) for name in sorted(named)]
    if report_format is ReportFormat.JSON:
        write_json([row.to_dict() for row in rows])
    elif rows:
        heading = ("NAME", "VERSION", "LEVELS", "SUITES", "FROM", "DESCRIPTION")
        write_table(heading, [row.cells() for row in rows], ("DESCRIPTION", "FROM"))
    else:
        note("no packs are installed (see `babyrobot install`)")
    for row in rows:
        for hidden in row.hides:
            name, front, behind = row.pack.name, row.pack.origin, hidden.origin
            note(one_line(f"{name} ({behind}) is hidden by {name} ({front})"))


def list_suites(report_format: ReportFormat) -> None:
    """Write the suites that have names."""
    from babyrobot_levels.suites.suite import load_suite

    rows: list[dict[str, Any]] = []
    for name, path in sorted(suite_files().items()):
        try:
            suite = load_suite(path)
        except LevelError:
            note(f"{path} has errors (see `babyrobot validate`)")
            continue
        rows.append(
            {"name": name, "levels": len(suite), "title": suite.fields.title, "path": str(path)}
        )
    if report_format is ReportFormat.JSON:
        write_json(rows)
    else:
        cells = [(row["name"], f"{row['levels']:,}", one_line(row["title"] or "")) for row in rows]
        write_table(("NAME", "LEVELS", "TITLE"), cells, ("TITLE",))


def list_extensions(report_format: ReportFormat) -> None:
    """Write the extensions that there are, and note what of them cannot be used."""
    # What the package has itself, which extensions cannot take.
    for place in ("envs.observations", "extensions.formats.formats"):
        with suppress(ModuleNotFoundError):
            import_module(f"babyrobot_levels.{place}")
    from babyrobot_levels.registry.entries import all_built_in, installed

    found = [*all_built_in(__version__), *installed()]
    if report_format is ReportFormat.JSON:
        write_json([each.to_dict() for each in found])
    else:
        cells = [
            (each.name, each.distribution, "; ".join(each.words()), each.summary) for each in found
        ]
        write_table(("NAME", "FROM", "ADDS", "DESCRIPTION"), cells, ("DESCRIPTION", "ADDS"))
    _note_all(f"extension {fault}" for each in installed() for fault in each.faults())


def _row(pack: KnownPack, *hides: KnownPack) -> _Row:
    suites: set[str] = set()
    levels: set[str] = set()
    for file in files_in(Place(pack.folder)):
        (suites if is_suite_file(file.path) else levels).add(file.name)
    return _Row(pack, hides, fields(pack.folder), len(levels), len(suites))


def _source(pack: KnownPack) -> dict[str, str]:
    return {"from": pack.origin, "folder": str(pack.folder)}
