"""Rewards that are drawn: what the tables have of them, and what is told of the tables."""

from collections import Counter

import numpy as np
import pytest

import babyrobot_levels as brl
from babyrobot_levels.render.words.rules import rules_of

REWARD = {"values": [-1, 5], "weights": [3, 1]}
LEVEL = {
    "version": 1,
    "size": [3, 1],
    "areas": [{"at": [1, 0], "size": [2, 1], "reward": REWARD}],
    "rewards": {"exit": "cell"},
}


def test_solvers_take_the_mean() -> None:
    # Staying on the second cell pays 0.5 for ever, which is more than the exit.
    assert brl.solve(LEVEL, 0.5).expected_return == pytest.approx(1)
    assert brl.evaluate(LEVEL, np.array([2, 2, 0]), 0.5).expected_return == pytest.approx(0.75)


def test_the_distribution_of_returns_is_exact() -> None:
    level = brl.load({**LEVEL, "max_steps": 2})
    found = brl.return_distribution(level, np.array([2, 2, 0]))
    assert found.values.tolist() == [-2, 4, 10]
    assert found.probabilities == pytest.approx(np.array([9, 6, 1]) / 16)


def test_model_checkers_get_the_mean_as_a_fraction() -> None:
    areas = [{"at": [1, 0], "reward": {"values": [-1, 5, 0], "weights": [3, 3, 1]}}]
    assert "[east] s=0 : 12/7;" in brl.export({**LEVEL, "areas": areas}, "prism").content


@pytest.mark.slow
def test_each_step_draws_the_reward_anew_by_the_seed() -> None:
    def episode(seed: int) -> tuple[float, ...]:
        env = brl.load(LEVEL).make()
        env.reset(seed=seed)
        return tuple(float(env.step(brl.Action.EAST)[1]) for _ in range(2))

    episodes = [episode(seed) for seed in range(100)]
    assert episodes == [episode(seed) for seed in range(100)]
    assert {*episodes} == {(-1, -1), (-1, 5), (5, -1), (5, 5)}
    assert 30 < Counter(sum(episodes, ()))[5] < 70


def test_values_that_are_alike_are_one_outcome() -> None:
    area = {"at": [1, 0], "reward": {"values": [2, 2]}}
    sure = {**LEVEL, "areas": [{**area, "reward": 2}]}
    assert brl.load({**LEVEL, "areas": [area]}).digest == brl.load(sure).digest


def test_a_later_number_takes_the_place_of_a_drawn_reward() -> None:
    areas = [*LEVEL["areas"], {"at": [1, 0], "reward": 7}]  # type: ignore[misc]
    mdp = brl.load({**LEVEL, "areas": areas}).compile()
    assert mdp.outcomes(0, brl.Action.EAST) == [(1, 1, 7, False)]
    assert len(mdp.outcomes(1, brl.Action.EAST)) == 2


def test_the_rules_tell_values_and_how_often_they_are_drawn() -> None:
    told = " ".join(rule.text for rule in rules_of(brl.load(LEVEL)))
    assert "costs 1 (3 times in 4) or pays 5 (1 time in 4)" in told


def test_a_difference_of_weights_is_told() -> None:
    areas = [{**LEVEL["areas"][0], "reward": {**REWARD, "weights": [1, 3]}}]  # type: ignore[index]
    change = brl.diff(LEVEL, {**LEVEL, "areas": areas}).cells.first[0]
    assert change.before["reward"]["weights"] == [3, 1]


def test_too_many_outcomes_name_the_rewards() -> None:
    values = {"values": [*range(16)]}
    fields = {
        "version": 1,
        "size": [5, 3],
        "areas": [{"at": [0, 0], "size": [5, 3], "reward": values}],
        "wind": {"east": [1, 1, 1], "varies": True},
        "skid": {"probability": 0.5, "to": "others"},
        "items": [{"name": "key", "at": [1, 0]}],
    }
    with pytest.raises(brl.LevelError, match="values of rewards"):
        brl.load(fields).compile()


def test_values_that_are_too_large_to_add_up_are_told() -> None:
    # Their sum is no number, and their mean is one.
    level = brl.load({**LEVEL, "areas": [{"at": [1, 0], "reward": {"values": [1e308, 1e308]}}]})
    with pytest.raises(brl.BabyRobotError, match="too large to add up"):
        brl.solve(level)


@pytest.mark.parametrize(
    ("reward", "help_text"),
    [
        ({"weights": [3, 1]}, "add `values: [-1, 5]`"),
        ({"values": [-1, 5], "probabilities": [0.75, 0.25]}, "`weights`"),
    ],
)
def test_mistakes_lead_to_what_is_meant(reward: object, help_text: str) -> None:
    with pytest.raises(brl.LevelError) as told:
        brl.load({**LEVEL, "areas": [{"at": [1, 0], "reward": reward}]})
    assert help_text in str(told.value)
