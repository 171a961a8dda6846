"""Grades: the plays of several files in a table, beside the exact optimum."""

from __future__ import annotations

import math
import os
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from functools import lru_cache
from hashlib import sha256
from itertools import chain
from pathlib import Path
from typing import Any

from babyrobot_levels.analysis.solver.policies import space_of
from babyrobot_levels.analysis.solver.results import EpisodeTooLongError, UndefinedReturnError
from babyrobot_levels.language.play import PlayError
from babyrobot_levels.library.catalogue import load
from babyrobot_levels.library.level import Level
from babyrobot_levels.scoring.decisions import decisions_of
from babyrobot_levels.scoring.plays import Play, read_plays
from babyrobot_levels.scoring.results import Table, plain
from babyrobot_levels.scoring.score import score
from babyrobot_levels.scoring.verify import verify_play
from babyrobot_levels.text.words import listed

_Conditions = tuple[str, str, int | None, float]
"""Of plays that are compared: digest, set of actions, time limit, discount."""

_LINE = re.compile(r"^(\d+):")


@dataclass(frozen=True, slots=True)
class Bounds:
    """What returns of episodes in a level are compared with.

    Attributes:
        optimum: the optimal expected return under the conditions of the play; nan where it has
            none, as in a level without an exit and without a time limit.
        random: the expected return of the random policy.
    """

    optimum: float
    random: float

    def share(self, earned: float) -> float:
        """Return how much of the way from the random policy to the optimum a return covers.

        It is nan where there is no way, and can be above 1: single episodes can be lucky.
        """
        way = self.optimum - self.random
        scale = max(1.0, abs(self.optimum))
        if not math.isfinite(way) or way <= 1e-9 * scale:
            return math.nan
        return (earned - self.random) / way


def bounds_of(play: Play) -> Bounds:
    """Return what the return of a valid play is compared with: its level, limit and actions."""
    return _bounds(play.level, play.digest, play.action_set, play.max_steps, play.discount)


@lru_cache(maxsize=256)
def _bounds(
    level: Level, digest: str, actions: str, max_steps: int | None, discount: float
) -> Bounds:
    played = level.model_copy(update={"max_steps": max_steps})
    try:
        (found,) = score("random", played, actions=actions, discount=discount)
    except (ValueError, UndefinedReturnError, EpisodeTooLongError):
        return Bounds(math.nan, math.nan)
    return Bounds(found.optimum, found.random)


def reaches_exit(play: Play) -> bool:
    """Return whether a valid play ends at an exit."""
    exits = space_of(play.level, play.action_set).exits
    return play.end == "terminated" and bool(exits[play.states[-1]])


@dataclass(frozen=True, slots=True)
class Grade:
    """The plays of one player in one level.

    Unfinished episodes are counted, but have no return. Plays that are not valid count in nothing,
    and equal plays (the same seed, actions and states) count once.

    Attributes:
        player: the name of the file, without its suffix.
        level: the level's name, or its digest if it has none.
        episodes: the number of valid plays that ended.
        unfinished: the number of valid plays that did not end.
        best: the highest return; nan without an episode.
        mean: the mean return.
        optimum: the optimal expected return.
        random: the expected return of the random policy.
        share: how much of the way from the random policy to the optimum the mean return covers:
            `(mean - random) / (optimum - random)`.
        success: how many of the episodes end at an exit, 0 to 1.
        steps: the mean number of steps.
        regret: the least that the decisions of an episode cost; see `Verification`.
        luck: what chance added to the highest return.
        hints: how many hints the player asked for, as the game tells.
        undone: how many steps the player took back, as the game tells.
        watched: how many steps the policy took that the player watched, as the game tells.
        unseeded: how many plays have no seed, so that nothing tells whether chance was chosen.
        copies: how many plays were left out, because they equal another one of the player.
        shared: how many plays equal one of another player.
        shared_with: these players, with commas between them.
        fault: what is wrong with the file or its first play that is not valid; None for nothing.
    """

    __module__ = "babyrobot_levels"

    player: str
    level: str
    episodes: int
    unfinished: int
    best: float
    mean: float
    optimum: float
    random: float
    share: float
    success: float
    steps: float
    regret: float
    luck: float
    hints: int
    undone: int
    watched: int
    unseeded: int
    copies: int
    shared: int
    shared_with: str
    fault: str | None


class Grades(Table[Grade]):
    """The plays of several players: one grade for each player and level."""

    __module__ = "babyrobot_levels"
    ROW = Grade

    @property
    def are_valid(self) -> bool:
        """Whether nothing is wrong with any file."""
        return all(grade.fault is None for grade in self)

    def to_dict(self) -> dict[str, Any]:
        """Return everything as a mapping that JSON can hold; null for nan."""
        return {"grades": [plain(asdict(grade)) for grade in self]}

    def __repr__(self) -> str:
        return f"<Grades of {len({grade.player for grade in self})} players>"


