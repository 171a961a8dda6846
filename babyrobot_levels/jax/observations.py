"""The observations of all states as arrays, from which a compiled step reads them.

They are those of the other environments, made by the same observers.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from math import prod
from typing import Any

import jax.numpy as jnp
import numpy as np
from gymnasium import spaces as gymnasium_spaces
from gymnax.environments import spaces
from jax import Array
from jax.tree_util import register_dataclass
from numpy.typing import NDArray

from babyrobot_levels.envs.observations import Observation, make_observer
from babyrobot_levels.envs.observations.extent import Extent
from babyrobot_levels.envs.observations.numbers import NUMERIC, NumericObserver
from babyrobot_levels.envs.observations.planes import PlanePainter
from babyrobot_levels.envs.observations.vectors import VectorObserver
from babyrobot_levels.envs.observations.views import ViewPainter
from babyrobot_levels.library.level import Level


@register_dataclass
@dataclass(frozen=True)
class RowTable:
    """An observation that has a row of an array for each state.

    Attributes:
        rows: `[states, …]`; of views, the bits, uint8 `[states, bytes]`.
        shape: the shape of a view; None if rows are observations.
    """

    rows: Array
    shape: tuple[int, ...] | None = field(default=None, metadata={"static": True})

    def at(self, state: Array) -> Array:
        """Return the observation of a state."""
        row = self.rows[state]
        if self.shape is None:
            return row
        return jnp.unpackbits(row, count=prod(self.shape)).reshape(self.shape)

    def take(self, level: Array, base: Array, states: int) -> RowTable:
        """Return the rows of a level, which begin at `base`."""
        rows = self.rows.at[base + jnp.arange(states)].get(mode="clip")
        return replace(self, rows=rows)


@register_dataclass
@dataclass(frozen=True)
class PlaneTables:
    """Planes in two parts: those of a configuration, to which the robot is added.

    Attributes:
        ground: int32 `[states]`: the row of `grounds`.
        robot: int32 `[states, places]`: where the robot is, as indices of flat planes.
        grounds: `[configurations, …]`: the planes without the robot.
        first_ground: int32 `[levels + 1]`: where the grounds of each level begin.
        one: what stands for 1.
        most: the most configurations of a level.
    """

    ground: Array
    robot: Array
    grounds: Array
    first_ground: Array
    one: int = field(metadata={"static": True})
    most: int = field(metadata={"static": True})

    def at(self, state: Array) -> Array:
        """Return the planes of a state."""
        planes = self.grounds[self.ground[state]]
        return planes.reshape(-1).at[self.robot[state]].set(self.one).reshape(planes.shape)

    def take(self, level: Array, base: Array, states: int) -> PlaneTables:
        """Return the planes of a level, whose states begin at `base`."""
        here, first = base + jnp.arange(states), self.first_ground[level]
        return replace(
            self,
            ground=self.ground.at[here].get(mode="clip") - first,
            robot=self.robot.at[here].get(mode="clip"),
            grounds=self.grounds.at[first + jnp.arange(self.most)].get(mode="clip"),
            first_ground=jnp.stack([jnp.zeros_like(first), self.first_ground[level + 1] - first]),
        )


@register_dataclass
@dataclass(frozen=True)
class DictTables:
    """Several observations.

    Attributes:
        parts: each of them by its name.
    """

    parts: dict[str, ObservationTables]

    def at(self, state: Array) -> dict[str, Array]:
        """Return the observations of a state."""
        return {name: part.at(state) for name, part in self.parts.items()}

    def take(self, level: Array, base: Array, states: int) -> DictTables:
        """Return the observations of a level, whose states begin at `base`."""
        return DictTables(
            {name: part.take(level, base, states) for name, part in self.parts.items()}
        )


ObservationTables = RowTable | PlaneTables | DictTables


def tables_of(
    levels: Sequence[Level], counts: Sequence[int], observation: Observation, extent: Extent
) -> ObservationTables:
    """Return the observations of all states of some levels.

    Args:
        levels: the levels.
        counts: how many states each of them has.
        observation: which observation.
        extent: the extent of all levels.
    """
    match observation.name:
        case tuple():
            parts = observation.parts().items()
            made = {name: tables_of(levels, counts, part, extent) for name, part in parts}
            return DictTables(made)
        case "planes":
            return _planes(levels, counts, observation, extent)
        case "view":
            return _views(levels, counts, observation, extent)
        case "vector":
            rows = [VectorObserver(level, extent).table() for level in levels]
            return RowTable(jnp.asarray(np.concatenate(rows)))
        case "image":
            return _images(levels, counts, observation, extent)
        case name:
            assert name in NUMERIC
            numbers = np.concatenate(
                [NumericObserver(each, name, extent).table() for each in levels]
            )
            column = numbers[:, 0] if name == "index" else numbers
            return RowTable(jnp.asarray(column, jnp.int32))


def _planes(
    levels: Sequence[Level], counts: Sequence[int], observation: Observation, extent: Extent
) -> PlaneTables:
    painters = [PlanePainter(level, extent, observation.plane_form) for level in levels]
    configurations = [
        count // painter.states for count, painter in zip(counts, painters, strict=True)
    ]
    first = np.cumsum([0, *configurations])
    grounds, rows, robots = [], [], []
    for painter, count, base in zip(painters, counts, first.tolist(), strict=False):
        grounds += [painter.ground(number) for number in range(count // painter.states)]
        states = np.arange(count)
        rows.append(base + states // painter.states)
        robots.append(painter.robot(states))
    return PlaneTables(
        ground=jnp.asarray(np.concatenate(rows), jnp.int32),
        robot=jnp.asarray(np.concatenate(robots), jnp.int32),
        grounds=jnp.asarray(np.stack(grounds)),
        first_ground=jnp.asarray(first, jnp.int32),
        one=observation.plane_form.one,
        most=max(configurations),
    )


def _views(
    levels: Sequence[Level], counts: Sequence[int], observation: Observation, extent: Extent
) -> RowTable:
    bits: list[NDArray[np.uint8]] = []
    shape: tuple[int, ...] = ()
    for level, count in zip(levels, counts, strict=True):
        painter = ViewPainter(
            level, extent.headings, observation.view_radius, observation.see_through
        )
        for state in range(count):
            view = painter.view(state)
            shape = view.shape
            bits.append(np.packbits(view))
    return RowTable(jnp.asarray(np.stack(bits)), shape)


def _images(
    levels: Sequence[Level], counts: Sequence[int], observation: Observation, extent: Extent
) -> RowTable:
    observers = [make_observer(level, observation, extent) for level in levels]
    return RowTable(
        jnp.asarray(
            np.stack(
                [
                    observer.at(state)()
                    for observer, count in zip(observers, counts, strict=True)
                    for state in range(count)
                ]
            )
        )
    )


def gymnax_space(space: gymnasium_spaces.Space[Any]) -> spaces.Space:
    """Return a space of Gymnasium as one of gymnax."""
    match space:
        case gymnasium_spaces.Discrete():
            return spaces.Discrete(int(space.n))
        case gymnasium_spaces.MultiDiscrete():
            return spaces.Box(0, np.asarray(space.nvec) - 1, space.shape, jnp.int32)
        case gymnasium_spaces.Box():
            return spaces.Box(space.low.flat[0], space.high.flat[0], space.shape, space.dtype)
        case gymnasium_spaces.Dict():
            return spaces.Dict({name: gymnax_space(each) for name, each in space.items()})
    raise NotImplementedError(f"gymnax has no space like {space}")
