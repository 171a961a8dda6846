"""The extras of this distribution, and how to install one."""

from __future__ import annotations

import re

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
