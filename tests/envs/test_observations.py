"""Observations are defined once: every table fits its space, and the page lists all of them."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest
from gymnasium import spaces
from support.combinations import combined
from support.places import DOCS
from support.playing import level_named

import babyrobot_levels as brl
from babyrobot_levels.envs.observations import OBSERVATIONS, make_batch_observer, make_observer
from babyrobot_levels.envs.observations.base import BatchObserver, Extent, Observation
from babyrobot_levels.envs.spaces import ACTION_SETS
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


@combined(
    1,
    turns=[False, True],
    name=["final-maze", "things of all kinds"],
    observation=[*OBSERVATIONS, tuple(OBSERVATIONS)],
)
def test_one_many_and_all_states_show_the_same_in_their_space(
    observation: Any, name: str, turns: bool
) -> None:
    level, other = level_named(name), level_named("four-corners")
    extent = Extent.of([level, other], turns=turns)
    observer = make_observer(level, Observation(observation), extent)
    count = level.compile().num_states * extent.headings
    assert observer.states().tolist() == [*range(count)]
    states = np.arange(0, count, 1 + count // 50)
    before = other.compile().num_states * extent.headings
    batch = make_batch_observer(Observation(observation), extent, 1)
    plain = BatchObserver(type(observer), extent, Observation(observation), 1)
    for many in (batch, plain):
        many.write_all(np.array([0, before, before + count]), [other, level])
    rows, gathered = observer.rows(states), batch.gather(before + states)
    each = [observer.at(state)() for state in states.tolist()]
    assert all(one in observer.space for one in each)
    if isinstance(observation, str):
        assert np.array_equal(plain.gather(before + states), gathered)
        assert np.array_equal(rows, each)
        assert np.array_equal(gathered, each)
        assert rows.dtype == gathered.dtype == observer.space.dtype
        assert not np.shares_memory(each[0], observer.at(0)())
        return
    for part in observation:
        assert np.array_equal(rows[part], [one[part] for one in each])
        assert np.array_equal(gathered[part], rows[part])


@pytest.mark.parametrize("observation", ["position", "index", "walls", "vector"])
def test_rows_tell_states_apart(observation: str) -> None:
    level = level_named("things of all kinds")
    observer = make_observer(level, Observation(observation), Extent.of([level], turns=True))
    rows = observer.rows(observer.states())
    assert len(np.unique(rows, axis=0)) == len(rows)


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


@pytest.mark.parametrize(
    ("heading", "names"), [("Observation Space", OBSERVATIONS), ("Action Space", ACTION_SETS)]
)
def test_the_page_lists_all(heading: str, names: list[str]) -> None:
    section = PAGE.partition(f"\n## {heading}\n")[2].partition("\n## ")[0]
    assert set(re.findall(r'^\| `"(\w+)"` \|', section, re.MULTILINE)) == set(names)
    arguments = PAGE.partition("\n## Arguments\n")[2].partition("\n## ")[0]
    assert all(f'`"{name}"`' in arguments for name in names)
    told = f"{brl.LevelEnv.__doc__}{brl.LevelEnv.__init__.__doc__}"
    assert all(f'"{name}"' in told for name in names)


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
