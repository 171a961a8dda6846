"""Levels that are made when episodes begin: those of suites, and mazes that grow each time."""

from __future__ import annotations

import copy
import gc
import pickle
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium import error
from gymnasium.vector import AutoresetMode
from gymnasium.vector.utils import batch_space
from hypothesis import given
from hypothesis import strategies as st
from support.combinations import combined, selected
from support.fleets import ENGINES, MODES, assert_same_from_here, kinds_of, levels, same, walked

import babyrobot_levels as brl
from babyrobot_levels.envs.engine.tables import (
    ALWAYS,
    Room,
    build_tables,
    empty_tables,
    needed,
    part_of,
    write_part,
)
from babyrobot_levels.envs.observations import OBSERVATIONS
from babyrobot_levels.envs.spaces import ACTION_SETS
from babyrobot_levels.envs.vector import levels as level_slots
from babyrobot_levels.envs.vector.env import LevelVectorEnv, SuiteVectorEnv
from babyrobot_levels.library.level import Level
from babyrobot_levels.suites.suite import Suite, load_suite

SUITE_ID = "babyrobot/Suite-v0"
SIZE = 5

DRY: dict[str, Any] = {
    "version": 1,
    "kind": "suite",
    "seed": 3,
    "count": 60,
    "size": {"min": [3, 3], "max": [5, 4]},
    "maze": {"loops": {"max": 1}},
    "start": "random",
    "splits": {"train": 0.5, "test": 0.5},
    "max_steps": 25,
}
WET: dict[str, Any] = {**DRY, "puddles": {"max": 4}}
GROWS: dict[str, Any] = {
    "version": 1,
    "size": [4, 3],
    "maze": {"seed": "random", "loops": 0.5},
    "max_steps": 25,
}
CORNERED: dict[str, Any] = {
    **GROWS,
    "start": [[0, 0], [3, 0], [0, 2]],
    "skid": {"probability": 0.3},
}

FAMILIES: dict[str, dict[str, Any]] = {
    "dry": {"suite": DRY},
    "wet": {"suite": WET},
    "mazes": {"level": GROWS},
    "cornered": {"level": CORNERED},
}

each_engine = pytest.mark.parametrize("engine", ENGINES)


def make(family: str, num_envs: int = SIZE, **given: Any) -> LevelVectorEnv:
    """Return the environment as users make it."""
    told = FAMILIES[family]
    env_id = SUITE_ID if "suite" in told else "babyrobot/Level-v0"
    envs = gymnasium.make_vec(env_id, num_envs=num_envs, **{**told, **given})
    assert isinstance(envs, LevelVectorEnv)
    return envs


def make_single(family: str, **given: Any) -> gymnasium.Env[Any, Any]:
    """Return the environment of one robot."""
    told = FAMILIES[family]
    return gymnasium.make(SUITE_ID if "suite" in told else "babyrobot/Level-v0", **told, **given)


def word_of(family: str) -> tuple[str, str]:
    """Return what numbers of levels are called in infos, and in options."""
    return ("level_index", "index") if "suite" in FAMILIES[family] else ("maze_seed", "maze_seed")


# -- making ----------------------------------------------------------------------------------


def test_the_ids_make_them() -> None:
    suite = gymnasium.make_vec(SUITE_ID, num_envs=3, suite="small-mazes", split="train")
    assert isinstance(suite, SuiteVectorEnv)
    assert suite.suite == load_suite("small-mazes").split("train")
    assert suite.levels is suite.suite
    mazes = gymnasium.make_vec("babyrobot/random-maze-v0", num_envs=3)
    assert type(mazes) is LevelVectorEnv
    assert mazes.levels == (brl.load("random-maze"),)


@combined(1, family=FAMILIES, observation=OBSERVATIONS, actions=ACTION_SETS)
def test_spaces_are_those_of_single_environments_and_never_change(
    family: str, observation: str, actions: str
) -> None:
    given: dict[str, Any] = {"observation": observation, "actions": actions}
    envs, single = make(family, **given), make_single(family, **given)
    assert envs.single_observation_space == single.observation_space
    assert envs.single_action_space == single.action_space
    assert envs.observation_space == batch_space(single.observation_space, SIZE)
    for told in walked(envs, 30):
        observations = told[0] if len(told) == 2 else told[1]
        assert observations in envs.observation_space
    assert envs.single_observation_space == single.observation_space


