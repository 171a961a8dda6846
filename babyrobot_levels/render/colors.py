"""CSS colours as numbers, in the notations that levels may use, and what is readable on them."""

from __future__ import annotations

import re
from collections.abc import Iterable
from colorsys import hls_to_rgb
from functools import lru_cache

from babyrobot_levels.language.looks import Colors

Rgb = tuple[int, int, int]
"""Red, green, blue in 0..255."""

Rgba = tuple[int, int, int, float]
"""Red, green, blue in 0..255, and alpha in 0..1."""

TEXT, GRAPHICS = 4.5, 3.0
"""The least contrasts of texts and of graphical objects (WCAG 2.2, 1.4.3 and 1.4.11)."""

_DARK, _LIGHT = "#000000", "#ffffff"

_NAMED = """
aliceblue f0f8ff antiquewhite faebd7 aqua 00ffff aquamarine 7fffd4 azure f0ffff beige f5f5dc
bisque ffe4c4 black 000000 blanchedalmond ffebcd blue 0000ff blueviolet 8a2be2 brown a52a2a
burlywood deb887 cadetblue 5f9ea0 chartreuse 7fff00 chocolate d2691e coral ff7f50
cornflowerblue 6495ed cornsilk fff8dc crimson dc143c cyan 00ffff darkblue 00008b darkcyan 008b8b
darkgoldenrod b8860b darkgray a9a9a9 darkgreen 006400 darkgrey a9a9a9 darkkhaki bdb76b
darkmagenta 8b008b darkolivegreen 556b2f darkorange ff8c00 darkorchid 9932cc darkred 8b0000
darksalmon e9967a darkseagreen 8fbc8f darkslateblue 483d8b darkslategray 2f4f4f
darkslategrey 2f4f4f darkturquoise 00ced1 darkviolet 9400d3 deeppink ff1493 deepskyblue 00bfff
dimgray 696969 dimgrey 696969 dodgerblue 1e90ff firebrick b22222 floralwhite fffaf0
forestgreen 228b22 fuchsia ff00ff gainsboro dcdcdc ghostwhite f8f8ff gold ffd700
goldenrod daa520 gray 808080 green 008000 greenyellow adff2f grey 808080 honeydew f0fff0
hotpink ff69b4 indianred cd5c5c indigo 4b0082 ivory fffff0 khaki f0e68c lavender e6e6fa
lavenderblush fff0f5 lawngreen 7cfc00 lemonchiffon fffacd lightblue add8e6 lightcoral f08080
lightcyan e0ffff lightgoldenrodyellow fafad2 lightgray d3d3d3 lightgreen 90ee90 lightgrey d3d3d3
lightpink ffb6c1 lightsalmon ffa07a lightseagreen 20b2aa lightskyblue 87cefa
lightslategray 778899 lightslategrey 778899 lightsteelblue b0c4de lightyellow ffffe0 lime 00ff00
limegreen 32cd32 linen faf0e6 magenta ff00ff maroon 800000 mediumaquamarine 66cdaa
mediumblue 0000cd mediumorchid ba55d3 mediumpurple 9370db mediumseagreen 3cb371
mediumslateblue 7b68ee mediumspringgreen 00fa9a mediumturquoise 48d1cc mediumvioletred c71585
midnightblue 191970 mintcream f5fffa mistyrose ffe4e1 moccasin ffe4b5 navajowhite ffdead
navy 000080 oldlace fdf5e6 olive 808000 olivedrab 6b8e23 orange ffa500 orangered ff4500
orchid da70d6 palegoldenrod eee8aa palegreen 98fb98 paleturquoise afeeee palevioletred db7093
papayawhip ffefd5 peachpuff ffdab9 peru cd853f pink ffc0cb plum dda0dd powderblue b0e0e6
purple 800080 rebeccapurple 663399 red ff0000 rosybrown bc8f8f royalblue 4169e1
saddlebrown 8b4513 salmon fa8072 sandybrown f4a460 seagreen 2e8b57 seashell fff5ee sienna a0522d
silver c0c0c0 skyblue 87ceeb slateblue 6a5acd slategray 708090 slategrey 708090 snow fffafa
springgreen 00ff7f steelblue 4682b4 tan d2b48c teal 008080 thistle d8bfd8 tomato ff6347
turquoise 40e0d0 violet ee82ee wheat f5deb3 white ffffff whitesmoke f5f5f5 yellow ffff00
yellowgreen 9acd32
"""
"""The named colours of CSS, each with its digits: Pillow, which has them, is slow to import."""


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
    if color not in _names():
        raise ValueError(f"invalid CSS colour: {color!r}")
    return _hexadecimal(_names()[color])


@lru_cache(maxsize=1)
def _names() -> dict[str, str]:
    words = _NAMED.split()
    return dict(zip(words[::2], words[1::2], strict=True))


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
    return max(_LIGHT, _DARK, key=lambda ink: min(contrast(ink, ground) for ground in below))


def ink_on(grounds: Iterable[str], preferred: str, least: float = TEXT) -> str:
    """Return a colour that is readable on all of the grounds.

    Args:
        grounds: what lies below, opaque; at least one.
        preferred: the colour to use if its contrast suffices; else it is black or white. What is
            transparent is hidden, and remains so.
        least: the contrast that suffices: `TEXT` or `GRAPHICS`.
    """
    if rgba(preferred)[3] == 0:
        return preferred
    below = tuple(grounds)
    is_clear = min(contrast(preferred, ground) for ground in below) >= least
    return preferred if is_clear else rim_on(below)


def plate_for(ink: str, preferred: str) -> str:
    """Return the background of a text that is readable whatever lies below it.

    Args:
        ink: the colour of the text.
        preferred: the background to use if it suffices, on black and on white; else it is black or
            white.
    """
    seen = (mixed(preferred, below) for below in (_DARK, _LIGHT))
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
