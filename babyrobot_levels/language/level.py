"""The level of a document: its fields, what its drawing adds, its theme, and its text."""

from pathlib import Path
from typing import Any, Self

from pydantic import PrivateAttr, model_validator

from babyrobot_levels.language.checks import issues_of
from babyrobot_levels.language.drawing import Drawing
from babyrobot_levels.language.expectations import decimals_in
from babyrobot_levels.language.fields import LevelFields
from babyrobot_levels.language.looks import BUILTIN_THEMES, Theme
from babyrobot_levels.language.plain_data import plain
from babyrobot_levels.text.diagnostics import Issue
from babyrobot_levels.text.document import Document
from babyrobot_levels.text.emitter import Figure, emit
from babyrobot_levels.text.errors import InvalidDocument, LevelError
from babyrobot_levels.text.source import SourceFile


class LevelSpec(LevelFields):
    """A valid level: its fields, with those that a drawing gives filled in."""

    _origin: SourceFile | None = PrivateAttr(default=None)
    _folder: Path | None = PrivateAttr(default=None)
    _theme: Theme | None = PrivateAttr(default=None)
    _drawing: Drawing | None = PrivateAttr(default=None)

    @model_validator(mode="after")
    def _complete(self) -> Self:
        """Fill in what the drawing gives, and check what only the whole level shows."""
        issues: list[Issue] = []
        if self.map is not None or "legend" in self.model_fields_set:
            from babyrobot_levels.language.map import expand_map

            drawn, issues = expand_map(self)
            if drawn is not None:
                self._drawing = drawn.drawing
                self._drawn.update(drawn.counts)
                # The model is frozen for its users; these fields are the drawing's own.
                self.__dict__.update(drawn.fields)
        elif not ("exit" in self.model_fields_set or self.exit_one_of or self.targets) and (
            not self.robots or any(robot.exit is None for robot in self.robots)
        ):
            self.__dict__["exit"] = (self.size[0] - 1, self.size[1] - 1)
        issues = issues or issues_of(self)
        if issues:
            raise InvalidDocument(issues)
        return self

    def remember_origin(
        self, origin: SourceFile | None, folder: Path | None, theme: Theme | None
    ) -> None:
        """Note the text and the folder that the level is from, and the theme that it names."""
        self._origin, self._folder, self._theme = origin, folder, theme

    @property
    def drawing(self) -> Drawing | None:
        """What `map` shows, None for a level that is not drawn."""
        return self._drawing

    @property
    def has_random_maze(self) -> bool:
        """Whether each reset of an environment grows another maze."""
        return self.maze is not None and self.maze.seed == "random"

    @property
    def resolved_theme(self) -> Theme:
        """The theme with its colours and widths, also where the level only names it.

        Raises:
            LevelError: the level names an unknown theme. Levels that were loaded do not.
        """
        if self._theme is not None:
            theme = self._theme
        elif isinstance(self.theme, Theme):
            theme = self.theme
        elif self.theme in BUILTIN_THEMES:
            theme = BUILTIN_THEMES[self.theme]
        else:
            raise LevelError(message=f"unknown theme {self.theme!r}")
        first = self.robots[0].color if self.robots else None
        return theme if first is None else theme.with_robot(first)

    def to_dict(self, *, whole: bool = False) -> dict[str, Any]:
        """Return the level as plain data, as in a file: the fields that were given, in order.

        Args:
            whole: whether to add what stood beside the file, its name and a theme of its own, so
                that the data alone make the same level.
        """
        data = plain(self.model_dump(by_alias=True, exclude_unset=True))
        if whole and self.name is not None:
            data["name"] = self.name
        if whole and self._theme is not None:
            data["theme"] = plain(self._theme)
        for name, decimals in self.stated_decimals().items():
            # It says how exact the figure is.
            data["expect"][name] = Figure(f"{data['expect'][name]:.{decimals}f}")
        for field, drawn in self._drawn.items():
            # The drawing gives these itself.
            if field in data:
                data[field] = data[field][drawn:]
                if not data[field]:
                    del data[field]
        return {name: data[name] for name in type(self).model_fields if name in data}

    def stated_decimals(self, document: Document | None = None) -> dict[str, int]:
        """Return with how many decimals the figures in `expect` are written, by their names.

        Args:
            document: the text of the level; by default it is read again, if there is one.
        """
        stated = {} if self.expect is None else self.expect.stated
        if stated and document is None and self._origin is not None:
            from babyrobot_levels.text.reader import read

            document = read(self._origin)
        return {
            name: decimals_in(document, name, value)
            for name, value in stated.items()
            if isinstance(value, float)
        }

    def to_yaml(self, *, comments: bool = False) -> str:
        """Return the level as canonical YAML: fields in order, each in one form.

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
