"""`babyrobot preview`: a level in the terminal, as a picture, as a GIF, or as a page to play."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Annotated, Any, Literal, TypeVar, get_args

import typer
from typer.core import TyperCommand

import babyrobot_levels as brl
from babyrobot_levels.analysis.guides import lost_of
from babyrobot_levels.analysis.picture_formats import (
    FORMATS,
    SUFFIXES,
    TEXT,
    PictureFormat,
    format_for,
    titles_of,
)
from babyrobot_levels.analysis.pictures import MAX_SCALE, dressed
from babyrobot_levels.cli.agents import PLAYS, blamed, named_agent, table_of
from babyrobot_levels.cli.console import (
    OutputOption,
    each_change,
    fail,
    flag,
    not_one_of,
    note,
    put,
    value_option,
    width_of,
    write,
)
from babyrobot_levels.cli.inputs import (
    LevelsArgument,
    SightOption,
    SplitOption,
    ViewRadiusOption,
    configuration_of,
    file_of,
    folder_for,
    is_folder,
    is_one_level,
    levels_named,
    load_level,
    names_levels,
    names_of_files,
    sight_options,
    valid_levels,
)
from babyrobot_levels.cli.parallel import Report, track, working
from babyrobot_levels.cli.pictures import (
    PolicyName,
    check_policy,
    format_by_suffix,
    picture,
    solution_of,
    solution_text,
    takes_pictures,
    text_picture,
)
from babyrobot_levels.render.text import WIDEST
from babyrobot_levels.text.errors import BabyRobotError, LevelError
from babyrobot_levels.text.source import printable
from babyrobot_levels.text.words import AGENTS, listed

Item = TypeVar("Item")

_PLAYED = listed(titles_of("seed"))


def _picture_format(word: str) -> str:
    return word if word in FORMATS else not_one_of(word, FORMATS)


MoveSet = Literal["all", "moves"]
"""The sets of actions of robots that do not turn."""


class PreviewCommand(TyperCommand):
    """A command whose option `--policy` may be given without a value, which means `best`."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Add the value that `--policy` may be given without."""
        whole: list[str] = []
        for index, word in enumerate(args):
            whole.append(word)
            following = args[index + 1] if index + 1 < len(args) else ""
            if word == "--policy" and following not in get_args(PolicyName):
                whole.append("best")
        # A word after `--policy` that is no policy is a level, or a mistake.
        after = {args[index + 1] for index in range(len(args) - 1) if args[index] == "--policy"}
        extra = super().parse_args(ctx, whole)
        levels = ctx.params.get("levels") or []
        for word in sorted(after & {*levels} - {*get_args(PolicyName)}):
            if len(levels) > 1 and not names_levels(word):
                fail(
                    f"invalid --policy {word!r}",
                    f"expected one of {', '.join(get_args(PolicyName))}; an agent: --agent {word}",
                )
        return extra


