"""What an agent is shown: by the names of observations and of worlds of text, or by a function."""

from __future__ import annotations

import re
from random import Random
from typing import Any

import numpy as np
import pytest
from extensions.sight.cases import blind

import babyrobot_levels as brl
from babyrobot_levels.envs.observations import OBSERVATIONS
from babyrobot_levels.extensions.sight import NAMES, SightPolicy, sight_cost, solve_sight

CROSSED = {"version": 1, "size": [3, 1], "start": [1, 0], "exit_one_of": [[0, 0], [2, 0]]}
"""The exit is in the west or in the east."""


def test_the_names_are_those_of_observations_and_of_worlds_of_text() -> None:
    assert (*OBSERVATIONS, "text-map", "text-view", "text-words") == NAMES


@pytest.mark.parametrize("name", NAMES)
def test_who_is_shown_where_the_exit_is_lacks_nothing(name: str) -> None:
    # Pictures, planes and numbers of things show it at once, also to who stands beside it.
    assert sight_cost({**CROSSED, "rewards": {"step": -1}}, name) == (0, 0)


def test_what_is_not_shown_costs_what_it_takes_to_find_out() -> None:
    level = {**CROSSED, "rewards": {"step": -1, "exit": 0}}
    found = solve_sight(level, blind)
    # In one of two cases two further steps, one of which is back to the start.
    assert (found.lower, found.upper, found.full) == pytest.approx((-1, -1, 0), abs=1e-12)
    assert found.cost == pytest.approx((1, 1), abs=1e-12)
    assert solve_sight(level, blind, within=1).upper == pytest.approx(-0.5)
    assert repr(found).startswith("<SightSolution expected_return=-1 full=0 sight='blind' beliefs=")


@pytest.mark.slow
def test_one_more_cell_of_view_is_worth_something() -> None:
    costs = [sight_cost("shell-game", view_radius=radius) for radius in (1, 2, 3)]
    assert all(low == pytest.approx(high, abs=1e-9) for low, high in costs)
    values = [low for low, _ in costs]
    assert values == sorted(values, reverse=True)
    assert values[0] > values[-1] > 0


def test_rewards_and_masks_tell_something_to_who_gets_them() -> None:
    level = {
        "version": 1,
        "size": [5, 1],
        "start": [[1, 0], [3, 0]],
        "exit": [2, 0],
        "areas": [
            {"at": [0, 0], "reward": -9, "ends": True},
            {"at": [4, 0], "reward": -9, "ends": True},
            {"at": [1, 0], "reward": -2},
        ],
        "rewards": {"step": -1, "exit": 0},
    }
    assert solve_sight(level, "position").upper == 0
    assert solve_sight(level, blind).upper == pytest.approx(-4.5)
    # Who waits learns by the reward where it is.
    assert solve_sight(level, blind, reward=True).upper == pytest.approx(-1.5)


def test_the_mask_tells_walls_that_a_picture_of_one_cell_does_not() -> None:
    def nothing_but_the_cell(level: brl.Level, state: int) -> int:
        return state % (level.size[0] * level.size[1])

    walls = [[{"at": [0, 0], "side": side}] for side in "ES"]
    levels = [{"version": 1, "size": [2, 2], "walls": each} for each in walls]
    shown = [solve_sight(levels, "position", mask=mask).upper for mask in (True, False)]
    assert shown[0] > shown[1] == solve_sight(levels, nothing_but_the_cell).upper


@pytest.mark.slow
@pytest.mark.parametrize("sight", ["map", "view", "words"])
@pytest.mark.parametrize("level", ["shell-game", "glasshouse", "two-levers"])
def test_worlds_of_text_tell_what_their_sight_says(level: str, sight: str) -> None:
    found = solve_sight(level, f"text-{sight}", within=30, beliefs=10)
    world, agent, random = brl.TextWorld(level, sight=sight, within=30), found.policy(), Random(1)
    for seed in range(3):
        rules, _, scene = world.reset(seed=seed).rpartition("\n\n")
        agent.reset()
        told: str | None = None
        while not world.done:
            agent.act((rules, scene, told))
            # The agent notes that another action was taken than its own.
            move = random.choice(["north", "east", "south", "west", "wait"])
            agent._action = ["wait", "north", "east", "south", "west"].index(move)
            text = world.wait() if move == "wait" else world.move(move)
            line, _, scene = text.partition("\n")
            told = re.sub(r"Step \d+ of \d+: (reward \S+), together \S+\.$", r"\1", line)
        assert believes(agent, world) or world.done


def believes(agent: SightPolicy, world: brl.TextWorld) -> bool:
    """Return whether an agent thinks that the state of a world may be what it is."""
    return any(state == world.state for _, state, _ in agent.belief)


@pytest.mark.slow
@pytest.mark.parametrize(
    "options",
    [
        {},
        {"view_radius": 1, "actions": "turns"},
        {"sight": ("position", "view")},
        {"sight": "planes"},
        {"sight": "image", "image_size": (20, 30)},
    ],
    ids=repr,
)
def test_environments_show_what_their_sight_says(options: dict[str, Any]) -> None:
    given = dict(options)
    sight, actions = given.pop("sight", "view"), given.pop("actions", "all")
    found = solve_sight("shell-game", sight, actions=actions, reward=True, beliefs=10, **given)
    env: Any = brl.load("shell-game").make(observation=sight, actions=actions, **given)
    agent, random = found.policy(), np.random.default_rng(2)
    for seed in range(5):
        observation, info = env.reset(seed=seed)
        agent.reset()
        reward: float | None = None
        for _ in range(20):
            agent.act(observation, info["action_mask"], reward)
            assert any(state == env.unwrapped.state for _, state, _ in agent.belief)
            agent._action = int(random.integers(env.action_space.n))
            observation, reward, terminated, truncated, info = env.step(agent._action)
            if terminated or truncated:
                break


@pytest.mark.parametrize(
    ("sight", "options", "message"),
    [
        ("veiw", {}, "sight must be one of .*did you mean `view`"),
        ("map", {}, "'text-map', 'text-view', 'text-words', not 'map'"),
        ("position", {"view_radius": 2}, "need observation='view'"),
        ("text-map", {"view_radius": 2}, "unexpected option 'view_radius': 'text-map' has none"),
        (blind, {"view_radius": 2}, "unexpected option 'view_radius': a function has none"),
        ("text-map", {"actions": "turns"}, "tells of robots that do not turn"),
        ("view", {"view_radius": 0}, "view_radius must be"),
        ("view", {"weights": [1, 2]}, "weights must be 1 numbers"),
        ("view", {"weights": [0]}, "weights must not all be 0"),
        ("view", {"within": 0}, "within must be"),
        ("view", {"discount": 2}, "discount must be"),
    ],
)
def test_what_cannot_be_is_refused(sight: Any, options: dict[str, Any], message: str) -> None:
    with pytest.raises((ValueError, TypeError), match=message):
        solve_sight("shell-game", sight, **options)


def test_a_word_that_is_no_argument_is_refused() -> None:
    with pytest.raises(TypeError, match="view_radius"):
        solve_sight("shell-game", view_radios=2)
