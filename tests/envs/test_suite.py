"""`babyrobot/Suite-v0`: another level in each episode, in spaces that never change."""

from __future__ import annotations

import copy
import pickle
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium import spaces
from gymnasium.envs.registration import EnvSpec
from gymnasium.utils.env_checker import check_env
from support.combinations import combined
from support.playing import plain

import babyrobot_levels as brl
from babyrobot_levels.envs.observations import OBSERVATIONS
from babyrobot_levels.render.frames import FramePainter
from babyrobot_levels.render.situation import Mood, Pose
from babyrobot_levels.suites.suite import load_suite
from babyrobot_levels.text.emitter import emit

SUITE_ID = "babyrobot/Suite-v0"

FIELDS: dict[str, Any] = {
    "version": 1,
    "kind": "suite",
    "seed": 3,
    "count": 60,
    "size": {"min": [3, 4], "max": [7, 5]},
    "puddles": {"max": 2},
    "splits": {"train": 0.5, "test": 0.5},
}

LOCKED: dict[str, Any] = {
    "version": 1,
    "kind": "suite",
    "seed": 3,
    "count": 60,
    "size": {"min": [4, 4], "max": [5, 5]},
    "exit": "farthest",
    "keys": {"max": 2},
    "coins": {"max": 2},
    "guards": {"max": 1},
}

each_observation = pytest.mark.parametrize("observation", ["position", "image"])


def make(**arguments: Any) -> Any:
    return gymnasium.make(SUITE_ID, **{"suite": FIELDS, **arguments})


def test_spaces_are_those_of_the_largest_level() -> None:
    assert make().observation_space == spaces.MultiDiscrete([7, 5])
    assert make(observation="index").observation_space == spaces.Discrete(35)
    assert make(observation="walls").observation_space == spaces.MultiDiscrete([7, 5, 2, 2, 2, 2])
    image = make(observation="image", image_size=(50, 70), grayscale=True).observation_space
    assert image == spaces.Box(0, 255, (50, 70, 1), np.uint8)


@pytest.mark.slow
@combined(1, observation=OBSERVATIONS, actions=["all", "turns"])
def test_levels_with_different_things_share_a_space(observation: str, actions: str) -> None:
    env = make(suite=LOCKED, observation=observation, actions=actions)
    space, seen = env.observation_space, set()
    for seed in range(5):
        shown, info = env.reset(seed=seed)
        level = env.unwrapped.level
        seen.add(level.things().names)
        keys = [*info]
        for _ in range(10):
            assert shown in space
            # Whatever the level has, there is room for what any of the suite can have.
            assert [*info] == keys
            assert keys[3:] == ["held", "hit", "level_index"]
            assert info["held"].shape == (load_suite(LOCKED).most_items,)
            assert not info["held"][len(level.items) :].any()
            shown, *_, info = env.step(env.action_space.sample())
        assert env.observation_space == space
    assert len(seen) > 3


def test_gymnasiums_checker_is_content() -> None:
    check_env(make().unwrapped)


@pytest.mark.slow
def test_every_level_is_drawn_and_told() -> None:
    env, suite = make(split="test"), load_suite(FIELDS).split("test")
    _, info = env.reset(seed=1)
    seen = {info["level_index"]}
    for _ in range(250):
        _, info = env.reset()
        seen.add(info["level_index"])
        assert env.unwrapped.level_digest == env.unwrapped.level.digest
        assert env.unwrapped.level == suite[info["level_index"]]
    assert seen == set(range(30))


def test_a_level_can_be_asked_for() -> None:
    env = make()
    _, info = env.reset(options={"index": 7})
    assert info["level_index"] == 7
    assert env.unwrapped.level.digest == load_suite(FIELDS)[7].digest
    for wrong in (-1, 60, "7", 1.5):
        with pytest.raises(ValueError, match="must be a whole number from 0 to 59"):
            env.reset(options={"index": wrong})
    exit_ = load_suite(FIELDS)[8].exits[0]
    with pytest.raises(ValueError, match="the episode would be over"):
        env.reset(options={"index": 8, "start": exit_})
    with pytest.raises(ValueError, match="for levels that say"):
        env.reset(options={"index": 8, "maze_seed": 1})
    assert env.unwrapped.level.digest == load_suite(FIELDS)[7].digest, "a refused reset"
    assert env.step(brl.Action.STAY)[4]["level_index"] == 7


def test_a_level_is_played_as_it_is_alone() -> None:
    env = make(observation="walls")
    for number in range(4):
        alone = load_suite(FIELDS)[number].make(observation="walls")
        env.reset(seed=9)
        alone.reset(seed=9)
        env.unwrapped.np_random.bit_generator.state = alone.unwrapped.np_random.bit_generator.state
        env.reset(options={"index": number})
        alone.reset()
        rng = np.random.default_rng(0)
        for _ in range(40):
            action = int(rng.integers(5))
            mine, theirs = env.step(action), alone.step(action)
            assert mine[0].tolist() == theirs[0].tolist()
            assert mine[1:4] == theirs[1:4]
            assert mine[4]["action_mask"].tolist() == theirs[4]["action_mask"].tolist()
            if mine[2]:
                break


