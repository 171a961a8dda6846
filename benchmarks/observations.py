"""Symbolic observations: the planes of a maze beside MiniGrid's arrays of cells.

    python benchmarks/observations.py

1,024 environments of 8x8 cells take random actions, drawn in advance. Ours is a vector environment
with planes of a maze; MiniGrid's environments step one by one in Gymnasium's SyncVectorEnv, with
the wrappers FullyObsWrapper and ImgObsWrapper (the whole room), or ImgObsWrapper alone (the 7x7
cells before the robot). MiniGrid has a virtual environment of its own, which the first run creates.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from typing import Any

import numpy as np
import report
from peers import Peer
from timing import Comparison, Measure, compare_in_turns, installed

import babyrobot_levels as brl

NUM_ENVS = 1024
SIZE = 8
STEPS = 200
PEER_STEPS = 5
LEVEL = {"version": 1, "size": [SIZE, SIZE], "maze": {"seed": 1, "loops": 0.2}}
AIM = 1e6
"""The least steps per second of float32 planes."""


def ours(**given: Any) -> Measure:
    """Return a measure of the steps per second of a vector environment."""
    envs = brl.LevelVectorEnv(LEVEL, num_envs=NUM_ENVS, actions="moves", **given)
    actions = np.random.default_rng(0).integers(4, size=(STEPS, NUM_ENVS))

    def measure() -> float:
        envs.reset(seed=1)
        begin = time.perf_counter()
        for action in actions:
            envs.step(action)
        return STEPS * NUM_ENVS / (time.perf_counter() - begin)

    measure()  # paints the maze
    return measure


def minigrid(peer: Peer, whole: bool) -> Measure:
    """Return a measure of MiniGrid's steps per second."""
    question = {"num_envs": NUM_ENVS, "steps": PEER_STEPS, "size": [SIZE, SIZE], "whole": whole}
    return lambda: PEER_STEPS * NUM_ENVS / float(peer.ask(**question)["seconds"])


def compare(count: int) -> Iterator[Comparison]:
    """Measure planes in two types, with and without copies, and vectors."""
    peer = Peer("minigrid", "peer_minigrid.py")
    planes = {
        f"planes, {dtype}{'' if copy else ', no copies'}": ours(
            observation="planes", planes_dtype=dtype, copy=copy
        )
        for dtype in ("float32", "uint8")
        for copy in (True, False)
    }
    yield compare_in_turns(
        f"steps per second, {NUM_ENVS:,} of {SIZE}x{SIZE}",
        {**planes, "vector": ours(observation="vector")},
        {
            "MiniGrid, FullyObs and ImgObs": minigrid(peer, whole=True),
            "MiniGrid, ImgObs": minigrid(peer, whole=False),
        },
        count,
        aims={(name, None): AIM for name in planes},
        versions=installed("babyrobot-levels", "gymnasium", "numpy", "numba") | peer.version,
    )
    peer.close()


if __name__ == "__main__":
    report.main(__doc__, compare)
