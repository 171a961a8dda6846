"""What holds of every vector environment, whatever it observes and however it begins anew."""

from __future__ import annotations

import copy
import pickle
import random
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium import error
from gymnasium.envs.registration import EnvSpec
from gymnasium.utils.env_checker import data_equivalence
from gymnasium.vector import AsyncVectorEnv, AutoresetMode, SyncVectorEnv
from gymnasium.vector.utils import batch_space
from support.combinations import combined
from support.fleets import (
    ENGINES,
    MODES,
    SEEDS,
    assert_same_from_here,
    assert_same_walks,
    copied,
    kinds_of,
    same,
    single,
    walked,
)
from support.playing import GALLERY, each_level_and, level_named

import babyrobot_levels as brl
from babyrobot_levels.envs.observations import OBSERVATIONS
from babyrobot_levels.envs.spaces import ACTION_SETS
from babyrobot_levels.envs.vector.env import LevelVectorEnv

LEVEL_ID = "babyrobot/Level-v0"
SIZE = 6


def make(name: str = "final-maze", **given: Any) -> LevelVectorEnv:
    """Return the environment as users make it."""
    envs = gymnasium.make_vec(LEVEL_ID, num_envs=SIZE, level=level_named(name), **given)
    assert isinstance(envs, LevelVectorEnv)
    return envs


# -- making ----------------------------------------------------------------------------------


def test_ids_of_the_gallery_make_one() -> None:
    for name in ("final-maze", "random-maze", "first-key"):
        envs = gymnasium.make_vec(f"babyrobot/{name}-v0", num_envs=3)
        assert type(envs) is LevelVectorEnv, name
        observations, _ = envs.reset(seed=1)
        assert observations in envs.observation_space, name
        single = gymnasium.make(f"babyrobot/{name}-v0")
        assert envs.single_observation_space == single.observation_space, name
        assert envs.single_action_space == single.action_space, name
        envs.close()


@each_level_and(("observation", [*OBSERVATIONS]), ("actions", [*ACTION_SETS]))
def test_spaces_are_those_of_single_environments(name: str, observation: str, actions: str) -> None:
    given = {"observation": observation, "actions": actions}
    envs = make(name, **given)
    single = level_named(name).make(**given)
    assert envs.single_observation_space == single.observation_space
    assert envs.single_action_space == single.action_space
    assert envs.observation_space == batch_space(single.observation_space, SIZE)
    assert envs.action_space == batch_space(single.action_space, SIZE)
    assert batch_space(single.action_space, SIZE) == envs.action_space
    for told in walked(envs, 12):
        observations = told[0] if len(told) == 2 else told[1]
        assert observations in envs.observation_space


@each_level_and(("engine", ENGINES), ("copy", [True, False]), ("actions", ["valid", "turns"]))
def test_infos_are_the_same_contiguous_numbers_at_reset_and_step(
    name: str, engine: str, copy: bool, actions: str
) -> None:
    level = level_named(name).replace(max_steps=9)
    kinds: dict[str, Any] = {"action_mask": ("int8", (3 if actions == "turns" else 5,))}
    kinds |= {"target_reached": ("bool", ()), "skidded": ("bool", ())}
    kinds |= {"held": ("bool", (len(level.items),))} if level.items else {}
    kinds |= {"hit": ("bool", ())} if level.movers else {}
    kinds |= {"maze_seed": ("int64", ())} if level.has_random_maze else {}
    # Odd numbers of environments, so that nothing is aligned by chance.
    for mode, size in zip(MODES, (1, 7, 301), strict=True):
        given: dict[str, Any] = {"autoreset_mode": mode, "actions": actions}
        given |= {"engine": engine, "copy": copy}
        envs = LevelVectorEnv(level, num_envs=size, **given)
        if level.has_random_maze and size > 7:
            continue
        ends = 0
        for told in walked(envs, 20):
            assert kinds_of(told[-1], size) == kinds
            if "final_info" in told[-1]:
                assert kinds_of(told[-1]["final_info"], size) == kinds
                ends += 1
        assert ends > 0 or mode is not AutoresetMode.SAME_STEP


