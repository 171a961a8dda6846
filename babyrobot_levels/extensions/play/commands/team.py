"""The game of several robots in the terminal: all move at once, when each has its action."""

from __future__ import annotations

from typing import Any

import babyrobot_levels as brl
from babyrobot_levels.extensions.play.commands.game import DIM, MOVES, Game
from babyrobot_levels.mdp.actions import Action
from babyrobot_levels.mdp.tables import Mdp
from babyrobot_levels.render.words.happenings import moves_of_team
from babyrobot_levels.text.source import printable

_ARROWS = ("up", "right", "down", "left")


class TeamGame(Game):
    """The game of several robots.

    The keys' choices are actions, each with the number of the robot that has these keys, if there
    are two robots; the one that is asked has the others. With too many joint states for tables, it
    knows no optimum.
    """

    def _make_keys(self, _level: brl.Level) -> dict[str, Any]:
        return {
            key: (int(action), None if action is Action.STAY else int(key in _ARROWS))
            for key, action in MOVES.items()
        }

    def _make(self, level: brl.Level) -> Any:
        return level.make(observation="index")

    def _numbering(self, level: brl.Level) -> Any:
        # A play has the digest of its level, for which there have to be tables.
        return level.numbering() if self._recorder is None else level.compile()

    def _use(self, level: brl.Level) -> None:
        super()._use(level)
        self._has_tables = isinstance(self._mdp, Mdp)
        if not self._has_tables:
            self._no_hint = "there are too many joint states to know the optimum"
        self._names = [printable(robot.name) for robot in level.robots]

    def _start(self, env: Any) -> None:
        self._picked: dict[int, int] = {}
        super()._start(env)
        self._ask()

    def act(self, choice: Any) -> None:
        """Take the choice of a key; once all robots have theirs, they move."""
        if self._end:
            return
        action, own = choice
        waiting = self._waiting()
        is_own = len(self._names) == 2 and own is not None and not self._now.arrived[own]
        self._picked[own if is_own else waiting[0]] = action
        if self._waiting():
            self._ask()
        else:
            actions = [self._picked.get(number, 0) for number in range(len(self._names))]
            self._take(actions, self._env)

    def _take(self, action: Any, env: Any) -> None:
        self._picked = {}
        super()._take(action, env)

    def undo(self) -> None:
        """Take back the choices for the next step, or the last step."""
        if self._picked:
            self._picked = {}
            self._ask()
        else:
            super().undo()

    def _waiting(self) -> list[int]:
        """Return the robots that have no action yet."""
        done = self._now.arrived
        return [
            number
            for number in range(len(self._names))
            if number not in self._picked and not done[number]
        ]

    def _ask(self) -> None:
        """Ask for the action of the next robot."""
        chosen = (
            f"{self._names[number]}: {Action(action).name.lower()}"
            for number, action in sorted(self._picked.items())
        )
        told = [self._message[0]] if not self._picked else [f"{', '.join(chosen)}."]
        self._say(" ".join([*told, f"And {self._names[self._waiting()[0]]}?"]), DIM)

    def _blow(self, before: int, action: Any) -> str:
        return super()._blow(before, action) if self._has_tables else "A robot is hit!"

    def _solved(self) -> list[int]:
        return super()._solved() if self._has_tables else []

    def _moved(self, before: int, action: Any, then: Any, mask: Any, info: dict[str, Any]) -> str:
        numbers = before, self._number(action), self._state
        return " ".join(moves_of_team(self._level, *numbers))

    def _won(self) -> tuple[str, str] | None:
        arrived = self._now.arrived
        if all(arrived) or (any(arrived) and self._level.team.ends == "first"):
            return "arrived", "All have arrived!" if all(arrived) else "Arrived!"
        return super()._won() if self._now.is_solved else None

    def _advice(self, action: int) -> str:
        parts = self._mdp.robot_actions(action).tolist()
        robots = zip(self._names, parts, self._now.arrived, strict=True)
        return ", ".join(
            f"{name} {Action(part).name.lower()}" for name, part, home in robots if not home
        )

    def _place(self) -> str:
        return "the step before"

    def _moving_keys(self) -> tuple[list[str], list[str]]:
        if len(self._names) > 2:
            return super()._moving_keys()
        arrows = "←↑↓→" if self._unicode else "arrows"
        first, second = self._names
        keys = [f"WASD {first}", f"{arrows} {second}"]
        return [*keys, "space stays", "h hints"], [*keys, "h hint"]
