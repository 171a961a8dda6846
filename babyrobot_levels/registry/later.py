"""What classes have of later rooms: methods, and what notebooks show of them.

A room imports no later one, so both are named as `package.module:name`, and imported when used.
"""

from __future__ import annotations

from typing import Any

from babyrobot_levels.registry.entries import resolve
from babyrobot_levels.text.words import Telling, telling


class _Later:
    """A function of a later room or module: called, or as the method of a class."""

    def __init__(self, place: str):
        self._place = place

    def __call__(self, *args: Any, **kwargs: Any) -> Any:
        return resolve(self._place)(*args, **kwargs)

    def __get__(self, instance: Any, owner: Any = None) -> Any:
        function = resolve(self._place)
        told = function if hasattr(function, "__wrapped__") else telling(function)
        return told if instance is None else told.__get__(instance, owner)


def later(place: str) -> Any:
    """Return what stands for the function at a place, also as the method of a class."""
    return _Later(place)


class Shown(Telling):
    """Shows itself as the last line of a notebook's cell; elsewhere its `repr` has to do."""

    __slots__ = ()

    def _html(self) -> str:
        """Return what a notebook shows."""
        raise NotImplementedError

    def _repr_mimebundle_(self, include: Any = None, exclude: Any = None) -> dict[str, Any]:
        return {"text/html": self._html(), "text/plain": repr(self)}
