"""Observations are defined once: every table fits its space, and the page lists all of them."""

from __future__ import annotations

import re

import numpy as np
import pytest
from gymnasium import spaces
from support.places import DOCS
from support.playing import level_named

from babyrobot_levels.envs.observations import NUMERIC, OBSERVATIONS, make_observer
from babyrobot_levels.envs.spaces import ACTION_SETS

PAGE = (DOCS / "environments.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("largest", [(8, 5), (11, 9)])
@pytest.mark.parametrize("observation", NUMERIC)
def test_tables_and_observers_show_the_same_in_their_space(
    observation: str, largest: tuple[int, int]
) -> None:
    level = level_named("final-maze")
    assert level.size == (8, 5)
    table = NUMERIC[observation].table(level, largest)
    observer = make_observer(level, observation, largest, None, False)
    assert table.dtype == np.int64
    assert len(table) == 40
    for state, row in enumerate(table.tolist()):
        one, other = observer.at(state)(), observer.at(state)()
        assert one in observer.space
        if isinstance(observer.space, spaces.Discrete):
            assert [one] == row
        else:
            assert one.tolist() == row
            assert not np.shares_memory(one, other)


def test_there_are_no_observations_without_a_name() -> None:
    assert set(OBSERVATIONS) == {*NUMERIC, "image"}


@pytest.mark.parametrize(
    ("heading", "names"), [("Observation Space", OBSERVATIONS), ("Action Space", ACTION_SETS)]
)
def test_the_page_lists_all(heading: str, names: list[str]) -> None:
    section = PAGE.partition(f"\n## {heading}\n")[2].partition("\n## ")[0]
    assert set(re.findall(r'^\| `"(\w+)"` \|', section, re.MULTILINE)) == set(names)
    arguments = PAGE.partition("\n## Arguments\n")[2].partition("\n## ")[0]
    assert all(f'`"{name}"`' in arguments for name in names)


def test_the_page_has_gymnasiums_headings_in_their_order() -> None:
    headings = re.findall(r"^## (.+)$", PAGE, re.MULTILINE)
    assert headings[:9] == [
        "Description",
        "Action Space",
        "Observation Space",
        "Starting State",
        "Rewards",
        "Episode End",
        "Information",
        "Arguments",
        "Version History",
    ]
