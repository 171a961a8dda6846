"""`babyrobot replay`: verifies recorded episodes, shows them, and makes films of them."""

from __future__ import annotations

import math
from contextlib import suppress
from pathlib import Path
from typing import Annotated, Any

import typer

import babyrobot_levels as brl
from babyrobot_levels.cli.console import (
    FINDINGS,
    FormatOption,
    ReportFormat,
    fact_lines,
    fail,
    note,
    quoted,
    save,
    short,
    value_option,
    write,
    write_json,
    write_table,
)
from babyrobot_levels.cli.parallel import working
from babyrobot_levels.language.play import PlayError
from babyrobot_levels.mdp.actions import HEADINGS
from babyrobot_levels.text.files import SUFFIXES
from babyrobot_levels.text.source import printable

_LONGEST_SHOW = 12.0
"""The most seconds that showing an episode takes."""

_LONGEST_PAUSE = 0.25
"""The most seconds between two steps."""


def replay(
    file: Annotated[
        Path, typer.Argument(metavar="FILE", help="A file of recorded episodes (.brlplay).")
    ],
    episode: Annotated[
        int | None, value_option("N", "Only this episode, counted from 1.  [default: all]", min=1)
    ] = None,
    output: Annotated[
        Path | None,
        value_option("FILM", "Write the episode to this file, an animated GIF.", "--output", "-o"),
    ] = None,
    report_format: FormatOption = ReportFormat.TEXT,
) -> None:
    """Verify recorded episodes by the tables of their level, and show them.

    An episode is valid if its level has the digest that it tells, each outcome is possible and, if
    it has a seed, drawn by this seed, the rewards add up to the return, and the end is the one
    told. Decisions cost what their actions lose against the best ones by expected returns, and luck
    is what chance added to that. On a terminal, a single episode is shown step by step. The exit
    status is 1 if an episode is not valid.

    Examples:

      babyrobot replay ada.brlplay

      babyrobot replay ada.brlplay --episode 2 -o ada.gif
    """
    from babyrobot_levels.agents.verify import verify_play

    plays = _read(file)
    if episode is not None and episode > len(plays):
        fail(f"--episode {episode}: the file has {len(plays):,} episodes")
    first = 1 if episode is None else episode
    chosen = plays if episode is None else [plays[episode - 1]]
    if output is not None and len(chosen) > 1:
        fail(f"the file has {len(plays):,} episodes", "choose one for the film: --episode N")
    if output is not None and output.suffix.lower() != ".gif":
        fail(f"a film is an animated GIF, and not {output.suffix or 'a file without suffix'}")
    found, rows = [], []
    with working("verifying") as report:
        for done, play in enumerate(chosen):
            found.append(verify_play(play))
            rows.append(_data(first + done, found[-1]))
            report(done + 1, len(chosen))
    if report_format is ReportFormat.JSON:
        write_json({"file": str(file), "plays": rows})
    elif len(found) == 1:
        if found[0].is_valid and output is None:
            _show(found[0].play)
        write(fact_lines(_facts(rows[0], found[0].play)))
    else:
        write_table(list(_COLUMNS), [_cells(row) for row in rows], less=("verified",))
    if output is not None and found[0].is_valid:
        _save_film(found[0], output)
    if not all(each.is_valid for each in found):
        raise typer.Exit(FINDINGS)


def _read(file: Path) -> list[brl.Play]:
    """Return the plays of a file; end the command if it cannot be read."""
    if file.suffix in SUFFIXES:
        fail(f"{file} is a level, and no play", f"to play it: babyrobot play {quoted(file)}")
    try:
        return brl.read_plays(file)
    except OSError as error:
        is_name = not file.suffix and not file.is_dir()
        help_text = f"to play a level: babyrobot play {quoted(file)}" * is_name
        is_missing = isinstance(error, PlayError)
        fail(f"{error}" if is_missing else f"{file} cannot be read ({error.strerror})", help_text)
    except PlayError as error:
        note(f"error: {error}")
        raise typer.Exit(FINDINGS) from None


# -- what is told --------------------------------------------------------------------------


