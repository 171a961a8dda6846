"""CSS colours as numbers, in the notations that levels may use."""

from __future__ import annotations

import re
from colorsys import hls_to_rgb
from functools import lru_cache

Rgb = tuple[int, int, int]
"""Red, green, blue in 0..255."""

Rgba = tuple[int, int, int, float]
"""Red, green, blue in 0..255, and alpha in 0..1."""


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
    # Pillow has the table of names; it is slow to import, and most colours do without it.
    from PIL.ImageColor import colormap, getrgb

    if color not in colormap:
        raise ValueError(f"invalid CSS colour: {color!r}")
    red, green, blue = getrgb(color)[:3]
    return red, green, blue, 1.0


def over(color: str, ground: Rgb) -> Rgb:
    """Return a colour composited on an opaque background."""
    *front, alpha = rgba(color)
    red, green, blue = (
        round(alpha * top + (1 - alpha) * below) for top, below in zip(front, ground, strict=True)
    )
    return red, green, blue


def contrast(color: str, ground: str) -> float:
    """Return the contrast ratio of a colour on a background, 1 to 21, as WCAG 2 defines it.

    A background that is not opaque is composited on white.
    """
    below = over(ground, (255, 255, 255))
    dark, light = sorted((_luminance(over(color, below)), _luminance(below)))
    return (light + 0.05) / (dark + 0.05)


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
