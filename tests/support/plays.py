"""Plays for tests: recorded, and forged with a checksum that is right."""

from __future__ import annotations

import json
import zlib
from pathlib import Path
from typing import Any

import numpy as np

import babyrobot_levels as brl


def record(path: Path, level: Any, actions: str = "all", episodes: int = 1, seed: int = 0) -> None:
    """Record episodes of a random policy."""
    env = brl.RecordPlay(brl.load(level).make(actions=actions), path)
    random = np.random.default_rng(seed)
    for number in range(episodes):
        _, info = env.reset(seed=seed + number)
        is_over = False
        while not is_over:
            action = random.choice(np.flatnonzero(info["action_mask"]))
            _, _, terminated, truncated, info = env.step(action)
            is_over = terminated or truncated
    env.close()


def recorded(folder: Path, level: Any, actions: str = "all", seed: int = 0) -> brl.Play:
    """Return the play of one episode of a random policy."""
    path = folder / f"{seed}.brlplay"
    record(path, level, actions, seed=seed)
    (play,) = brl.read_plays(path)
    return play


def line_of(data: dict[str, Any]) -> bytes:
    """Return a line with a checksum that fits."""
    body = json.dumps({name: data[name] for name in data if name != "checksum"})[:-1].encode()
    return body + f',"checksum":"{zlib.crc32(body):08x}"}}\n'.encode()


def forged(play: brl.Play, **changes: Any) -> brl.Play:
    """Return a play with other fields."""
    data = json.loads(play.to_line())
    return brl.Play.from_line(line_of({**data, **changes}))
