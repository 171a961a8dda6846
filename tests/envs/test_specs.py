"""Time limits and reward thresholds: what specs tell, and when episodes are cut."""

from __future__ import annotations

import copy
import pickle
from typing import Any

import gymnasium
import pytest
from gymnasium import error
from gymnasium.envs.registration import EnvSpec, registry
from gymnasium.wrappers import TimeLimit
from support.combinations import combined, swept
from support.ids import FEW, IDS, LEVEL_ID, SUITE_ID

import babyrobot_levels as brl
from babyrobot_levels.analysis.solver.horizon import best_return_within

UNLIMITED: dict[str, Any] = {"version": 1, "size": [5, 5]}
SHORT = brl.Level(version=1, size=(5, 5), max_steps=7)

ENVIRONMENTS: dict[str, tuple[str, dict[str, Any], int | None]] = {
    "an id": ("babyrobot/final-maze-v0", {}, 500),
    "a name": (LEVEL_ID, {"level": "frozen-lake"}, 100),
    "a level": (LEVEL_ID, {"level": SHORT}, 7),
    "a level without a limit": (LEVEL_ID, {"level": UNLIMITED}, None),
    "random mazes": ("babyrobot/random-maze-v0", {}, 200),
    "random mazes by name": (LEVEL_ID, {"level": "random-maze"}, 200),
    "a suite": (SUITE_ID, {"suite": "small-mazes", "split": "train"}, 500),
}

MODES = ("single", "sync", "vector_entry_point")

each_mode = pytest.mark.parametrize("mode", MODES)


def make(mode: str, env_id: str | EnvSpec, **given: Any) -> Any:
    if mode == "single":
        return gymnasium.make(env_id, **given)
    return gymnasium.make_vec(env_id, 2, mode, **given)


def cut_after(env: Any) -> int | None:
    """Return after how many steps an episode without a move is truncated; None if it is not."""
    env.reset(seed=1)
    is_single = isinstance(env, gymnasium.Env)
    for number in range(1, 600):
        *_, truncated, _ = env.step(0 if is_single else [0, 0])
        if truncated if is_single else truncated.any():
            return number
    return None


# -- the limit that applies ------------------------------------------------------------------


@combined(2, name=ENVIRONMENTS, mode=MODES, asked=[None, 3, 550, -1])
def test_one_limit_applies_and_the_spec_tells_it(name: str, mode: str, asked: int | None) -> None:
    env_id, given, own = ENVIRONMENTS[name]
    limit = own if asked is None else None if asked == -1 else asked
    more = {} if asked is None else {"max_episode_steps": asked}
    env = make(mode, env_id, **given, **more)
    assert env.spec.max_episode_steps == limit
    assert cut_after(env) == limit


def test_there_is_one_time_limit() -> None:
    env: Any = gymnasium.make(LEVEL_ID, level=SHORT, max_episode_steps=20)
    wrappers = []
    while isinstance(env, gymnasium.Wrapper):
        wrappers.append(type(env))
        env = env.env
    assert wrappers.count(TimeLimit) == 1


def test_several_levels_have_their_own_limits_unless_one_is_asked_for() -> None:
    levels = [SHORT, SHORT.replace(max_steps=9)]
    envs: Any = gymnasium.make_vec(LEVEL_ID, 2, levels=levels)
    assert envs.spec.max_episode_steps is None
    envs.reset(seed=1)
    cut = [envs.step([0, 0])[3].tolist() for _ in range(9)]
    assert cut[6] == [True, False]
    assert cut[8][1]
    same: Any = gymnasium.make_vec(LEVEL_ID, 2, levels=[SHORT, SHORT])
    assert same.spec.max_episode_steps == cut_after(same) == 7
    asked: Any = gymnasium.make_vec(LEVEL_ID, 2, levels=levels, max_episode_steps=4)
    assert asked.spec.max_episode_steps == cut_after(asked) == 4
    assert cut_after(gymnasium.make_vec(LEVEL_ID, 2, level=SHORT, max_episode_steps=2**70)) is None


