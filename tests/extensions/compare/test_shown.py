"""What a difference shows of itself in notebooks."""

from __future__ import annotations

import dataclasses
import re

from support.notebooks import assert_fits, assert_shows_numbers_only, shown, svgs

import babyrobot_levels as brl
from babyrobot_levels.render.scene.marks import MARK


def test_a_difference_marks_what_changed_in_both_pictures() -> None:
    before = brl.loads("version: 1\nsize: [4, 3]\n")
    walls = brl.loads("version: 1\nsize: [4, 3]\nwalls: [{at: [1, 1], side: E}]\n")
    wet = before.replace(puddles=[{"at": [2, 0], "size": "large"}])
    counts = []
    for after in (before, walls, wet):
        html, text = shown(brl.diff(before, after, limit=0))
        counts.append([picture.count(MARK) for picture in svgs(html)])
        assert text.count("\n") == 0
    assert counts == [[0, 0], [1, 1], [1, 1]]
    # Where there is no wall, dots stand for it.
    html = shown(brl.diff(before, walls))[0]
    dotted = [re.search(f'stroke="{MARK}"[^>]*dasharray', picture) for picture in svgs(html)]
    assert [each is not None for each in dotted] == [True, False]


def test_a_moved_exit_is_marked_where_it_is() -> None:
    level = brl.Level(version=1, size=(4, 3))
    one, two = svgs(shown(brl.diff(level, level.replace(exit=(0, 2))))[0])
    assert (one.count(MARK), two.count(MARK)) == (1, 1)
    assert [line for line in one.splitlines() if MARK in line] != [
        line for line in two.splitlines() if MARK in line
    ]


def test_a_difference_has_pictures_that_fit_and_numbers_where_its_levels_are_not_known() -> None:
    found = brl.diff("puddles", "maze")
    assert_fits(found)
    assert_shows_numbers_only(dataclasses.replace(found, levels=None))
