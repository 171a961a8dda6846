"""Plans for many agents, checked: whether they are free of conflicts, and what they cost.

This is multi-agent path finding on the maps of MovingAI: all agents move at once, by one cell to a
side or not at all, and stay at their goals. It takes no joint tables, and so hundreds of agents.
"""

from __future__ import annotations

import math
import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.extensions.formats.conversion import ConversionError
from babyrobot_levels.extensions.formats.movingai import plain_cells, rows_of_map, scenarios_of
from babyrobot_levels.extensions.robots.level_plans import Fault, Walk
from babyrobot_levels.extensions.robots.plan_files import Cells, count_fault, read_plan
from babyrobot_levels.language import drawing as d
from babyrobot_levels.language.geometry import Cell, show_cell
from babyrobot_levels.language.share_code import is_code
from babyrobot_levels.library.catalogue import LevelLike, load
from babyrobot_levels.library.level import Level
from babyrobot_levels.text import budget
from babyrobot_levels.text.files import read_source
from babyrobot_levels.text.source import START, Position
from babyrobot_levels.text.words import Telling, listed

_CELL = 1
"""The steps of work for a cell of the map, each time."""

_FAULTS = {
    "start": "{who} begins at {cell}, which is not its start",
    "outside": "{who} is off the map at time {time}, at {cell}",
    "blocked": "{who} is in the blocked cell {cell} at time {time}",
    "jump": "{who} comes to {cell} at time {time}, which is not beside the cell that it leaves",
    "edge": "{who} change places at time {time}, the first of them to {cell}",
    "vertex": "{who} are both at {cell} at time {time}",
    "goal": "{who} ends at {cell}, which is not its goal",
    "kept": "{who} is kept from {cell} at time {time}, by a wall, a door or another robot",
    "over": "the episode is over at time {time}, before {who} is at its goal",
}


@dataclass(frozen=True)
class PlanFault(Telling, public=True):
    """What is wrong with a plan.

    Attributes:
        kind: `"start"` or `"goal"`, it begins or ends elsewhere; `"outside"`, off the map;
            `"blocked"`; `"jump"`, no move to a neighbour; `"vertex"`, two agents in one cell;
            `"edge"`, two agents that change places; in a level also `"kept"`, what is in the way
            of a robot, and `"over"`, the episode ends before.
        agents: the numbers of the agents, counted from 1 as the scenarios are.
        time: after how many steps.
        cell: where the first of them is then, `(x, y)`.
    """

    kind: str
    agents: tuple[int, ...]
    time: int
    cell: Cell

    def __str__(self) -> str:
        who = f"agent{'s' * (len(self.agents) > 1)} {listed([*map(str, self.agents)])}"
        return _FAULTS[self.kind].format(who=who, time=self.time, cell=show_cell(self.cell))


@dataclass(frozen=True)
class PlanCheck(Telling, public=True):
    """What a plan for many agents is worth.

    Attributes:
        agents: how many they are.
        fault: the first that is wrong with it; None if it is valid.
        sum_of_costs: the sum over all agents of the steps until they are at their goals for good.
            None for a plan that is not valid.
        makespan: the largest of these.
        sum_of_costs_lower_bound: the sum of the lengths of all shortest paths: no plan costs less.
            None where a goal cannot be reached, and in a level of one's own.
        makespan_lower_bound: the largest of these.
    """

    agents: int
    fault: PlanFault | None
    sum_of_costs: int | None
    makespan: int | None
    sum_of_costs_lower_bound: int | None
    makespan_lower_bound: int | None

    @property
    def is_valid(self) -> bool:
        """Whether nothing is wrong with the plan."""
        return self.fault is None


