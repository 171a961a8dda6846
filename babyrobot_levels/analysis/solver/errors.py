"""What solving can fail at."""

from __future__ import annotations

from babyrobot_levels.analysis.solver.model import Flags, Model
from babyrobot_levels.text.errors import BabyRobotError


class NoTotalError(BabyRobotError, ArithmeticError):
    """Without a discount, the total reward of a level or of a policy has no value.

    Raised where rewards that differ from zero cancel out in a loop without end: +1, -1, +1, …
    `cell` is a cell `(x, y)` of such a loop.
    """

    def __init__(self, cell: tuple[int, int]):
        self.cell = cell
        super().__init__(cell)

    def __str__(self) -> str:
        x, y = self.cell
        return (
            f"around [{x}, {y}] the robot can go round for ever while rewards and costs cancel "
            "out, and such a sum has no value; a discount below 1 gives it one"
        )


class TooLongError(BabyRobotError, ArithmeticError):
    """Without a discount, episodes are so long that floating point cannot tell what they give."""

    def __str__(self) -> str:
        return (
            "on the way the robot would need more than 10^10 steps, too many for exact totals; "
            "a discount below 1 makes them exact again"
        )


def no_total(model: Model, unclear: Flags, width: int) -> NoTotalError:
    """Return the error that names the first of the unclear states, `[n]`, of a model."""
    y, x = divmod(int(model.states[unclear.argmax()]), width)
    return NoTotalError((x, y))
