"""`babyrobot score`: agents, and recorded episodes, beside the exact optimum of each level."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

import typer

import babyrobot_levels as brl
from babyrobot_levels.cli.agents import FITTING, PLAYS, blamed, named_agent
from babyrobot_levels.cli.console import (
    FINDINGS,
    ForceOption,
    TableFormat,
    TableOption,
    fact_lines,
    fail,
    flag,
    note,
    percent,
    quoted,
    save,
    short,
    value_option,
    write,
    write_json,
    write_table,
)
from babyrobot_levels.cli.inputs import SplitOption, levels_named
from babyrobot_levels.cli.parallel import working
from babyrobot_levels.cli.solve import ActionsOption
from babyrobot_levels.extensions.scoring.commands.replay import help_text
from babyrobot_levels.render.words.phrases import limited, name_of
from babyrobot_levels.text.source import printable
from babyrobot_levels.text.words import AGENTS, BEST, RANDOM

LONGEST, LONGEST_NAME = 300, 60
"""The most characters of a text and of a name of a player in a table."""

Rule = Literal["regret", "share", "success", "tries"]
"""By what points are given."""


Sight = Literal["map", "view", "words", "picture"]
"""What an agent sees that reads and writes."""


def score(
    what: Annotated[
        list[str],
        typer.Argument(
            metavar="AGENT LEVELS or PLAYS",
            help="An agent, and the levels, folders and packs, or the suite, to score it in; or "
            f"files of recorded episodes ({PLAYS}), with --level also folders and zip files of "
            f"them. An agent is {AGENTS}; `{BEST}` is an "
            "optimal policy without a time limit.",
        ),
    ],
    level: Annotated[
        str | None,
        value_option(
            "LEVEL",
            "Of recorded episodes: the level that was to be played, or the folder, the pack or the "
            "course of levels.",
        ),
    ] = None,
    points: Annotated[
        Rule | None,
        typer.Option(
            "--points",
            help="Of recorded episodes: by what the points of the best one in a level are given.  "
            "[default: regret]",
        ),
    ] = None,
    split: SplitOption = None,
    within: Annotated[
        int | None,
        value_option(
            "N", "Truncate episodes after N steps.  [default: each level's max_steps]", min=1
        ),
    ] = None,
    discount: Annotated[
        float | None,
        value_option("G", "Discount factor, above 0 and at most 1.  [default: each level's]"),
    ] = None,
    criterion: Annotated[
        Literal["return", "average"],
        typer.Option(
            help="What is compared: the expected return, or the average reward of a step in the "
            "long run, of agents without memory in levels that go on for ever."
        ),
    ] = "return",
    observation: Annotated[
        str,
        typer.Option(
            metavar="NAMES", help="What a model observes; several names with commas: a dict."
        ),
    ] = "position",
    actions: ActionsOption = "all",
    stochastic: Annotated[
        bool, flag("--stochastic", "Let a model sample, not take its likeliest action.")
    ] = False,
    episodes: Annotated[
        int | None,
        value_option(
            "N",
            "Play agents with memory, and those with --sight, N times in each level.  [default: "
            "1,000; 10 with --sight]",
            min=1,
        ),
    ] = None,
    sight: Annotated[
        Sight | None,
        typer.Option(
            help="The agent reads and writes, a function from texts to replies: what it sees."
        ),
    ] = None,
    chat: Annotated[
        bool, flag("--chat", "With --sight: the function gets all messages so far.")
    ] = False,
    knowable: Annotated[
        bool,
        flag(
            "--knowable",
            "Find the best that any agent can expect that observes what this one does, and the "
            "share of that: takes seconds for each level.",
        ),
    ] = False,
    knowable_suite: Annotated[
        bool,
        flag(
            "--knowable-suite",
            "Find the best that any agent can expect that is put into one of these levels, and not "
            "told into which.",
        ),
    ] = False,
    record: Annotated[
        Path | None,
        value_option("FILE", f"With --sight: append each episode to this file ({PLAYS})."),
    ] = None,
    trust: Annotated[
        bool,
        flag(
            "--trust",
            "Load models, although their files can run any code: only of authors whom you trust.",
        ),
    ] = False,
    table_format: TableOption = TableFormat.TEXT,
    output: Annotated[
        Path | None,
        value_option(
            "FILE",
            "Write to this file: .csv, .json; of an agent also a picture, .svg, .png.",
            "--output",
            "-o",
        ),
    ] = None,
    force: ForceOption = False,
) -> None:
    """Compare an agent, or recorded episodes, with the exact optimum of each level.

    The share is 0 for the random policy and 1 for an optimal one. Recorded episodes are verified;
    each player, whose folder or file it is, has a row for each level. With --level, plays of other
    levels or under other conditions do not count. The exit status is 1 if a play is not valid.

    Examples:

      babyrobot score random classics

      babyrobot score policy.npy frozen-lake -o scores.csv

      babyrobot score ppo.zip frozen-lake --observation vector --trust

      babyrobot score agents.py:east frozen-lake --sight map

      babyrobot score plays/*.brlplay --level frozen-lake

      babyrobot score class.zip --level robots -o plays.csv
    """
    are_plays = {word.lower().endswith(PLAYS) for word in what}
    if (level or points) and not any(_may_hold_plays(word) for word in what):
        if len(what) == 1 and not (what[0] in (BEST, RANDOM) or Path(what[0]).exists()):
            fail(f"there is no file or folder {what[0]}")
        fail(
            "--level and --points are for recorded episodes",
            f"give files that end in {PLAYS}; an agent: babyrobot score {quoted(what[0])} "
            + (quoted(level) if level else "LEVEL"),
        )
    if level is None and are_plays == {True, False}:
        fail(
            "files of recorded episodes cannot be mixed with agents and levels",
            "`--level LEVEL` names the level that was to be played",
        )
    if level is not None or are_plays == {True}:
        options = split, within, discount, episodes, sight, record
        if any(each is not None for each in options) or any(
            (stochastic, trust, chat, knowable, knowable_suite, criterion == "average")
        ):
            fail(
                "--split, --within, --discount, --stochastic, --trust, --episodes, --sight, "
                "--chat, --knowable, --knowable-suite, --record and --criterion are for agents",
                "leave them out: episodes are scored under the conditions under which they were "
                "played",
            )
        grades = _grades(what, level, points or "regret")
        _put_grades(grades, table_format, output, has_level=level is None, force=force)
        if not grades.are_valid:
            raise typer.Exit(FINDINGS)
        return
    if Path(what[0]).is_dir() and any(Path(what[0]).rglob(f"*{PLAYS}")):
        fail(f"{what[0]} is a folder of recorded episodes", "add --level LEVEL")
    if knowable and knowable_suite:
        fail("--knowable and --knowable-suite are two questions", "ask one of them")
    if len(what) < 2:
        with blamed(what[0]):
            named_agent(what[0], trust=trust)
        fail(
            "give an agent and at least one level, folder, pack or suite",
            f"for example: babyrobot score {quoted(what[0])} final-maze",
        )
    scores = _scores(
        what,
        trust=trust,
        split=split,
        within=within,
        discount=discount,
        observation=tuple(observation.split(",")) if "," in observation else observation,
        actions=str(actions),
        deterministic=not stochastic,
        episodes=episodes,
        sight=sight,
        chat=chat,
        knowable="suite" if knowable_suite else knowable,
        record=record,
        criterion=criterion,
    )
    if scores.notice is not None and sight is None:
        note(f"warning: {scores.notice}")
    _put(scores, table_format, output, force=force)


# -- agents --------------------------------------------------------------------------------


def _scores(what: list[str], *, trust: bool, **options: Any) -> brl.Scores:
    """Return the scores of an agent; end the command if there are none."""
    word, *names = what
    levels = levels_named(names)
    with working("scoring"), warnings.catch_warnings():
        # The command itself notes that episodes are few.
        warnings.filterwarnings("ignore", "of an agent with memory")
        try:
            with blamed(word, is_reader=options["sight"] is not None):
                return brl.score(levels, named_agent(word, trust=trust), **options)
        except (brl.UndefinedReturnError, brl.EpisodeTooLongError) as error:
            fail(str(error))
        except brl.BabyRobotError:
            raise
        except (TypeError, ValueError) as error:
            fail(str(error).partition("\n")[0], FITTING if word.endswith(".zip") else None)


def _put(scores: brl.Scores, kind: TableFormat, output: Path | None, *, force: bool) -> None:
    """Write the scores of an agent."""
    if output is not None:
        pictures = {".svg": scores.to_svg, ".png": scores.to_png}
        _save({".csv": scores.to_csv, ".json": scores.to_json, **pictures}, output, force=force)
    elif not _written(scores, kind):
        rows = [_score_cells(each) for each in scores]
        has_more = {
            "invalid": any(each.invalid for each in scores),
            "knowable": any(each.knowable is not None for each in scores),
        }
        has_more["of knowable"] = has_more["knowable"]
        heading = [name for name in rows[0] if has_more.get(name, True)]
        write_table(heading, [[row[name] for name in heading] for row in rows])
        write("\n" + fact_lines({**_summary(scores), **_pooled(scores), **_limits(scores)}))


def _written(found: brl.Scores | brl.Grades, kind: TableFormat) -> bool:
    """Write scores or grades for other programs; return whether they are for those."""
    if kind is TableFormat.CSV:
        write(found.to_csv())
    elif kind is TableFormat.JSON:
        write_json(found.to_dict())
    return kind is not TableFormat.TEXT


def _save(makers: Mapping[str, Callable[[], Any]], output: Path, *, force: bool) -> None:
    """Write a file in the format that its suffix names."""
    suffix = output.suffix.lower()
    if suffix not in makers:
        fail(f"unknown suffix {suffix or '(none)'}", f"use one of {', '.join(makers)}")
    save(output, makers[suffix](), force=force)


def _score_cells(row: brl.LevelScore) -> dict[str, str]:
    earned = short(row.expected_return)
    if row.episodes:
        earned += f" ({short(row.low)} to {short(row.high)})"
    return {
        "level": printable(row.level),
        "return": earned,
        "optimum": short(row.optimum),
        "random": short(row.random),
        "share": short(row.share),
        "success": percent(row.success),
        "steps": short(row.steps),
        "invalid": short(row.invalid),
        "knowable": short(row.knowable),
        "of knowable": short(row.knowable_share),
    }


def _pooled(scores: brl.Scores) -> dict[str, str]:
    """Return what can be known in one of the levels, if that was asked for."""
    found = scores.pooled
    if found is None:
        return {}
    rows = {"in one of them": found.expected_return, "knowable there": found.knowable}
    return {name: short(value) for name, value in rows.items()} | {
        "share of knowable": short(found.knowable_share)
    }


def _limits(scores: brl.Scores) -> dict[str, str]:
    """Return within how many steps returns are; of several levels, each may have its own."""
    if scores.criterion == "average":
        return {"return": "the average reward of a step in the long run"}
    limits = {row.within for row in scores}
    several = "within each level's max_steps"
    return {"returns": limited(limits.pop()) if len(limits) == 1 else several}


def _summary(scores: brl.Scores) -> dict[str, str]:
    """Return what several scores have in common; nothing for one."""
    if len(scores) < 2:
        return {}
    found = scores.summary

    def told(name: str, text: Callable[[float], str] = short) -> str:
        value, (low, high) = getattr(found, name), found.intervals[name]
        if math.isnan(high):
            return text(value)
        ends = f"at most {text(high)}" if math.isnan(low) else f"{text(low)} to {text(high)}"
        return f"{text(value)} ({ends})"

    rows = {
        "levels": f"{found.levels:,}",
        "mean share": told("mean"),
        "median": told("median"),
        "interquartile mean": told("iqm"),
        "worst tenth": told("worst_tenth"),
        "solved": told("solved", percent),
        "success": told("success", percent),
    }
    if scores.is_exact:
        return {**rows, "scores": "exact; 95 % intervals for levels like these"}
    return {
        **rows,
        "mean in these levels": f"{short(found.low)} to {short(found.high)}",
        "scores": "from episodes; 95 % intervals for levels like these",
    }


# -- recorded episodes ---------------------------------------------------------------------


def _may_hold_plays(word: str) -> bool:
    return Path(word).is_dir() or Path(word).suffix.lower() in (PLAYS, ".zip")


def _grades(files: list[str], level: str | None, rule: Rule) -> brl.Grades:
    """Return the grades of plays; end the command if the levels are not fit for that."""
    # What is wrong with a level, its errors tell.
    if level is not None and any(brl.load(each).has_random_maze for each in levels_named([level])):
        fail("the maze of this level is random", "give the level with its seed: a file, or a code")
    with working("verifying"):
        try:
            return brl.grade(files, level, points=rule, functions=[])
        except ValueError as error:
            fail(str(error))


def _put_grades(
    grades: brl.Grades, kind: TableFormat, output: Path | None, *, has_level: bool, force: bool
) -> None:
    """Write the grades of plays."""
    if output is not None:
        _save({".csv": grades.to_csv, ".json": grades.to_json}, output, force=force)
    elif not _written(grades, kind):
        _write_grades(grades, has_level=has_level)


def _write_grades(grades: brl.Grades, *, has_level: bool) -> None:
    """Write a table; the columns of help and notes are left out if they are empty."""
    rows = [_grade_cells(each) for each in grades]
    is_shown = {name: any(row[name] for row in rows) for name in ("help", "notes")}
    is_shown["level"] = has_level or len(grades.levels) > 1
    heading = [name for name in rows[0] if is_shown.get(name, True)]
    less = ("verified", "random", "success", "episodes")
    write_table(heading, [[row[name] for name in heading] for row in rows], less)


def _grade_cells(row: brl.Grade) -> dict[str, str]:
    more = f" + {row.unfinished}" if row.unfinished else ""
    verified = "yes" if row.episodes or row.unfinished else "-"
    return {
        "player": told(row.player),
        "level": told(row.level),
        "points": short(row.points),
        "episodes": f"{row.episodes}{more}",
        "best": short(row.best),
        "mean": short(row.mean),
        "optimum": short(row.optimum),
        "random": short(row.random),
        "share": short(row.share),
        "success": percent(row.success),
        "regret": short(row.regret),
        "luck": short(row.luck),
        "help": help_text(row),
        "notes": _notes(row),
        "verified": f"no: {told(row.fault, LONGEST)}" if row.fault else verified,
    }


def told(text: str, longest: int = LONGEST_NAME) -> str:
    """Return a text of a player, which may hold anything, for a table."""
    return name_of(text, longest)


def _notes(row: brl.Grade) -> str:
    """Return what else there is to know about the plays of a player."""
    notes = {
        "copies left out": row.copies,
        f"shared with {told(row.shared_with, LONGEST)}": row.shared,
        "without a seed": row.unseeded,
    }
    return "; ".join(f"{text}: {count:,}" for text, count in notes.items() if count)
