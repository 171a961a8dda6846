"""Agents that read and write: their episodes in levels, graded without the luck of the outcomes."""

import os
import re
from collections.abc import Callable
from copy import deepcopy
from pathlib import Path
from typing import Any

import numpy as np

from babyrobot_levels.agents.plays import append_play, check_appendable
from babyrobot_levels.extensions.scoring.results import Played
from babyrobot_levels.extensions.scoring.text_world import MOVES, TextWorld
from babyrobot_levels.library.level import Level
from babyrobot_levels.text.words import listed

INSTRUCTION = (
    "Answer with {}. Only the last line of your answer is read, and it must have nothing else."
)

MOST_INVALID = 3
"""After so many invalid replies one after the other, the robot waits for a step."""

_WAITING = ("wait", "stay")
_REPLY = re.compile(rf"\W*(?:move |go )?({'|'.join((*MOVES, *_WAITING))})\W*", re.IGNORECASE)
_LONGEST = 200
"""The most characters of the last line of a reply."""


def move_of(reply: Any) -> str | None:
    """Return the move that a reply names in its last line, or `"wait"`; None if it names none."""
    lines = reply.strip().splitlines() if isinstance(reply, str) else []
    found = _REPLY.fullmatch(lines[-1][:_LONGEST]) if lines else None
    if found is None:
        return None
    word = found[1].lower()
    return "wait" if word in _WAITING else word


def content_of(text: str, data_url: str | None) -> str | list[dict[str, Any]]:
    """Return the content of a message: its text, or if a picture goes with it, both as parts.

    The parts are those of OpenAI's chat completions.
    """
    if data_url is None:
        return text
    return [{"type": "text", "text": text}, {"type": "image_url", "image_url": {"url": data_url}}]


class Conversation:
    """An agent in an episode: it gets texts, and answers with moves.

    Args:
        agent: a function from a text to a reply, which gets the rules and what is seen each time,
            in a world of pictures also the pixels; or with `chat`, from all messages so far.
        world: the world, in which an episode has begun.
        rules: what `reset` returned.
        chat: whether the agent gets messages.
    """

    def __init__(
        self, agent: Callable[..., Any], world: TextWorld, rules: str, *, chat: bool
    ) -> None:
        self._agent, self._world, self._chat = agent, world, chat
        self._rules = rules.removesuffix(world.look())
        self._asked = INSTRUCTION.format(listed([*world.directions, "wait"], "or"))
        self._messages: list[dict[str, Any]] = []

    def play(self) -> None:
        """Play the episode to its end."""
        world, shown, invalid = self._world, self._world.look(), 0
        while not world.done:
            word = move_of(self._reply(shown))
            if word is None and invalid < MOST_INVALID - 1:
                invalid += 1
                world.invalid += 1
                shown = f"That is no move, and nothing happened.\n{world.look()}"
                continue
            world.invalid += word is None
            waits, invalid = word in (None, "wait"), 0
            shown = world.wait() if waits else world.move(str(word))

    def _reply(self, shown: str) -> Any:
        """Return what the agent answers."""
        if not self._chat:
            pixels = self._world.pixels
            seen = () if pixels is None else (pixels,)
            return self._agent(f"{self._rules}{shown}\n{self._asked}", *seen)
        begins = f"{self._rules}{self._asked}\n\n" if not self._messages else ""
        content = content_of(begins + shown, self._world.data_url)
        self._messages.append({"role": "user", "content": content})
        reply = self._agent(deepcopy(self._messages))
        self._messages.append({"role": "assistant", "content": str(reply)})
        return reply


def converse(
    agent: Callable[..., Any],
    level: Level,
    sight: str,
    *,
    chat: bool,
    limit: int,
    seeds: list[int],
    record: str | os.PathLike[str] | None,
) -> tuple[tuple[float, float, float], Played]:
    """Return what an agent that reads and writes earned, and its episodes.

    Returns are told without luck: the optimum less the regret of an episode. Their mean is that of
    the returns, because luck is 0 on average, but they vary less.

    Args:
        agent: see `Conversation`.
        level: the level.
        sight: what it sees; see `TextWorld`.
        chat: whether it gets messages.
        limit: after how many steps an episode is over.
        seeds: the seed of each episode.
        record: a file to which plays are appended as they end.

    Returns:
        The means of returns, of success and of steps; and the returns.
    """
    if record is not None:
        check_appendable(Path(record))
    world = TextWorld(level, sight=sight, within=limit)
    rows = []
    for seed in seeds:
        Conversation(agent, world, world.reset(seed=seed), chat=chat).play()
        if record is not None:
            append_play(Path(record), world.play)
        rows.append((world.regret, world.is_success, len(world.moves), world.invalid))
    table, best = np.array(rows, float), world.optimum
    returns = best - table[:, 0]
    _, success, steps, invalid = table.mean(axis=0).tolist()
    played = Played(returns, best - world.largest_regret, best, invalid)
    return (float(returns.mean()), success, steps), played
