"""`babyrobot play`: a level in the terminal, played with the arrow keys."""

from __future__ import annotations

import codecs
import re
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import closing, contextmanager, suppress
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from babyrobot_levels.cli.console import fail, note, speaks_unicode, value_option, write
from babyrobot_levels.cli.inputs import LevelArgument, MazeSeedOption, load_level
from babyrobot_levels.cli.reporting import STANDARD_INPUT
from babyrobot_levels.mdp.actions import Action, Turn
from babyrobot_levels.render.terminal import colors_of
from babyrobot_levels.text.source import printable

if TYPE_CHECKING:
    import os

    from babyrobot_levels.library.level import Level
    from babyrobot_levels.mdp.configurations import Configuration


class PlayActions(StrEnum):
    """The actions with which a level can be played."""

    ALL = "all"
    TURNS = "turns"


_MOVES = {
    **dict.fromkeys(("up", "w"), Action.NORTH),
    **dict.fromkeys(("right", "d"), Action.EAST),
    **dict.fromkeys(("down", "s"), Action.SOUTH),
    **dict.fromkeys(("left", "a"), Action.WEST),
    **dict.fromkeys((" ", "."), Action.STAY),
}
_TURNS = {
    **dict.fromkeys(("left", "a"), Turn.LEFT),
    **dict.fromkeys(("right", "d"), Turn.RIGHT),
    **dict.fromkeys(("up", "w"), Turn.FORWARD),
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
        int | None, value_option("N", "Random seed: the same moves have the same results.", min=0)
    ] = None,
    maze_seed: MazeSeedOption = None,
    actions: Annotated[
        PlayActions,
        typer.Option(
            help="What the robot can do: move to all sides, or turn left, turn right and move "
            "forward.",
        ),
    ] = PlayActions.ALL,
    record: Annotated[
        Path | None,
        value_option(
            "FILE",
            "Append each episode to this file, for example ada.brlplay: see `babyrobot replay`.",
        ),
    ] = None,
) -> None:
    """Play a level in the terminal with the arrow keys.

    W, A, S and D move the robot, too. Space or a full stop lets it stay, r restarts, q quits. A
    robot that turns does so with the arrow keys left and right, and moves forward with up.

    Examples:

      babyrobot play final-maze

      babyrobot play frozen-lake --seed 7

      babyrobot play first-key --actions turns

      babyrobot play final-maze --record ada.brlplay
    """
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
    game = _Game(loaded, seed, maze_seed, record, turns=actions is PlayActions.TURNS)
    # A closed terminal ends the game as q does. However it ends, its last episode is recorded.
    with (
        closing(game),
        suppress(EOFError),
        _whole_screen(),
        keyboard() as next_key,
    ):
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
        elif key in game.keys:
            game.act(game.keys[key])


