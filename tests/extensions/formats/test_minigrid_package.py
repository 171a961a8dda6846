"""Levels and MiniGrid itself, where the package is installed: the same games, the same plans."""

from __future__ import annotations

from typing import Any

import pytest
from support.combinations import swept
from support.conversions import level_of_world

import babyrobot_levels as brl
from babyrobot_levels.analysis.environments import made_minigrid
from babyrobot_levels.extensions.formats.minigrid import world_of_environment
from babyrobot_levels.library.level import Level

pytest.importorskip("minigrid", reason="the package minigrid is not installed")

SEEDS = range(3)

SAME = [
    *("Empty-5x5", "Empty-Random-6x6", "Empty-16x16", "FourRooms", "SimpleCrossingS9N1"),
    *("SimpleCrossingS11N5", "LavaCrossingS9N2", "LavaCrossingS11N5", "LavaGapS5", "LavaGapS7"),
    *("DistShift1", "DistShift2"),
]
"""Environments without objects."""

ALIKE = [
    *("MiniGrid-DoorKey-5x5", "MiniGrid-DoorKey-8x8", "MiniGrid-DoorKey-16x16"),
    *("MiniGrid-MultiRoom-N2-S4", "MiniGrid-MultiRoom-N6", "MiniGrid-LockedRoom"),
    *("MiniGrid-Unlock", "MiniGrid-UnlockPickup", "MiniGrid-KeyCorridorS3R1"),
    *("MiniGrid-KeyCorridorS3R3", "MiniGrid-KeyCorridorS6R3", "MiniGrid-RedBlueDoors-8x8"),
    *("MiniGrid-MemoryS7", "MiniGrid-MemoryS13", "MiniGrid-Fetch-8x8-N3"),
    *("MiniGrid-GoToDoor-6x6", "MiniGrid-GoToObject-6x6-N2", "MiniGrid-ObstructedMaze-1Dl"),
    *("MiniGrid-ObstructedMaze-1Dlh", "BabyAI-GoToObj", "BabyAI-OpenRedDoor"),
    *("BabyAI-UnlockToUnlock", "BabyAI-KeyCorridorS3R3", "BabyAI-UnlockLocal"),
]
"""Environments in which a plan for the level can be carried out."""

FORWARD, PICK_UP, TOGGLE, DONE = 2, 3, 5, 6


def made(env_id: str, seed: int) -> tuple[Any, Level]:
    """Return an environment after a reset, and its level."""
    env = made_minigrid(env_id, seed, None)
    return env, level_of_world(world_of_environment(env, env_id, seed))


@pytest.mark.slow
@pytest.mark.parametrize("name", swept(["Empty-5x5", "Empty-Random-6x6", "LavaGapS5"], SAME))
def test_grids_without_objects_are_the_same_game(name: str) -> None:
    for seed in SEEDS:
        env_id = f"MiniGrid-{name}-v0"
        _, level = made(env_id, seed)
        certificate = brl.compare(level, f"minigrid:{env_id}", seed=seed)
        assert (certificate.equal, certificate.difference) == (True, None)


@pytest.mark.parametrize("name", ALIKE)
def test_a_plan_for_the_level_does_the_task_in_minigrid(name: str) -> None:
    for seed in SEEDS:
        env, level = made(f"{name}-v0", seed)
        env.max_steps = 10_000
        assert Player(env).play(plan_of(level)) > 0


def plan_of(level: Level) -> list[int]:
    """Return the actions of a shortest way to succeed, by turning and moving."""
    mdp = level.replace(rewards={"step": -1, "exit": 1000}).compile().turning(level.heading)
    (start,) = mdp.start.nonzero()[0].tolist()
    previous: dict[int, tuple[int, int]] = {start: (-1, -1)}
    waiting: list[int] = [start]
    for state in waiting:
        for action in range(3):
            ((_, after, reward, ends),) = mdp.outcomes(state, action)
            if ends and reward > 0:
                actions = [action]
                while previous[state][0] >= 0:
                    state, action = previous[state]
                    actions.append(action)
                return actions[::-1]
            if not ends and after not in previous:
                previous[after] = (state, action)
                waiting.append(after)
    raise AssertionError("the level cannot be done")


class Player:
    """Carries out a plan with MiniGrid's own actions, and a bag for what one hand cannot hold."""

    def __init__(self, env: Any):
        self.env = env
        self.bag: list[Any] = []
        self.reward, self.is_over = 0.0, False

    def play(self, plan: list[int]) -> float:
        """Return the reward of the last action."""
        for action in plan[:-1]:
            self.act(action)
        if hasattr(self.env, "target_pos"):
            # The agent stands next to its target.
            self.step(DONE)
        else:
            self.act(plan[-1])
        return self.reward

    def act(self, action: int) -> None:
        """Turn or move; on the way, open and pick up what is ahead."""
        ahead: Any = self.env.grid.get(*self.env.front_pos) if action == FORWARD else None
        if getattr(ahead, "contains", None) is not None:
            self.step(TOGGLE)
            ahead = ahead.contains
        if ahead is not None and ahead.type == "door" and not ahead.is_open:
            fitting = (each for each in self.bag if (each.type, each.color) == ("key", ahead.color))
            self.env.carrying = next(fitting, None)
            self.step(TOGGLE)
            self.env.carrying = None
        if ahead is not None and ahead.type in ("key", "ball", "box"):
            # BabyAI looks at what was in the hand before.
            self.step(DONE)
            self.step(PICK_UP)
            self.bag.append(self.env.carrying)
            self.env.carrying = None
        self.step(action)

    def step(self, action: int) -> None:
        """Take an action, unless the episode is over."""
        if not self.is_over:
            _, self.reward, self.is_over, _, _ = self.env.step(action)
