"""Rules of play on random levels: findings are true, and safe fixes do not change the MDP."""

from __future__ import annotations

import random
from collections.abc import Iterable
from typing import Any
from unittest.mock import patch

import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from oracles.things_reference import Reference
from support.handwriting import Scribe
from support.reading import read_level
from support.things import thing_worlds
from support.worlds import (
    LEGEND,
    World,
    decorated_worlds,
    drawings,
    inside,
    level_of,
    sometimes,
    with_walls_for_maze,
    worlds,
)

from babyrobot_levels.analysis.solver.evaluation import success_within
from babyrobot_levels.language.drawing import compose
from babyrobot_levels.library.level import Level
from babyrobot_levels.linter.optimal_policy import (
    endless_loop,
    is_within_limit,
    solution_of,
    surely_terminates,
)
from babyrobot_levels.linter.rules import all_rules
from babyrobot_levels.linter.runner import apply, fix, lint_source
from babyrobot_levels.linter.variants import gives
from babyrobot_levels.mdp import graph
from babyrobot_levels.mdp.states import Reach, reach_of
from babyrobot_levels.text.diagnostics import Diagnostic
from babyrobot_levels.text.emitter import emit
from babyrobot_levels.text.source import SourceFile

RULES = [rule for rule in all_rules() if rule.code < "BR6"]
INSIDE = ("walls", "openings", "puddles", "areas", "warps", "blocked")
"""Fields with lists of entries that can each be removed."""


@st.composite
def texts(draw: st.DrawFn) -> str:
    """Texts of random levels, some with a drawing, some with `max_steps`."""
    if draw(st.booleans()):
        world: World = draw(thing_worlds() if sometimes(draw, 6) else worlds(5))
    else:
        world = {"version": 1, "map": compose(draw(drawings(4))), "legend": LEGEND}
        assume(is_valid(emit(world)))
    if sometimes(draw, 3):
        world["max_steps"] = draw(st.integers(1, 30))
    if sometimes(draw, 3):
        world["discount"] = draw(st.sampled_from([0.5, 0.9, 0.99]))
    if sometimes(draw) and "maze" in world:
        world["maze"] = {**world["maze"], "loops": draw(st.sampled_from([0.05, 0.5]))}
    return emit(world)


def is_valid(text: str) -> bool:
    return read_level(SourceFile("x.yaml", text))[0] is not None


def loaded(text: str) -> Level:
    level, diagnostics = read_level(SourceFile("x.yaml", text))
    assert level is not None, "\n".join(map(str, diagnostics))
    return level


def found(text: str) -> list[Diagnostic]:
    return lint_source(SourceFile("x.yaml", text), RULES).diagnostics


untimed = settings(deadline=None, suppress_health_check=[HealthCheck.too_slow])


# -- fixes -------------------------------------------------------------------------------------


@pytest.mark.slow
@untimed
@given(texts())
def test_safe_fixes_do_not_change_the_mdp(text: str) -> None:
    """Each by itself, and all of them, after which none is left and nothing more changes."""
    digest = loaded(text).digest
    for each in found(text):
        if each.fix is not None:
            after = apply(each.fix.edits, SourceFile("x.yaml", text))
            assert after != text
            level = loaded(after)
            assert not each.fix.safe or level.digest == digest, f"{each}\n\n{text}\n{after}"
    fixed = fix(SourceFile("x.yaml", text), RULES)
    assert loaded(fixed.text).digest == digest
    left = [each for each in fixed.report.diagnostics if each.fix is not None and each.fix.safe]
    assert left == []


@pytest.mark.slow
@untimed
@given(decorated_worlds(), st.randoms(use_true_random=False), st.sampled_from([0.0, 0.1, 0.4]))
def test_fixing_twice_changes_nothing_more(world: World, rng: random.Random, chatty: float) -> None:
    text = Scribe(rng, chatty).write(world)
    once = fix(SourceFile("x.yaml", text), all_rules(), unsafe=True)
    twice = fix(SourceFile("x.yaml", once.text), all_rules(), unsafe=True)
    assert (twice.text, twice.count) == (once.text, 0)


# -- everything without findings has an effect ------------------------------------------------


