"""`babyrobot play`: a level in the terminal, played with the arrow keys."""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator
from contextlib import closing, contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

import babyrobot_levels as brl
from babyrobot_levels.cli.console import fail, note, speaks_unicode, value_option, write
from babyrobot_levels.cli.inputs import LevelArgument, MazeSeedOption, load_level
from babyrobot_levels.cli.reporting import STANDARD_INPUT
from babyrobot_levels.extensions.play.keyboard import NextKey, keyboard
from babyrobot_levels.mdp.actions import Action, Turn
from babyrobot_levels.mdp.gridworld import check_one_robot
from babyrobot_levels.render.terminal import colors_of
from babyrobot_levels.render.words.happenings import bump, changes, hitter
from babyrobot_levels.render.words.phrases import counted, with_limit
from babyrobot_levels.text.source import printable

if TYPE_CHECKING:
    import os


PlayActions = Literal["all", "turns"]
"""The actions with which a level can be played."""


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
_HINT, _UNDO, _RESTART, _QUIT = ("h", "?"), ("u", "z"), "r", ("q", "\x04")
_ALL_SCREEN, _SCREEN_AS_IT_WAS = "\x1b[?1049h\x1b[?25l", "\x1b[?25h\x1b[?1049l"
_Style = dict[str, Any]
_BOLD: _Style = {"bold": True}
_DIM: _Style = {"dim": True}
_WARNING: _Style = {"fg": "yellow"}
_GOOD: _Style = {"fg": "green", "bold": True}
MAX_SOLVED = 5_000
"""The most states of a level that is solved without being asked for."""

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
        fail("`babyrobot play` needs a terminal", "use `babyrobot preview` to look at a level")
    game = _Game(loaded, seed, maze_seed, record, turns=actions == "turns")
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
        elif key in _HINT:
            game.hint()
        elif key in _UNDO:
            game.undo()
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
        level: brl.Level,
        seed: int | None,
        maze_seed: int | None,
        record: Path | None,
        *,
        turns: bool,
    ) -> None:
        self._turns = turns
        self.keys: dict[str, int] = {**(_TURNS if turns else _MOVES)}
        self._inner = level.make(observation="index", actions="turns" if turns else "valid")
        self._recorder = None if record is None else _recorded(self._inner, record)
        self._env = self._recorder or self._inner
        self._options = {} if maze_seed is None else {"maze_seed": maze_seed}
        self._colors, self._unicode = colors_of(sys.stdout), speaks_unicode(sys.stdout)
        self._name = printable(level.name or "level")
        self._title = printable(level.title or self._name)
        self._limit = f" of {level.max_steps}" if level.max_steps else ""
        self.moment = 0
        self._use(self._env.get_wrapper_attr("level"))
        self.begin(seed)

    def _use(self, level: brl.Level) -> None:
        """Set the level of the episode: one with a random maze has others."""
        from babyrobot_levels.render.text import TextPainter
        from babyrobot_levels.render.words.describe import goal_of

        check_one_robot(level, "games in the terminal")
        self._goal, self._best = goal_of(level), ""
        self._policy: list[int] | None = None
        self._level, self._painter = level, TextPainter(level, plain=not self._unicode)
        self._mdp = level.compile().turning(level.heading) if self._turns else level.compile()

    def begin(self, seed: int | None = None) -> None:
        """Begin an episode."""
        self._seed, self._luck = seed, self._inner.unwrapped.np_random.bit_generator.state
        self._hints = self._undone = 0
        self._start(self._env)

    def _start(self, env: Any) -> None:
        """Show the first state of the episode of a seed, or of the random numbers at hand."""
        state, info = env.reset(seed=self._seed, options=self._options)
        self._mask = info["action_mask"]
        maze = f"  maze {info['maze_seed']}" if "maze_seed" in info else ""
        self._heading = self._title + maze
        level = env.get_wrapper_attr("level")
        if level is not self._level:
            self._use(level)
        self._enter(state)
        self._taken: list[int] = []
        self._reward, self._return = 0.0, 0.0
        self._end, self._is_hinted = "", False
        self._say(self._goal, _DIM)

    def _enter(self, state: int) -> None:
        """Set the state and what it means."""
        self._state, self._now = state, self._level.configuration(self._mdp.configuration(state))

    def act(self, action: int) -> None:
        """Take an action, if the episode is not over."""
        if not self._end:
            self._take(action, self._env)

    def _take(self, action: int, env: Any) -> None:
        possible, before, then = self._mask[action], self._state, self._now
        state, reward, over, late, info = env.step(action)
        self._enter(state)
        self._reward = float(reward)
        self._mask = info["action_mask"]
        self._return += self._reward * self._level.discount**self._steps
        self._taken.append(action)
        self._is_hinted = False
        level = self._level
        told = list(changes(level, then, self._now))
        if info.get("hit"):
            told.insert(0, f"The {hitter(level, self._mdp, before, action, state)} hits the robot!")
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
            told.insert(0, bump(level, self._mdp, before, self._move(before, action), then))
        elif not info["target_reached"]:
            style = _WARNING
            told.insert(0, "The glass throws the robot back.")
        self._say(" ".join(told), style)

    @property
    def _steps(self) -> int:
        return len(self._taken)

    @property
    def _is_final(self) -> bool:
        """Whether the episode has ended and is recorded."""
        return bool(self._end) and self._recorder is not None

    def hint(self) -> None:
        """Tell the best action, and count that it was asked for."""
        from babyrobot_levels.analysis.solver.results import action_names

        policy = self._solved()
        action = policy[self._state] if policy and not self._end else -1
        if action < 0:
            why = "the episode has ended" if self._end else "no policy is the best here"
            self._say(f"There is no hint: {why}.", _DIM)
            return
        self._hints += not self._is_hinted
        self._is_hinted = True
        if self._recorder is not None:
            self._recorder.hints = self._hints
        name = action_names("turns" if self._turns else "all")[action]
        told = name if name == "stay" else f"turn {name}" if self._turns else f"move {name}"
        self._say(f"Hint: {told.replace('turn forward', 'move forward')}.", _GOOD)

    def undo(self) -> None:
        """Go back to before the last action; the same action will have the same outcome again."""
        if not self._taken:
            self._say("There is no action to undo.", _DIM)
        elif self._is_final:
            self._say("The episode is recorded as it ended.", _DIM)
        else:
            *taken, _ = self._taken
            # An episode follows from its random numbers and actions.
            self._inner.unwrapped.np_random.bit_generator.state = self._luck
            self._start(self._inner)
            for action in taken:
                self._take(action, self._inner)
            self._undone += 1
            if self._recorder is not None:
                self._recorder.take_back()
            x, y = self._mdp.cell(self._state)
            self._say(f"Undone: back at [{x}, {y}] after {counted(self._steps, 'step')}.", _DIM)

    def _solved(self) -> list[int]:
        """Return the optimal action of each state; none if the level has no solution."""
        from babyrobot_levels.analysis.guides import best_average, policy_of
        from babyrobot_levels.render.page_format import rounded

        if self._policy is None:
            self._policy = []
            with suppress(brl.UndefinedReturnError):
                solution = brl.solve(self._level, actions="turns" if self._turns else "all")
                best = best_average(self._level, solution)
                limit = self._level.max_steps
                told = rounded(best).replace("\N{MINUS SIGN}", "-")
                self._best = with_limit(told, limit, limit) if math.isfinite(best) else ""
                self._policy = (
                    solution.policy.ravel().tolist() if self._turns else policy_of(solution)
                )
        return self._policy

    def _result(self) -> list[str]:
        """Return what there is to tell of an episode beside its return."""
        if self._end and self._mdp.num_states <= MAX_SOLVED:
            self._solved()
        counts = ((self._hints, "hint"), (self._undone, "undo"))
        help_ = ", ".join(counted(number, name) for number, name in counts if number)
        best = self._best if self._end else ""
        return [*([f"best average {best}"] if best else []), *([f"help: {help_}"] if help_ else [])]

    def _move(self, state: int, action: int) -> int:
        """Return the move that an action is: forward is the one in the robot's direction."""
        return self._mdp.heading(state) + Action.NORTH if self._turns else action

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
        facts = [f"return {self._return:g}", *self._result()]
        how = f"{self._end or 'stopped'} after {counted(self._steps, 'step')}"
        return f"{self._name}: {how}, {', '.join(facts)}"

    def screen(self, room: os.terminal_size) -> list[str]:
        """Return the lines of the whole screen."""
        rate = self._level.discount
        name = "return" if rate == 1 else f"return, discount {rate:g},"
        facts = [f"step {self._steps}{self._limit}", f"reward {self._reward:g}",
                 f"{name} {self._return:g}"]  # fmt: skip
        above = [self._styled(self._heading, _BOLD, room)]
        status = self._status()
        below = [
            *(self._styled("   ".join(each), {}, room) for each in (facts, self._result()) if each),
            *([self._styled(status, {}, room)] if status else []),
            self._styled(*self._message, room),
            self._styled(self._keys(room.columns - 2), _DIM, room),
        ]
        size = type(room)((room.columns - 2, max(1, room.lines - len(above) - len(below))))
        heading = self._mdp.heading(self._state) if self._turns else None
        picture = self._painter.lines(
            self._shown(), heading=heading, colors=self._colors, held=False, room=size
        )
        free = room.lines - len(picture) - len(above) - len(below) - 4
        legend = self._legend(room.columns - 2) if free > 0 else []
        if 0 < len(legend) <= free:
            picture += ["", *legend]
        if len(picture) + len(above) + len(below) + 3 <= room.lines:
            # There is room for empty lines.
            above, below = [*above, ""], ["", *below[:-1], "", below[-1]]
        return [*above, *(" " + line for line in picture), *below][: room.lines]

    def _legend(self, columns: int) -> list[str]:
        number = self._mdp.configuration(self._state) if self._level.has_things else None
        return self._painter.explained(configuration=number, colors=self._colors, columns=columns)

    def _keys(self, width: int) -> str:
        """Return what the keys do, in the longest of the forms that fit."""
        dot, arrows = (" · ", "←↑↓→") if self._unicode else (", ", "arrows")
        turns, forward = ("←→", "↑") if self._unicode else ("left, right", "up")
        long, short = (
            [f"{turns} or AD turn", f"{forward} or W moves", "h hints"],
            [f"{turns} turn", f"{forward} moves", "h hint"],
        ) if self._turns else (
            [f"{arrows} or WASD move", "space stays", "h hints"],
            [f"{arrows} move", "h hint"],
        )  # fmt: skip
        if self._end:
            long = short = []
        undo = [] if self._is_final else ["u undo"]
        rest = [*undo, "r restart", "q quits"]
        forms = (
            dot.join([*long, *(f"{each}es" for each in undo), "r restarts", "q quits"]),
            dot.join([*short, *rest]),
            dot.join([*short[-1:], *rest]),
        )
        return next((form for form in forms if len(form) <= width), forms[-1])

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
    try:
        return brl.RecordPlay(env, path)
    except brl.PlayError as error:
        fail(str(error))
    except OSError as error:
        fail(f"{path} cannot be written ({error.strerror or error})")


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
