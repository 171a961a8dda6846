"""The game in the terminal: its state, and the screen that shows it."""

from __future__ import annotations

import math
import sys
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import babyrobot_levels as brl
from babyrobot_levels.cli.console import fail, speaks_unicode, styled
from babyrobot_levels.language.metric_names import MAX_SOLVED
from babyrobot_levels.mdp.actions import NUM_MOVES, Action, Turn
from babyrobot_levels.render.terminal import colors_of
from babyrobot_levels.render.words.happenings import bump, changes, hitter
from babyrobot_levels.render.words.phrases import counted, with_limit
from babyrobot_levels.text.source import printable

if TYPE_CHECKING:
    import os

MOVES = {
    **dict.fromkeys(("up", "w"), Action.NORTH),
    **dict.fromkeys(("right", "d"), Action.EAST),
    **dict.fromkeys(("down", "s"), Action.SOUTH),
    **dict.fromkeys(("left", "a"), Action.WEST),
    **dict.fromkeys((" ", "."), Action.STAY),
}
_DIAGONALS = {
    "9": Action.NORTH_EAST,
    "3": Action.SOUTH_EAST,
    "1": Action.SOUTH_WEST,
    "7": Action.NORTH_WEST,
}
"""The keys of the numeric keypad."""

_TURNS = {
    **dict.fromkeys(("left", "a"), Turn.LEFT),
    **dict.fromkeys(("right", "d"), Turn.RIGHT),
    **dict.fromkeys(("up", "w"), Turn.FORWARD),
}
Style = dict[str, Any]
"""How a line is shown, as `styled` takes it."""

_BOLD: Style = {"bold": True}
DIM: Style = {"dim": True}
WARNING: Style = {"fg": "yellow"}
GOOD: Style = {"fg": "green", "bold": True}


