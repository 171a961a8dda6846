"""Whether the numeric half is at hand: in a browser, it is loaded only when the user asks for it.

Reading, checking, drawing, formatting and sharing need neither NumPy nor SciPy. The tables of a
level do, and all that is computed from them.
"""

import sys
from importlib.machinery import PathFinder

LIBRARIES = ("numpy", "scipy")

NEEDS_NUMPY = (
    "values, play, learning, policies and links that play need NumPy and SciPy, "
    "which are not loaded here"
)


def is_numeric() -> bool:
    """Return whether NumPy and SciPy can be imported."""
    return all(map(_is_at_hand, LIBRARIES))


def _is_at_hand(name: str) -> bool:
    if name in sys.modules:
        return sys.modules[name] is not None
    return PathFinder.find_spec(name) is not None
