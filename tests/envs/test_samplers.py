"""Samplers: which level an episode is in."""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np
import pytest
from support.fleets import ENGINES, same

import babyrobot_levels as brl

SUITE_ID = "babyrobot/Suite-v0"
NAMES = ["maze", "cliff-walking", "frozen-lake", "three-gems"]
WEIGHTED: dict[str, Any] = {
    "version": 1,
    "kind": "suite",
    "levels": ["maze", {"level": "cliff-walking", "weight": 6}, "frozen-lake"],
    "max_steps": 20,
}


def shares(sampler: brl.Sampler, count: int, size: int = 100_000) -> list[float]:
    drawn = sampler.sample(np.random.default_rng(0).random(size))
    assert drawn.dtype == np.int64
    found: list[float] = (np.bincount(drawn, minlength=count) / size).tolist()
    return found


def test_uniform_and_weighted_shares() -> None:
    assert shares(brl.UniformSampler(4), 4) == pytest.approx([0.25] * 4, abs=0.01)
    weighted = brl.WeightedSampler([1, 0, 3])
    assert shares(weighted, 3) == pytest.approx([0.25, 0, 0.75], abs=0.01)
    grouped = brl.WeightedSampler([1, 2], [1, 4])
    assert shares(grouped, 5) == pytest.approx([1 / 3, *[1 / 6] * 4], abs=0.01)


@pytest.mark.parametrize("weights", [[0.1] * 10, [1, 0], [0, 1], [1e-300, 1e300, 1e-300]])
def test_the_ends_of_the_draws_are_levels(weights: list[float]) -> None:
    ends = brl.WeightedSampler(weights).sample(np.array([0, np.nextafter(1, 0)]))
    assert all(weights[number] > 0 for number in ends)


