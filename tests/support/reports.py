"""The reports of faulty files, as a user gets to read them."""

from __future__ import annotations

from pathlib import Path

from babyrobot_levels.diagnostics import Diagnostic
from babyrobot_levels.files import ReadFault, read_source
from babyrobot_levels.level import Level
from babyrobot_levels.reading import read_level

LEVELS = Path(__file__).parents[1] / "levels"
GOOD = sorted((LEVELS / "good").glob("*.yaml"))
BAD = sorted((LEVELS / "bad").glob("*.yaml"))


def read(path: Path) -> tuple[Level | None, list[Diagnostic]]:
    """Read a level file under its bare name, so that reports do not speak of this machine."""
    try:
        return read_level(read_source(path, path.name))
    except ReadFault as fault:
        return None, [fault.diagnostic]


def report(path: Path) -> str:
    """Return all that is said about a file, ending with a line end."""
    return "\n\n".join(map(str, read(path)[1])) + "\n"
