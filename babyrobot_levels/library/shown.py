"""What asks later rooms for pictures: they are named here, but what they show may be solved."""

from __future__ import annotations

from pkgutil import resolve_name
from typing import Any


def later(name: str) -> Any:
    """Return a module or function of `analysis`.

    Users look for pictures in the methods of what is to be seen, but what a picture shows may have
    to be solved, and solving belongs to a later room. So it is named, as an entry point is.
    """
    return resolve_name(f"babyrobot_levels.analysis.{name}")


class Shown:
    """Shows itself as the last line of a notebook's cell; elsewhere its `repr` has to do."""

    __slots__ = ()

    def _repr_mimebundle_(self, include: Any = None, exclude: Any = None) -> dict[str, Any]:
        bundle: dict[str, Any] = later("shown:bundle_of")(self)
        return bundle
