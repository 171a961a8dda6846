"""Levels that compiled code makes: their tables are those of their files."""

from __future__ import annotations

from functools import cache, partial
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from support.jax_walks import bits_64

import babyrobot_levels as brl
import babyrobot_levels.jax as brl_jax

MIXED: dict[str, Any] = {
    "version": 1,
    "size": [6, 5],
    "exit": [5, 4],
    "blocked": [{"at": [2, 2], "size": [2, 1]}],
    "areas": [
        {"at": [4, 0], "size": [2, 2], "reward": -3, "skid": {"probability": 0.3, "to": "others"}},
        {"at": [0, 4], "ends": True},
    ],
    "skid": {"probability": 0.1, "to": "sides"},
    "rewards": {"step": -1, "bump": -2.5, "stay": -0.3, "closer": -0.7, "farther": -1.3, "exit": 7},
    "discount": 0.95,
    "max_steps": 60,
}
BYTES: dict[str, Any] = {"planes_dtype": "uint8", "channels_last": True}


@cache
def mazes() -> tuple[brl_jax.LevelEnvironment, brl_jax.Designs]:
    """Sixteen designs of a maze: what is compiled for one test is there for the next."""
    return brl_jax.designs("final-maze", 16)


def one_of(layouts: brl_jax.Layout, number: int) -> brl_jax.Layout:
    one: brl_jax.Layout = jax.tree.map(lambda array: array[number], layouts)
    return one


def mutants(made: brl_jax.Designs, edits: int, **more: Any) -> brl_jax.Layout:
    keys = jax.random.split(jax.random.key(7), made.count)
    start = made.layout(made.base)
    found: brl_jax.Layout = jax.vmap(lambda key: made.mutate(key, start, edits, **more))(keys)
    return found


def same(one: Any, other: Any) -> None:
    assert jax.tree.structure(one) == jax.tree.structure(other)
    for first, second in zip(jax.tree.leaves(one), jax.tree.leaves(other), strict=True):
        assert first.dtype == second.dtype
        np.testing.assert_array_equal(first, second)


@pytest.mark.parametrize(
    ("base", "actions", "options"),
    [
        pytest.param("final-maze", "moves", {"observation": "planes"}, marks=pytest.mark.sweep),
        pytest.param("final-maze", "all", {"observation": "index"}, marks=pytest.mark.sweep),
        pytest.param("frozen-lake", "moves", {"observation": "position"}, marks=pytest.mark.sweep),
        (MIXED, "all", {"observation": "planes", **BYTES}),
    ],
    ids=["planes", "stay", "ice", "mixed"],
)
def test_tables_are_those_of_the_saved_files(
    base: Any, actions: str, options: dict[str, Any], tmp_path: Path
) -> None:
    with bits_64():
        env, made = brl_jax.designs(base, 8, actions=actions, **options)
        layouts = mutants(made, 30)
        paths = [tmp_path / f"evolved-{number}.yaml" for number in range(made.count)]
        for number, path in enumerate(paths):
            made.level(one_of(layouts, number)).save(path)
        levels = [brl.load(path) for path in paths]
        assert len({level.digest for level in levels}) == made.count
        same(made.params(layouts), env.load(levels))
        for number, level in enumerate(levels):
            same(made.layout(level), one_of(layouts, number))


@pytest.mark.sweep
def test_tables_of_32_bits_are_close_to_those_of_the_files() -> None:
    env, made = brl_jax.designs(MIXED, 4, observation="index")
    layouts = mutants(made, 20)
    params = made.params(layouts)
    files = env.load([made.level(one_of(layouts, number)) for number in range(4)])
    assert jax.tree.structure(params) == jax.tree.structure(files)
    np.testing.assert_allclose(params.probability, files.probability, atol=1e-6)
    np.testing.assert_allclose(params.reward, files.reward, rtol=1e-6)
    np.testing.assert_array_equal(params.next_state, files.next_state)


@pytest.mark.sweep
def test_mutants_are_solvable_where_asked() -> None:
    _, made = mazes()
    layouts = mutants(made, 60)
    assert jax.vmap(made.is_solvable)(layouts).all()
    for number in range(0, 16, 4):
        level = made.level(one_of(layouts, number))
        assert brl.solve(level).exit_probability == pytest.approx(1)
    free = mutants(made, 60, solvable=False)
    told = jax.vmap(made.is_solvable)(free)
    assert not told.all()
    for number in range(16):
        lengths = brl.metrics(made.level(one_of(free, number))).path_length
        assert (lengths is not None) == bool(told[number])


@pytest.mark.parametrize("kind", ["wall", "puddle", "start", "exit"])
def test_only_what_is_asked_for_is_edited(kind: str) -> None:
    _, made = mazes()
    before, after = made.layout("final-maze"), mutants(made, 5, kinds=(kind,))
    fields = {"wall": "walls", "puddle": "puddles", "start": "start", "exit": "exit"}
    for name in fields.values():
        is_same = (getattr(after, name) == getattr(before, name)).all()
        assert bool(is_same) == (name != fields[kind])


def test_an_evolution_is_one_compiled_loop() -> None:
    env, made = mazes()

    def evolve(key: Any) -> Any:
        def generation(layouts: Any, key: Any) -> Any:
            children = jax.vmap(partial(made.mutate, edits=3))(jax.random.split(key, 16), layouts)
            params = made.params(children)
            regret = brl_jax.regret(params, brl_jax.random_policy(params), within="max_steps")
            _, states = jax.vmap(env.reset_to_level, (0, 0, None))(
                jax.random.split(key, 16), jnp.arange(16), params
            )
            return children, (regret, states.state)

        first = jax.tree.map(lambda array: jnp.stack([array] * 16), made.layout("final-maze"))
        return jax.lax.scan(generation, first, jax.random.split(key, 5))

    layouts, (regret, states) = jax.jit(evolve)(jax.random.key(0))
    assert regret.shape == states.shape == (5, 16)
    assert (np.asarray(states[-1]) % 40 == layouts.start).all()
    level = made.level(one_of(layouts, 3))
    optimum = brl.solve(level, within=500).expected_return
    random = brl.evaluate(level, "random", within=500, actions="moves").expected_return
    assert float(regret[-1, 3]) == pytest.approx(optimum - random, rel=1e-4)


@pytest.mark.parametrize(
    ("level", "message"),
    [
        ("door-key", "has things"),
        ("windy-gridworld", "has wind"),
        ("windy-gridworld-king", "has diagonal moves"),
        ("glass-wall", "has glass"),
        ({"version": 1, "size": [2, 2], "exit": "none"}, "has several exits or none"),
    ],
)
def test_levels_with_more_are_refused(level: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        brl_jax.designs(level, 2)


def test_wrong_arguments_are_named() -> None:
    _, made = mazes()
    with pytest.raises(ValueError, match="differs from the base in more than walls"):
        made.layout("frozen-lake")
    with pytest.raises(ValueError, match=r"there must be 16 levels, not \[\]"):
        made.params(made.layout("final-maze"))
    with pytest.raises(ValueError, match="count must be a whole number, at least 1"):
        brl_jax.designs("final-maze", 0)
    with pytest.raises(ValueError, match="observation must be"):
        brl_jax.designs("final-maze", 2, observation="view")
    with pytest.raises(ValueError, match="kinds must be"):
        made.mutate(jax.random.key(0), made.layout("final-maze"), kinds=("walls",))
