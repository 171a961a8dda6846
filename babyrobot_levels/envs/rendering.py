"""Rendering of a single environment: render modes, overlays, saved pictures, notebooks."""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import gymnasium
import numpy as np
from gymnasium import logger

from babyrobot_levels.mdp.actions import Action, Turn
from babyrobot_levels.render.situation import STANDING, GoodEnds, pose_of
from babyrobot_levels.text.words import Telling, check_choice

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from babyrobot_levels.envs.spaces import ActionSet
    from babyrobot_levels.library.level import Level
    from babyrobot_levels.mdp.tables import Mdp
    from babyrobot_levels.render.frames import FramePainter
    from babyrobot_levels.render.notebook.view import LevelView
    from babyrobot_levels.render.scene.layout import Overlay
    from babyrobot_levels.render.scene.shapes import Scene
    from babyrobot_levels.render.terminal import Terminal
    from babyrobot_levels.render.text import TextPainter

RENDER_MODES = ("human", "rgb_array", "ansi", "svg", "canvas")
RENDER_FPS = 4
"""Steps per second of a robot of speed 1 in animations."""

SUFFIXES = (".svg", ".png", ".txt")
"""The file types that a picture can be saved as."""


class Pictures:
    """The pictures of one environment. Each painter is made when it is first needed.

    Args:
        mode: the environment's `render_mode`.
        level: the level that is played; its maze has a seed.
        state: the robot's state, in the numbering of the level's tables.
        heading: where a robot that turns looks, 0 north to 3 west.
        frame_size: width and height of all frames in pixels; where a picture is smaller, they are
            black. By default, those of the level's own picture.
    """

    def __init__(
        self,
        mode: str | None,
        level: Level,
        state: int,
        heading: int | None,
        frame_size: tuple[int, int] | None = None,
    ) -> None:
        self._mode, self._frame_size = mode, frame_size
        self._state, self._pose = state, STANDING.turned(heading)
        self._overlay: Overlay | None = None
        self._is_up_to_date = False
        self._enter(level)
        self._terminal: Terminal | None = None
        self._view: LevelView | None = None

    def __getstate__(self) -> dict[str, Any]:
        kept = {**vars(self), "_terminal": None, "_view": None, "_is_up_to_date": False}
        return {**kept, "_frames": None, "_texts": {}}

    def _enter(self, level: Level) -> None:
        """Go over to a level."""
        self._level = level
        self._num_cells = level.size[0] * level.size[1]
        self._good_ends = GoodEnds(level)
        self._forget_painters()

    def _forget_painters(self) -> None:
        self._frames: FramePainter | None = None
        self._texts: dict[bool, TextPainter] = {}

    # -- changes ---------------------------------------------------------------------------

    def reset(self, level: Level, state: int, heading: int | None) -> None:
        """Show the start of an episode, perhaps in another level.

        Overlays stay if the level is as large as the one before, unless they differ between its
        configurations or headings.
        """
        if level is not self._level:
            varies = self._overlay is not None and self._overlay.parts is not None
            if varies or level.size != self._level.size:
                self._overlay = None
                if self._view is not None:
                    self._view.set_overlay(None)
            self._enter(level)
            if self._view is not None:
                self._view.set_level(level, state)
        self._state, self._pose = state, STANDING.turned(heading)
        self._follow()

    def step(self, action: int, state: int, heading: int | None, skidded: bool) -> None:
        """Show the robot after a step.

        Args:
            action: the `brl.Action` that it took; for a robot that turns, the one that this
                comes to.
            state: where the action led, in the numbering of the level's tables.
            heading: where a robot that turns looks now.
            skidded: whether chance took it somewhere else.
        """
        before, cell = self._state % self._num_cells, state % self._num_cells
        ends_well = self._good_ends.are_reached(self._state, state)
        width = self._level.size[0]
        pose = pose_of(before, cell, action, width, skidded=skidded, ends_well=ends_well)
        self._state, self._pose = state, pose.turned(heading)
        self._follow()

    def show_info(self, info: Mapping[str, Any] | None) -> None:
        """Replace the overlay; None removes it.

        Raises:
            ValueError: the info is invalid, or does not fit the level.
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
        """Update what is on the screen."""
        self._is_up_to_date = False
        if self._view is not None:
            self._view.move(self._state, self._pose)
        if self._mode == "human":
            self.render()

    # -- output ----------------------------------------------------------------------------

    def render(self) -> Any:
        """Return or show the current picture."""
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
        from babyrobot_levels.render.notebook.html import in_notebook

        if self._view is None and in_notebook():
            self._canvas().show()
        if self._view is not None:
            return
        if self._terminal is None:
            from babyrobot_levels.render.terminal import Terminal

            self._terminal = Terminal()
        terminal = self._terminal
        lines = self._text_painter(plain=not terminal.takes_unicode).lines(
            self._state, heading=self._pose.heading, colors=terminal.colors, room=terminal.room
        )
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

            self._frames = FramePainter(self._level, overlay=self._overlay, room=self._frame_size)
        frame = self._frames.frame(self._state, self._pose)
        if self._frame_size is None:
            return frame
        width, height = self._frame_size
        padded = np.zeros((height, width, 3), np.uint8)
        padded[: frame.shape[0], : frame.shape[1]] = frame[:height, :width]
        return padded

    def _text_painter(self, *, plain: bool) -> TextPainter:
        if plain not in self._texts:
            from babyrobot_levels.render.text import TextPainter

            self._texts[plain] = TextPainter(self._level, plain=plain, overlay=self._overlay)
        return self._texts[plain]

    def _scene(self) -> Scene:
        from babyrobot_levels.render.scene.build import build_scene

        return build_scene(
            self._level,
            state=self._state,
            heading=self._pose.heading,
            pose=self._pose,
            overlay=self._overlay,
        )

    def svg(self) -> str:
        """Return the picture as an SVG document."""
        from babyrobot_levels.render.svg import to_svg

        return to_svg(self._scene())

    def text(self) -> str:
        """Return the picture as a text; each line ends with a newline."""
        lines = self._text_painter(plain=False).lines(self._state, heading=self._pose.heading)
        return "\n".join([*lines, ""])

    def mimebundle(self) -> dict[str, Any]:
        """Return the representations for the last line of a notebook cell."""
        if self._view is not None:
            return self._view.mimebundle()
        from babyrobot_levels.render.notebook.html import (
            is_too_large,
            level_mimebundle,
            picture_mimebundle,
        )

        if is_too_large(self._level):
            # It contains a note that the level is too large.
            return level_mimebundle(self._level)
        return picture_mimebundle(self._scene(), self.text().rstrip("\n"))

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the picture to a file of the type of its suffix.

        Raises:
            ValueError: the suffix is not one of `SUFFIXES`.
            OSError: the file cannot be written.
        """
        from babyrobot_levels.text.files import write_bytes

        file = Path(path)
        check_choice("the suffix", file.suffix.lower(), SUFFIXES)
        match file.suffix.lower():
            case ".svg":
                data = self.svg().encode()
            case ".txt":
                data = self.text().encode()
            case _:
                from babyrobot_levels.render.raster import to_png

                data = to_png(self._scene())
        write_bytes(file, data)

    def close(self) -> None:
        """Release what is on the screen; a later `render` shows it again."""
        if self._view is not None:
            self._view.close()
        self._view = self._terminal = None
        self._is_up_to_date = False