def preview(
    levels: LevelsArgument,
    picture_format: Annotated[
        str | None,
        value_option(
            f"<{'|'.join(FORMATS.own)}>",
            "Output format; `text` is drawn with lines and colours on a terminal, and is "
            "`ascii` elsewhere.  [default: by the suffix of the file, else text]",
            "--format",
            parser=_picture_format,
        ),
    ] = None,
    output: OutputOption = None,
    theme: Annotated[str | None, value_option("THEME", "Use this theme.")] = None,
    coordinates: Annotated[
        bool, flag("--coordinates", "Show the coordinates of each cell.")
    ] = False,
    values: Annotated[bool, flag("--values", "Show the optimal value of each cell.")] = False,
    visits: Annotated[
        bool, flag("--visits", "Show how often an optimal policy visits each cell, on average.")
    ] = False,
    policy: Annotated[
        PolicyName | None,
        value_option(
            "[best|random]",
            f"Show an optimal policy; in a {_PLAYED} page, the policy to follow.  "
            f"[default for {_PLAYED}: best]",
        ),
    ] = None,
    agent: Annotated[
        str | None,
        value_option(
            "FILE",
            f"Show the policy of this agent, in a page beside the optimum: {AGENTS}, or recorded "
            f"episodes ({PLAYS}).",
        ),
    ] = None,
    observation: Annotated[
        str, typer.Option(metavar="NAMES", help="What an agent that is a model observes.")
    ] = "position",
    actions: Annotated[
        MoveSet,
        typer.Option(help="The actions of the agent: stay and the four moves; or the moves."),
    ] = "all",
    trust: Annotated[
        bool,
        flag(
            "--trust",
            "Load a model, although its file can run any code: only of authors whom you trust.",
        ),
    ] = False,
    rules: Annotated[
        bool,
        flag(
            "--rules",
            "Show the rules of the level in words, all of them; pages and drawings in the "
            "terminal have them in any case, the first 20.",
        ),
    ] = False,
    held: Annotated[
        str | None,
        value_option(
            "NAMES",
            "Show the level while exactly these things are held or on, separated by "
            "commas; `nothing` for none.  [default: the level as a whole; values and policy where "
            "episodes begin]",
        ),
    ] = None,
    lost: Annotated[
        bool, flag("--lost", "Cross the cells from which a box can be pushed to no target.")
    ] = False,
    seed: Annotated[
        int | None,
        value_option(
            "N",
            f"Random seed for {_PLAYED} output, as in `env.reset(seed=N)`.  [default: 0]",
            min=0,
        ),
    ] = None,
    no_answers: Annotated[
        bool,
        flag(
            "--no-answers",
            "Leave the solution out of an HTML page: no values, optimal actions and hints, "
            "and no algorithms that learn it.",
        ),
    ] = False,
    learn: Annotated[
        bool,
        flag("--learn", "Let algorithms learn the level on an HTML page without answers, too."),
    ] = False,
    sight: SightOption = None,
    view_radius: ViewRadiusOption = None,
    scale: Annotated[
        float | None, value_option("X", "Size of pictures and GIFs; 1 is 64 pixels per cell.")
    ] = None,
    cell: Annotated[
        int | None, value_option("N", "Size of pictures and GIFs in pixels per cell.")
    ] = None,
    maze_seed: Annotated[
        int | None,
        value_option("N", "Seed for the maze of a level with a random maze.  [default: 0]"),
    ] = None,
    split: SplitOption = None,
    watch: Annotated[bool, flag("--watch", "Repeat whenever the level is saved.")] = False,
) -> None:
    """Draw levels in the terminal, or save them as pictures, animated GIFs or web pages.

    The suffix of FILE chooses the format. An HTML page can be played in any browser. Pictures and
    pages are overwritten. With --sight, a page shows only what the robot observes, and what it saw
    before; the best agent that sees no more can be watched.

    Several levels, folders and packs are drawn one below the other. With -o FOLDER, a picture of
    each is written there, also of the levels of a suite: SVG files unless --format says otherwise.
    Pages lead from one level to the next.

    Examples:

      babyrobot preview final-maze

      babyrobot preview levels/first.yaml -o first.png

      babyrobot preview levels/first.yaml --watch

      babyrobot preview frozen-lake --values --policy -o answers.svg

      babyrobot preview treasure-chests --rules -o hand-out.png

      babyrobot preview first-key --values --held key -o with-key.svg

      babyrobot preview first-box --lost

      babyrobot preview final-maze --visits -o visits.png

      babyrobot preview final-maze --policy best --seed 3 -o walk.gif

      babyrobot preview final-maze -o play.html

      babyrobot preview final-maze --no-answers -o homework.html

      babyrobot preview frozen-lake --agent policy.npy -o agent.html

      babyrobot preview shell-game --sight view --view-radius 1 -o fog.html

      babyrobot preview levels/ -o pictures/

      babyrobot preview final-maze frozen-lake --values --format png -o pictures/
    """
    has_folder = output is not None and (output.is_dir() if picture_format else is_folder(output))
    one = split is None and is_one_level(levels) and not has_folder
    chosen = _chosen_format(picture_format, output if one else None, folder=output)
    is_text = chosen.kind == TEXT
    _check_for("seed", chosen, given=seed is not None)
    if held is not None and "held" not in chosen.options:
        kinds = dict.fromkeys(each.kind for each in FORMATS.own.values() if "held" in each.options)
        shown = listed([kind if kind == TEXT else f"{kind}s" for kind in kinds])
        fail(f"--held is for {shown}", "leave out --held")
    _check_for("answers", chosen, given=no_answers, name="--no-answers")
    _check_for("learn", chosen, given=learn)
    _check_for("sight", chosen, given=sight is not None)
    if view_radius is not None and sight is None:
        fail("--view-radius is for --sight", "add --sight view")
    _check_for("visits", chosen, given=visits)
    _check_for("lost", chosen, given=lost)
    if no_answers and (values or policy == "best"):
        fail("--no-answers cannot be combined with --values and --policy best", "leave them out")
    if agent is not None and (is_text or policy is not None):
        fail(
            "--agent is for pictures, films and pages"
            if is_text
            else "--agent and --policy cannot be combined",
            "add -o FILE.html" if is_text else "leave out one of the two",
        )
    with blamed(agent or ""):
        given = None if agent is None else named_agent(agent, trust=trust, plays=True)
    times = _scale(scale, cell, chosen)
    if watch and not one:
        fail("--watch is for one level")
    if watch and output is None and not is_text:
        fail("--watch needs a file to write to", "add -o FILE")
    if not one and output is None and not is_text:
        fail("several pictures need a folder", "add -o FOLDER")
    if is_text and coordinates:
        note("--coordinates has no effect on text output")
    asked = {
        "values": values,
        "visits": visits,
        "policy": policy,
        "seed": seed or 0,
        "scale": times,
        "held": held,
        "lost": lost,
        "answers": not no_answers,
        "learn": learn or None,
        **({} if sight is None else sight_options(sight, view_radius)),
        "rules": rules,
    }
    plain = chosen.name == "ascii" or output is not None

    def drawn(level: brl.Level, report: Report, **pages: str | None) -> str | bytes:
        shown = _prepared(level, theme, coordinates, maze_seed, several=not one)
        if lost and one and not shown.boxes:
            fail("the level has no boxes", "leave out --lost")
        if is_text:
            check_policy(chosen, policy)
            return _text(shown, asked, plain=plain)
        if agent is None:
            return picture(shown, chosen.name, asked | pages, report)
        with blamed(agent):
            table = table_of(given, shown, observation=observation, actions=actions)
        return picture(shown, chosen.name, {**asked, **pages, "policy": table}, report)

    def made() -> str | bytes:
        with working("drawing") as report:
            return drawn(load_level(levels[0]), report)

    if not one:
        _put_all(levels_named(levels, split), drawn, chosen, output)
        return
    for result in _each_time(made, file_of(levels[0])) if watch else [made()]:
        put(result, output, chosen.title)