def check_plan(
    plan: str | os.PathLike[str] | Sequence[Sequence[Cell]],
    scen: LevelLike,
    map_file: str | os.PathLike[str] | None = None,
    *,
    agents: int | None = None,
) -> PlanCheck:
    """Check a plan of multi-agent path finding, as `babyrobot check-plan` does.

    Args:
        plan: a file of the MAPF tracker, or of PIBT or LaCAM; or the cells of each agent, one for
            each time, `[agents][steps + 1][2]`. An agent with fewer stays in the last one.
        scen: MovingAI's file of scenarios, the first of which are the agents; or a level with
            several robots: a name, a share code, or a file (`.yaml`), a mapping or a `Level`, which
            may also come first. Its own rules are followed, in which nothing may happen by chance:
            a robot is at its goal when it has arrived at its exit, and there are no lower bounds.
        map_file: the map; by default, that which the scenarios name, in the same folder.
        agents: how many agents the plan must have; of several plans in a file, which.

    Raises:
        LevelNotFoundError: there is no such level.
        LevelError: a file cannot be read, or is not what it should be.
        ValueError: the cells are not of this shape.
    """
    if _is_level(plan):
        plan, scen = cast(Any, scen), cast(Any, plan)
    if _is_level(scen):
        return _check_in_level(plan, load(scen))
    if names_level(scen):
        return _check_in_level(plan, load(str(scen)))
    assert isinstance(scen, str | os.PathLike)
    field = _Field.of(Path(scen), None if map_file is None else Path(map_file))
    readings = [(cells, field.fault(cells)) for cells in field.readings(plan, agents)]
    # Of two readings, the one that is the right way up goes wrong later, if it does.
    cells, fault = max(readings, key=lambda each: math.inf if each[1] is None else each[1].time)
    count = cells.shape[1]
    starts, goals = field.starts[:count], field.goals[:count]
    costs = None if fault else _costs(cells, goals)
    alone = _distances(field.free, starts, goals)
    return PlanCheck(count, fault, *_totals(costs), *_totals(alone if alone.min() >= 0 else None))


def _is_level(given: Any) -> bool:
    if isinstance(given, str | os.PathLike):
        return Path(given).suffix.lower() in (".yaml", ".yml")
    return isinstance(given, Level | Mapping)


def names_level(given: Any) -> bool:
    """Return whether what should be scenarios is a share code, or a name and no file."""
    if not isinstance(given, str | os.PathLike):
        return False
    path = Path(given)
    return is_code(str(given)) or not (path.suffix or path.exists())


def _check_in_level(plan: Any, level: Level) -> PlanCheck:
    """Check a plan for the robots of a level."""
    walk = Walk(level)
    readings = walk.read(Path(plan)) if isinstance(plan, str | os.PathLike) else [_aligned(plan)]
    count, found = len(walk.starts), []
    for cells in readings:
        if wrong := count_fault(cells.shape[1], count, count):
            raise ValueError(wrong)
        away = np.flatnonzero((cells[0] != walk.starts).any(axis=1)).tolist()
        fault: Fault | None
        fault, costs = walk.take(cells)
        if away:
            fault = "start", (away[0],), 0
        found.append((math.inf if fault is None else fault[2], fault, cells, costs))
    _, fault, cells, costs = max(found, key=lambda each: each[0])
    if fault is None:
        return PlanCheck(count, None, int(costs.sum()), int(costs.max()), None, None)
    kind, agents, time = fault
    numbers = tuple(agent + 1 for agent in agents)
    told = PlanFault(kind, numbers, time, tuple(cells[time, agents[0]].tolist()))
    return PlanCheck(count, told, None, None, None, None)


def _totals(costs: NDArray[np.intp] | None) -> tuple[int, int] | tuple[None, None]:
    """Return the sum of costs, and the largest."""
    return (None, None) if costs is None else (int(costs.sum()), int(costs.max()))


def _costs(cells: Cells, goals: Cells) -> NDArray[np.intp]:
    """Return for each agent the steps after which it is at its goal for good."""
    away = (cells != goals).any(axis=2)
    return np.where(away.any(axis=0), len(cells) - away[::-1].argmax(axis=0), 0)


@dataclass(frozen=True, eq=False)
class _Field:
    """A map, and the agents of its scenarios.

    Attributes:
        name: the file of scenarios.
        free: which cells are free, `[height, width]`.
        starts: where agents start, `[scenarios, 2]`.
        goals: their goals, `[scenarios, 2]`.
    """

    name: str
    free: NDArray[np.bool_]
    starts: Cells
    goals: Cells

    @staticmethod
    def of(scen: Path, map_file: Path | None) -> _Field:
        """Read a map and its scenarios."""
        source = read_source(scen)
        agents = scenarios_of(source)
        if not agents:
            raise ConversionError.at(source, START, "there are no scenarios")
        there = read_source(map_file or scen.parent / agents[0].map)
        free = np.array([list(plain_cells(row)) for row in rows_of_map(there)[0]]) == d.PLAIN
        for agent in agents:
            for x, y in (agent.start, agent.goal):
                if y >= len(free) or x >= len(free[0]) or not free[y, x]:
                    message = f"{show_cell((x, y))} is no free cell of the map {there.name}"
                    raise ConversionError.at(source, Position(agent.line, 1), message)
        starts, goals = (
            np.array([getattr(agent, end) for agent in agents], np.int32)
            for end in ("start", "goal")
        )
        return _Field(str(scen), free, starts, goals)

    def readings(self, plan: Any, agents: int | None) -> Iterator[Cells]:
        """Yield where agents are at each time, `[steps + 1, agents, 2]`; see `read_plan`."""
        if isinstance(plan, str | os.PathLike):
            yield from read_plan(Path(plan), self.name, self.starts, agents)
            return
        cells = _aligned(plan)
        if fault := count_fault(cells.shape[1], len(self.starts), agents):
            raise ValueError(fault)
        yield cells

    def fault(self, cells: Cells) -> PlanFault | None:
        """Return the first that is wrong with a plan."""
        count = cells.shape[1]
        return next(_faults(self.free, self.starts[:count], self.goals[:count], cells), None)


