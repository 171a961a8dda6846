"""The exceptions of the library, all `BabyRobotError`s, and how to install what is missing."""

from __future__ import annotations

import re
import sys
import warnings
from collections.abc import Iterable, Sequence
from pathlib import Path
from types import FrameType

from babyrobot_levels.text.diagnostics import Diagnostic, Issue
from babyrobot_levels.text.words import Public, no_file


class BabyRobotError(Public, Exception, public=True):
    """The root of this library's exceptions."""

    def _render_traceback_(self) -> list[str]:
        """Return what IPython shows: the line that called, and the message."""
        import traceback

        ours = (str(Path(__file__).parents[1]), "site-packages")
        frames = traceback.extract_tb(self.__traceback__)
        callers = [frame for frame in frames if not any(each in frame.filename for each in ours)]
        return [*traceback.format_list(callers[-1:]), f"{type(self).__name__}: {self}"]


class HelpfulError(BabyRobotError):
    """An error whose `help` says what to do, if that is known."""

    def __init__(self, message: str, help_text: str | None = None):
        self.help = help_text
        super().__init__(message, help_text)

    def __str__(self) -> str:
        return str(self.args[0])


class LevelError(BabyRobotError, ValueError, public=True):
    """A level that cannot be used. Carries the `diagnostics` and prints them.

    Raised by everything that reads a level. `diagnostics` is empty where the level came from
    Python and has no text to point at; the message is then complete by itself.
    """

    def __init__(self, diagnostics: Iterable[Diagnostic] = (), message: str | None = None):
        self.diagnostics = tuple(diagnostics)
        self.message = message
        super().__init__(str(self))

    def __str__(self) -> str:
        return self.shown()

    def shown(self, width: int | None = None) -> str:
        """Return the message as `str` does, its source lines cut to the width of a terminal."""
        parts = [self.message] if self.message else []
        if self.diagnostics and not self.message:
            count = len(self.diagnostics)
            parts.append(f"{count} error{'s' if count != 1 else ''}")
        parts += [diagnostic.shown(width) for diagnostic in self.diagnostics]
        return "\n\n".join(parts) or "the level cannot be used"

    def __reduce__(self) -> tuple[type[LevelError], tuple[tuple[Diagnostic, ...], str | None]]:
        return type(self), (self.diagnostics, self.message)


class RandomMazeError(LevelError, public=True):
    """A level grows another maze at each reset: there is not one that could be looked at."""


class UnplayableError(LevelError, public=True):
    """A level whose tables cannot be made: a door stands on a wall, or there are too many states.

    `issues` are the errors, which point to fields; messages show all of them.
    """

    def __init__(self, issues: Iterable[Issue]):
        self.issues = tuple(issues)
        super().__init__(message="\n".join(f"{each.code}: {each.message}" for each in self.issues))

    def __reduce__(self) -> tuple[type[UnplayableError], tuple[tuple[Issue, ...]]]:  # type: ignore[override]
        return type(self), (self.issues,)


class InvalidDocument(ValueError):
    """Issues on their way through a pydantic validator, which lets only a `ValueError` pass."""

    def __init__(self, issues: Iterable[Issue]):
        self.issues = tuple(issues)
        super().__init__("; ".join(issue.message for issue in self.issues))


class LevelNotFoundError(BabyRobotError, LookupError, public=True):
    """No level has that name. `name` is what was asked for, `nearest` are the likeliest ones."""

    what = "level"
    listing = "babyrobot list"

    def __init__(
        self, name: str, nearest: Sequence[str] = (), is_file: bool = False, help_text: str = ""
    ):
        self.name = name
        self.nearest = tuple(nearest)
        self.is_file = is_file
        self.help_text = help_text
        super().__init__(name, self.nearest, is_file, help_text)

    def __str__(self) -> str:
        name = self.name if len(self.name) <= 100 else self.name[:99] + "…"
        what = "file" if self.is_file else f"{self.what} called"
        text = f"there is no {what} {name!r}"
        if self.help_text:
            return f"{text}; {self.help_text}"
        text += no_file(name, [*map(repr, self.nearest)])
        return text if self.is_file else text + f" (`{self.listing}` shows all {self.what}s)"


class SuiteNotFoundError(LevelNotFoundError, public=True):
    """No suite has that name."""

    what = "suite"
    listing = "babyrobot list --suites"


class FolderError(HelpfulError, public=True):
    """A folder holds files that must not be overwritten. `help` says what to do."""


def warn(text: str, category: type[Warning] = UserWarning) -> None:
    """Warn of something; the warning names the line that called this package."""
    package, depth = __name__.partition(".")[0], 0
    frame: FrameType | None = sys._getframe()
    while frame is not None and frame.f_globals["__name__"].partition(".")[0] == package:
        frame, depth = frame.f_back, depth + 1
    warnings.warn(text, category, stacklevel=depth + 1)


DISTRIBUTION = "babyrobot-levels"


def how_to_install(extra: str) -> str:
    """Return how to install what an extra brings, as it works wherever the package is from.

    The command names the packages themselves: only an index that has this distribution could find
    them by the extra's name.
    """
    from importlib.metadata import PackageNotFoundError, requires

    try:
        required = requires(DISTRIBUTION) or []
    except PackageNotFoundError:
        required = []
    wanted = re.compile(rf"""(.*?) *;.*\bextra == ["']{extra}["']""")
    packages = [found[1] for each in required if (found := wanted.fullmatch(each))]
    named = " ".join(f'"{package}"' for package in packages or [f".[{extra}]"])
    return f"install the extra `{extra}`: pip install {named}"