def test_a_group_may_have_a_billion_levels() -> None:
    drawn = brl.WeightedSampler([1, 1], [10**9, 1]).sample(np.array([0, 0.25, 0.5, 0.75]))
    assert drawn.tolist() == [0, 5 * 10**8, 10**9, 10**9]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (([1, -1],), "weights must be finite"),
        (([0, 0],), "weights must be finite"),
        (([1, np.inf],), "weights must be finite"),
        (([1, np.nan],), "weights must be finite"),
        (([],), "weights must be finite"),
        (([1, 2], [1, 0]), "counts must be"),
    ],
)
def test_wrong_weights(arguments: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        brl.WeightedSampler(*arguments)


# -- prioritised level replay ----------------------------------------------------------------


def test_unseen_levels_come_first() -> None:
    sampler = brl.PrioritizedSampler(4, staleness=0)
    assert sampler.probabilities().tolist() == [0.25] * 4
    sampler.update([2], [1.0])
    assert sampler.probabilities().tolist() == [0.25, 0.25, 0.25, 0.25]
    sampler.update([0, 3], [5.0, 1.0])
    chances = sampler.probabilities()
    assert chances[1] == 0.25
    assert chances[0] > 0.7
    fixed = brl.PrioritizedSampler(4, staleness=0, unseen=0.5)
    fixed.update([2], [1.0])
    assert fixed.probabilities() == pytest.approx([1 / 6, 1 / 6, 0.5, 1 / 6])


def test_priorities_are_ranks_or_scores() -> None:
    ranked = brl.PrioritizedSampler(3, temperature=1, staleness=0)
    ranked.update([0, 1, 2], [-2.0, 10.0, 0.0])
    assert ranked.probabilities() == pytest.approx(np.array([1 / 3, 1, 1 / 2]) / (11 / 6))
    scored = brl.PrioritizedSampler(3, by="score", temperature=0.5, staleness=0)
    scored.update([0, 1, 2], [1.0, 3.0, 0.0])
    assert scored.probabilities() == pytest.approx([0.1, 0.9, 0])
    scored.update([0, 1], [0.0, 0.0])
    assert scored.probabilities() == pytest.approx([1 / 3] * 3)


def test_levels_that_were_not_drawn_for_long_are_drawn() -> None:
    sampler = brl.PrioritizedSampler(2, staleness=1)
    sampler.update([0, 1], [9.0, 1.0])
    drawn = [int(sampler.sample(np.array([0.0]))[0]) for _ in range(6)]
    assert drawn == [0, 1, 0, 1, 0, 1]


def test_the_last_score_of_a_level_counts() -> None:
    sampler = brl.PrioritizedSampler(3)
    sampler.update(np.array([1, 1]), np.array([5.0, 2.0]))
    assert np.array_equal(sampler.scores, [np.nan, 2.0, np.nan], equal_nan=True)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"by": "size"}, "by must be one of"),
        ({"temperature": 0}, "temperature must be above 0"),
        ({"staleness": 1.5}, "staleness must be from 0 to 1"),
        ({"unseen": -1}, "unseen must be from 0 to 1"),
    ],
)
def test_wrong_arguments(arguments: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        brl.PrioritizedSampler(3, **arguments)


@pytest.mark.parametrize(
    ("levels", "scores", "message"),
    [
        ([0, 1], [1.0], "the same length"),
        ([3], [1.0], "below 3"),
        ([-1], [1.0], "below 3"),
        ([0.5], [1.0], "whole numbers"),
        ([0], [np.nan], "finite"),
        ([0], [-1.0], "from 0 on"),
    ],
)
def test_wrong_scores(levels: Any, scores: Any, message: str) -> None:
    sampler = brl.PrioritizedSampler(3, by="score")
    with pytest.raises(ValueError, match=message):
        sampler.update(levels, scores)
    assert np.isnan(sampler.scores).all()


# -- in environments -------------------------------------------------------------------------


class Only:
    """A sampler that always draws one level."""

    def __init__(self, number: Any) -> None:
        self.number = number

    def sample(self, draws: Any) -> Any:
        return np.full(draws.shape, self.number)


@pytest.mark.parametrize("engine", ENGINES)
def test_a_sampler_selects_the_levels(engine: str) -> None:
    several = brl.LevelVectorEnv(
        levels=NAMES, num_envs=3, draw_levels=True, sampler=Only(2), engine=engine
    )
    suite: Any = gymnasium.make_vec(
        SUITE_ID, suite=WEIGHTED, num_envs=3, sampler=Only(2), engine=engine
    )
    for envs in (several, suite):
        _, info = envs.reset(seed=1)
        assert info["level_index"].tolist() == [2, 2, 2]
        assert {level.name for level in envs.call("level")} == {"frozen-lake"}
    single: Any = gymnasium.make(SUITE_ID, suite=WEIGHTED, sampler=Only(2))
    assert single.reset(seed=1)[1]["level_index"] == 2


def test_weights_of_a_suite_select_its_levels() -> None:
    envs: Any = gymnasium.make_vec(SUITE_ID, suite=WEIGHTED, num_envs=4000)
    drawn = np.bincount(envs.reset(seed=1)[1]["level_index"]) / 4000
    assert drawn == pytest.approx([1 / 8, 6 / 8, 1 / 8], abs=0.03)
    single: Any = gymnasium.make(SUITE_ID, suite=WEIGHTED)
    _, info = single.reset(seed=1)
    numbers = [info["level_index"], *(single.reset()[1]["level_index"] for _ in range(200))]
    assert 0.6 < np.mean(np.array(numbers) == 1) < 0.9


@pytest.mark.slow
@pytest.mark.parametrize("engine", ENGINES)
def test_with_seeds_of_their_own_levels_are_those_of_single_environments(engine: str) -> None:
    # Levels differ in their numbers of starts, limits and things.
    several = {**WEIGHTED, "levels": [*WEIGHTED["levels"], "gridworld-4-1", "night-watch"]}
    envs: Any = gymnasium.make_vec(SUITE_ID, suite=several, num_envs=3, engine=engine)
    singles: list[Any] = [gymnasium.make(SUITE_ID, suite=several) for _ in range(3)]
    shown, _ = envs.reset(seed=[4, 5, 6])
    alone = [env.reset(seed=4 + number)[0] for number, env in enumerate(singles)]
    rng, over, met = np.random.default_rng(0), [False] * 3, set()
    for _ in range(120):
        assert shown.tolist() == [each.tolist() for each in alone]
        met |= {level.name for level in envs.call("level")}
        actions = rng.integers(0, 5, 3)
        shown, *_ = envs.step(actions)
        for number, env in enumerate(singles):
            if over[number]:
                alone[number], over[number] = env.reset()[0], False
            else:
                alone[number], _, end, cut, _ = env.step(int(actions[number]))
                over[number] = end or cut
    assert len(met) >= 4


def test_the_same_seed_gives_the_same_levels() -> None:
    def play(seed: int) -> list[Any]:
        sampler = brl.PrioritizedSampler(4)
        envs = brl.LevelVectorEnv(
            levels=NAMES, num_envs=8, draw_levels=True, sampler=sampler, max_episode_steps=3
        )
        told: list[Any] = [envs.reset(seed=seed)]
        for _ in range(20):
            told.append(envs.step(np.zeros(8, int)))
            numbers = told[-1][-1]["level_index"]
            sampler.update(numbers, numbers.astype(float))
        return told

    assert same(play(1), play(1))
    assert not same(play(1), play(2))


@pytest.mark.parametrize(
    ("number", "message"), [(4, "returned 4, but the levels are 0 to 3"), (0.5, "whole numbers")]
)
def test_what_a_sampler_returns_is_checked(number: Any, message: str) -> None:
    envs = brl.LevelVectorEnv(levels=NAMES, draw_levels=True, sampler=Only(number))
    with pytest.raises(ValueError, match=message):
        envs.reset(seed=1)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"levels": NAMES, "sampler": Only(0)}, "draw_levels=True"),
        ({"level": "maze", "sampler": Only(0), "draw_levels": True}, "draw_levels=True"),
        ({"levels": NAMES, "sampler": 3, "draw_levels": True}, "method `sample"),
    ],
)
def test_samplers_that_cannot_be(arguments: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        brl.LevelVectorEnv(**arguments)