def test_a_suite_is_a_list_of_levels_too() -> None:
    suite = load_suite(DRY)
    envs = LevelVectorEnv(levels=suite, num_envs=7)
    assert envs.levels == tuple(suite[:7])
    _, info = envs.reset(seed=1)
    assert info["level_index"].tolist() == list(range(7))
    assert envs.get_attr("level_digest") == tuple(level.digest for level in suite[:7])
    assert LevelVectorEnv(levels=suite[10:14]).num_envs == 4
    drawn = LevelVectorEnv(levels=suite[10:14], num_envs=200, draw_levels=True)
    _, info = drawn.reset(seed=1)
    assert set(info["level_index"]) == set(range(4))
    assert {level.digest for level in drawn.call("level")} == {each.digest for each in suite[10:14]}


def test_billions_of_levels_cost_no_more_than_those_that_are_played(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    made = made_levels(monkeypatch)
    envs = make("dry", suite={**DRY, "count": 10**9}, split="test")
    envs.reset(seed=1)
    assert len(made) <= SIZE + 2


def made_levels(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    """Return a list of what suites are asked for from now on."""
    made: list[Any] = []
    get = Suite.__getitem__

    def counted(suite: Suite, index: Any) -> Any:
        made.append(index)
        return get(suite, index)

    monkeypatch.setattr(Suite, "__getitem__", counted)
    return made


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"levels": load_suite(DRY)[5:5]}, "at least one level"),
        ({"levels": "small-mazes"}, "a list of levels or a suite, not 'small-mazes'"),
        ({"levels": [GROWS, "maze"]}, r"must be the only one.*draw_levels=True"),
    ],
)
def test_what_cannot_be_made(arguments: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        LevelVectorEnv(**arguments)


# -- playing ---------------------------------------------------------------------------------


class Shadows:
    """Single environments that play the levels which a vector one says it plays."""

    def __init__(self, family: str, **given: Any) -> None:
        self._envs = [make_single(family, **given) for _ in range(SIZE)]
        self._word, self._option = word_of(family)

    def begin(self, number: int, envs: LevelVectorEnv, info: dict[str, Any], shown: Any) -> None:
        """Begin in the level, and where, a vector environment has begun; compare what is shown."""
        assert info[f"_{self._word}"][number]
        level = envs.call("level")[number]
        state = int(envs._envs.state[number] - envs._tables.offset[envs._envs.level[number]])
        y, x = divmod(state, level.size[0])
        asked = {self._option: int(info[self._word][number]), "start": (x, y)}
        told, own = self._envs[number].reset(options=asked)
        assert (x, y) in level.starts
        assert np.array_equal(shown[number], told)
        assert own[self._word] == info[self._word][number]
        single: Any = self._envs[number].unwrapped
        assert envs.get_attr("level_digest")[number] == single.level_digest
        assert info["action_mask"][number].tolist() == own["action_mask"].tolist()

    def step(self, number: int, action: int, shown: Any, told: Any, info: dict[str, Any]) -> None:
        """Take an action, and compare what comes of it."""
        observation, *others, own = self._envs[number].step(action)
        assert np.array_equal(shown, observation)
        assert [each[number] for each in told] == others
        for key, value in own.items():
            assert np.array_equal(info[key][number], value), key


@pytest.mark.slow
@combined(1, family=["dry", "mazes"], observation=OBSERVATIONS, mode=MODES, engine=ENGINES)
def test_each_environment_plays_the_level_that_it_says(
    family: str, observation: str, mode: AutoresetMode, engine: str
) -> None:
    given: dict[str, Any] = {"observation": observation, "actions": "all"}
    envs: Any = make(family, autoreset_mode=mode, engine=engine, **given)
    shadows, rng = Shadows(family, **given), np.random.default_rng(2)
    shown, info = envs.reset(seed=7)
    over, played = np.zeros(SIZE, np.bool_), set()
    for number in range(SIZE):
        shadows.begin(number, envs, info, shown)
    for _ in range(60):
        if mode is AutoresetMode.DISABLED and over.any():
            shown, info = envs.reset(options={"reset_mask": over})
            for number in np.flatnonzero(over).tolist():
                shadows.begin(number, envs, info, shown)
            over[:] = False
        actions = rng.integers(0, 5, SIZE)
        shown, *told, info = envs.step(actions)
        ends = told[1] | told[2]
        played |= set(info[word_of(family)[0]].tolist())
        for number in range(SIZE):
            if over[number]:
                assert [each[number] for each in told] == [0, False, False]
                shadows.begin(number, envs, info, shown)
            elif mode is AutoresetMode.SAME_STEP and ends[number]:
                last, final = info["final_obs"][number], info["final_info"]
                shadows.step(number, actions[number], last, told, final)
                shadows.begin(number, envs, info, shown)
            else:
                shadows.step(number, actions[number], shown[number], told, info)
        over = ends & (mode is not AutoresetMode.SAME_STEP)
    assert len(played) > 2 * SIZE


@pytest.mark.slow
@combined(1, family=FAMILIES, mode=MODES)
def test_both_engines_walk_the_same_way(family: str, mode: AutoresetMode) -> None:
    given: dict[str, Any] = {"autoreset_mode": mode, "observation": "walls"}
    one, other = (walked(make(family, engine=engine, **given), 50, 4) for engine in ENGINES)
    assert same(one, other)
    without = walked(make(family, copy=False, **given), 50, 4)
    assert same(one, without)


@combined(1, family=FAMILIES, engine=ENGINES)
def test_what_was_played_before_has_no_influence(
    family: str, engine: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    envs = make(family, engine=engine)
    first = walked(envs, 40, 4)
    walked(envs, 80, 5)
    assert same(walked(envs, 40, 4), first)
    monkeypatch.setattr(level_slots, "KEPT_STATES", 1)
    assert same(walked(make(family, engine=engine), 40, 4), first)


@combined(1, family=["dry", "mazes"], engine=ENGINES)
def test_one_robot_walks_as_a_single_environment_with_its_seed(family: str, engine: str) -> None:
    envs, single = make(family, 1, engine=engine), make_single(family)
    shown, infos = envs.reset(seed=11)
    told, info = single.reset(seed=11)
    rng, word = np.random.default_rng(1), word_of(family)[0]
    for _ in range(100):
        assert np.array_equal(shown[0], told)
        if word in info:
            assert infos[word][0] == info[word]
        action = int(rng.integers(5))
        told, *others, info = single.step(action)
        shown, *ours, infos = envs.step([action])
        assert [each[0] for each in ours] == others
        assert infos["skidded"][0] == info["skidded"]
        if others[1] or others[2]:
            told, info = single.reset()
            shown, *_, infos = envs.step([0])


@combined(1, family=FAMILIES, mode=MODES[:2], engine=ENGINES)
def test_with_seeds_of_their_own_they_walk_as_single_environments(
    family: str, mode: AutoresetMode, engine: str
) -> None:
    envs = make(family, 3, engine=engine, autoreset_mode=mode)
    singles = [make_single(family) for _ in range(3)]
    seeds, rng, word = [5, 11, 2], np.random.default_rng(1), word_of(family)[0]
    shown, infos = envs.reset(seed=seeds)
    told = [single.reset(seed=seed) for single, seed in zip(singles, seeds, strict=True)]
    over = [False] * 3
    for _ in range(60):
        for number, (observation, info) in enumerate(told):
            assert np.array_equal(shown[number], observation)
            assert infos[word][number] == info.get(word, infos[word][number])
        actions = rng.integers(0, 5, 3).tolist()
        shown, *ours, infos = envs.step(actions)
        for number, single in enumerate(singles):
            if over[number]:
                told[number], over[number] = single.reset(), False
                continue
            observation, *others, info = single.step(actions[number])
            assert [each[number] for each in ours] == others
            told[number], over[number] = (observation, info), bool(others[1] or others[2])
            if over[number] and mode is AutoresetMode.SAME_STEP:
                told[number], over[number] = single.reset(), False


@pytest.mark.slow
def test_levels_are_drawn_evenly() -> None:
    envs = make("wet", 6000, split="test")
    _, info = envs.reset(seed=1)
    seen, counts = np.unique(info["level_index"], return_counts=True)
    assert seen.tolist() == list(range(30))
    assert counts.min() > 140
    mazes = make("mazes", 300)
    _, info = mazes.reset(seed=1)
    assert info["maze_seed"].dtype == np.int64
    assert len(set(info["maze_seed"])) == 300
    assert info["maze_seed"].mean() == pytest.approx(2**30, rel=0.1)


def test_a_level_can_be_asked_for() -> None:
    envs = make("dry")
    _, info = envs.reset(seed=1, options={"index": 7})
    assert info["level_index"].tolist() == [7] * SIZE
    assert envs.get_attr("level_digest") == (load_suite(DRY)[7].digest,) * SIZE
    _, info = envs.reset(options={"index": [4, 1, 4, 2, 59]})
    assert info["level_index"].tolist() == [4, 1, 4, 2, 59]
    mask = np.array([True, False, False, False, True])
    _, info = envs.reset(options={"index": 8, "reset_mask": mask})
    assert info["_level_index"].tolist() == mask.tolist()
    assert info["level_index"].tolist() == [8, 0, 0, 0, 8]
    assert [level.name for level in envs.call("level")] == [
        f"level-{number:05}" for number in (8, 1, 4, 2, 8)
    ]
    mazes = make("mazes")
    _, info = mazes.reset(options={"maze_seed": 2**40})
    assert info["maze_seed"].tolist() == [2**40] * SIZE
    assert mazes.get_attr("level") == (brl.load(GROWS).with_maze_seed(2**40),) * SIZE


@pytest.mark.parametrize(
    ("family", "options", "message"),
    [
        ("dry", {"index": 60}, r"options\['index'\] must be below 60, not 60"),
        ("dry", {"index": [0, 1, 2, 3, -1]}, "must be below 60"),
        ("dry", {"index": [1, 2]}, "a whole number, or 5 of them"),
        ("dry", {"index": "7"}, "a whole number, or 5 of them"),
        ("dry", {"maze_seed": 7}, "for levels that say `maze: {seed: random}`"),
        ("mazes", {"maze_seed": 1.5}, "a whole number, or 5 of them"),
        ("mazes", {"maze_seed": 2**63}, r"must be below 2\*\*63"),
        ("dry", {"index": 3, "start": [4, 3]}, "off the grid|would be over"),
        ("mazes", {"start": [3, 2]}, "would be over"),
    ],
)
def test_a_refused_reset_changes_no_level(
    family: str, options: dict[str, Any], message: str
) -> None:
    envs = make(family)
    envs.reset(seed=1)
    before, masks = envs.call("level"), envs.action_masks().tolist()
    with pytest.raises(ValueError, match=message):
        envs.reset(options=options)
    assert envs.call("level") == before
    assert envs.action_masks().tolist() == masks


def test_a_start_need_not_be_in_the_levels_of_those_that_stay() -> None:
    sizes = [level.size for level in load_suite(DRY)]
    wide, narrow = sizes.index((5, 3)), sizes.index((3, 3))
    envs = make("dry")
    before, _ = envs.reset(options={"index": [narrow] * 4 + [wide]})
    mask = np.array([False] * 4 + [True])
    observations, _ = envs.reset(options={"index": wide, "start": [4, 1], "reset_mask": mask})
    assert observations.tolist() == [*before[:4].tolist(), [4, 1]]


@each_engine
def test_invalid_actions_are_refused_and_change_nothing(engine: str) -> None:
    envs = make("wet", engine=engine, max_episode_steps=1)
    envs.reset(seed=1)
    envs.step(np.zeros(SIZE, int))
    before, levels = copy.deepcopy(envs), envs.call("level")
    with pytest.raises(error.InvalidAction, match="7, the action of environment 2, is not"):
        envs.step([0, 0, 7, 0, 0])
    assert envs.call("level") == levels
    assert same(envs.step(np.zeros(SIZE, int)), before.step(np.zeros(SIZE, int)))


@pytest.mark.slow
@selected([("wet", AutoresetMode.NEXT_STEP)], family=["wet", "cornered"], mode=MODES)
def test_copies_go_on_with_the_same_episodes(family: str, mode: AutoresetMode) -> None:
    envs = make(family, autoreset_mode=mode, observation="index", render_mode="rgb_array")
    unbegun = pickle.loads(pickle.dumps(envs))
    told = walked(envs, 20, 3)
    envs.render()
    for again in (copy.deepcopy(envs), pickle.loads(pickle.dumps(envs))):
        one = copy.deepcopy(envs)
        assert np.array_equal(one.render(), again.render())
        assert one.call("level") == again.call("level")
        assert same(one.action_masks(), again.action_masks())
        assert_same_from_here(one, again, 30)
    assert same(walked(unbegun, 20, 3), told)


@pytest.mark.parametrize("family", ["wet", "mazes"])
def test_sampled_actions_are_possible_where_the_robots_stand(family: str) -> None:
    envs = make(family, 50)
    _, info = envs.reset(seed=1)
    for _ in range(30):
        actions = envs.action_space.sample()
        assert info["action_mask"][np.arange(50), actions].all()
        assert np.array_equal(envs.action_masks(), info["action_mask"])
        *_, info = envs.step(actions)


@combined(1, family=FAMILIES, engine=ENGINES)
def test_infos_are_the_same_numbers_at_reset_and_step(family: str, engine: str) -> None:
    for mode in MODES:
        envs = make(family, engine=engine, autoreset_mode=mode)
        kinds = [kinds_of(told[-1], SIZE) for told in walked(envs, 30)]
        assert word_of(family)[0] in kinds[0]
        assert all(each == kinds[0] for each in kinds)
    alone = make_single(family)
    assert [*alone.reset(seed=1)[1]] == [*alone.step(0)[4]] == [*kinds[0]]


@pytest.mark.slow
@pytest.mark.parametrize("family", ["dry", "cornered"])
def test_the_picture_shows_the_levels_that_are_played(family: str) -> None:
    envs = make(family, 8, render_mode="rgb_array")
    before = envs.montage()
    envs.reset(seed=1)
    envs.action_space.seed(1)
    pictures = [before, envs.montage()]
    for _ in range(60):
        *_, terminated, truncated, _ = envs.step(envs.action_space.sample())
        if (terminated | truncated).any():
            envs.step(envs.action_space.sample())
            break
    starts = np.unique(envs._envs.state % envs._tables.offset[1])
    assert starts.size > 1
    pictures.append(envs.montage())
    assert len({picture.shape for picture in pictures}) == 1
    assert len({picture.tobytes() for picture in pictures}) == 3
    if "level" in FAMILIES[family]:
        alone = LevelVectorEnv(levels=envs.call("level"), render_mode="rgb_array")
        ours, theirs = envs._tables.offset, alone._tables.offset
        alone._envs.state[:] = envs._envs.state - ours[envs._envs.level] + theirs[:-1]
        assert np.array_equal(alone.montage(), pictures[-1])


# -- the tables ------------------------------------------------------------------------------


@pytest.mark.slow
@given(played=st.lists(levels(), min_size=1, max_size=3), first_action=st.sampled_from([0, 1]))
def test_a_slot_has_all_of_its_level_and_nothing_of_the_one_before(
    played: list[Level], first_action: int
) -> None:
    one_start = [level.replace(start=level.starts[0], start_weights=()) for level in played]
    parts = [part_of(level, level.compile(), first_action) for level in one_start]
    most = [max(sizes) for sizes in zip(*map(needed, parts), strict=True)]
    room = Room(
        slots=3,
        states=max(part.state_info.size for part in parts),
        starts=1,
        stochastic=most[0] + 1,
        outcomes=most[1] + 1,
    )
    tables, fresh = (empty_tables(room, 5 - first_action) for _ in range(2))
    span = room.span(1, tables.num_actions)
    for part in parts:
        write_part(tables, span, part, 9)
    write_part(fresh, span, parts[-1], 9)
    for name in ("threshold", "first", "limit", "starts", "first_start"):
        assert np.array_equal(getattr(tables, name), getattr(fresh, name)), name
    alone = build_tables(parts[-1:], [9])
    base, num_rows = room.states, alone.idle_row
    assert tables.starts[1:2].tolist() == (alone.starts + base).tolist()
    own = alone.state_info
    assert np.array_equal(tables.state_info[base : base + own.size], own)
    for row in range(num_rows):
        ours, theirs = tables.next_state[span.rows.start + row], alone.next_state[row]
        assert (ours < 0) == (theirs < 0)
        count = alone.threshold[theirs].tolist().index(ALWAYS) + 1 if theirs < 0 else 1
        first = tables.first[ours] if ours < 0 else span.rows.start + row
        other = alone.first[theirs] if theirs < 0 else row
        where, there = slice(first, first + count), slice(other, other + count)
        assert np.array_equal(tables.next_state[where], alone.next_state[there] + base)
        assert np.array_equal(tables.reward[where], alone.reward[there])
        assert np.array_equal(tables.outcome_info[where], alone.outcome_info[there])
        if ours < 0:
            assert np.array_equal(tables.threshold[ours, :count], alone.threshold[theirs, :count])
            assert (tables.threshold[ours, count:] == ALWAYS).all()


# -- what it costs ---------------------------------------------------------------------------


def living_levels() -> int:
    gc.collect()
    return sum(type(each) is Level for each in gc.get_objects())


@pytest.mark.slow
@selected([("wet", "position")], family=["wet", "mazes"], observation=["position", "image"])
def test_memory_is_bounded(family: str, observation: str, monkeypatch: pytest.MonkeyPatch) -> None:
    given: dict[str, Any] = {"observation": observation}
    num_slots, steps = 12 if family == "wet" else 4, 60
    if observation == "image":
        given["image_size"], steps = (10, 10), 20
    # As many as twelve of the largest levels of the suite have.
    monkeypatch.setattr(level_slots, "KEPT_STATES", 240)
    if family == "wet":
        given = {"suite": {**WET, "count": 10**6}, **given}
    envs: Any = make(family, 4, max_episode_steps=1, **given)
    before = living_levels()
    envs.reset(seed=1)
    seen: set[int] = set()
    for _ in range(steps):
        *_, info = envs.step(np.zeros(4, int))
        seen |= set(info[word_of(family)[0]].tolist())
    assert len(seen) > steps
    assert len(envs._slots.levels) == num_slots
    assert living_levels() - before <= 2 * num_slots + 4


def test_levels_that_come_again_are_made_once(monkeypatch: pytest.MonkeyPatch) -> None:
    envs = make("wet", 8, split="test", max_episode_steps=1)
    made = made_levels(monkeypatch)
    envs.reset(seed=1)
    for _ in range(200):
        envs.step(np.zeros(8, int))
    assert len(made) == len(set(made))
    assert set(made) <= set(range(30))


# -- whole rollouts --------------------------------------------------------------------------


@each_engine
def test_rollouts_in_a_suite_are_those_in_its_first_levels(
    engine: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    suite = load_suite({**WET, "count": 10**6})[20:]
    made = made_levels(monkeypatch)
    given: dict[str, Any] = {"num_envs": 6, "num_steps": 50, "seed": 1, "engine": engine}
    rolled = brl.rollout(suite, "random", **given)
    assert len(made) <= 7
    levels = [suite[number] for number in range(6)]
    assert same(vars(rolled), vars(brl.rollout(levels, "random", **given)))
    best = [brl.solve(level) for level in levels]
    assert brl.rollout(suite, best, **given).terminations.any(axis=0).all()
