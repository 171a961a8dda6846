"""The options of pictures: each function has those of its format, by name, and no others."""

from __future__ import annotations

import inspect
from typing import Any

import pytest

import babyrobot_levels as brl
from babyrobot_levels.analysis.picture_formats import FORMATS, PictureFormat, titles_of

MADE = [each for each in FORMATS.values() if each.make is not None]
each_format = pytest.mark.parametrize("chosen", MADE, ids=lambda each: each.name)


def method_of(level: brl.Level, chosen: PictureFormat) -> Any:
    return getattr(level, f"to_{chosen.name}")


@each_format
def test_a_level_has_a_method_for_each_format(chosen: PictureFormat) -> None:
    made: Any = chosen.make
    assert method_of(brl.load("default"), chosen).__func__ is made.__get__(None)
    assert inspect.getdoc(method_of(brl.load("default"), chosen))


@each_format
def test_help_and_completion_show_each_option(chosen: PictureFormat) -> None:
    shown = inspect.signature(method_of(brl.load("default"), chosen)).parameters
    assert [*shown] == ["path", *chosen.shows.__annotations__, *chosen.hears]
    assert all(each.default is not inspect.Parameter.empty for each in shown.values())


@pytest.mark.slow
def test_the_defaults_are_shown_and_are_what_they_say() -> None:
    level = brl.load("default")
    for chosen in MADE:
        shown = inspect.signature(method_of(level, chosen)).parameters
        given = {name: shown[name].default for name in chosen.options}
        assert method_of(level, chosen)() == method_of(level, chosen)(**given)
    assert inspect.signature(level.to_gif).parameters["policy"].default == "best"


@each_format
def test_options_are_documented(chosen: PictureFormat) -> None:
    own = inspect.getdoc(method_of(brl.load("default"), chosen)) or ""
    text = (inspect.getdoc(brl.Level.to_svg) or "") if "those of `to_svg`" in own else own
    assert [name for name in chosen.options if f"    {name}: " not in text] == []


@each_format
def test_a_misspelt_option_is_told_the_nearest(chosen: PictureFormat) -> None:
    name = f"to_{chosen.name}"
    wrong: Any = {"valeus": True}
    with pytest.raises(TypeError) as caught:
        method_of(brl.load("default"), chosen)(**wrong)
    assert str(caught.value) == (
        f"{name}() got an unexpected keyword argument 'valeus'; did you mean `values`?"
    )


def test_an_option_of_another_format_is_refused() -> None:
    other: Any = {"held": "nothing"}
    with pytest.raises(TypeError, match=r"to_gif\(\) got an unexpected keyword argument 'held'"):
        brl.load("default").to_gif(**other)


def test_formats_are_found_by_what_they_show() -> None:
    assert titles_of("seed") == ["GIF", "HTML"]
    assert titles_of("scale") == ["SVG", "PDF", "PNG", "GIF"]
    assert titles_of("answers") == ["HTML"]
