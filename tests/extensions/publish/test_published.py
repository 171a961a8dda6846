"""What books print about levels of the gallery, and what is computed for them."""

from __future__ import annotations

from typing import Any

import pytest

from babyrobot_levels.extensions.publish.published import FIGURES, comparisons
from babyrobot_levels.library.catalogue import load

NAMES = sorted({figure.level for figure in FIGURES})


@pytest.mark.parametrize("name", NAMES)
def test_what_is_computed_is_what_is_printed(name: str) -> None:
    world = load(name)
    found = comparisons(world)
    assert [each.figure for each in found] == [each for each in FIGURES if each.level == name]
    assert {each.figure.digest for each in found} == {world.digest}
    assert all(each.agrees for each in found)


@pytest.mark.parametrize("name", NAMES)
def test_each_figure_has_the_source_of_the_level(name: str) -> None:
    author = str(load(name).source).split()[0]
    assert all(figure.source.startswith(author) for figure in FIGURES if figure.level == name)


def test_another_level_of_the_name_has_no_figures() -> None:
    changed: dict[str, Any] = {"rewards": {"step": -2}}
    assert comparisons(load("windy-gridworld").replace(**changed)) == []


def test_a_difference_that_rounding_does_not_explain_is_told() -> None:
    world = load("cliff-walking")
    (found,) = comparisons(world)
    assert (found.difference, found.agrees) == (0, True)
    assert not type(found)(found.figure, [[-12.4]], 0.6).agrees
