"""What was changed in a text, so that it can be undone and redone without end."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass(frozen=True, slots=True)
class Step:
    """One change, with its name: from a place on, `old` became `new`."""

    name: str
    first: int
    old: str
    new: str


@dataclass(slots=True)
class History:
    """A text with the changes that led to it, and those that were undone."""

    text: str
    _done: list[Step] = field(default_factory=list)
    _undone: list[Step] = field(default_factory=list)

    @property
    def can_undo(self) -> bool:
        """Whether there is a change to undo."""
        return bool(self._done)

    @property
    def can_redo(self) -> bool:
        """Whether there is a change to do again."""
        return bool(self._undone)

    def change(self, text: str, name: str, *, joined: bool = False) -> None:
        """Make another text of it.

        Args:
            text: the text.
            name: what the step is called.
            joined: whether this and the change before are one step.
        """
        if text == self.text:
            return
        before = self.text
        if joined and self._done:
            before = _replaced(before, self._done.pop(), undo=True)
        self._done.append(_step(name, before, text))
        self._undone.clear()
        self.text = text

    def undo(self) -> str | None:
        """Undo the last change, and return its name; None if there is none."""
        if not self._done:
            return None
        self._undone.append(self._done.pop())
        self.text = _replaced(self.text, self._undone[-1], undo=True)
        return self._undone[-1].name

    def redo(self) -> str | None:
        """Do again what was undone last, and return its name; None if there is nothing."""
        if not self._undone:
            return None
        self._done.append(self._undone.pop())
        self.text = _replaced(self.text, self._done[-1], undo=False)
        return self._done[-1].name


def _step(name: str, old: str, new: str) -> Step:
    first = _common(old, new)
    left, right = old[first:], new[first:]
    same = _common(left[::-1], right[::-1])
    return Step(name, first, left[: len(left) - same], right[: len(right) - same])


def _common(left: str, right: str) -> int:
    """Return with how many characters both texts begin."""
    least, most = 0, min(len(left), len(right))
    while least < most:
        middle = (least + most + 1) // 2
        if left[least:middle] == right[least:middle]:
            least = middle
        else:
            most = middle - 1
    return least


def _replaced(text: str, step: Step, *, undo: bool) -> str:
    old, new = (step.new, step.old) if undo else (step.old, step.new)
    return text[: step.first] + new + text[step.first + len(old) :]
