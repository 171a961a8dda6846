"""What a level states of itself: how it is written, kept, and what it does not change."""

from __future__ import annotations

from typing import Any

import pytest

import babyrobot_levels as brl
from babyrobot_levels.language.expectations import FigureRange
from babyrobot_levels.language.ranges import bounds, ends
from babyrobot_levels.library.level import Level

EXPECT = {
    "path_length": 4.0,
    "best_return": "-4.5..-4",
    "best_steps": {"min": 4},
    "random_return": -12.3456789012,
    "difficulty": "..3",
    "lint": "clean",
}


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("18..22", {"min": 18, "max": 22}),
        ("-36.59..-36.58", {"min": -36.59, "max": -36.58}),
        ("18..", {"min": 18}),
        ("..-2", {"max": -2}),
        *((text, {}) for text in ("..", "", "18", "1...2", "1..2..3", "a..b", ".5..1", "1 .. 2")),
    ],
)
def test_ranges_are_read_from_texts(text: str, expected: dict[str, float]) -> None:
    assert ends(text) == expected


@pytest.mark.parametrize("value", ["2..5.5", FigureRange(min=2, max=5.5)])
def test_all_forms_of_a_range_have_the_same_bounds(value: Any) -> None:
    assert bounds(value) == (2, 5.5)


def test_facts_are_kept_as_they_are_written() -> None:
    level = Level.from_fields({"version": 1, "expect": EXPECT})
    assert level.to_dict()["expect"] == EXPECT
    assert brl.loads(level.to_yaml()).to_dict() == level.to_dict()
    assert list(level.expect.stated) == [*EXPECT]  # type: ignore[union-attr]


def test_saving_keeps_the_lines_of_facts() -> None:
    text = 'version: 1\ntheme: green\nexpect:\n  cells: 9.0  # all\n  best_return: "-4..-3"\n'
    saved = brl.loads(text).replace(theme="print").to_yaml(comments=True)
    assert saved == text.replace("green", "print")


def test_figures_keep_their_decimals_wherever_they_are_written() -> None:
    text = "version: 1\nsize: [3, 1]\nexpect:\n  best_return: -1.00\n  best_steps: 2\n"
    level = brl.loads(text)
    assert level.to_yaml() == text
    assert level.resolve().to_yaml() == text
    assert level.replace(size=[2, 1]).to_yaml() == text.replace("[3", "[2")


def test_facts_change_nothing_else() -> None:
    bare = Level.from_fields({"version": 1})
    level = bare.replace(expect=EXPECT)
    assert level.digest == bare.digest
    assert level.share_code() == bare.share_code()
    assert exact_return(level) == exact_return(bare)


def exact_return(level: Level) -> Any:
    return brl.solve(level, exact=True).expected_return


@pytest.mark.parametrize(
    ("written", "mapping"),
    [("12..", {"min": 12}), ("..30", {"max": 30}), ("12..30", {"min": 12, "max": 30})],
)
def test_ranges_of_suites_may_be_texts(written: str, mapping: dict[str, int]) -> None:
    base = {"version": 1, "kind": "suite", "count": 3}
    one, other = (brl.load_suite({**base, "path_length": value}) for value in (written, mapping))
    assert one.to_dict() == other.to_dict()
    assert [level.digest for level in one] == [level.digest for level in other]
