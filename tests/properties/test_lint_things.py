"""Rules of play on random levels with things, against the plain reference implementation."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from random import Random
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from oracles.random_things import random_level
from oracles.things_reference import Reference, cells_of
from support.reading import read_level

from babyrobot_levels.analysis.solver.optimum import solve
from babyrobot_levels.analysis.solver.results import EpisodeTooLongError, UndefinedReturnError
from babyrobot_levels.library.level import Level
from babyrobot_levels.linter.rules import all_rules, select
from babyrobot_levels.linter.runner import fix, lint_source
from babyrobot_levels.text.diagnostics import Diagnostic
from babyrobot_levels.text.emitter import emit
from babyrobot_levels.text.source import SourceFile

Pair = tuple[tuple[int, ...], tuple[int, int]]
"""The values of all things, and the robot's cell."""

RULES = [rule for rule in all_rules() if rule.code < "BR6"]
SLOW = [HealthCheck.too_slow, HealthCheck.filter_too_much]
pytestmark = pytest.mark.slow

untimed = settings(
    max_examples=min(settings().max_examples, 50), deadline=None, suppress_health_check=SLOW
)
"""The reference takes long: thorough runs have as many examples as the others."""

worlds = st.integers(0, 10**9).map(lambda seed: random_level(Random(seed)))


def found(world: dict[str, Any], *rules: str) -> list[Diagnostic]:
    source = SourceFile("x.yaml", emit(world))
    return lint_source(source, select(rules) if rules else RULES).diagnostics


def loaded(text: str) -> Level:
    level, diagnostics = read_level(SourceFile("x.yaml", text))
    assert level is not None, "\n".join(map(str, diagnostics))
    return level


def reached_by(level: Reference, sources: Iterable[Pair]) -> set[Pair]:
    """Return the pairs in which an episode from some others can go on, these included."""
    waiting = list(sources)
    reached = set(waiting)
    while waiting:
        for results in level.results.get(waiting.pop(), []):
            for result in results:
                if not result.over and result.pair not in reached:
                    reached.add(result.pair)
                    waiting.append(result.pair)
    return reached


def before(level: Reference, goals: Callable[[Pair], bool]) -> set[Pair]:
    """Return the pairs from which an episode can come to a goal, goals included."""
    able = {pair for pair in level.reached if goals(pair)}
    while True:
        more = {
            pair
            for pair, rows in level.results.items()
            if pair not in able
            and any(
                each.pair in able and (not each.over or goals(each.pair))
                for row in rows
                for each in row
            )
        }
        if not more:
            return able
        able |= more


# -- fixes -------------------------------------------------------------------------------------


def optimum(level: Level) -> float:
    try:
        return solve(level).expected_return
    except (UndefinedReturnError, EpisodeTooLongError):
        return np.nan


@pytest.mark.sweep
@untimed
@given(worlds, st.sampled_from([1.0, 0.9]))
@pytest.mark.parametrize("codes", [["BR529", "BR536"], ["BR531", "BR532"], ["BR533"]])
def test_without_what_is_useless_the_optimum_is_the_same(
    codes: list[str], world: dict[str, Any], discount: float
) -> None:
    """All of it is removed together."""
    text = emit({**world, "discount": discount})
    fixed = fix(SourceFile("x.yaml", text), select(codes), unsafe=True)
    assume(fixed.count)
    level, other = loaded(text), loaded(fixed.text)
    one, two = optimum(level), optimum(other)
    assert two == pytest.approx(one, rel=1e-6, abs=1e-6, nan_ok=True), f"{text}\n{fixed.text}"


# -- findings are exact ------------------------------------------------------------------------


@untimed
@given(worlds)
def test_items_that_nobody_takes(world: dict[str, Any]) -> None:
    level = Reference(world)
    expected = []
    for index, item in enumerate(level.items):
        column, places = level.first_item + index, level.item_places[index]
        taken = {
            pair[0][column]
            for pair, rows in level.results.items()
            for row in rows
            for each in row
            if each.pair[0][column] == len(places)
        }
        left = [
            place
            for place, cell in enumerate(places)
            if place not in taken and cell not in level.starts
        ]
        if left:
            x, y = places[left[0]]
            partly = f" from [{x}, {y}]" if len(left) < len(places) else ""
            expected.append(f"`{item['name']}` can never be taken{partly}")
    messages = [each.message for each in found(world, "BR528")]
    assert len(messages) == len(expected)
    assert all(map(str.startswith, messages, expected))


@untimed
@given(worlds)
def test_doors_that_never_open_or_never_close(world: dict[str, Any]) -> None:
    level = Reference(world)
    playing = {values for values, _ in level.results}
    never, always = [], []
    for entry in world.get("doors", []):
        (door, *_), *_ = Reference({**world, "doors": [entry]}).doors.values()
        opened = [level.door_open(door, values) for values in playing]
        where = f"the door on side {entry['side']} of {list(entry['at'])}"
        never += [where] * (not any(opened))
        always += [where] * all(opened)
    assert [each.message.split(" never opens")[0] for each in found(world, "BR530")] == never
    assert [each.message.split(" is never closed")[0] for each in found(world, "BR531")] == always


