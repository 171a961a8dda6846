"""Which levels many robots play: the same ones always, or others in other episodes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.envs.arguments import checked_start
from babyrobot_levels.envs.engine.arguments import limits_of
from babyrobot_levels.envs.engine.choice import make_engine
from babyrobot_levels.envs.engine.tables import build_tables
from babyrobot_levels.envs.vector.rendering import RenderedVectorEnv
from babyrobot_levels.envs.vector.seeding import SeededVectorEnv
from babyrobot_levels.envs.vector.slots import Slots

if TYPE_CHECKING:
    from babyrobot_levels.envs.engine.robots import Engine
    from babyrobot_levels.envs.engine.tables import Ints, Tables
    from babyrobot_levels.envs.vector.arguments import Played
    from babyrobot_levels.envs.vector.observations import BatchObserver
    from babyrobot_levels.envs.vector.spaces import BatchActions


class ChangingVectorEnv(SeededVectorEnv, RenderedVectorEnv):
    """Many robots whose levels can change. When episodes begin, heirs say."""

    action_space: BatchActions
    _observer: BatchObserver
    _engine: Engine
    _engine_name: str | None
    _samples_possible: bool

    def _take(
        self, played: Played, first_action: int, max_episode_steps: Any, draw_levels: bool
    ) -> None:
        """Make the tables of what is played, and the engine that walks in them."""
        if played.family is None:
            limits = limits_of(self.levels, max_episode_steps)
            mdps = [each.compile() for each in self.levels]
            tables = build_tables(mdps, limits, first_action, draw_levels)
            self._observer.show(tables.offset, self.levels)
            self._playing = self.levels
        else:
            limit = limits_of([played.family.level(0)], max_episode_steps)[0]
            self._slots = Slots(played.family, self.num_envs, first_action, limit, self._observer)
            tables, self._playing = self._slots.tables, self._slots.levels
        self._use(tables)

    def _use(self, tables: Tables) -> None:
        """Walk in tables from now on."""
        self._tables = tables
        self._engine = make_engine(self._engine_name, tables, self._observer.table, self.num_envs)
        if self._samples_possible:
            self.action_space.standing = tables.standing

    def _level_numbers(self) -> dict[str, NDArray[np.int64]]:
        """Return the numbers of the levels that are played, under their name in infos."""
        if self._slots is not None:
            numbers = self._slots.numbers.take(self._robots.level)
            return {self._slots.family.word: numbers}
        return {"level_index": self._robots.level.copy()} if len(self.levels) > 1 else {}

    def _digests(self, which: Ints) -> dict[str, NDArray[np.object_]]:
        """Return the digests of the levels in which robots begin, as infos have them."""
        if self._slots is not None and self._slots.family.word == "maze_seed":
            return {}
        level, where = np.unique(self._robots.level[which], return_inverse=True)
        digests = np.full(self.num_envs, None, object)
        told = [self._playing[number].digest for number in level.tolist()]
        digests[which] = np.array(told, object)[where]
        return {"level_digest": digests}

    def _change_levels(self, which: Ints, numbers: Any = None, start: Any = None) -> None:
        """Have robots go to other levels: to those of these numbers, `[num_envs]`, or drawn ones.

        A level that cannot be made, or in which episodes cannot begin at `start`, changes nothing.
        """
        slots = self._slots
        assert slots is not None
        if numbers is None:
            drawn = self._draws.uniform(which) * slots.family.count
            wanted = drawn.astype(np.int64)
        else:
            wanted = numbers[which]
        levels = slots.levels_of(wanted.tolist())
        for level in levels.values():
            checked_start(start, level)
        spans = slots.place(self._robots.level, which, wanted, levels)
        if spans is None:
            self._use(slots.tables)
        else:
            for span in spans:
                self._engine.reread(span)
