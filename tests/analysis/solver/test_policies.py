"""Evaluating policies, however they are told."""

from __future__ import annotations

import copy
import dataclasses
import json
import pickle
from functools import partial
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.chains import dense, world
from support.worlds import World, level_of, worlds

import babyrobot_levels as brl
from babyrobot_levels.analysis.solver.evaluation import evaluate, simulate, success_within
from babyrobot_levels.analysis.solver.optimum import solve
from babyrobot_levels.analysis.solver.policies import read_policy, space_of
from babyrobot_levels.analysis.solver.results import PolicyArray
from babyrobot_levels.render.scene.info import policy_actions

CORNER = world(rows=["S  ", "  #", " XE"], skid={"probability": 0.2, "to": "others"})


@given(worlds(5), st.integers(0, 99), st.sampled_from(["all", "moves"]))
@pytest.mark.slow
def test_values_are_those_of_repeated_steps(world: World, seed: int, actions: str) -> None:
    level = level_of(world)
    mdp = level.compile()
    steps, rewards = dense(mdp, 0 if actions == "all" else 1)
    weights = np.random.default_rng(seed).dirichlet(np.ones(len(steps)), mdp.num_states)
    found = evaluate(level, weights, 0.8, actions)
    chances = np.append(weights, np.full((1, len(steps)), 1 / len(steps)), axis=0)
    expected = np.zeros(mdp.num_states + 1)
    for _ in range(250):
        ahead = rewards + 0.8 * steps @ expected
        expected = np.einsum("sa,as->s", chances, ahead)
    over = mdp.is_terminal
    np.testing.assert_allclose(found.values.ravel()[~over], expected[:-1][~over], atol=1e-9)
    by_action = found.action_values.reshape(-1, len(steps))[~over]
    np.testing.assert_allclose(by_action, ahead.T[:-1][~over], atol=1e-9)
    assert found.expected_return == pytest.approx(float(mdp.start @ expected[:-1]), abs=1e-9)


def test_random_takes_what_is_possible_and_uniform_takes_all() -> None:
    # In a corridor, four actions are two ways and two walls.
    level = world(rows=["  S  E"])
    mdp = level_of(level).compile()
    for actions in ("all", "moves"):
        possible = mdp.action_mask[:, 0 if actions == "all" else 1 :].astype(float)
        possible[-1] = 1
        even = possible / possible.sum(axis=1, keepdims=True)
        found, expected = (evaluate(level, p, 1.0, actions) for p in ("random", even))
        np.testing.assert_allclose(found.values, expected.values)
        ones = np.full(possible.shape, 1 / possible.shape[1])
        found, expected = (evaluate(level, p, 1.0, actions) for p in ("uniform", ones))
        np.testing.assert_allclose(found.values, expected.values)
    # Gambler's ruin, beginning 2 cells from the wall, with 5 in all.
    found = evaluate(level, "random", actions="moves")
    assert found.expected_steps == pytest.approx(25 - 4)
    assert evaluate(level, "uniform", actions="moves").expected_steps == pytest.approx(2 * (30 - 6))


def test_random_where_nothing_is_possible() -> None:
    shut = world(rows=["S#E"], rewards={"step": 0, "bump": -3})
    assert evaluate(shut, "random", 0.5, "moves").expected_return == pytest.approx(-6)
    assert evaluate(shut, "random", 0.5, "all").expected_return == 0


def test_one_policy_told_in_every_way() -> None:
    solution = solve(CORNER)
    policy = solution.policy
    table = np.eye(5)[policy]
    table[policy < 0] = np.nan  # Where nothing is to be done, nothing is read.
    ways: list[Any] = [
        solution,
        policy,
        policy.tolist(),
        policy.astype(np.int8),
        table,
        table.reshape(-1, 5),
        lambda seen: policy[seen[1], seen[0]],
        lambda seen: brl.Action(int(policy[seen[1], seen[0]])),
        lambda seen: np.eye(5)[policy[seen[1], seen[0]]],
        "best",
    ]
    for way in ways:
        found = evaluate(CORNER, way)
        np.testing.assert_allclose(found.values, solution.values, atol=1e-12)
        assert found.expected_steps == pytest.approx(solution.expected_steps)
        assert (
            simulate(CORNER, way, 10).returns.tolist()
            == simulate(CORNER, policy, 10).returns.tolist()
        )
        assert success_within(CORNER, way, 9) == pytest.approx(success_within(CORNER, policy, 9))