def _put_all(
    levels: brl.Suite | list[Any],
    drawn: Callable[..., str | bytes],
    chosen: PictureFormat,
    output: Path | None,
) -> None:
    """Write the pictures of several levels, to files in a folder or one below the other."""
    if output is None and not isinstance(levels, list):
        fail(f"this is a suite of {len(levels):,} levels", "write their pictures: add -o FOLDER")
    if isinstance(levels, list):
        levels, _ = valid_levels(levels, "pictures were")
    folder = None if output is None else folder_for(output)
    loaded = track(map(brl.load, levels), len(levels), "drawing")
    named = ((f"{name}{chosen.suffixes[0]}", level) for name, level in names_of_files(loaded))
    for before, (file, level), after in _with_neighbours(named):
        pages = {"previous_page": before and before[0], "next_page": after and after[0]}
        result = drawn(level, lambda done, total: None, **pages)
        if folder is None:
            write(("\n" if before else "") + f"{printable(level.name or Path(file).stem)}\n\n")
        put(result, folder and folder / file, chosen.title)


def _with_neighbours(items: Iterator[Item]) -> Iterator[tuple[Item | None, Item, Item | None]]:
    """Yield each item between the one before and the one after it; None where there is none."""
    before, here = None, next(items, None)
    while here is not None:
        after = next(items, None)
        yield before, here, after
        before, here = here, after


