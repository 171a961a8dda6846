"""Levels as worlds of text: moves are graded exactly, and nothing that is sent ends a program."""

from __future__ import annotations

import inspect
import math
import random
from pathlib import Path
from typing import Any

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from support.combinations import selected
from support.things import thing_worlds
from support.worlds import level, level_of, worlds

import babyrobot_levels as brl
from babyrobot_levels.agents.verify import verify_play
from babyrobot_levels.analysis.solver.results import action_names

WET = {
    "size": [3, 2],
    "exit": [2, 1],
    "puddles": [{"at": [1, 0]}, {"at": [1, 1], "size": "large"}],
    "max_steps": 20,
}
NAMES = action_names("all", brl.load("maze").compile())


def act(world: brl.TextWorld, action: str) -> str:
    return world.wait() if action == "stay" else world.move(action)


def follow(world: brl.TextWorld) -> None:
    """Play an episode by the optimal policy within the limit."""
    policies = brl.solve(world.level, within=world.within).policies
    assert policies is not None
    while not world.done:
        act(world, NAMES[int(policies[len(world.moves)].ravel()[world.state])])


@pytest.mark.slow
@settings(max_examples=min(settings().max_examples, 60), deadline=None)
@given(
    st.one_of(worlds(5), thing_worlds()),
    st.integers(1, 30),
    st.integers(0, 2**20),
    st.sampled_from([1.0, 0.9]),
)
def test_advantages_and_luck_add_up_to_what_an_episode_misses_of_the_optimum(
    fields: dict[str, Any], limit: int, seed: int, discount: float
) -> None:
    """The law of grading, whatever is done in whatever level."""
    given_level = level_of({**fields, "max_steps": limit, "discount": discount})
    assume(not given_level.has_random_maze)
    world, rng = brl.TextWorld(given_level, sight="words"), random.Random(seed)
    assert given_level.compile().start.sum() == pytest.approx(1)
    world.reset(seed=seed)
    if not world.done:
        while not world.done:
            act(world, rng.choice(NAMES))
        assert brl.replay(world.play)[0].is_valid
    scale = 1 + sum(abs(move.reward) for move in world.moves)
    missing = world.return_ - world.optimum
    assert math.isclose(world.luck - world.regret, missing, abs_tol=1e-9 * scale)
    assert all(move.advantage <= 0 for move in world.moves)
    assert world.optimum == pytest.approx(
        brl.solve(given_level, within=limit).expected_return, abs=1e-9 * scale
    )


@pytest.mark.slow
@pytest.mark.parametrize("name", ["frozen-lake", "night-watch", "first-key", "final-maze"])
def test_only_optimal_play_has_no_regret(name: str) -> None:
    world = brl.TextWorld(name)
    for seed in range(5):
        world.reset(seed=seed)
        follow(world)
        assert (world.regret, world.blunders, world.invalid) == (0.0, 0, 0)
    world.reset(seed=0)
    for action in NAMES:
        best = brl.solve(name, within="max_steps").policies
        assert best is not None
        if NAMES[int(best[0].ravel()[world.state])] != action and not world.moves:
            act(world, action)
    (move,) = world.moves
    assert (move.advantage < 0) == (world.regret > 0)


def test_regret_of_a_detour_is_what_it_costs() -> None:
    world = brl.TextWorld(level(size=[4, 1], exit=[3, 0], max_steps=20))
    world.reset(seed=0)
    assert world.optimum == -2
    world.move("east")
    world.move("west")
    world.move("WEST ")
    assert [move.advantage for move in world.moves] == [0, -2, -1]
    assert [move.is_loop for move in world.moves] == [False, True, True]
    assert (world.regret, world.loops, world.invalid, world.done) == (3, 2, 0, False)
    for _ in range(3):
        world.move("east")
    assert (world.done, world.is_success, world.return_, world.luck) == (True, True, -5, 0)


def test_values_are_those_within_the_steps_that_are_left() -> None:
    """With two steps left of a way of three, nothing is lost any more."""
    world = brl.TextWorld(level(size=[5, 1], exit=[4, 0], rewards={"step": 0, "exit": 1}), within=5)
    world.reset()
    world.wait()
    assert world.regret == 0
    world.wait()
    assert world.regret == 1
    world.move("west")
    assert (world.regret, world.blunders) == (1, 1)


@pytest.mark.parametrize(("kind", "after"), [("world", -2.0), ("advantage", 0.0), ("success", 1.0)])
def test_the_reward_is_of_the_kind_that_is_chosen(kind: str, after: float) -> None:
    world = brl.TextWorld(level(size=[4, 1], exit=[3, 0], max_steps=9), reward=kind)
    assert world.reward == 0
    world.reset()
    for _ in range(3):
        world.move("east")
    assert world.reward == after
    assert math.copysign(1, world.reward) == (-1 if after < 0 else 1)


@pytest.mark.parametrize("word", ["up", "", "north east", None, 7, ["north"], "nörth", "n" * 10**6])
def test_nonsense_is_answered_and_counted(word: Any) -> None:
    world = brl.TextWorld("first-key")
    world.reset(seed=1)
    before = world.look()
    answer = world.move(word)
    assert answer == "That is no direction: move north, east, south or west. Nothing happened."
    assert (world.invalid, world.moves, world.look()) == (1, (), before)


def test_calls_before_and_after_an_episode_are_answered() -> None:
    world = brl.TextWorld(level(size=[2, 1], exit=[1, 0], max_steps=9))
    assert world.done
    assert world.move("east") == world.wait() == world.look()
    assert "reset the world" in world.look()
    with pytest.raises(brl.PlayError, match="no step"):
        _ = world.play
    world.reset()
    world.move("east")
    over = world.move("east")
    assert over == "The episode is over: it ended at the exit after 1 step, with 0 in all."
    assert (len(world.moves), world.invalid) == (1, 1)
    world.reset()
    assert (world.invalid, world.done) == (0, False)


