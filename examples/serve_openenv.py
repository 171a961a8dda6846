"""Levels as an OpenEnv environment, which plays over the network: python examples/serve_openenv.py

A task is a level of a split of the suite; the reward of a step is its exact advantage. It needs the
extra `openenv`: pip install ".[openenv]"
"""

from __future__ import annotations

import argparse
from typing import Any, Literal

import uvicorn
from arguments import at_least, suite_of
from fastapi import FastAPI
from openenv.core import Action, Environment, Observation, State, create_fastapi_app

import babyrobot_levels as brl


class Move(Action):
    move: Literal["north", "east", "south", "west", "wait"]


class Seen(Observation):
    text: str
    picture: str | None = None  # a data URL, with --sight picture


class Levels(Environment[Move, Seen, State]):
    """Each session has a robot of its own, in the level that its `reset` names."""

    SUPPORTS_CONCURRENT_SESSIONS = True

    def __init__(self, suite: brl.Suite, sight: str) -> None:
        super().__init__()
        self._suite, self._state = suite, State()
        self._world = brl.TextWorld(suite[0], sight=sight, reward="advantage")

    def reset(
        self,
        seed: int | None = None,
        episode_id: str | None = None,
        *,
        split: str = "train",
        index: int = 0,
        **others: Any,
    ) -> Seen:
        self._state = State(episode_id=episode_id)
        text = self._world.reset(seed=seed, level=self._suite.split(split)[index])
        return Seen(text=text, picture=self._world.data_url)

    def step(self, action: Move, timeout_s: float | None = None, **others: Any) -> Seen:
        world, before = self._world, self._world.reward
        text = world.wait() if action.move == "wait" else world.move(action.move)
        self._state.step_count = len(world.moves)
        reward, done = world.reward - before, world.done
        return Seen(text=text, picture=world.data_url, reward=reward, done=done)

    @property
    def state(self) -> State:
        return self._state

    def list_splits(self) -> list[str]:
        return [*self._suite.splits]

    def num_tasks(self, split: str) -> int:
        return len(self._suite.split(split))

    def get_task(self, split: str, index: int) -> dict[str, Any]:
        return {"id": self._suite.split(split)[index].digest, "split": split, "index": index}


def app_of(suite: brl.Suite, sight: str = "map") -> FastAPI:
    return create_fastapi_app(
        lambda: Levels(suite, sight), Move, Seen, max_concurrent_envs=64, env_name="levels"
    )


app = app_of(brl.load_suite("text-easy"))
"""What `openenv.yaml` names."""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--suite", type=suite_of, default="text-easy", help="a name or a path")
    parser.add_argument("--sight", choices=("map", "view", "words", "picture"), default="map")
    parser.add_argument("--port", type=at_least(0), default=8000)
    args = parser.parse_args()
    uvicorn.run(app_of(args.suite, args.sight), port=args.port)


if __name__ == "__main__":
    main()
