"""MiniGrid's text, two characters a cell, as `pprint_grid` prints it."""

from __future__ import annotations

from babyrobot_levels.convert.blocks import (
    ENDS,
    block_map,
    place_of,
    replaced,
    text_rows,
    without_ring,
    without_surroundings,
)
from babyrobot_levels.convert.conversion import Conversion, ConversionError, World
from babyrobot_levels.convert.minigrids.levels import moved, world_of
from babyrobot_levels.convert.minigrids.snapshot import LAVA, Cell, Object, Snapshot
from babyrobot_levels.language import drawing as d
from babyrobot_levels.language.moves import Rewards
from babyrobot_levels.library.level import Level
from babyrobot_levels.text.source import SourceFile

REWARDS = Rewards(step=0, exit=1)
"""The rewards of MiniGrid's goals."""

_AGENTS = {">>": "E", "VV": "S", "<<": "W", "^^": "N"}
_CELLS = {"W": d.BLOCKED, "G": d.EXIT, "V": LAVA, "F": d.PLAIN}
_KINDS = {"D": "door", "L": "door", "K": "key", "A": "ball", "B": "box"}
_STATES = {"D": "closed", "L": "locked"}
_COLORS = {"R": "red", "G": "green", "B": "blue", "P": "purple", "Y": "yellow"}
"""G is grey as well: the text has one letter for both."""

_HELP = (
    "two characters a cell: WG wall, GG goal, VR lava, `>>` the agent, two blanks free; "
    "F, D, L, K, A and B with a colour are floor, doors, locked doors, keys, balls and boxes"
)


def read_minigrid(source: SourceFile) -> World:
    """Return the world of a MiniGrid text: its walls are blocked cells."""
    rows: list[str] = []
    objects: list[Object] = []
    agents: dict[Cell, str] = {}
    floor = False
    for y, line in enumerate(text_rows(source)):
        pairs = [line[x : x + 2].ljust(2) for x in range(0, len(line), 2)]
        marks = [d.PLAIN] * len(pairs)
        for x, pair in enumerate(pairs):
            kind, color = pair[0], pair[1]
            if pair in _AGENTS:
                agents[x, y] = _AGENTS[pair]
            elif pair == "__":
                # An open door has no colour.
                objects.append(Object("door", "grey", (x, y), "open"))
            elif kind in _KINDS and color in _COLORS:
                state = _STATES.get(kind, "")
                objects.append(Object(_KINDS[kind], _COLORS[color], (x, y), state))
            elif kind in _CELLS and color in _COLORS:
                marks[x] = _CELLS[kind]
                floor |= kind == "F"
            elif pair != "  ":
                message = f"unknown cell `{pair}`"
                raise ConversionError.at(source, place_of(source, 2 * x, y), message, _HELP)
        rows.append("".join(marks))
    whole = without_surroundings(replaced(tuple(rows), agents, d.START))
    inner = without_ring(whole)
    ring = int(len(inner) < len(whole))
    heading = next(iter(agents.values()), "E")
    found = Snapshot(whole, tuple(objects), tuple(agents), heading, floor=floor)
    return world_of(moved(found, inner, ring, ring), "A text of MiniGrid's pprint_grid.")


def write_minigrid(level: Level) -> Conversion:
    """Return a level as a MiniGrid text, with a ring of walls."""
    carried = frozenset({"heading"})
    rows, lost = block_map(level, "a MiniGrid text", REWARDS, ends=None, many="E", carried=carried)
    agent = next(pair for pair, heading in _AGENTS.items() if heading == level.heading)
    pairs = {d.BLOCKED: "WG", d.PLAIN: "  ", d.START: agent, d.EXIT: "GG", ENDS: "VR"}
    text = "\n".join("".join(map(pairs.__getitem__, row)) for row in rows)
    return Conversion(f"{text}\n", tuple(lost))
