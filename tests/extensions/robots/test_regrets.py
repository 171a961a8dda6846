"""What a team loses, and whose loss it is: games whose answers are known, and brute force."""

from __future__ import annotations

from itertools import product
from random import Random
from typing import Any

import numpy as np
import pytest
from oracles.random_teams import random_team

import babyrobot_levels as brl
from babyrobot_levels.text.errors import LevelError

PASSING = "passing-place"
MEETING: dict[str, Any] = {
    # Both want the cell between them, which one alone can enter: a game of chicken.
    "version": 1,
    "size": [3, 1],
    "exit": "none",
    "robots": [{"name": "a", "start": [0, 0]}, {"name": "b", "start": [2, 0]}],
    "areas": [{"at": [1, 0], "ends": True, "reward": 10}],
    "rewards": {"step": 0, "meet": -4},
    "discount": 0.5,
}


def states_of(level: brl.Level) -> int:
    return level.compile().num_states


def always(level: brl.Level, action: int) -> np.ndarray[Any, Any]:
    return np.full(states_of(level), action)


def test_the_optimum_has_no_regret() -> None:
    for level in (PASSING, "two-pads"):
        found = brl.score_team(level, "best")
        assert found.regret == pytest.approx(0, abs=1e-9)
        assert [each.team_regret for each in found.robots] == pytest.approx([0, 0], abs=1e-9)
        assert found.expected_return == pytest.approx(
            sum(each.expected_return for each in found.robots)
        )


def test_two_that_both_go_lose_by_it_and_two_that_both_stay_lose_as_well() -> None:
    level = brl.load(MEETING)
    both = brl.score_team(level, [always(level, 2), always(level, 4)])
    # -4 each, for ever: -4 / (1 - 0.5).
    assert [each.expected_return for each in both.robots] == pytest.approx([-8, -8])
    # While the other goes on, who stays gets 0, and the other gets 10 at once.
    assert [each.best_return for each in both.robots] == pytest.approx([0, 0])
    assert [each.regret for each in both.robots] == pytest.approx([8, 8])
    assert [each.team_return for each in both.robots] == pytest.approx([10, 10])
    assert (both.expected_return, both.best_return) == (-16, 10)
    assert both.coordination == pytest.approx(0)
    assert not both.is_equilibrium
    neither = brl.score_team(level, [always(level, 0), always(level, 0)])
    assert [each.best_return for each in neither.robots] == pytest.approx([10, 10])
    assert not neither.is_equilibrium


def test_each_that_gives_way_to_the_other_is_an_equilibrium() -> None:
    level = brl.load(MEETING)
    for one, other in ((2, 0), (0, 4)):
        found = brl.score_team(level, [always(level, one), always(level, other)])
        assert (found.expected_return, found.is_equilibrium) == (10, True)
        assert found.regret == pytest.approx(0)


def test_a_loss_that_nobody_can_save_alone_is_one_of_coordination() -> None:
    fields = {**MEETING, "areas": [], "targets": [{"at": [0, 0]}, {"at": [2, 0]}]}
    fields |= {"size": [4, 1], "rewards": {"step": 0, "exit": 5}, "discount": 0.9}
    fields["robots"] = [{"name": "a", "start": [1, 0]}, {"name": "b", "start": [3, 0]}]
    level = brl.load(fields)
    found = brl.score_team(level, [always(level, 0), always(level, 0)])
    assert (found.best_return, found.expected_return) == (10, 0)
    # A target that is covered alone ends nothing.
    assert [each.team_regret for each in found.robots] == [0, 0]
    assert (found.coordination, found.is_equilibrium) == (10, True)


def pairs() -> list[brl.Level]:
    """Return random levels with two robots and few states."""
    teams = [random_team(Random(seed)) for seed in range(40)]
    levels = [brl.load(fields) for fields in teams if fields and len(fields["robots"]) == 2]
    return [level for level in levels if level.compile().num_states <= 1_000][:8]


