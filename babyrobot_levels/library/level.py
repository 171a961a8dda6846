"""The level as users hold it: the validated fields, and what can be done with them."""

from __future__ import annotations

import os
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from babyrobot_levels.language.documents import level_from_mapping
from babyrobot_levels.language.looks import Theme
from babyrobot_levels.mdp.gridworld import GridWorld

if TYPE_CHECKING:
    import gymnasium


class Level(GridWorld):
    """A level: the contents of a level file, validated and frozen.

    Its attributes are the fields of the language, with what a drawing gives filled in. Levels are
    made by `brl.load`, `brl.loads`, or from the fields themselves: `Level(version=1, size=(4, 4))`.
    """

    __module__ = "babyrobot_levels"

    @classmethod
    def from_fields(
        cls, fields: Mapping[str, Any], *, name: str | None = None, folder: Path | None = None
    ) -> Level:
        """Return the level that a mapping of the language's fields gives.

        Args:
            fields: the fields. NumPy's numbers and arrays, tuples and models are taken too.
            name: the level's name, if the mapping gives none.
            folder: where `themes/` may stand.

        Raises:
            LevelError: the mapping is not a valid level. The diagnostics point into the mapping
                as it would be written in a file.
        """
        level = level_from_mapping(fields, cls, name=name, folder=folder)
        if level.stands_on_grid and not level.has_random_maze:
            from babyrobot_levels.language.documents import error_in_mapping
            from babyrobot_levels.mdp.placement import placement_issues

            issues = placement_issues(level, level.grid())
            if issues:
                raise error_in_mapping(fields, issues)
        return level

    def __hash__(self) -> int:
        # Some fields are mappings, which have none; equal levels are alike in these.
        return hash((self.name, self.title, self.size, self.start))

    def __repr__(self) -> str:
        """Return the level in short; `to_yaml` and `draw` show all of it."""
        name = "" if self.name is None else f" {self.name!r}"
        width, height = self.size
        return f"<Level{name}: {width}x{height}>"

    __str__ = __repr__

    @property
    def colors_and_widths(self) -> Theme:
        """The former name of `resolved_theme`. Deprecated."""
        warnings.warn(
            "Level.colors_and_widths is deprecated; use Level.resolved_theme",
            DeprecationWarning,
            stacklevel=2,
        )
        return self.resolved_theme

    # -- other levels ----------------------------------------------------------------------

    def replace(self, **fields: Any) -> Level:
        """Return a level with other values for some fields; None removes a field.

        Raises:
            LevelError: the level would not be valid.
        """
        data = {**self.to_dict(), **fields}
        given = {name: value for name, value in data.items() if value is not None}
        name = self.name if "name" not in fields else None
        other = self.from_fields(given, name=name, folder=self._folder)
        other._origin = self._origin
        return other

    def resolve(self) -> Level:
        """Return the same level with its maze written out as walls, without `maze` and `openings`.

        A level without a maze is returned as it is.

        Raises:
            LevelError: the maze has no seed yet (`seed: random`).
        """
        from babyrobot_levels.mdp.drawn import resolved_fields

        if self.maze is None:
            return self
        return self.replace(**resolved_fields(self, self.grid()))

    # -- as text ---------------------------------------------------------------------------

    def share_code(self) -> str:
        """Return the level as a share code: one line, `brl1.…`, that `brl.load` takes.

        It holds all fields, the name and a theme of the level's own included, but no comments.
        It has a checksum, and only characters that may stand in an address.

        Raises:
            LevelError: the level is larger than a level file may be.
        """
        from babyrobot_levels.language.share_code import encode

        return encode(self.to_dict(whole=True))

    def save(self, path: str | Path) -> None:
        """Write the level to a file, atomically.

        A level that was loaded from a text keeps its comments and its layout; only the lines
        of changed fields are new.
        """
        from babyrobot_levels.text.files import write_text

        write_text(Path(path), self.to_yaml(comments=True))

    # -- as a picture ----------------------------------------------------------------------

    def to_svg(self, path: str | os.PathLike[str] | None = None) -> str:
        """Return the level's picture as an SVG document.

        Args:
            path: a file to write it to as well, atomically; an existing one is replaced.

        Raises:
            LevelError: the maze has no seed yet (`seed: random`).
        """
        from babyrobot_levels.render.scene.build import build_scene
        from babyrobot_levels.render.svg import to_svg
        from babyrobot_levels.text.files import write_text

        picture = to_svg(build_scene(self))
        if path is not None:
            write_text(Path(path), picture)
        return picture

    def to_png(self, path: str | os.PathLike[str] | None = None) -> bytes:
        """Return the level's picture as a PNG file, 64 pixels a cell.

        Of large levels a cell has fewer pixels: no side of the picture has more than 4,000.

        Args:
            path: a file to write it to as well, atomically; an existing one is replaced.

        Raises:
            LevelError: the maze has no seed yet (`seed: random`).
        """
        from babyrobot_levels.render.raster import to_png
        from babyrobot_levels.render.scene.build import build_scene
        from babyrobot_levels.text.files import write_bytes

        picture = to_png(build_scene(self))
        if path is not None:
            write_bytes(Path(path), picture)
        return picture

    def _repr_mimebundle_(self, include: Any = None, exclude: Any = None) -> dict[str, Any]:
        from babyrobot_levels.render.notebook.bundle import level_mimebundle

        return level_mimebundle(self)

    # -- as an environment -----------------------------------------------------------------

    def make(self, **kwargs: Any) -> gymnasium.Env[Any, Any]:
        """Return the level as a Gymnasium environment; `max_steps` becomes its time limit.

        Args:
            kwargs: what `gymnasium.make("babyrobot/Level-v0", …)` takes beside `level`:
                `observation`, `actions`, `render_mode`, `image_size`, `grayscale`, `view_radius`,
                `see_through`, `channels_last`, `planes_dtype`. A `max_episode_steps` takes the
                place of the level's `max_steps`, -1 of any limit.
        """
        import gymnasium

        return gymnasium.make("babyrobot/Level-v0", level=self, **kwargs)
