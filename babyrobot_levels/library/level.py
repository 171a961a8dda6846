"""The level as users hold it: the validated fields, and what can be done with them."""

from __future__ import annotations

import operator
import os
import re
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pydantic import PrivateAttr

from babyrobot_levels.language.level import LevelFields
from babyrobot_levels.language.looks import BUILTIN_THEMES, Theme
from babyrobot_levels.language.plain_data import plain
from babyrobot_levels.language.walls import Maze
from babyrobot_levels.mdp.grid import Grid, build_grid
from babyrobot_levels.text.emitter import emit
from babyrobot_levels.text.errors import LevelError

if TYPE_CHECKING:
    import gymnasium

    from babyrobot_levels.mdp.tables import Mdp
    from babyrobot_levels.text.source import SourceFile


class Level(LevelFields):
    """A level: what a file says, validated and frozen.

    Its attributes are the fields of the language, with what a drawing says filled in. Levels are
    made by `brl.load`, `brl.loads`, or from the fields themselves: `Level(version=1, size=(4, 4))`.
    """

    _origin: SourceFile | None = PrivateAttr(default=None)
    _theme: Theme | None = PrivateAttr(default=None)
    _folder: Path | None = PrivateAttr(default=None)

    def remember_origin(
        self, origin: SourceFile | None, folder: Path | None, theme: Theme | None
    ) -> None:
        """Note the text and the folder that the level is from, and the theme that it names."""
        self._origin, self._folder, self._theme = origin, folder, theme

    def __hash__(self) -> int:
        # Some fields are mappings, which have none; equal levels are alike in these.
        return hash((self.name, self.title, self.size, self.start))

    def __repr__(self) -> str:
        """Return the level in short; `to_yaml` and `draw` tell all of it."""
        name = "" if self.name is None else f" {self.name!r}"
        width, height = self.size
        return f"<Level{name}: {width}x{height}>"

    __str__ = __repr__

    # -- what it comes to ------------------------------------------------------------------

    def grid(self) -> Grid:
        """Return walls and cells after the maze. The grid is made once and shared.

        Raises:
            LevelError: the maze has no seed yet (`seed: random`).
        """
        return self._grid

    def compile(self) -> Mdp:
        """Return the exact tables. They are made once, shared, and read-only.

        Raises:
            LevelError: the maze has no seed yet (`seed: random`).
        """
        return self._mdp

    @property
    def digest(self) -> str:
        """`sha256:…` of the compiled level: equal for equal games, however they are written.

        It is worked out once.

        Raises:
            LevelError: the maze has no seed yet (`seed: random`).
        """
        return self._digest

    @property
    def has_random_maze(self) -> bool:
        """Whether the level grows another maze at each reset."""
        return self.maze is not None and self.maze.seed == "random"

    @property
    def colors_and_widths(self) -> Theme:
        """The theme, also where the level only names it.

        Raises:
            LevelError: it names one that nobody knows. Levels that were loaded do not.
        """
        if self._theme is not None:
            return self._theme
        if isinstance(self.theme, Theme):
            return self.theme
        if self.theme not in BUILTIN_THEMES:
            raise LevelError(message=f"there is no theme {self.theme!r}")
        return BUILTIN_THEMES[self.theme]

    @cached_property
    def _grid(self) -> Grid:
        return build_grid(self)

    @cached_property
    def _mdp(self) -> Mdp:
        from babyrobot_levels.mdp.compiler import compile_mdp

        return compile_mdp(self, self.grid())

    @cached_property
    def _digest(self) -> str:
        from babyrobot_levels.mdp.digest import digest

        return digest(self.grid(), self.compile())

    # -- other levels ----------------------------------------------------------------------

    def replace(self, **fields: Any) -> Level:
        """Return a level with other values for some fields; None takes a field away.

        Raises:
            LevelError: the level would not be valid.
        """
        from babyrobot_levels.library.reading import from_mapping

        data = {**self.to_dict(), **fields}
        given = {name: value for name, value in data.items() if value is not None}
        name = self.name if "name" not in fields else None
        other = from_mapping(given, name=name, folder=self._folder)
        other._origin = self._origin
        return other

    def with_maze_seed(self, seed: int) -> Level:
        """Return the level with the maze that grows from `seed`.

        Raises:
            LevelError: the level has no maze, or the seed is no whole number.
        """
        if self.maze is None:
            raise LevelError(message="the level has no maze that could have a seed")
        if isinstance(seed, bool) or not hasattr(seed, "__index__"):
            raise LevelError(message=f"a maze's seed is a whole number, not {seed!r}")
        fields = {**self.maze.model_dump(exclude_unset=True), "seed": operator.index(seed)}
        maze = Maze.model_validate(fields)
        other = self.model_copy(update={"maze": maze})
        for name in ("_grid", "_mdp", "_digest"):
            other.__dict__.pop(name, None)
        return other

    def resolve(self) -> Level:
        """Return the same level with its maze written out as walls, without `maze` and `openings`.

        A level without a maze is returned as it is.

        Raises:
            LevelError: the maze has no seed yet (`seed: random`).
        """
        from babyrobot_levels.mdp.resolve import resolve

        return resolve(self)

    # -- as text ---------------------------------------------------------------------------

    def draw(self) -> str:
        """Return the level as the language's ASCII drawing. A `map` may hold what it returns.

        A drawing shows size, starts, exits, walls, puddles and blocked cells, and the characters
        of the level's legend. A cell shows one thing: a start or an exit hides a puddle.

        Raises:
            LevelError: the maze has no seed yet (`seed: random`).
        """
        from babyrobot_levels.language.drawing import compose
        from babyrobot_levels.render.text import drawing_of

        return compose(drawing_of(self, self.grid()))

    def to_dict(self, *, whole: bool = False) -> dict[str, Any]:
        """Return the level as plain data, as a file would say it: what was given, in order.

        Args:
            whole: whether to add what the file did not say itself but stood beside it, the name
                and a theme of its own, so that the data alone makes the same level.
        """
        data = plain(self.model_dump(by_alias=True, exclude_unset=True))
        if whole and self.name is not None:
            data["name"] = self.name
        if whole and self._theme is not None:
            data["theme"] = plain(self._theme)
        for field, drawn in self._drawn.items():
            # The drawing says these itself.
            if field in data:
                data[field] = data[field][drawn:]
                if not data[field]:
                    del data[field]
        return {name: data[name] for name in type(self).model_fields if name in data}

    def to_yaml(self, *, comments: bool = False) -> str:
        """Return the level as canonical YAML: fields in order, one way of writing each.

        Args:
            comments: whether a level that was loaded from a text keeps its comments and its
                layout, so that only the lines of changed fields are new.
        """
        from babyrobot_levels.text.splice import splice

        if comments and self._origin is not None:
            text = splice(self._origin.text, self.to_dict(), list(type(self).model_fields))
            if text is not None:
                return text
        return emit(self.to_dict())

    def share_code(self) -> str:
        """Return the level as a share code: one line, `brl1.…`, that `brl.load` takes.

        It holds all that the level says, its name and a theme of its own included, but no
        comments. It has a checksum, and only characters that may stand in an address.

        Raises:
            LevelError: the level is larger than a level file may be.
        """
        from babyrobot_levels.language.share_code import share_code

        return share_code(self)

    def save(self, path: str | Path) -> None:
        """Write the level to a file, whole or not at all.

        A level that was loaded from a text keeps its comments and its layout; only the lines
        of changed fields are new.
        """
        from babyrobot_levels.text.files import write_text

        write_text(Path(path), self.to_yaml(comments=True))

    # -- as a picture ----------------------------------------------------------------------

    def to_svg(self, path: str | os.PathLike[str] | None = None) -> str:
        """Return the level's picture as an SVG document.

        Args:
            path: a file to write it to as well, whole or not at all, whatever is there.

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
            path: a file to write it to as well, whole or not at all, whatever is there.

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
                `observation`, `actions`, `render_mode`, `image_size`, `grayscale`. A
                `max_episode_steps` takes the place of the level's `max_steps`, -1 of any limit.
        """
        import gymnasium

        import babyrobot_levels  # noqa: F401  (registers the environments)

        has_limit = kwargs.get("max_episode_steps") is not None
        level = self.replace(max_steps=None) if has_limit else self
        return gymnasium.make("babyrobot/Level-v0", level=level, **kwargs)


def slug(text: str) -> str | None:
    """Return a file's stem as a level's name, or None where nothing of it is left."""
    return re.sub(r"[^a-z0-9]+", "-", text.lower()).strip("-") or None
