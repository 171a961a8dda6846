"""The exact tables, which everything that plays a level reads."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.mdp.actions import NUM_ACTIONS

Outcome = tuple[float, int, float, bool]
"""Probability, next state, reward, terminal."""

FREE, REFUSED, GLASS = range(3)
"""What obstructs an action: nothing, a wall, or a wall of glass."""


FORMER_NAMES = {
    "over": "is_terminal",
    "possible": "action_mask",
    "hindered": "obstruction",
    "target": "intended_next_state",
}
"""Attributes of `Mdp` by the names that they had in version 0.1."""


@dataclass(frozen=True, eq=False)
class Mdp:
    """A finite Markov decision process whose states are the cells, numbered `y * width + x`.

    The tables are `[states, actions, outcomes]`. The outcomes of a state and action are distinct
    in (next state, reward, terminal), sorted by these, and their probabilities sum to one;
    rows with fewer outcomes than the longest are padded with probability 0. Where the episode
    is over, every action leads back with reward 0 and `terminal` set.

    Attributes:
        width: the number of columns of cells.
        height: the number of rows of cells.
        probability: float64, `[states, actions, outcomes]`.
        next_state: int32, `[states, actions, outcomes]`.
        reward: float64, `[states, actions, outcomes]`.
        terminal: bool, `[states, actions, outcomes]`.
        start: float64, `[states]`: the probability of each state at reset.
        is_terminal: bool, `[states]`: whether the episode is over there.
        action_mask: int8, `[states, actions]`: 1 for the actions that nothing refuses.
        intended_next_state: int32, `[states, actions]`: where the action leads without chance;
            the number of states stands for "one of the starts".
        obstruction: int8, `[states, actions]`: `FREE`, `REFUSED` or `GLASS`.
    """

    __module__ = "babyrobot_levels"

    width: int
    height: int
    probability: NDArray[np.float64]
    next_state: NDArray[np.int32]
    reward: NDArray[np.float64]
    terminal: NDArray[np.bool_]
    start: NDArray[np.float64]
    is_terminal: NDArray[np.bool_]
    action_mask: NDArray[np.int8]
    intended_next_state: NDArray[np.int32]
    obstruction: NDArray[np.int8]

    @property
    def num_states(self) -> int:
        """The number of cells, blocked ones included."""
        return self.width * self.height

    def outcomes(self, state: int, action: int) -> list[Outcome]:
        """Return what an action can lead to, as Gymnasium's toy_text tables list it."""
        chances = self.probability[state, action]
        count = int(np.count_nonzero(chances))
        return list(
            zip(
                chances[:count].tolist(),
                self.next_state[state, action, :count].tolist(),
                self.reward[state, action, :count].tolist(),
                self.terminal[state, action, :count].tolist(),
                strict=True,
            )
        )

    def to_toy_text(self, first_action: int = 0) -> dict[int, dict[int, list[Outcome]]]:
        """Return the tables as `{state: {action: [(probability, next state, reward, terminal)]}}`.

        Args:
            first_action: the action that becomes number 0: 1 leaves `stay` out.
        """
        return {
            state: {
                action - first_action: self.outcomes(state, action)
                for action in range(first_action, NUM_ACTIONS)
            }
            for state in range(self.num_states)
        }

    def freeze(self) -> Mdp:
        """Make all arrays read-only and return self: a table that all share must not change."""
        for value in vars(self).values():
            if isinstance(value, np.ndarray):
                value.flags.writeable = False
        return self

    def __deepcopy__(self, memo: dict[int, Any]) -> Mdp:
        return self

    def __getstate__(self) -> dict[str, Any]:
        return dict(vars(self))

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            if name not in FORMER_NAMES:
                raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")
            now = FORMER_NAMES[name]
            warnings.warn(
                f"Mdp.{name} is deprecated; use Mdp.{now}", DeprecationWarning, stacklevel=2
            )
            return getattr(self, now)

    def __setstate__(self, state: dict[str, Any]) -> None:
        # Pickles of version 0.1 have the former names.
        self.__dict__.update({FORMER_NAMES.get(name, name): value for name, value in state.items()})
        self.freeze()
