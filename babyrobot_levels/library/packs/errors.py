"""What can be wrong with packs."""

from __future__ import annotations

from collections.abc import Sequence

from babyrobot_levels.text.errors import BabyRobotError


class PackError(BabyRobotError):
    """A pack that is damaged, too large, or not what it says it is."""


class PackConflictError(BabyRobotError):
    """Something is there already that is not taken away unasked. `help` says what can be done."""

    def __init__(self, message: str, help_text: str):
        self.help = help_text
        super().__init__(message, help_text)

    def __str__(self) -> str:
        return str(self.args[0])


class PackNotFoundError(BabyRobotError, LookupError):
    """No pack of that name is installed. `nearest` are the likeliest ones."""

    def __init__(self, name: str, nearest: Sequence[str] = ()):
        self.name, self.nearest = name, tuple(nearest)
        super().__init__(name, self.nearest)

    def __str__(self) -> str:
        name = self.name if len(self.name) <= 100 else self.name[:99] + "…"
        text = f"there is no installed pack called {name!r}"
        if self.nearest:
            text += f"; did you mean {' or '.join(map(repr, self.nearest))}?"
        return text