def test_the_two_numberings_of_actions() -> None:
    every, moves = solve(CORNER), solve(CORNER, actions="moves")
    assert (every.first_action, moves.first_action) == (0, 1)
    assert moves.action_values.shape == moves.greedy.shape == (3, 3, 4)
    going = every.policy > 0
    assert (moves.policy[going] == every.policy[going] - 1).all()
    np.testing.assert_allclose(moves.action_values, every.action_values[..., 1:], atol=1e-12)
    # A solution knows its own numbering.
    for solution in (every, moves):
        for actions in ("all", "moves"):
            found = evaluate(CORNER, solution, actions=actions)
            assert found.expected_return == pytest.approx(every.expected_return)
    resting = solve(world(rows=["S#E"], rewards={"step": -1, "stay": 0}))
    with pytest.raises(ValueError, match=r"at \[0, 0\] is stay, which actions='moves' does not"):
        evaluate(world(rows=["S#E"]), resting, actions="moves")


@pytest.mark.slow
def test_a_policy_of_a_result_knows_its_numbering() -> None:
    *_, learned = brl.q_learning("cliff-walking", 500, seed=0)
    *_, swept = brl.value_iteration("cliff-walking")
    for policy in (learned.policy, swept.policy, solve("cliff-walking", actions="moves").policy):
        expected = evaluate("cliff-walking", policy, actions="moves").values
        for way in (policy, policy.copy(), pickle.loads(pickle.dumps(policy)), copy.copy(policy)):
            np.testing.assert_array_equal(evaluate("cliff-walking", way).values, expected)
        runs = [simulate("cliff-walking", policy, 5, actions=a).mean for a in ("all", "moves")]
        assert runs[0] == runs[1] == expected[3, 0]
        assert success_within("cliff-walking", policy, 20) == 1
        steps = brl.rollout("cliff-walking", policy, num_steps=13, seed=0)
        assert steps.terminations[-1].all()


def test_a_policy_array_is_an_array_like_any_other() -> None:
    policy = solve("cliff-walking", actions="moves").policy
    plain = np.asarray(policy)
    assert type(plain) is np.ndarray
    assert isinstance(policy, np.ndarray)
    assert (policy == plain).all()
    assert policy.tolist() == plain.tolist()
    assert json.loads(json.dumps(policy.tolist())) == plain.tolist()
    assert type(policy[3, 0]) is np.int64
    assert repr(policy[3, :2]) == "PolicyArray([0, 0], actions='moves')"
    assert str(policy) == str(plain)
    np.testing.assert_array_equal(np.eye(4)[policy], np.eye(4)[plain])
    # Numbers that something was added to mean something else.
    shifted = policy.copy()
    shifted += 1
    for changed in (policy + 1, shifted, np.maximum(policy, 0), policy >= 0, policy.max()):
        assert not isinstance(changed, PolicyArray)
    for kept in (policy.copy(), policy.astype(np.int8), policy[:2], policy.ravel()):
        assert isinstance(kept, PolicyArray)
        assert kept.first_action == 1
    assert np.add.reduce(policy, axis=None) == plain.sum()
    assert np.concatenate([policy, policy]).tolist() == plain.tolist() * 2


def test_a_policy_that_never_ends_is_reported() -> None:
    policy = np.asarray(solve("final-maze", actions="moves").policy)
    with pytest.warns(RuntimeWarning) as caught:
        found = evaluate("final-maze", policy)
    assert found.expected_return == -np.inf
    ((x, y), *_) = found.diverging_cells
    assert str(caught[0].message) == (
        f"with this policy, the expected return is -inf, because an episode may go on for ever "
        f"around [{x}, {y}], where costs add up without bound; a discount below 1, such as 0.99, "
        "or a limit of steps, such as within=200, makes it finite; if its action 0 is north, "
        "give actions='moves'"
    )
    assert caught[0].filename == __file__
    with pytest.warns(RuntimeWarning, match="makes it finite$"):
        evaluate("final-maze", lambda seen: 0)
    # With a discount, and from the right numbering, nothing is to be said.
    evaluate("final-maze", policy, 0.99)
    evaluate("final-maze", policy, actions="moves")


@pytest.mark.parametrize(
    ("policy", "told"),
    [
        ("randon", "did you mean `random`"),
        (np.zeros((3, 4), int), r"array \[3, 3\] of actions, .* not one of shape \[3, 4\]"),
        (np.zeros((3, 3)), "integers or names"),
        (np.full((3, 3), 5), r"at \[0, 0\] is 5; actions='all' has 0 stay, 1 north, .* 4 west"),
        (np.full((3, 3), -1), r"at \[0, 0\] is -1"),
        (np.full((9, 5), 0.3), r"at \[0, 0\] are \[0.3, .* add up to 1"),
        (np.tile([1.5, -0.5, 0, 0, 0], (9, 1)), "must not be negative"),
        (np.full((9, 5), np.nan), "add up to 1"),
        (np.full((9, 4), 0.25), "4 probabilities for each cell need actions='moves'"),
        (lambda seen: None, r"at \[0, 0\]: an agent's answer must be .* not None"),
        (lambda seen: [0.3] * 5, r"at \[0, 0\] are \[0.3, "),
        (None, "of probabilities, not None"),
        (7, "of probabilities, not 7"),
    ],
)
def test_policies_that_do_not_fit(policy: Any, told: str) -> None:
    for use in (evaluate, simulate, partial(success_within, steps=5)):
        with pytest.raises(ValueError, match=told):
            use(CORNER, policy)


