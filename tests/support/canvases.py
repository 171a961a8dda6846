"""What ipycanvas sends to a browser, and what is needed to draw it without Jupyter."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import comm
import pytest
from ipycanvas.canvas import COMMANDS, Canvas, MultiCanvas  # type: ignore[import-untyped]

NAMES = {number: name for name, number in COMMANDS.items()}
STYLES = {
    number: "".join([first, *(part.title() for part in rest)])
    for (first, *rest), number in ((name.split("_"), n) for name, n in Canvas.ATTRS.items())
}
"""The attributes of a browser's canvas by ipycanvas's numbers for them."""

Command = tuple[str, list[Any]]


class Sent:
    """The messages of all widgets, as they were sent."""

    def __init__(self) -> None:
        self.kinds: list[str] = []
        self.drawings: list[list[Command]] = []

    def publish(self, _: object, kind: str, data: Any = None, **keys: Any) -> None:
        """Take the place of what sends a message."""
        self.kinds.append(kind)
        if (data or {}).get("method") == "custom":
            buffers = keys["buffers"]
            # What is not in the first one, numbers of commands of one kind, we do not use.
            assert len(buffers) == 1
            commands = json.loads(bytes(buffers[0]))
            if not isinstance(commands[0], list):
                commands = [commands]
            self.drawings.append([(NAMES[name], arguments) for name, arguments, *_ in commands])

    def clear(self) -> None:
        """Forget what was sent."""
        self.kinds.clear()
        self.drawings.clear()

    def commands(self, name: str) -> list[list[Any]]:
        """Return the arguments of all commands of a name."""
        return [args for drawing in self.drawings for called, args in drawing if called == name]

    def _steps(self) -> Iterator[tuple[str, str, list[Any]]]:
        """Yield the commands, each with the model id of the canvas that it is for."""
        current = ""
        for name, arguments in (each for drawing in self.drawings for each in drawing):
            if name == "switchCanvas":
                current = arguments[0].removeprefix("IPY_MODEL_")
            else:
                yield current, name, arguments

    @property
    def layers(self) -> list[str]:
        """The model ids of the canvases that were cleared, in order: those painted anew."""
        return [canvas for canvas, name, _ in self._steps() if name == "clear"]

    def seen_on(self, widget: MultiCanvas) -> list[list[Command]]:
        """Return, for each layer, the commands that made what is seen of it now."""
        seen: dict[str, list[Command]] = {}
        for canvas, name, arguments in self._steps():
            if name == "clear":
                seen[canvas] = []
            else:
                seen.setdefault(canvas, []).append((name, arguments))
        for commands in seen.values():
            # A path that was only begun cannot be seen.
            while commands and commands[-1][0] == "beginPath":
                commands.pop()
        return [seen[layer.model_id] for layer in widget._canvases]


@contextmanager
def recorded() -> Iterator[Sent]:
    """Record what is sent inside of the block; it goes nowhere else."""
    sent = Sent()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(
            comm.DummyComm, "publish_msg", lambda *args, **keys: sent.publish(*args, **keys)
        )
        yield sent
