"""Observations: each kind is defined once, as a space and as what every state of a level shows.

All environments use these definitions: single and vector ones, both stepping engines, and the
adapter for Stable-Baselines3. Levels that share a space share the one of their `Extent`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any, Protocol

from gymnasium import spaces

from babyrobot_levels.envs.observations.extent import Extent
from babyrobot_levels.envs.observations.images import ImageObserver
from babyrobot_levels.envs.observations.numbers import NUMERIC, NumericObserver
from babyrobot_levels.envs.observations.planes import PlaneForm, PlaneObserver
from babyrobot_levels.envs.observations.vectors import VectorObserver
from babyrobot_levels.envs.observations.views import DEFAULT_RADIUS, ViewObserver
from babyrobot_levels.library.level import Level

OBSERVATIONS = (*NUMERIC, "vector", "planes", "image", "view")
"""The names of all observations."""


@dataclass(frozen=True, slots=True)
class Observation:
    """An observation that was chosen, with its options.

    Attributes:
        name: one of `OBSERVATIONS`, or a tuple of several: a dict with each of them.
        image_size: `(height, width)` in pixels of images, None for the default.
        grayscale: whether images are grey.
        view_radius: how many cells a view shows in each direction.
        see_through: whether a view shows what walls, doors and blocked cells hide.
        plane_form: the form of planes.
    """

    name: str | tuple[str, ...] = "position"
    image_size: tuple[int, int] | None = None
    grayscale: bool = False
    view_radius: int = DEFAULT_RADIUS
    see_through: bool = False
    plane_form: PlaneForm = field(default_factory=PlaneForm)

    def parts(self) -> dict[str, Observation]:
        """Return each of several observations by its name."""
        return {name: replace(self, name=name) for name in self.name}


class Observer(Protocol):
    """Makes the observations of one level."""

    @property
    def space(self) -> spaces.Space[Any]:
        """The space of the observations."""

    def at(self, state: int) -> Callable[[], Any]:
        """Return a function that makes a new observation of the state at each call.

        With turning, the state is one of `Mdp.turning`, which has a heading.
        """


class DictObserver:
    """Makes dicts of several observations of one level, in the order of their names."""

    def __init__(self, observers: dict[str, Observer]) -> None:
        self.space = spaces.Dict({name: each.space for name, each in observers.items()})
        self._observers = {name: observers[name] for name in self.space}

    def at(self, state: int) -> Callable[[], Any]:
        """Return a function that makes a new dict of new observations."""
        return partial(_made, {name: each.at(state) for name, each in self._observers.items()})


def _made(makers: dict[str, Callable[[], Any]]) -> dict[str, Any]:
    return {name: make() for name, make in makers.items()}


def make_observer(level: Level, observation: Observation, extent: Extent) -> Observer:
    """Return the observer of a level, in the space that the levels of an extent share."""
    match observation.name:
        case tuple():
            parts = observation.parts().items()
            return DictObserver({name: make_observer(level, part, extent) for name, part in parts})
        case "image":
            return ImageObserver(level, extent, observation.image_size, observation.grayscale)
        case "view":
            return ViewObserver(level, extent, observation.view_radius, observation.see_through)
        case "planes":
            return PlaneObserver(level, extent, observation.plane_form)
        case "vector":
            return VectorObserver(level, extent)
        case name:
            return NumericObserver(level, name, extent)