class _Game:
    """The game: its state, and the screen that shows it.

    Attributes:
        keys: the actions of the keys, as the environment numbers them.
        moment: counts the changes of the screen.
    """

    def __init__(
        self,
        level: Level,
        seed: int | None,
        maze_seed: int | None,
        record: Path | None,
        *,
        turns: bool,
    ) -> None:
        self._turns = turns
        self.keys: dict[str, int] = {**(_TURNS if turns else _MOVES)}
        self._env = level.make(observation="index", actions="turns" if turns else "valid")
        if record is not None:
            self._env = _recorded(self._env, record)
        self._options = {} if maze_seed is None else {"maze_seed": maze_seed}
        self._colors, self._unicode = colors_of(sys.stdout), speaks_unicode(sys.stdout)
        self._name = printable(level.name or "level")
        self._title = printable(level.title or self._name)
        self._aim = "Find the exit." if level.exits else "This level has no exit."
        self._limit = f" of {level.max_steps}" if level.max_steps else ""
        self.moment = 0
        self._use(self._env.get_wrapper_attr("level"))
        self.begin(seed)

    def _use(self, level: Level) -> None:
        """Set the level of the episode: one with a random maze has others."""
        from babyrobot_levels.render.text import TextPainter

        self._level, self._painter = level, TextPainter(level, plain=not self._unicode)
        self._mdp = level.compile().turning(level.heading) if self._turns else level.compile()

    def begin(self, seed: int | None = None) -> None:
        """Begin an episode."""
        state, info = self._env.reset(seed=seed, options=self._options)
        self._mask = info["action_mask"]
        maze = f"  maze {info['maze_seed']}" if "maze_seed" in info else ""
        self._heading = self._title + maze
        level = self._env.get_wrapper_attr("level")
        if level is not self._level:
            self._use(level)
        self._enter(state)
        self._steps, self._reward, self._return = 0, 0.0, 0.0
        self._end = ""
        needs = "" if self._now.exit_is_open else f" It needs {_listed(self._level.exit_keys)}."
        self._say(self._aim + needs, _DIM)

    def _enter(self, state: int) -> None:
        """Set the state and what it means."""
        self._state, self._now = state, self._level.configuration(self._mdp.configuration(state))

    def act(self, action: int) -> None:
        """Take an action, if the episode is not over."""
        if self._end:
            return
        possible, before, then = self._mask[action], self._state, self._now
        state, reward, over, late, info = self._env.step(action)
        self._enter(state)
        self._reward = float(reward)
        self._mask = info["action_mask"]
        self._steps += 1
        self._return += self._reward
        told = list(self._changes(then))
        if info.get("hit"):
            told.insert(0, f"The {self._hitter(before, action)} hits the robot!")
        style = _WARNING if info.get("hit") else {}
        if over and not info.get("hit") and self._is_at_exit():
            self._end, style = "reached the exit", _GOOD
            told = ["The exit! Well done."]
        elif over:
            self._end, style = "ended", _WARNING
            told.append("The episode is over.")
        elif late:
            self._end, style = "ran out of steps", _WARNING
            told.append("No steps left.")
        elif info["skidded"]:
            style = _WARNING
            told.insert(0, "Whoops, the robot skids!")
        elif not possible:
            style = _WARNING
            told.insert(0, self._bump(before, action, then))
        elif not info["target_reached"]:
            style = _WARNING
            told.insert(0, "The glass throws the robot back.")
        self._say(" ".join(told), style)

    def _changes(self, then: Configuration) -> Iterator[str]:
        """Yield what has changed since a configuration."""
        from babyrobot_levels.mdp.grid import door_name

        level, now = self._level, self._now
        yield from (f"Took the {name}." for name in now.held if name not in then.held)
        things = level.things()
        for column, before, after in zip(things.fixed, then.on, now.on, strict=True):
            if before != after:
                yield f"The {things.names[column]} is {'on' if after else 'off'}."
        for door, before, after in zip(level.doors, then.doors, now.doors, strict=True):
            if before != after:
                yield f"The {door_name(door)} {'closes' if after else 'opens'}."
        if then.exit_is_open != now.exit_is_open:
            yield f"The exit is {'open' if now.exit_is_open else 'closed'}."

    def _hitter(self, before: int, action: int) -> str:
        """Return the name of the mover that hit the robot in the last step."""
        from babyrobot_levels.mdp.tables import hits_by_mover

        is_outcome = (self._mdp.probability[before, action] > 0) & (
            self._mdp.next_state[before, action] == self._state
        )
        names = self._level.things().names[self._level.things().static :]
        hits = hits_by_mover(self._level, self._mdp, slice(before, before + 1))
        return next(
            name
            for name, by_mover in zip(names, hits, strict=True)
            if by_mover[0, action][is_outcome].any()
        )

    def _bump(self, before: int, action: int, then: Configuration) -> str:
        """Return what refused the last move."""
        from babyrobot_levels.language.base import SIDES
        from babyrobot_levels.mdp.grid import door_sides

        move = self._mdp.heading(before) + Action.NORTH if self._turns else action
        cell, side = before % self._mdp.cells, SIDES[move - Action.NORTH]
        doors = door_sides(self._level, self._level.grid())
        is_door = any((cell, side) == (at, of) and then.doors[number] for at, of, number in doors)
        where = Action(move).name.lower()
        return (
            f"Bump! The door in the {where} is closed."
            if is_door
            else (f"Bump! A wall in the {where}.")
        )

    def _is_at_exit(self) -> bool:
        return self._now.exit_is_open and self._mdp.cell(self._state) in self._now.exits

    def _status(self) -> str:
        """Return what is held and on; nothing for a level without such things."""
        told = self._level.things().told(self._now.values)
        return "   ".join(
            f"{state}: {', '.join(names) or 'nothing'}" for state, names in told.items()
        )

    def close(self) -> None:
        """End the last episode."""
        self._env.close()

    def summary(self) -> str:
        """Return the result in one line."""
        steps = "1 step" if self._steps == 1 else f"{self._steps} steps"
        return f"{self._name}: {self._end or 'stopped'} after {steps}, return {self._return:g}"

    def screen(self, room: os.terminal_size) -> list[str]:
        """Return the lines of the whole screen."""
        dot, arrows = (" · ", "←↑↓→") if self._unicode else (", ", "arrows")
        turns, forward = ("←→", "↑") if self._unicode else ("left, right", "up")
        keys = ["r restarts", "q quits"]
        if not self._end and self._turns:
            keys = [f"{turns} or AD turn", f"{forward} or W moves forward", *keys]
        elif not self._end:
            keys = [f"{arrows} or WASD move", "space stays", *keys]
        facts = [f"step {self._steps}{self._limit}", f"reward {self._reward:g}",
                 f"return {self._return:g}"]  # fmt: skip
        if len(dot.join(keys)) > room.columns - 2:
            short = [f"{turns} turn", f"{forward} moves"] if self._turns else [f"{arrows} move"]
            keys = [*([] if self._end else short), "r restart", "q quits"]
        above = [self._styled(self._heading, _BOLD, room)]
        status = self._status()
        below = [
            self._styled("   ".join(facts), {}, room),
            *([self._styled(status, {}, room)] if status else []),
            self._styled(*self._message, room),
            self._styled(dot.join(keys), _DIM, room),
        ]
        size = type(room)((room.columns - 2, max(1, room.lines - len(above) - len(below))))
        heading = self._mdp.heading(self._state) if self._turns else None
        picture = self._painter.lines(
            self._shown(), heading=heading, colors=self._colors, held=False, room=size
        )
        if len(picture) + len(above) + len(below) + 3 <= room.lines:
            # There is room for empty lines.
            above, below = [*above, ""], ["", *below[:-1], "", below[-1]]
        return [*above, *(" " + line for line in picture), *below][: room.lines]

    def _shown(self) -> int:
        """Return the state in the numbering of the level's tables."""
        mdp = self._mdp
        return mdp.configuration(self._state) * mdp.cells + self._state % mdp.cells

    def _say(self, text: str, style: _Style | None = None) -> None:
        """Set the message about what has just happened."""
        self._message = text, style or {}
        self.moment += 1

    def _styled(self, text: str, style: _Style, room: os.terminal_size) -> str:
        """Return a line that fits, in a style if the terminal takes colour."""
        text = " " + text[: room.columns - 2]
        return typer.style(text, **style) if style and self._colors and text.strip() else text


