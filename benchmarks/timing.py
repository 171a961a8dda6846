"""Measuring side by side: rounds in turn, so that a machine whose speed drifts slows all alike."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec

ROUNDS = 7
"""How many rounds count."""

FEW = 2
"""How many do in a quick run."""

EXTRAS = {"numba": "fast", "jax": "jax", "gymnax": "jax"}
"""The extras of this project that packages belong to."""

Measure = Callable[[], float]
"""Runs once and returns its rate, in things done per second.

It raises `MissingPeer` where what it measures cannot be had here.
"""

Rates = dict[str, list[float]]
"""The rates of measures, one a round, by name; none where something is missing."""


Aims = Mapping[tuple[str, str | None], float]
"""The least that ours are to reach: as a ratio, by the names of ours and of the peer; as a rate,
where the peer is None."""


class MissingPeer(Exception):
    """Something to be measured that cannot be had. Its text says what, and why."""


@dataclass(frozen=True)
class Comparison:
    """What was measured in turn.

    Attributes:
        unit: what all rates count, such as "steps per second".
        ours: the rates of this project.
        peers: the rates that ours are set beside. None, for figures that stand alone.
        missing: why, for what has no rates, ours or a peer.
        aims: the least that ours are to reach.
        versions: of the packages that were measured.
        note: what else was found out.
    """

    unit: str
    ours: Rates
    peers: Rates = field(default_factory=dict)
    missing: Mapping[str, str] = field(default_factory=dict)
    aims: Aims = field(default_factory=dict)
    versions: Mapping[str, str] = field(default_factory=dict)
    note: str = ""


Compare = Callable[..., Iterator[Comparison]]
"""What each script has under the name `compare`. It takes the number of rounds that count, and, if
the script has an option for them, numbers of environments."""


def in_turns(measures: Mapping[str, Measure], count: int) -> tuple[Rates, dict[str, str]]:
    """Run all measures in turn, `count` times after one round that does not count.

    Returns:
        the rates, and what is missing with the reason.
    """
    rates: Rates = {name: [] for name in measures}
    missing: dict[str, str] = {}
    for number in range(count + 1):
        for name, measure in measures.items():
            if name in missing:
                continue
            try:
                rate = measure()
            except MissingPeer as error:
                missing[name] = str(error)
                continue
            if number:
                rates[name].append(rate)
    return rates, missing


def compare_in_turns(
    unit: str,
    ours: Mapping[str, Measure],
    peers: Mapping[str, Measure],
    count: int,
    *,
    aims: Aims | None = None,
    versions: Mapping[str, str] | None = None,
) -> Comparison:
    """Return ours beside the peers, all measured in turn."""
    rates, missing = in_turns({**peers, **ours}, count)
    mine, others = ({name: rates[name] for name in names} for names in (ours, peers))
    return Comparison(unit, mine, others, missing, aims or {}, versions or {})


def needing(packages: str, make: Callable[[], Measure]) -> Measure:
    """Return a measure that is made when it first runs, and missing where a package is.

    Args:
        packages: their names in imports, with spaces between them.
        make: returns the measure.
    """
    made = cache(make)

    def measure() -> float:
        for each in packages.split():
            if find_spec(each) is None:
                extra = f" (the extra `{EXTRAS[each]}`)" if each in EXTRAS else ""
                raise MissingPeer(f"{each} is not installed{extra}")
        return made()()

    return measure


def installed(*packages: str) -> dict[str, str]:
    """Return the versions of packages, those that are there."""
    found = {}
    for name in packages:
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            continue
    return found
