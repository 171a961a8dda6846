"""How an environment is seen: the half of it that Gymnasium's players and notebooks ask for."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import gymnasium
from gymnasium import logger

from babyrobot_levels.envs.pictures import RENDER_FPS, RENDER_MODES, Pictures
from babyrobot_levels.envs.spaces import keys_of_actions

if TYPE_CHECKING:
    from babyrobot_levels.library.level import Level


class RenderedEnv(gymnasium.Env[Any, Any]):
    """An environment whose level and robot can be seen. What happens in it, heirs say.

    Nothing is made for pictures before there is one to show: an environment that has no
    `render_mode` steps as fast as if it could not be seen.
    """

    metadata = {"render_modes": [*RENDER_MODES], "render_fps": RENDER_FPS}  # noqa: RUF012

    level: Level
    _state: int
    _starts: list[int]
    _first_action: int
    _pictures: Pictures | None

    def render(self) -> Any:
        """Show the level as it stands; before the first reset, as an episode begins.

        Returns:
            By `render_mode`: uint8 `[height, width, 3]` (`"rgb_array"`), a text (`"ansi"`), an SVG
            document as a text (`"svg"`), or an ipycanvas `MultiCanvas`, in which the robot then
            follows the episode (`"canvas"`). `"human"` returns None: it shows every reset and
            step by itself, in a notebook as such a canvas, elsewhere on standard output.
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
        """Write on the picture, in the place of what was there: values, arrows, texts.

        Args:
            info: what to write, by its kind; see the page on environments.

        Raises:
            ValueError: the info is not understood, or does not fit the level.
        """
        self._picture().show_info(info)

    def clear_info(self) -> None:
        """Take away what `show_info` wrote."""
        self._picture().show_info(None)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the picture as it stands to a file, whole or not at all, whatever is there.

        Args:
            path: a file whose suffix is `.svg`, `.png`, or `.txt` for what `"ansi"` renders.

        Raises:
            ValueError: it has another suffix.
            OSError: the file cannot be written.
        """
        self._picture().save(path)

    def close(self) -> None:
        """Let go of what is on the screen. Nothing else is held."""
        if self._pictures is not None:
            self._pictures.close()

    def get_keys_to_action(self) -> dict[tuple[int, ...], int]:
        """Return the action of each key for `gymnasium.utils.play.play`: arrows, W, A, S, D."""
        return keys_of_actions(self._first_action)

    def _repr_mimebundle_(self, **_: Any) -> dict[str, Any]:
        return self._picture().mimebundle()

    def _picture(self) -> Pictures:
        """Return the pictures; they are made when there is something to show."""
        if self._pictures is None:
            self._pictures = self._new_pictures()
        return self._pictures

    def _new_pictures(self) -> Pictures:
        state = self._state if self._state >= 0 else self._starts[0]
        return Pictures(self.render_mode, self.level, state)
