"""`babyrobot play`: a level in the terminal, played with the arrow keys."""

from __future__ import annotations

import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from babyrobot_levels.cli.console import fail, speaks_unicode, wants_color, write
from babyrobot_levels.cli.inputs import LevelArgument, MazeSeedOption, load_level
from babyrobot_levels.cli.reporting import STANDARD_INPUT
from babyrobot_levels.mdp.actions import Action
from babyrobot_levels.text.source import printable

if TYPE_CHECKING:
    import os

    from babyrobot_levels.cli.keyboard import NextKey
    from babyrobot_levels.library.level import Level

_ACTIONS = {
    **dict.fromkeys(("up", "w"), Action.NORTH),
    **dict.fromkeys(("right", "d"), Action.EAST),
    **dict.fromkeys(("down", "s"), Action.SOUTH),
    **dict.fromkeys(("left", "a"), Action.WEST),
    **dict.fromkeys((" ", "."), Action.STAY),
}
_RESTART, _QUIT = "r", ("q", "\x04")
_ALL_SCREEN, _SCREEN_AS_IT_WAS = "\x1b[?1049h\x1b[?25l", "\x1b[?25h\x1b[?1049l"
_Style = dict[str, Any]
_BOLD: _Style = {"bold": True}
_DIM: _Style = {"dim": True}
_WARNING: _Style = {"fg": "yellow"}
_GOOD: _Style = {"fg": "green", "bold": True}
_LOOK_AGAIN = 0.25
"""Seconds without a key after which the size of the window is checked."""


def play(
    level: LevelArgument,
    seed: Annotated[
        int | None,
        typer.Option(
            metavar="N",
            min=0,
            help="Random seed: the same moves have the same results.",
            show_default=False,
        ),
    ] = None,
    maze_seed: MazeSeedOption = None,
) -> None:
    """Play a level in the terminal with the arrow keys.

    W, A, S and D move the robot, too. Space or a full stop lets it stay, r restarts, q quits.

    Examples:

      babyrobot play final-maze

      babyrobot play frozen-lake --seed 7
    """
    from babyrobot_levels.cli.keyboard import keyboard
    from babyrobot_levels.render.terminal import moves_cursor

    loaded = load_level(level)
    if level == str(STANDARD_INPUT) and moves_cursor(sys.stdout):
        _take_keys_from_the_terminal()
    if maze_seed is not None and not loaded.has_random_maze:
        fail("the level's maze is not random", "leave out --maze-seed")
    if sys.stdin is None or not (sys.stdin.isatty() and moves_cursor(sys.stdout)):
        fail(
            "`babyrobot play` needs a terminal",
            "use `babyrobot preview` to look at a level",
        )
    game = _Game(loaded, seed, maze_seed)
    # A closed terminal ends the game as q does.
    with _ended_by_signals(), suppress(EOFError), _whole_screen(), keyboard() as next_key:
        _play(game, next_key)
    write(game.summary() + "\n")


def _take_keys_from_the_terminal() -> None:
    """Read keys from the terminal although standard input was the level."""
    # Without a terminal, the command then reports that it needs one.
    with suppress(OSError):
        terminal = Path("CONIN$" if sys.platform == "win32" else "/dev/tty")
        sys.stdin = terminal.open(encoding="utf-8")


def _play(game: _Game, next_key: NextKey) -> None:
    """Show the game and act on keys, until one quits."""
    from babyrobot_levels.render.terminal import room_of

    shown: tuple[int, os.terminal_size] | None = None
    while True:
        room = room_of(sys.stdout)
        if shown != (game.moment, room):
            shown = game.moment, room
            lines = game.screen(room)
            sys.stdout.write("\x1b[H" + "\x1b[K\r\n".join(lines) + "\x1b[K\x1b[J")
            sys.stdout.flush()
        key = (next_key(_LOOK_AGAIN) or "").lower()
        if key in _QUIT:
            return
        if key == _RESTART:
            game.begin()
        elif key in _ACTIONS:
            game.act(_ACTIONS[key])