@pytest.mark.slow
@each_level_and(("mode", MODES), ("engine", ENGINES))
def test_each_environment_is_a_single_one(name: str, mode: AutoresetMode, engine: str) -> None:
    level = level_named(name).replace(max_steps=7)
    envs = LevelVectorEnv(
        level, num_envs=len(SEEDS), engine=engine, autoreset_mode=mode, observation="index"
    )
    assert_same_walks(envs, single([level], observation="index"), SEEDS, 30)


def test_the_spec_as_json_makes_the_same_game() -> None:
    for given in (
        {"level": level_named("all at once")},
        {"levels": [level_named("all at once"), GALLERY["maze"]], "draw_levels": True},
        {"level": "final-maze", "autoreset_mode": AutoresetMode.SAME_STEP, "actions": "moves"},
    ):
        envs = gymnasium.make_vec(LEVEL_ID, num_envs=4, **given)
        assert envs.spec is not None
        again = gymnasium.make_vec(EnvSpec.from_json(envs.spec.to_json()))
        assert isinstance(envs, LevelVectorEnv)
        assert isinstance(again, LevelVectorEnv)
        assert same(walked(envs, 20), walked(again, 20))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({}, "give either `level` or `levels`"),
        ({"level": "maze", "levels": ["maze"]}, "give either `level` or `levels`"),
        ({"levels": "maze"}, "must be a list of levels or a suite, not 'maze'"),
        ({"levels": []}, "at least one level"),
        ({"level": "maze", "num_envs": 0}, "num_envs must be a whole number, at least 1, not 0"),
        ({"level": "maze", "num_envs": "4"}, "num_envs must be"),
        ({"level": "maze", "observation": "indx"}, "index"),
        ({"level": "maze", "actions": "move"}, "moves"),
        ({"level": "maze", "render_mode": "human"}, "rgb_array"),
        ({"level": "maze", "engine": "numbas"}, "engine must be"),
        ({"level": "maze", "grayscale": True}, "observation='image'"),
        ({"level": "maze", "max_episode_steps": 0}, "at least 1, or -1"),
        ({"level": "maze", "autoreset_mode": "Never"}, "'NextStep'.*not 'Never'"),
    ],
)
def test_what_cannot_be_made(arguments: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        LevelVectorEnv(**arguments)


# -- playing ---------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", [[1], [1, 2, 3], [1, -2], [1, 2.5], [None, -1], [[1, 2]]])
def test_what_is_no_seed(seed: Any) -> None:
    envs = LevelVectorEnv("maze", num_envs=2)
    with pytest.raises(ValueError, match="a list of 2 such numbers"):
        envs.reset(seed=seed)


def test_a_reset_without_a_seed_goes_on_with_the_generator() -> None:
    envs = make("four-corners", observation="index")
    envs.reset(seed=1)
    generator = envs.np_random
    assert len({tuple(envs.reset()[0].tolist()) for _ in range(30)}) > 5
    assert envs.np_random is generator


def test_a_start_that_is_asked_for() -> None:
    envs = LevelVectorEnv(levels=["final-maze", "frozen-lake"], num_envs=4)
    observations, _ = envs.reset(options={"start": [2, 1]})
    assert observations.tolist() == [[2, 1]] * 4
    with pytest.raises(ValueError, match=r"\[7, 1\] is off the grid"):
        envs.reset(options={"start": [7, 1]})
    assert envs.call("action_masks")[0].tolist() == envs.action_masks()[0].tolist()


def test_some_are_reset_and_the_others_stay() -> None:
    envs = make("final-maze", autoreset_mode="Disabled")
    envs.reset(seed=1)
    before, *_ = envs.step(np.full(SIZE, brl.Action.EAST))
    assert before[:, 0].any()
    mask = np.zeros(SIZE, bool)
    mask[[1, 4]] = True
    options = {"reset_mask": mask}
    after, info = envs.reset(options=options)
    assert options == {"reset_mask": mask}
    assert after[mask].tolist() == [[0, 0]] * 2
    assert after[~mask].tolist() == before[~mask].tolist()
    assert info["_action_mask"].tolist() == mask.tolist()
    assert not info["action_mask"][~mask].any()


@pytest.mark.parametrize(
    ("mask", "kind"),
    [
        ([True] * SIZE, TypeError),
        (np.ones(SIZE, int), TypeError),
        (np.ones(SIZE + 1, bool), ValueError),
        (np.zeros(SIZE, bool), ValueError),
    ],
)
def test_what_is_no_reset_mask(mask: Any, kind: type[Exception]) -> None:
    envs = make()
    envs.reset(seed=1)
    with pytest.raises(kind, match="reset_mask"):
        envs.reset(options={"reset_mask": mask})


def test_nothing_can_be_done_before_the_first_reset() -> None:
    envs = make()
    some = np.zeros(SIZE, bool)
    some[0] = True
    for call in (
        lambda: envs.step(np.zeros(SIZE, int)),
        envs.action_masks,
        lambda: envs.reset(options={"reset_mask": some}),
    ):
        with pytest.raises(error.ResetNeeded, match="reset"):
            call()
    # Where nobody stands yet, any action may be sampled.
    drawn = np.array([envs.action_space.sample() for _ in range(100)])
    assert set(drawn.ravel().tolist()) == set(range(5))


def test_without_autoreset_nobody_acts_when_it_is_over() -> None:
    envs = LevelVectorEnv("maze", num_envs=3, autoreset_mode="Disabled", max_episode_steps=1)
    envs.reset(seed=1)
    *_, truncated, _ = envs.step([0, 0, 0])
    assert truncated.all()
    with pytest.raises(error.ResetNeeded, match=r"environment 0 is over: .*reset_mask"):
        envs.step([0, 0, 0])


@pytest.mark.parametrize("engine", ENGINES)
def test_invalid_actions_are_refused_and_change_nothing(engine: str) -> None:
    envs = LevelVectorEnv("ice-rink", num_envs=2, engine=engine, actions="moves")
    envs.reset(seed=1)
    before = copy.deepcopy(envs)
    wrong: tuple[Any, ...] = (
        [0],
        [0, 1, 2],
        [[0, 1]],
        [[0], [0, 1]],
        0,
        [0.0, 1.0],
        [True, False],
        ["n", "e"],
        None,
        [0, 4],
        [-1, 0],
        np.array([0, 2**64 - 1], np.uint64),
    )
    for actions in wrong:
        with pytest.raises(error.InvalidAction, match="actions"):
            envs.step(actions)
    with pytest.raises(error.InvalidAction, match=r"4, the action of environment 1, .* 0 to 3"):
        envs.step([0, 4])
    assert same(envs.step([1, 2]), before.step([1, 2]))


@pytest.mark.parametrize("count", [3, 300])
@pytest.mark.parametrize("engine", ENGINES)
def test_numbers_of_all_sorts_are_actions(engine: str, count: int) -> None:
    wanted = np.resize([2, 3, 2], count)
    read_only = wanted.copy()
    read_only.flags.writeable = False
    told = []
    for actions in (
        wanted.tolist(),
        tuple(wanted.tolist()),
        [brl.Action(action) for action in wanted],
        wanted.astype(np.uint8),
        wanted.astype(">i8"),
        wanted.repeat(2)[::2],
        read_only,
    ):
        envs = LevelVectorEnv("ice-rink", num_envs=count, engine=engine)
        envs.reset(seed=1)
        told.append(envs.step(actions))
    assert all(same(each, told[0]) for each in told)


@combined(1, observation=[*OBSERVATIONS], mode=MODES, engine=ENGINES)
def test_what_is_returned_belongs_to_the_user(
    observation: str, mode: AutoresetMode, engine: str
) -> None:
    given = {"observation": observation, "autoreset_mode": mode, "engine": engine}
    ours, theirs = make("all at once", **given), make("all at once", **given)
    told = walked(ours, 40)
    spoiled = []
    step, reset = theirs.step, theirs.reset

    def spoil(result: Any) -> Any:
        spoiled.append(copied(result))
        _overwrite(result)
        return spoiled[-1]

    theirs.step = lambda actions: spoil(step(actions))  # type: ignore[method-assign]
    theirs.reset = lambda **kwargs: spoil(reset(**kwargs))  # type: ignore[method-assign]
    assert same(walked(theirs, 40), told)


def _overwrite(value: Any) -> None:
    if isinstance(value, dict | tuple):
        for inner in value.values() if isinstance(value, dict) else value:
            _overwrite(inner)
    elif isinstance(value, np.ndarray) and value.dtype != object:
        value[...] = 1 - value.astype(np.int64)


@combined(1, observation=OBSERVATIONS, engine=ENGINES)
def test_without_copies_it_is_always_the_same_arrays(observation: str, engine: str) -> None:
    envs = make(observation=observation, copy=False, engine=engine)
    copies = make(observation=observation, engine=engine)
    envs.reset(seed=1)
    copies.reset(seed=1)
    first = envs.step(np.full(SIZE, 2))
    kept = copies.step(np.full(SIZE, 2))
    assert same(first, kept)
    second = envs.step(np.full(SIZE, 4))
    copies.step(np.full(SIZE, 4))
    for one, other in zip(first[:4], second[:4], strict=True):
        assert np.shares_memory(one, other)
    assert np.shares_memory(first[4]["action_mask"], second[4]["action_mask"])
    assert not np.array_equal(first[0], kept[0])


@pytest.mark.slow
@combined(1, mode=MODES, engine=ENGINES, observation=["index", "image"])
def test_copies_go_on_with_the_same_episodes(
    observation: str, engine: str, mode: AutoresetMode
) -> None:
    envs = LevelVectorEnv(
        levels=["frozen-lake", "ice-rink"],
        num_envs=4,
        observation=observation,
        autoreset_mode=mode,
        engine=engine,
        max_episode_steps=20,
        draw_levels=True,
        render_mode="rgb_array",
    )
    unbegun = pickle.loads(pickle.dumps(envs))
    told = walked(envs, 10, 3)
    envs.render()
    for again in (copy.deepcopy(envs), pickle.loads(pickle.dumps(envs))):
        one = copy.deepcopy(envs)
        assert_same_from_here(one, again, 25)
        assert np.array_equal(one.render(), again.render())
    assert same(walked(unbegun, 10, 3), told)


@pytest.mark.parametrize("engine", ENGINES)
def test_copies_of_what_writes_over_its_arrays_do_so_too(engine: str) -> None:
    envs = make("all at once", copy=False, engine=engine)
    walked(envs, 10, 3)
    copies = [copy.deepcopy(envs), pickle.loads(pickle.dumps(envs))]
    for action in (2, 3, 2):
        told = envs.step(np.full(SIZE, action))
        for again in copies:
            assert same(again.step(np.full(SIZE, action)), told)
    for again in copies:
        first, second = (again.step(np.full(SIZE, 1))[0] for _ in range(2))
        assert np.shares_memory(first, second)
        assert not np.shares_memory(first, told[0])


def test_global_generators_are_left_alone() -> None:
    def states() -> list[Any]:
        _, keys, position, *_ = np.random.get_state(legacy=True)
        return [random.getstate(), np.asarray(keys).tolist(), position]

    before = states()
    walked(make("all at once"), 20)
    brl.rollout("ice-rink", num_envs=3, num_steps=10)
    assert states() == before


# -- several levels --------------------------------------------------------------------------


def test_the_smallest_of_levels_can_be_seen() -> None:
    levels = [{"version": 1, "size": size} for size in ([2, 2], [40, 2], [2, 40])]
    envs = LevelVectorEnv(levels=levels, observation="image", image_size=(6, 6))
    for picture in envs.reset(seed=1)[0]:
        assert picture[0, 0].any()


# -- the action space ------------------------------------------------------------------------


@pytest.mark.parametrize("engine", ENGINES)
def test_sampled_actions_are_all_those_that_are_possible(engine: str) -> None:
    envs = LevelVectorEnv("final-maze", num_envs=500, engine=engine)
    envs.reset(seed=1)
    envs.action_space.seed(1)
    for _ in range(20):
        *_, info = envs.step(envs.action_space.sample())
    seen = np.zeros((500, 5), np.int8)
    for _ in range(200):
        seen[np.arange(500), envs.action_space.sample()] = 1
    assert seen.tolist() == info["action_mask"].tolist()
    masked = np.zeros_like(seen)
    for _ in range(200):
        masked[np.arange(500), envs.action_space.sample(info["action_mask"])] = 1
    assert masked.tolist() == seen.tolist()


@pytest.mark.parametrize("actions", ACTION_SETS)
def test_masks_and_probabilities_that_are_given(actions: str) -> None:
    envs: Any = make(actions=actions)
    count = envs.action_space.nvec[0]
    mask = np.zeros((SIZE, count), np.int8)
    mask[np.arange(SIZE), np.arange(SIZE) % count] = 1
    wanted = (np.arange(SIZE) % count).tolist()
    for _ in range(2):
        assert envs.action_space.sample(mask).tolist() == wanted
        assert envs.action_space.sample(tuple(mask)).tolist() == wanted
        weights = tuple(mask.astype(np.float64))
        assert envs.action_space.sample(probability=weights).tolist() == wanted
        envs.reset(seed=1)
    assert envs.action_space.sample(mask * 0).tolist() == [0] * SIZE
    with pytest.raises(ValueError, match=rf"\[{SIZE}, {count}\], not \[1, {count}\]"):
        envs.action_space.sample(mask[:1])
    if not actions.startswith("valid"):
        drawn = {tuple(envs.action_space.sample().tolist()) for _ in range(200)}
        assert {action for sample in drawn for action in sample} == set(range(count))


# -- being used ------------------------------------------------------------------------------


def test_attributes() -> None:
    envs = make("final-maze", render_mode="rgb_array")
    envs.reset(seed=1)
    assert envs.get_attr("level") == (level_named("final-maze"),) * SIZE
    assert envs.get_attr("render_mode") == ("rgb_array",) * SIZE
    masks = envs.call("action_masks")
    assert len(masks) == SIZE
    assert masks[0].tolist() == envs.action_masks()[0].tolist()
    with pytest.raises(AttributeError, match="battery"):
        envs.get_attr("battery")
    assert repr(envs) == f"LevelVectorEnv({LEVEL_ID}, num_envs={SIZE})"


@pytest.mark.parametrize(("num_envs", "tiles"), [(1, (1, 1)), (1000, (4, 4))])
def test_a_montage_shows_the_first_sixteen(num_envs: int, tiles: tuple[int, int]) -> None:
    envs = LevelVectorEnv("frozen-lake", num_envs=num_envs, render_mode="rgb_array")
    before = envs.montage()
    assert before.dtype == np.uint8
    rows, columns = tiles
    assert before.shape[0] == before.shape[1]
    assert max(before.shape) <= 1024 + 12
    envs.reset(seed=1)
    assert np.array_equal(envs.montage(), before)
    actions = np.zeros(num_envs, int)
    actions[min(15, num_envs - 1)] = brl.Action.SOUTH
    while not envs._envs.state.any():
        envs.step(actions)
    changed = np.argwhere((envs.montage() != before).any(axis=2))
    height, width = before.shape[0] / rows, before.shape[1] / columns
    assert set((changed[:, 0] // height).tolist()) == {rows - 1}
    assert set((changed[:, 1] // width).tolist()) == {columns - 1}
    if num_envs > 16:
        shown = envs.montage()
        actions[:] = 0
        actions[16:] = brl.Action.SOUTH
        envs.step(actions)
        assert np.array_equal(envs.montage(), shown)


def test_a_montage_of_several_levels() -> None:
    levels = [{"version": 1, "size": size} for size in ([1, 3], [4, 1])]
    envs = LevelVectorEnv(levels=levels, num_envs=4, render_mode="rgb_array")
    envs.reset(seed=1)
    picture = envs.montage()
    alone = [LevelVectorEnv(level, render_mode="rgb_array").montage() for level in levels]
    # Each tile has room for the largest, 4 cells wide and 3 high, and is white around its level.
    assert picture.shape == (2 * 3 * 64 + 4, 2 * 4 * 64 + 4, 3)
    for number in range(4):
        own = alone[number % 2]
        row, column = divmod(number, 2)
        tile = picture[row * (3 * 64 + 4) :, column * (4 * 64 + 4) :][: 3 * 64, : 4 * 64]
        assert np.array_equal(tile[: own.shape[0], : own.shape[1]], own)
        assert (tile[own.shape[0] :] == 255).all()
        assert (tile[:, own.shape[1] :] == 255).all()


@pytest.mark.slow
def test_there_is_a_frame_of_each_environment() -> None:
    levels = [level_named(name) for name in ("frozen-lake", "cliff-walking", "door-key")]
    envs = LevelVectorEnv(levels=levels, num_envs=20, render_mode="rgb_array", actions="all")
    before = envs.render()
    assert isinstance(before, tuple)
    assert {(frame.dtype, frame.shape) for frame in before} == {
        (np.dtype(np.uint8), before[0].shape)
    }
    # Of the largest width and height, with a row for what is held.
    columns, rows = 12, max(level.size[1] + bool(level.items) for level in levels)
    assert before[0].shape == (rows * 64, columns * 64, 3)
    for frame, level in zip(before, levels, strict=False):
        (alone,) = LevelVectorEnv(level, render_mode="rgb_array").render()
        height, width, _ = alone.shape
        assert np.array_equal(frame[:height, :width], alone)
        assert not frame[height:].any()
        assert not frame[:, width:].any()
    envs.reset(seed=1)
    before, states = envs.render(), envs._envs.state.copy()
    envs.step(np.arange(20) % 5)
    changed = [not np.array_equal(*frames) for frames in zip(before, envs.render(), strict=True)]
    assert changed == (envs._envs.state != states).tolist()
    assert {*changed} == {True, False}


def test_without_a_mode_there_is_no_picture() -> None:
    for picture in (make().render, make().montage):
        with pytest.warns(UserWarning, match="render_mode='rgb_array'"):
            assert picture() is None


@pytest.mark.parametrize(
    ("size", "num_envs", "shape"),
    [
        # All tiles beside one another, or below: the longer side is the shortest that there can be.
        ((2, 12), 4, (12 * 64, 4 * 2 * 64 + 3 * 4)),
        ((12, 2), 4, (4 * 2 * 64 + 3 * 4, 12 * 64)),
        ((4, 4), 5, (3 * 4 * 64 + 2 * 4, 2 * 4 * 64 + 4)),
        # Cells of levels that are too large have a pixel each.
        ((520, 65), 16, (16 * 65 + 15 * 4, 520)),
    ],
)
def test_the_size_of_a_montage(
    size: tuple[int, int], num_envs: int, shape: tuple[int, int]
) -> None:
    level = {"version": 1, "size": size}
    envs = LevelVectorEnv(level, num_envs=num_envs, render_mode="rgb_array")
    assert envs.montage().shape == (*shape, 3)


def test_it_can_be_closed_twice() -> None:
    envs = make(render_mode="rgb_array")
    envs.reset(seed=1)
    envs.render()
    envs.close()
    assert envs.closed
    envs.close()


def test_attributes_that_can_be_set() -> None:
    envs = make()
    envs.set_attr("render_mode", "rgb_array")
    assert len(envs.render()) == SIZE
    envs.set_attr("render_mode", [None] * SIZE)
    assert envs.render_mode is None
    generator = np.random.default_rng(1)
    envs.set_attr("np_random", generator)
    assert envs.np_random is generator
    for name, value, kind, message in (
        ("level", "maze", AttributeError, "'level' cannot be set, only np_random and render_mode"),
        ("battery", 1, AttributeError, "make another LevelVectorEnv"),
        ("render_mode", "human", ValueError, "rgb_array"),
        ("render_mode", ["rgb_array"] * 2, ValueError, "one value, for all of them"),
        ("render_mode", [None, *["rgb_array"] * (SIZE - 1)], ValueError, "one value, for all"),
    ):
        with pytest.raises(kind, match=message):
            envs.set_attr(name, value)


@combined(1, observation=OBSERVATIONS, engine=ENGINES)
def test_nothing_that_is_returned_is_shared_between_steps(engine: str, observation: str) -> None:
    envs = make("final-maze", engine=engine, observation=observation)
    envs.reset(seed=1)
    told = [envs.step(np.full(SIZE, 2)) for _ in range(2)]
    first, second = ([*each[:4], *each[4].values()] for each in told)
    assert not any(np.shares_memory(one, other) for one in first for other in second)
    # Of one step, only what is said of the same robots under two names is one array.
    for number, one in enumerate(first[:4]):
        assert not any(np.shares_memory(one, other) for other in first[number + 1 :])


@pytest.mark.slow
def test_processes_do_as_one_process_does() -> None:
    # The prefix imports the package in a process of its own.
    env_id = "babyrobot_levels:babyrobot/frozen-lake-v0"
    make_one = [lambda: gymnasium.make(env_id, observation=("position", "walls"))] * 2
    one, other = SyncVectorEnv(make_one), AsyncVectorEnv(make_one, context="spawn")
    assert other.observation_space == one.observation_space
    assert data_equivalence(other.reset(seed=0), one.reset(seed=0))
    for action in [2, 3] * 10:
        assert data_equivalence(other.step([action] * 2), one.step([action] * 2))
    other.close()
