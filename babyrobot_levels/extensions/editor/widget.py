"""The editor as a widget in notebooks, of the same front end that the server shows."""

from __future__ import annotations

import asyncio
import os
from pathlib import Path
from typing import Any

import anywidget
import traitlets

from babyrobot_levels.extensions.editor.protocol import SLOW, answer, prepare
from babyrobot_levels.extensions.editor.session import EditedFile, Session
from babyrobot_levels.extensions.editor.state import state_of, widget_script
from babyrobot_levels.library.level import Level
from babyrobot_levels.render.notebook.html import (
    SVG,
    TEXT,
    WIDGET,
    Bundle,
    Frontend,
    frontend,
    level_mimebundle,
)
from babyrobot_levels.text.files import write_text

QUIET_SECONDS = 0.5
"""The picture that stays in the notebook is renewed when nothing has changed for so long."""


class Editor(anywidget.AnyWidget):
    """A level that is edited in a notebook cell.

    `observe(handler, "level")` and `observe(handler, "yaml")` call a handler at each change.

    Attributes:
        yaml: the text at hand. It can be set, which is one step to undo.
        level: the level of the text, or of the last text that was valid; None if none was.
    """

    __module__ = "babyrobot_levels"

    _esm = widget_script()

    yaml = traitlets.Unicode()
    level = traitlets.Instance(Level, allow_none=True, read_only=True)

    def __init__(self, session: Session) -> None:
        self._session = session
        self._stand_ins: list[Any] = []
        self._timer: asyncio.TimerHandle | None = None
        self._tasks: set[asyncio.Task[None]] = set()
        super().__init__()
        self._class = f"babyrobot-{self.model_id}"
        self.add_class(self._class)
        self._take_over()
        self.observe(self._type, "yaml")
        self.on_msg(self._receive)

    def __repr__(self) -> str:
        return f"<Editor of {self._session.path or self._session.name}>"

    def save(self, path: str | os.PathLike[str] | None = None) -> None:
        """Write the text to a file, whole or not at all.

        Args:
            path: the file, which is overwritten, and saved to from now on; None for the file that
                the level is from.

        Raises:
            RefusedError: there is no file, it cannot be written, or another program has changed
                it meanwhile; with its path, it is overwritten.
        """
        if path is not None:
            write_text(Path(path).expanduser(), self._session.text)
            self._session.file = EditedFile(Path(path).expanduser())
        self._session.save()
        self._push()

    # -- messages --------------------------------------------------------------------------

    def _receive(self, _: object, content: Any, buffers: object) -> None:
        if not isinstance(content, dict):
            return
        if content.get("do") in SLOW:
            task = asyncio.get_running_loop().create_task(self._answer_later(content))
            self._tasks.add(task)
            task.add_done_callback(self._tasks.discard)
            return
        before = self._session.revision
        self.send(answer(self._session, content))
        if self._session.revision != before:
            self._take_over()
            self._renew_later()

    async def _answer_later(self, question: dict[str, Any]) -> None:
        """Answer a question that may take long, while the kernel does other things."""
        reply = await asyncio.to_thread(prepare, self._session, question)
        self.send(answer(self._session, question) if reply is None else reply)

    def _type(self, change: Any) -> None:
        """Take a text that was set in Python."""
        if change.new != self._session.text:
            self._session.type(change.new)
            self._push()

    def _push(self) -> None:
        """Show all views what was changed in Python."""
        self._take_over()
        self._renew_later()
        self.send(self._session.shown.reply(state_of(self._session), None))

    def _take_over(self) -> None:
        """Set the traits to what the session has."""
        with self.hold_trait_notifications():
            self.set_trait("level", self._session.level)
            self.yaml = self._session.text

    # -- the picture that stays ------------------------------------------------------------

    def _repr_mimebundle_(self, **_: Any) -> tuple[Bundle, Bundle]:
        """Return the widget, with a picture where there is no kernel, and no metadata.

        Programs that run notebooks get the picture alone. Where a person watches, the picture is
        an output of its own, since front ends show only the widget of a bundle that has one.
        """
        kind = frontend()
        if kind is Frontend.PROGRAM:
            return self._picture(), {}
        bundle, _metadata = super()._repr_mimebundle_() or ({}, {})
        view = {WIDGET: bundle[WIDGET], TEXT: ""}
        if kind is Frontend.NONE:
            return view | self._picture(), {}
        from babyrobot_levels.render.notebook.view import Output

        self._stand_ins.append(Output(self._picture, self._class))
        return view, {}

    def _picture(self) -> Bundle:
        level = self._session.level
        if level is None:
            return {TEXT: repr(self)}
        bundle = level_mimebundle(level)
        if SVG in bundle:
            bundle[SVG] = bundle[SVG].replace("<svg ", f'<svg class="{self._class}" ', 1)
        return bundle

    def _renew_later(self) -> None:
        """Renew the pictures in the notebook when the user pauses."""
        if not self._stand_ins:
            return
        if self._timer is not None:
            self._timer.cancel()
        # Kernels handle messages and run cells in a loop.
        self._timer = asyncio.get_running_loop().call_later(QUIET_SECONDS, self._renew)

    def _renew(self) -> None:
        for stand_in in self._stand_ins:
            stand_in.refresh()
