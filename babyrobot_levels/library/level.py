"""The level as users hold it: the validated fields, and what can be done with them."""

from __future__ import annotations

import os
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from pydantic import ValidationError

from babyrobot_levels.analysis import pictures
from babyrobot_levels.analysis.environments import make
from babyrobot_levels.mdp.gridworld import GridWorld

if TYPE_CHECKING:
    import gymnasium

    from babyrobot_levels.analysis.facts import Facts
    from babyrobot_levels.analysis.previews import Preview
    from babyrobot_levels.analysis.solver.results import Solution

Made = TypeVar("Made", str, bytes)


class Level(GridWorld):
    """A level: the contents of a level file, validated and frozen.

    Its attributes are the fields of the language, with what a drawing gives filled in. Levels are
    made by `brl.load`, `brl.loads`, or from the fields themselves: `Level(version=1, size=(4, 4))`.
    """

    __module__ = "babyrobot_levels"

    if not TYPE_CHECKING:

        def __init__(self, **fields: Any) -> None:
            with suppress(ValidationError):
                super().__init__(**fields)
                return
            # Tells what is wrong as of a file; NumPy's numbers and other levels' parts are right.
            checked = type(self).from_fields(fields)
            super().__init__(**checked.to_dict())

        # pydantic would call it for the levels that it makes, too.
        __init__.__pydantic_base_init__ = True

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
    def width(self) -> int:
        """The number of columns."""
        return self.size[0]

    @property
    def height(self) -> int:
        """The number of rows."""
        return self.size[1]

    # -- what it comes to ------------------------------------------------------------------

    def solve(self, discount: float | None = None, **options: Any) -> Solution:
        """Return an optimal policy and its values; see `brl.solve` for arguments and errors."""
        from babyrobot_levels.analysis.solver.optimum import solve

        return solve(self, discount, **options)

    def show(self) -> Facts:
        """Return the facts about the level: texts, numbers, digest, metrics; see `brl.show`."""
        from babyrobot_levels.analysis.facts import show

        return show(self)

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

    def to_svg(
        self,
        path: str | os.PathLike[str] | None = None,
        *,
        values: Any = None,
        policy: Any = None,
        action_values: Any = None,
        visits: Any = None,
        coordinates: bool | None = None,
        theme: Any = None,
        held: str | Iterable[str] | None = None,
        rules: bool = False,
        scale: float | None = None,
    ) -> str:
        """Return the level's picture as an SVG document, as `babyrobot preview` makes it.

        With values, actions or counts, the robot is left out, and terminal states show none.

        Args:
            path: a file to write it to as well, atomically; an existing one is replaced.
            values: what cells show: True for the optimal values, a `Solution`, an `Evaluation` or
                a `Sweep` for theirs, or an array as `show_info` takes it.
            policy: the same for actions; `"best"` means True.
            action_values: the same for the values of actions.
            visits: counts of visits, as `show_info` takes them.
            coordinates: whether cells show their coordinates; by default, what the level says.
            theme: another theme: a name, or a mapping as in a level file.
            held: the names of the items that are held and the switches that are on; `"nothing"`
                or an empty list for none. By default, the level is shown as a whole, with values
                and actions where episodes begin.
            rules: whether the rules of the level are shown: in its panel, or below the picture.
            scale: the size; 1, the default, is 64 pixels per cell.

        Raises:
            LevelError: the maze has no seed yet (`seed: random`), or there is no such theme.
            UndefinedReturnError: the level has no solution that could be shown.
            ValueError: another argument does not fit the level.
        """
        picture: str = pictures.to_svg(
            self,
            values=values,
            policy=policy,
            action_values=action_values,
            visits=visits,
            coordinates=coordinates,
            theme=theme,
            held=held,
            rules=rules,
            scale=scale,
        )
        return _saved(picture, path)

    def to_pdf(
        self,
        path: str | os.PathLike[str] | None = None,
        *,
        values: Any = None,
        policy: Any = None,
        action_values: Any = None,
        visits: Any = None,
        coordinates: bool | None = None,
        theme: Any = None,
        held: str | Iterable[str] | None = None,
        rules: bool = False,
        scale: float | None = None,
    ) -> bytes:
        """Return the level's picture as a PDF file of one page, as `babyrobot preview` makes it.

        Args and errors are those of `to_svg`; a `scale` of 1 is 48 points per cell.
        """
        picture: bytes = pictures.to_pdf(
            self,
            values=values,
            policy=policy,
            action_values=action_values,
            visits=visits,
            coordinates=coordinates,
            theme=theme,
            held=held,
            rules=rules,
            scale=scale,
        )
        return _saved(picture, path)

    def to_png(
        self,
        path: str | os.PathLike[str] | None = None,
        *,
        values: Any = None,
        policy: Any = None,
        action_values: Any = None,
        visits: Any = None,
        coordinates: bool | None = None,
        theme: Any = None,
        held: str | Iterable[str] | None = None,
        rules: bool = False,
        scale: float | None = None,
    ) -> bytes:
        """Return the level's picture as a PNG file, as `babyrobot preview` makes it.

        Args and errors are those of `to_svg`. Without a `scale`, a cell has 64 pixels, and fewer in
        large levels: no side of the picture has more than 4,000.
        """
        picture: bytes = pictures.to_png(
            self,
            values=values,
            policy=policy,
            action_values=action_values,
            visits=visits,
            coordinates=coordinates,
            theme=theme,
            held=held,
            rules=rules,
            scale=scale,
        )
        return _saved(picture, path)

    def to_gif(
        self,
        path: str | os.PathLike[str] | None = None,
        *,
        policy: Any = "best",
        seed: int = 0,
        values: Any = None,
        coordinates: bool | None = None,
        theme: Any = None,
        rules: bool = False,
        scale: float | None = None,
    ) -> bytes:
        """Return an episode as an animated GIF, as `babyrobot preview` makes it.

        It is cut after 500 steps, with a warning.

        Args:
            path: a file to write it to as well, atomically; an existing one is replaced.
            policy: the policy that is followed: `"best"`, `"random"`, a `Solution`, an array, or
                what else `evaluate` takes, of a robot that does not turn.
            seed: the random seed; it is the same episode as after `env.reset(seed=…)`.
            values: what cells show below the robot; see `to_svg`.
            coordinates: whether cells show their coordinates; by default, what the level says.
            theme: another theme: a name, or a mapping as in a level file.
            rules: whether the rules of the level are shown below the film.
            scale: the size; 1 is 64 pixels per cell. By default it is the largest up to 1 with
                which no side has more than 800 pixels.

        Raises:
            LevelError: the maze has no seed yet (`seed: random`), or there is no such theme.
            UndefinedReturnError: the level has no solution that could be followed or shown.
            ValueError: another argument does not fit the level, or the film is too large.
        """
        film: bytes = pictures.to_gif(
            self,
            policy=policy,
            seed=seed,
            values=values,
            coordinates=coordinates,
            theme=theme,
            rules=rules,
            scale=scale,
        )
        return _saved(film, path)

    def to_html(
        self,
        path: str | os.PathLike[str] | None = None,
        *,
        values: bool = False,
        policy: str | bool | None = None,
        seed: int = 0,
        coordinates: bool | None = None,
        theme: Any = None,
        answers: bool = True,
    ) -> str:
        """Return a page on which the level can be played, as `babyrobot preview` makes it.

        Args:
            path: a file to write it to as well, atomically; an existing one is replaced.
            values: whether optimal values are shown at first.
            policy: the policy that can be watched, `"best"` or `"random"`. By default it is the
                best one; with `"best"` or True, optimal actions are shown at first.
            seed: the random seed of the first episode.
            coordinates: whether cells show their coordinates; by default, what the level says.
            theme: another theme: a name, or a mapping as in a level file.
            answers: whether the page knows the solution: values, optimal actions, hints, and how
                good a return is. With False, nothing of it is in the page.

        Raises:
            LevelError: the maze has no seed yet (`seed: random`), or there is no such theme.
            UndefinedReturnError: the level has no solution that could be shown.
            ValueError: the level is too large for a page, there is no such policy, or answers are
                to be shown without answers.
        """
        page: str = pictures.to_html(
            self,
            values=values,
            policy=policy,
            seed=seed,
            coordinates=coordinates,
            theme=theme,
            answers=answers,
        )
        return _saved(page, path)

    def preview(self, path: str | os.PathLike[str] | None = None, **shown: Any) -> Preview:
        """Return a picture, a film or a page; see `brl.preview` for arguments and errors."""
        from babyrobot_levels.analysis.previews import preview

        return preview(self, path, **shown)

    def play(self, path: str | os.PathLike[str] | None = None, **shown: Any) -> Preview:
        """Return a page on which the level can be played; see `brl.play`."""
        from babyrobot_levels.analysis.previews import play

        return play(self, path, **shown)

    def _repr_mimebundle_(self, include: Any = None, exclude: Any = None) -> dict[str, Any]:
        from babyrobot_levels.render.notebook.html import level_mimebundle

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
        return make(self, **kwargs)


def _saved(made: Made, path: str | os.PathLike[str] | None) -> Made:
    """Write what was made to a file, if one is given, and return it."""
    from babyrobot_levels.text.files import write_bytes

    if path is not None:
        write_bytes(Path(path), made.encode("utf-8") if isinstance(made, str) else made)
    return made