@untimed
@given(worlds)
def test_exits_starts_and_traps(world: dict[str, Any]) -> None:
    level = Reference(world)
    able = before(level, lambda pair: level.won(*pair))
    starts = [level.pair(state) for state in level.start]
    exits = level.exit_places or level.exits
    good = [pair for pair in starts if pair in able]
    traps = (reached_by(level, good) & {*level.results}) - able
    findings = {each.code: each for each in found(world, "BR5")}
    never = bool(exits and level.exit_needs) and not any(
        all(level.has(name, values) for name in level.exit_needs) for values, _ in level.results
    )
    assert ("BR534" in findings) == never
    # The needs of exits are reported once.
    has_goal = bool(exits or level.targets)
    assert ("BR501" in findings) == (has_goal and len(good) < len(starts) and not never)
    # A push may lose a level.
    assert ("BR503" in findings) == (bool(traps) and not level.boxes)
    # Levels without things have results also where no episode comes.
    ended = {
        result.pair[1]
        for pair in reached_by(level, starts)
        for results in level.results.get(pair, [])
        for result in results
        if level.exit_open(*result.pair)
    }
    assert ("BR517" in findings) == (0 < len(ended) < len({*exits}))
    if traps and not level.boxes:
        # The first cell that is named; there may be several ("from 2 cells ([0, 2] and [2, 2])").
        named = re.search(r"\[\d+, \d+\]", findings["BR503"].message)
        assert named
        assert named[0] in {f"[{x}, {y}]" for _, (x, y) in traps}


# -- movers ------------------------------------------------------------------------------------


def hits(level: Reference, mover: int, pair: Pair, after: Pair) -> bool:
    was, now = level.mover_cell(mover, pair[0]), level.mover_cell(mover, after[0])
    here, there = pair[1], after[1]
    return there == now or (there != here and there == was and here == now)


def is_avoidable(level: Reference, start: Pair, movers: Iterable[int]) -> bool:
    """Return whether some policy comes to an exit, if there is one, and is surely never hit."""
    actions = {
        pair: [
            row
            for row in rows
            if not any(hits(level, mover, pair, each.pair) for mover in movers for each in row)
        ]
        for pair, rows in level.results.items()
    }
    while True:
        safe = {pair for pair, rows in actions.items() if rows}
        kept = {
            pair: [row for row in rows if all(each.over or each.pair in safe for each in row)]
            for pair, rows in actions.items()
        }
        if kept == actions:
            break
        actions = kept
    if start not in safe or not (level.exit_places or level.exits or level.targets):
        return start in safe
    reached, waiting = {start}, [start]
    while waiting:
        for row in actions.get(waiting.pop(), []):
            for each in row:
                if each.over and level.won(*each.pair):
                    return True
                if not each.over and each.pair not in reached:
                    reached.add(each.pair)
                    waiting.append(each.pair)
    return False


@pytest.mark.sweep
@untimed
@given(worlds.filter(lambda world: "movers" in world))
def test_movers_that_nobody_meets_or_avoids(world: dict[str, Any]) -> None:
    level = Reference(world)
    numbers = range(len(level.movers))
    names = [mover.get("name", f"mover-{n}") for n, mover in enumerate(level.movers, 1)]
    met = [
        any(
            hits(level, mover, pair, each.pair)
            for pair, rows in level.results.items()
            for row in rows
            for each in row
        )
        for mover in numbers
    ]
    never = [f"`{names[n]}` never meets the robot" for n in numbers if not met[n]]
    assert [each.message for each in found(world, "BR536")] == never
    able = before(level, lambda pair: level.won(*pair))
    has_exits = bool(level.exit_places or level.exits or level.targets)
    starts = [pair for pair in map(level.pair, level.start) if not has_exits or pair in able]
    alone = [n for n in numbers if not all(is_avoidable(level, start, [n]) for start in starts)]
    every = not all(is_avoidable(level, start, numbers) for start in starts)
    messages = [each.message for each in found(world, "BR535")]
    assert len(messages) == (len(alone) or int(every))
    for n, message in zip(alone, messages, strict=False):
        assert message.startswith(f"`{names[n]}` cannot be avoided")


@untimed
@given(worlds)
def test_every_cell_that_is_reported_is_never_reached(world: dict[str, Any]) -> None:
    level = Reference({name: value for name, value in world.items() if name != "wind"})
    world.pop("wind", None)
    playing = reached_by(level, map(level.pair, level.start))
    cells = {cell for _, cell in playing}
    cells |= {each.pair[1] for pair in playing for row in level.results[pair] for each in row}
    others = {*level.blocked, *level.exit_places, *level.exits, *entered(world)}
    # Where boxes come to stand, the robot need not.
    others |= {cell for values, _ in level.reached for cell in level.boxes_in(values)}
    missed = {*level.cells} - cells - others
    messages = [each.message for each in found(world, "BR502")]
    assert len(messages) == bool(missed)
    if len(missed) > 1:
        assert messages[0].startswith(f"{len(missed)} cells ")


def entered(world: dict[str, Any]) -> list[tuple[int, int]]:
    """Return the cells of warps that act on entering, in which nobody stands."""
    warps = [warp for warp in world.get("warps", []) if warp.get("when", "enter") == "enter"]
    return [cell for warp in warps for cell in cells_of(warp["at"])]