def test_the_ids_themselves_have_no_limit_before_something_is_made() -> None:
    gymnasium.make(LEVEL_ID, level=SHORT)
    for env_id in (LEVEL_ID, SUITE_ID):
        assert gymnasium.spec(env_id).max_episode_steps is None
        assert gymnasium.spec(env_id).reward_threshold is None


# -- the threshold ---------------------------------------------------------------------------


@each_mode
def test_the_threshold_is_the_optimum_within_the_limit(mode: str) -> None:
    lake = make(mode, "babyrobot/frozen-lake-v0")
    assert lake.spec.reward_threshold == pytest.approx(0.744190, abs=1e-6)
    longer = make(mode, "babyrobot/frozen-lake-v0", max_episode_steps=1000)
    assert longer.spec.reward_threshold == pytest.approx(14 / 17, abs=1e-6)
    maze = make(mode, LEVEL_ID, level="final-maze")
    solution = brl.solve("final-maze")
    assert maze.spec.reward_threshold == pytest.approx(solution.expected_return, abs=1e-6)


@pytest.mark.parametrize(
    ("actions", "same"), [("valid", "all"), ("valid_moves", "moves"), ("turns", "turns")]
)
def test_the_threshold_is_that_of_the_actions(actions: str, same: str) -> None:
    spec = gymnasium.make("babyrobot/night-watch-v0", actions=actions).spec
    assert spec is not None
    expected = best_return_within("night-watch", 200, actions=same)
    assert spec.reward_threshold == expected
    assert best_return_within("night-watch", 200, actions="turns") < expected or same == "turns"


@combined(1, name=["a level without a limit", "random mazes", "a suite"], mode=MODES)
def test_where_there_is_no_threshold(name: str, mode: str) -> None:
    env_id, given, _ = ENVIRONMENTS[name]
    assert make(mode, env_id, **given).spec.reward_threshold is None


def test_levels_that_would_take_long_have_no_threshold() -> None:
    large = {"version": 1, "size": [400, 400], "max_steps": 10}
    long = {"version": 1, "size": [100, 100], "max_steps": 501}
    almost = {"version": 1, "size": [100, 100], "max_steps": 500}
    specs = [gymnasium.make(LEVEL_ID, level=level).spec for level in (large, long, almost)]
    told = [None if spec is None else spec.reward_threshold for spec in specs]
    assert told == [None, None, -197]


def test_a_threshold_can_be_set() -> None:
    spec = copy.deepcopy(gymnasium.spec("babyrobot/frozen-lake-v0"))
    spec.reward_threshold = 0.7
    made = gymnasium.make(spec).spec
    assert made is not None
    assert spec.reward_threshold == made.reward_threshold == 0.7


def test_making_does_not_compute_the_threshold(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: Any) -> float:
        raise AssertionError("nobody asked for it")

    monkeypatch.setattr("babyrobot_levels.envs.specs._best_return", refuse)
    with pytest.raises(AssertionError, match="nobody"):
        gymnasium.spec("babyrobot/final-maze-v0").reward_threshold  # noqa: B018
    for mode in MODES:
        make(mode, "babyrobot/final-maze-v0").reset()


# -- specs -----------------------------------------------------------------------------------


def copies(spec: EnvSpec) -> list[EnvSpec]:
    return [
        EnvSpec.from_json(spec.to_json()),
        copy.deepcopy(spec),
        pickle.loads(pickle.dumps(spec)),
    ]


@pytest.mark.parametrize("env_id", swept(FEW, IDS))
def test_the_spec_of_every_id_equals_its_copies(env_id: str) -> None:
    spec = gymnasium.spec(env_id)
    for same in copies(spec):
        assert spec == same
        assert same == spec
    for options in ({}, {"include_entry_points": True}, {"print_all": True}):
        assert f"id={env_id}" in str(spec.pprint(disable_print=True, **options))
    assert spec != gymnasium.spec("CartPole-v1")