class RenderedEnv(Telling, gymnasium.Env[Any, Any]):
    """An environment with a level and a robot to render. Subclasses define `reset` and `step`.

    Painters are made when the first picture is needed: without a `render_mode`, rendering costs
    nothing.
    """

    metadata = {"render_modes": [*RENDER_MODES], "render_fps": RENDER_FPS}  # noqa: RUF012

    level: Level
    _state: int
    _starts: list[int]
    _actions: ActionSet
    _mdp: Mdp
    _pictures: Pictures | None

    def render(self) -> Any:
        """Render the current state; before the first reset, the start of an episode.

        Returns:
            Depending on `render_mode`: uint8 `[height, width, 3]` (`"rgb_array"`), a text
            (`"ansi"`), an SVG document as a text (`"svg"`), or an ipycanvas `MultiCanvas` that
            follows the episode (`"canvas"`). `"human"` returns None: every reset and step is
            shown automatically, in a notebook on such a canvas, elsewhere on standard output.
        """
        if self.render_mode is None:
            name = self.spec.id if self.spec is not None else "babyrobot/Level-v0"
            logger.warn(
                "render() needs a render_mode, given when the environment is made: "
                f'gymnasium.make("{name}", render_mode="rgb_array")'
            )
            return None
        return self._picture().render()

    def show_info(self, info: Mapping[str, Any]) -> None:
        """Show values, arrows or texts on the picture, in place of those shown before.

        Args:
            info: the overlays by kind; the page on environments lists them.

        Raises:
            ValueError: the info is invalid, or does not fit the level.
        """
        self._picture().show_info(info)

    def clear_info(self) -> None:
        """Remove what `show_info` added."""
        self._picture().show_info(None)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the current picture to a file, atomically; an existing file is overwritten.

        Args:
            path: a file with the suffix `.svg`, `.png`, or `.txt` for what `"ansi"` renders.

        Raises:
            ValueError: it has another suffix.
            OSError: the file cannot be written.
        """
        self._picture().save(path)

    def close(self) -> None:
        """Release what is on the screen; there are no other resources."""
        if self._pictures is not None:
            self._pictures.close()

    def get_keys_to_action(self) -> dict[tuple[int, ...], int]:
        """Return the action of each key for `gymnasium.utils.play.play`: arrows, W, A, S, D.

        Those of diagonal moves are 9, 3, 1 and 7, as on a keypad.
        """
        if self._actions.turns:
            numbers = {action: int(turn) for action, turn in _TURNS.items()}
        else:
            first = self._actions.first
            most = self._mdp.num_actions
            numbers = {action: action - first for action in _KEYS if first <= action < most}
        return {
            (key,): number
            for action, number in numbers.items()
            for key in (ord(_KEYS[action][0]), _KEYS[action][1])
            if key is not None
        }

    def _repr_mimebundle_(self, **_: Any) -> dict[str, Any]:
        return self._picture().mimebundle()

    def _picture(self) -> Pictures:
        """Return the pictures, which are made when they are first needed."""
        if self._pictures is None:
            self._pictures = self._new_pictures()
        return self._pictures

    def _new_pictures(self) -> Pictures:
        state = self._state if self._state >= 0 else self._starts[0]
        return Pictures(self.render_mode, self.level, *self._shown(state), self._frame_size())

    def _frame_size(self) -> tuple[int, int] | None:
        """Return width and height of all frames, in pixels; None if they are the level's own."""
        return None

    def _shown(self, state: int) -> tuple[int, int | None]:
        """Return a state in the numbering of the level's tables, and the heading if it turns."""
        mdp = self._mdp
        if mdp.headings == 1:
            return state, None
        return mdp.configuration(state) * mdp.cells + state % mdp.cells, mdp.heading(state)

    def _show_step(self, pictures: Pictures, action: int, before: int, skidded: bool) -> None:
        """Show a step to the current state.

        Args:
            pictures: the pictures.
            action: the action, as the action space numbers it.
            before: the state before the step.
            skidded: whether chance took the robot somewhere else.
        """
        if not self._actions.turns:
            taken = action + self._actions.first
        else:
            taken = Action.STAY
            if action == Turn.FORWARD:
                taken = Action.NORTH + self._mdp.heading(before)
        pictures.step(taken, *self._shown(self._state), skidded)


