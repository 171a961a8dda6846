"""`set_levels`: other levels for chosen environments, from their next episodes on."""

from __future__ import annotations

import pickle
from typing import Any

import numpy as np
import pytest
from gymnasium.vector import AutoresetMode
from support.combinations import combined
from support.fleets import ENGINES, MODES, same

import babyrobot_levels as brl
from babyrobot_levels.envs.observations import OBSERVATIONS
from babyrobot_levels.envs.vector import levels as level_slots

FIRST = ["final-maze", "maze", "three-gems"]
LIMIT = 4

MOVES: dict[str, Any] = {
    "version": 1,
    "size": [3, 3],
    "movers": [{"name": "bat", "path": [[1, 0], [1, 1]]}],
}
ITEMS: dict[str, Any] = {
    "version": 1,
    "size": [4, 3],
    "items": [{"name": f"coin-{n}", "at": [n % 4, n // 4]} for n in range(1, 10)],
}
TWO_PLACES: dict[str, Any] = {
    "version": 1,
    "size": [4, 3],
    "items": [{"name": "coin", "one_of": [[1, 0], [2, 0]]}],
}

each_engine = pytest.mark.parametrize("engine", ENGINES)


def make(num_envs: int = 6, levels: Any = FIRST, **given: Any) -> brl.LevelVectorEnv:
    return brl.LevelVectorEnv(
        levels=levels, num_envs=num_envs, **{"max_episode_steps": LIMIT, **given}
    )


def names(envs: brl.LevelVectorEnv) -> list[str]:
    return [level.name for level in envs.call("level")]


def stay(envs: brl.LevelVectorEnv, steps: int) -> dict[str, Any]:
    for _ in range(steps):
        *_, info = envs.step(np.zeros(envs.num_envs, int))
    return info


@pytest.mark.slow
@combined(1, mode=MODES, engine=ENGINES, observation=OBSERVATIONS)
def test_levels_change_at_the_next_episode(
    mode: AutoresetMode, engine: str, observation: str
) -> None:
    envs = make(autoreset_mode=mode, engine=engine, observation=observation, actions="all")
    envs.reset(seed=1)
    stay(envs, 1)
    envs.set_levels(["maze", "first-key"], [0, 3, 4])
    before = ["final-maze", "maze", "three-gems"] * 2
    after = ["maze", "maze", "three-gems", "first-key", "maze", "three-gems"]
    stay(envs, LIMIT - 2)
    assert names(envs) == before
    *_, truncated, _ = envs.step(np.zeros(6, int))
    assert truncated.all()
    if mode is AutoresetMode.DISABLED:
        shown, info = envs.reset(options={"reset_mask": truncated})
    elif mode is AutoresetMode.NEXT_STEP:
        assert names(envs) == before
        shown, *_, info = envs.step(np.zeros(6, int))
    else:
        shown, info = envs.reset(seed=1)
    assert names(envs) == after
    assert shown in envs.observation_space
    assert [envs.levels[number].name for number in info["level_index"]] == after
    # From here on, it is as if it had been made with these levels.
    fresh = make(levels=[*map(brl.load, after), *FIRST], autoreset_mode=mode,
                 engine=engine, observation=observation, actions="all")  # fmt: skip
    theirs, _ = fresh.reset(seed=2)
    ours, _ = envs.reset(seed=2)
    rng = np.random.default_rng(0)
    assert np.array_equal(ours, theirs)
    for _ in range(LIMIT - 1):
        actions = rng.integers(0, 5, 6)
        one, other = envs.step(actions), fresh.step(actions)
        assert same(one[:4], other[:4])
        assert same(one[4]["action_mask"], other[4]["action_mask"])


@each_engine
def test_present_episodes_go_on_as_they_would(engine: str) -> None:
    envs, others = (make(engine=engine, max_episode_steps=-1) for _ in range(2))
    rng = np.random.default_rng(0)
    for each in (envs, others):
        each.reset(seed=1)
    for number in range(12):
        if number in (3, 7):
            envs.set_levels("first-key", [number % 6])
        actions = rng.integers(0, 5, 6)
        one, other = envs.step(actions), others.step(actions)
        keep = ~(one[2] | other[2])
        assert same([each[keep] for each in one[:4]], [each[keep] for each in other[:4]])


@each_engine
def test_limits_and_starts_are_those_of_each_level(engine: str) -> None:
    short = brl.load("final-maze").replace(max_steps=2)
    many = {"version": 1, "size": [3, 3], "start": [[0, 0], [2, 0], [0, 2]], "max_steps": 3}
    envs = make(2, ["final-maze"], max_episode_steps=None, engine=engine)
    envs.reset(seed=1)
    envs.set_levels([short, many])
    shown, _ = envs.reset()
    seen = {tuple(shown[1])}
    ends = []
    for _ in range(40):
        shown, _, _, truncated, _ = envs.step(np.zeros(2, int))
        ends.append(truncated.tolist())
        seen.add(tuple(shown[1].tolist()))
    assert [end[0] for end in ends[:6]] == [False, True, False, False, True, False]
    assert [end[1] for end in ends[:8]] == [*[False] * 2, True, *[False] * 3, True, False]
    assert seen == {(0, 0), (2, 0), (0, 2)}


def test_environments_are_chosen_by_index_or_mask() -> None:
    envs = make()
    for which, chosen in (
        (None, range(6)),
        (3, [3]),
        (np.array([5, 1]), [1, 5]),
        (np.arange(6) > 3, [4, 5]),
        ([True, False] * 3, [0, 2, 4]),
    ):
        envs.set_levels("maze")
        envs.reset(seed=1)
        envs.set_levels(["first-key"], which)
        envs.reset()
        assert [n for n, name in enumerate(names(envs)) if name == "first-key"] == [*chosen]


def test_without_a_call_nothing_changes_and_infos_tell_of_one_level_as_before() -> None:
    envs = make(2, ["maze"])
    assert "level_index" not in envs.reset(seed=1)[1]
    envs.set_levels("maze", 1)
    _, info = envs.reset()
    assert info["level_index"].tolist() == [0, 1]


@pytest.mark.slow
@each_engine
def test_memory_is_bounded(engine: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(level_slots, "KEPT_STATES", 1)
    suite = brl.load_suite("small-mazes")
    envs = make(4, [next(each for each in suite if each.size == (8, 8))], engine=engine)
    envs.reset(seed=1)
    for number in range(60):
        envs.set_levels(suite[4 * number : 4 * number + 4])
        info = stay(envs, 3)
        assert len(envs.levels) <= 8
        playing = [envs.levels[each] for each in info["level_index"]]
        assert [each.digest for each in playing] == [each.digest for each in envs.call("level")]
    assert envs._slots is not None
    assert len(envs._slots.levels) <= 8


@each_engine
def test_copies_go_on_alike(engine: str) -> None:
    envs = make(engine=engine)
    envs.reset(seed=1)
    envs.set_levels("first-key", [1, 2])
    stay(envs, 2)
    twin = pickle.loads(pickle.dumps(envs))
    rng = np.random.default_rng(1)
    for _ in range(12):
        actions = rng.integers(0, 5, 6)
        assert same(envs.step(actions), twin.step(actions))
    assert names(envs) == names(twin)


@pytest.mark.parametrize(
    ("level", "message"),
    [
        (TWO_PLACES, "its things have more values"),
        ("cliff-walking", "it has 12x4 cells, and the spaces 8x7"),
        (MOVES, "it has movers, and the spaces have none"),
        (ITEMS, "it has 9 items, and the spaces have 4"),
        ("random-maze", "has no maze of its own"),
    ],
)
def test_levels_must_fit_into_the_spaces(level: str, message: str) -> None:
    envs = make()
    envs.reset(seed=1)
    before = envs.levels
    with pytest.raises(ValueError, match=message):
        envs.set_levels(level)
    assert envs.levels is before


def test_there_is_room_for_levels_like_those_it_was_made_with() -> None:
    envs = make(2, ["maze", "maze", "cliff-walking"])
    envs.reset(seed=1)
    envs.set_levels("cliff-walking")
    envs.reset()
    assert names(envs) == ["cliff-walking"] * 2
    with pytest.raises(ValueError, match="items, and the spaces have 0; make the environment with"):
        make(2, ["maze"]).set_levels(ITEMS)


@pytest.mark.parametrize("which", [6, -1, [], [True], np.zeros(6, bool), 0.5, [[1]]])
def test_wrong_environments(which: Any) -> None:
    with pytest.raises(ValueError, match="which must be indices of environments, 0 to 5"):
        make().set_levels("maze", which)


def test_levels_that_are_drawn_stay() -> None:
    suite = brl.load_suite("small-mazes")[:5]
    for envs in (
        brl.LevelVectorEnv(levels=suite, draw_levels=True),
        brl.LevelVectorEnv(levels=FIRST, draw_levels=True),
        brl.LevelVectorEnv("random-maze"),
    ):
        with pytest.raises(ValueError, match="set_levels is for levels that stay"):
            envs.set_levels("maze")
    with pytest.raises(ValueError, match="at least one level"):
        make().set_levels([])
