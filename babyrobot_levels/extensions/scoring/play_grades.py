"""Grades of plays: those of several players, verified, beside the exact optimum."""

from __future__ import annotations

import math
import zlib
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import nullcontext, suppress
from dataclasses import dataclass
from functools import lru_cache
from hashlib import sha256
from typing import NamedTuple

from babyrobot_levels.agents.decisions import decisions_of, optimal_values
from babyrobot_levels.agents.plays import Play, recognise
from babyrobot_levels.agents.verify import verify_play
from babyrobot_levels.analysis.solver.evaluation import random_return
from babyrobot_levels.analysis.solver.horizon import best_returns_within
from babyrobot_levels.analysis.solver.policies import space_of
from babyrobot_levels.analysis.solver.results import EpisodeTooLongError, UndefinedReturnError
from babyrobot_levels.extensions.scoring.hand_ins import HandIn, words_of
from babyrobot_levels.library.level import Level
from babyrobot_levels.text import budget
from babyrobot_levels.text.words import Telling, listed

_Conditions = tuple[str, str, int | None, float]
"""Of plays that are compared: digest, set of actions, time limit, discount."""

RULES = ("regret", "share", "success", "tries")
"""By what points are given; see `grade`."""

_OWN_SEEDS = 1_000_000
"""So many seeds from that of a name on are a player's own."""


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
        if not math.isfinite(way) or way <= 1e-9 * max(1.0, abs(self.optimum)):
            return math.nan
        return (earned - self.random) / way


def bounds_of(play: Play) -> Bounds:
    """Return what the return of a valid play is compared with: its level, limit and actions."""
    return _bounds(play.level, play.digest, play.action_set, play.max_steps, play.discount)


@lru_cache(maxsize=256)
def _bounds(level: Level, digest: str, actions: str, limit: int | None, discount: float) -> Bounds:
    values = optimal_values(level, digest, actions, limit, discount)
    with suppress(UndefinedReturnError, EpisodeTooLongError):
        if values is not None and math.isfinite(values.optimum):
            return Bounds(values.optimum, values.random)
        if values is None and limit is not None:
            # They are too many to be kept for each step.
            space = space_of(level, actions)
            (optimum,) = best_returns_within([space], [limit], [discount]).tolist()
            return Bounds(optimum, random_return(space, limit, discount))
    return Bounds(math.nan, math.nan)


def reaches_exit(play: Play) -> bool:
    """Return whether a valid play ends at an exit."""
    exits = space_of(play.level, play.action_set).exits
    return play.end == "terminated" and bool(exits[play.states[-1]])


@dataclass(frozen=True, slots=True)
class Grade(Telling, public=True):
    """The plays of one player in one level.

    Unfinished episodes are counted, but have no return. Plays that are not valid or not the
    player's own count in nothing, and equal plays (the same seed, actions and states) count once.

    Attributes:
        player: the player: the name of the folder or the file, without its suffix, or the name
            that its plays tell, if the file's name has it.
        level: the level's name, or its digest if it has none.
        points: what the best play earns by the rule; 0 without one.
        worth: the most points.
        episodes: the number of valid plays that ended.
        unfinished: the number of valid plays that did not end.
        best: the highest return; nan without an episode.
        mean: the mean return.
        optimum: the optimal expected return.
        random: the expected return of the random policy.
        share: how much of the way from the random policy to the optimum the mean return covers:
            `(mean - random) / (optimum - random)`.
        regret: the least that the decisions of an episode cost; see `Verification`.
        luck: what chance added to the highest return.
        success: how many of the episodes end at an exit, 0 to 1.
        steps: the mean number of steps.
        hints: how many hints the player asked for, as the game tells.
        undone: how many steps the player took back, as the game tells.
        watched: how many steps the policy took that the player watched, as the game tells.
        unseeded: how many plays have no seed, so that nothing tells whether chance was chosen.
        copies: how many plays were left out, because they equal another one of the player.
        shared: how many plays equal one of another player.
        shared_with: these players, with commas between them.
        fault: what is wrong with the first play that is not valid, or, where there is no valid one
            of the level, with the first file; None for nothing.
    """

    player: str
    level: str
    points: float
    worth: float
    episodes: int
    unfinished: int
    best: float
    mean: float
    optimum: float
    random: float
    share: float
    regret: float
    luck: float
    success: float
    steps: float
    hints: int
    undone: int
    watched: int
    unseeded: int
    copies: int
    shared: int
    shared_with: str
    fault: str | None


