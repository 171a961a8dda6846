"""`babyrobot play`: a level in the terminal, played with the arrow keys."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import closing, contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from babyrobot_levels.cli.console import fail, note, value_option, write
from babyrobot_levels.cli.inputs import LevelArgument, MazeSeedOption, load_level
from babyrobot_levels.cli.reporting import STANDARD_INPUT
from babyrobot_levels.extensions.play.commands.game import Game
from babyrobot_levels.extensions.play.commands.team import TeamGame
from babyrobot_levels.extensions.play.keyboard import NextKey, keyboard
from babyrobot_levels.render.terminal import moves_cursor, room_of

if TYPE_CHECKING:
    import os


PlayActions = Literal["all", "turns"]
"""The actions with which a level can be played."""


_HINT, _UNDO, _RESTART, _QUIT = ("h", "?"), ("u", "z"), "r", ("q", "\x04")
_ALL_SCREEN, _SCREEN_AS_IT_WAS = "\x1b[?1049h\x1b[?25l", "\x1b[?25h\x1b[?1049l"

_LOOK_AGAIN = 0.25
"""Seconds without a key after which the size of the window is checked."""


def play(
    level: LevelArgument,
    seed: Annotated[
        int | None, value_option("N", "Random seed: the same moves have the same results.", min=0)
    ] = None,
    maze_seed: MazeSeedOption = None,
    actions: Annotated[
        PlayActions,
        typer.Option(
            help="What the robot can do: move to all sides, or turn left, turn right and move "
            "forward."
        ),
    ] = "all",
    record: Annotated[
        Path | None,
        value_option(
            "FILE",
            "Append each episode to this file, for example ada.brlplay: see `babyrobot replay`.",
        ),
    ] = None,
) -> None:
    """Play a level in the terminal with the arrow keys.

    W, A, S and D move the robot, too. Space or a full stop lets it stay, h shows the best action, u
    takes a step back, r restarts, q quits. A robot that turns does so with the arrow keys left and
    right, and moves forward with up. The end tells the best average, that of an optimal policy.
    Several robots move at once: of two, the letters move the first, the arrow keys the second.

    Examples:

      babyrobot play final-maze

      babyrobot play frozen-lake --seed 7

      babyrobot play first-key --actions turns

      babyrobot play final-maze --record ada.brlplay
    """
    loaded = load_level(level)
    if level == str(STANDARD_INPUT) and moves_cursor(sys.stdout):
        _take_keys_from_the_terminal()
    if maze_seed is not None and not loaded.has_random_maze:
        fail("the level's maze is not random", "leave out --maze-seed")
    if sys.stdin is None or not (sys.stdin.isatty() and moves_cursor(sys.stdout)):
        fail("`babyrobot play` needs a terminal", "use `babyrobot preview` to look at a level")
    if loaded.robots and actions == "turns":
        fail("the robots of a team do not turn", "leave out --actions")
    kind = TeamGame if loaded.robots else Game
    game = kind(loaded, seed, maze_seed, record, turns=actions == "turns")
    # A closed terminal ends the game as q does. However it ends, its last episode is recorded.
    with closing(game), suppress(EOFError), _whole_screen(), keyboard() as next_key:
        _play(game, next_key)
    write(game.summary() + "\n")
    if record is not None:
        note(f"recorded in {record}")


def _take_keys_from_the_terminal() -> None:
    """Read keys from the terminal although standard input was the level."""
    # Without a terminal, the command then reports that it needs one.
    with suppress(OSError):
        terminal = Path("CONIN$" if sys.platform == "win32" else "/dev/tty")
        sys.stdin = terminal.open(encoding="utf-8")


def _play(game: Game, next_key: NextKey) -> None:
    """Show the game and act on keys, until one quits."""
    shown: tuple[int, os.terminal_size] | None = None
    while True:
        room = room_of(sys.stdout)
        if shown != (game.moment, room):
            shown = game.moment, room
            sys.stdout.write("\x1b[H" + "\x1b[K\r\n".join(game.screen(room)) + "\x1b[K\x1b[J")
            sys.stdout.flush()
        key = (next_key(_LOOK_AGAIN) or "").lower()
        if key in _QUIT:
            return
        if key == _RESTART:
            game.begin()
        elif key in _HINT:
            game.hint()
        elif key in _UNDO:
            game.undo()
        elif key in game.keys:
            game.act(game.keys[key])


@contextmanager
def _whole_screen() -> Iterator[None]:
    """Use the whole screen, and restore it at the end."""
    sys.stdout.write(_ALL_SCREEN)
    try:
        yield
    finally:
        # The terminal may be closed.
        with suppress(OSError):
            sys.stdout.write(_SCREEN_AS_IT_WAS)
            sys.stdout.flush()
