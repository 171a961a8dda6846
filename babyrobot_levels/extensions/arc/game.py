"""A level as a game of arcengine: its transitions are those of the level's exact tables."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from babyrobot_levels.analysis.solver.policies import space_of
from babyrobot_levels.extensions.arc.boards import MOST, board_of
from babyrobot_levels.language.geometry import show_cell
from babyrobot_levels.library.catalogue import load
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.actions import NUM_MOVES, Action
from babyrobot_levels.mdp.tables import Flags, Ints
from babyrobot_levels.suites.suite import Levels, named_levels
from babyrobot_levels.text.errors import how_to_install

if TYPE_CHECKING:
    from arcengine import ARCBaseGame

ACTIONS = {1: Action.NORTH, 2: Action.SOUTH, 3: Action.WEST, 4: Action.EAST, 5: Action.STAY}
"""What the engine's actions do: up, down, left, right, and nothing."""


@dataclass(frozen=True, eq=False)
class Rules:
    """What follows from a level without chance.

    Attributes:
        level: the level.
        start: the state in which it begins.
        next_state: `[states, actions]`.
        terminal: whether a step ends the episode, `[states, actions]`.
        exits: whether an episode that ends in a state is won, `[states]`.
        least: the least number of actions to win.
    """

    level: Level
    start: int
    next_state: Ints
    terminal: Flags
    exits: Flags
    least: int


def arc_game(levels: Levels, *, game_id: str = "babyrobot") -> ARCBaseGame:
    """Return a game of arcengine, the engine of ARC-AGI-3, whose levels are these levels.

    ACTION1 to ACTION4 move up, down, left and right, ACTION5 waits. A level is won at its exit, or
    where its targets are covered; another end, or `max_steps`, loses the game. Its attribute
    `least_actions` has the least number of actions that wins each level.

    Args:
        levels: a level, several, a folder, a pack or a suite: names, paths, mappings, `Level`s.
        game_id: the name of the game.

    Raises:
        ImportError: the package `arcengine` is not installed.
        LevelNotFoundError: there is no such level.
        LevelError: a level is not valid, or its maze has no seed yet.
        ValueError: the engine cannot hold a level: it has more than 31 columns or rows, chance,
            several robots or diagonal moves; or it cannot be won.
    """
    try:
        from arcengine import ARCBaseGame, Camera, GameAction, Sprite
        from arcengine import Level as Board
    except ImportError:
        message = (
            f"games need the package `arcengine`, for Python 3.12 or later: {how_to_install('arc')}"
        )
        raise ImportError(message, name="arcengine") from None
    rules = [_rules_of(load(each)) for each in named_levels(levels)]

    class Game(ARCBaseGame):  # type: ignore[misc]
        """The game; `place` is the present state, as `level.compile()` numbers it."""

        least_actions = tuple(each.least for each in rules)

        def __init__(self) -> None:
            boards = [
                Board(
                    [Sprite(board_of(each.level, each.start), name="board")],
                    (2 * each.level.width + 1, 2 * each.level.height + 1),
                    name=each.level.name or each.level.digest,
                )
                for each in rules
            ]
            super().__init__(game_id, boards, Camera(), available_actions=[*ACTIONS])

        def on_set_level(self, level: Any) -> None:
            self.place, self._taken = rules[self.level_index].start, 0

        def step(self) -> None:
            if self.action.id is not GameAction.RESET and self.action.id.value in ACTIONS:
                self._move(rules[self.level_index], int(ACTIONS[self.action.id.value]))
            self.complete_action()

        def _move(self, rules: Rules, action: int) -> None:
            ended = bool(rules.terminal[self.place, action])
            self.place = int(rules.next_state[self.place, action])
            self._taken += 1
            (sprite,) = self.current_level.get_sprites()
            sprite.pixels = board_of(rules.level, self.place)
            if ended and rules.exits[self.place]:
                self.next_level()
            elif ended or self._taken == rules.level.max_steps:
                self.lose()

    return Game()


def _rules_of(level: Level) -> Rules:
    """Return what the engine plays of a level.

    Raises:
        ValueError: it cannot hold it.
    """
    name = level.name or "the level"
    if max(level.size) > MOST:
        columns, rows = level.size
        raise ValueError(
            f"{name} has {columns} x {rows} cells: arcengine's 64 x 64 pixels hold {MOST} x "
            f"{MOST} with the walls between them"
        )
    if level.robots or level.moves > NUM_MOVES:
        what = "several robots" if level.robots else "diagonal moves"
        raise ValueError(f"{name} has {what}: arcengine has four moves, of one player")
    space = space_of(level, "all")
    mdp = space.mdp
    starts = np.flatnonzero(mdp.start)
    if len(starts) > 1:
        raise ValueError(f"{name} begins in one of {len(starts)} states: arcengine has no chance")
    likely = mdp.probability.argmax(axis=-1)[..., None]
    next_state: Ints = np.take_along_axis(mdp.next_state, likely, -1)[..., 0]
    terminal: Flags = np.take_along_axis(mdp.terminal, likely, -1)[..., 0]
    start = int(starts[0])
    reached, least = _explored(start, next_state, terminal, space.exits)
    chance = reached[(mdp.probability[reached].max(axis=-1) < 1 - 1e-9).any(axis=1)]
    if chance.size:
        cell = show_cell(mdp.cell(int(chance[0])))
        raise ValueError(
            f"{name} has chance, at {cell} for example: arcengine's games are without chance"
        )
    if least is None or (level.max_steps is not None and least > level.max_steps):
        raise ValueError(f"{name} cannot be won: there is no way to an exit, or not in time")
    return Rules(level, start, next_state, terminal, space.exits, least)


def _explored(
    start: int, next_state: Ints, terminal: Flags, exits: Flags
) -> tuple[Ints, int | None]:
    """Return the states in which episodes go on, and in how many actions one can win at least."""
    is_reached = np.zeros(len(exits), bool)
    is_reached[start] = True
    front, steps, least = np.array([start]), 0, None
    while front.size:
        steps += 1
        after, ended = next_state[front].ravel(), terminal[front].ravel()
        if least is None and exits[after[ended]].any():
            least = steps
        front = np.unique(after[~ended & ~is_reached[after]])
        is_reached[front] = True
    return np.flatnonzero(is_reached), least