@dataclass(frozen=True, slots=True)
class Defect:
    """A file or a play that does not count.

    Attributes:
        player: who handed it in.
        place: the file, if the player has several, and the line.
        reason: why it does not count.
    """

    __module__ = "babyrobot_levels"

    player: str
    place: str
    reason: str


class Asked(NamedTuple):
    """A level that was to be played, and what it is worth."""

    level: Level
    worth: float


class Players:
    """What all players handed in, for what is only told by comparing them."""

    def __init__(
        self, wanted: Mapping[str, Asked] | None, rule: str, handed: Sequence[HandIn]
    ) -> None:
        self.wanted, self.rule = wanted, rule
        self.defects: list[Defect] = []
        self.alike: set[tuple[str, frozenset[str]]] = set()
        self.versions = {asked.level.name: asked.level for asked in (wanted or {}).values()}
        for level in self.versions.values():
            recognise(level)
        self.words = {each.player: words_of(each.player) for each in handed}
        self.episodes: dict[int, bytes] = {}
        self.players: dict[bytes, set[str]] = {}
        self.owners: dict[bytes, str] = {}
        """Whose name gives the seed of an episode."""
        for hand_in in handed:
            for _, play in hand_in.entries:
                episode = self.episodes[id(play)] = _episode_of(play)
                self.players.setdefault(episode, set()).add(hand_in.player)
                if (
                    _has_own_seed(play)
                    and words_of(play.player or "") <= self.words[hand_in.player]
                ):
                    self.owners.setdefault(episode, hand_in.player)

    def grades_of(self, hand_in: HandIn) -> Iterator[Grade]:
        """Yield the grades of a player, at least one."""
        player, wanted = hand_in.player, self.wanted
        groups: dict[_Conditions, dict[bytes, Play]] = {}
        copies: Counter[_Conditions] = Counter()
        faults: dict[_Conditions, str] = {}
        # Levels that were not asked for are the player's own.
        with nullcontext() if wanted is None else budget.together():
            for place, play in hand_in.entries:
                asked = None if wanted is None else self._asked(play)
                if wanted is not None and asked is None:
                    continue
                of = play if asked is None else asked.level
                key = (of.digest, str(play.action_set), of.max_steps, of.discount)
                fault = self._fault(play, player, of)
                if fault is not None:
                    self.defects.append(Defect(player, place, fault))
                    faults.setdefault(key, f"{place}: {fault}")
                    continue
                group, episode = groups.setdefault(key, {}), self.episodes[id(play)]
                copies[key] += episode in group
                group.setdefault(episode, play)
        # A file that cannot be read is of no level; with several, the defects tell of it.
        self.defects += [Defect(player, *fault) for fault in hand_in.faults]
        broken = next((": ".join(filter(None, fault)) for fault in hand_in.faults), None)
        is_one = wanted is None or len(wanted) == 1
        keys: list[_Conditions] = [*(groups | faults)]
        none: list[_Conditions] = [
            (digest, "all", None, 1.0)
            for digest in ({} if wanted is None and keys else dict.fromkeys(wanted or [""]))
            if digest not in {key[0] for key in keys}
        ]
        if none and is_one and broken is None:
            others = sorted({play.name for _, play in hand_in.entries if play.name})[:3]
            broken = "it has no play of this level" + f", but of {listed(others)}" * bool(others)
            self.defects.append(Defect(player, "", broken))
        order = list(wanted or ())
        for key in sorted(keys + none, key=lambda key: order.index(key[0]) if order else 0):
            # What is not read may have been a play of this level.
            own = faults.get(key) or (broken if is_one or key not in groups else None)
            yield self._grade(player, key, groups.get(key, {}), copies[key], own)

    def _asked(self, play: Play) -> Asked | None:
        """Return which of the levels a play is of, or is meant to be of."""
        assert self.wanted is not None
        version = self.versions.get(play.name) if play.name else None
        return self.wanted.get(play.digest if version is None else version.digest)

    def _fault(self, play: Play, player: str, of: Level | Play) -> str | None:
        """Return why a play does not count; None if it does."""
        if play.digest != of.digest:
            return f"it is of another version of {of.name}"
        owner = self.owners.get(self.episodes[id(play)], player)
        claimed = words_of(play.player or "")
        if claimed and not claimed <= self.words[player]:
            for other, words in self.words.items():
                if claimed <= words:
                    return f"it is under the name of {other}"
        if owner != player:
            return f"it is the same play as that of {owner}"
        try:
            return _condition_fault(play, of) or verify_play(play).fault
        except budget.OverBudgetError as error:
            if of is play:
                raise
            return f"it cannot be verified: {error}"

    def _grade(
        self,
        player: str,
        key: _Conditions,
        episodes: Mapping[bytes, Play],
        copies: int,
        fault: str | None,
    ) -> Grade:
        """Return the grade of valid plays under the same conditions, none of them equal."""
        budget.begin()
        plays = [*episodes.values()]
        asked = None if self.wanted is None else self.wanted.get(key[0])
        named = asked.level if asked is not None else plays[0] if plays else None
        others = [self.players[of] - {player} for of in episodes]
        level = (named and named.name) or key[0]
        self.alike |= {(level, frozenset(self.players[of])) for of in episodes}
        ended = [play for play in plays if play.end != "unfinished"]
        returns = [play.return_ for play in ended]
        best = max(ended, key=lambda play: play.return_, default=None)
        bounds = bounds_of(plays[0]) if plays else Bounds(math.nan, math.nan)
        mean, worth = _mean(returns), 1.0 if asked is None else asked.worth
        return Grade(
            player=player,
            level=level,
            points=worth * _earned(self.rule, [play for play in ended if not play.watched], bounds),
            worth=worth,
            episodes=len(ended),
            unfinished=len(plays) - len(ended),
            best=max(returns, default=math.nan),
            mean=mean,
            optimum=bounds.optimum,
            random=bounds.random,
            share=bounds.share(mean),
            regret=min((decisions_of(play).regret for play in ended), default=math.nan),
            luck=math.nan if best is None else decisions_of(best).luck,
            success=_mean([float(reaches_exit(play)) for play in ended]),
            steps=_mean([float(play.steps) for play in ended]),
            hints=sum(play.hints for play in plays),
            undone=sum(play.undone for play in plays),
            watched=sum(play.watched for play in plays),
            unseeded=sum(play.seed is None for play in plays),
            copies=copies,
            shared=sum(map(bool, others)),
            shared_with=", ".join(sorted({name for names in others for name in names})),
            fault=fault,
        )


