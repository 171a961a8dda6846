"""The themes that come with the package can be seen: contrasts by WCAG 2.2."""

from __future__ import annotations

import pytest

from babyrobot_levels.language.looks import BUILTIN_THEMES, Colors
from babyrobot_levels.render.colors import Rgb, over, rgba

GRAPHICS = 3.0
TEXT = 4.5

FIXED = {
    "default": {"start", "exit"},
    "blue_green": {"start"},
    "green": {"start", "exit", "walls"},
}
"""What the ancestor's colours leave below the bound: they are given."""


def luminance(color: Rgb) -> float:
    shares = [channel / 255 for channel in color]
    linear = [s / 12.92 if s <= 0.04045 else ((s + 0.055) / 1.055) ** 2.4 for s in shares]
    return sum(w * part for w, part in zip((0.2126, 0.7152, 0.0722), linear, strict=True))


def contrast(color: str, ground: str) -> float:
    below = rgba(ground)[:3]
    light, dark = sorted((luminance(over(color, below)), luminance(below)), reverse=True)
    return (light + 0.05) / (dark + 0.05)


def faint(colors: Colors, bound: float) -> set[str]:
    """Return what does not stand out from the ground."""
    parts = ("start", "exit", "robot", "walls", "puddle")
    return {part for part in parts if contrast(getattr(colors, part), colors.base) < bound}


def test_contrast_is_that_of_the_standard() -> None:
    assert contrast("white", "black") == pytest.approx(21)
    assert contrast("#777777", "#ffffff") == pytest.approx(4.48, abs=0.01)


@pytest.mark.parametrize("name", BUILTIN_THEMES)
def test_what_matters_stands_out_but_for_colours_that_are_given(name: str) -> None:
    assert faint(BUILTIN_THEMES[name].colors, GRAPHICS) == FIXED.get(name, set())


def test_high_contrast_is_what_it_says() -> None:
    colors = BUILTIN_THEMES["high_contrast"].colors
    assert faint(colors, 9) == set()
    for text, ground in (
        (colors.start_text, colors.start),
        (colors.exit_text, colors.exit),
        (colors.text_fg, colors.text_bg),
        (colors.arrows, colors.base),
        (colors.lines, colors.base),
    ):
        assert contrast(text, ground) >= TEXT
    # The outer wall is seen on the page as well.
    assert min(contrast(colors.border, page) for page in ("white", "black")) >= GRAPHICS


def test_print_is_of_greys_alone_and_readable() -> None:
    colors = BUILTIN_THEMES["print"].colors
    for color in colors.model_dump().values():
        red, green, blue, alpha = rgba(color)
        assert red == green == blue
        assert alpha == 1
    for text, ground in (
        (colors.start_text, colors.start),
        (colors.exit_text, colors.exit),
        (colors.text_fg, colors.text_bg),
    ):
        assert contrast(text, ground) >= TEXT