def effects(level: Level) -> Any:
    """Return digest and grid, which includes walls that only the picture shows."""
    return level.digest, level.grid().wall_bits, level.grid().glass


def without(level: Level, field: str, number: int) -> Level | None:
    """Return the level without one entry of a list, None if it would not be valid."""
    data = level.to_dict()
    data[field] = [entry for index, entry in enumerate(data[field]) if index != number]
    if not data[field]:
        del data[field]
    text = emit(data)
    return loaded(text) if is_valid(text) else None


def must_matter(entry: World, level: Level) -> bool:
    """Return whether an entry must have an effect on the MDP.

    It need not if it sets a colour, if it is slippery where walls or wind prevent all moves, or if
    it is a wall between blocked cells in which an opening begins.
    """
    if {"color", "label", "width", "fit"} & {*entry}:
        return False
    if "side" in entry and level.openings and _is_between_blocked(entry, level):
        return False
    if {"side", "to"} & {*entry}:
        return True
    size = entry.get("size", [1, 1])
    cells = inside({"at": entry["at"], "size": size if isinstance(size, list) else [1, 1]})
    return level.wind is None and not cells & {*enclosed(level)}


def _is_between_blocked(wall: World, level: Level) -> bool:
    (x, y), (dx, dy) = (
        wall["at"],
        {"N": (0, -1), "E": (1, 0), "S": (0, 1), "W": (-1, 0)}[wall["side"]],
    )
    (width, height), blocked = level.size, level.grid().blocked_cells
    cells = [(x, y), (x + dx, y + dy)]
    inner = [(x, y) for x, y in cells if 0 <= x < width and 0 <= y < height]
    return all(blocked[y * width + x] for x, y in inner)


