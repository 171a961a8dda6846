"""Wind in generated levels: as many rows and columns as asked for, and always a way to the exit."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from support.combinations import swept

import babyrobot_levels as brl
from babyrobot_levels.generation import search
from babyrobot_levels.language.base import SIDE_NAMES

FIELDS: dict[str, Any] = {
    "version": 1,
    "kind": "suite",
    "name": "windy",
    "count": 30,
    "size": {"min": [4, 5], "max": [7, 7]},
    "maze": {"algorithm": "wilson", "loops": {"max": 1}},
    "exit": "farthest",
    "puddles": {"max": 2},
    "wind": {"min": 1, "max": 3},
}


def lines(level: brl.Level) -> int:
    given = (
        {}
        if level.wind is None
        else level.wind.model_dump(include={*SIDE_NAMES}, exclude_none=True)
    )
    assert {strength for side in given.values() for strength in side} <= {0, 1}
    return sum(map(sum, given.values()))


def may_never_get_out(level: brl.Level) -> bool:
    """Whether the robot can get into a state from which no exit can be reached."""
    mdp = level.compile()
    leads = np.zeros((mdp.num_states, mdp.num_states), bool)
    for state in np.flatnonzero(~mdp.is_terminal):
        leads[state, mdp.next_state[state][mdp.probability[state] > 0]] = True
    reach = leads | np.eye(len(leads), dtype=bool)
    for _ in range(len(leads).bit_length()):
        reach = reach @ reach
    met = reach[np.flatnonzero(mdp.start)].any(axis=0)
    return not reach[met][:, mdp.is_terminal].any(axis=1).all()


@pytest.mark.slow
@pytest.mark.parametrize(
    "more", swept([{}], [{"start": "farthest"}, {"keys": 1, "guards": {"max": 1}}])
)
def test_there_is_a_way_out_of_wherever_the_wind_pushes(more: dict[str, Any]) -> None:
    suite = brl.load_suite({**FIELDS, **more, "count": 12})
    counts = set()
    for level in suite:
        counts.add(lines(level))
        assert not may_never_get_out(level)
        assert level.to_dict()["wind"]
    assert counts == {1, 2, 3}


@pytest.mark.slow
def test_environments_show_the_wind_of_all_levels() -> None:
    suite = brl.load_suite({**FIELDS, "wind": {"max": 1}})
    assert any(level.wind is None for level in suite)
    envs = brl.LevelVectorEnv(levels=suite, num_envs=len(suite), observation="planes")
    planes = envs.get_attr("plane_names")[0]
    observations, _ = envs.reset(seed=1)
    pushes = np.array([observations[:, planes.index(f"wind-{side}")].any(axis=(1, 2))
                       for side in ("north", "east", "south", "west")])  # fmt: skip
    assert pushes.any(axis=0).tolist() == [level.wind is not None for level in suite]


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"wind": 13}, "the smallest level has only 9 rows and columns"),
        ({"wind": {"min": 3, "max": 1}}, "wind"),
        ({"wind": -1}, "wind"),
    ],
)
def test_what_cannot_be_is_an_error(fields: dict[str, Any], message: str) -> None:
    with pytest.raises(brl.LevelError, match=message):
        brl.load_suite({**FIELDS, **fields})


def test_too_much_wind_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(search, "MOST_TRIES", 50)
    suite = brl.load_suite({**FIELDS, "size": [7, 7], "maze": {}, "wind": 14})
    with pytest.raises(search.UnsatisfiableError, match="a way against the wind"):
        suite[0]
