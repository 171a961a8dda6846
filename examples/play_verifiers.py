"""Language models play levels in verifiers: python examples/play_verifiers.py -m MODEL --no-push

It has the options of `vf-eval`: --client.base-url names a server with an interface like OpenAI's,
-n how many levels are played; --help tells all. The reward of an episode is the sum of the exact
advantages of its moves, which is minus its regret. It needs the extra `verifiers`:
pip install ".[verifiers]"
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from typing import Literal

import verifiers.v1 as vf
from verifiers.v1.cli.eval.main import main

import babyrobot_levels as brl

__all__ = ["Episodes", "Levels"]

PROMPT = (
    "Play this level. Answer each time with north, east, south, west or wait, and nothing else."
)


class LevelsConfig(vf.TasksetConfig):
    suite: str = "text-easy"
    split: str = "validation"
    sight: Literal["map", "view", "words", "picture"] = "map"
    seed: int = 0


class LevelData(vf.TaskData):
    level: str
    sight: str
    seed: int


class LevelTask(vf.Task[LevelData]):
    """An episode in a level."""


class Levels(vf.Taskset[LevelTask, LevelsConfig]):
    """The levels of a suite, by their share codes: --env.taskset.suite text-hard."""

    def load(self) -> Iterator[LevelTask]:
        config = self.config
        for level in brl.load_suite(config.suite).split(config.split):
            data = LevelData(
                name=level.digest,
                system_prompt=PROMPT,
                level=level.share_code(),
                sight=config.sight,
                seed=config.seed,
            )
            yield LevelTask(data, config.task)


def message_of(text: str, data_url: str | None) -> vf.UserMessage:
    """Return what is told, with the picture if there is one."""
    if data_url is None:
        return vf.UserMessage(content=text)
    picture = vf.ImageUrlContentPart(image_url=vf.ImageUrlSource(url=data_url))
    return vf.UserMessage(content=[vf.TextContentPart(text=text), picture])


class EpisodesConfig(vf.EnvConfig):
    player: vf.AgentConfig = vf.AgentConfig(
        # A model that only answers, so it needs no container.
        harness={"id": "null"},
        runtime=vf.SubprocessConfig(),
        # After so many replies, also invalid ones, the robot waits until the end.
        max_turns=200,
    )


class Episodes(vf.Env[EpisodesConfig]):
    """The level is the user of the conversation: it answers each move with what is seen."""

    async def run(self, task: LevelTask, agents: vf.Agents) -> None:
        world = brl.TextWorld(task.data.level, sight=task.data.sight, reward="advantage")
        shown = world.reset(seed=task.data.seed)
        async with agents.player.interaction(task) as interaction:
            while not world.done:
                segment = await interaction.turn([message_of(shown, world.data_url)])
                if segment.terminated:
                    break
                word = segment.last_reply.lower()
                shown = world.wait() if word == "wait" else world.move(word)
        while not world.done:
            world.wait()
        trace = interaction.trace
        trace.record_reward("advantage", world.reward)
        trace.record_metrics({"success": world.is_success, "invalid": world.invalid})


if __name__ == "__main__":
    # The module that verifiers loads by its name is this file.
    main(["play_verifiers", *sys.argv[1:]])
