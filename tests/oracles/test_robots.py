"""Several robots: the compiled tables against the plain reference, outcome by outcome."""

from __future__ import annotations

from random import Random

import numpy as np
import pytest
from oracles.random_teams import random_team
from oracles.random_things import Fields
from oracles.robots_reference import Joint, TeamReference

import babyrobot_levels as brl

MOST, MORE = 12_000, 60_000
"""The most states times joint actions of a level that the reference is asked about."""


class Numbering:
    """The numbers that the tables of a level give to the states of the reference."""

    def __init__(self, level: brl.Level) -> None:
        self.mdp, things = level.compile(), level.things()
        self.first, self.movers = things.of_kind("robot").start, len(level.movers)
        rows = self.mdp.configurations.tolist()
        self.configurations = {tuple(row): number for number, row in enumerate(rows)}

    def state(self, joint: Joint) -> int:
        """Return the number of a state."""
        cells = [y * self.mdp.width + x for (x, y), _ in joint.places]
        arrived = [int(home) for _, home in joint.places]
        robots = [arrived[0]]
        pairs = zip(cells[1:], arrived[1:], strict=True)
        robots += [cell + self.mdp.cells * home for cell, home in pairs]
        values = joint.configuration
        values = (*values[: self.first], *robots, *values[self.first :])
        return self.configurations[values] * self.mdp.cells + cells[0]


def assert_agrees(fields: Fields, level: brl.Level) -> None:
    reference, mdp, numbers = TeamReference(fields), level.compile(), Numbering(level)
    start = np.zeros(mdp.num_states)
    for joint, probability in reference.start.items():
        start[numbers.state(joint)] += probability
    assert start == pytest.approx(mdp.start)
    going_on = {numbers.state(joint) for joint in reference.results}
    assert going_on == {*np.flatnonzero(~mdp.is_terminal).tolist()}
    robots = range(len(reference.robots))
    for joint, rows in reference.results.items():
        state, allowed = numbers.state(joint), [reference.allowed(joint, each) for each in robots]
        for actions, total in rows.items():
            action = int(mdp.joint_action(actions))
            assert (*mdp.robot_actions(action).tolist(),) == actions
            is_valid = all(each in known for each, known in zip(actions, allowed, strict=True))
            assert bool(mdp.action_mask[state, action]) == is_valid
            expected = sorted(
                (numbers.state(after), *map(float, shares), over, probability)
                for (after, shares, over), probability in total.items()
            )
            assert mdp.shares is not None
            outcomes = mdp.outcomes(state, action)
            shares = mdp.shares[state, action, : len(outcomes)].tolist()
            found = sorted(
                (after, *share, over, probability)
                for (probability, after, _, over), share in zip(outcomes, shares, strict=True)
            )
            assert len(found) == len(expected)
            for one, other in zip(found, expected, strict=True):
                assert one == pytest.approx(other, abs=1e-12)
            sums = [sum(share) for share in shares]
            assert sums == pytest.approx([reward for _, _, reward, _ in outcomes])


@pytest.mark.parametrize(
    ("first", "count"), [(0, 10), pytest.param(10, 140, marks=pytest.mark.sweep)]
)
def test_random_teams_agree_with_the_reference(first: int, count: int) -> None:
    _assert_agree(range(first, first + count), MOST)


@pytest.mark.sweep
@pytest.mark.parametrize("first", range(0, 1200, 60))
def test_more_random_teams_agree_with_the_reference(first: int) -> None:
    _assert_agree(range(first, first + 60), MORE)


def _assert_agree(seeds: range, most: int) -> None:
    tried = 0
    for seed in seeds:
        fields = random_team(Random(seed))
        if fields is None:
            continue
        level = brl.load(fields)
        try:
            mdp = level.compile()
        except brl.UnplayableError:
            # So much happens by chance that the tables are too large.
            continue
        if mdp.num_states * mdp.num_actions <= most:
            assert_agrees(fields, level)
            tried += 1
    assert tried


# The reference, checked by hand.


def corridor(**more: object) -> TeamReference:
    robots = [{"name": "a", "start": [0, 0]}, {"name": "b", "start": [2, 0]}]
    return TeamReference({"size": [3, 1], "exit": "none", "robots": robots, **more})


def test_the_reference_lets_nobody_through() -> None:
    (start,) = corridor().start
    assert start == Joint((), (((0, 0), False), ((2, 0), False)))
    (row,) = corridor().results[start][2, 4].items()
    assert row == ((start, (-1.0, -1.0), False), 1.0)


def test_the_reference_lets_the_first_go() -> None:
    reference = corridor(team={"meet": "order"})
    (start,) = reference.start
    ((after, shares, over),) = reference.results[start][2, 4]
    assert after.places == (((1, 0), False), ((2, 0), False))
    assert (shares, over) == ((-1.0, -1.0), False)
