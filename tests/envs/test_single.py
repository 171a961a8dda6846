"""How a level is played: chances, starts, mazes, what infos say, pictures, and refusals."""

from __future__ import annotations

import contextlib
import re
from collections.abc import Callable
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.envs.registration import EnvSpec
from support.combinations import swept
from support.playing import CORNERS, Env, level_named, noted, plain

import babyrobot_levels as brl
from babyrobot_levels.envs.single import LevelEnv
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.actions import Action

STAY, NORTH, EAST, SOUTH, WEST, *_ = Action
DRAWS = 4000
RETURNED = ("rgb_array", "ansi", "svg")
"""The render modes that return pictures."""


def play(world: dict[str, Any] | Level, **kwargs: Any) -> LevelEnv:
    """Return the environment of a level, without Gymnasium's wrappers."""
    if not isinstance(world, Level):
        world = {"version": 1, **world}
    return LevelEnv(world, **kwargs)


def far_off(counts: list[int], chances: list[float]) -> bool:
    """Return whether counts are so far from what chances promise that no seed excuses it."""
    total = sum(counts)
    statistic: float = sum(
        (count - total * chance) ** 2 / (total * chance)
        for count, chance in zip(counts, chances, strict=True)
    )
    freedom = len(counts) - 1
    return bool(statistic > freedom + 5 * (2 * freedom) ** 0.5 + 20)


# -- chances ---------------------------------------------------------------------------------


@pytest.mark.parametrize("actions", ["all", "moves"])
@pytest.mark.parametrize("name", ["frozen-lake", "glass-wall", "all at once"])
def test_the_table_is_the_compiled_one_in_toy_texts_shape(name: str, actions: str) -> None:
    level = level_named(name)
    mdp = level.compile()
    first = 1 if actions == "moves" else 0
    table = play(level, actions=actions).P
    assert list(table) == list(range(mdp.num_states))
    for state, row in table.items():
        assert list(row) == list(range(5 - first))
        for action, outcomes in row.items():
            assert sum(outcome[0] for outcome in outcomes) == pytest.approx(1, abs=1e-12)
            for slot, (chance, next_state, reward, terminal) in enumerate(outcomes):
                assert [type(part) for part in outcomes[slot]] == [float, int, float, bool]
                place = (state, action + first, slot)
                assert chance == mdp.probability[place] > 0
                assert next_state == mdp.next_state[place]
                assert reward == mdp.reward[place]
                assert terminal == mdp.terminal[place]
            assert not mdp.probability[state, action + first, len(outcomes) :].any()


