"""What an episode can come to, in levels with things."""

from __future__ import annotations

from typing import Any

import numpy as np

import babyrobot_levels as brl
from babyrobot_levels.mdp.states import ends_by_hit, exit_states, reach_of, transitions

# The key lies to the west, the exit to the east.
LOCKED: dict[str, Any] = {
    "version": 1,
    "size": [4, 1],
    "start": [1, 0],
    "exit": [3, 0],
    "exit_needs": "key",
    "items": [{"name": "key", "at": [0, 0]}],
}

# A guard walks to and fro in a corridor with a niche, and there is no exit.
GUARD: dict[str, Any] = {
    "version": 1,
    "size": [4, 2],
    "exit": "none",
    "blocked": [{"at": [x, 1]} for x in (0, 1, 3)],
    "movers": [{"path": [[1, 0], [2, 0], [3, 0]], "back": True}],
}


def test_exits_are_those_that_are_open() -> None:
    level = brl.load(LOCKED)
    assert np.flatnonzero(exit_states(level, level.compile())).tolist() == [7]
    turning = level.compile().turning("E")
    # Configuration 1, any heading, the last cell.
    assert np.flatnonzero(exit_states(level, turning)).tolist() == [19, 23, 27, 31]


def test_a_drawn_exit_is_one_in_its_own_configurations() -> None:
    level = brl.load(
        {"version": 1, "size": [3, 1], "start": [1, 0], "exit_one_of": [[0, 0], [2, 0]]}
    )
    assert np.flatnonzero(exit_states(level, level.compile())).tolist() == [0, 5]


def test_steps_to_the_exit_lead_by_what_it_needs() -> None:
    level = brl.load(LOCKED)
    reach = reach_of(level, level.compile())
    assert list(reach.steps) == [-1, 0, 1, 2, 1, 2, 3, 4]
    assert list(reach.to_exit) == [-1, 4, 5, 6, 3, 2, 1, 0]
    assert [bool(on) for on in reach.on] == [False, *[True] * 6, False]


def test_a_hit_is_an_end_but_leads_nowhere() -> None:
    level = brl.load(GUARD)
    mdp = level.compile()
    reach = reach_of(level, mdp)
    hits = ends_by_hit(mdp)
    assert hits.any()
    assert mdp.terminal[hits].all()
    going_on = np.flatnonzero(~mdp.is_terminal)
    # Wherever an episode goes on, the guard can be met.
    assert all(reach.to_end[state] > 0 for state in going_on)
    assert {reach.to_exit[state] for state in going_on} == {-1}
    # The guard walks away and comes back: at the earliest they change places in the third step.
    assert reach.to_end[int(mdp.start.argmax())] == 3
    graph = transitions(mdp)
    pairs = set(zip(graph.source.tolist(), graph.target.tolist(), strict=True))
    plain = (mdp.probability > 0) & ~mdp.terminal
    states = np.arange(mdp.num_states)[:, None, None]
    steps = np.broadcast_to(states, plain.shape)[plain], mdp.next_state[plain]
    expected = {(int(one), int(two)) for one, two in zip(*steps, strict=True) if one != two}
    assert {pair for pair in pairs if not mdp.is_terminal[pair[1]]} == expected
