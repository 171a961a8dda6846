"""Solving, evaluating and simulating levels with things, and robots that turn."""

from __future__ import annotations

import pickle
from typing import Any

import numpy as np
import pytest

import babyrobot_levels as brl
from babyrobot_levels.analysis.solver import linear, model
from babyrobot_levels.analysis.solver.evaluation import evaluate, simulate, success_within
from babyrobot_levels.analysis.solver.optimum import solve

# From the start the key is to the west, and the exit behind the door to the east.
KEY: dict[str, Any] = {
    "version": 1,
    "size": [4, 1],
    "start": [1, 0],
    "exit": [3, 0],
    "items": [{"name": "key", "at": [0, 0]}],
    "doors": [{"at": [1, 0], "side": "E", "needs": "key"}],
}

# A guard walks to and fro in a corridor; the niche is in its middle.
GUARD: dict[str, Any] = {
    "version": 1,
    "size": [5, 2],
    "exit": [4, 0],
    "blocked": [{"at": [x, 1]} for x in (0, 1, 3, 4)],
    "movers": [{"name": "guard", "path": [[1, 0], [2, 0], [3, 0]], "back": True}],
    "hit": {"reward": -10},
}


def test_values_and_policy_have_an_axis_of_configurations() -> None:
    solution = solve(KEY)
    assert solution.values.shape == solution.policy.shape == (2, 1, 4)
    assert solution.action_values.shape == solution.greedy.shape == (2, 1, 4, 5)
    # West for the key, then east: two steps without the door, then one onto the exit.
    np.testing.assert_array_equal(solution.values[0], [[np.nan, -3, np.nan, np.nan]])
    np.testing.assert_array_equal(solution.values[1], [[-2, -1, 0, 0]])
    np.testing.assert_array_equal(solution.policy[:, 0], [[-1, 4, -1, -1], [2, 2, 2, -1]])
    assert (solution.expected_return, solution.expected_steps) == (-3, 4)
    assert solution.exit_probability == 1


def test_the_part_of_a_configuration() -> None:
    solution = solve(KEY)
    part = solution.at(1)
    assert isinstance(part, brl.Solution)
    assert part.values.tolist() == [[-2, -1, 0, 0]]
    assert part.policy.tolist() == [[2, 2, 2, -1]]
    assert part.policy.first_action == 0  # type: ignore[attr-defined]
    assert part.action_values.shape == part.greedy.shape == (1, 4, 5)
    assert part.expected_return == solution.expected_return
    np.testing.assert_array_equal(evaluate(KEY, solution).at(0).values, solution.at(0).values)
    assert pickle.loads(pickle.dumps(part)).values.tolist() == part.values.tolist()
    with pytest.raises(IndexError):
        solution.at(2)
    with pytest.raises(ValueError, match="heading must be for actions='turns'"):
        solution.at(0, "N")


def test_the_part_of_a_level_without_things() -> None:
    solution = solve("final-maze")
    np.testing.assert_array_equal(solution.at(0).values, solution.values)
    with pytest.raises(IndexError, match="no configuration 1"):
        solution.at(1)


def test_a_robot_that_turns() -> None:
    level = {**KEY, "heading": "N"}
    solution = solve(level, actions="turns")
    assert solution.values.shape == solution.policy.shape == (2, 4, 1, 4)
    assert solution.action_values.shape == (2, 4, 1, 4, 3)
    # Turn left, forward onto the key, turn twice, and three steps to the exit.
    assert (solution.expected_return, solution.expected_steps) == (-6, 7)
    west = solution.at(0, "W")
    assert west.values.shape == (1, 4)
    assert west.policy[0, 1] == brl.Turn.FORWARD
    assert solution.at(0).policy[0, 0, 1] == brl.Turn.LEFT
    found = evaluate(level, solution, actions="turns")
    np.testing.assert_array_equal(found.values, solution.values)
    with pytest.raises(ValueError, match="heading must be N, E, S, W, not 'north'"):
        solution.at(0, "north")


def test_a_robot_that_turns_in_a_level_without_things() -> None:
    corridor = {"version": 1, "size": [3, 1], "exit": [0, 0], "start": [2, 0]}
    solution = solve(corridor, actions="turns")
    assert solution.values.shape == (4, 1, 3)
    # By default it looks east: twice left, twice forward.
    assert solution.expected_steps == 4
    part = solution.at(0, "W")
    assert part.policy.tolist() == [[-1, 2, 2]]
    assert simulate(corridor, solution, 5, actions="turns").steps.tolist() == [4] * 5
    assert success_within(corridor, solution, 4, actions="turns") == 1
    assert success_within(corridor, solution, 3, actions="turns") == 0


