"""Whether what a level states is true: figures, ranges, names, and metrics without a value."""

from __future__ import annotations

import math
from decimal import ROUND_HALF_UP, Decimal
from fractions import Fraction
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

import babyrobot_levels as brl
from babyrobot_levels.analysis.expectations import is_met
from babyrobot_levels.language.expectations import FigureRange


def broken(text: str) -> dict[str, str]:
    found = brl.broken_expectations(brl.loads(f"version: 1\n{text}\n"))
    return {each.name: each.message for each in found}


# -- single figures ----------------------------------------------------------------------------


@given(st.decimals(-1000, 1000, places=6), st.integers(0, 5))
def test_a_figure_is_true_if_it_is_the_metric_rounded(value: Decimal, decimals: int) -> None:
    step = Fraction(1, 10**decimals)
    below = Fraction(value) // step
    rounded = Fraction(value.quantize(Decimal(10) ** -decimals, ROUND_HALF_UP))
    for number in (below - 1, below, below + 1, below + 2):
        stated = float(number * step)
        found = is_met("best_return", stated, float(value), decimals)
        assert found == (number * step == rounded)


@pytest.mark.parametrize(
    ("value", "figure"),
    [(2.5, 3), (-2.5, -3), (-2.4999999999999, -3), (-2.4999, -2), (0.5, 1), (-0.5, -1), (1.5, 2)],
)
def test_halves_are_rounded_away_from_0(value: float, figure: int) -> None:
    figures = [each for each in range(-5, 6) if is_met("best_return", float(each), value)]
    assert figures == [figure]


@pytest.mark.parametrize(
    ("stated", "value", "expected"),
    [
        (1.0, 1 - 1e-12, True),
        (1.0, 0.9999, False),
        (0.0, 1e-6, False),
        (0.0, 0.0, True),
        # Other figures of shares are rounded.
        (0.5, 0.5004, False),
    ],
)
def test_zero_and_one_are_exact_for_probabilities(
    stated: float, value: float, expected: bool
) -> None:
    assert is_met("success", stated, value, 3 if stated == 0.5 else 0) == (
        expected or stated == 0.5
    )
    assert is_met("best_return", stated, value)


@pytest.mark.parametrize(
    ("text", "is_true"),
    [
        ("1.50", False),
        ("1.5", True),
        ("2", True),
        ("1.53", True),
        ("153e-2", True),
        ("1.54", False),
    ],
)
def test_the_text_says_how_exact_a_figure_is(text: str, is_true: bool) -> None:
    # The optimal return is -1 - 0.526.
    level = "size: [4, 1]\ndiscount: 0.526\nexpect:\n  "
    assert (broken(f"{level}best_return: -{text}") == {}) == is_true


def test_a_level_that_no_text_says_has_the_decimals_of_its_numbers() -> None:
    level = brl.Level(version=1, size=(4, 1), skid=0.25, expect={"best_steps": 4})
    (found,) = brl.broken_expectations(level.replace(expect={"best_steps": 3.25}))
    assert (found.name, found.expected) == ("best_steps", 3.25)


def test_changed_facts_are_not_read_from_the_text_as_it_was() -> None:
    level = brl.loads("version: 1\nsize: [4, 1]\nexpect:\n  best_steps: 3.00\n")
    assert brl.broken_expectations(level) == []
    assert [each.message for each in brl.broken_expectations(level.replace(size=[5, 1]))] == [
        "`best_steps` is 4, not 3.00"
    ]
    assert brl.broken_expectations(level.replace(size=[5, 1], expect={"best_steps": 4})) == []


# -- ranges and names --------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("stated", "value", "expected"),
    [
        ("18..22", 18, True),
        ("18..22", 22 + 1e-9, True),
        ("18..22", 22.0001, False),
        ("18..", 1e9, True),
        ("18..", math.inf, False),
        ("..-3.5", -3.5, True),
        ("..-3.5", -3.4, False),
        ("0..", -1e-12, True),
        (FigureRange(min=2, max=3), 2.5, True),
        (FigureRange(min=2), 1.5, False),
    ],
)
def test_a_range_holds_its_ends(stated: Any, value: float, expected: bool) -> None:
    assert is_met("best_return", stated, value) == expected


def test_names_are_compared_without_their_order() -> None:
    assert is_met("needs", ("lever", "key"), ("key", "lever"))
    assert not is_met("needs", ("key",), ("key", "lever"))
    assert not is_met("needs", (), None)


@pytest.mark.parametrize("value", [None, math.nan, math.inf, -math.inf])
def test_what_is_no_number_breaks_every_fact(value: float | None) -> None:
    for stated in (0.0, "..5", "-5..", FigureRange(min=0)):
        assert not is_met("best_return", stated, value)


# -- what is told ------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("exit: none\nexpect: {path_length: 2}", "has no value, not 2: there is no exit"),
        (
            "walls: [{at: [0, 0], side: E}, {at: [0, 0], side: S}]\nexpect: {turns: 2}",
            "has no value, not 2: from a start, no path to an exit is known",
        ),
        (
            "rewards: {step: 1}\nexpect: {difficulty: 1}",
            "has no value, not 1: the best policy does not go to an exit",
        ),
        ("rewards: {step: 1}\nexpect: {best_return: 4..}", "is infinite, not 4.."),
        # Six digits would say 4.
        ("expect: {best_steps: 4.0000001..5}", "is 4, not 4.0000001..5"),
    ],
)
def test_the_true_value_is_told_or_why_there_is_none(text: str, message: str) -> None:
    (told,) = broken(text).values()
    assert told.endswith(message)


def test_returns_that_have_no_end_are_explained() -> None:
    found = broken(
        "size: [4, 1]\nwalls: [{at: [2, 0], side: E}]\n"
        "rewards: {closer: 1, farther: -1, stay: -1, bump: -1}\n"
        "expect: {best_return: 4, cells: 4}"
    )
    assert [*found] == ["best_return"]
    assert found["best_return"].endswith("undefined, or episodes are too long to compute")