class Game:
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
        self.keys = self._make_keys(level)
        self._inner = self._make(level)
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

    def _make_keys(self, level: brl.Level) -> dict[str, Any]:
        if self._turns:
            return {**_TURNS}
        return MOVES | _DIAGONALS if level.moves > NUM_MOVES else {**MOVES}

    def _make(self, level: brl.Level) -> Any:
        return level.make(observation="index", actions="turns" if self._turns else "valid")

    def _use(self, level: brl.Level) -> None:
        """Set the level of the episode: one with a random maze has others."""
        from babyrobot_levels.render.text import TextPainter
        from babyrobot_levels.render.words.describe import goal_of

        self._goal, self._best = goal_of(level), ""
        self._policy: list[int] | None = None
        self._level, self._painter = level, TextPainter(level, plain=not self._unicode)
        self._mdp = self._numbering(level)

    def _numbering(self, level: brl.Level) -> Any:
        return level.compile().turning(level.heading) if self._turns else level.compile()

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
        if (level := env.get_wrapper_attr("level")) is not self._level:
            self._use(level)
        self._enter(state)
        self._taken: list[Any] = []
        self._reward, self._return = 0.0, 0.0
        self._end, self._is_hinted = "", False
        self._say(self._goal, DIM)

    def _enter(self, state: int) -> None:
        """Set the state and what it means."""
        self._state, self._now = state, self._level.configuration(self._mdp.configuration(state))

    def act(self, choice: Any) -> None:
        """Take the choice of a key, if the episode is not over."""
        if not self._end:
            self._take(choice, self._env)

    def _take(self, action: Any, env: Any) -> None:
        before, then, mask = self._state, self._now, self._mask
        state, reward, over, late, info = env.step(action)
        self._enter(state)
        self._reward = float(reward)
        self._mask = info["action_mask"]
        self._return += self._reward * self._level.discount**self._steps
        self._taken.append(action)
        self._is_hinted = False
        told = list(changes(self._level, then, self._now))
        style = WARNING if info.get("hit") else {}
        if info.get("hit"):
            told.insert(0, self._blow(before, action))
        won = self._won() if over and not info.get("hit") else None
        if won is not None:
            (self._end, sentence), style = won, GOOD
            told = [f"{sentence} Well done."]
        elif over:
            self._end, style = "ended", WARNING
            told.append("The episode is over.")
        elif late:
            self._end, style = "ran out of steps", WARNING
            told.append("No steps left.")
        elif moved := self._moved(before, action, then, mask, info):
            style = style or self._moved_style
            told.insert(0, moved)
        self._say(" ".join(told), style)

    _moved_style = WARNING
    """How it is told that moves had another end than usual."""

    def _moved(self, before: int, action: Any, then: Any, mask: Any, info: dict[str, Any]) -> str:
        """Return what is to be told of a move; nothing of one that went where it should."""
        if info["skidded"]:
            return "Whoops, the robot skids!"
        if not mask[action]:
            return bump(self._level, self._mdp, before, self._move(before, action), then)
        return "" if info["target_reached"] else "The glass throws the robot back."

    def _blow(self, before: int, action: Any) -> str:
        """Return who hit the robot in a step, as a sentence."""
        name = hitter(self._level, self._mdp, before, self._number(action), self._state)
        return f"The {name} hits {'a' if self._level.robots else 'the'} robot!"

    def _number(self, action: Any) -> int:
        """Return the number of an action in the tables."""
        return int(self._inner.unwrapped.action_number(action))

    @property
    def _steps(self) -> int:
        return len(self._taken)

    @property
    def _is_final(self) -> bool:
        """Whether the episode has ended and is recorded."""
        return bool(self._end) and self._recorder is not None

    _no_hint = "no policy is the best here"
    """Why there is no hint in an episode that goes on."""

    def hint(self) -> None:
        """Tell the best action, and count that it was asked for."""
        policy = self._solved()
        action = policy[self._state] if policy and not self._end else -1
        if action < 0:
            why = "the episode has ended" if self._end else self._no_hint
            self._say(f"There is no hint: {why}.", DIM)
            return
        self._hints += not self._is_hinted
        self._is_hinted = True
        if self._recorder is not None:
            self._recorder.hints = self._hints
        self._say(f"Hint: {self._advice(action)}.", GOOD)

    def _advice(self, action: int) -> str:
        """Return an action of the tables in words."""
        from babyrobot_levels.analysis.solver.results import action_names

        name = action_names("turns" if self._turns else "all", self._mdp)[action]
        told = name if name == "stay" else f"turn {name}" if self._turns else f"move {name}"
        return told.replace("turn forward", "move forward")

    def undo(self) -> None:
        """Go back to before the last action; the same action will have the same outcome again."""
        if not self._taken:
            self._say("There is no action to undo.", DIM)
        elif self._is_final:
            self._say("The episode is recorded as it ended.", DIM)
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
            after = f"after {counted(self._steps, 'step')}"
            self._say(f"Undone: back at {self._place()} {after}.", DIM)

    def _place(self) -> str:
        x, y = self._mdp.cell(self._state)
        return f"[{x}, {y}]"

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

    def _won(self) -> tuple[str, str] | None:
        """Return how an episode that is over was won, for the summary and for the message."""
        now = self._now
        if now.exit_is_open and self._mdp.cell(self._state) in now.exits:
            return "reached the exit", "The exit!"
        return ("covered all targets", "All targets are covered!") if now.is_solved else None

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
            self._styled(self._keys(room.columns - 2), DIM, room),
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
        dot = " · " if self._unicode else ", "
        long, short = ([], []) if self._end else self._moving_keys()
        undo = [] if self._is_final else ["u undo"]
        rest = [*undo, "r restart", "q quits"]
        forms = (
            dot.join([*long, *(f"{each}es" for each in undo), "r restarts", "q quits"]),
            dot.join([*short, *rest]),
            dot.join([*short[-1:], *rest]),
        )
        return next((form for form in forms if len(form) <= width), forms[-1])

    def _moving_keys(self) -> tuple[list[str], list[str]]:
        """Return what the keys of actions do, at length and in brief."""
        arrows = "←↑↓→" if self._unicode else "arrows"
        turns, forward = ("←→", "↑") if self._unicode else ("left, right", "up")
        if self._turns:
            long = [f"{turns} or AD turn", f"{forward} or W moves", "h hints"]
            return long, [f"{turns} turn", f"{forward} moves", "h hint"]
        return [f"{arrows} or WASD move", "space stays", "h hints"], [f"{arrows} move", "h hint"]

    def _shown(self) -> int:
        """Return the state in the numbering of the level's tables."""
        mdp = self._mdp
        return int(mdp.configuration(self._state) * mdp.cells + self._state % mdp.cells)

    def _say(self, text: str, style: Style | None = None) -> None:
        """Set the message about what has just happened."""
        self._message = text, style or {}
        self.moment += 1

    def _styled(self, text: str, style: Style, room: os.terminal_size) -> str:
        """Return a line that fits, in a style if the terminal takes colour."""
        text = " " + text[: room.columns - 2]
        return styled(text, **style) if style and text.strip() else text


def _recorded(env: Any, path: Path) -> Any:
    """Return an environment whose episodes are recorded; end the command if that is impossible."""
    try:
        return brl.RecordPlay(env, path)
    except brl.PlayError as error:
        fail(str(error))
    except OSError as error:
        fail(f"{path} cannot be written ({error.strerror or error})")
