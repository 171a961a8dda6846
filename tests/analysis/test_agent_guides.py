"""What a page shows of an agent: its regret, its differences from the optimum, and their costs."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

import babyrobot_levels as brl
from babyrobot_levels.analysis.agent_guides import MAX_DIFFERENCES, page_agent
from babyrobot_levels.analysis.guides import guide_of
from babyrobot_levels.render.page import page_data
from babyrobot_levels.render.page_agent import PageAgent
from babyrobot_levels.render.page_format import rounded

CANCELLING = brl.loads(
    "version: 1\nsize: [3, 1]\nstart: [1, 0]\nexit: none\nblocked: [{at: [2, 0]}]\n"
    "rewards: {stay: -9, bump: -9}\n"
    "areas: [{at: [0, 0], reward: 1}, {at: [1, 0], reward: -1}]\n"
)
LEVELS = [
    "frozen-lake",
    "first-key",
    "cliff-walking",
    "puddles",
    "treasure-chests",
    "gridworld-3-5",
]


def agent(level: Any, policy: Any) -> PageAgent:
    level = brl.load(level)
    solution = brl.solve(level)
    return page_agent(level, policy, solution, guide_of(level, solution).expected_return)


def random_policy(level: Any, seed: int = 0) -> Any:
    """Return a policy that takes every action with some probability."""
    mdp = brl.load(level).compile()
    return np.random.default_rng(seed).dirichlet(np.ones(5), mdp.num_states)


def number(text: str) -> float:
    return float(text.replace("\N{MINUS SIGN}", "-").replace("∞", "inf"))


@pytest.mark.parametrize("name", LEVELS)
def test_costs_times_visits_add_up_to_the_regret(name: str) -> None:
    level, policy = brl.load(name), random_policy(name)
    solution, found = brl.solve(level), brl.evaluate(level, policy)
    shown = agent(level, policy)
    visits = brl.occupancy(level, policy).states.ravel()
    costs = np.full(visits.shape, np.nan)
    assert shown.costs is not None
    for number in range(level.compile().num_configurations):
        rows = shown.costs.at(number).values
        assert rows is not None
        cells = [np.nan if value is None else value for row in rows for value in row]
        costs[number * len(cells) : (number + 1) * len(cells)] = cells
    regret = solution.expected_return - found.expected_return
    assert np.nansum(costs * visits) == pytest.approx(regret)
    told = next(each for each in shown.told if "without a limit" in each)
    assert f"regret {rounded(regret)} " in told


def test_a_difference_tells_its_state_actions_and_cost() -> None:
    best = brl.solve("first-key")
    policy = np.array(best.policy)
    # To the south-west corner, away from the key, which the optimal policy fetches first.
    policy[0, 0, 1] = brl.Action.EAST
    (told,) = agent("first-key", policy).differences
    cost = best.values[0, 0, 1] - best.action_values[0, 0, 1, brl.Action.EAST]
    assert (told.cell, told.where) == (1, "[1, 0] while nothing is held")
    assert (told.action, told.optimal, number(told.cost)) == ("east", "west", cost)
    assert number(told.visits) == math.inf


def test_probabilities_are_told_where_there_are_several() -> None:
    policy = np.array(brl.solve("cliff-walking").greedy, float)
    policy /= policy.sum(axis=-1, keepdims=True).clip(1)
    policy[0, 0] = [0, 0.25, 0.75, 0, 0]
    shown = agent("cliff-walking", policy)
    assert [each.action for each in shown.differences] == ["east 75 %, north 25 %"]
    assert shown.told[-1] == "Not optimal in 1 state; its episodes come to none of them."


def test_the_optimum_differs_nowhere() -> None:
    shown = agent("frozen-lake", brl.solve("frozen-lake"))
    assert shown.differences == []
    assert shown.told[1:] == [
        "Return 0.82, optimum 0.82: regret 0 without a limit.",
        "Each of its actions is optimal without a limit.",
    ]


def test_the_states_that_cost_most_come_first_and_the_others_are_counted() -> None:
    level = brl.load("final-maze")
    shown = agent(level, "random")
    lost = [number(each.cost) * number(each.visits) for each in shown.differences]
    # They are told with two decimals.
    assert all(more > 0.9 * less for more, less in pairwise(lost))
    assert lost[0] > 2 * lost[-1]
    assert len(lost) == MAX_DIFFERENCES
    wrong = brl.solve(level).greedy[~level.compile().is_terminal.reshape(level.height, level.width)]
    possible = level.compile().action_mask[~level.compile().is_terminal]
    assert shown.left_out == int((possible & ~wrong).any(axis=1).sum()) - MAX_DIFFERENCES


def test_episodes_without_end_have_an_infinite_regret() -> None:
    stay = np.zeros((4, 12), int)
    told = agent("cliff-walking", stay).told
    assert told[0].endswith("regret 987 within 1,000 steps.")
    assert told[1].endswith("regret ∞ without a limit.")


def test_circles_that_cost_nothing_by_themselves_are_told() -> None:
    policy = np.array(brl.solve("frozen-lake").policy)
    policy[3, 2] = brl.Action.STAY
    shown = agent("frozen-lake", policy)
    assert shown.differences == []
    assert "regret 0.82 without a limit." in shown.told[1]
    assert (
        shown.told[-1] == "Its episodes may go round in circles, at no cost of any single action."
    )
    assert not any(
        "circles" in each for each in agent("frozen-lake", random_policy("frozen-lake")).told
    )


def test_where_a_policy_is_not_known_it_is_optimal() -> None:
    best = brl.solve("cliff-walking")
    policy = np.full((4, 12, 5), np.nan)
    policy[3, 0] = np.eye(5)[brl.Action.STAY] / 2 + np.eye(5)[brl.Action.NORTH] / 2
    level = brl.load("cliff-walking")
    shown = agent(level, policy)
    assert [each.where for each in shown.differences] == ["[0, 3]"]
    assert shown.told[0].endswith("regret 1 within 1,000 steps and without a limit.")
    plain = page_agent(level, policy, None)
    assert (plain.told, plain.costs, plain.overlay.values) == ((), None, None)
    has_action = np.array(plain.policy).any(axis=1).reshape(4, 12)
    assert np.argwhere(has_action).tolist() == [[3, 0]]
    assert best.policy[3, 0] == brl.Action.NORTH


@pytest.mark.parametrize(
    ("policy", "wrong"),
    [
        (lambda: brl.solve("frozen-lake", actions="turns"), "cannot show a robot that turns"),
        (lambda: brl.solve("frozen-lake", within=9), "this policy changes with the step"),
        (lambda: [[0, 1], [2, 3]], "a policy for this level"),
        (lambda: np.full((4, 4), 7), "the policy's action at"),
    ],
)
def test_what_is_no_policy_of_the_level_is_refused(policy: Any, wrong: str) -> None:
    with pytest.raises(ValueError, match=wrong):
        brl.load("frozen-lake").to_html(policy=policy())


@pytest.mark.slow
def test_moves_are_numbered_as_they_say() -> None:
    level = brl.load("frozen-lake")
    moves = brl.solve(level, actions="moves")
    chances = np.eye(4)[np.maximum(moves.policy, 0)]
    page = level.to_html(policy=moves)
    assert page == level.to_html(policy=moves.policy) == level.to_html(policy=chances)


def test_a_level_without_an_optimum_shows_the_agent_alone() -> None:
    with pytest.warns(UserWarning, match="the page shows no optimal moves"):
        page = CANCELLING.to_html(policy=np.array([[2, 4, 0]]))
    assert '"walker":"agent"' in page
    assert "Agent and optimum" not in page


def test_costs_have_a_scale_of_their_own() -> None:
    level = brl.load("cliff-walking")
    shown = agent(level, random_policy(level))
    data = page_data(level, guide=guide_of(level, brl.solve(level)), agent=shown)["agent"]
    ends = [list(texts(each["legend"])) for each in (data, data["costs"])]
    assert shown.costs is not None
    assert shown.costs.values is not None
    costs = [value for row in shown.costs.values for value in row if value is not None]
    assert ends[0] != ends[1]
    assert number(ends[1][0]) == pytest.approx(min(costs), abs=0.01)


def texts(packed: Any) -> Iterator[str]:
    """Yield the texts in packed shapes."""
    for each in packed if isinstance(packed, list | tuple) else ():
        if isinstance(each, str):
            yield each
        yield from texts(each)