def _each_time(made: Callable[[], str | bytes], file: Path) -> Iterator[str | bytes]:
    """Yield a picture whenever a level is saved; of a level with errors, these are shown."""
    for _ in each_change(lambda: [file]):
        try:
            yield made()
        except LevelError as error:
            note(error.shown(width_of(sys.stderr)))
        except BabyRobotError as error:
            note(f"error: {error}")
        except typer.Exit:
            # The reason has been shown.
            continue


def _check_for(option: str, chosen: PictureFormat, *, given: bool, name: str = "") -> None:
    """Refuse an option that the format does not have."""
    name = name or f"--{option}"
    if given and option not in chosen.options:
        fail(f"{name} is for {listed(titles_of(option))} output", f"leave out {name}")


def _chosen_format(asked: str | None, output: Path | None, folder: Path | None) -> PictureFormat:
    if asked is not None:
        meant = SUFFIXES.get(output.suffix.lower()) if output else None
        if meant not in (None, asked) and {meant, asked}.isdisjoint(("text", "ascii")):
            fail(f"{output} is no file of the format {asked}", "leave out --format")
        return FORMATS[asked]
    if output is None:
        return FORMATS["text" if folder is None else "svg"]
    return FORMATS[format_for(output.suffix.lower()) or format_by_suffix(output, SUFFIXES)]


def _scale(scale: float | None, cell: int | None, chosen: PictureFormat) -> float | None:
    """Return the scale of a picture, None for the default."""
    from babyrobot_levels.render.scene.layout import CELL

    if scale is None and cell is None:
        return None
    if scale is not None and cell is not None:
        fail("--scale and --cell cannot be combined", "leave out one of the two")
    if "scale" not in chosen.options:
        fail(f"--scale and --cell are for {listed(titles_of('scale'))} output", "leave them out")
    times = scale if scale is not None else (cell or 0) / CELL
    if not 0 < times <= MAX_SCALE:
        fail(
            f"--scale must be above 0 and at most {MAX_SCALE:g}"
            if cell is None
            else f"--cell must be 1 to {MAX_SCALE * CELL:g} pixels"
        )
    return times


def _prepared(
    level: brl.Level,
    theme: str | None,
    coordinates: bool,
    maze_seed: int | None,
    *,
    several: bool = False,
) -> brl.Level:
    """Return the level with the theme, coordinates and maze that are asked for.

    The seed is for the random mazes among several levels.
    """
    try:
        level = dressed(level, theme=theme, coordinates=coordinates or None)
    except LevelError as error:
        found = error.diagnostics[0]
        fail(found.message, found.help)
    if level.has_random_maze:
        if maze_seed is None:
            note("the maze is random: this is the one of seed 0 (see --maze-seed)")
        level = level.with_maze_seed(maze_seed or 0)
    elif maze_seed is not None and not several:
        fail("the level's maze is not random", "leave out --maze-seed")
    return level


def _text(level: brl.Level, asked: Mapping[str, Any], *, plain: bool) -> str:
    """Return a level for the terminal, by what is asked of all pictures."""
    values, policy, held = asked["values"], asked["policy"] is not None, asked["held"]
    options = {
        "plain": plain or not takes_pictures(),
        "configuration": None if held is None else configuration_of(level, held),
        "lost": lost_of(level) if asked["lost"] else frozenset(),
        "all_rules": asked["rules"],
    }
    if not (values or policy):
        return text_picture(level, **options)
    if values and options["plain"] and level.size[0] > WIDEST:
        note(f"values are shown for up to {WIDEST} columns; save a picture with -o FILE.svg")
    return solution_text(level, solution_of(level), values=values, policy=policy, **options)


preview.command_class = PreviewCommand  # type: ignore[attr-defined]