@pytest.mark.sweep
@pytest.mark.parametrize("seed", range(8))
def test_best_answers_are_those_of_value_iteration(seed: int) -> None:
    level = pairs()[seed]
    mdp, rng = level.compile(), np.random.default_rng(seed)
    own = [rng.dirichlet(np.ones(5), mdp.num_states) for _ in range(mdp.num_robots)]
    found = brl.score_team(level, own, discount=0.8)
    assert mdp.shares is not None
    for robot, told in enumerate(found.robots):
        values = np.zeros(mdp.num_states)
        for _ in range(150):
            ahead = np.zeros((mdp.num_states, 5))
            for joint, actions in enumerate(product(range(5), repeat=2)):
                goes_on = np.where(mdp.terminal[:, joint], 0.0, values[mdp.next_state[:, joint]])
                gain = mdp.shares[:, joint, :, robot] + 0.8 * goes_on
                worth = (mdp.probability[:, joint] * gain).sum(axis=1)
                ahead[:, actions[robot]] += own[1 - robot][:, actions[1 - robot]] * worth
            values = np.where(mdp.is_terminal, 0.0, ahead.max(axis=1))
        assert told.best_return == pytest.approx(float(mdp.start @ values), abs=1e-6)
        assert told.regret >= -1e-9


def test_weights_say_what_counts_for_the_team() -> None:
    level = brl.load(MEETING)
    goes, stays = always(level, 2), always(level, 0)
    # Who goes gets the 10; the other one, who stays, gets nothing.
    scores = {
        weights: brl.score_team(level, [goes, stays], weights=weights)
        for weights in ((1, 1), (3, 1), (0, 2))
    }
    assert [each.expected_return for each in scores.values()] == [10, 30, 0]
    assert [each.best_return for each in scores.values()] == [10, 30, 20]
    assert [each.regret for each in scores.values()] == [0, 0, 20]
    for each in scores.values():
        assert [robot.expected_return for robot in each.robots] == [10, 0]
        assert [robot.regret for robot in each.robots] == [0, 0]
    assert brl.score_team(level, "best", weights=(0, 2)).expected_return == 20
    wrongs: list[Any] = [(1,), (1, -1), (1, float("nan")), "ab", ("1", "2")]
    for wrong in wrongs:
        with pytest.raises(ValueError, match="2 numbers, one for each robot"):
            brl.score_team(level, "best", weights=wrong)


def test_wrong_policies_are_named() -> None:
    level = brl.load(PASSING)
    for policies, told in (
        ([always(level, 0)], "1 policies for 2 robots: red, blue"),
        ([always(level, 7), "random"], "the action of red at .* is 7; actions are 0 to 4"),
        (["random", [1, 2]], "the policy of blue is an array"),
        (["random", np.ones((states_of(level), 5))], "the probabilities of blue"),
        (["random", np.full((states_of(level), 5), np.nan)], "the probabilities of blue"),
    ):
        with pytest.raises(ValueError, match=told):
            brl.score_team(level, policies)
    with pytest.raises(ValueError, match="one robot"):
        brl.score_team("final-maze", "best")
    with pytest.raises(LevelError):
        brl.score_team({"version": 1, "robots": [{"name": "a"}]}, "best")


def test_coordination_is_known_where_the_team_never_ends() -> None:
    # Each can wait for the other to come by chance, so that either could end what never ends.
    found = brl.score_team("two-pads", "random")
    assert found.expected_return == -np.inf
    assert max(each.team_return for each in found.robots) == pytest.approx(-90.8333333)
    assert found.coordination == pytest.approx(80.8333333)


def test_it_shows_itself_as_a_table() -> None:
    found = brl.score_team(PASSING, "random")
    html = found._repr_mimebundle_()["text/html"]
    assert html.count("<tr>") == 4
    assert "<td>blue</td>" in html
