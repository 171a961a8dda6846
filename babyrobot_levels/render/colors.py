"""CSS colours as numbers, in the notations that levels may use, and what is readable on them."""

import re
from collections.abc import Iterable
from colorsys import hls_to_rgb
from functools import lru_cache

from babyrobot_levels.language.looks import NAMED, Colors

Rgb = tuple[int, int, int]
"""Red, green, blue in 0..255."""

Rgba = tuple[int, int, int, float]
"""Red, green, blue in 0..255, and alpha in 0..1."""

TEXT, GRAPHICS = 4.5, 3.0
"""The least contrasts of texts and of graphical objects (WCAG 2.2, 1.4.3 and 1.4.11)."""

BLACK, WHITE = "#000000", "#ffffff"


@lru_cache(maxsize=1024)
def rgba(color: str) -> Rgba:
    """Return a CSS colour as numbers.

    Raises:
        ValueError: it is not a valid colour.
    """
    if color == "transparent":
        return 0, 0, 0, 0.0
    if color.startswith("#"):
        return _hexadecimal(color[1:])
    if color.startswith("rgb"):
        red, green, blue, *alpha = (float(number) for number in re.findall(r"[\d.]+", color))
        return int(red), int(green), int(blue), alpha[0] if alpha else 1.0
    if color.startswith("hsl"):
        hue, saturation, lightness = (int(number) for number in re.findall(r"\d+", color))
        shares = hls_to_rgb(hue / 360, lightness / 100, saturation / 100)
        r, g, b = (round(255 * share) for share in shares)
        return r, g, b, 1.0
    if color not in NAMED:
        raise ValueError(f"invalid CSS colour: {color!r}")
    return _hexadecimal(NAMED[color])


def over(color: str, ground: Rgb) -> Rgb:
    """Return a colour composited on an opaque background."""
    *front, alpha = rgba(color)
    red, green, blue = (
        round(alpha * top + (1 - alpha) * below) for top, below in zip(front, ground, strict=True)
    )
    return red, green, blue


@lru_cache(maxsize=1024)
def mixed(color: str, ground: str, share: float = 1.0) -> str:
    """Return a colour of which only a share is left on a ground, as `#rrggbb`.

    A ground that is not opaque is composited on white.
    """
    below = over(ground, (255, 255, 255))
    parts = zip(over(color, below), below, strict=True)
    return _written(round(share * top + (1 - share) * low) for top, low in parts)


def gray(color: str) -> str:
    """Return the grey of the same luminance, which has the same contrasts; alpha stays."""
    *opaque, alpha = rgba(color)
    if len({*opaque}) == 1:
        return color
    share = _luminance((opaque[0], opaque[1], opaque[2]))
    level = 12.92 * share if share <= 0.0031308 else 1.055 * share ** (1 / 2.4) - 0.055
    return _written([round(255 * level)] * 3 + [round(255 * alpha)] * (alpha < 1))


def _written(parts: Iterable[int]) -> str:
    return "#" + "".join(f"{part:02x}" for part in parts)


# -- contrast ------------------------------------------------------------------------------------


@lru_cache(maxsize=4096)
def contrast(color: str, ground: str) -> float:
    """Return the contrast ratio of a colour on a background, 1 to 21, as WCAG 2 defines it.

    A background that is not opaque is composited on white.
    """
    below = over(ground, (255, 255, 255))
    dark, light = sorted((_luminance(over(color, below)), _luminance(below)))
    return (light + 0.05) / (dark + 0.05)


def rim_on(grounds: Iterable[str]) -> str:
    """Return black or white, whichever stands out more from the grounds.

    It has a contrast of at least 4.5 to any one ground. Around a line or a figure of a colour that
    has a contrast of 9 to it, one of the two has at least 3 to anything.
    """
    below = tuple(grounds)
    return max(WHITE, BLACK, key=lambda ink: min(contrast(ink, ground) for ground in below))


def ink_on(grounds: Iterable[str], preferred: str, least: float = TEXT) -> str:
    """Return a colour that is readable on all of the grounds.

    Args:
        grounds: what lies below, opaque; at least one.
        preferred: the colour to use if its contrast suffices; else it is black or white. What is
            transparent is hidden, and remains so.
        least: the contrast that suffices: `TEXT` or `GRAPHICS`.
    """
    return _ink_on(tuple(grounds), preferred, least)


@lru_cache(maxsize=1024)
def _ink_on(below: tuple[str, ...], preferred: str, least: float) -> str:
    if rgba(preferred)[3] == 0:
        return preferred
    is_clear = min(contrast(preferred, ground) for ground in below) >= least
    return preferred if is_clear else rim_on(below)


def plate_for(ink: str, preferred: str) -> str:
    """Return the background of a text that is readable whatever lies below it.

    Args:
        ink: the colour of the text.
        preferred: the background to use if it suffices, on black and on white; else it is black or
            white.
    """
    seen = (mixed(preferred, below) for below in (BLACK, WHITE))
    is_readable = min(contrast(ink, ground) for ground in seen) >= TEXT
    return preferred if is_readable else rim_on([ink])


def _luminance(color: Rgb) -> float:
    """Return the relative luminance of an sRGB colour, 0 to 1."""
    shares = (channel / 255 for channel in color)
    red, green, blue = (
        share / 12.92 if share <= 0.04045 else ((share + 0.055) / 1.055) ** 2.4 for share in shares
    )
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue


def _hexadecimal(digits: str) -> Rgba:
    if len(digits) < 6:
        digits = "".join(2 * digit for digit in digits)
    red, green, blue, *alpha = bytes.fromhex(digits)
    return red, green, blue, alpha[0] / 255 if alpha else 1.0


def is_gray(colors: Colors) -> bool:
    """Return whether all colours of a theme are greys: its pictures are grey throughout."""
    return all(len({*rgba(color)[:3]}) == 1 for color in colors.model_dump().values())
