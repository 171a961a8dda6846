"""What outcomes mean: whether the robot comes where the action leads, and whether it is hit."""

from __future__ import annotations

from random import Random
from typing import Any

import numpy as np
import pytest
from oracles.random_things import random_level
from oracles.things_reference import Reference
from support.each import for_each

import babyrobot_levels as brl
from babyrobot_levels.mdp.actions import Turn
from babyrobot_levels.mdp.tables import Event, events_of, hits_of


def happening(level: dict[str, Any], actions: list[int]) -> list[tuple[str, bool]]:
    """Take actions from the start of a level without chance; return event and hit of each."""
    loaded = brl.load({"version": 1, **level})
    mdp = loaded.compile()
    events, hits = events_of(mdp), hits_of(loaded, mdp)
    state, told = int(mdp.start.argmax()), []
    for action in actions:
        told.append((Event(events[state, action, 0]).name, bool(hits[state, action, 0])))
        state = int(mdp.next_state[state, action, 0])
    return told


def test_a_robot_that_takes_an_item_or_flips_a_switch_reaches_its_target() -> None:
    level = {
        "size": [3, 1],
        "items": [{"name": "key", "at": [1, 0]}],
        "exit": "none",
        "switches": [{"name": "lever", "at": [2, 0]}],
    }
    reached, bumped = ("REACHED", False), ("BUMPED", False)
    assert happening(level, [2, 2, 2, 1, 4]) == [reached, reached, bumped, bumped, reached]


@pytest.mark.parametrize("turning", [False, True])
def test_what_a_warp_draws_is_where_the_robot_wanted_to_go(turning: bool) -> None:
    warp = {"at": [1, 0], "to": [[2, 0], [3, 0]], "probability": 0.5}
    level = {"size": [4, 2], "exit": [0, 1], "skid": {"probability": 0.2, "to": "others"}}
    mdp = brl.load({"version": 1, **level, "warps": [warp]}).compile()
    mdp = mdp.turning() if turning else mdp
    state = int(mdp.start.argmax())
    events = events_of(mdp)[state, 2]
    told = {
        mdp.cell(following): Event(event).name
        for following, event, chance in zip(
            mdp.next_state[state, 2], events, mdp.probability[state, 2], strict=True
        )
        if chance
    }
    drawn = dict.fromkeys([(1, 0), (2, 0), (3, 0)], "REACHED")
    assert told == drawn | dict.fromkeys([(0, 0), (0, 1)], "SKIDDED")


def test_movers_hit_those_whose_cell_they_enter_or_that_they_pass() -> None:
    level = {
        "size": [4, 1],
        "start": [0, 0],
        "exit": "none",
        "switches": [{"name": "lever", "at": [1, 0]}],
        "movers": [{"path": [[2, 0], [3, 0]], "back": True}],
        "hit": {"ends": False},
    }
    # After these steps the mover is at 3, 2, 3, 2, 3, 2, 3 and the robot at 0, 1, 2, 3, 3, 2, 1.
    hits = [hit for _, hit in happening(level, [0, 2, 2, 2, 0, 4, 4])]
    assert hits == [False, False, False, True, True, True, False]


@pytest.mark.slow
@for_each("seed", range(50))
def test_hits_are_those_of_the_reference(seed: int) -> None:
    fields = random_level(Random(seed))
    level, reference = brl.Level.from_fields(fields), Reference(fields)
    mdp = level.compile()
    for tables in (mdp, mdp.turning("S")):
        hits = hits_of(level, tables)

        def pair(state: int, tables: Any = tables) -> Any:
            number = tables.configuration(state)
            return tuple(tables.configurations[number].tolist()), tables.cell(state)

        for state, action, outcome in np.argwhere(tables.probability > 0).tolist():
            after = int(tables.next_state[state, action, outcome])
            wanted = not tables.is_terminal[state] and reference.is_hit(pair(state), pair(after))
            assert hits[state, action, outcome] == wanted, (fields, state, action)


@pytest.mark.parametrize("heading", "NESW")
def test_a_robot_that_turns_reaches_its_target(heading: str) -> None:
    level = brl.load({"version": 1, "size": [2, 2], "items": [{"name": "key", "at": [1, 0]}]})
    mdp = level.compile().turning(heading)
    events = events_of(mdp)[~mdp.is_terminal]
    assert (events[:, [Turn.LEFT, Turn.RIGHT], 0] == Event.REACHED).all()
    assert set(np.unique(events[:, Turn.FORWARD, 0])) == {Event.REACHED, Event.BUMPED}


@pytest.mark.parametrize("actions", [[1], [1, 5], [-1, 0], [1, 2, 3], [0.5, 1], 3, "ab", None])
def test_only_actions_of_all_robots_are_a_joint_action(actions: Any) -> None:
    robots = [{"name": "a", "start": [0, 0]}, {"name": "b", "start": [1, 0]}]
    mdp = brl.load({"version": 1, "size": [3, 1], "robots": robots}).compile()
    assert mdp.joint_action([[1, 2], [4, 4]]).tolist() == [7, 24]
    with pytest.raises(ValueError, match="is not an action, 0 to 4, of each of the 2 robots"):
        mdp.joint_action(actions)


def test_environments_draw_starts_as_often_as_weights_say() -> None:
    level = brl.load(
        {
            "version": 1,
            "start": [[0, 0], [1, 0]],
            "start_weights": [4, 6],
            "exit_one_of": [[2, 1], [2, 2]],
            "exit_weights": [1, 2],
        }
    )
    mdp = level.compile()
    states, counts = np.unique(mdp.starts, return_counts=True)
    assert counts.tolist() == [2, 3, 4, 6]
    assert mdp.start[states] == pytest.approx(counts / 15)
    env: Any = level.make()
    begun = [(env.reset(seed=seed), env.unwrapped.state)[1] for seed in range(3000)]
    found = np.bincount(begun, minlength=mdp.num_states)[states] / 3000
    # Four standard deviations of a share of 3,000.
    assert np.abs(found - counts / 15).max() < 4 * 0.5 / 3000**0.5
    vector = brl.LevelVectorEnv(levels=[level], num_envs=3000)
    observations, _ = vector.reset(seed=1)
    # An observation tells the configuration and the cell.
    _, seen = np.unique(np.asarray(observations), axis=0, return_counts=True)
    assert np.abs(np.sort(seen) / 3000 - counts / 15).max() < 4 * 0.5 / 3000**0.5