def test_policies_of_the_other_set_of_actions() -> None:
    with pytest.raises(ValueError, match="5 probabilities for each cell need actions='all'"):
        evaluate(CORNER, np.full((9, 5), 0.2), actions="moves")
    with pytest.raises(ValueError, match="3 west; if its action 0 is stay, give actions='all'"):
        evaluate(CORNER, np.full((3, 3), 4), actions="moves")


def test_arguments_that_cannot_be() -> None:
    for wrong in (0, -1, 1.5, float("nan")):
        with pytest.raises(ValueError, match="discount must be above 0"):
            solve(CORNER, wrong)
        with pytest.raises(ValueError, match="discount must be above 0"):
            evaluate(CORNER, "random", wrong)
    with pytest.raises(ValueError, match="'all', 'moves' or 'turns'"):
        solve(CORNER, actions="valid")
    with pytest.raises(ValueError, match="'all', 'moves' or 'turns'"):
        evaluate(CORNER, "random", actions="some")
    with pytest.raises(brl.LevelNotFoundError):
        solve("no-such-level")
    with pytest.raises(brl.LevelError, match="seed"):
        solve("random-maze")


def test_the_discount_is_the_levels_unless_told() -> None:
    assert solve("gridworld-3-5").discount == 0.9
    assert evaluate("gridworld-3-5", "random").discount == 0.9
    assert solve("final-maze").discount == 1.0
    assert solve("final-maze", 0.5).discount == 0.5


def test_results_are_read_only_and_can_be_copied() -> None:
    solution = solve(CORNER)
    for name in ("values", "action_values", "greedy", "policy"):
        with pytest.raises(ValueError, match="read-only"):
            getattr(solution, name)[:] = 0
    for other in (copy.deepcopy(solution), pickle.loads(pickle.dumps(solution))):
        np.testing.assert_array_equal(other.values, solution.values)
    assert repr(solution).startswith("<Solution expected_return=")
    assert [str(solution.policy.dtype), str(solution.values.dtype)] == ["int64", "float64"]


@pytest.mark.parametrize("copied", [copy.copy, copy.deepcopy, dataclasses.replace])
def test_what_is_found_when_asked_for_is_the_same_in_copies(copied: Any) -> None:
    solution = solve("final-maze")
    other = copied(solve("final-maze"))
    for name in ("policy", "fastest", "expected_steps", "exit_probability"):
        assert name in dir(solution)
        np.testing.assert_array_equal(getattr(other, name), getattr(solution, name))
        assert vars(solution)[name] is getattr(solution, name)
    assert not solution.fastest.flags.writeable


def test_probabilities_that_almost_add_up_to_one_are_normalised() -> None:
    level = brl.load("final-maze")
    table = np.full((40, 5), 0.2 + 1e-8)
    assert read_policy(table, space_of(level, "all")).sum(axis=1)[0] == pytest.approx(1, abs=1e-15)


# -- what pictures show ------------------------------------------------------------------------


@pytest.mark.parametrize("within", [None, "max_steps"])
def test_pictures_show_neither_stay_nor_bumps_where_these_lead_nowhere(within: str | None) -> None:
    for name in ("frozen-lake", "frozen-lake-8x8-dry"):
        solution = solve(name, within=within)
        assert within or solution.greedy[..., 0].any()
        assert not solution.fastest[..., 0].any()
    drawn = policy_actions(solve("frozen-lake", within=within), brl.load("frozen-lake"))
    assert drawn[0][0] == (brl.Action.WEST,)


@given(worlds(5), st.sampled_from([1.0, 0.8]), st.sampled_from(["all", "moves"]))
def test_who_takes_any_action_of_a_picture_ends_as_soon_as_the_optimal_policy(
    world: World, discount: float, actions: str
) -> None:
    level = level_of(world)
    try:
        best = solve(level, discount, actions=actions)
    except ArithmeticError:
        return
    assert not (best.fastest & ~best.greedy).any()
    if not np.isfinite(best.expected_return):
        return
    weights = best.fastest / np.maximum(best.fastest.sum(axis=-1, keepdims=True), 1)
    found = evaluate(level, weights, discount, actions)
    np.testing.assert_allclose(found.expected_return, best.expected_return, atol=1e-7)
    if np.isfinite(best.expected_steps):
        np.testing.assert_allclose(found.expected_steps, best.expected_steps, rtol=1e-7)