@pytest.mark.slow
@combined(1, name=ENVIRONMENTS, mode=["single", "vector_entry_point"])
def test_the_spec_of_an_environment_equals_its_copies_and_makes_it(name: str, mode: str) -> None:
    env_id, given, limit = ENVIRONMENTS[name]
    env = make(mode, env_id, **given, observation="image", image_size=(36, 40))
    for same in copies(env.spec):
        assert env.spec == same
        assert same == env.spec
        again = make(mode, same) if mode == "single" else gymnasium.make_vec(same)
        assert again.spec == env.spec
        assert str(again) == str(env)
        assert cut_after(again) == limit
    assert env.spec != make(mode, env_id, **given).spec


def test_a_wrapped_environment_is_made_again_from_its_spec() -> None:
    env = gymnasium.wrappers.FlattenObservation(SHORT.make(actions="turns"))
    assert env.spec is not None
    for spec in copies(env.spec):
        assert spec == env.spec
        again = gymnasium.make(spec)
        assert str(again) == str(env)
        assert again.observation_space == env.observation_space
        assert cut_after(again) == 7
    made = gymnasium.make(LEVEL_ID, level=SHORT, max_episode_steps=-1).spec
    assert made is not None
    assert cut_after(made.make()) is None
    assert cut_after(gymnasium.make(EnvSpec.from_json(made.to_json()))) is None


def test_the_registry_is_printed_without_reading_levels(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: Any, **__: Any) -> None:
        raise AssertionError("nobody asked for it")

    monkeypatch.setattr("babyrobot_levels.envs.specs.load", refuse)
    printed = gymnasium.pprint_registry(disable_print=True)
    assert printed is not None
    assert all(env_id in printed for env_id in registry if env_id.startswith("babyrobot/"))


# -- missing and foreign arguments -----------------------------------------------------------


@pytest.mark.parametrize("making", [gymnasium.make, gymnasium.make_vec])
@pytest.mark.parametrize(
    ("env_id", "example"),
    [(LEVEL_ID, f'make("{LEVEL_ID}", level="final-maze")'),
     (SUITE_ID, f'make("{SUITE_ID}", suite="small-mazes")')],
)  # fmt: skip
def test_a_missing_argument_is_named(making: Any, env_id: str, example: str) -> None:
    with pytest.raises(error.MissingArgument) as caught:
        making(env_id)
    assert example in str(caught.value)


@pytest.mark.parametrize("making", [gymnasium.make, gymnasium.make_vec])
@pytest.mark.parametrize(
    ("given", "told"),
    [
        ({"desc": ["SF", "FG"]}, "babyrobot import"),
        ({"map_name": "8x8"}, "babyrobot/frozen-lake-8x8-v0"),
        ({"is_slippery": False}, "`skid`.*babyrobot/frozen-lake-dry-v0"),
        ({"observations": "walls"}, "did you mean `observation`"),
        (
            {"battery": 1},
            "unexpected keyword argument 'battery'; accepted arguments: .*observation",
        ),
    ],
)
def test_habits_and_misspellings_are_told_what_to_do(
    making: Any, given: dict[str, Any], told: str
) -> None:
    for env_id, more in (
        ("babyrobot/frozen-lake-v0", {}),
        (LEVEL_ID, {}),
        (LEVEL_ID, {"level": "frozen-lake"}),
        (SUITE_ID, {"suite": "small-mazes"}),
    ):
        with pytest.raises(TypeError, match=told):
            making(env_id, **more, **given)


# -- frames of suites ------------------------------------------------------------------------


@pytest.mark.slow
def test_all_frames_of_a_suite_have_one_size() -> None:
    env: Any = gymnasium.make(SUITE_ID, suite="locked-mazes", render_mode="rgb_array")
    shape, sizes = env.render().shape, set()
    for index in (0, 1, 4):
        env.reset(options={"index": index})
        level = env.unwrapped.level
        frame, alone = env.render(), level.make(render_mode="rgb_array").render()
        assert frame.shape == shape
        height, width = alone.shape[:2]
        rest = frame.copy()
        rest[:height, :width] = 0
        assert not rest.any()
        assert frame[height - 1, : width - 1].any()
        sizes.add(level.size)
        env.unwrapped.show_info({"side_panel": "a panel", "bottom_panel": ["two", "lines"]})
        assert env.render().shape == shape
        env.unwrapped.clear_info()
    assert len(sizes) > 1
