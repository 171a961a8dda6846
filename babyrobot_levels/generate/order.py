"""An order: a suite, what its levels are called, and which games must not be among them."""

from __future__ import annotations

import json
import re
from dataclasses import dataclass, field
from functools import cached_property
from hashlib import sha256

from babyrobot_levels.generate.candidates import Maker
from babyrobot_levels.language.base import SLUG
from babyrobot_levels.language.plain_data import plain
from babyrobot_levels.language.suite import SuiteFields
from babyrobot_levels.library.level import Level

FORMAT_VERSION = 1
"""Counts up when the same order would give other files."""

DEFAULT_NAMES = "level-{index:05}"

_NAMES = re.compile(r"([a-z0-9-]*)\{index(:0[1-9])?\}([a-z0-9-]*)")
_HEADER = re.compile(r"# Level (\d+) of the order ([0-9a-f]{12}), try (\d+):\n")
_FOR_PEOPLE = ("name", "title", "description", "author", "license", "source", "tags")


@dataclass(frozen=True)
class Order:
    """What is to be generated.

    Attributes:
        suite: what the levels are like, and how many there are.
        names: what they are called: a text with `{index}`, or `{index:05}`, in it.
        told: the order as people would say it, on one line.
        excluded: the digests of games that must not be among them.
    """

    suite: SuiteFields
    names: str
    told: str
    excluded: frozenset[str] = field(default_factory=frozenset)

    @cached_property
    def mark(self) -> str:
        """Twelve hex digits by which files of this order are known."""
        stated = {
            name: value for name, value in plain(self.suite).items() if name not in _FOR_PEOPLE
        }
        if not self.suite.splits:
            # Level 7 is the same of ten levels and of a thousand.
            stated.pop("count")
        whole = [FORMAT_VERSION, stated, self.names, sorted(self.excluded)]
        return sha256(json.dumps(whole, sort_keys=True).encode("utf-8")).hexdigest()[:12]

    def maker(self) -> Maker:
        """Return what draws the levels."""
        return Maker(self.suite, self.names)

    def text(self, number: int, attempt: int, level: Level) -> str:
        """Return a level's file: where it comes from, and what it says."""
        return (
            f"# Level {number} of the order {self.mark}, try {attempt}:\n"
            f"# {self.told}\n{level.to_yaml()}"
        )


def origin_of(text: str) -> tuple[str, int, int] | None:
    """Return of which order a file is, which level, and which try; None if it is of none."""
    match = _HEADER.match(text)
    return (match[2], int(match[1]), int(match[3])) if match else None


def is_pattern(names: str) -> bool:
    """Tell whether a text can say what levels are called, each in its own way."""
    return bool(_NAMES.fullmatch(names)) and bool(re.fullmatch(SLUG, names.format(index=0)))
