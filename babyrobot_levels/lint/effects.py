"""What a property of the ground can come to."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum, auto


class Effect(Enum):
    """What a property does, on all cells together that it is given to."""

    WORKS = auto()
    """It changes the game."""
    NOBODY = auto()
    """It changes only what would happen where nobody ever stands: on a warp for who enters."""
    SAME = auto()
    """Without it, the cells would have the same."""
    NEVER = auto()
    """It never comes into play: the episode is over there, or something else decides."""
    COVERED = auto()
    """Later areas or puddles say something else about all of its cells."""


@dataclass(slots=True)
class AreaEffect:
    """What an area of the level does.

    Attributes:
        number: its number among the level's areas.
        game: what each of the properties that it gives does.
        colored: whether its colour is to be seen; None if it has none.
        labelled: whether it has a label.
    """

    number: int
    game: dict[str, Effect] = field(default_factory=dict)
    colored: bool | None = None
    labelled: bool = False

    @property
    def works(self) -> bool:
        """Whether game or picture would be different without it."""
        return Effect.WORKS in self.game.values() or bool(self.colored) or self.labelled

    @property
    def is_covered(self) -> bool:
        """Whether it gives something, and all of it is covered."""
        covered = [effect is Effect.COVERED for effect in self.game.values()]
        covered += [] if self.colored is None else [not self.colored]
        return bool(covered) and all(covered)

    @property
    def is_safe(self) -> bool:
        """Whether taking it away would leave the tables as they are."""
        return all(self.is_safe_without(name) for name in self.game)

    def is_safe_without(self, name: str) -> bool:
        """Tell whether taking a property away would leave the tables as they are."""
        return self.game[name] not in (Effect.WORKS, Effect.NOBODY)

    def is_idle(self, name: str) -> bool:
        """Tell whether a property is given and nobody ever notices, not by chance of its value."""
        return self.game.get(name) in (Effect.NOBODY, Effect.NEVER, Effect.COVERED)