def test_an_episode_ends_when_the_steps_are_used_up() -> None:
    world = brl.TextWorld("final-maze", within=2)
    rules = world.reset()
    assert "the episode ends after 2 steps" in rules
    world.wait()
    assert "for want of steps after 2 steps" in world.wait()
    assert (world.done, world.is_success, world.play.end) == (True, False, "truncated")


def test_the_same_seed_gives_the_same_episode() -> None:
    texts = []
    for _ in range(2):
        world = brl.TextWorld("frozen-lake", sight="view")
        texts.append([world.reset(seed=5), *(world.move("east") for _ in range(9))])
    assert texts[0] == texts[1]
    assert world.seed == 5
    drawn = {(world.reset(), world.seed)[1] for _ in range(4)}
    assert len(drawn) == 4


def test_trainers_get_a_class_without_arguments_and_its_methods_as_tools() -> None:
    """The contract of TRL's `environment_factory`: what it calls, and what it takes for tools."""

    class Lake(brl.TextWorld):
        def __init__(self) -> None:
            super().__init__("frozen-lake", reward="success")

    lake = Lake()
    text = lake.reset(prompt=[{"role": "user", "content": "Play."}], seed=3, level="first-key")
    assert isinstance(text, str)
    assert "the key" in text
    assert lake.level.name == "first-key"
    functions = dict(inspect.getmembers(Lake, predicate=inspect.isfunction))
    tools = {name for name in functions if not name.startswith("_")} - {"reset"}
    assert tools == {"move", "wait", "look"}
    for name in tools:
        documentation = inspect.getdoc(functions[name])
        assert documentation is not None
        arguments = {*inspect.signature(functions[name]).parameters} - {"self"}
        assert ("Args:" in documentation) == bool(arguments)
        assert all(f"{argument}:" in documentation for argument in arguments)


@pytest.mark.slow
def test_wrong_arguments_are_refused() -> None:
    for arguments, message in (
        ({"sight": "smell"}, "sight must be"),
        ({"reward": "gold"}, "reward must be"),
        ({"within": 0}, "within must be"),
    ):
        with pytest.raises(ValueError, match=message):
            brl.TextWorld("first-key", **arguments)
    with pytest.raises(ValueError, match="has no max_steps"):
        brl.TextWorld(level(size=[2, 2]))
    with pytest.raises(ValueError, match="use sight='view'"):
        brl.TextWorld(level(size=[100, 100], max_steps=5))
    with pytest.raises(brl.LevelError):
        brl.TextWorld(level(size=[4, 4], maze={"seed": "random"}, max_steps=5))


def test_blunders_are_told_by_their_share_of_what_there_is_to_win() -> None:
    world = brl.TextWorld("frozen-lake", blunder=0.0)
    strict, lenient = 0, 0
    for threshold in (0.0, 0.5):
        world = brl.TextWorld("frozen-lake", blunder=threshold)
        world.reset(seed=2)
        while not world.done:
            world.move("south")
        strict, lenient = lenient, world.blunders
    assert strict > lenient
    assert strict == sum(move.advantage < 0 for move in world.moves)


@pytest.mark.parametrize("sight", ["map", "view", "words"])
def test_observations_are_what_worlds_of_text_tell(sight: str) -> None:
    env: Any = brl.TextObservation(brl.make("ice-vault", actions="all"), sight)
    world = brl.TextWorld("ice-vault", sight=sight)
    seen, info = env.reset(seed=4)
    assert world.reset(seed=4) == f"{info['rules']}\n\n{seen}"
    for _ in range(30):
        seen, _, terminated, truncated, _ = env.step(int(brl.Action.EAST))
        assert seen in env.observation_space
        told = world.move("east")
        if terminated or truncated:
            break
        assert told.endswith(seen)


def test_decisions_are_those_of_text_worlds(tmp_path: Path) -> None:
    world = brl.TextWorld("frozen-lake")
    world.reset(seed=3)
    for direction in ("east", "south", "south", "west", "north", "east"):
        world.move(direction)
    found = verify_play(world.play)
    assert (found.regret, found.luck) == pytest.approx((world.regret, world.luck))


# -- how sure one can be ---------------------------------------------------------------------


@pytest.mark.slow
def test_it_is_told_how_sure_one_can_be() -> None:
    world = brl.TextWorld("three-gems", sight="words", tell_sure=True)
    assert "one can be 25 % sure how everything stands" in world.reset(seed=1)
    assert world.sure == pytest.approx(1 / 4)
    assert "sure" not in brl.TextWorld("three-gems", sight="words").reset(seed=1)
    assert brl.TextWorld("three-gems", sight="words").sure is None
    known = brl.TextWorld("three-gems", sight="map", tell_sure=True)
    assert "One can know how everything stands." in known.reset(seed=1)


@pytest.mark.slow
@selected(
    [("three-gems", "view")],
    level=["three-gems", "bat-cave", "treasure-chests"],
    sight=["map", "view", "words"],
)
def test_what_is_true_is_never_ruled_out(level: str, sight: str) -> None:
    world: Any = brl.TextWorld(level, sight=sight, tell_sure=True)
    rng = random.Random(7)
    for seed in range(3):
        world.reset(seed=seed)
        for _ in range(40):
            if world.done:
                break
            tracker = world._tracker
            states = tracker.model.state[tracker.states].tolist()
            assert world.state in states
            assert sum(tracker.chances) == pytest.approx(1)
            world.move(rng.choice(["north", "east", "south", "west"]))
