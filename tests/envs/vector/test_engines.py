"""Both engines do the same, to the last bit, and draw no more than they need."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from gymnasium import error
from gymnasium.vector import AutoresetMode
from hypothesis import given
from hypothesis import strategies as st
from support.fleets import ENGINES, MODES, levels, same, walked
from support.playing import level_named

import babyrobot_levels as brl
from babyrobot_levels.envs.engine.draws import SharedDraws
from babyrobot_levels.envs.engine.plain import make_engine
from babyrobot_levels.envs.engine.tables import ALWAYS, TERMINAL, build_tables, info_dtype, part_of
from babyrobot_levels.envs.spaces import ACTION_SETS
from babyrobot_levels.envs.vector.env import LevelVectorEnv
from babyrobot_levels.library.level import Level


@pytest.mark.slow
@given(
    played=st.lists(levels(), min_size=1, max_size=4),
    mode=st.sampled_from(MODES),
    actions=st.sampled_from([*ACTION_SETS]),
    draw_levels=st.booleans(),
    copy=st.booleans(),
    seed=st.integers(0, 2**64),
)
def test_both_engines_walk_the_same_way(
    played: list[Level], mode: AutoresetMode, actions: str, draw_levels: bool, copy: bool, seed: int
) -> None:
    def walk(engine: str, copy: bool) -> list[Any]:
        envs = LevelVectorEnv(
            levels=played,
            num_envs=9,
            engine=engine,
            observation="walls",
            autoreset_mode=mode,
            actions=actions,
            draw_levels=draw_levels,
            copy=copy,
        )
        return walked(envs, 30, seed % 1000)

    assert same(walk("numpy", copy), walk("compiled", True))


@pytest.mark.parametrize("seed", [3, list(range(400))])
@pytest.mark.parametrize("mode", MODES)
def test_both_engines_walk_many_the_same_way(mode: AutoresetMode, seed: Any) -> None:
    def walk(engine: str) -> list[Any]:
        envs = LevelVectorEnv(
            levels=["ice-rink", "four-corners", "frozen-lake"],
            num_envs=400,
            engine=engine,
            autoreset_mode=mode,
            max_episode_steps=20,
        )
        envs.reset(seed=seed)
        sampled = np.random.default_rng(1).integers(5, size=(60, 400))
        told: list[Any] = []
        for actions in sampled:
            told.append(envs.step(actions))
            over = told[-1][2] | told[-1][3]
            if mode is AutoresetMode.DISABLED and over.any():
                told.append(envs.reset(options={"reset_mask": over}))
        for wrong in (5, -1, 2**40):
            with pytest.raises(error.InvalidAction, match=f"{wrong}, the action of env.* 399,"):
                envs.step([*[0] * 399, wrong])
        return told

    assert same(walk("numpy"), walk("compiled"))


def test_all_can_act_by_chance_and_begin_anew_in_the_same_step() -> None:
    ice = {"version": 1, "size": [3, 3], "skid": {"probability": 0.5, "to": "others"}}
    played = [{**ice, "start": starts} for starts in ([[1, 1], [0, 1]], [[1, 1], [1, 0], [2, 1]])]

    def walk(engine: str) -> list[Any]:
        envs = LevelVectorEnv(
            levels=played,
            num_envs=600,
            draw_levels=True,
            max_episode_steps=1,
            autoreset_mode="SameStep",
            engine=engine,
        )
        return [envs.reset(seed=1), *(envs.step(np.full(600, 1)) for _ in range(8))]

    told = walk("numpy")
    assert same(told, walk("compiled"))
    for begun, *_, info in told[1:]:
        assert info["_final_obs"].all()
        assert 0.3 < (begun == [1, 1]).all(axis=1).mean() < 0.5


@pytest.mark.slow
@given(
    played=st.lists(levels(), min_size=1, max_size=3),
    actions=st.sampled_from(["all", "moves"]),
    policy=st.sampled_from(["random", "uniform"]),
    seed=st.integers(0, 2**64),
)
def test_both_engines_roll_out_the_same(
    played: list[Level], actions: str, policy: str, seed: int
) -> None:
    def roll(engine: str) -> dict[str, Any]:
        given = {"num_envs": 7, "num_steps": 40, "seed": seed}
        return vars(brl.rollout(played, policy, **given, actions=actions, engine=engine))

    assert same(roll("numpy"), roll("compiled"))


@given(level=levels(), first_action=st.sampled_from([0, 1]))
def test_the_tables_are_those_of_the_level(level: Level, first_action: int) -> None:
    mdp = level.compile()
    parts = [
        part_of(each, each.compile(), first_action) for each in (level_named("frozen-lake"), level)
    ]
    tables = build_tables(parts, [1, 1])
    end = tables.outcome_info.view(info_dtype(tables.num_actions))["end"]
    base = tables.offset[1]
    for state in range(mdp.num_states):
        for action in range(tables.num_actions):
            row = (base + state) * tables.num_actions + action
            number = tables.next_state[row]
            thresholds = tables.threshold[number].tolist() if number < 0 else [ALWAYS]
            count = thresholds.index(ALWAYS) + 1
            chances = np.diff([0.0, *thresholds[: count - 1], 1.0])
            first = tables.first[number] if number < 0 else row
            outcomes = range(first, first + count)
            ends = tables.next_state[outcomes]
            is_over = end[outcomes] == TERMINAL
            told = zip(ends - base, tables.reward[outcomes], is_over, strict=True)
            wanted = mdp.outcomes(state, action + first_action)
            assert chances == pytest.approx([outcome[0] for outcome in wanted])
            assert list(told) == [outcome[1:] for outcome in wanted]
            assert (number < 0) == (count > 1)


@pytest.mark.parametrize("engine", ENGINES)
def test_levels_without_chance_draw_nothing(engine: str) -> None:
    envs = LevelVectorEnv("cliff-walking", num_envs=4, engine=engine)
    told = walked(envs, 20)
    assert len(told) == 21
    drawn = envs.np_random.random()
    assert drawn == np.random.default_rng(0).random()


class Quarters:
    """In the place of a generator: draws that lie on the thresholds themselves."""

    def __init__(self) -> None:
        self._count = 0

    def random(self, out: Any = None) -> float:
        numbers = (np.arange(1 if out is None else len(out)) + self._count) * 5 % 8 / 8
        self._count += len(numbers)
        if out is not None:
            out[:] = numbers
        return float(numbers[0])


@pytest.mark.parametrize("engine", ENGINES)
def test_a_draw_that_is_a_threshold_falls_on_the_same_side_as_in_a_single_environment(
    engine: str,
) -> None:
    world = {"version": 1, "size": [4, 4], "skid": {"probability": 0.75, "to": "others"}}
    single: Any = brl.load(world).make().unwrapped
    envs: Any = LevelVectorEnv(world, engine=engine)
    single.reset()
    envs.reset()
    single.np_random, envs.np_random = Quarters(), Quarters()
    for action in [1, 2, 3, 4, 3, 2] * 20:
        observation, _, terminated, *_ = single.step(action)
        observations, *_ = envs.step([action])
        assert observations[0].tolist() == observation.tolist()
        if terminated:
            break


def test_draws_are_those_of_the_generator_in_their_order() -> None:
    draws, taken = SharedDraws(np.random.default_rng(3), 700), list[float]()
    for count in (1, 700, 0, 650, 699, 13, 700) * 3:
        draws.reserve()
        taken += draws.take(count).tolist()
    assert taken == np.random.default_rng(3).random(len(taken)).tolist()


def test_drawn_levels_and_starts_are_all_there_are_evenly() -> None:
    four = level_named("four-corners")
    envs = LevelVectorEnv(levels=[four, "default"], num_envs=20_000, draw_levels=True)
    _, info = envs.reset(seed=5)
    assert info["level_index"].mean() == pytest.approx(0.5, abs=0.02)
    states, counts = np.unique(envs._envs.state[info["level_index"] == 0], return_counts=True)
    width = four.size[0]
    assert set(states) == {y * width + x for x, y in four.starts}
    assert counts / counts.sum() == pytest.approx(1 / len(four.starts), abs=0.02)


# -- which engine ----------------------------------------------------------------------------


def engine_of(name: str | None) -> str:
    level = level_named("default")
    tables = build_tables([part_of(level, level.compile(), 0)], [1])
    return make_engine(name, tables, np.empty((tables.state_info.size, 0), np.int64), 1).name


def without_numba(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "numba", None)


def where_nothing_is_compiled(monkeypatch: pytest.MonkeyPatch) -> None:
    import numba

    config: Any = numba.config
    monkeypatch.setattr(config, "DISABLE_JIT", 1)


def where_nothing_can_be_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    import numba

    def refuse(**_: Any) -> None:
        raise RuntimeError("cannot cache function")

    monkeypatch.setattr(numba, "njit", refuse)


def test_the_fastest_that_is_installed_is_the_default() -> None:
    assert [engine_of(name) for name in (None, "numpy", "compiled")] == [
        "compiled",
        "numpy",
        "compiled",
    ]


@pytest.mark.parametrize(
    "spoil", [without_numba, where_nothing_is_compiled, where_nothing_can_be_kept]
)
def test_where_nothing_can_be_compiled_numpy_does_it(
    spoil: Callable[[pytest.MonkeyPatch], None], monkeypatch: pytest.MonkeyPatch
) -> None:
    import babyrobot_levels.envs.engine

    for name in ("compiled", "loops"):
        monkeypatch.delitem(sys.modules, f"babyrobot_levels.envs.engine.{name}", raising=False)
        monkeypatch.delattr(babyrobot_levels.envs.engine, name, raising=False)
    spoil(monkeypatch)
    assert engine_of(None) == "numpy"
    with pytest.raises(ImportError, match="the extra `fast`"):
        engine_of("compiled")
    assert brl.rollout("default", "random", num_envs=3, num_steps=10).actions.shape == (10, 3)


def test_there_are_no_other_engines() -> None:
    with pytest.raises(ValueError, match=r"'compiled', not 'numpi'.*numpy"):
        engine_of("numpi")
