"""How often policies visit states: sums, simulated episodes, loops, discounts, and pictures."""

from __future__ import annotations

from random import Random

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oracles.random_things import random_level

import babyrobot_levels as brl
from babyrobot_levels.analysis.solver.occupancy import occupancy, successor_representation
from babyrobot_levels.analysis.solver.results import EpisodeTooLongError, UndefinedReturnError


@pytest.mark.slow
@given(
    st.integers(0, 10**6), st.sampled_from([0.5, 0.99]), st.sampled_from(["all", "moves", "turns"])
)
def test_visits_times_rewards_are_the_return(seed: int, discount: float, actions: str) -> None:
    level = brl.load(random_level(Random(seed)))
    found = occupancy(level, "random", discount, actions)
    worth = brl.evaluate(level, "random", discount, actions)
    mdp = level.compile() if actions != "turns" else level.compile().turning(level.heading)
    first = worth.first_action if actions != "turns" else 0
    possible = mdp.action_mask[:, first:].astype(float)
    possible[~possible.any(axis=1)] = 1.0
    weights = possible / possible.sum(axis=1, keepdims=True)
    rewards = np.einsum("sa,sao,sao->s", weights, mdp.probability[:, first:], mdp.reward[:, first:])
    visits = np.where(mdp.is_terminal, 0.0, np.nan_to_num(found.states.ravel()))
    assert visits @ rewards == pytest.approx(worth.expected_return, abs=1e-9)
    # Each step counts by its discount; all of them together are at most 1 / (1 - discount).
    assert visits.sum() == pytest.approx(found.steps)
    assert found.steps <= 1 / (1 - discount) + 1e-9
    assert np.nansum(found.states) == pytest.approx(found.visits.sum())


@pytest.mark.slow
@given(st.integers(0, 10**6))
def test_without_a_discount_they_add_up_to_the_steps(seed: int) -> None:
    level = brl.load(random_level(Random(seed)))
    try:
        solution = brl.solve(level)
        found = occupancy(level, solution, 1.0)
    except (UndefinedReturnError, EpisodeTooLongError):
        return
    if level.discount == 1 or np.isfinite(solution.expected_steps):
        assert found.steps == pytest.approx(solution.expected_steps)
    if np.isfinite(found.steps) and level.exits:
        # Every episode ends once.
        over = level.compile().is_terminal.reshape(found.states.shape)
        hits = any(True for _ in level.movers)
        assert hits or np.nansum(found.states[over]) == pytest.approx(1.0)


@pytest.mark.slow
def test_simulated_episodes_visit_cells_as_often() -> None:
    level = brl.load("frozen-lake")
    found, env = occupancy(level, "random"), level.make()
    counts, random = np.zeros((4, 4)), np.random.default_rng(0)
    for episode in range(1500):
        observation, info = env.reset(seed=None if episode else 0)
        over = False
        while not over:
            counts[observation[1], observation[0]] += 1
            action = random.choice(np.flatnonzero(info["action_mask"]))
            observation, _, terminated, truncated, info = env.step(action)
            over = terminated or truncated
        counts[observation[1], observation[0]] += terminated
    assert np.abs(counts / 1500 - found.visits).max() < 0.25


def test_what_goes_on_for_ever_is_inf() -> None:
    found = occupancy({"version": 1, "size": [3, 1], "exit": "none"}, np.array([[2, 0, 0]]))
    assert found.visits.tolist() == [[1.0, np.inf, 0.0]]
    assert found.steps == np.inf
    with pytest.raises(ValueError, match="for ever, so that visits have no picture"):
        brl.load({"version": 1, "size": [3, 1], "exit": "none"}).to_svg(visits="random")


@pytest.mark.slow
def test_the_successor_representation_gives_the_values() -> None:
    level = brl.load("frozen-lake")
    ahead = successor_representation(level, "random", 0.9)
    found, worth = occupancy(level, "random", 0.9), brl.evaluate(level, "random", 0.9)
    over = level.compile().is_terminal
    start = level.compile().start
    assert (start @ ahead)[~over] == pytest.approx(found.states.ravel()[~over])
    mdp, weights = (
        level.compile(),
        level.compile().action_mask / level.compile().action_mask.sum(1)[:, None],
    )
    rewards = np.einsum("sa,sao,sao->s", weights, mdp.probability, mdp.reward)
    rewards[over] = 0
    assert ahead @ rewards == pytest.approx(np.where(over, 0, worth.values.ravel()))
    with pytest.raises(ValueError, match="a discount below 1"):
        successor_representation(level, "random")
    with pytest.raises(ValueError, match="at most 4,000 states"):
        successor_representation({"version": 1, "size": [64, 64]}, "random", 0.9)


def test_pictures_show_them() -> None:
    level = brl.load("final-maze")
    best = occupancy(level, brl.solve(level))
    assert level.to_svg(visits=best) == level.to_svg(visits="best") == level.to_svg(visits=True)
    assert ">2.50<" in level.to_svg(visits=best)
    assert level.to_svg(visits="random") != level.to_svg(visits="best")
    with pytest.raises(ValueError, match="there is no agent 'worst'"):
        level.to_svg(visits="worst")
    assert "<img" in best._repr_mimebundle_()["text/html"]
    assert repr(best) == "<Occupancy steps=23.8333 discount=1>"


@pytest.mark.parametrize("discount", [0.5, 0.9, 1.0])
def test_whoever_begins_goes_on_or_ends(discount: float) -> None:
    found = occupancy("frozen-lake", "random", discount)
    over = brl.load("frozen-lake").compile().is_terminal.reshape(4, 4)
    assert found.visits[over].sum() + (1 - discount) * found.steps == pytest.approx(1.0)