def _earned(rule: str, plays: Sequence[Play], bounds: Bounds) -> float:
    """Return which part of the points the best of several plays earns, 0 to 1."""
    if not plays:
        return 0.0
    if rule in ("success", "tries"):
        tries = (number for number, play in enumerate(plays, 1) if reaches_exit(play))
        first = next(tries, math.inf)
        return 1 / first if rule == "tries" else float(first < math.inf)
    reached = max(play.return_ for play in plays)
    if rule == "regret":
        reached = bounds.optimum - min(decisions_of(play).regret for play in plays)
    share = bounds.share(reached)
    if math.isnan(share):
        # Random actions are as good as any.
        share = float(reached >= bounds.optimum - 1e-9) if math.isfinite(reached) else share
    return share if math.isnan(share) else min(1.0, max(0.0, share))


def _episode_of(play: Play) -> bytes:
    """Return what valid plays have in common if they are the same episode, as a digest."""
    seed = None if play.seed is None else int(play.seed)
    told = play.digest, str(play.action_set), seed, play.actions, play.states
    return sha256(repr(told).encode()).digest()


def _has_own_seed(play: Play) -> bool:
    """Return whether a play has a seed that pages give to the name that it tells."""
    if play.player is None or play.seed is None:
        return False
    return 0 <= int(play.seed) - zlib.crc32(play.player.encode("utf-8", "replace")) < _OWN_SEEDS


def _condition_fault(play: Play, wanted: Level | Play) -> str | None:
    """Return why a play is none of the level that was to be played."""
    if wanted is play:
        return None
    if play.max_steps != wanted.max_steps:
        return f"it has another time limit, {play.max_steps}, and not {wanted.max_steps}"
    if play.discount != wanted.discount:
        return f"it has another discount, {play.discount:g}, and not {wanted.discount:g}"
    if play.start == "chosen":
        return "the player chose its start"
    return None


def _mean(numbers: Sequence[float]) -> float:
    return math.fsum(numbers) / len(numbers) if numbers else math.nan
