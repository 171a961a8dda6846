"""What results show of themselves in notebooks, and as text elsewhere."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

import pytest
from support.notebooks import assert_fits, assert_shows_numbers_only, shown, svgs, texts

import babyrobot_levels as brl
from babyrobot_levels.library.catalogue import LevelList

HOSTILE = "<script>alert(1)</script>&"


# -- values and policies -------------------------------------------------------------------


def test_a_solution_shows_its_picture_and_its_numbers() -> None:
    best = brl.solve("puddles")
    html, text = shown(best)
    assert svgs(html) == [brl.load("puddles").to_svg(values=best, policy=best)]
    number = f"{best.expected_return:.6g}".replace("-", "\N{MINUS SIGN}")
    assert f"Expected return {number}" in texts(html)
    assert text == repr(best)
    assert text.startswith("<Solution expected_return=")


@pytest.mark.parametrize(
    "make",
    [
        lambda: brl.evaluate("frozen-lake", "random"),
        lambda: brl.solve("two-levers").at(1),
        lambda: brl.solve("door-key", actions="turns"),
        lambda: brl.metrics("two-levers"),
    ],
)
def test_results_show_pictures_that_fit_and_are_short_as_text(make: Any) -> None:
    assert_fits(make())


def test_a_result_whose_level_is_not_known_shows_its_numbers() -> None:
    for result in (
        dataclasses.replace(brl.solve("puddles"), level=None),
        brl.solve("door-key", actions="turns").at(0),
    ):
        assert_shows_numbers_only(result)


def test_an_infinite_return_is_explained() -> None:
    level = brl.loads("version: 1\nsize: [3, 1]\nexit: none\n")
    assert "costs add up without bound" in texts(shown(brl.solve(level))[0])


# -- learning ------------------------------------------------------------------------------


# -- metrics, differences, lists -----------------------------------------------------------


def test_metrics_are_a_table() -> None:
    found = brl.metrics("maze")
    text = texts(shown(found)[0])
    for name, value in found.to_dict().items():
        number = f"{value:.6g}".replace("-", "\N{MINUS SIGN}")
        assert f"{name.replace('_', ' ')} {number}" in text


def written(folder: Path, count: int, title: str = "A level") -> None:
    for number in range(count):
        text = f"version: 1\nname: mine-{number:02}\ntitle: {title!r}\n"
        (folder / f"mine-{number:02}.yaml").write_text(text, "utf-8")


@pytest.mark.slow
def test_a_list_of_levels_is_a_table_with_at_most_fifty_pictures(here: Path) -> None:
    (here / "levels").mkdir()
    written(here / "levels", 60, HOSTILE)
    found = brl.levels()
    mine = LevelList(info for info in found if info.name.startswith("mine-"))
    html, text = shown(mine)
    assert html.count("<img ") == 50
    assert texts(html).count("alert(1)") == 60
    assert "<script>" not in html
    assert len(text.splitlines()) == 22
    assert text.splitlines()[0] == "60 levels"
    assert text.splitlines()[-1] == "  … and 40 more"
    # It is a list like any other.
    assert isinstance(found, list)
    assert mine[1:3] == [mine[1], mine[2]]
    assert shown(mine[1:3])[0].count("<img ") == 2


def test_a_level_of_a_list_shows_its_facts(here: Path) -> None:
    (here / "levels").mkdir()
    written(here / "levels", 1)
    (info,) = (info for info in brl.levels() if info.name == "mine-00")
    html, text = shown(info)
    assert html.count("<img ") == 1
    assert "Name mine-00 Title A level Size 3 × 3" in texts(html)
    assert text == "<LevelInfo 'mine-00': 3x3 'A level'>"
    info.path.unlink()
    assert "<img " not in shown(info)[0]


def test_texts_of_levels_are_escaped() -> None:
    level = brl.load("puddles").replace(title=HOSTILE)
    for result in (brl.solve(level), brl.metrics(level)):
        html, _ = shown(result)
        assert "<script>" not in html
        assert "&lt;script&gt;" in html
        assert all("<script>" not in picture for picture in svgs(html))


# -- strips --------------------------------------------------------------------------------
