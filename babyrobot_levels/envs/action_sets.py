"""Action sets: the values of the argument `actions` of environments."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from babyrobot_levels.mdp.actions import NUM_ACTIONS, Action, Turn

if TYPE_CHECKING:
    from babyrobot_levels.library.level import Level
    from babyrobot_levels.mdp.tables import Mdp


class ActionSet(NamedTuple):
    """What a value of `actions` means.

    Attributes:
        first: the action that is number 0 of the space.
        samples_valid: whether `sample()` gives only actions that the action mask allows.
        turns: whether the robot turns: the actions are those of `Turn`, in the tables of
            `Mdp.turning`, whose states have a heading.
    """

    first: int
    samples_valid: bool
    turns: bool = False

    @property
    def num_actions(self) -> int:
        """The number of actions."""
        return len(Turn) if self.turns else NUM_ACTIONS - self.first

    def tables(self, level: Level) -> Mdp:
        """Return the tables of a level for a robot with these actions, which begin at `first`."""
        return level.compile().turning(level.heading) if self.turns else level.compile()


ACTION_SETS = {
    "valid": ActionSet(Action.STAY, True),
    "all": ActionSet(Action.STAY, False),
    "moves": ActionSet(Action.NORTH, False),
    "valid_moves": ActionSet(Action.NORTH, True),
    "turns": ActionSet(Turn.LEFT, False, turns=True),
}
"""The values of `actions`. From the first action of each set, all further ones belong to it."""