class _Game:
    """The game: its state, and the screen that shows it.

    Attributes:
        moment: counts the changes of the screen.
    """

    def __init__(self, level: Level, seed: int | None, maze_seed: int | None) -> None:
        self._env = level.make(observation="index")
        self._options = {} if maze_seed is None else {"maze_seed": maze_seed}
        self._color, self._unicode = wants_color(sys.stdout), speaks_unicode(sys.stdout)
        self._name = printable(level.name or "level")
        self._title = printable(level.title or self._name)
        self._aim = "Find the exit." if level.exits else "This level has no exit."
        self._limit = f" of {level.max_steps}" if level.max_steps else ""
        self._level: Level | None = None
        self.moment = 0
        self.begin(seed)

    def begin(self, seed: int | None = None) -> None:
        """Begin an episode."""
        from babyrobot_levels.render.text import TextPainter

        self._state, info = self._env.reset(seed=seed, options=self._options)
        self._mask = info["action_mask"]
        maze = f"  maze {info['maze_seed']}" if "maze_seed" in info else ""
        self._heading = self._title + maze
        level = self._env.get_wrapper_attr("level")
        if level is not self._level:
            self._level, self._painter = level, TextPainter(level, plain=not self._unicode)
        self._exits = {y * level.size[0] + x for x, y in level.exits}
        self._steps, self._reward, self._return = 0, 0.0, 0.0
        self._end = ""
        self._say(self._aim, _DIM)

    def act(self, action: Action) -> None:
        """Take an action, if the episode is not over."""
        if self._end:
            return
        possible = self._mask[action]
        self._state, reward, over, late, info = self._env.step(action)
        self._reward = float(reward)
        self._mask = info["action_mask"]
        self._steps += 1
        self._return += self._reward
        if over:
            at_exit = self._state in self._exits
            self._end = "reached the exit" if at_exit else "ended"
            if at_exit:
                self._say("The exit! Well done.", _GOOD)
            else:
                self._say("The episode is over.", _WARNING)
        elif late:
            self._end = "ran out of steps"
            self._say("No steps left.", _WARNING)
        elif info["skidded"]:
            self._say("Whoops, the robot skids!", _WARNING)
        elif not possible:
            self._say(f"Bump! A wall in the {action.name.lower()}.", _WARNING)
        elif not info["target_reached"]:
            self._say("The glass throws the robot back.", _WARNING)
        else:
            self._say("")

    def summary(self) -> str:
        """Return the result in one line."""
        steps = "1 step" if self._steps == 1 else f"{self._steps} steps"
        return f"{self._name}: {self._end or 'stopped'} after {steps}, return {self._return:g}"

    def screen(self, room: os.terminal_size) -> list[str]:
        """Return the lines of the whole screen."""
        dot, arrows = (" · ", "←↑↓→") if self._unicode else (", ", "arrows")
        keys = ["r restarts", "q quits"]
        if not self._end:
            keys = [f"{arrows} or WASD move", "space stays", *keys]
        facts = [f"step {self._steps}{self._limit}", f"reward {self._reward:g}",
                 f"return {self._return:g}"]  # fmt: skip
        if len(dot.join(keys)) > room.columns - 2:
            keys = [*([] if self._end else [f"{arrows} move"]), "r restart", "q quits"]
        above = [self._styled(self._heading, _BOLD, room)]
        below = [
            self._styled("   ".join(facts), {}, room),
            self._styled(*self._message, room),
            self._styled(dot.join(keys), _DIM, room),
        ]
        size = type(room)((room.columns - 2, max(1, room.lines - len(above) - len(below))))
        picture = self._painter.lines(self._state, color=self._color, room=size)
        if len(picture) + len(above) + len(below) + 3 <= room.lines:
            # There is room for empty lines.
            above, below = [*above, ""], ["", *below[:2], "", *below[2:]]
        return [*above, *(" " + line for line in picture), *below][: room.lines]

    def _say(self, text: str, style: _Style | None = None) -> None:
        """Set the message about what has just happened."""
        self._message = text, style or {}
        self.moment += 1

    def _styled(self, text: str, style: _Style, room: os.terminal_size) -> str:
        """Return a line that fits, in a style if the terminal takes colour."""
        text = " " + text[: room.columns - 2]
        return typer.style(text, **style) if style and self._color and text.strip() else text


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


@contextmanager
def _ended_by_signals() -> Iterator[None]:
    """Let signals that end the process raise SystemExit, so that the terminal is restored."""

    def end(number: int, _: object) -> None:
        sys.exit(128 + number)

    names = ("SIGTERM", "SIGHUP")
    numbers = [getattr(signal, name) for name in names if hasattr(signal, name)]
    before = {number: signal.signal(number, end) for number in numbers}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
