"""How a vector environment is seen: its pictures, its attributes, and how it was made."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from gymnasium import logger
from gymnasium.vector import AutoresetMode, VectorEnv

from babyrobot_levels.envs.vector.pictures import Tiles

if TYPE_CHECKING:
    from gymnasium.envs.registration import EnvSpec

    from babyrobot_levels.engine.robots import Robots
    from babyrobot_levels.engine.tables import Tables
    from babyrobot_levels.level import Level


class RenderedVectorEnv(VectorEnv[Any, Any, Any]):
    """Many robots that can be seen. What happens to them, heirs say."""

    levels: tuple[Level, ...]
    _robots: Robots
    _tables: Tables
    _mode: AutoresetMode
    _tiles: Tiles | None = None
    _spec: EnvSpec | None = None

    def call(self, name: str, *args: Any, **kwargs: Any) -> tuple[Any, ...]:
        """Return what a method says, or an attribute is, for each environment.

        There are no environments inside this one: all share its attributes and methods. Of
        `level` and `action_masks`, each environment has its own.
        """
        if name == "level":
            return tuple(self.levels[number] for number in self._robots.level.tolist())
        found = getattr(self, name)
        if name == "action_masks":
            return tuple(found(*args, **kwargs))
        return (found(*args, **kwargs) if callable(found) else found,) * self.num_envs

    def get_attr(self, name: str) -> tuple[Any, ...]:
        """Return what an attribute is for each environment; see `call`."""
        return self.call(name)

    def render(self) -> Any:
        """Return a picture of the first 16 robots side by side, uint8 `[height, width, 3]`."""
        if self.render_mode is None:
            logger.warn("render() needs render_mode='rgb_array', given to make the environment")
            return None
        if self._tiles is None:
            self._tiles = Tiles(self.levels, self.num_envs)
        tables = self._tables
        level = self._robots.level[: self._tiles.count]
        state = self._robots.state[: self._tiles.count]
        if state[0] < 0:
            # Before the first reset, they stand where episodes begin.
            state = tables.starts[tables.first_start[level]]
        return self._tiles.picture(level.tolist(), (state - tables.offset[level]).tolist())

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
            given = spec.kwargs
            # Models, paths and modes are not JSON; what they say is.
            if not isinstance(given.get("level"), str | None):
                given["level"] = self.levels[0].to_dict(whole=True)
            if "levels" in given:
                given["levels"] = [level.to_dict(whole=True) for level in self.levels]
            if "autoreset_mode" in given:
                given["autoreset_mode"] = self._mode.value
        self._spec = spec

    def __getstate__(self) -> dict[str, Any]:
        return {**vars(self), "_tiles": None}
