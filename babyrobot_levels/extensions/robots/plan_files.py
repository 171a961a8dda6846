"""Plans of many agents as texts: of the MAPF tracker, and of the planners PIBT and LaCAM.

A plan of the tracker has a row of moves for each agent, `u d l r w`, also with run lengths (`5r`),
alone in a text or in a column of comma-separated values. That of a planner has below `solution=` a
line for each time with the places of all agents, `0:(1,2),(3,4),`.
"""

import re
from collections.abc import Iterator, Sequence
from pathlib import Path, PurePath
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.extensions.formats.conversion import ConversionError
from babyrobot_levels.text.files import read_source
from babyrobot_levels.text.source import START, Position, SourceFile

Cells = NDArray[np.int32]
"""The columns and rows of agents."""

MAX_BYTES = 16 << 20
"""The most bytes of a plan."""

MAX_STEPS = 100_000
"""The most steps of a plan."""

MAX_CELLS = 10_000_000
"""The most cells of a plan: agents times steps."""

MAX_FIELDS = 1_000_000
"""The most fields of a table of plans."""

_LINE_END = re.compile(r"\r\n|\r|\n")
_FIELD = re.compile(r'"((?:[^"]++|"")*+)"|([^",\r\n]*+)')
_MOVES = re.compile(r"(?:[0-9]{0,6}[udlrw])*+")
_RUN = re.compile(r"([0-9]+)([udlrw])")
_PLACES = re.compile(r"([0-9]{1,6}):(?:\([0-9]{1,6},[0-9]{1,6}\),?)++")
_BLANKS = str.maketrans("(),", "   ")
_STEPS = np.zeros((128, 2), np.int32)
_STEPS[[*b"udlr"]] = [(0, -1), (0, 1), (-1, 0), (1, 0)]


def read_plan(path: Path, scen: str, starts: Cells, agents: int | None) -> Iterator[Cells]:
    """Yield where the agents of a plan are at each time, `[steps + 1, agents, 2]`.

    Plans that were published before the tracker had the column `flip_up_down` go down by `u`. Where
    it is not told, that is a second reading.

    Args:
        path: the file.
        scen: the name of the file of scenarios: of several plans, that for it is taken.
        starts: the starts of all scenarios, `[scenarios, 2]`.
        agents: how many agents it is for; None for as many as it has.

    Raises:
        LevelError: the file cannot be read, is too large, is no plan, or has no such plan.
    """
    source, is_flipped = read_source(path, limit=MAX_BYTES), None
    if re.search(r"^solution=\s*$", source.text, re.M):
        cells, is_flipped = _of_planner(source), False
    elif "," in source.text.partition("\n")[0]:
        moves, at, is_flipped = _of_table(source, PurePath(scen).stem, agents)
        cells = _walked(source, moves, at, starts)
    else:
        cells = _walked(source, source.text.removesuffix("\n").removesuffix("\r"), START, starts)
    if fault := count_fault(cells.shape[1], len(starts), agents):
        raise ConversionError.at(source, START, fault)
    if not is_flipped:
        yield cells
    if is_flipped is not False:
        yield np.stack([cells[..., 0], 2 * cells[0, :, 1] - cells[..., 1]], axis=2)


def count_fault(count: int, most: int, agents: int | None) -> str | None:
    """Return why a plan has not as many agents as it should; None if it has."""
    if count <= most and agents in (None, count):
        return None
    wanted = f"there are {most:,} scenarios" if agents is None else f"not for {agents:,}"
    return f"the plan is for {count:,} agents, and {wanted}"


def _of_planner(source: SourceFile) -> Cells:
    """Return the places that a planner tells for each time."""
    first = next(n for n, line in enumerate(source.lines, 1) if line.strip() == "solution=") + 1
    rows: list[Cells] = []
    for number, line in enumerate(map(str.rstrip, source.lines[first - 1 :]), first):
        if line:
            rows.append(_places(source, number, line, rows))
    if not rows:
        raise ConversionError.at(source, Position(first - 1, 1), "the planner found no solution")
    return np.stack(rows)


def _places(source: SourceFile, number: int, line: str, before: Sequence[Cells]) -> Cells:
    """Return the places of a line, `[agents, 2]`."""
    found = _PLACES.match(line)
    if found is None or found.end() < len(line):
        place = Position(number, found.end() + 1 if found else 1)
        raise ConversionError.at(source, place, "this is no `TIME:(x,y),(x,y),` of a plan")
    if int(found[1]) != len(before):
        message = f"the time {found[1]} follows {len(before)} lines of others"
        raise ConversionError.at(source, Position(number, 1), message)
    text = line[found.end(1) + 1 :].translate(_BLANKS)
    cells = np.fromstring(text, np.int32, sep=" ").reshape(-1, 2)
    if before and len(cells) != len(before[0]):
        message = f"{len(cells):,} agents have a place, and {len(before[0]):,} at the time 0"
        raise ConversionError.at(source, Position(number, 1), message)
    _check_size(source, Position(number, 1), len(before), len(cells))
    return cells


