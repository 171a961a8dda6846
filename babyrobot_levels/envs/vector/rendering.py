"""How a vector environment is seen: its pictures, its attributes, and how it was made."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from gymnasium import logger
from gymnasium.vector import AutoresetMode, VectorEnv

from babyrobot_levels.envs.arguments import check_choice
from babyrobot_levels.envs.vector.observations import largest_of
from babyrobot_levels.envs.vector.pictures import Tiles

if TYPE_CHECKING:
    from gymnasium.envs.registration import EnvSpec

    from babyrobot_levels.envs.engine.robots import Robots
    from babyrobot_levels.envs.engine.tables import Tables
    from babyrobot_levels.envs.vector.slots import Slots
    from babyrobot_levels.library.level import Level


SETTABLE = ("np_random", "render_mode")
"""The attributes that `set_attr` sets: nothing that is made depends on them."""


class RenderedVectorEnv(VectorEnv[Any, Any, Any]):
    """Many robots that can be seen. What happens to them, heirs say."""

    levels: Sequence[Level]
    _playing: Sequence[Level | None]
    _slots: Slots | None = None
    _robots: Robots
    _tables: Tables
    _mode: AutoresetMode
    _tiles: Tiles | None = None
    _spec: EnvSpec | None = None

    def call(self, name: str, *args: Any, **kwargs: Any) -> tuple[Any, ...]:
        """Return what a method says, or an attribute is, for each environment.

        There are no environments inside this one: all share its attributes and methods. Of
        `level`, `action_masks` and, after a list of seeds, `np_random` and `np_random_seed`, each
        environment has its own.
        """
        if name == "level":
            return tuple(self._playing[number] for number in self._robots.level.tolist())
        found = getattr(self, name)
        if name == "action_masks":
            return tuple(found(*args, **kwargs))
        if name in ("np_random", "np_random_seed") and isinstance(found, tuple):
            return found
        return (found(*args, **kwargs) if callable(found) else found,) * self.num_envs

    def get_attr(self, name: str) -> tuple[Any, ...]:
        """Return what an attribute is for each environment; see `call`."""
        return self.call(name)

    def set_attr(self, name: str, values: Any) -> None:
        """Set `np_random` or `render_mode`, which all environments share.

        Args:
            name: which of them.
            values: the value, or a list of it for each environment.

        Raises:
            AttributeError: it is another attribute, which cannot be set.
            ValueError: the values differ, or the attribute cannot have this one.
        """
        if name not in SETTABLE:
            raise AttributeError(
                f"{name!r} cannot be set: of {type(self).__name__}, only "
                f"{' and '.join(SETTABLE)} can. Make another environment"
            )
        value, *others = values if isinstance(values, list | tuple) and values else [values]
        if others and (len(others) != self.num_envs - 1 or any(each != value for each in others)):
            raise ValueError(f"all environments share {name!r}: give one value, for all of them")
        if name == "render_mode" and value is not None:
            check_choice(name, value, ("rgb_array",))
        setattr(self, name, value)

    def render(self) -> Any:
        """Return a picture of the first 16 robots side by side, uint8 `[height, width, 3]`."""
        if self.render_mode is None:
            logger.warn("render() needs render_mode='rgb_array', given to make the environment")
            return None
        if self._tiles is None:
            largest = largest_of(self.levels) if self._slots is None else self._slots.family.largest
            self._tiles = Tiles(largest, self.num_envs)
        tables = self._tables
        level = self._robots.level[: self._tiles.count]
        state = self._robots.state[: self._tiles.count]
        if state[0] < 0:
            # Before the first reset, they stand where episodes begin.
            state = tables.starts[tables.first_start[level]]
        numbers, states = level.tolist(), (state - tables.offset[level]).tolist()
        return self._tiles.picture(numbers, [self._playing[n] for n in numbers], states)

    def close_extras(self, **kwargs: Any) -> None:
        """Let go of the pictures. Nothing else is held."""
        self._tiles = None

    @property
    def spec(self) -> EnvSpec | None:
        """The spec by which Gymnasium made the environment; it can be written as JSON."""
        return self._spec

    @spec.setter
    def spec(self, spec: EnvSpec | None) -> None:
        if spec is not None:
            self._spell_out(spec.kwargs)
        self._spec = spec

    def _spell_out(self, given: dict[str, Any]) -> None:
        """Put what is JSON into the place of arguments that are not, and say the same."""
        if not isinstance(given.get("level"), str | None):
            given["level"] = self.levels[0].to_dict(whole=True)
        if isinstance(self.levels, tuple) and "levels" in given:
            given["levels"] = [level.to_dict(whole=True) for level in self.levels]
        if "autoreset_mode" in given:
            given["autoreset_mode"] = self._mode.value

    def __getstate__(self) -> dict[str, Any]:
        return {**vars(self), "_tiles": None}
