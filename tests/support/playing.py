"""Playing environments: levels that are read once, episodes as plain data, and ways to an end."""

from __future__ import annotations

from collections import deque
from functools import cache
from typing import Any

import gymnasium
import numpy as np

from babyrobot_levels.library.catalogue import load
from babyrobot_levels.library.level import Level
from support.places import GALLERY_FOLDER

Env = gymnasium.Env[Any, Any]
Table = dict[int, dict[int, list[tuple[float, int, float, bool]]]]
Step = tuple[Any, ...]

GALLERY = {
    path.stem: path
    for path in sorted(GALLERY_FOLDER.rglob("*.yaml"))
    if path.parent.name not in ("themes", "suites")
}

CORNERS: dict[str, dict[str, Any]] = {
    "one cell, no exit": {"version": 1, "size": [1, 1], "exit": "none"},
    "a start that is shut in": {
        "version": 1,
        "size": [2, 1],
        "walls": [{"at": [0, 0], "side": "E"}],
    },
    "random mazes with several starts": {
        "version": 1,
        "size": [4, 3],
        "start": [[0, 0], [3, 0], [0, 2]],
        "maze": {"seed": "random", "loops": 0.5},
        "skid": {"probability": 0.3, "to": "others"},
    },
    "all at once": {
        "version": 1,
        "size": [5, 4],
        "start": [[0, 0], [0, 3]],
        "exit": [[4, 0], [4, 3]],
        "walls": [{"at": [1, 0], "side": "E", "length": 2, "pass": 0.4}],
        "puddles": [{"at": [1, 1], "size": "large"}],
        "areas": [{"at": [3, 1], "ends": True, "reward": -9}, {"at": [0, 1], "skid": 0.5}],
        "blocked": [{"at": [2, 3]}],
        "warps": [
            {"at": [2, 0], "to": "start", "reward": -5},
            {"at": [4, 2], "to": [0, 0], "when": "leave"},
        ],
        "wind": {"north": [0, 0, 0, 1, 0]},
        "rewards": {"bump": -2, "stay": -0.25, "bounce": -3},
        "max_steps": 25,
    },
}
"""Worlds that the gallery has none of, because they are no fun to play."""


@cache
def level_named(name: str) -> Level:
    """Return a level of `GALLERY` or `CORNERS`, the same one each time."""
    return load(GALLERY[name]) if name in GALLERY else load(CORNERS[name])


def plain(observation: Any) -> Any:
    """Return an observation as data that can be compared with `==`."""
    if isinstance(observation, np.ndarray):
        return str(observation.dtype), observation.shape, observation.tobytes()
    return type(observation), observation


def noted(info: dict[str, Any]) -> dict[str, Any]:
    """Return an info as data that can be compared with `==`."""
    return {
        key: value.tolist() if isinstance(value, np.ndarray) else value
        for key, value in info.items()
    }


def spoil(observation: Any, info: dict[str, Any]) -> None:
    """Overwrite all that can be overwritten of what an environment has returned."""
    for value in (observation, *info.values()):
        if isinstance(value, np.ndarray):
            value[...] = 1 - value
    info.clear()


def walk(env: Env, steps: int, spoiling: bool = False) -> list[Step]:
    """Take sampled actions, beginning anew wherever an episode ends, and note all that happens."""
    told: list[Step] = []
    done = False
    for _ in range(steps):
        if done:
            observation, info = env.reset()
            told.append((plain(observation), noted(info)))
            if spoiling:
                spoil(observation, info)
        action = env.action_space.sample()
        observation, reward, terminated, truncated, info = env.step(action)
        done = terminated or truncated
        told.append((int(action), plain(observation), reward, terminated, truncated, noted(info)))
        if spoiling:
            spoil(observation, info)
            spoil(None, {"masks": env.get_wrapper_attr("action_masks")()})
    return told


def episodes(env: Env, seed: int, steps: int = 25, spoiling: bool = False) -> list[Step]:
    """Reset with a seed, for the actions too, and note all that happens from there on."""
    env.action_space.seed(seed)
    observation, info = env.reset(seed=seed)
    told: list[Step] = [(plain(observation), noted(info))]
    if spoiling:
        spoil(observation, info)
    return told + walk(env, steps, spoiling)


def way_out(table: Table) -> dict[int, int]:
    """Return the action most likely to lead nearer to an end, for states that can reach one."""
    before: dict[int, set[tuple[float, int, int]]] = {}
    ends = set()
    for state, actions in table.items():
        for action, outcomes in actions.items():
            for probability, next_state, _, terminal in outcomes:
                before.setdefault(next_state, set()).add((-probability, state, action))
                if terminal:
                    ends.add(next_state)
    policy: dict[int, int] = {}
    queue = deque(sorted(ends))
    while queue:
        for _, state, action in sorted(before.get(queue.popleft(), ())):
            if state not in policy and state not in ends:
                policy[state] = action
                queue.append(state)
    return policy
