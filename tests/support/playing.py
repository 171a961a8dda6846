"""Playing environments: levels that are read once, episodes as plain data, and ways to an end."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from functools import cache
from itertools import chain, cycle, islice, product
from typing import Any

import gymnasium
import numpy as np
import pytest

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

EIGHT_MOVES = ("windy-gridworld-king", "windy-gridworld-stochastic")
"""The levels of the gallery whose robot does not turn, as it moves diagonally."""

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
    "things of all kinds": {
        "version": 1,
        "size": [5, 4],
        "start": [[0, 0], [0, 3]],
        "heading": "S",
        "exit_one_of": [[4, 0], [4, 3]],
        "exit_needs": "gem",
        "walls": [{"at": [2, 0], "side": "E"}, {"at": [2, 3], "side": "E"}],
        "items": [
            {"name": "key", "at": [1, 0]},
            {"name": "gem", "one_of": [[3, 1], [3, 2]], "reward": 2},
        ],
        "doors": [{"at": [2, 1], "side": "E", "length": 2, "needs": "key", "unless": "lever"}],
        "switches": [{"name": "lever", "at": [0, 1]}],
        "movers": [
            {"name": "guard", "path": [[1, 2], [2, 2]], "back": True},
            {"within": {"at": [3, 0], "size": [2, 2]}, "start": [3, 0]},
        ],
        "areas": [{"at": [2, 0], "skid": 0.3}],
    },
    "an item under a start, and hits that do not end": {
        "version": 1,
        "size": [3, 2],
        "start": [[0, 0], [2, 0]],
        "exit": "none",
        "items": [{"name": "coin", "one_of": [[0, 0], [1, 1]], "reward": 3}],
        "switches": [{"name": "lamp", "at": [2, 1], "once": True, "on": True}],
        "movers": [{"path": [[1, 0], [1, 1]]}],
        "hit": {"reward": -4, "ends": False},
    },
    "random mazes with things": {
        "version": 1,
        "size": [4, 3],
        "exit": [3, 0],
        "exit_needs": "key",
        "maze": {"seed": "random"},
        "items": [{"name": "key", "one_of": [[1, 1], [2, 1]]}],
        "movers": [{"within": {"at": [1, 2], "size": [2, 1]}}],
    },
}
"""Levels with features that no level of the gallery has."""

FEATURES = {
    **dict.fromkeys(CORNERS, "what their names say"),
    "final-maze": "puddles and walls in a maze",
    "frozen-lake": "skidding, cells that end the episode, a time limit",
    "four-corners": "several starts",
    "teleport-pads": "warps",
}
"""A level for each feature that environments could get wrong, for tests of all combinations."""


def each_level_and(*parameters: tuple[str, Sequence[Any]]) -> pytest.MarkDecorator:
    """Parametrise a test by `name` and parameters, so that no cross product of all is needed.

    The levels of `FEATURES` come with every value of each parameter; further combinations of
    values are a sweep, and so are the gallery's other levels with one robot that has four moves,
    once each.
    """
    combinations = list(product(*(values for _, values in parameters)))
    few = zip(FEATURES, *(cycle(values) for _, values in parameters), strict=False)
    cases = [pytest.param(*case) for case in few]
    others = (name for name in GALLERY if name not in FEATURES)
    rest = [name for name in others if GALLERY[name].parent.name != "robots"]
    rest = [name for name in rest if name not in EIGHT_MOVES]
    names = chain(islice(cycle(FEATURES), len(combinations)), rest)
    cases += [
        pytest.param(name, *values, marks=pytest.mark.sweep)
        for name, values in zip(names, cycle(combinations), strict=False)
    ]
    return pytest.mark.parametrize(("name", *(name for name, _ in parameters)), cases)


@cache
def level_named(name: str) -> Level:
    """Return a level of `GALLERY` or `CORNERS`, the same one each time."""
    return load(GALLERY[name]) if name in GALLERY else load(CORNERS[name])


def plain(observation: Any) -> Any:
    """Return an observation as data that can be compared with `==`."""
    if isinstance(observation, dict):
        return {name: plain(each) for name, each in observation.items()}
    if isinstance(observation, np.ndarray):
        return str(observation.dtype), observation.shape, observation.tobytes()
    return type(observation), observation


def noted(info: dict[str, Any]) -> dict[str, Any]:
    """Return an info as data that can be compared with `==`."""
    return {
        key: plain(value) if isinstance(value, dict | np.ndarray) else value
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
        if all(outcomes == [(1.0, state, 0.0, True)] for outcomes in actions.values()):
            ends.add(state)
        for action, outcomes in actions.items():
            for probability, next_state, _, _ in outcomes:
                before.setdefault(next_state, set()).add((-probability, state, action))
    policy: dict[int, int] = {}
    queue = deque(sorted(ends))
    while queue:
        for _, state, action in sorted(before.get(queue.popleft(), ())):
            if state not in policy and state not in ends:
                policy[state] = action
                queue.append(state)
    return policy