def _check_size(source: SourceFile, place: Position, steps: int, agents: int) -> None:
    if steps > MAX_STEPS or (steps + 1) * agents > MAX_CELLS:
        message = (
            f"{agents:,} agents and {steps:,} steps are too many: a plan has {MAX_STEPS:,} steps, "
            f"and {MAX_CELLS:,} agents times steps at most"
        )
        raise ConversionError.at(source, place, message)


# -- moves -----------------------------------------------------------------------------------------


def _walked(source: SourceFile, text: str, at: Position, starts: Cells) -> Cells:
    """Return where rows of moves lead that begin at a place of a file."""
    rows = _LINE_END.split(text)
    if fault := count_fault(len(rows), len(starts), None):
        raise ConversionError.at(source, at, fault)
    columns = [at.column, *[1] * (len(rows) - 1)]
    places = [Position(at.line + n, column) for n, column in enumerate(columns)]
    steps = [_count_of(source, row, place) for row, place in zip(rows, places, strict=True)]
    _check_size(source, at, max(steps), len(rows))
    letters = np.full((max(steps) + 1, len(rows)), ord("w"), np.uint8)
    for agent, row in enumerate(rows):
        moves = _RUN.sub(lambda run: int(run[1]) * run[2], row)
        letters[1 : len(moves) + 1, agent] = np.frombuffer(moves.encode(), np.uint8)
    return starts[: len(rows)] + np.cumsum(_STEPS[letters], axis=0, dtype=np.int32)


def _count_of(source: SourceFile, row: str, at: Position) -> int:
    """Return how many moves there are in the row of an agent."""
    found = _MOVES.match(row)
    assert found is not None, "it may match nothing"
    if found.end() < len(row):
        place = Position(at.line, at.column + found.end())
        message = "this is none of the moves u, d, l, r and w, which may have counts, as in 5r"
        raise ConversionError.at(source, place, message)
    runs = [int(run[1]) - 1 - len(run[1]) for run in _RUN.finditer(row)]
    return len(row) + sum(runs)


# -- tables ----------------------------------------------------------------------------------------


class _Field(NamedTuple):
    text: str
    at: int


def _of_table(
    source: SourceFile, scen: str, agents: int | None
) -> tuple[str, Position, bool | None]:
    """Return the moves of a plan of a table, where they begin, and whether `u` goes down.

    It is the plan for some scenarios, and for so many agents.
    """
    head, *rows = _rows(source)
    names = [field.text for field in head]
    plan = next((name for name in ("solution_plan", "path") if name in names), None)
    if plan is None:
        message = "there is no column solution_plan or path"
        raise ConversionError.at(source, START, message)
    entries = [dict(zip(names, row, strict=False)) for row in rows]
    entries = [entry for entry in entries if plan in entry]
    if agents is not None:
        entries = [entry for entry in entries if _count(entry) in (None, str(agents))]
    if len(entries) > 1:
        entries = [entry for entry in entries if _scen(entry) == scen]
    if len(entries) != 1:
        told = "" if agents is None else f" for {agents} agents"
        message = f"there are {len(entries)} plans{told} for the scenarios {scen}"
        raise ConversionError.at(source, START, message, "give the number of agents")
    (entry,) = entries
    text, at = entry[plan]
    told = entry["flip_up_down"].text.upper() if "flip_up_down" in entry else ""
    is_flipped = {"TRUE": True, "FALSE": False}.get(told)
    begin = source.position(at + (source.text[at : at + 1] == '"'))
    return text, begin, is_flipped


def _count(entry: dict[str, _Field]) -> str | None:
    return next((entry[name].text for name in ("agents", "agent_count") if name in entry), None)


def _scen(entry: dict[str, _Field]) -> str:
    names = ("map_name", "scen_type", "type_id")
    return "-".join(entry[name].text for name in names if name in entry)


def _rows(source: SourceFile) -> Iterator[list[_Field]]:
    """Yield the rows of comma-separated values. Those of `csv` have no places, and end sooner."""
    text, at, count = source.text, 0, 0
    row: list[_Field] = []
    while at < len(text):
        count += 1
        if count > MAX_FIELDS:
            raise ConversionError.at(source, source.position(at), f"over {MAX_FIELDS:,} fields")
        found = _FIELD.match(text, at)
        assert found is not None, "it may match nothing"
        row.append(_Field((found[1] or found[2] or "").replace('""', '"'), at))
        at = found.end()
        end = _LINE_END.match(text, at)
        if end is None and text[at : at + 1] not in ("", ","):
            message = "a comma or the end of the line is missing"
            raise ConversionError.at(source, source.position(at), message)
        at = end.end() if end else at + 1
        if end or at >= len(text):
            yield row
            row = []
