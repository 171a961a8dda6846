"""Observations are defined once: every table fits its space, and the page lists all of them."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest
from gymnasium import spaces
from support.places import DOCS
from support.playing import level_named

import babyrobot_levels as brl
from babyrobot_levels.envs.action_sets import ACTION_SETS
from babyrobot_levels.envs.observations import OBSERVATIONS, Observation, make_observer
from babyrobot_levels.envs.observations.extent import Extent
from babyrobot_levels.envs.observations.numbers import NUMERIC, NumericObserver
from babyrobot_levels.library.level import Level

PAGE = (DOCS / "environments.md").read_text(encoding="utf-8")

KEY_AND_LEVER: dict[str, Any] = {
    "version": 1,
    "size": [3, 1],
    "exit": "none",
    "items": [{"name": "key", "one_of": [[1, 0], [2, 0]]}],
    "doors": [{"at": [0, 0], "side": "E", "unless": "key"}],
}
"""Its door closes when the key is taken."""


def observed(level: Level, name: str, extent: Extent, state: int) -> Any:
    return make_observer(level, Observation(name), extent).at(state)()


@pytest.mark.parametrize("turns", [False, True])
@pytest.mark.parametrize("other", ["final-maze", "four-corners", "things of all kinds"])
@pytest.mark.parametrize("name", ["final-maze", "things of all kinds"])
@pytest.mark.parametrize("observation", NUMERIC)
def test_tables_and_observers_show_the_same_in_their_space(
    observation: str, name: str, other: str, turns: bool
) -> None:
    level = level_named(name)
    extent = Extent.of([level, level_named(other)], turns=turns)
    table = NumericObserver(level, observation, extent).table()
    observer = make_observer(level, Observation(observation), extent)
    assert table.dtype == np.int64
    assert len(table) == level.compile().num_states * extent.headings
    for state in range(0, len(table), 1 + len(table) // 200):
        one, other_one = observer.at(state)(), observer.at(state)()
        assert one in observer.space
        if isinstance(observer.space, spaces.Discrete):
            assert [one] == table[state].tolist()
        else:
            assert one.tolist() == table[state].tolist()
            assert not np.shares_memory(one, other_one)
    assert len(np.unique(table, axis=0)) == len(table)


def test_numbers_end_with_the_configuration_and_the_heading() -> None:
    level = brl.load(KEY_AND_LEVER)
    # The value of the key is 0 or 1, the number of its place, and 2 while it is held.
    assert level.compile().configurations.tolist() == [[0], [1], [2]]
    extent, turning = (Extent.of([level], turns=turns) for turns in (False, True))
    assert observed(level, "position", extent, 2 * 3 + 1).tolist() == [1, 0, 2]
    assert observed(level, "position", turning, (2 * 4 + 3) * 3 + 1).tolist() == [1, 0, 2, 3]
    assert observed(level, "index", turning, (2 * 4 + 3) * 3 + 1) == 34
    assert observed(level, "walls", turning, (1 * 4 + 3) * 3).tolist() == [0, 0, 0, 1, 0, 0, 1, 3]
    assert observed(level, "walls", turning, (2 * 4 + 3) * 3).tolist() == [0, 0, 0, 0, 0, 0, 2, 3]


def test_levels_that_share_a_space_are_padded_to_the_most() -> None:
    small, large = brl.load(KEY_AND_LEVER), brl.load({"version": 1, "size": [4, 5]})
    mover = {"path": [[0, 0], [1, 0], [0, 0]]}
    both = brl.load({"version": 1, "size": [2, 1], "movers": [mover, mover]})
    extent = Extent.of([small, large, both], turns=True)
    assert extent == Extent((4, 5), (3, 3), 3, 4, True)
    assert make_observer(small, Observation("position"), extent).space == spaces.MultiDiscrete(
        [4, 5, 3, 3, 4]
    )
    assert observed(small, "position", extent, 2 * 12 + 6 + 1).tolist() == [1, 0, 2, 0, 2]
    assert observed(large, "position", extent, 20 + 19).tolist() == [3, 4, 0, 0, 1]
    assert observed(small, "index", extent, 2 * 12 + 6 + 1) == (2 * 4 + 2) * 20 + 1
    assert make_observer(both, Observation("index"), extent).space == spaces.Discrete(3 * 4 * 20)


def test_random_mazes_count_with_all_that_their_things_could_be() -> None:
    level = level_named("random mazes with things")
    assert Extent.of([level]) == Extent((4, 3), (3, 2), 6, has_items=True)
    env = brl.LevelEnv(level)
    for seed in range(20):
        observation, _ = env.reset(options={"maze_seed": seed})
        assert observation in env.observation_space


def test_pictures_show_things_and_headings() -> None:
    level = brl.load(KEY_AND_LEVER)
    extent = Extent.of([level], turns=True)
    observer = make_observer(level, Observation("image", image_size=(32, 48)), extent)
    pictures = [observer.at(state)() for state in range(36)]
    assert all(picture in observer.space for picture in pictures)
    assert len({picture.tobytes() for picture in pictures}) == 36


def test_pictures_of_a_level_without_items_have_no_row_for_them() -> None:
    plain = brl.load({"version": 1, "size": [3, 1]})
    extent = Extent.of([plain, brl.load(KEY_AND_LEVER)])
    picture = make_observer(plain, Observation("image", image_size=(32, 48)), extent).at(0)()
    assert picture[:16].any()
    assert not picture[16:].any()
    own = make_observer(plain, Observation("image", image_size=(16, 48)), Extent.of([plain]))
    assert np.array_equal(own.at(0)(), picture[:16])


def test_there_are_no_observations_without_a_name() -> None:
    assert set(OBSERVATIONS) == {*NUMERIC, "vector", "planes", "image", "view"}


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