def grade(files: Iterable[str | os.PathLike[str]], level: Any = None) -> Grades:
    """Verify the plays of several files, and compare their returns with the exact optimum.

    Args:
        files: the `.brlplay` files, one for each player.
        level: the level that was to be played, under its time limit, its discount and from its
            starts; plays of other levels are left out, and those under other conditions are
            faults. By default, each level has a grade of its own, under the conditions of its
            plays.

    Raises:
        LevelNotFoundError: there is no such level.
        LevelError: the level is not valid, or its maze has no seed yet.
    """
    wanted = None if level is None else load(level)
    if wanted is not None:
        wanted.compile()
    found: list[tuple[Path, Grade, set[bytes]]] = []
    players: dict[bytes, dict[Path, None]] = {}
    for path in map(Path, files):
        for each, episodes in _grades_of(path, wanted):
            found.append((path, each, episodes))
            for episode in episodes:
                players.setdefault(episode, {})[path] = None
    return Grades([_with_shared(*each, players) for each in found])


def _with_shared(
    path: Path, found: Grade, episodes: set[bytes], players: Mapping[bytes, Iterable[Path]]
) -> Grade:
    """Return a grade that tells which of its episodes other files have, too."""
    others = [[each.stem for each in players[of] if each != path] for of in episodes]
    names = sorted(set(chain.from_iterable(others)))
    return replace(found, shared=sum(map(bool, others)), shared_with=", ".join(names))


def _grades_of(path: Path, wanted: Level | None) -> Iterator[tuple[Grade, set[bytes]]]:
    """Yield the grades of a player, at least one, and the episodes that each is of."""
    try:
        plays = read_plays(path)
    except (PlayError, OSError) as error:
        # The player's name says in which file.
        reason = str(error).removeprefix(f"{path}:").strip()
        fault = error.strerror if isinstance(error, OSError) else _LINE.sub(r"line \1:", reason)
        yield _grade(path.stem, _name_of(wanted), [], 0, fault), set()
        return
    groups: dict[_Conditions, dict[bytes, Play]] = {}
    copies: Counter[_Conditions] = Counter()
    faults: dict[_Conditions, str] = {}
    for number, play in enumerate(plays, 1):
        if wanted is not None and play.digest != wanted.digest:
            continue
        conditions = wanted or play
        key = (play.digest, str(play.action_set), conditions.max_steps, conditions.discount)
        fault = _condition_fault(play, wanted) or verify_play(play).fault
        if fault is not None:
            faults.setdefault(key, f"line {number}: {fault}")
            continue
        group, episode = groups.setdefault(key, {}), _episode_of(play)
        copies[key] += episode in group
        group.setdefault(episode, play)
    if wanted is not None and not groups and not faults:
        others = sorted({play.name for play in plays if play.name})[:3]
        fault = "it has no play of this level" + (f", but of {listed(others)}" if others else "")
        yield _grade(path.stem, _name_of(wanted), [], 0, fault), set()
    for key in groups | faults:
        group = groups.get(key, {})
        valid = [*group.values()]
        name = _name_of(wanted or (valid[0] if valid else None)) or key[0]
        yield _grade(path.stem, name, valid, copies[key], faults.get(key)), set(group)


def _episode_of(play: Play) -> bytes:
    """Return what valid plays have in common if they are the same episode, as a digest."""
    seed = None if play.seed is None else int(play.seed)
    told = play.digest, str(play.action_set), seed, play.actions, play.states
    return sha256(repr(told).encode()).digest()


def _name_of(found: Level | Play | None) -> str:
    return "" if found is None else found.name or found.digest


def _condition_fault(play: Play, wanted: Level | None) -> str | None:
    """Return why a play is none of the level that was to be played."""
    if wanted is None:
        return None
    if play.max_steps != wanted.max_steps:
        return f"it has another time limit, {play.max_steps}, and not {wanted.max_steps}"
    if play.discount != wanted.discount:
        return f"it has another discount, {play.discount:g}, and not {wanted.discount:g}"
    if play.start == "chosen":
        return "the player chose its start"
    return None


def _grade(player: str, level: str, plays: Sequence[Play], copies: int, fault: str | None) -> Grade:
    """Return the grade of valid plays under the same conditions, none of them equal."""
    ended = [play for play in plays if play.end != "unfinished"]
    returns = [play.return_ for play in ended]
    best = max(ended, key=lambda play: play.return_, default=None)
    decisions = [decisions_of(play) for play in ended]
    bounds = bounds_of(plays[0]) if plays else Bounds(math.nan, math.nan)
    mean = _mean(returns)
    return Grade(
        player=player,
        level=level,
        episodes=len(ended),
        unfinished=len(plays) - len(ended),
        best=max(returns, default=math.nan),
        mean=mean,
        optimum=bounds.optimum,
        random=bounds.random,
        share=bounds.share(mean),
        success=_mean([float(reaches_exit(play)) for play in ended]),
        steps=_mean([float(play.steps) for play in ended]),
        regret=min((each.regret for each in decisions), default=math.nan),
        luck=math.nan if best is None else decisions_of(best).luck,
        hints=sum(play.hints for play in plays),
        undone=sum(play.undone for play in plays),
        watched=sum(play.watched for play in plays),
        unseeded=sum(play.seed is None for play in plays),
        copies=copies,
        shared=0,
        shared_with="",
        fault=fault,
    )


def _mean(numbers: Sequence[float]) -> float:
    return math.fsum(numbers) / len(numbers) if numbers else math.nan
