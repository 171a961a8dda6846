"""Agents that move several robots: scored as those of one, by their tables or by episodes."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import babyrobot_levels as brl

PADS = "two-pads"


@pytest.fixture(scope="module")
def best() -> Any:
    """Return an optimal policy as a function of the default observation."""
    level = brl.load(PADS)
    mdp, solution = level.compile(), brl.solve(level)
    env = level.make()
    env.reset(seed=0)
    observer: Any = env.get_wrapper_attr("_observer")
    rows = observer.rows(observer.states())
    actions = mdp.robot_actions(np.maximum(solution.policy.ravel(), 0))
    known = {tuple(row): own for row, own in zip(rows.tolist(), actions.tolist(), strict=True)}
    return lambda observation: known[tuple(np.asarray(observation).tolist())]


@pytest.mark.slow
def test_a_function_chooses_the_action_of_each(best: Any) -> None:
    (row,) = brl.score(PADS, best)
    assert (row.expected_return, row.regret, row.success) == (-10.0, 0.0, 1.0)
    assert brl.score(PADS, best, positive_advantage=True)[0].positive_advantage == 0.0
    many = brl.score(PADS, lambda seen: np.array([best(each) for each in seen]), batched=True)
    assert many[0].expected_return == -10.0
    assert brl.evaluate(PADS, best).expected_return == -10.0
    (joint,) = brl.score(PADS, lambda seen: 5 * best(seen)[0] + best(seen)[1])
    assert joint.expected_return == -10.0
    (even,) = brl.score(PADS, lambda _: np.full(25, 1 / 25))
    assert even.expected_return == pytest.approx(brl.score(PADS, "uniform")[0].expected_return)


class Remembering:
    """Does what another agent does, and counts its steps."""

    def __init__(self, agent: Any) -> None:
        self.agent, self.steps = agent, 0

    def reset(self) -> None:
        self.steps = 0

    def act(self, observation: Any, mask: Any) -> Any:
        self.steps += 1
        actions = self.agent(observation)
        assert all(own[action] for own, action in zip(mask, actions, strict=True))
        return actions


@pytest.mark.filterwarnings("ignore:of an agent with memory")
def test_one_with_memory_plays_episodes(best: Any) -> None:
    agent = Remembering(best)
    (row,) = brl.score(PADS, agent, episodes=5)
    assert (row.expected_return, row.success) == (-10.0, 1.0)
    assert agent.steps == 7


@pytest.mark.parametrize("answer", [[2, 7], [2], 30, "east", [[1, 2]], [0.5, 0.5]])
def test_what_is_no_answer_is_told_with_the_place(answer: Any) -> None:
    told = "0 to 4 of each of the 2 robots, or 25 probabilities, not "
    with pytest.raises(ValueError, match=told):
        brl.score(PADS, lambda _: answer)


def test_levels_have_as_many_robots_as_the_agent_moves() -> None:
    with pytest.raises(ValueError, match="these have 1 to 2"):
        brl.score([PADS, "final-maze"], "random")
