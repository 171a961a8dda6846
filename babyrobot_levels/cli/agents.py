"""Agents that arguments of commands name."""

from __future__ import annotations

import sys
import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from runpy import run_path
from typing import TYPE_CHECKING, Any

from babyrobot_levels.cli.console import fail

if TYPE_CHECKING:
    from babyrobot_levels.library.level import Level

BEST, RANDOM = "best", "random"
PLAYS = ".brlplay"
AGENTS = (
    f"`{RANDOM}`, `{BEST}`, a policy (.json, .npy, .npz), a model (.zip), or what a Python file "
    "calls by a name (agent.py:name)"
)
FITTING = "give --observation and --actions as those that the agent was made with"

_TABLES = (".json", ".npy", ".npz")
_MODEL = ".zip"


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
                None if is_reader else "without --sight, an agent gets observations, not texts",
            )
        raise


def _code(path: Path, name: str) -> Any:
    """Return what a Python file calls by a name."""
    if not path.is_file():
        fail(f"there is no file {path}")
    # It can import what stands beside it, but nothing is imported from there in place of a library.
    sys.path.append(str(path.parent.resolve()))
    found = run_path(str(path))
    if name not in found:
        fail(f"{path} has nothing called {name!r}")
    return found[name]


def named_agent(word: str, *, trust: bool, plays: bool = False) -> Any:
    """Return the agent that an argument names; end the command if there is none.

    Args:
        word: the name of a policy, or a file.
        trust: whether models may be loaded, which can run any code.
        plays: whether it may be a file of recorded episodes, too.
    """
    from babyrobot_levels.language.play import PlayError
    from babyrobot_levels.scoring.agents import AgentError, load_model, load_policy
    from babyrobot_levels.scoring.plays import read_plays

    if word in (RANDOM, BEST):
        return word
    file, _, name = word.rpartition(":")
    if file.endswith(".py"):
        return _code(Path(file), name)
    path = Path(word)
    suffix = path.suffix.lower()
    if suffix == ".py":
        fail(f"{word} is a file of Python", f"name the agent in it, as in {word}:agent")
    if suffix not in (*_TABLES, _MODEL, *([PLAYS] if plays else [])):
        fail(f"there is no agent {word!r}", f"an agent is {AGENTS}")
    try:
        if suffix == PLAYS:
            return read_plays(path)
        if suffix == _MODEL and not trust:
            path.stat()
            fail(
                f"{word} is a model, and loading a model can run any code",
                "if you trust its author, add --trust",
            )
        return load_model(path) if suffix == _MODEL else load_policy(path)
    except AgentError as error:
        fail(str(error), error.help)
    except PlayError as error:
        fail(str(error))
    except OSError as error:
        fail(f"{word} cannot be read ({error.strerror or error})")


def table_of(agent: Any, level: Level, *, observation: str, actions: str) -> Any:
    """Return the policy of an agent in a level as pictures show it; end the command without one."""
    from babyrobot_levels.analysis.solver.optimum import solve
    from babyrobot_levels.analysis.solver.results import UndefinedReturnError
    from babyrobot_levels.scoring.policy_tables import policy_table

    names = tuple(observation.split(",")) if "," in observation else observation
    try:
        given = solve(level) if isinstance(agent, str) and agent == BEST else agent
        return policy_table(given, level, observation=names, actions=str(actions))
    except UndefinedReturnError as error:
        fail(f"the level has no optimal policy: {error}")
    except (ValueError, TypeError) as error:
        is_fixed = isinstance(agent, str | list)
        fail(str(error).partition("\n")[0], None if is_fixed else FITTING)
