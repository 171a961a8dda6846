"""Frames for videos and agents: a step, and the picture after it as an array of pixels.

    python benchmarks/frames.py

All pictures are new arrays (`rgb_array`) of 8 by 5 cells of 64 pixels. MiniGrid draws an empty
room, its simplest picture, and FrozenLake a lake of that size; ours is the final maze, with walls
and puddles. MiniGrid needs another version of pygame than the tests, so it runs in a virtual
environment of its own, which the first run creates.
"""

from __future__ import annotations

import random
import time
from collections.abc import Iterator
from typing import Any

import gymnasium
import report
from peers import Peer
from timing import Comparison, Measure, compare_in_turns, installed

import babyrobot_levels as brl

SIZE = (8, 5)
CELL = 64
LAKE = ["SFFFFFFF", "FFFHFFFF", "FFFFFHFF", "FHFFFFFF", "FFFHFFFG"]
FRAMES = 10_000
FEWER = 200
"""The number of frames of the peers, so that all measurements take about as long."""


def drawing(env: gymnasium.Env[Any, Any], first_action: int, count: int) -> Measure:
    """Return a measure of the frames per second of an environment with four moves."""
    rng = random.Random(0)
    actions = [first_action + rng.randrange(4) for _ in range(count)]

    def measure() -> float:
        env.reset(seed=0)
        begin = time.perf_counter()
        for action in actions:
            _, _, terminated, truncated, _ = env.step(action)
            env.render()
            if terminated or truncated:
                env.reset()
        return count / (time.perf_counter() - begin)

    return measure


def asking(peer: Peer, highlight: bool) -> Measure:
    """Return a measure of MiniGrid's frames per second, with or without the agent's field of view.

    MiniGrid highlights the field of view by default.
    """
    question = {"size": SIZE, "tile": CELL, "frames": FEWER}
    return lambda: FEWER / float(peer.ask(**question, highlight=highlight)["seconds"])


def shown(env: gymnasium.Env[Any, Any]) -> str:
    """Return the size of an environment's pictures, in pixels."""
    env.reset(seed=0)
    height, width, _ = env.render().shape  # type: ignore[union-attr]
    return f"{width}x{height}"


def compare(count: int) -> Iterator[Comparison]:
    """Measure pictures of our maze and those of the peers."""
    level = brl.load("final-maze").replace(display={})
    plain, written = level.make(render_mode="rgb_array"), level.make(render_mode="rgb_array")
    best = brl.solve(level)
    written.unwrapped.show_info({"values": best.values, "policy": best.policy})  # type: ignore[attr-defined]
    lake = gymnasium.make("FrozenLake-v1", desc=LAKE, render_mode="rgb_array")
    peer = Peer("minigrid", "peer_minigrid.py")
    room = f"MiniGrid, a room, {SIZE[0] * CELL}x{SIZE[1] * CELL}"
    maze = f"the final maze, {shown(plain)}"
    yield compare_in_turns(
        "frames per second",
        {
            maze: drawing(plain, 1, FRAMES),
            "the final maze, with values and arrows": drawing(written, 1, FRAMES),
        },
        {
            room: asking(peer, highlight=True),
            "MiniGrid, no field of view": asking(peer, highlight=False),
            f"FrozenLake-v1, {shown(lake)}": drawing(lake, 0, FEWER),
        },
        count,
        aims={(maze, room): 10},
        versions={
            **installed("babyrobot-levels", "gymnasium", "numpy", "pygame-ce"),
            **peer.version,
        },
    )
    peer.close()


if __name__ == "__main__":
    report.main(__doc__, compare)
