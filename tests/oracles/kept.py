"""Record what files, seeds and ids stand for, so that it stays: `python tests/oracles/kept.py`.

`kept.json` and `kept.brlpack` were recorded once; `tests/e2e/test_compatibility.py` holds today's
code against them. An entry is recorded anew only if the changelog says that it has changed.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np

import babyrobot_levels as brl

FILE = Path(__file__).with_suffix(".json")
SUITES = (
    *("bench-easy", "bench-hard", "bench-keys", "locked-mazes", "long-ways", "small-mazes"),
    *("wet-mazes", "text-easy", "text-hard"),
)
PLAYED = (
    *("final-maze", "default", "glasshouse", "windy-gridworld", "frozen-lake", "random-maze"),
    *("two-doors", "ice-rink", "night-watch", "two-levers", "treasure-chests"),
)
STEPS = 20
CONDITIONS: dict[str, dict[str, Any]] = {
    "plain": {"size": [6, 5]},
    "wet": {"size": {"min": [4, 4], "max": [7, 7]}, "puddles": {"min": 1, "max": 4}},
    "loops": {"size": [7, 7], "maze": {"algorithm": "wilson", "loops": 0.5}, "exit": "farthest"},
    "locked": {"size": [6, 6], "keys": 1, "coins": 2},
    "windy": {"size": [6, 6], "wind": {"min": 1, "max": 2}},
}
"""Fields of suites of which levels are generated."""


def levels() -> dict[str, brl.Level]:
    """Return the levels of the gallery, those with random mazes with a seed."""
    found = {info.name: brl.load(info.name) for info in brl.levels()}
    return {
        name: level.with_maze_seed(7) if level.has_random_maze else level
        for name, level in found.items()
    }


def kept() -> dict[str, Any]:
    """Return all that has to stay, by kind."""
    gallery = levels()
    return {
        "digests": {name: level.digest for name, level in gallery.items()},
        "share codes": {name: level.share_code() for name, level in gallery.items()},
        "suites": {
            name: [brl.load_suite(name)[number].digest for number in (0, 1, 99)] for name in SUITES
        },
        "generated": {name: generated(fields) for name, fields in CONDITIONS.items()},
        "episodes": episodes(),
        "environment ids": sorted(name for name in gymnasium.registry if "babyrobot/" in name),
    }


def generated(fields: Mapping[str, Any]) -> list[str]:
    """Return the digests of the first levels of a suite."""
    head = {"version": 1, "kind": "suite", "name": "some", "seed": 5, "count": 3}
    suite = brl.load_suite({**head, **fields})
    return [level.digest for level in suite]


def episodes() -> dict[str, Any]:
    """Return the first steps of seeded episodes of some levels, alone and as vectors."""
    found: dict[str, Any] = {}
    for name in PLAYED:
        found[name] = _steps(gymnasium.make("babyrobot/Level-v0", level=name))
        vector = gymnasium.make_vec("babyrobot/Level-v0", num_envs=3, level=name)
        found[f"{name} (vector)"] = _vector_steps(vector)
    found["small-mazes"] = _steps(gymnasium.make("babyrobot/Suite-v0", suite="small-mazes"))
    suite = gymnasium.make_vec("babyrobot/Suite-v0", num_envs=3, suite="small-mazes")
    found["small-mazes (vector)"] = _vector_steps(suite)
    return found


def _steps(env: Any) -> list[Any]:
    observation, info = env.reset(seed=11)
    found: list[Any] = [_plain(observation)]
    for step in range(STEPS):
        actions = np.flatnonzero(info["action_mask"])
        result = env.step(actions[step * 7 % len(actions)])
        info = result[4]
        found.append(_plain(result[:4]))
        if result[2] or result[3]:
            observation, info = env.reset()
            found.append(_plain(observation))
    env.close()
    return found


def _vector_steps(envs: Any) -> list[Any]:
    observation, info = envs.reset(seed=11)
    found: list[Any] = [_plain(observation)]
    for step in range(STEPS):
        rows = [np.flatnonzero(row) for row in info["action_mask"]]
        actions = [row[step * 7 % len(row)] if len(row) else 0 for row in rows]
        *result, info = envs.step(np.array(actions))
        found.append(_plain(result))
    envs.close()
    return found


def _plain(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {key: _plain(each) for key, each in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(each) for each in value]
    return value.tolist() if isinstance(value, np.ndarray | np.generic) else value


def record() -> None:
    """Write the file, an entry a line."""
    text = json.dumps(kept(), separators=(",", ":")).replace("}", "}\n").replace('",', '",\n')
    FILE.write_text(text + "\n", encoding="utf-8")


if __name__ == "__main__":
    record()
