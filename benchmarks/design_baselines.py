"""Authors for `design.py` that know no language: what search alone reaches.

`random` and `search` are told the facts, and need not read the brief. `repair` is told nothing: it
answers with an empty room, and learns from each list of findings what else must be true.
"""

from __future__ import annotations

import json
import random
import re
from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import Any

from design import Author, Message
from design_judge import FIXED, KINDS, USUAL, Brief, Finding

import babyrobot_levels as brl
from babyrobot_levels.language.ranges import ends

TRIES = 60
"""How many levels `repair` looks at for an answer."""

Side = tuple[int, int, str]
SHAPES = ((2, 1), (1, 2), (3, 1), (1, 3), (2, 2), (4, 1), (1, 4))


class Sketch:
    """A level that is drawn at random with what a brief counts, and changed at random.

    Args:
        brief: its fields and counts are those of the level; names are what it says is needed.
        rng: draws.
    """

    def __init__(self, brief: Brief, rng: random.Random) -> None:
        self.brief, self.rng = brief, rng
        self.width, self.height = brief.fields.get("size", (3, 3))
        self.sides = [(x, y, "E") for x in range(self.width - 1) for y in range(self.height)]
        self.sides += [(x, y, "S") for x in range(self.width) for y in range(self.height - 1)]
        self.walls = self._maze()
        counts = {kind: self._drawn(brief.counts.get(kind, USUAL.get(kind, 0))) for kind in KINDS}
        counts["items"] -= counts["coins"]
        counts["puddles"] = max(0, counts["puddles"] - counts["large_puddles"])
        names = [*brief.expect.get("needs", ()), "key", "lever"]
        self.names = {
            "items": names[: counts["items"]],
            "switches": names[counts["items"] :][: counts["switches"]],
            "coins": [f"coin-{number + 1}" for number in range(counts["coins"])],
        }
        self.entries = {
            kind: [self._entry(kind) for _ in range(count)]
            for kind, count in counts.items()
            if kind not in ("wind", "drawn", "exit_needs", "warps", "areas")
        }
        self.gusts = [self._gust() for _ in range(counts["wind"])]
        self.locks = counts["exit_needs"]
        self.rewards: dict[str, float] = {}

    def changed(self) -> Sketch:
        """Return a sketch that differs in some places."""
        other = object.__new__(Sketch)
        other.__dict__.update(self.__dict__)
        other.walls, other.gusts = set(self.walls), [*self.gusts]
        other.entries = {kind: [*each] for kind, each in self.entries.items()}
        for _ in range(self.rng.choice((1, 1, 2, 3))):
            other.change()
        return other

    def change(self) -> None:
        """Change a wall, or where one thing is."""
        rng = self.rng
        kinds = [kind for kind, each in self.entries.items() if each]
        if rng.random() < 0.5 or not kinds:
            self.walls ^= {rng.choice(self.sides)} if self.sides else set()
            return
        if self.brief.fields.get("rewards") == "any" and rng.random() < 0.3:
            self.rewards = {"exit": rng.choice((0, 1, 5, 10, 14, 20))}
        if self.gusts and rng.random() < 0.3:
            self.gusts[rng.randrange(len(self.gusts))] = self._gust()
        kind = rng.choice(kinds)
        self.entries[kind][rng.randrange(len(self.entries[kind]))] = self._entry(kind)

    def to_dict(self) -> dict[str, Any]:
        """Return the level as plain data."""
        found, given = self.entries, self.brief.fields
        doors = {(*door["at"], door["side"]) for door in found["doors"] + found["glass"]}
        data: dict[str, Any] = {
            "size": [self.width, self.height],
            "start": found["starts"],
            "exit": found["exits"],
            "walls": [{"at": [x, y], "side": side} for x, y, side in sorted(self.walls - doors)]
            + found["glass"],
            "puddles": found["puddles"] + found["large_puddles"],
            "areas": found["holes"],
            "blocked": found["blocked"],
            "items": self._named("items") + self._named("coins"),
            "switches": self._named("switches"),
            "doors": found["doors"],
            "movers": found["guards"] + found["wanderers"],
            "exit_needs": (self.names["items"] + self.names["switches"])[: self.locks],
            "wind": self._wind(),
            "rewards": self.rewards,
        }
        fixed = {name: value for name, value in given.items() if value != "any"}
        return {"version": 1, **{name: each for name, each in data.items() if each}, **fixed}

    def level(self) -> brl.Level | None:
        """Return the level; None if it is not valid."""
        try:
            return brl.Level(**self.to_dict())
        except brl.LevelError:
            return None

    def _named(self, kind: str) -> list[dict[str, Any]]:
        pairs = zip(self.names[kind], self.entries[kind], strict=False)
        return [{"name": name, **entry} for name, entry in pairs]

    def _wind(self) -> dict[str, list[int]]:
        wind: dict[str, list[int]] = {}
        for side, line in self.gusts:
            count = self.width if side in ("north", "south") else self.height
            wind.setdefault(side, [0] * count)[line] = 1
        return wind

    def _gust(self) -> tuple[str, int]:
        side = self.rng.choice(("north", "east", "south", "west"))
        count = self.width if side in ("north", "south") else self.height
        return side, self.rng.randrange(count)

    def _cell(self) -> list[int]:
        return [self.rng.randrange(self.width), self.rng.randrange(self.height)]

    def _entry(self, kind: str) -> Any:
        """Return one of a kind, somewhere."""
        rng, at = self.rng, self._cell()
        each = dict(self.brief.each.get(kind, {}))
        match kind:
            case "starts" | "exits":
                return at
            case "large_puddles":
                return {"at": at, "size": "large"}
            case "holes":
                return {"at": at, "ends": True, **each}
            case "coins":
                return {"at": at, "reward": 5, **each}
            case "doors" | "glass":
                x, y, side = rng.choice(self.sides)
                place = {"at": [x, y], "side": side}
                names = self.names["items"] + self.names["switches"]
                if kind == "glass":
                    return {**place, "pass": rng.choice((0.2, 0.3, 0.5, 0.7, 0.8))}
                return {**place, "needs": rng.choice(names)} if names else place
            case "guards" | "wanderers":
                width, height = rng.choice(SHAPES)
                size = [min(width, self.width - at[0]), min(height, self.height - at[1])]
                if kind == "wanderers":
                    return {"within": {"at": at, "size": size}}
                columns, rows = range(size[0]), range(size[1])
                path = [[at[0] + x, at[1]] for x in columns] + [
                    [at[0] + size[0] - 1, at[1] + y] for y in rows[1:]
                ]
                return {"path": path[:: rng.choice((1, -1))], "back": True}
        return {"at": at}

    def _drawn(self, count: Any) -> int:
        if not isinstance(count, str):
            return int(count)
        found = ends(count)
        least = found.get("min", 0)
        return self.rng.randint(least, found.get("max", least + 2))

    def _maze(self) -> set[Side]:
        """Return the walls of a random maze, some of them open."""
        walls = set(self.sides)
        groups = {(x, y): {(x, y)} for x in range(self.width) for y in range(self.height)}
        for x, y, side in self.rng.sample(self.sides, len(self.sides)):
            one, other = groups[x, y], groups[x + (side == "E"), y + (side == "S")]
            if one is not other:
                walls.discard((x, y, side))
                one |= other
                groups.update(dict.fromkeys(other, one))
        share = self.rng.choice((0, 0, 0.1, 0.3))
        return {wall for wall in walls if self.rng.random() >= share}


