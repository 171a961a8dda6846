"""Scales: numbers as colours, for values of states and actions and for counts.

A stronger colour is a higher number: darker on themes with dark walls, brighter on themes with
light ones. Lightness alone orders the colours of a sequential scale, and the two hues of a
diverging one, orange and blue, are told apart by people who are colour-blind. Themes of greys have
greys.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache

from babyrobot_levels.language.looks import Colors
from babyrobot_levels.render.colors import contrast, is_gray, rgba

STEPS = 64
"""The number of steps of a scale: equal neighbours are painted as one."""

BLACK, WHITE = "#000000", "#ffffff"

_NOISE = 1e-9
"""The share of the larger side up to which the other sign of a value is rounding."""


@dataclass(frozen=True, slots=True)
class Ramps:
    """The colours of the scales of a theme: stops from the lowest to the highest value.

    Attributes:
        sequential: for numbers of one sign.
        diverging: for numbers of both signs; zero is in the middle.
        below: for negative infinity.
        above: for positive infinity.
    """

    sequential: tuple[str, ...]
    diverging: tuple[str, ...]
    below: str
    above: str


_LIGHT = Ramps(
    ("#fffbd8", "#e3f2b8", "#b9e0b7", "#84cbbb", "#52b3c4", "#3496be"),
    ("#d9602c", "#eb9566", "#f7cbb0", "#f7f4ef", "#b7d3e9", "#73a9d4", "#3b80ba"),
    "#4d4d4d",
    "#ffffff",
)
_DARK = Ramps(
    ("#2c0f4a", "#3d2e74", "#39538b", "#2f708e", "#21918c"),
    ("#c07f16", "#8d5a10", "#573a12", "#242326", "#1c3d5c", "#24648f", "#3a8fc9"),
    "#000000",
    "#e8e8e8",
)
_LIGHT_GRAYS = Ramps(("#f4f4f4", "#8c8c8c"), ("#f4f4f4", "#8c8c8c"), "#4d4d4d", "#ffffff")
_DARK_GRAYS = Ramps(("#1f1f1f", "#868686"), ("#1f1f1f", "#868686"), "#000000", "#e8e8e8")


@dataclass(frozen=True, slots=True)
class Scale:
    """A scale of colours.

    Attributes:
        low: the lowest finite number; of counts, 0.
        high: the highest finite number.
        is_diverging: whether there are both signs: zero has the colour in the middle, and equal
            distances from it are equally strong.
        is_logarithmic: whether strength grows with the logarithm, so that the largest count does
            not make all others pale.
        stops: some of the colours from the lowest to the highest number, evenly between them.
        below: the colour of negative infinity.
        above: the colour of positive infinity.
    """

    low: float
    high: float
    is_diverging: bool
    is_logarithmic: bool
    stops: tuple[str, ...]
    below: str
    above: str

    @property
    def colors(self) -> tuple[str, ...]:
        """The colours from the lowest to the highest number, `STEPS + 1`, as `#rrggbb`."""
        return _ramp(self.stops)

    def color(self, value: float) -> str:
        """Return the colour of a number, as `#rrggbb`; one beyond an end has that end's."""
        if math.isinf(value):
            return self.above if value > 0 else self.below
        return self.colors[self.step(value)]

    def step(self, value: float) -> int:
        """Return the index of a finite number's colour."""
        return round(STEPS * min(max(self._share(value), 0.0), 1.0))

    def strip(self, count: int) -> list[str]:
        """Return the colours from the lowest to the highest number, in equal parts."""
        shares = ((index + 0.5) / count for index in range(count))
        if self.is_logarithmic:
            # Equal lengths are equal colours all the same.
            return [self.colors[round(STEPS * share)] for share in shares]
        return [self.color(self.low + share * (self.high - self.low)) for share in shares]

    def ink(self, value: float) -> str:
        """Return black or white, whichever is readable on the colour of a number."""
        return ink_on(self.color(value))

    def _share(self, value: float) -> float:
        """Return where a number is between the ends, 0 to 1."""
        if self.is_diverging:
            return 0.5 + 0.5 * value / max(-self.low, self.high)
        if self.is_logarithmic:
            return math.log1p(value) / (math.log1p(self.high) or 1.0)
        return (value - self.low) / (self.high - self.low) if self.high > self.low else 0.5


def scale_of(values: Iterable[float | None], colors: Colors) -> Scale:
    """Return the scale of values.

    Args:
        values: all values of a picture; None and infinite ones have no part in it.
        colors: the colours of the theme.
    """
    finite = [value for value in values if value is not None and math.isfinite(value)]
    low, high = min(finite, default=0.0), max(finite, default=0.0)
    ramps = ramps_of(colors)
    is_diverging = min(-low, high) > _NOISE * max(-low, high)
    stops = ramps.diverging if is_diverging else ramps.sequential
    return Scale(low, high, is_diverging, False, stops, ramps.below, ramps.above)


def count_scale(counts: Iterable[float | None], colors: Colors) -> Scale:
    """Return the logarithmic scale of counts, from 0; see `scale_of`."""
    most = max((count for count in counts if count is not None), default=0.0)
    ramps = ramps_of(colors)
    return Scale(0.0, most, False, True, ramps.sequential, ramps.below, ramps.above)


def ramps_of(colors: Colors) -> Ramps:
    """Return the colours of a theme's scales: light ones where walls are dark, and else dark."""
    is_light = contrast(colors.walls, WHITE) > contrast(colors.walls, BLACK)
    if is_gray(colors):
        return _LIGHT_GRAYS if is_light else _DARK_GRAYS
    return _LIGHT if is_light else _DARK


@lru_cache(maxsize=4096)
def ink_on(color: str) -> str:
    """Return black or white, whichever has the higher contrast on a colour: 4.58 or more."""
    return WHITE if contrast(WHITE, color) > contrast(BLACK, color) else BLACK


@lru_cache(maxsize=16)
def _ramp(stops: Sequence[str]) -> tuple[str, ...]:
    """Return the colours of a scale, evenly between its stops."""
    parts = len(stops) - 1
    channels = [rgba(stop)[:3] for stop in stops]
    ramp = []
    for step in range(STEPS + 1):
        index = min(int(step * parts / STEPS), parts - 1)
        share = step * parts / STEPS - index
        pairs = zip(channels[index], channels[index + 1], strict=True)
        mixed = (round(low + share * (high - low)) for low, high in pairs)
        ramp.append("#" + "".join(f"{channel:02x}" for channel in mixed))
    return tuple(ramp)
