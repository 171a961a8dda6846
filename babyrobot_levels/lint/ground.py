"""What areas, puddles and skidding come to on each cell, and which of them come to nothing.

A cell's reward is that of its puddle, else of the last area that gives one, else the level's
step; its skid likewise; and whether it ends the episode is what the last area says. So properties
lie on each other in layers. They are painted from the bottom up, noting where each makes a
difference, and then looked at from the top down, where those above that matter hide those below.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.language.cells import Area, SkidLike, as_skid
from babyrobot_levels.lint.drawn import count_drawn
from babyrobot_levels.lint.effects import AreaEffect, Effect

if TYPE_CHECKING:
    from babyrobot_levels.lint.case import Case

Flags = NDArray[np.bool_]
Where = tuple[Any, Any]

PROPERTIES = ("reward", "skid", "ends")


class Ground:
    """What the layers of a level's ground do.

    Attributes:
        areas: what each area does that the file lists.
        puddles: the puddles that change nothing: number, and what reward and skid do.
        skid: what the skid of the level does, None where there is none.
    """

    def __init__(self, case: Case) -> None:
        self._case, self._level = case, case.level
        mdp = case.mdp
        shape = (mdp.height, mdp.width)
        self._over = mdp.over.reshape(shape)
        enters = [warp.at for warp in self._level.warps if warp.when == "enter"]
        leaves = [warp.at for warp in self._level.warps if warp.when == "leave"]
        self._stood = ~_flags(shape, enters)
        self._moved = ~self._over & ~_flags(shape, leaves)
        self._fixed = _flags(shape, self._level.exits) | case.grid.blocked
        self._drawn = count_drawn(self._level, "areas")
        self._value = {
            "reward": np.full(shape, self._level.rewards.step),
            "skid": np.full(shape, skid_code(self._level.skid), complex),
            "ends": np.zeros(shape, bool),
        }
        self._hidden = {name: np.zeros(shape, bool) for name in (*PROPERTIES, "color")}
        changes = self._paint()
        self.puddles = self._puddles()
        self.areas = self._areas(changes)
        self.skid = self._skid()
        # The case keeps its ground: together they would outlive their use.
        del self._case

    def _paint(self) -> list[dict[str, Flags]]:
        """Paint the areas; return for each of the listed ones where its properties differ."""
        for area in self._level.areas[: self._drawn]:
            for name in PROPERTIES:
                if getattr(area, name) is not None:
                    self._value[name][area.at[1], area.at[0]] = _code(area, name)
        changes = []
        for area in self._level.areas[self._drawn :]:
            where, change = place(area), {}
            for name in PROPERTIES:
                if getattr(area, name) is not None:
                    value = _code(area, name)
                    change[name] = self._value[name][where] != value
                    self._value[name][where] = value
            changes.append(change)
        return changes

    def _puddles(self) -> list[tuple[int, Effect, Effect]]:
        found = []
        for size in ("small", "large"):
            kind = getattr(self._level.puddle_types, size)
            numbers = [n for n, puddle in enumerate(self._level.puddles) if puddle.size == size]
            if not numbers:
                continue
            at = np.array([self._level.puddles[number].at for number in numbers])
            where = (at[:, 1], at[:, 0])
            reward = self._value["reward"][where] != kind.reward
            skid = self._value["skid"][where] != skid_code(kind.skid)
            works = (reward & self._surely_given[where]) | (
                skid & (self._moved & self._stood)[where]
            )
            for name in ("reward", "skid"):
                self._hidden[name][where] = True
            for index in np.flatnonzero(~works):
                one = (where[0][index : index + 1], where[1][index : index + 1])
                seen = np.ones(1, bool)
                effects = (
                    self._effect("reward", one, seen, reward[index : index + 1]),
                    self._effect("skid", one, seen, skid[index : index + 1]),
                )
                if Effect.WORKS not in effects:
                    found.append((numbers[index], *effects))
                    for name in ("reward", "skid"):
                        self._hidden[name][one] = False
        return sorted(found, key=lambda each: each[0])

    def _areas(self, changes: list[dict[str, Flags]]) -> list[AreaEffect]:
        found: list[AreaEffect] = []
        listed = [*enumerate(self._level.areas)][self._drawn :]
        if not listed:
            return found
        shown = self._shown()
        for (number, area), change in zip(reversed(listed), reversed(changes), strict=True):
            where = place(area)
            one = AreaEffect(number, labelled=bool((area.label or "").split()))
            for name, differs in change.items():
                seen = ~self._hidden[name][where]
                dry = name == "skid" and skid_code(area.skid) == 0
                one.game[name] = self._effect(name, where, seen, differs, dry=dry)
            if area.color is not None:
                one.colored = bool((shown[where] & ~self._hidden["color"][where]).any())
            found.append(one)
            if one.works:
                for name in change:
                    if not (name == "skid" and one.game[name] is not Effect.WORKS):
                        self._hidden[name][where] = True
                if area.color is not None and is_opaque(area.color):
                    self._hidden["color"][where] = True
        return found[::-1]

    def _shown(self) -> Flags:
        """Return the cells whose ground is to be seen: nothing else is painted over it."""
        level, colors = self._level, self._level.resolved_theme.colors
        shown = np.ones_like(self._over)
        for cells, color in ((level.starts, colors.start), (level.exits, colors.exit)):
            if is_opaque(color):
                shown &= ~_flags(shown.shape, cells)
        if is_opaque(colors.blocked):
            shown &= ~self._case.grid.blocked
        return shown

    def _skid(self) -> Effect | None:
        if self._level.skid is None:
            return None
        everywhere = (slice(None), slice(None))
        seen, dry = ~self._hidden["skid"], skid_code(self._level.skid) == 0
        return self._effect("skid", everywhere, seen, np.full_like(seen, not dry), dry=dry)

    def _effect(
        self, name: str, where: Where, seen: Flags, differs: Flags, *, dry: bool = False
    ) -> Effect:
        """Return what a property does on some cells.

        Args:
            name: the property.
            where: the cells.
            seen: on which of them nothing hides it.
            differs: on which of them something else would be so without it.
            dry: whether it is a skid by which nobody skids.
        """
        if not seen.any():
            return Effect.COVERED
        changes = seen & differs
        stood = self._stood[where]
        if name == "reward" and (changes & self._surely_given[where]).any():
            return Effect.WORKS
        counts = self._counts(name)[where]
        if (changes & counts & stood).any():
            return Effect.WORKS
        if (changes & counts).any():
            return Effect.NOBODY
        return Effect.SAME if not dry and (seen & counts & stood).any() else Effect.NEVER

    def _counts(self, name: str) -> Flags:
        """Return the cells on which a property comes into play."""
        if name == "reward":
            return self._case.rewarded
        return self._moved if name == "skid" else ~self._fixed

    @property
    def _surely_given(self) -> Flags:
        """Some of the cells whose own reward counts, known without looking at the tables."""
        # Whoever stays gets it.
        plain = self._level.rewards.stay is None
        return ~self._over & self._stood if plain else np.zeros_like(self._over)


def place(area: Area) -> tuple[slice, slice]:
    """Return where an area lies in arrays `[height, width]`."""
    (x, y), (columns, rows) = area.at, area.size
    return slice(y, y + rows), slice(x, x + columns)


def skid_code(skid: SkidLike | None) -> complex:
    """Return a skid as one number: the same for all that do not skid."""
    if skid is None:
        return 0j
    given = as_skid(skid)
    return given.probability * {"open": 1, "sides": -1, "others": 1j}[given.to]


def is_opaque(color: str) -> bool:
    """Tell whether a CSS colour surely hides what lies below it."""
    if color.startswith("#"):
        return len(color) in (4, 7)
    return color != "transparent" and not color.startswith("rgba")


def _code(area: Area, name: str) -> Any:
    value = getattr(area, name)
    return skid_code(value) if name == "skid" else value


def _flags(shape: tuple[int, ...], cells: Any) -> Flags:
    flags = np.zeros(shape, bool)
    for x, y in cells:
        flags[y, x] = True
    return flags