def _faults(
    free: NDArray[np.bool_], starts: Cells, goals: Cells, cells: Cells
) -> Iterator[PlanFault]:
    """Yield what is wrong, in the order of time. Only the first one is sure."""
    yield from _alone("start", (cells[0] != starts).any(axis=1), 0, cells[0])
    size, last, numbers = free.shape[::-1], np.zeros(0, np.intp), np.arange(len(starts))
    # Who is in each cell, -1 for nobody.
    holder = np.full(free.size, -1)
    for time, now in enumerate(cells):
        yield from _alone("outside", ((now < 0) | (now >= size)).any(axis=1), time, now)
        place = now @ np.array([1, size[0]])
        yield from _alone("blocked", ~free.ravel()[place], time, now)
        if time:
            far = np.abs(now - cells[time - 1]).sum(axis=1) > 1
            yield from _alone("jump", far, time, now)
            there = holder[place]
            changed = (there >= 0) & (there != numbers) & (place[there] == last)
            yield from _pairs("edge", changed, there, time, now)
        holder[last] = -1
        holder[place] = numbers
        yield from _pairs("vertex", holder[place] != numbers, holder[place], time, now)
        last = place
    yield from _alone("goal", (now != goals).any(axis=1), time, now)


def _distances(free: NDArray[np.bool_], starts: Cells, goals: Cells) -> NDArray[np.intp]:
    """Return the lengths of the shortest paths of agents, -1 where there is none."""
    parts = [slice(first, first + 64) for first in range(0, len(starts), 64)]
    return np.concatenate([_spread(free, starts[part], goals[part]) for part in parts])


def _spread(free: NDArray[np.bool_], starts: Cells, goals: Cells) -> NDArray[np.intp]:
    """Return the same of at most 64 agents.

    Each has a bit of the numbers that spread over the map, by a cell in each step.
    """
    begin, end = (tuple(cells[:, ::-1].T + 1) for cells in (starts, goals))
    bits = np.uint64(1) << np.arange(len(starts), dtype=np.uint64)
    reached = np.zeros(np.add(free.shape, 2), np.uint64)
    np.bitwise_or.at(reached, begin, bits)
    passable = np.where(free, ~np.uint64(0), np.uint64(0))
    inner, found, step = reached[1:-1, 1:-1], np.full(len(bits), -1), 0
    while True:
        found[(found < 0) & (reached[end] & bits != 0)] = step
        beside = reached[:-2, 1:-1] | reached[2:, 1:-1]
        beside |= reached[1:-1, :-2]
        beside |= reached[1:-1, 2:]
        beside |= inner
        beside &= passable
        if (found >= 0).all() or np.array_equal(beside, inner):
            return found
        inner[:] = beside
        step += 1
        budget.spend(_CELL * free.size)


def _aligned(plan: Any) -> Cells:
    """Return the cells of each agent as those of each time, of which all have as many."""
    paths = [[*path] for path in plan]
    steps = max(map(len, paths), default=0)
    if not paths or not all(paths):
        raise ValueError("a plan has a cell for each agent")
    cells = np.array([[*path, *[path[-1]] * (steps - len(path))] for path in paths])
    if cells.ndim != 3 or cells.shape[2] != 2 or cells.dtype.kind not in "iu":
        raise ValueError("the cells of a plan are pairs of integers, [agents][steps + 1][2]")
    return np.ascontiguousarray(cells.swapaxes(0, 1), np.int32)


def _alone(kind: str, is_wrong: NDArray[np.bool_], time: int, now: Cells) -> Iterator[PlanFault]:
    """Yield the fault of the first agent that is wrong."""
    for agent in np.flatnonzero(is_wrong)[:1].tolist():
        yield PlanFault(kind, (agent + 1,), time, tuple(now[agent].tolist()))


def _pairs(
    kind: str, is_wrong: NDArray[np.bool_], others: NDArray[np.intp], time: int, now: Cells
) -> Iterator[PlanFault]:
    """Yield the fault of the first agent that meets another one."""
    for fault in _alone(kind, is_wrong, time, now):
        (agent,) = fault.agents
        yield replace(fault, agents=(agent, int(others[agent - 1]) + 1))