def test_a_hit_that_ends_the_episode_ends_it_where_others_go_on() -> None:
    # The guard comes back: who walks on meets it between the second and the third cell.
    east = np.full((4, 2, 5), 2)
    found = evaluate(GUARD, east)
    assert (found.expected_return, found.expected_steps, found.exit_probability) == (-12, 3, 0)
    level = brl.load(GUARD)
    mdp = level.compile()
    assert not mdp.is_terminal[mdp.next_state[mdp.terminal & (mdp.probability > 0)]].all()
    trials = simulate(GUARD, east, 3)
    assert trials.returns.tolist() == [-12] * 3
    assert not trials.at_exit.any()
    assert not trials.cut.any()
    assert success_within(GUARD, east, 50) == 0
    best = solve(GUARD)
    assert best.exit_probability == 1
    assert best.expected_return > -12


def test_a_hit_that_does_not_end_the_episode_costs() -> None:
    level = {**GUARD, "hit": {"reward": -10, "ends": False}}
    # Two plain steps, a third one that meets the guard, and the exit.
    found = evaluate(level, np.full((4, 2, 5), 2))
    assert (found.expected_return, found.expected_steps, found.exit_probability) == (-12, 4, 1)


def test_a_hit_on_an_open_exit_counts_as_reaching_it() -> None:
    level = {"version": 1, "size": [3, 1], "exit": [2, 0], "movers": [{"path": [[2, 0]]}]}
    level["hit"] = {"reward": -7}
    solution = solve(level)
    assert (solution.expected_return, solution.exit_probability) == (-8, 1)
    assert simulate(level, solution, 1).at_exit.all()


def test_an_exit_counts_when_what_it_needs_is_held() -> None:
    level = {**KEY, "doors": [], "exit_needs": "key", "max_steps": 9}
    east = np.full((2, 1, 4), 2)
    with pytest.warns(RuntimeWarning, match=r"around \[3, 0\] while nothing is held, where"):
        found = evaluate(level, east)
    assert (found.exit_probability, found.diverging_cells) == (0, ((3, 0),))
    trials = simulate(level, east, 2)
    assert not trials.at_exit.any()
    assert trials.cut.all()
    fetch = np.where(np.arange(2)[:, None, None] == 0, 4, east)
    assert evaluate(level, fetch).exit_probability == 1
    assert simulate(level, fetch, 2).at_exit.all()
    assert success_within(level, fetch, 4) == 1


# -- policies ------------------------------------------------------------------------------------


def test_one_policy_told_in_every_way() -> None:
    solution = solve(KEY)
    policy = solution.policy
    table = np.eye(5)[policy]

    def with_key(seen: Any) -> int:
        _, _, key = seen
        return 2 if key else 4

    ways: list[Any] = [policy, policy.tolist(), table, table.reshape(-1, 5), with_key]
    for way in ways:
        np.testing.assert_array_equal(evaluate(KEY, way).values, solution.values)


def test_functions_of_a_robot_that_turns() -> None:
    asked = set()

    def ahead(seen: Any) -> int:
        _, _, heading = seen
        asked.add(heading)
        return 2 if heading == 3 else 0

    corridor = {"version": 1, "size": [3, 1], "exit": [0, 0], "start": [2, 0]}
    assert evaluate(corridor, ahead, actions="turns").expected_steps == 4
    assert asked == {0, 1, 2, 3}

    def fetch(seen: Any) -> int:
        _, _, key, heading = seen
        return 2 if heading == (1 if key else 3) else 0

    assert evaluate(KEY, fetch, actions="turns").expected_return == -7


def test_random_takes_what_doors_leave_open() -> None:
    # Before the key is held only west and stay are possible; onto the key takes two on average.
    found = evaluate(
        {
            **KEY,
            "exit_needs": [],
            "exit": [0, 0],
            "start": [2, 0],
            "items": [{"name": "key", "at": [3, 0]}],
            "doors": [{"at": [1, 0], "side": "E", "needs": "key"}],
        },
        "random",
        actions="moves",
    )
    # East for sure onto the key, then a walk on a line of four cells with an end at the left.
    assert found.expected_steps == pytest.approx(1 + 9)


@pytest.mark.parametrize(
    ("policy", "actions", "told"),
    [
        (np.zeros((1, 4), int), "all", r"an array \[2, 1, 4\] of actions, .* shape \[1, 4\]"),
        (np.zeros((2, 1, 4)), "all", r"a policy \[configurations, height, width\] is an array of"),
        (np.full((2, 1, 4), 7), "all", r"action at \[1, 0\] while nothing is held is 7;"),
        (lambda seen: None, "all", r"at \[1, 0\] while nothing is held: an agent's answer"),
        (np.full((2, 4, 1, 4), 3), "turns", r"\[1, 0\] looking N while .* has 0 left, 1 right, 2"),
        (np.full((8, 5), 0.3), "all", r"at \[1, 0\] while nothing is held are \[0.3, .* add up"),
        (solve(KEY), "turns", "the policy is one for actions='all', not for actions='turns'"),
        (solve(KEY, actions="turns").policy, "all", "one for actions='turns', not for"),
    ],
)
def test_policies_that_do_not_fit(policy: Any, actions: str, told: str) -> None:
    with pytest.raises(ValueError, match=told):
        evaluate(KEY, policy, actions=actions)