def _recorded(env: Any, path: Path) -> Any:
    """Return an environment whose episodes are recorded; end the command if that is impossible."""
    from babyrobot_levels.language.play import PlayError
    from babyrobot_levels.scoring.plays import RecordPlay

    try:
        return RecordPlay(env, path)
    except PlayError as error:
        fail(str(error))
    except OSError as error:
        fail(f"{path} cannot be written ({error.strerror or error})")


def _listed(names: Sequence[str]) -> str:
    """Return names as a sentence lists them."""
    return " and ".join([*([", ".join(names[:-1])] if names[1:] else []), names[-1]])


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


UP, DOWN, RIGHT, LEFT = "up", "down", "right", "left"

NextKey = Callable[[float], str | None]
"""Waits at most so many seconds for a key. Returns the name of an arrow key, a character, another
escape sequence, or None if no key was pressed."""

_INTERRUPT = "\x03"


if sys.platform == "win32":
    import msvcrt

    _ARROWS = {"H": UP, "P": DOWN, "M": RIGHT, "K": LEFT}

    @contextmanager
    def keyboard() -> Iterator[NextKey]:
        """Yield a function that waits for keys. It raises KeyboardInterrupt for Ctrl-C."""
        yield _next_key

    def _next_key(seconds: float) -> str | None:
        end = time.monotonic() + seconds
        while not msvcrt.kbhit():
            if time.monotonic() >= end:
                return None
            time.sleep(0.01)
        key = msvcrt.getwch()
        if key == _INTERRUPT:
            raise KeyboardInterrupt
        if key in ("\x00", "\xe0"):
            key = msvcrt.getwch()
            return _ARROWS.get(key, f"\x00{key}")
        return key

