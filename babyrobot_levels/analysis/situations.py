"""The configurations of a level in words, and as plain data: what is held, on, and where."""

from __future__ import annotations

from typing import Any

from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.configurations import Configuration


def situation(level: Level, number: int) -> dict[str, Any]:
    """Return what each thing of a level is in a configuration, by name.

    Items are `"held"` or the cell in which they lie, switches `"on"` or `"off"`, movers and a
    drawn exit are the cells in which they are.
    """
    found = level.configuration(number)
    exits = [list(found.exits[0])] if level.exit_one_of is not None else []
    items = ["held" if cell is None else list(cell) for cell in found.items]
    switches = ["on" if is_on else "off" for is_on in found.on]
    movers = [list(cell) for cell in found.movers]
    return dict(zip(level.things().names, [*exits, *items, *switches, *movers], strict=True))


def situation_words(level: Level, number: int) -> str:
    """Return what distinguishes a configuration: "key held, lever on, guard at [2, 4]".

    Items that lie in their only place and switches that are off go without saying.
    """
    if not level.has_things:
        return ""
    found = level.configuration(number)
    return ", ".join(_parts(level, found))


def _parts(level: Level, found: Configuration) -> list[str]:
    names = level.things().names
    movers = names[len(names) - len(found.movers) :]
    parts = [] if level.exit_one_of is None else [f"exit at {_cell(found.exits[0])}"]
    for item, cell in zip(level.items, found.items, strict=True):
        if cell is None:
            parts.append(f"{item.name} held")
        elif len(item.places) > 1:
            parts.append(f"{item.name} at {_cell(cell)}")
    parts += [s.name + " on" for s, is_on in zip(level.switches, found.on, strict=True) if is_on]
    parts += [f"{name} at {_cell(cell)}" for name, cell in zip(movers, found.movers, strict=True)]
    return parts


def _cell(cell: tuple[int, int]) -> str:
    return f"[{cell[0]}, {cell[1]}]"