@each_observation
def test_copies_and_pickles_go_on_alike(observation: str) -> None:
    env = make(observation=observation).unwrapped
    env.reset(seed=2)
    twins = [copy.deepcopy(env), pickle.loads(pickle.dumps(env))]
    told = [[plain(each.reset()[0]) for _ in range(5)] for each in (env, *twins)]
    assert told[0] == told[1] == told[2]


@pytest.mark.parametrize("making", [gymnasium.make, gymnasium.make_vec])
def test_what_the_json_says_is_what_is_played(making: Any) -> None:
    suite = load_suite(FIELDS)
    for played in (suite, suite.split("train"), suite.split("test")):
        again = making(EnvSpec.from_json(making(SUITE_ID, suite=played).spec.to_json()))
        again.reset(options={"index": 1})
        assert digest_of(again) == played[1].digest
    for part in (suite[::-1], suite[2:5], suite.split("train")[1:]):
        env = making(SUITE_ID, suite=part)
        assert env.spec.kwargs["suite"] == part
        env.reset(options={"index": 1})
        assert digest_of(env) == part[1].digest


def digest_of(env: Any) -> str:
    """Return the digest of the level of an environment, or of the only one of a vector one."""
    if isinstance(env, gymnasium.vector.VectorEnv):
        env = env.unwrapped
        (digest,) = env.get_attr("level_digest")
        return str(digest)
    return str(env.unwrapped.level_digest)


@pytest.mark.parametrize("make", [gymnasium.make, gymnasium.make_vec])
def test_the_spec_as_json_has_the_theme_that_stands_beside_the_suite(
    make: Any, tmp_path: Path
) -> None:
    (tmp_path / "themes").mkdir()
    (tmp_path / "themes" / "sea.yaml").write_text("colors: {base: '#cceeff'}\n", "utf-8")
    (tmp_path / "seas.yaml").write_text(emit({**FIELDS, "theme": "sea"}), "utf-8")
    env = make(SUITE_ID, suite=tmp_path / "seas.yaml", render_mode="rgb_array")
    again = make(EnvSpec.from_json(env.spec.to_json()))
    for each in (env, again):
        each.reset(seed=6)
    assert np.array_equal(env.render(), again.render())


def test_a_part_of_a_suite_is_not_written_as_the_whole() -> None:
    for make in (gymnasium.make, gymnasium.make_vec):
        env: Any = make(SUITE_ID, suite=load_suite(FIELDS)[3:8])
        with pytest.raises(TypeError, match="Suite is not JSON"):
            env.spec.to_json()


@pytest.mark.slow
def test_he_cheers_at_the_exit_of_every_level() -> None:
    env = make(suite={**FIELDS, "exit": "random"}, render_mode="rgb_array")
    ends = set()
    for number in range(6):
        (x, y), _ = env.reset(seed=1, options={"index": number})
        level, over = env.unwrapped.level, False
        best = brl.solve(level).policy
        while not over:
            (x, y), _, over, *_ = env.step(best[y, x])
        ends.add((x, y))
        cheering = FramePainter(level).frame(y * level.size[0] + x, Pose(mood=Mood.CHEER))
        height, width = cheering.shape[:2]
        assert np.array_equal(env.render()[:height, :width], cheering)
    assert len(ends) > 3


@pytest.mark.slow
def test_what_is_written_stays_in_levels_of_the_same_size() -> None:
    sizes = [level.size for level in load_suite(FIELDS)]
    same = sizes.index(sizes[0], 1)
    other = next(number for number, size in enumerate(sizes) if size != sizes[0])
    width, height = sizes[0]
    svg, clean, canvas = (make(render_mode=mode) for mode in ("svg", "svg", "canvas"))
    for env in (svg, canvas):
        env.reset(options={"index": 0})
        env.unwrapped.show_info({"values": np.zeros((height, width)), "side_panel": "zeros"})
        env.render()
    for number, is_written in ((same, True), (other, False), (same, False)):
        for env in (svg, clean, canvas):
            env.reset(options={"index": number})
        assert ("zeros" in svg.render()) is is_written
        assert (svg.render() == clean.render()) is not is_written
        assert ("zeros" in canvas.unwrapped._repr_mimebundle_()["image/svg+xml"]) is is_written


def test_what_cannot_be() -> None:
    with pytest.raises(ValueError, match="there is no split"):
        make(split="dev")
    with pytest.raises(ValueError, match="no levels"):
        make(suite=load_suite(FIELDS)[5:5])
    with pytest.raises(ValueError, match="observation must be one of"):
        make(observation="smell")
    with pytest.raises(brl.SuiteNotFoundError):
        make(suite="no-such-suite")