def enclosed(level: Level) -> list[tuple[int, int]]:
    """Return the free cells that are enclosed by walls."""
    grid, width = level.grid(), level.size[0]
    return [
        (cell % width, cell // width)
        for cell, sides in enumerate(grid.open_bits)
        if not sides and not grid.blocked_cells[cell]
    ]


@pytest.mark.slow
@untimed
@given(worlds(5))
def test_entries_without_findings_have_an_effect(world: World) -> None:
    """After all fixes, every entry that is left has an effect."""
    fixed = fix(SourceFile("x.yaml", emit(world)), RULES, unsafe=True)
    level = loaded(fixed.text)
    data, known = level.to_dict(), effects(level)
    # Walls with a gap are reported, but not fixed.
    gaps = any(each.code == "BR513" for each in fixed.report.diagnostics)
    for field in INSIDE:
        for number, entry in enumerate(data.get(field, []) if not gaps or field != "walls" else ()):
            if must_matter(entry, level):
                other = without(level, field, number)
                assert other is None or effects(other) != known, f"{field} {number}\n{fixed.text}"
    if "wind" in data:
        assert effects(level.replace(wind=None)) != known, fixed.text
    # The other side to which the robot skids may warp it back to where it was.
    if not {"wind", "warps"} & {*data} and "skid" in data and not enclosed(level):
        assert effects(level.replace(skid=None)) != known, fixed.text
    for name, value in data.get("rewards", {}).items():
        assert name == "step" or value is None or gives(level, name)


# -- reachability ------------------------------------------------------------------------------


def graph_of(world: World) -> tuple[Reference, dict[int, set[int]]]:
    """Return the reference implementation, and where one step can lead from each state."""
    reference = Reference(with_walls_for_maze(world))
    ahead = {
        state: {after for action in range(5) for _, after, *_ in reference.outcomes(state, action)}
        for state in range(reference.num_states)
        if not reference.is_terminal(state)
    }
    return reference, ahead


def closure(sources: Iterable[int], ahead: dict[int, set[int]]) -> dict[int, int]:
    """Return the fewest steps to each state that can be reached."""
    steps = dict.fromkeys(sources, 0)
    edge, count = list(steps), 0
    while edge:
        count += 1
        edge = [b for b in {b for a in edge for b in ahead.get(a, ())} if b not in steps]
        steps.update(dict.fromkeys(edge, count))
    return steps


def as_list(steps: dict[int, int], count: int) -> list[int]:
    return [steps.get(state, -1) for state in range(count)]


def reach(world: World) -> Reach:
    level = level_of(world)
    return reach_of(level, level.compile())


@pytest.mark.slow
@untimed
@given(worlds(5))
def test_reachable_states_are_those_of_the_reference(world: World) -> None:
    reference, ahead = graph_of(world)
    count = reference.width * reference.height
    back: dict[int, set[int]] = {}
    for origin, targets in ahead.items():
        for target in targets:
            back.setdefault(target, set()).add(origin)

    width: int = reference.width

    def state(cell: tuple[int, int]) -> int:
        return cell[1] * width + cell[0]

    ends = [
        state(cell)
        for cell in reference.cells
        if reference.over((), cell) and cell not in reference.blocked
    ]
    steps = closure(map(state, reference.starts), ahead)
    few = reach(world)
    assert list(few.steps) == as_list(steps, count)
    assert list(few.to_exit) == as_list(closure(map(state, reference.exits), back), count)
    assert list(few.to_end) == as_list(closure(ends, back), count)
    assert list(few.on) == [s in steps and not reference.is_terminal(s) for s in range(count)]
    # The algorithm for large levels gives the same.
    with patch.object(graph, "MANY", 0):
        many = reach(world)
        starts = [state for state, steps in enumerate(few.steps) if steps == 0]
        assert many.from_some([*starts, *starts]) == few.steps
        assert [*map(list, many.successors)] == [*map(list, few.successors)]
    assert (many.steps, many.on) == (few.steps, few.on)
    assert (many.to_exit, many.to_end) == (few.to_exit, few.to_end)


def codes(text: str) -> set[str]:
    return {each.code for each in found(text)}


@pytest.mark.slow
@untimed
@given(worlds(4), st.integers(1, 20))
def test_findings_about_reachability_are_exact(world: World, limit: int) -> None:
    unlimited, ways, level = codes(emit(world)), reach(world), level_of(world)
    limited = codes(emit({**world, "max_steps": limit}))
    width = level.size[0]
    starts = [y * width + x for x, y in level.starts]
    exits = [y * width + x for x, y in level.exits]
    shut = [state for state in starts if ways.to_exit[state] < 0]
    assert ("BR501" in limited) == bool(exits and shut)
    reached = [ways.reached(state) for state in exits]
    assert ("BR517" in limited) == (any(reached) and not all(reached))
    good = [state for state in starts if state not in shut]
    after = ways.from_some(good)
    trapped = [
        state for state, on in enumerate(ways.on) if on and after[state] >= 0 > ways.to_exit[state]
    ]
    assert ("BR503" in limited) == bool(good and trapped)
    assert ("BR511" in limited) == any(ways.to_exit[state] > limit for state in starts)
    assert "BR521" not in limited
    ends = any(ways.to_end[state] >= 0 for state in starts)
    assert ("BR521" in unlimited) == (not ends and not level.exits)


# -- the optimal policy ------------------------------------------------------------------------


@pytest.mark.slow
@untimed
@given(worlds(4), st.sampled_from([0.5, 0.9, 1.0]))
def test_rewards_alone_show_that_the_policy_terminates(world: World, discount: float) -> None:
    level = level_of({**world, "discount": discount})
    mdp, best = level.compile(), solution_of(level)
    assume(best is not None and surely_terminates(mdp, discount))
    assert best is not None
    assert endless_loop(mdp, reach_of(level, mdp), best) == []


@pytest.mark.slow
@untimed
@given(worlds(4), st.integers(1, 40), st.sampled_from([0.25, 0.5, 0.9]))
def test_the_probability_to_exit_in_time_is_exact(world: World, limit: int, share: float) -> None:
    level = level_of({**world, "max_steps": limit})
    best = solution_of(level)
    assume(best is not None and level.exits)
    assert best is not None
    exact = success_within(level, best)
    assume(abs(exact - share) > 1e-9)
    assert is_within_limit(level, best, share) == (exact >= share)


@pytest.mark.parametrize(("steps", "answer"), [(1, False), (2, True)])
def test_steps_are_counted_exactly(steps: int, answer: bool) -> None:
    level = level_of({"version": 1, "size": [3, 1], "max_steps": steps})
    best = solution_of(level)
    assert best is not None
    assert is_within_limit(level, best, 0.5) is answer
