"""Plans for the robots of a level, step by step by its own rules."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.extensions.robots.plan_files import Cells, read_plan
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.actions import DELTAS, MOVES, Action
from babyrobot_levels.mdp.compiler.things import stepper
from babyrobot_levels.mdp.states import has_succeeded
from babyrobot_levels.text import budget
from babyrobot_levels.text.errors import LevelError

_TIME, _OUTCOMES = 10_000, 150_000
"""The steps of work for each time of a plan, and to find out what a step of all robots comes to."""

_TAKEN = {DELTAS[move]: int(move) for move in MOVES[:4]} | {(0, 0): int(Action.STAY)}


Fault = tuple[str, tuple[int, ...], int]
"""The kind of a fault, whose it is, counted from 0, and after how many steps."""


class Walk:
    """What a plan comes to in a level.

    Args:
        level: the level, which nothing happens in by chance.

    Attributes:
        starts: where the robots start, `[robots, 2]`.

    Raises:
        LevelError: the level has one robot, moves lead elsewhere than to the next cell, or chance
            decides where episodes start.
    """

    def __init__(self, level: Level) -> None:
        if not level.robots:
            raise LevelError(message="a plan is for several robots, and the level has one")
        if level.warps or level.wind is not None:
            raise LevelError(message="plans are checked in levels without warps and wind")
        self.level, self.robots = level, stepper(level, level.grid())
        if len(self.robots.starts) > 1:
            raise LevelError(message=f"{_BY_CHANCE}: what episodes begin with is drawn")
        self.starts = np.array([cell for _, cell in level.team_starts], np.int32)

    def read(self, plan: Path) -> list[Cells]:
        """Return the readings of a file, each `[steps + 1, robots, 2]`; see `read_plan`."""
        return [*read_plan(plan, self.level.name or "", self.starts, len(self.starts))]

    def take(self, cells: Cells) -> tuple[Fault | None, NDArray[np.intp]]:
        """Follow a plan as far as the level lets it.

        Returns:
            The kind of the first fault, whose it is, counted from 0, and when, or None; and after
            how many steps each robot has arrived, or moved for the last time.

        Raises:
            LevelError: what a step leads to is drawn.
            OverBudgetError: there are too many steps.
        """
        try:
            return self._taken(cells)
        except budget.OverBudgetError as error:
            message = f"to follow a plan of {len(cells) - 1:,} steps is too much work"
            raise budget.OverBudgetError(message, error.help) from None

    def _taken(self, cells: Cells) -> tuple[Fault | None, NDArray[np.intp]]:
        state, count = int(self.robots.starts[0]), cells.shape[1]

        # Robots that wait come to the same again and again.
        @cache
        def told_of(state: int, joint: int) -> list[Any]:
            budget.spend(_OUTCOMES)
            return self.robots.outcomes(state, joint)[0]

        done = np.zeros(count, np.intp)
        for time in range(1, len(cells)):
            budget.spend(_TIME)
            moved = cells[time] - cells[time - 1]
            if (far := np.flatnonzero(np.abs(moved).sum(axis=1) > 1)).size:
                return ("jump", (int(far[0]),), time), done
            taken = [_TAKEN[x, y] for x, y in moved.tolist()]
            told = told_of(state, int(self.robots.joint_action(taken)))
            if len({outcome[1] for outcome in told}) > 1:
                raise LevelError(message=f"{_BY_CHANCE}: that of step {time} of this plan is drawn")
            before = self._away(state)
            state, over = told[0][1], told[0][3]
            there, away = self._cells(state), self._away(state)
            done[~before & (moved.any(axis=1) | away)] = time
            if (wrong := np.flatnonzero((there != cells[time]).any(axis=1))).size:
                return self._kept(cells, time, int(wrong[0])), done
            if over:
                if self._has_succeeded(state):
                    return None, done
                return ("over", (int(np.argmin(away)),), time), done
        away = self._away(state)
        return ("goal", (int(np.argmin(away)),), len(cells) - 1), done

    def _kept(self, cells: Cells, time: int, robot: int) -> Fault:
        """Return what keeps a robot from where the plan has it."""
        then, now = cells[time - 1], cells[time]
        for other in range(len(now)):
            if other != robot and (now[other] == now[robot]).all():
                return "vertex", (robot, other), time
            swaps = (now[other] == then[robot]).all() and (now[robot] == then[other]).all()
            if other != robot and swaps:
                return "edge", (robot, other), time
        return "kept", (robot,), time

    def _cells(self, state: int) -> Cells:
        places, _ = self.robots.places(np.array([state]))
        rows, columns = np.divmod(places[:, 0], self.robots.width)
        return np.stack([columns, rows], axis=1).astype(np.int32)

    def _away(self, state: int) -> NDArray[np.bool_]:
        _, away = self.robots.places(np.array([state]))
        found: NDArray[np.bool_] = away[:, 0]
        return found

    def _has_succeeded(self, state: int) -> bool:
        values: Any = self.robots.configurations[self.robots.configuration(state)]
        return has_succeeded(self.level, self.level.things().at(values.tolist()))


_BY_CHANCE = "plans are for levels in which nothing happens by chance"