def at_random(brief: Brief) -> Author:
    """Return an author that answers with what the brief counts, anywhere."""
    rng = random.Random(brief.name)

    def author(_: list[Message]) -> str:
        levels = (Sketch(brief, rng).level() for _ in range(100))
        return next((level.to_yaml() for level in levels if level), "")

    return author


def by_search(brief: Brief) -> Author:
    """Return an author that has the generator of suites look for a level with the facts.

    It does not answer a brief with what suites do not have: holes, glass, switches, more starts.
    """
    counts = dict(brief.counts)
    coins, keys = counts.get("coins", 0), counts.pop("items", 0)
    suite = {
        "version": 1,
        "kind": "suite",
        "name": "search",
        "count": 1,
        "maze": {"loops": {"max": 0.6}},
        "start": "random",
        "exit": "random",
        "keys": keys - coins,
        "expect": {name: each for name, each in brief.expect.items() if name != "needs"},
        **counts,
        **{name: each for name, each in brief.fields.items() if each != "any"},
    }

    def author(messages: list[Message]) -> str:
        try:
            found = brl.load_suite({**suite, "seed": len(messages)})[0].to_dict()
        except (brl.BabyRobotError, ValueError):
            return ""
        needed = iter(brief.expect.get("needs", ()))
        names = {each["name"]: next(needed, each["name"]) for each in found.get("items", ())}
        for item in found.get("items", ()):
            item["name"] = names[item["name"]]
            if "reward" in item:
                item.update(brief.each.get("coins", {}))
        for door in found.get("doors", ()):
            door["needs"] = names[door["needs"]]
        return brl.Level(**found).to_yaml()

    return author