_KEYS = {
    Action.STAY: (" ", None),
    Action.NORTH: ("w", 0x40000052),
    Action.EAST: ("d", 0x4000004F),
    Action.SOUTH: ("s", 0x40000051),
    Action.WEST: ("a", 0x40000050),
    Action.NORTH_EAST: ("9", None),
    Action.SOUTH_EAST: ("3", None),
    Action.SOUTH_WEST: ("1", None),
    Action.NORTH_WEST: ("7", None),
}
"""The keys of actions: a character, and pygame's number of the arrow key (it is SDL's)."""


_TURNS = {Action.WEST: Turn.LEFT, Action.EAST: Turn.RIGHT, Action.NORTH: Turn.FORWARD}
"""Whose keys turn the robot, and let it go."""


def show_wrapped_environments() -> None:
    """Make IPython, if it is running, show wrapped environments as it shows unwrapped ones.

    Gymnasium's wrappers pass on no representations. IPython asks its formatters before it asks an
    object, so a formatter for wrappers is registered, unless there is one already.
    """
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython is not None else None
    if shell is not None:
        formatter = shell.display_formatter.mimebundle_formatter
        if gymnasium.Wrapper not in formatter.type_printers:
            formatter.for_type(gymnasium.Wrapper, _mimebundle)


def _mimebundle(wrapper: gymnasium.Wrapper[Any, Any, Any, Any]) -> Any:
    """Return the representations of a wrapper; with None, IPython falls back to its default."""
    own = getattr(wrapper, "_repr_mimebundle_", None)
    if own is None and isinstance(wrapper.unwrapped, RenderedEnv):
        own = wrapper.unwrapped._repr_mimebundle_
    return own() if own is not None else None
