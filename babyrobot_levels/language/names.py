"""Names of levels, suites and packs: their form, and those of files."""

import re
from collections.abc import Iterator
from itertools import count

SLUG = r"^[a-z0-9]+(-[a-z0-9]+)*$"
_NUMBER = r"(0|[1-9][0-9]{0,8})"
FUNCTION = r"^[a-z][a-z0-9_]*$"
VERSION = rf"^{_NUMBER}\.{_NUMBER}\.{_NUMBER}$"


def slug(text: str) -> str | None:
    """Return a file's stem as a level's name, or None where nothing of it is left."""
    return re.sub(r"[^a-z0-9]+", "-", text.lower()).strip("-") or None


def numbered(name: str, joint: str = "-") -> Iterator[str]:
    """Yield a name, and then the same with the numbers from 2 on: `maze`, `maze-2`, `maze-3`."""
    yield name
    yield from (f"{name}{joint}{number}" for number in count(2))
