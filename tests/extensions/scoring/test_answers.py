"""Graded answers: what students computed, right and wrong on purpose, and what is said to it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from support.places import ROOT

import babyrobot_levels as brl
from babyrobot_levels.analysis.solver import policies
from babyrobot_levels.text.budget import Limits, left, within

LAKE = "frozen-lake"
CLIFF = "cliff-walking"


def swept(discount: float = 0.9, end: float = 0.0, sweeps: int = 1000) -> Any:
    """Return values of the lake by sweeps over all states, whose terminal ones have a value."""
    mdp = brl.load(LAKE).compile()
    values = np.zeros(16)
    values[15] = end
    for _ in range(sweeps):
        following = mdp.reward + discount * values[mdp.next_state]
        best = (mdp.probability * following).sum(axis=-1).max(axis=1)
        values = np.where(mdp.is_terminal, values, best)
    return values.reshape(4, 4)


def in_place(sweeps: int) -> Any:
    """Return values of the lake after sweeps that use what the same sweep has found."""
    mdp = brl.load(LAKE).compile()
    values = np.zeros(16)
    for _ in range(sweeps):
        for state in np.flatnonzero(~mdp.is_terminal):
            following = mdp.reward[state] + values[mdp.next_state[state]]
            values[state] = (mdp.probability[state] * following).sum(axis=-1).max()
    return values.reshape(4, 4)


def changed(table: Any, **cells: float) -> Any:
    """Return a copy of a table with other numbers in some cells, `x1y2=…`."""
    copy = np.array(table)
    for cell, number in cells.items():
        x, y = cell[1:].split("y")
        copy[int(y), int(x)] = number
    return copy


@pytest.mark.parametrize("level", [LAKE, CLIFF, "first-key", "gridworld-3-5", "glass-wall"])
def test_solutions_are_right(level: str) -> None:
    solution = brl.solve(level)
    values = brl.grade_values(level, solution.values.tolist(), points=5)
    policy = brl.grade_policy(level, np.asarray(solution.policy))
    assert values, values
    assert policy, policy
    assert (values.points, values.share, values.out_of) == (5, 1, 5)
    assert brl.grade_values(level, np.ravel(solution.values))


@pytest.mark.slow
def test_values_of_policies_and_of_sweeps() -> None:
    assert brl.grade_values(LAKE, brl.evaluate(LAKE, "random").values, policy="random")
    sweeps = list(brl.value_iteration(LAKE))
    assert brl.grade_values(LAKE, sweeps[6].values, sweeps=6)
    few = list(brl.policy_evaluation(LAKE, "random"))
    assert brl.grade_values(LAKE, few[3].values, policy="random", sweeps=3)


@pytest.mark.parametrize(
    ("values", "asked", "said"),
    [
        (swept(1.0, sweeps=5), {}, "after 5 sweeps; go on until"),
        (swept(1.0, sweeps=5), {"sweeps": 6}, "after 5 sweeps, not 6"),
        (swept(1.0, sweeps=1), {"sweeps": 2}, "after 1 sweep, not 2"),
        (in_place(4), {"sweeps": 4}, "in place"),
        (np.zeros((4, 4)), {}, "all of them are 0"),
        (swept(0.9), {}, "for the discount 0.9, not 1"),
        (0.9 * swept(0.9), {"discount": 0.9}, "the reward of a step is discounted, too"),
        (changed(swept(), x3y3=1), {"discount": 0.9}, "only terminal states"),
        (swept(end=1.0), {"discount": 0.9}, "terminal states are valued, first [3, 3]"),
        (brl.evaluate(LAKE, "random").values, {}, "the largest of its action values"),
        (brl.solve(LAKE).values, {"policy": "random"}, "not those of the policy"),
        (brl.solve(LAKE).values.T, {}, "rows and columns are exchanged"),
        (-brl.solve(LAKE).values, {}, "signs are exchanged"),
        (changed(brl.solve(LAKE).values, x2y1=0.5), {}, "at [2, 1] it is too low, by between 0.01"),
        (changed(brl.solve(LAKE).values, x2y1=np.inf), {}, "at [2, 1] it is too high, by infinite"),
    ],
)
def test_mistakes_with_values(values: Any, asked: dict[str, Any], said: str) -> None:
    grade = brl.grade_values(LAKE, values, **asked)
    assert not grade
    assert 0 < grade.share < 1
    assert said in grade.message
    assert "values are right: " in grade.message


@pytest.mark.parametrize(
    ("values", "said"),
    [
        (np.zeros(5), "must be an array [4, 12], not one of shape [5]"),
        (np.zeros((12, 4)), "rows come first: values[y, x]"),
        (np.full((4, 12), np.nan), "the value of [0, 0] is not a number (nan)"),
        ([[1], [1, 2]], "not numbers in a table"),
        ("best", "not numbers in a table"),
        (None, "must be an array"),
    ],
)
def test_what_is_no_table_of_values(values: Any, said: str) -> None:
    grade = brl.grade_values(CLIFF, values)
    assert grade.share == 0
    assert said in grade.message


def test_ends_that_are_no_terminal_states() -> None:
    """A hit ends the episode in a state where others go on."""
    mover = {"name": "bat", "path": [[1, 0], [2, 0]]}
    hit = {"hit": {"reward": 1}, "discount": 0.9}
    level = brl.load({"version": 1, "size": [4, 2], "movers": [mover], **hit})
    mdp = level.compile()
    values = np.zeros(mdp.num_states)
    for _ in range(500):
        following = mdp.reward + 0.9 * values[mdp.next_state]
        values = np.where(
            mdp.is_terminal, 0, (mdp.probability * following).sum(axis=-1).max(axis=1)
        )
    grade = brl.grade_values(level, values.reshape(mdp.shape))
    assert not grade
    assert "is added even where a step ends the episode" in grade.message


def test_a_cause_comes_before_its_consequences() -> None:
    """The first wrong value follows from a wrong one below it, which is told."""
    wrong = changed(swept(sweeps=1000), x2y2=0.1)
    mdp = brl.load(LAKE).compile()
    values = np.ravel(wrong)
    for _ in range(1000):
        best = (mdp.probability * (mdp.reward + 0.9 * values[mdp.next_state])).sum(-1).max(1)
        values = np.where(mdp.is_terminal, 0, best)
        values[10] = 0.1
    grade = brl.grade_values(LAKE, values.reshape(4, 4), discount=0.9)
    assert "at [2, 2] it is too low" in grade.message
    assert "not what its best action gives" in grade.message


def test_other_optimal_actions_are_right() -> None:
    solution = brl.solve("frozen-lake-dry", 0.9)
    count = solution.greedy.shape[-1]
    last = count - 1 - solution.greedy[..., ::-1].argmax(axis=-1)
    assert (last != solution.policy)[solution.policy >= 0].any()
    assert brl.grade_policy("frozen-lake-dry", last, discount=0.9)
    assert brl.grade_policy(
        "frozen-lake-dry",
        solution.greedy / solution.greedy.sum(-1).clip(1)[..., None],
        discount=0.9,
    )


BEST = np.asarray(brl.solve(LAKE).policy)
BEST_DRY = np.asarray(brl.solve("frozen-lake-dry", actions="moves").policy).clip(0)
NAMES_DRY = np.array(["north", "east", "south", "west"])[BEST_DRY]
SAFE = np.asarray(brl.solve(CLIFF).policy).clip(0)


@pytest.mark.parametrize(
    ("level", "policy", "said"),
    [
        (LAKE, BEST - 1, "would be right if 0 is north there"),
        (LAKE, np.array([0, 3, 2, 1, 0])[BEST], "as in Gymnasium's FrozenLake"),
        (LAKE, BEST.T, "rows and columns are exchanged"),
        (
            LAKE,
            np.zeros((4, 4), int),
            "from [0, 0] its episodes never end, but go on around [0, 0]",
        ),
        (CLIFF, changed(SAFE, x2y0=2, x3y0=4), "never end, but go on around [2, 0], [3, 0]"),
        (
            CLIFF,
            changed(SAFE, x3y1=1),
            "at [3, 1], north is not optimal; it loses between 1 and 10",
        ),
        (LAKE, "random", "is not optimal"),
        (LAKE, np.full((4, 4), 7), "the policy's action at [0, 0] is 7"),
        (LAKE, np.full((4, 4), np.nan), "integers or names"),
        (LAKE, np.full((4, 4, 5), np.nan), "must not be negative and add up to 1"),
        (LAKE, [[1], [1, 2]], "rows differ in length"),
        (LAKE, lambda seen: "north", "at [0, 0]: an agent's answer must be an action from 0"),
        ("final-maze", brl.solve("final-maze", 0.5).policy, "for the discount 0.5, not for 1"),
    ],
)
def test_mistakes_with_policies(level: str, policy: Any, said: str) -> None:
    grade = brl.grade_policy(level, policy)
    assert not grade
    assert grade.share < 1
    assert said in grade.message


def test_going_on_for_ever_is_no_mistake_where_the_optimum_does() -> None:
    grade = brl.grade_policy("gridworld-3-5", np.full((5, 5), 1))
    assert not grade
    assert "at [0, 0], north is not optimal; it loses" in grade.message


NAMES = np.array(["stay", "north", "east", "south", "west"])[BEST]


@pytest.mark.parametrize(
    "policy",
    [BEST.ravel(), NAMES, NAMES.tolist(), NAMES.ravel(), np.char.title(NAMES), BEST.astype(float)],
    ids=["flat", "names", "lists", "flat names", "titles", "floats"],
)
def test_forms_of_policies(policy: Any) -> None:
    assert brl.grade_policy(LAKE, policy)
    assert brl.grade_agent(LAKE, policy)


def test_names_have_the_numbers_of_the_set_of_actions() -> None:
    assert brl.grade_policy("frozen-lake-dry", NAMES_DRY, actions="moves")
    told = brl.grade_policy("frozen-lake-dry", np.where(BEST_DRY == 0, "stay", "east"),
                            actions="moves").message  # fmt: skip
    assert "'stay' is none of the actions north, east, south, west, or of their numbers" in told
    assert brl.grade_agent(LAKE, np.full((4, 4), "nort")).message.endswith(
        "numbers 0 to 4; did you mean `north`?"
    )


def test_floats_that_are_whole_are_actions() -> None:
    assert brl.grade_policy(LAKE, BEST.astype(float))


@pytest.mark.slow
def test_agents() -> None:
    assert brl.grade_agent(LAKE, brl.solve(LAKE))
    chance = brl.grade_agent(LAKE, "random", points=4)
    assert chance.points == 0
    assert "0 % of the way" in chance.message
    assert "must be an action from 0 to 4" in brl.grade_agent(LAKE, lambda _: 9).message
    assert brl.grade_agent(LAKE, "random", at_least=0)
    with pytest.raises(ValueError, match="within"):
        brl.grade_agent(LAKE, "random", within=-1)
    with pytest.raises(ZeroDivisionError):
        brl.grade_agent(LAKE, lambda _: 1 // 0)


@pytest.mark.slow
def test_an_agent_passes_from_the_bound_on_and_its_share_counts_below() -> None:
    best = np.eye(5)[brl.solve(LAKE).policy.ravel()]
    mixed = 0.9 * best + 0.1 / 5
    (found,) = brl.score(LAKE, mixed)
    assert 0.1 < found.share < 0.9
    assert brl.grade_agent(LAKE, mixed, at_least=found.share - 0.01)
    short = brl.grade_agent(LAKE, mixed, at_least=found.share + 0.01, points=4)
    assert not short
    assert short.points == pytest.approx(4 * found.share)


def test_impossible_actions_of_an_agent_are_counted() -> None:
    level = brl.load({"version": 1, "size": [3, 1]})
    told = "; it takes impossible actions in {}: leave them out of the maximum"
    one, two = told.format("1 state"), told.format("2 states")
    assert brl.grade_agent(level, [(1, 2, 0)]).message.endswith(one)
    assert brl.grade_agent(level, [(1, 3, 1)]).message.endswith(two)
    assert brl.grade_agent(level, np.array([(0, 1, 0)]), actions="moves").message.endswith(one)
    assert "impossible" not in brl.grade_agent(level, [(0, 2, 0)]).message
    assert "impossible" not in brl.grade_agent(level, lambda _: 1).message


@pytest.mark.parametrize(
    ("name", "learned"),
    [
        ("q_learning", "values[mdp.action_mask == 1] = -5"),
        ("approximate_q", "weights[mdp.action_mask.ravel() == 1] = -5"),
    ],
)
def test_what_students_begin_with_takes_no_action_that_was_never_possible(
    name: str, learned: str
) -> None:
    text = (ROOT / "course" / f"{name}.py").read_text("utf-8")
    names: dict[str, Any] = {}
    exec(text.replace("raise NotImplementedError", learned), names)
    level = brl.load(ROOT / "course" / "levels" / "two-ways.yaml")
    message = brl.grade_agent(level, names[name](level)).message
    assert "needed" in message
    assert "impossible" not in message


@pytest.mark.slow
def test_no_message_tells_the_solution() -> None:
    """The digits of a right value stand in no sentence about a wrong one."""
    solution = brl.solve(LAKE)
    for x, y in [(0, 0), (2, 1), (1, 3)]:
        wrong = changed(solution.values, **{f"x{x}y{y}": 0.31})
        assert f"{solution.values[y, x]:.2f}" not in brl.grade_values(LAKE, wrong).message


def test_the_message_of_an_assertion() -> None:
    grade = brl.grade_values(LAKE, np.zeros((4, 4)))
    with pytest.raises(AssertionError, match="5 of 16 values are right: all of them are 0"):
        assert grade, grade.message


def test_a_wrong_policy_is_graded_with_one_model(monkeypatch: pytest.MonkeyPatch) -> None:
    made, build = [], policies.StateSpace.model

    def noted(space: policies.StateSpace) -> Any:
        made.append(space)
        return build(space)

    monkeypatch.setattr(policies.StateSpace, "model", noted)
    level = brl.load({"version": 1, "size": [9, 1], "discount": 0.9})
    assert not brl.grade_policy(level, np.zeros((1, 9), int)).passed
    assert len(made) == 1


def test_what_takes_too_long_to_explain_is_only_wrong() -> None:
    level = brl.load({"version": 1, "size": [9, 1], "discount": 0.9})
    values = brl.solve(level, discount=0.5).values
    assert "the discount 0.5" in brl.grade_values(level, values).message
    steps = 0.0
    with within(Limits(10**9, 10**6)):
        brl.solve(level)
        steps = 10**9 - left()
    with within(Limits(2 * steps, 10**6)):
        found = brl.grade_values(level, values)
    assert not found.passed
    assert "discount" not in found.message