def _data(number: int, verification: brl.Verification) -> dict[str, Any]:
    """Return what is known about a play, for JSON: null where it is not known."""
    from babyrobot_levels.extensions.scoring.play_grades import bounds_of

    play = verification.play
    data: dict[str, Any] = {
        "episode": number,
        "name": play.name,
        "digest": play.digest,
        "actions": play.action_set,
        "seed": play.seed,
        "steps": play.steps,
        "return": play.return_,
        "discount": play.discount,
        "max_steps": play.max_steps,
        "end": play.end,
        "hints": play.hints,
        "undone": play.undone,
        "watched": play.watched,
        "valid": verification.is_valid,
        "fault": verification.fault,
    }
    if not verification.is_valid:
        return data
    bounds = bounds_of(play)
    return {
        **data,
        "optimum": _finite(bounds.optimum),
        "random": _finite(bounds.random),
        "share": None if play.end == "unfinished" else _finite(bounds.share(play.return_)),
        "log_probability": verification.log_probability,
        "regret": _finite(verification.regret),
        "luck": _finite(verification.luck),
        "chance": verification.chance,
        "expected_return": verification.expected_return,
    }


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _facts(row: dict[str, Any], play: brl.Play) -> dict[str, str]:
    """Return what is told about one play."""
    steps = "1 step" if play.steps == 1 else f"{play.steps:,} steps"
    limit = f" of {play.max_steps:,}" if play.max_steps is not None else ""
    facts = {
        "level": printable(play.name or play.digest),
        "episode": f"{play.end} after {steps}{limit}",
        "return": f"{play.return_:.6g}" + _discounted(play),
        "seed": play.seed or "",
        "help": help_text(play),
    }
    if row["fault"] is not None:
        return {**facts, "verified": f"no: {printable(row['fault'])}"}
    share = "" if row["share"] is None else f", share {row['share']:.4g}"
    optimum, chance, expected = row["optimum"], row["random"], row["expected_return"]
    is_known = optimum is not None and chance is not None
    return {
        **facts,
        "optimum": f"{optimum:.6g} (random policy {chance:.6g}{share})" if is_known else "",
        "expected": "" if expected is None else f"{expected:.6g} with the same actions",
        "decisions": f"cost {row['regret']:.4g}" if row["regret"] is not None else "",
        "luck": f"{row['luck']:+.4g}" if row["luck"] is not None else "",
        "chance": _chance(row["chance"]),
        "verified": "yes",
    }


def help_text(row: brl.Play | brl.Grade) -> str:
    """Return what helped a player, as the game tells; the empty text for nothing."""
    counts = {"hints": row.hints, "undone": row.undone, "watched": row.watched}
    return ", ".join(f"{count} {name}" for name, count in counts.items() if count)


def _discounted(play: brl.Play) -> str:
    return f" (discount {play.discount:g})" if play.discount < 1 else ""


def _chance(chance: float | None) -> str:
    if chance is None:
        return "not computed: too many returns are possible"
    return f"{100 * chance:.3g} % of episodes with the same actions return this or more"


_COLUMNS = (
    *("episode", "level", "end", "steps", "return", "optimum", "share", "regret", "luck"),
    "verified",
)


def _cells(row: dict[str, Any]) -> list[str]:
    """Return the row of a play in the table."""
    return [
        str(row["episode"]),
        printable(row["name"] or row["digest"][:15]),
        row["end"],
        str(row["steps"]),
        f"{row['return']:.6g}",
        short(row.get("optimum")),
        short(row.get("share")),
        short(row.get("regret")),
        short(row.get("luck")),
        "yes" if row["valid"] else f"no: {printable(row['fault'])}",
    ]


# -- what is shown -------------------------------------------------------------------------


def _show(play: brl.Play) -> None:
    """Show an episode on a terminal, step by step; Ctrl-C ends that."""
    from babyrobot_levels.render.terminal import Terminal
    from babyrobot_levels.render.text import TextPainter

    terminal = Terminal()
    room = terminal.room
    if room is None:
        return
    painter = TextPainter(play.level, plain=not terminal.takes_unicode)
    turns = play.action_set == "turns"
    cells = play.level.compile().cells
    size = type(room)((room.columns, max(1, room.lines - 1)))
    pause = min(_LONGEST_PAUSE, _LONGEST_SHOW / len(play.states))
    total, factor = 0.0, 1.0
    with suppress(KeyboardInterrupt):
        for number, state in enumerate(play.states):
            if number:
                total += factor * play.rewards[number - 1]
                factor *= play.discount
            configuration, place = divmod(state, (HEADINGS if turns else 1) * cells)
            picture = painter.lines(
                configuration * cells + place % cells,
                heading=place // cells if turns else None,
                colors=terminal.colors,
                held=False,
                room=size,
            )
            terminal.show([*picture, f"step {number}   return {total:g}"], pause)
    write("\n")


def _save_film(verification: brl.Verification, path: Path) -> None:
    with working("drawing") as report:
        try:
            film = verification.to_gif(progress=report)
        except ValueError as error:
            fail(str(error))
    save(path, film)
