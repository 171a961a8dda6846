"""What differs in the cells that two levels have in common, counted from the top-left corner."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.analysis.diff.changes import Change, Changes
from babyrobot_levels.language.base import MAX_SIZE, SIDES
from babyrobot_levels.language.cells import SkidRule, as_skid
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.actions import Action
from babyrobot_levels.mdp.compiler.terrain import RULES, build_terrain
from babyrobot_levels.mdp.tables import Mdp

Ints = NDArray[np.intp]

_SIZES = {"small": 1, "large": 2}


def common_cells(before: Level, after: Level) -> tuple[Ints, Ints]:
    """Return the numbers, in each of the levels, of the cells that both have, row by row."""
    width, height = (min(pair) for pair in zip(before.size, after.size, strict=True))
    y, x = np.mgrid[:height, :width]
    return (y * before.size[0] + x).ravel(), (y * after.size[0] + x).ravel()


def cell_changes(before: Level, after: Level, limit: int | None) -> Changes:
    """Return the cells with other properties: blocked, wet, slippery, costly, ending, warping."""
    cells = common_cells(before, after)
    tables = [
        _properties(level, where) for level, where in zip((before, after), cells, strict=True)
    ]
    # What is not given is nan, and equal to itself.
    equal = (tables[0] == tables[1]) | (np.isnan(tables[0]) & np.isnan(tables[1]))
    width = min(before.size[0], after.size[0])

    def tell(place: int) -> Change:
        one, two = (_told_cell(table[place]) for table in tables)
        return Change(one, two, (place % width, place // width))

    places = np.flatnonzero(~equal.all(axis=1)).tolist()
    return Changes.of(places, len(cells[0]), tell, limit)


def wall_changes(before: Level, after: Level, limit: int | None) -> Changes:
    """Return the sides between free cells that were opened, closed, or made of glass."""
    cells = common_cells(before, after)
    width = min(before.size[0], after.size[0])
    height = len(cells[0]) // width
    states = [_sides(level, where) for level, where in zip((before, after), cells, strict=True)]
    blocked = [level.grid().blocked.ravel() for level in (before, after)]
    free = ~(blocked[0][cells[0]] | blocked[1][cells[1]]).reshape(height, width)
    between = np.zeros((height, width, 2), np.bool_)
    between[:, :-1, 0] = free[:, :-1] & free[:, 1:]
    between[:-1, :, 1] = free[:-1] & free[1:]
    differing = np.argwhere(between.reshape(-1, 2) & (states[0] != states[1])).tolist()

    def tell(place: list[int]) -> Change:
        cell, side = place
        one, two = (_told_side(float(state[cell, side])) for state in states)
        return Change(one, two, (cell % width, cell // width), "ES"[side])

    return Changes.of(differing, int(between.sum()), tell, limit)


def transition_changes(before: Level, after: Level, limit: int | None) -> Changes:
    """Return the states and actions that have other outcomes."""
    cells = common_cells(before, after)
    mdps = (before.compile(), after.compile())
    rows = [_rows(mdp, where) for mdp, where in zip(mdps, cells, strict=True)]
    most = max(row.shape[2] for row in rows)
    one, two = (np.pad(row, ((0, 0), (0, 0), (0, most - row.shape[2]), (0, 0))) for row in rows)
    differ = (one != two).any(axis=(2, 3))
    width = min(before.size[0], after.size[0])

    def tell(place: list[int]) -> Change:
        cell, action = place
        one, two = (
            _told_outcomes(mdp, int(where[cell]), action)
            for mdp, where in zip(mdps, cells, strict=True)
        )
        return Change(one, two, (cell % width, cell // width), Action(action).name.lower())

    return Changes.of(np.argwhere(differ).tolist(), differ.size, tell, limit)


# -- cells ---------------------------------------------------------------------------------

BLOCKED, WET, REWARD, SKID, RULE, ENDS, WARP_TO, WARP_WHEN, WARP_REWARD = range(9)
"""The columns of the table of properties."""

_TO_START = -1
_WHEN = ("enter", "leave")


def _properties(level: Level, cells: Ints) -> NDArray[np.float64]:
    """Return what is special about each cell, `[cells, properties]`; nan for nothing special."""
    grid = level.grid()
    terrain = build_terrain(level, grid)
    table = np.full((terrain.reward.size, 9), np.nan)
    skid = as_skid(level.skid if level.skid is not None else 0.0)
    rule = RULES.index(SkidRule(skid.to))
    is_usual = (terrain.skid == skid.probability) & ((terrain.rule == rule) | (terrain.skid == 0))
    free = np.frombuffer(grid.blocked_cells, np.uint8) == 0
    table[~free, BLOCKED] = 1
    for puddle in level.puddles:
        table[_number(puddle.at, level), WET] = _SIZES[puddle.size]
    own = free & (terrain.reward != level.rewards.step)
    table[own, REWARD] = terrain.reward[own]
    own = free & ~is_usual
    table[own, SKID], table[own, RULE] = terrain.skid[own], terrain.rule[own]
    table[free & terrain.over & ~terrain.exit, ENDS] = 1
    for warp in level.warps:
        row = table[_number(warp.at, level)]
        x, y = (_TO_START, 0) if isinstance(warp.to, str) else warp.to
        row[WARP_TO], row[WARP_WHEN] = y * MAX_SIZE + x, _WHEN.index(warp.when)
        row[WARP_REWARD] = np.nan if warp.reward is None else warp.reward
    return table[cells]


def _told_cell(row: NDArray[np.float64]) -> dict[str, Any]:
    """Return what is special about a cell, as plain data."""
    given = {column: value for column, value in enumerate(row.tolist()) if value == value}
    told: dict[str, Any] = {}
    if BLOCKED in given:
        told["blocked"] = True
    if WET in given:
        told["puddle"] = [*_SIZES][int(given[WET]) - 1]
    if REWARD in given:
        told["reward"] = given[REWARD]
    if SKID in given:
        told["skid"] = {"probability": given[SKID], "to": RULES[int(given[RULE])].value}
    if ENDS in given:
        told["ends"] = True
    if WARP_TO in given:
        y, x = divmod(int(given[WARP_TO]), MAX_SIZE)
        to: Any = "start" if given[WARP_TO] == _TO_START else [x, y]
        told["warp"] = {"to": to, "when": _WHEN[int(given[WARP_WHEN])]}
        if WARP_REWARD in given:
            told["warp"]["reward"] = given[WARP_REWARD]
    return told


def _number(cell: tuple[int, int], level: Level) -> int:
    return cell[1] * level.size[0] + cell[0]


# -- sides ---------------------------------------------------------------------------------


def _sides(level: Level, cells: Ints) -> NDArray[np.float64]:
    """Return how each cell's sides E and S are, `[cells, 2]`: 2 open, 0 a wall, else glass."""
    grid = level.grid()
    east, south = SIDES.index("E"), SIDES.index("S")
    states = np.where(grid.open, 2.0, 0.0).reshape(-1, len(SIDES))
    for (cell, side), probability in grid.glass.items():
        states[cell, SIDES.index(side)] = probability
    return states[cells][:, [east, south]]


def _told_side(state: float) -> Any:
    return "open" if state == 2 else {"pass": state} if state else "wall"


# -- transitions ---------------------------------------------------------------------------


def _rows(mdp: Mdp, cells: Ints) -> NDArray[np.float64]:
    """Return all outcomes, `[cells, actions, outcomes, 4]`, with states numbered alike for all."""
    y, x = np.divmod(mdp.next_state[cells], mdp.width)
    parts = [mdp.probability[cells], y * MAX_SIZE + x, mdp.reward[cells], mdp.terminal[cells]]
    happens = mdp.probability[cells] > 0
    return np.stack([np.where(happens, part, 0).astype(np.float64) for part in parts], axis=-1)


def _told_outcomes(mdp: Mdp, state: int, action: int) -> list[dict[str, Any]]:
    return [
        {
            "cell": [next_state % mdp.width, next_state // mdp.width],
            "probability": probability,
            "reward": reward,
            "ends": terminal,
        }
        for probability, next_state, reward, terminal in mdp.outcomes(state, action)
    ]