# -- returns without a discount ------------------------------------------------------------------


def test_an_undefined_return_names_what_is_held() -> None:
    # Behind the door that closes for good, steps to and fro cancel out.
    level = {
        "version": 1,
        "size": [4, 1],
        "exit": [3, 0],
        "items": [{"name": "stone", "at": [1, 0]}],
        "doors": [{"at": [2, 0], "side": "E", "unless": "stone"}],
        "rewards": {"closer": 1, "farther": -1, "stay": -1, "bump": -1, "exit": -5},
    }
    with pytest.raises(brl.UndefinedReturnError, match=r"\] while stone is held an ep") as caught:
        solve(level)
    assert caught.value.cell == tuple(map(int, caught.value.where[1:5].split(",")))
    copy = pickle.loads(pickle.dumps(caught.value))
    assert (str(copy), copy.where) == (str(caught.value), caught.value.where)


def test_a_loop_that_pays_is_named_with_what_is_held() -> None:
    level = {**KEY, "areas": [{"at": [2, 0], "reward": 3}]}
    solution = solve(level)
    assert solution.expected_return == np.inf
    assert solution.diverging_condition == "while key is held"
    assert "around [2, 0] while key is held, where rewards add up" in str(solution.explanation)
    # Where a switch flips to and fro, nothing is on all the time.
    flips = solve(
        {
            "version": 1,
            "size": [2, 1],
            "exit": "none",
            "switches": [{"name": "lamp", "at": [1, 0]}],
            "areas": [{"at": [1, 0], "reward": 3}],
            "rewards": {"stay": -9},
        },
        actions="moves",
    )
    assert flips.expected_return == np.inf


# -- large levels --------------------------------------------------------------------------------


@pytest.mark.slow
def test_large_systems_are_solved_alike(monkeypatch: pytest.MonkeyPatch) -> None:
    # Walking at random fills the matrix: such systems are solved iteratively, then by elimination.
    expected = {
        (policy, discount): evaluate("bat-cave", policy, discount)
        for policy in ("random", "uniform")
        for discount in (1.0, 0.9)
    }
    best = solve("bat-cave")
    monkeypatch.setattr(linear, "DENSE_STATES", 0)
    monkeypatch.setattr(model, "DENSE_STATES", 0)
    monkeypatch.setattr(linear, "MANY_STATES", 0)
    monkeypatch.setattr(linear, "FILLED", 0)
    for iterations in (500, 1):
        monkeypatch.setattr(linear, "ITERATIONS", iterations)
        for (policy, discount), one in expected.items():
            found = evaluate("bat-cave", policy, discount)
            np.testing.assert_allclose(found.values, one.values, rtol=1e-11, atol=1e-10)
            assert found.expected_steps == pytest.approx(one.expected_steps, rel=1e-11)
            assert found.exit_probability == pytest.approx(one.exit_probability, rel=1e-11)
        found = solve("bat-cave")
        np.testing.assert_allclose(found.values, best.values, atol=1e-10)


def test_iterations_are_what_solves_large_systems(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(linear, "MANY_STATES", 0)
    monkeypatch.setattr(linear, "DENSE_STATES", 0)
    monkeypatch.setattr("scipy.sparse.linalg.splu", None)
    found = evaluate("bat-cave", "random", 0.9)
    assert np.isfinite(found.expected_return)


def test_several_robots_have_all_actions_and_no_others() -> None:
    robots = [{"name": "a", "start": [0, 0]}, {"name": "b", "start": [1, 0]}]
    level = {"version": 1, "size": [3, 1], "robots": robots}
    for actions in ("moves", "turns"):
        # The command line tells such an error in a sentence.
        with pytest.raises(brl.LevelError, match="several robots have actions='all', not"):
            solve(level, actions=actions)


@pytest.mark.parametrize("discount", [1.0, 0.9])
def test_what_cannot_be_taken_back_is_eliminated_layer_by_layer(
    discount: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    items = [{"name": f"i{n}", "at": [n, 1]} for n in range(5)]
    level = brl.load({"version": 1, "size": [6, 3], "items": items, "discount": discount})
    expected = brl.evaluate(level, "random")
    visits = brl.occupancy(level, "random")
    monkeypatch.setattr(linear, "DENSE_STATES", 0)
    monkeypatch.setattr(linear, "MANY_STATES", 0)
    counts, split = [], linear._layers

    def noted(steps: Any) -> Any:
        layers = split(steps)
        counts.append(len(layers))
        return layers

    monkeypatch.setattr(linear, "_layers", noted)
    found = brl.evaluate(level, "random")
    np.testing.assert_allclose(found.values, expected.values, rtol=1e-12)
    np.testing.assert_allclose(brl.occupancy(level, "random").states, visits.states, atol=1e-12)
    # As many items are taken, one after the other.
    assert {*counts} == {6}
