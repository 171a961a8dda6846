"""The themes that come with the package can be seen: contrasts by WCAG 2.2."""

from __future__ import annotations

import pytest

from babyrobot_levels.language.looks import BUILTIN_THEMES, Colors
from babyrobot_levels.render.colors import GRAPHICS, TEXT, contrast, rgba, rim_on


def faint(colors: Colors, bound: float) -> set[str]:
    """Return what does not stand out from the ground."""
    parts = ("start", "exit", "robot", "walls", "border", "arrows", "puddle", "blocked")
    return {part for part in parts if contrast(getattr(colors, part), colors.base) < bound}


def test_contrast_is_that_of_the_standard() -> None:
    assert contrast("white", "black") == pytest.approx(21)
    assert contrast("#777777", "#ffffff") == pytest.approx(4.48, abs=0.01)


@pytest.mark.parametrize("name", BUILTIN_THEMES)
def test_what_matters_stands_out_from_the_ground(name: str) -> None:
    colors = BUILTIN_THEMES[name].colors
    assert faint(colors, GRAPHICS) == set()
    # Then one of an arrow and its rim stands out from any ground.
    assert contrast(colors.arrows, rim_on([colors.arrows])) >= GRAPHICS**2
    for text, ground in (
        (colors.start_text, colors.start),
        (colors.exit_text, colors.exit),
        (colors.text_fg, colors.text_bg),
    ):
        assert contrast(text, ground) >= TEXT


def test_high_contrast_is_what_it_says() -> None:
    colors = BUILTIN_THEMES["high_contrast"].colors
    assert faint(colors, 9) == {"border", "blocked"}
    assert contrast(colors.lines, colors.base) >= TEXT
    # The outer wall is seen on the page as well.
    assert min(contrast(colors.border, page) for page in ("white", "black")) >= GRAPHICS


def test_print_is_of_greys_alone() -> None:
    colors = BUILTIN_THEMES["print"].colors
    for color in colors.model_dump().values():
        red, green, blue, alpha = rgba(color)
        assert red == green == blue
        assert alpha == 1
