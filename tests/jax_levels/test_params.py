"""Levels as parameters: single ones of many, weights, and others in the same shapes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from support.jax_walks import POOL

import babyrobot_levels as brl
import babyrobot_levels.jax as brl_jax
from babyrobot_levels.jax.params import below, chosen, thresholds

SUITE = brl.load_suite("small-mazes")


def test_a_level_that_is_taken_alone_is_as_it_is_among_others() -> None:
    env, params = brl_jax.make(POOL, observation="index", actions="moves", draw_levels=False)
    number = np.arange(len(POOL))
    # Each in an environment of its own, and the indices are not known when it is compiled.
    each = jax.jit(params.take)(number)

    def walk(params: Any, key: Any, level: Any) -> Any:
        def one(state: Any, key: Any) -> Any:
            action = env.sample_action(key, state, params)
            observed, state, *told, info = env.step(key, state, action, params)
            return state, (state.state, observed, told, info)

        _, state = env.reset_to_level(key, level, params)
        return state.state, jax.lax.scan(one, state, jax.random.split(key, 300))[1]

    keys = jax.random.split(jax.random.key(3), len(POOL))
    together = jax.jit(jax.vmap(walk, (None, 0, 0)))(params, keys, number)
    alone = jax.jit(jax.vmap(walk, (0, 0, None)))(each, keys, 0)
    base = np.asarray(params.offset[:-1])
    assert np.array_equal(together[0] - base, alone[0])
    assert np.array_equal(together[1][0] - base[:, None], alone[1][0])
    for one, other in zip(
        *(jax.tree.leaves(found[1][1:]) for found in (together, alone)), strict=True
    ):
        assert np.array_equal(one, other)


def test_a_folder_is_all_of_its_levels(tmp_path: Path) -> None:
    for size in (2, 3):
        text = f"version: 1\nsize: [{size}, 1]\n"
        (tmp_path / f"{size}.yaml").write_text(text, encoding="utf-8")
    _, params = brl_jax.make(tmp_path)
    assert brl_jax.optimum(params).returns.tolist() == [0, -1]


def test_levels_are_drawn_by_their_weights() -> None:
    env, params = brl_jax.make(["default", "walls", "puddles", "maze"])
    keys = jax.random.split(jax.random.key(1), 4000)

    def drawn(params: Any) -> Any:
        return jax.vmap(env.reset, (0, None))(keys, params)[1].level

    assert np.bincount(drawn(params)) == pytest.approx(1000, rel=0.15)
    counts = np.bincount(drawn(params.weighted([0, 1, 0, 3])), minlength=4)
    assert counts[[0, 2]].tolist() == [0, 0]
    assert counts[3] / counts[1] == pytest.approx(3, rel=0.15)


def test_a_suite_draws_its_levels_by_its_weights() -> None:
    suite = brl.load_suite(
        {
            "version": 1,
            "kind": "suite",
            "levels": [{"level": "default", "weight": 1}, {"level": "walls", "weight": 4}],
        }
    )
    env, params = brl_jax.make(suite)
    keys = jax.random.split(jax.random.key(1), 1000)
    level = jax.vmap(env.reset, (0, None))(keys, params)[1].level
    assert np.mean(level) == pytest.approx(0.8, abs=0.05)
    # Levels of a list are drawn equally often, in the same arrays.
    other = env.load(list(suite))
    assert jax.tree.structure(other) == jax.tree.structure(params)
    assert np.asarray(other.drawn_level(jnp.uint32(2**31 - 1))) == 0


def test_other_levels_are_played_without_compiling_anew() -> None:
    env, params = brl_jax.make(SUITE[:5], observation="planes", room_for=SUITE[5:10])
    traced = []

    def played(params: Any, key: Any) -> Any:
        traced.append(key)
        _, state = env.reset_to_level(key, 4, params)
        return env.step(key, state, 1, params), params.take(4)

    key = jax.random.key(0)
    compiled = jax.jit(played)
    before = compiled(params, key)
    after = compiled(env.load(SUITE[5:10]), key)
    assert len(traced) == 1
    _, own = brl_jax.make(SUITE[5:10], observation="planes")
    (found, *_), alone = after
    base = own.offset[4]
    start = own.starts[own.first_start[4]]
    shown: Any = own.observations.at(own.next_state[start * 5 + 1])
    assert np.array_equal(found, shown)
    assert not np.array_equal(found, before[0][0])
    size = int(own.offset[5] - base)
    assert np.array_equal(
        alone.next_state[: 5 * size], own.next_state[5 * base :][: 5 * size] - base
    )


@pytest.mark.parametrize(
    ("weights", "message"),
    [
        ([1.0] * 3, r"one for each of the 2 levels, not an array of shape \[3\]"),
        (1.0, r"one for each of the 2 levels, not an array of shape \[\]"),
        ([0.0, 0.0], "must be finite, none of them below 0, and one above it"),
        ([2.0, -1.0], "must be finite"),
        ([1.0, np.nan], "must be finite"),
        ([1.0, np.inf], "must be finite"),
    ],
)
def test_weights_that_are_none_are_refused(weights: Any, message: str) -> None:
    _, params = brl_jax.make(["default", "maze"])
    with pytest.raises(ValueError, match=message):
        params.weighted(weights)


@pytest.mark.parametrize(
    ("levels", "message"),
    [
        ("maze", "there must be 2 levels, .*, not 1; give some of them several times"),
        (["maze"] * 3, "not 3; give fewer, or make the environment with as many"),
        (["default", "four-rooms"], "'four-rooms'.* does not fit: it has 11x11 cells, and the"),
        (["default", "first-key"], "does not fit: it has 1 items, and the spaces have 0"),
        (["maze", "maze"], "they have 80 states together, and there is room for 49"),
        (["default", "puddles"], "they have 7 pairs of state and action with several outcomes tog"),
        (["default", "random-maze"], "another maze in each episode"),
        (["default", "nowhere"], "no level called 'nowhere'"),
    ],
)
def test_levels_that_do_not_fit_are_refused(levels: Any, message: str) -> None:
    env, _ = brl_jax.make(["default", "maze"])
    with pytest.raises((ValueError, brl.LevelNotFoundError), match=message):
        env.load(levels)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"levels": []}, "at least one level"),
        ({"levels": "random-maze"}, r"another maze in each episode; .*with_maze_seed"),
        ({"levels": SUITE[:0]}, "at least one level"),
        ({"levels": "maze", "actions": "jump"}, "actions must be one of"),
        ({"levels": "maze", "observation": "pixels"}, "observation must be one of"),
        ({"levels": "maze", "view_radius": 2}, "need observation='view'"),
        ({"levels": "maze", "max_episode_steps": 0}, "max_episode_steps must be at least 1"),
        ({"levels": "maze", "max_bytes": 0}, "max_bytes must be a whole number"),
        (
            {"levels": SUITE, "observation": "image", "max_bytes": 2**23},
            r"the tables of \d+ of 10,000 levels take 8.\d MiB, more than max_bytes=8,388,608 "
            r"\(8.0 MiB\): .* KiB for transitions, .* MiB for the observation 'image'; give fewer",
        ),
        (
            {"levels": ["default"] * 50, "room_for": "four-rooms", "max_bytes": 2**17},
            "50 levels as large as the largest take",
        ),
    ],
)
def test_what_cannot_be_made_is_refused(arguments: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        brl_jax.make(**arguments)


def test_more_outcomes_than_can_be_numbered_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("babyrobot_levels.jax.loading.MOST_ENTRIES", 100)
    with pytest.raises(ValueError, match="3 of 3 levels have 135 outcomes, more than the 100 that"):
        brl_jax.make(["default"] * 3)


@pytest.mark.parametrize("observation", ["position", "planes", ("view", "vector")])
def test_the_bound_of_memory_is_that_of_what_is_made(observation: Any) -> None:
    levels = ["bat-cave", "ice-vault", "maze"]
    _, params = brl_jax.make(levels, observation=observation, actions="turns")
    size = params.nbytes
    brl_jax.make(levels, observation=observation, actions="turns", max_bytes=float(size))
    with pytest.raises(ValueError, match="more than max_bytes"):
        brl_jax.make(levels, observation=observation, actions="turns", max_bytes=size - 64)


def test_an_environment_stays_in_its_level_if_levels_are_not_drawn() -> None:
    env, params = brl_jax.make(["default", "walls", "maze"], draw_levels=False)
    keys = jax.random.split(jax.random.key(0), 64)
    _, state = jax.vmap(env.reset, (0, None))(keys, params)
    assert set(np.asarray(state.level).tolist()) == {0, 1, 2}
    stepped = jax.jit(jax.vmap(env.step, (0, 0, None, None)))
    now = state
    for _ in range(5):
        # Their episodes are over at each step.
        _, now, *_ = stepped(keys, now.__class__(now.time + 10**6, now.state, now.level), 1, params)
        assert np.array_equal(now.level, state.level)
        assert not np.asarray(now.time).any()


def test_sampled_actions_are_valid_and_equally_frequent() -> None:
    env, params = brl_jax.make("maze")
    states = [brl_jax.EnvState(*map(jnp.int32, (0, each, 0))) for each in range(params.num_states)]
    state = jax.tree.map(lambda *each: jnp.stack(each), *states)
    sample = jax.jit(jax.vmap(jax.vmap(env.sample_action, (None, 0, None)), (0, None, None)))
    actions = np.asarray(sample(jax.random.split(jax.random.key(0), 2000), state, params))
    masks = np.asarray(env.action_mask(state, params))
    for number in range(params.num_states):
        counts = np.bincount(actions[:, number], minlength=env.num_actions)
        allowed = masks[number].astype(bool)
        assert not counts[~allowed].any()
        assert counts[allowed] == pytest.approx(2000 / allowed.sum(), rel=0.25)


# -- words -----------------------------------------------------------------------------------


WORDS = np.unique(
    np.concatenate(
        [
            np.random.default_rng(0).integers(0, 2**32, 2000, np.uint32),
            np.array([0, 1, 2**16, 2**31 - 1, 2**31, 2**32 - 2, 2**32 - 1], np.uint32),
        ]
    )
)


def test_a_word_selects_the_number_that_its_draw_selects() -> None:
    counts = np.array([1, 2, 3, 7, 1000, 2**16, 2**16 + 1, 2**30, 2**31 - 1])
    found = jax.vmap(jax.vmap(below, (None, 0)), (0, None))(WORDS, jnp.asarray(counts))
    wanted = [[word * count >> 32 for count in counts.tolist()] for word in WORDS.tolist()]
    assert np.asarray(found).tolist() == wanted


def test_a_word_draws_the_outcome_that_its_draw_draws() -> None:
    rows = np.cumsum([[0.1, 0.2, 0.7], [1 / 3, 1 / 3, 1 / 3], [2.0**-40, 0.5, 0.5]], axis=1)
    # The draws at the thresholds themselves, and beside them.
    edges = np.ceil(rows[:, :-1].reshape(-1) * 2.0**32).astype(np.int64)
    words = np.concatenate([WORDS, *((edges + step).clip(0, 2**32 - 1) for step in (-1, 0, 1))])
    for row in rows:
        # An action with one outcome fewer than another has a threshold of 1.
        for cumulated in (row[:-1], np.append(row[:-1], 1.0)):
            limits = jnp.asarray(thresholds(cumulated))
            found = chosen(jnp.asarray(words, jnp.uint32)[:, None], limits)
            wanted = (words[:, None] / 2.0**32 >= cumulated).sum(axis=1)
            assert np.array_equal(found, wanted)
