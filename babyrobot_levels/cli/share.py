"""`babyrobot share` and `babyrobot resolve`: levels as codes, links and maze-free files."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

from typer.core import TyperCommand

import babyrobot_levels as brl
from babyrobot_levels.analysis.sharing import fragment_of, link_fault
from babyrobot_levels.cli.console import (
    ForceOption,
    OutputOption,
    fail,
    flag,
    note,
    put,
    save,
    value_option,
    write,
)
from babyrobot_levels.cli.inputs import (
    LevelArgument,
    LevelsArgument,
    MazeSeedOption,
    SplitOption,
    folder_for,
    is_one_level,
    levels_named,
    load_level,
    names_of_files,
    valid_levels,
    with_seed,
)
from babyrobot_levels.cli.parallel import track, working
from babyrobot_levels.text.files import SUFFIXES
from babyrobot_levels.text.source import MAX_BYTES

WORTH_A_LOOK = 10_000
"""Mazes of fewer cells fit into a file, or are quickly found not to."""
SHORTEST_ENTRY = "  - {at: [0, 0], side: E}\n"
EXAMPLE = "for example --link https://example.org/play.html"


class ShareCommand(TyperCommand):
    """A command that explains the value of `--link` where it is missing."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Report a `--link` without a value."""
        for word, following in itertools.pairwise([*args, "-"]):
            if word == "--link" and following.startswith("-") | following.endswith(SUFFIXES):
                fail(
                    "--link needs BASE, the address of a page that plays levels",
                    "make the page with `babyrobot preview LEVEL -o play.html`, and give its "
                    f"address: {EXAMPLE}",
                )
        return super().parse_args(ctx, args)


def share(
    levels: LevelsArgument,
    link: Annotated[
        str | None,
        value_option(
            "BASE",
            "Print a link instead. BASE is the address of any page made by `babyrobot "
            "preview LEVEL -o page.html`: it plays the level of the link.",
        ),
    ] = None,
    output: Annotated[
        Path | None,
        value_option(
            "FILE",
            "Write a level file instead, for example from a share code; for several levels, "
            "to a folder.",
            "--output",
            "-o",
        ),
    ] = None,
    no_answers: Annotated[
        bool,
        flag(
            "--no-answers",
            "Leave the solution out of the link: no values, optimal actions and hints.",
        ),
    ] = False,
    split: SplitOption = None,
    force: ForceOption = False,
) -> None:
    """Print a level as a share code: one line that every command accepts as LEVEL.

    Of several levels, folders, packs and suites, each line is a name, a tab, and the code or link.

    A code contains the whole level except for comments. It has a checksum, so that a code that is
    cut off or mistyped is reported.

    A link opens a page that plays the level. BASE is the address of any page that `babyrobot
    preview LEVEL -o page.html` has made, on a web server or as a local file
    (`file:///…/page.html`).

    Examples:

      babyrobot share final-maze

      babyrobot share final-maze --link https://example.org/play.html

      babyrobot share final-maze --link https://example.org/play.html --no-answers

      babyrobot share brl1.24.R4BZv8Oakkoy8yqVkLIv0EYA -o tiny.yaml

      babyrobot share levels/
    """
    if link is not None and output is not None:
        fail("--link and --output cannot be combined", "leave out one of the two")
    if link is not None and (reason := link_fault(link)):
        fail(f"invalid --link {link!r}", f"{reason}: {EXAMPLE}")
    if no_answers and link is None:
        fail("--no-answers is for links", "add --link BASE, or leave out --no-answers")
    shown = _Shown(link, answers=not no_answers)
    if split is None and is_one_level(levels):
        level = load_level(levels[0])
        if output is None:
            write(f"{shown.of(level)}\n")
        else:
            _save(output, level, force=force)
        return
    folder = None if output is None else folder_for(output)
    chosen = levels_named(levels, split)
    if isinstance(chosen, list):
        chosen, _ = valid_levels(chosen, "codes were" if output is None else "files were")
    for name, level in names_of_files(track(map(brl.load, chosen), len(chosen), "sharing")):
        if folder is None:
            write(f"{name}\t{shown.of(level)}\n")
        else:
            _save(folder / f"{name}.yaml", level, force=force)


def _save(path: Path, level: brl.Level, *, force: bool) -> None:
    from babyrobot_levels.text.emitter import emit

    save(path, emit(level.to_dict(whole=True)), force=force)


@dataclass(frozen=True, slots=True)
class _Shown:
    """How levels are shared: as codes, or as links to a page."""

    page: str | None
    answers: bool

    def of(self, level: brl.Level) -> str:
        if self.page is None:
            return level.share_code()
        return f"{self.page}#{self._fragment(level)}"

    def _fragment(self, level: brl.Level) -> str:
        from babyrobot_levels.cli.pictures import check_page_size
        from babyrobot_levels.render.page_format import TooLargeError

        try:
            return fragment_of(level, answers=self.answers, tell=note)
        except TooLargeError as error:
            check_page_size(level, "send the level file")
            fail(
                str(error),
                "send the level file, or a page made by `babyrobot preview LEVEL -o page.html`",
            )


share.command_class = ShareCommand  # type: ignore[attr-defined]


def resolve(
    level: LevelArgument,
    maze_seed: MazeSeedOption = None,
    output: OutputOption = None,
    force: ForceOption = False,
) -> None:
    """Replace a level's maze by walls, so that they can be edited one by one.

    The fields `maze` and `openings` become `walls`; the level does not change otherwise, and keeps
    its comments.

    Examples:

      babyrobot resolve final-maze

      babyrobot resolve random-maze --maze-seed 7 -o seven.yaml
    """
    from babyrobot_levels.library.catalogue import text_for

    loaded = with_seed(load_level(level), maze_seed)
    if loaded.maze is None:
        note(f"{loaded.name or 'the level'} has no maze: nothing to resolve")
    _check_walls(loaded)
    with working("resolving"):
        resolved = loaded.resolve()
        text = resolved.to_yaml(comments=True)
    if output is not None:
        text = text_for(resolved, text, output)
    if len(text.encode("utf-8")) > MAX_BYTES:
        fail(
            "the walls of this maze do not fit into a level file", "a level file has at most 1 MiB"
        )
    put(text, output, force=force)


def _check_walls(level: brl.Level) -> None:
    """End the command if a maze has too many walls for a file, before they are all written."""
    if level.maze is None or level.map is not None or level.size[0] * level.size[1] < WORTH_A_LOOK:
        return
    import numpy as np

    from babyrobot_levels.mdp.grid import BIT

    width, height = level.size
    bits = np.frombuffer(bytes(level.grid().wall_bits), np.uint8).reshape(height, width)
    south, east = (bits[:-1] & BIT["S"]) > 0, (bits[:, :-1] & BIT["E"]) > 0
    # Walls in a line are one entry of the file.
    count = int(south[:, 0].sum() + (south[:, 1:] & ~south[:, :-1]).sum())
    count += int(east[0].sum() + (east[1:] & ~east[:-1]).sum())
    if count * len(SHORTEST_ENTRY) > MAX_BYTES:
        fail(
            f"this maze has {count:,} straight walls, too many for a level file",
            f"a level file has at most 1 MiB, room for some {MAX_BYTES // 35:,} walls",
        )