def by_repair(brief: Brief, tries: int = TRIES) -> Author:
    """Return an author that learns from findings what is wanted, and changes levels at random.

    It keeps a change if the level comes nearer to all facts that it has been told so far.
    """
    rng = random.Random(brief.name)
    known = Brief(brief.name, "")

    def author(messages: list[Message]) -> str:
        nonlocal known
        found = re.search(r"^\[.*^\]", messages[-1]["content"], re.DOTALL | re.MULTILINE)
        if found is None:
            return "version: 1\n"
        known = learned(known, json.loads(found[0]))
        return climb(known, rng, tries)

    return author


def learned(known: Brief, findings: Iterable[Finding]) -> Brief:
    """Return what is known of a brief after some findings."""
    for each in findings:
        name, *rest = each.get("fact", "").split(".")
        part = "fields" if name in (*FIXED, "size", "start", "exit") else "counts"
        if rest:
            each_of = {**known.each.get(name, {}), rest[0]: each["expected"]}
            known = replace(known, each={**known.each, name: each_of})
        elif name:
            part = part if part == "fields" or name in KINDS else "expect"
            facts: Any = {part: {**getattr(known, part), name: each["expected"]}}
            known = replace(known, **facts)
    return known


def climb(known: Brief, rng: random.Random, tries: int) -> str:
    """Return the best of some levels, each but the first like one before."""
    best, least = "version: 1\n", float("inf")
    while tries:
        sketch, here, stale = Sketch(known, rng), float("inf"), 0
        while stale < 100 and tries:
            tries, other = tries - 1, sketch.changed()
            level = other.level()
            there = far(known, level) if level else float("inf")
            stale = 0 if there < here else stale + 1
            if there <= here:
                sketch, here = other, there
            if level and there < least:
                best, least = level.to_yaml(), there
            if there == 0:
                return best
    return best


def far(known: Brief, level: brl.Level) -> float:
    """Return how far a level is from a brief: 0 if it meets it."""
    try:
        # What the linter finds counts less than any fact, and takes longer.
        found = [*known.unmet(level)]
        return sum(map(distance, found)) if found else 0.04 * len(known.judge(level.to_yaml()))
    except brl.LevelError:
        return float("inf")


def distance(finding: Finding) -> float:
    """Return how far a finding is from being mended; figures count by their shares."""
    expected, value = finding.get("expected"), finding.get("value")
    if isinstance(expected, str):
        named = [*ends(expected).values()]
    else:
        named = [expected] if isinstance(expected, int | float) else []
    if not named or not isinstance(value, int | float) or value != value:
        return 1.0
    least: float = min(abs(value - end) / max(1.0, abs(end)) for end in named)
    return 0.05 + min(1.0, least)


BASELINES: dict[str, Callable[[Brief], Author]] = {
    "random": at_random,
    "search": by_search,
    "repair": by_repair,
}
