"""Games that a level can be compared with, as tables: levels and Gymnasium's environments."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.library.catalogue import load
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.actions import Action
from babyrobot_levels.mdp.tables import Outcome
from babyrobot_levels.text.errors import BabyRobotError

LevelLike = str | os.PathLike[str] | Mapping[str, Any] | Level
Flags = NDArray[np.bool_]
Floats = NDArray[np.float64]

GYMNASIUM = "gymnasium:"
"""What the name of an environment begins with, where a level could be meant as well."""


class ComparisonError(BabyRobotError, ValueError):
    """What was given cannot be compared with a level."""


@dataclass(frozen=True, eq=False)
class Game:
    """The other's tables, as `Mdp` has them, but not sorted; and what its actions are called."""

    probability: Floats
    next_state: Floats
    reward: Floats
    terminal: Flags
    start: Floats
    names: tuple[str, ...]

    @property
    def over(self) -> Flags:
        """Where episodes end, `[states]`: what some outcome with `terminal` set leads to."""
        ends = self.next_state[self.terminal & (self.probability != 0)]
        return np.isin(np.arange(self.start.size), ends)

    def outcomes(self, state: int, action: int) -> list[Outcome]:
        """Return what an action can lead to, as listed."""
        tables = (self.probability, self.next_state, self.reward, self.terminal)
        rows = zip(*(table[state, action].tolist() for table in tables), strict=True)
        return [row for row in rows if row[0] != 0]


def fixed_level(level: LevelLike) -> Level:
    """Return a level of which there is only one.

    Raises:
        LevelNotFoundError: there is no such level.
        LevelError: the level is not valid.
        ComparisonError: it grows another maze at each reset.
    """
    loaded = load(level)
    if loaded.has_random_maze:
        raise ComparisonError(
            "each reset grows another maze of this level; compare one that says its seed"
        )
    return loaded


def game_of(other: Any, kwargs: Mapping[str, Any] | None = None) -> Game:
    """Return the tables of a level, an environment, its id, or a pair of table and starts.

    Raises:
        ComparisonError: there is no table, or none that can be read.
    """
    if isinstance(other, str) and other.startswith(GYMNASIUM):
        env = _made(other.removeprefix(GYMNASIUM), kwargs or {})
        try:
            return _game_of_environment(env)
        finally:
            env.close()
    if kwargs is not None:
        raise ComparisonError(f"keyword arguments are for environments, `{GYMNASIUM}ID`")
    if hasattr(other, "unwrapped"):
        return _game_of_environment(other)
    if isinstance(other, tuple) and len(other) == 2:
        return _game_of_table(*other)
    if isinstance(other, Mapping) and other and not any(isinstance(key, str) for key in other):
        raise _no_table("the starts are missing; give a pair of both")
    mdp = fixed_level(other).compile()
    names = tuple(action.name.lower() for action in Action)
    next_state = mdp.next_state.astype(np.float64)
    return Game(mdp.probability, next_state, mdp.reward, mdp.terminal, mdp.start, names)


def _made(name: str, kwargs: Mapping[str, Any]) -> Any:
    import gymnasium

    try:
        return gymnasium.make(name, **kwargs)
    except gymnasium.error.Error as error:
        raise ComparisonError(str(error)) from error
    except Exception as error:  # What an environment's own code raises can be anything.
        told = f"{type(error).__name__}: {error}"
        raise ComparisonError(f"Gymnasium cannot make {name!r}: {told}") from error


def _game_of_environment(env: Any) -> Game:
    inner = env.unwrapped
    table, start = (getattr(inner, name, None) for name in ("P", "initial_state_distrib"))
    if table is None or start is None:
        name = env.spec.id if getattr(env, "spec", None) else type(inner).__name__
        raise ComparisonError(
            f"{name} has no table of its outcomes (`P` and `initial_state_distrib`)"
        )
    return _game_of_table(table, start)


def _game_of_table(table: Any, start: Any) -> Game:
    try:
        counts = {len(table[state]) for state in range(len(table))}
        (count,) = counts if len(counts) == 1 else (0,)
        rows = [[list(table[s][a]) for a in range(count)] for s in range(len(table))]
        longest = max((len(row) for actions in rows for row in actions), default=0)
        # Padding has probability 0, and so cannot happen.
        full = [
            [[*row, *[(0, 0, 0, 0)] * (longest - len(row))] for row in actions] for actions in rows
        ]
        numbers = np.array(full, np.float64).reshape(len(rows), count, longest, 4)
        starts = np.array(start, np.float64)
    except (LookupError, TypeError, ValueError) as error:
        raise _no_table(f"{type(error).__name__}: {error}") from error
    if not numbers.size:
        raise _no_table("each state needs the same actions, and these need outcomes")
    if not (np.isfinite(numbers).all() and np.isfinite(starts).all()):
        raise _no_table("not all of its numbers are finite")
    if starts.shape != (len(rows),):
        raise _no_table(f"{len(rows)} states need as many probabilities of starts")
    probability, next_state, reward, terminal = np.moveaxis(numbers, -1, 0)
    names = tuple(f"action {number}" for number in range(count))
    return Game(probability, next_state, reward, terminal != 0, starts, names)


def _no_table(why: str) -> ComparisonError:
    return ComparisonError(
        "this is no table {state: {action: [(probability, next state, reward, terminal)]}} "
        f"with the probability of each start: {why}"
    )
