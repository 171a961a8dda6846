"""Agents that arguments of commands name."""

from __future__ import annotations

import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import babyrobot_levels as brl
from babyrobot_levels.cli.console import fail
from babyrobot_levels.cli.inputs import names_levels
from babyrobot_levels.text.words import NAMED

PLAYS = ".brlplay"
FITTING = "give --observation and --actions as those that the agent was made with"


@contextmanager
def blamed(word: str, *, is_reader: bool = False) -> Iterator[None]:
    """End the command if the code of a Python file raises an error, with its line.

    Args:
        word: what names the agent.
        is_reader: whether the agent reads and writes.
    """
    try:
        yield
    except Exception as error:
        file = str(Path(word.rpartition(":")[0]))
        frames = traceback.extract_tb(error.__traceback__)
        lines = [frame.lineno for frame in frames if frame.filename == file]
        if isinstance(error, SyntaxError) and error.filename == file:
            lines.append(error.lineno)
        if lines:
            fail(
                f"{file}:{lines[-1]}: the agent failed: {type(error).__name__}: {error}",
                None
                if is_reader or isinstance(error, SyntaxError | ImportError)
                else "without --sight, an agent gets observations, not texts",
            )
        raise


def named_agent(word: str, *, trust: bool, plays: bool = False) -> Any:
    """Return the agent that an argument names; end the command if there is none.

    Args:
        word: the name of a policy, or a file.
        trust: whether models may be loaded, which can run any code.
        plays: whether it may be a file of recorded episodes, too.
    """
    from babyrobot_levels.agents.agents import AgentError, load_agent

    if word in NAMED:
        return word
    try:
        if plays and Path(word).suffix.lower() == PLAYS:
            return brl.read_plays(Path(word))
        return load_agent(word, trust=trust)
    except AgentError as error:
        is_model = Path(word).is_file() and Path(word).suffix.lower() == ".zip" and not trust
        levels = [each for each in word.split(",") if names_levels(each)]
        told = f"before the level stands an agent: `babyrobot score random {' '.join(levels)}`"
        told = told if levels else error.help or ""
        fail(error.message, "if you trust its author, add --trust" if is_model else told)
    except brl.PlayError as error:
        fail(str(error))
    except OSError as error:
        fail(f"{word} cannot be read ({error.strerror or error})")


def table_of(agent: Any, level: brl.Level, *, observation: str, actions: str) -> Any:
    """Return the policy of an agent in a level as pictures show it; end the command without one."""
    names = tuple(observation.split(",")) if "," in observation else observation
    try:
        return brl.policy_table(level, agent, observation=names, actions=str(actions))
    except brl.UndefinedReturnError as error:
        fail(f"the level has no optimal policy: {error}")
    except (ValueError, TypeError) as error:
        fail(str(error).partition("\n")[0], FITTING if hasattr(agent, "predict") else None)