else:
    import os
    import select
    import termios

    _ARROWS = {"A": UP, "B": DOWN, "C": RIGHT, "D": LEFT}
    _KEY = re.compile(r"\x1b\[[0-?]*[ -/]*[@-~]|\x1bO[@-~]|.", re.DOTALL)
    _UNFINISHED = re.compile(r"\x1b(?:\[[0-?]*[ -/]*|O)?")
    _REST_OF_A_SEQUENCE = 0.05

    @contextmanager
    def keyboard() -> Iterator[NextKey]:
        """Yield a function that waits for keys, which the terminal does not echo meanwhile.

        It raises KeyboardInterrupt for Ctrl-C, and EOFError if the terminal is closed.
        """
        descriptor = sys.stdin.fileno()
        before = termios.tcgetattr(descriptor)
        mode = termios.tcgetattr(descriptor)
        # Ctrl-Z, too, is a key: suspended, the game would not restore the screen.
        mode[3] &= ~(termios.ICANON | termios.ECHO | termios.ISIG)
        mode[6][termios.VMIN], mode[6][termios.VTIME] = 1, 0
        try:
            termios.tcsetattr(descriptor, termios.TCSADRAIN, mode)
            yield _Keys(descriptor)
        finally:
            # Fails if the terminal is closed. Keys that were pressed too late for the game are
            # discarded, so that they are not typed into the shell.
            with suppress(termios.error):
                termios.tcsetattr(descriptor, termios.TCSAFLUSH, before)

    class _Keys:
        """Reads keys from a terminal."""

        def __init__(self, descriptor: int) -> None:
            self._descriptor = descriptor
            self._decode = codecs.getincrementaldecoder("utf-8")("replace").decode
            self._text = ""

        def __call__(self, seconds: float) -> str | None:
            end = time.monotonic() + seconds
            while not self._text:
                # There may be less than a whole character.
                if not self._read(max(0.0, end - time.monotonic())):
                    return None
            while _UNFINISHED.fullmatch(self._text) and self._read(_REST_OF_A_SEQUENCE):
                pass
            found = _KEY.match(self._text)
            key = found[0] if found else self._text
            self._text = self._text[len(key) :]
            if key == _INTERRUPT:
                raise KeyboardInterrupt
            return _ARROWS.get(key[-1], key) if len(key) > 2 else key

        def _read(self, seconds: float) -> bool:
            """Read what is there or comes in time. Return False if nothing was."""
            if not select.select([self._descriptor], [], [], seconds)[0]:
                return False
            data = b""
            # A closed terminal either gives nothing or cannot be read.
            with suppress(OSError):
                data = os.read(self._descriptor, 1024)
            if not data:
                raise EOFError("the terminal is closed")
            self._text += self._decode(data)
            return True