@pytest.mark.slow
@pytest.mark.parametrize("name", swept(["all at once"], ["frozen-lake", "glass-wall"]))
def test_steps_happen_as_often_as_the_table_says(name: str) -> None:
    env = play(level_named(name), actions="all")
    env.reset(seed=20)
    width = env.level.size[0]
    rows = [
        (state, action, outcomes)
        for state, row in env.P.items()
        for action, outcomes in row.items()
        if len(outcomes) > 1 and state_can_start(env, state)
    ]
    assert rows
    for state, action, outcomes in rows[:: max(1, len(rows) // 6)]:
        counts = dict.fromkeys([outcome[1:] for outcome in outcomes], 0)
        for _ in range(DRAWS):
            env.reset(options={"start": [state % width, state // width]})
            (x, y), reward, terminated, _, _ = env.step(action)
            counts[int(y) * width + int(x), reward, terminated] += 1
        chances = [outcome[0] for outcome in outcomes]
        assert not far_off(list(counts.values()), chances), (state, action, counts, outcomes)


def state_can_start(env: LevelEnv, state: int) -> bool:
    y, x = divmod(state, env.level.size[0])
    entered = {warp.at for warp in env.level.warps if warp.when == "enter"}
    return not env.level.compile().is_terminal[state] and (x, y) not in entered


def test_the_bound_on_frequencies_sees_a_difference_of_a_twentieth() -> None:
    assert far_off([int(0.45 * DRAWS), int(0.55 * DRAWS)], [0.5, 0.5])
    assert not far_off([int(0.49 * DRAWS), int(0.51 * DRAWS)], [0.5, 0.5])


# -- what a step says of itself --------------------------------------------------------------


def outcomes_seen(
    world: dict[str, Any], start: tuple[int, int], action: int
) -> set[tuple[tuple[int, int], bool, bool]]:
    """Return all (cell, target_reached, skidded) that an action comes to."""
    env = play(world, actions="all")
    env.reset(seed=21)
    seen = set()
    for _ in range(200):
        env.reset(options={"start": start})
        observation, _, _, _, info = env.step(action)
        x, y = observation.tolist()
        seen.add(((x, y), info["target_reached"], info["skidded"]))
    return seen


OPEN_FIELD: dict[str, Any] = {"exit": "none"}
CENTRE = (1, 1)


def test_a_free_move_reaches_its_target() -> None:
    assert outcomes_seen(OPEN_FIELD, CENTRE, NORTH) == {((1, 0), True, False)}


def test_staying_reaches_its_target() -> None:
    always = {"exit": "none", "skid": 1}
    assert outcomes_seen(always, CENTRE, STAY) == {(CENTRE, True, False)}


@pytest.mark.parametrize(("start", "action"), [((0, 0), NORTH), ((2, 2), EAST)])
def test_a_refused_move_neither_reaches_nor_skids(start: tuple[int, int], action: int) -> None:
    assert outcomes_seen(OPEN_FIELD, start, action) == {(start, False, False)}


def test_a_skid_is_one_and_misses_the_target() -> None:
    half = {"exit": "none", "skid": 0.5}
    assert outcomes_seen(half, CENTRE, NORTH) == {
        ((1, 0), True, False),
        ((2, 1), False, True),
        ((1, 2), False, True),
        ((0, 1), False, True),
    }


def test_a_wall_does_not_keep_a_robot_from_skidding_aside() -> None:
    ice = {"exit": "none", "skid": {"probability": 1, "to": "sides"}}
    assert outcomes_seen(ice, (1, 0), NORTH) == {((0, 0), False, True), ((2, 0), False, True)}


GLASS: dict[str, Any] = {"exit": "none", "walls": [{"at": [1, 1], "side": "E", "pass": 0.5}]}


def test_glass_lets_through_or_throws_back() -> None:
    assert outcomes_seen(GLASS, CENTRE, EAST) == {((2, 1), True, False), ((0, 1), False, False)}


def test_a_bounce_without_room_stays() -> None:
    shut = {**GLASS, "walls": [*GLASS["walls"], {"at": [1, 1], "side": "W"}]}
    assert outcomes_seen(shut, CENTRE, EAST) == {((2, 1), True, False), (CENTRE, False, False)}


def test_glass_is_no_place_to_skid_to_and_no_skid() -> None:
    wet = {**GLASS, "skid": 0.9}
    assert outcomes_seen(wet, CENTRE, NORTH) == {
        ((1, 0), True, False),
        ((1, 2), False, True),
        ((0, 1), False, True),
    }
    assert outcomes_seen(wet, CENTRE, EAST) == {((2, 1), True, False), ((0, 1), False, False)}


def test_a_warp_is_where_the_move_leads() -> None:
    pads = {"exit": "none", "warps": [{"at": [1, 0], "to": [2, 2]}]}
    assert outcomes_seen(pads, CENTRE, NORTH) == {((2, 2), True, False)}
    leaves = {"exit": "none", "warps": [{"at": [1, 1], "to": [2, 2], "when": "leave"}]}
    assert outcomes_seen(leaves, CENTRE, NORTH) == {((2, 2), True, False)}


def test_a_warp_to_one_of_several_starts_reaches_its_target_in_each() -> None:
    back = {"exit": "none", "start": [[0, 2], [2, 2]], "warps": [{"at": [1, 0], "to": "start"}]}
    assert outcomes_seen(back, CENTRE, NORTH) == {((0, 2), True, False), ((2, 2), True, False)}


def test_wind_is_part_of_where_a_move_leads() -> None:
    windy = {"exit": "none", "wind": {"north": [0, 1, 0]}}
    assert outcomes_seen(windy, (1, 2), EAST) == {((2, 1), True, False)}
    # The wind cancels the move out; nothing has refused it.
    assert outcomes_seen(windy, CENTRE, SOUTH) == {(CENTRE, True, False)}


def test_nobody_can_spoil_what_the_action_space_knows() -> None:
    env = play(level_named("default"))
    _, info = env.reset()
    with contextlib.suppress(ValueError):
        # Read-only would do as well as a copy.
        env.action_space.mask[:] = 0  # type: ignore[attr-defined]
    assert env.action_masks().tolist() == info["action_mask"].tolist()
    assert env.action_space.sample() in info["action_mask"].nonzero()[0]


# -- where episodes begin --------------------------------------------------------------------


def test_several_starts_are_drawn_evenly() -> None:
    env = play(level_named("four-corners"), observation="index")
    env.reset(seed=22)
    counts = dict.fromkeys(env.initial_state_distrib.nonzero()[0].tolist(), 0)
    assert len(counts) == 4
    for _ in range(DRAWS):
        counts[env.reset()[0]] += 1
    assert not far_off(list(counts.values()), [0.25] * 4)


def test_the_initial_distribution_is_a_copy_that_sums_to_one() -> None:
    env = play(level_named("four-corners"))
    given = env.initial_state_distrib
    assert given.shape == (25,)
    assert given[[0, 4, 20, 24]].tolist() == [0.25] * 4
    assert given.sum() == 1
    given[:] = 0
    assert env.initial_state_distrib.sum() == 1


@pytest.mark.parametrize("cell", [[2, 0], (2, 0), np.array([2, 0])])
def test_an_episode_can_begin_at_a_given_cell(cell: Any) -> None:
    env = play(level_named("default"))
    observation, info = env.reset(options={"start": cell})
    assert observation.tolist() == [2, 0]
    assert info["action_mask"].tolist() == [1, 0, 0, 1, 1]
    assert env.reset()[0].tolist() == [0, 0]
    assert env.reset(options={"start": None})[0].tolist() == [0, 0]


@pytest.mark.parametrize(
    ("cell", "told"),
    [
        ([5, 0], "[5, 0] is off the grid"),
        ([0, -1], "[0, -1] is off the grid"),
        ([2, 3], "[2, 3] the episode would be over"),
        ([3, 1], "[3, 1] the episode would be over"),
        ([2, 0], "[2, 0] is a warp"),
        ([1], "must be a cell, [x, y], not [1]"),
        ([0.5, 1], "must be a cell"),
        ("1,1", "must be a cell, [x, y], not '1,1'"),
    ],
)
def test_starts_that_cannot_be_are_refused(cell: Any, told: str) -> None:
    env = play(CORNERS["all at once"])
    with pytest.raises(ValueError, match=re.escape(told)):
        env.reset(options={"start": cell})


@pytest.mark.parametrize("name", ["default", "random-maze"])
def test_a_refused_reset_leaves_the_running_episode_as_it_was(name: str) -> None:
    env = play(level_named(name), render_mode="ansi")
    _, info = env.reset(seed=1)
    action = int(info["action_mask"].nonzero()[0][-1])
    expected, *_ = env.step(action)
    picture, level = env.render(), env.level
    for options in ({"start": [99, 99]}, {"maze_seed": "random"}):
        with pytest.raises(ValueError, match=r"off the grid|maze_seed"):
            env.reset(options=options)
        assert env.level is level
        assert env.render() == picture
        assert env.step(STAY)[0].tolist() == expected.tolist()


def test_a_leave_warp_can_be_started_from() -> None:
    env = play(CORNERS["all at once"])
    env.reset(options={"start": [4, 2]})
    assert env.step(NORTH)[0].tolist() == [0, 0]


# -- random mazes ----------------------------------------------------------------------------


@pytest.fixture
def mazes() -> LevelEnv:
    return play(level_named("random-maze"))


@pytest.mark.parametrize("seed", [0, np.int64(7), 2**31 - 1])
def test_a_maze_can_be_asked_for(mazes: LevelEnv, seed: int) -> None:
    before = mazes.observation_space, mazes.action_space
    _, info = mazes.reset(options={"maze_seed": seed})
    assert info["maze_seed"] == seed
    expected = level_named("random-maze").with_maze_seed(seed)
    assert mazes.level.digest == expected.digest
    assert expected.compile().to_toy_text() == mazes.P
    assert mazes.observation_space is before[0]
    assert mazes.action_space is before[1]


def test_an_asked_for_maze_draws_nothing(mazes: LevelEnv) -> None:
    mazes.reset(seed=27)
    follows = mazes.reset()[1]["maze_seed"]
    mazes.reset(seed=27)
    mazes.reset(options={"maze_seed": 1})
    assert mazes.reset()[1]["maze_seed"] == follows


@pytest.mark.parametrize("seed", ["random", "7", 1.5, [1], True])
def test_maze_seeds_that_are_none_are_refused(mazes: LevelEnv, seed: Any) -> None:
    with pytest.raises(ValueError, match=r"options\['maze_seed'\] must be"):
        mazes.reset(options={"maze_seed": seed})


ALL_KINDS: dict[str, Callable[[], Any]] = {
    "one": lambda: brl.load("default").make(),
    "mazes": lambda: brl.load("random-maze").make(),
    "suite": lambda: gymnasium.make("babyrobot/Suite-v0", suite="small-mazes"),
    "many": lambda: brl.LevelVectorEnv(level="default", num_envs=2),
    "many in levels": lambda: brl.LevelVectorEnv(levels=["maze", "default"], draw_levels=True),
    "many in mazes": lambda: brl.LevelVectorEnv(level="random-maze", num_envs=2),
    "many in a suite": lambda: gymnasium.make_vec(
        "babyrobot/Suite-v0", num_envs=2, suite="small-mazes"
    ),
}


NO_OPTIONS: list[tuple[Any, str, str]] = [
    # Options, what is told, and a word in the kinds that have them.
    (
        {"strat": [1, 1]},
        "`reset` has no option 'strat'; did you mean `start`? known options: `start`",
        "none",
    ),
    ({7: 1}, "`reset` has no option 7; known options: `start`", "none"),
    ({"initial_pos": [1, 1]}, "no option 'initial_pos'; known options: `start`", "none"),
    ([1], "options must be a dict, not [1]", "none"),
    ({"index": 1}, "options['index'] is for suites", "suite"),
    (
        {"maze_seed": 1},
        "options['maze_seed'] is for levels that say `maze: {seed: random}`",
        "mazes",
    ),
    ({"reset_mask": np.ones(1, bool)}, "options['reset_mask'] is for vector environments", "many"),
]


@pytest.mark.parametrize(
    ("kind", "options", "message"),
    [
        (kind, options, message)
        for kind in ALL_KINDS
        for options, message, word in NO_OPTIONS
        if word not in kind
    ],
)
def test_options_that_there_are_not_are_refused(kind: str, options: Any, message: str) -> None:
    env = ALL_KINDS[kind]()
    with pytest.raises(ValueError, match=re.escape(message)):
        env.reset(options=options)
    env.reset(options={"start": None, "maze_seed": None})


@pytest.mark.parametrize("mode", RETURNED)
def test_pictures_show_the_maze_of_the_episode(mode: str) -> None:
    env = play(level_named("random-maze"), observation="image", render_mode=mode)
    first, _ = env.reset(options={"maze_seed": 1})
    picture = plain(env.render())
    second, _ = env.reset(options={"maze_seed": 2})
    assert (first != second).any()
    assert plain(env.render()) != picture
    again, _ = env.reset(options={"maze_seed": 1})
    assert (first == again).all()
    assert plain(env.render()) == picture


# -- pictures --------------------------------------------------------------------------------


def test_a_frame_belongs_to_the_user() -> None:
    env = play(level_named("default"), render_mode="rgb_array")
    env.reset()
    frame = env.render()
    before = frame.copy()
    frame[:] = 0
    assert (env.render() == before).all()


def test_render_without_a_mode_warns_and_says_how() -> None:
    env = level_named("default").make()
    env.reset()
    with pytest.warns(UserWarning, match=r'render_mode="rgb_array"'):
        assert env.render() is None


# -- cells as observations -------------------------------------------------------------------


FENCED: dict[str, Any] = {
    "size": [3, 2],
    "start": [1, 0],
    "walls": [{"at": [1, 0], "side": "E"}, {"at": [1, 1], "side": "W", "pass": 0.5}],
    "blocked": [{"at": [2, 0]}],
    "exit": "none",
}


@pytest.mark.parametrize(
    ("cell", "sides"),
    [
        # North, east, south, west: 1 where nothing closes the side; glass does.
        ([0, 0], [0, 1, 1, 0]),
        ([1, 0], [0, 0, 1, 1]),
        ([0, 1], [1, 0, 0, 0]),
        ([1, 1], [1, 1, 0, 0]),
        ([2, 1], [0, 0, 0, 1]),
    ],
)
def test_what_is_observed_of_a_cell(cell: list[int], sides: list[int]) -> None:
    seen = {
        kind: play(FENCED, observation=kind).reset(options={"start": cell})[0]
        for kind in ("position", "index", "walls")
    }
    assert seen["position"].tolist() == cell
    assert seen["index"] == cell[1] * 3 + cell[0]
    assert seen["walls"].tolist() == cell + sides


# -- images as observations ------------------------------------------------------------------


def images(**kwargs: Any) -> Env:
    return level_named("image-maze").make(observation="image", **kwargs)


@pytest.mark.parametrize("gray", [False, True])
@pytest.mark.parametrize("size", [(1, 1), (50, 91)])
def test_images_have_the_size_that_was_asked_for(size: tuple[int, int], gray: bool) -> None:
    env = images(image_size=np.array(size) if gray else size, grayscale=gray)
    observation, _ = env.reset()
    assert observation.shape == env.observation_space.shape == (*size, 1 if gray else 3)
    assert observation.dtype == env.observation_space.dtype == np.uint8
    assert (observation in env.observation_space) is True


def test_gray_is_the_brightness_of_the_colours() -> None:
    colour, _ = images(image_size=(40, 48)).reset()
    gray, _ = images(image_size=(40, 48), grayscale=True).reset()
    expected = colour @ np.array([0.299, 0.587, 0.114])
    assert np.abs(gray[..., 0] - expected).max() <= 2


# -- refusals --------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ({"observation": "postion"}, "did you mean `position`"),
        ({"observation": "pixels"}, "one of 'position', 'index', 'walls', 'vector', 'planes'"),
        ({"observation": None}, "one of 'position'"),
        ({"actions": "move"}, "did you mean `moves`"),
        ({"actions": 5}, "one of 'valid', 'all', 'moves', 'valid_moves'"),
        ({"render_mode": "rgb_aray"}, "did you mean `rgb_array`"),
        ({"image_size": (40, 40)}, "observation='image'"),
        ({"grayscale": True}, "observation='image'"),
        ({"observation": "image", "image_size": (0, 10)}, "(height, width) in pixels"),
        ({"observation": "image", "image_size": (40, 5000)}, "(height, width) in pixels"),
        ({"observation": "image", "image_size": 40}, "(height, width) in pixels, 1 to 4096 each"),
        ({"observation": "image", "image_size": (40.5, 40)}, "(height, width) in pixels"),
        ({"observation": "image", "image_size": "4x"}, "(height, width) in pixels"),
    ],
)
def test_arguments_that_cannot_be_are_refused(given: dict[str, Any], told: str) -> None:
    with pytest.raises(ValueError, match=re.escape(told)):
        LevelEnv("default", **given)


def test_unknown_levels_are_refused() -> None:
    with pytest.raises(brl.LevelNotFoundError, match="did you mean 'final-maze'"):
        gymnasium.make("babyrobot/Level-v0", level="finl-maze")
    with pytest.raises(brl.LevelError, match="version"):
        gymnasium.make("babyrobot/Level-v0", level={"size": [3, 3]})


# -- the level by any other name -------------------------------------------------------------


THEME = "colors: {base: '#123456'}\n"
THEMED = "version: 1\nsize: [4, 3]\nmaze: {seed: 5}\npuddles: [{at: [2, 1]}]\ntheme: sea\n"


@pytest.mark.parametrize("way", ["name", "path", "path text", "mapping", "level", "themed"])
def test_the_spec_as_json_makes_the_same_game(way: str, tmp_path: Any) -> None:
    path = tmp_path / "ours.yaml"
    path.write_text(THEMED.replace("theme: sea\n", ""), "utf-8")
    themed = tmp_path / "themed.yaml"
    themed.write_text(THEMED, "utf-8")
    (tmp_path / "themes").mkdir()
    (tmp_path / "themes" / "sea.yaml").write_text(THEME, "utf-8")
    level: Any = {
        "name": "final-maze",
        "path": path,
        "path text": str(path),
        "mapping": CORNERS["all at once"],
        "level": level_named("random-maze"),
        "themed": brl.load(themed),
    }[way]
    env = gymnasium.make("babyrobot/Level-v0", level=level, render_mode="rgb_array")
    assert env.spec is not None
    if way == "themed":
        # The level and its theme are all that is needed: the files may be gone.
        themed.unlink()
        (tmp_path / "themes" / "sea.yaml").unlink()
    again = gymnasium.make(EnvSpec.from_json(env.spec.to_json()))
    one, other = env.reset(seed=31), again.reset(seed=31)
    assert plain(one[0]) == plain(other[0])
    assert noted(one[1]) == noted(other[1])
    ours: Any = env.unwrapped
    theirs: Any = again.unwrapped
    assert ours.level.digest == theirs.level.digest
    assert ours.level.name == theirs.level.name
    assert ours.level.max_steps == theirs.level.max_steps
    assert plain(env.render()) == plain(again.render())
