"""Colours and built-in themes."""

from __future__ import annotations

import pytest

from babyrobot_levels.language.fields import LevelFields
from babyrobot_levels.language.looks import BUILTIN_THEMES, NAMES, Theme, is_color


@pytest.mark.parametrize("name", BUILTIN_THEMES)
def test_built_in_themes_are_valid(name: str) -> None:
    theme = BUILTIN_THEMES[name]
    assert Theme.model_validate(theme.model_dump()) == theme


def test_defaults_are_what_empty_mappings_stand_for() -> None:
    names = ("hit", "puddle_types", "rewards", "display")
    given = LevelFields.model_validate({"version": 1, **{name: {} for name in names}})
    left_out = LevelFields(version=1)
    for name in names:
        assert getattr(given, name) == getattr(left_out, name)


def test_colors_are_names_and_forms_of_css_and_nothing_around_them() -> None:
    colors = [*NAMES, "#abc", "#aabbccdd", "rgb(1, 2,255)", "rgba(0,0,0,0.5)", "hsl(360, 5%,100%)"]
    assert all(map(is_color, colors))
    others = ["Red", "red\n", " red", "#abcde", "#abc\n", "rgb(256,0,0)", "hsl(361,0%,0%)", ""]
    assert not any(map(is_color, others))
