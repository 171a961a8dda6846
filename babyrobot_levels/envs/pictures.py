"""The pictures of an environment: painters of every render mode, and what they have to show."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from babyrobot_levels.render.scene.pose import STANDING, pose_of
from babyrobot_levels.text.words import did_you_mean

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from babyrobot_levels.library.level import Level
    from babyrobot_levels.render.frames import FramePainter
    from babyrobot_levels.render.notebook.view import LevelView
    from babyrobot_levels.render.scene.overlay import Overlay
    from babyrobot_levels.render.scene.shapes import Scene
    from babyrobot_levels.render.terminal import Terminal
    from babyrobot_levels.render.text import TextPainter

RENDER_MODES = ("human", "rgb_array", "ansi", "svg", "canvas")
RENDER_FPS = 4
"""How many steps a second a robot of speed 1 takes where somebody watches."""

SUFFIXES = (".svg", ".png", ".txt")
"""The files that a picture can be saved as."""


class Pictures:
    """The pictures of one environment. Each painter is made when it is first needed.

    Args:
        mode: the environment's `render_mode`.
        level: the level that is played, its maze grown.
        state: where the robot is.
    """

    def __init__(self, mode: str | None, level: Level, state: int) -> None:
        self._mode = mode
        self._state, self._pose = state, STANDING
        self._overlay: Overlay | None = None
        self._is_up_to_date = False
        self._enter(level)
        self._terminal: Terminal | None = None
        self._view: LevelView | None = None

    def __getstate__(self) -> dict[str, Any]:
        kept = {**vars(self), "_terminal": None, "_view": None, "_is_up_to_date": False}
        return {**kept, "_frames": None, "_texts": {}}

    def _enter(self, level: Level) -> None:
        """Show a level from now on."""
        self._level = level
        self._exits = frozenset(y * level.size[0] + x for x, y in level.exits)
        self._forget_painters()

    def _forget_painters(self) -> None:
        self._frames: FramePainter | None = None
        self._texts: dict[bool, TextPainter] = {}

    # -- what happens ----------------------------------------------------------------------

    def begin(self, level: Level, state: int) -> None:
        """Have the robot stand where an episode begins, perhaps in another level.

        What is written on the picture stays, if the level is as large as the one before.
        """
        if level is not self._level:
            if level.size != self._level.size:
                self._overlay = None
                if self._view is not None:
                    self._view.set_overlay(None)
            self._enter(level)
            if self._view is not None:
                self._view.set_level(level, state)
        self._state, self._pose = state, STANDING
        self._follow()

    def step(self, action: int, state: int, skidded: bool) -> None:
        """Have the robot take an action, a `brl.Action`, that leads to a state."""
        self._pose = pose_of(
            self._state,
            state,
            action,
            self._level.size[0],
            skidded=skidded,
            at_exit=state in self._exits,
        )
        self._state = state
        self._follow()

    def show_info(self, info: Mapping[str, Any] | None) -> None:
        """Write on the picture, in the place of what was there; None for nothing.

        Raises:
            ValueError: the info is not understood, or does not fit the level.
        """
        from babyrobot_levels.render.scene.info import overlay_from

        self._overlay = None if info is None else overlay_from(info, self._level)
        self._forget_painters()
        if self._view is not None:
            self._view.set_overlay(self._overlay)
        self._is_up_to_date = False
        if self._terminal is not None:
            self.render()

    def _follow(self) -> None:
        """Have whoever watches see where the robot is."""
        self._is_up_to_date = False
        if self._view is not None:
            self._view.move(self._state, self._pose)
        if self._mode == "human":
            self.render()

    # -- what is seen ----------------------------------------------------------------------

    def render(self) -> Any:
        """Return, or show, the picture as it stands."""
        match self._mode:
            case "rgb_array":
                return self._frame()
            case "svg":
                return self.svg()
            case "ansi":
                return self.text()
            case "canvas":
                return self._canvas().widget
        if not self._is_up_to_date:
            self._show()
            self._is_up_to_date = True
        return None

    def _show(self) -> None:
        from babyrobot_levels.render.notebook.frontend import in_notebook

        if self._view is None and in_notebook():
            self._canvas().show()
        if self._view is not None:
            return
        if self._terminal is None:
            from babyrobot_levels.render.terminal import Terminal

            self._terminal = Terminal()
        terminal = self._terminal
        painter = self._text_painter(plain=not terminal.takes_unicode)
        lines = painter.lines(self._state, color=terminal.takes_color, room=terminal.room)
        terminal.show(lines, 1 / (RENDER_FPS * self._level.display.robot.speed))

    def _canvas(self) -> LevelView:
        if self._view is None:
            from babyrobot_levels.render.notebook.view import LevelView

            self._view = LevelView(self._level)
            self._view.set_overlay(self._overlay)
            self._view.move(self._state, self._pose)
        return self._view

    def _frame(self) -> NDArray[np.uint8]:
        if self._frames is None:
            from babyrobot_levels.render.frames import FramePainter

            self._frames = FramePainter(self._level, overlay=self._overlay)
        return self._frames.frame(self._state, self._pose)

    def _text_painter(self, *, plain: bool) -> TextPainter:
        if plain not in self._texts:
            from babyrobot_levels.render.text import TextPainter

            self._texts[plain] = TextPainter(self._level, plain=plain, overlay=self._overlay)
        return self._texts[plain]

    def _scene(self) -> Scene:
        from babyrobot_levels.render.scene.build import build_scene

        return build_scene(self._level, state=self._state, pose=self._pose, overlay=self._overlay)

    def svg(self) -> str:
        """Return the picture as an SVG document."""
        from babyrobot_levels.render.svg import to_svg

        return to_svg(self._scene())

    def text(self) -> str:
        """Return the picture as a text; each line ends with a newline."""
        return "\n".join([*self._text_painter(plain=False).lines(self._state), ""])

    def mimebundle(self) -> dict[str, Any]:
        """Return what a notebook shows as the last line of a cell."""
        if self._view is not None:
            return self._view.mimebundle()
        from babyrobot_levels.render.notebook.bundle import (
            MAX_CELLS,
            level_mimebundle,
            picture_mimebundle,
        )

        columns, rows = self._level.size
        if columns * rows > MAX_CELLS:
            # It says that the level is too large.
            return level_mimebundle(self._level)
        return picture_mimebundle(self._scene(), self.text().rstrip("\n"))

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the picture to a file; its suffix tells what is made.

        Raises:
            ValueError: the suffix is not one of `SUFFIXES`.
            OSError: the file cannot be written.
        """
        from babyrobot_levels.text.files import write_bytes

        file = Path(path)
        match file.suffix.lower():
            case ".svg":
                data = self.svg().encode()
            case ".txt":
                data = self.text().encode()
            case ".png":
                from babyrobot_levels.render.raster import to_png

                data = to_png(self._scene())
            case suffix:
                known = ", ".join(SUFFIXES)
                guess = did_you_mean(suffix, SUFFIXES)
                raise ValueError(f"a picture is saved as {known}, not as {suffix!r}{guess}")
        write_bytes(file, data)

    def close(self) -> None:
        """Let go of what is on the screen; a later `render` begins anew."""
        if self._view is not None:
            self._view.close()
        self._view = self._terminal = None
        self._is_up_to_date = False
