"""MiniGrid: the text of `pprint_grid`, two characters a cell: an object and its colour."""

from __future__ import annotations

from babyrobot_levels.convert.blocks import drawn, text_rows, without_ring, without_surroundings
from babyrobot_levels.convert.conversion import Conversion, ConversionError, Lost, World
from babyrobot_levels.convert.marks import ENDS, LAVA_COLOR, block_map
from babyrobot_levels.language import drawing as d
from babyrobot_levels.language.moves import Rewards
from babyrobot_levels.library.level import Level
from babyrobot_levels.text.source import Position, SourceFile

PLACE = "a MiniGrid text"
REWARDS = Rewards(step=0, exit=1)
LAVA = "~"
COLORS = "RGBPY"
"""Red, green or grey, blue, purple, yellow."""

AGENTS = (">>", "VV", "<<", "^^")
_OBJECTS = {"W": d.BLOCKED, "G": d.EXIT, "V": LAVA, "F": d.PLAIN}
_LEFT_OUT = {"D": "doors", "L": "locked doors", "K": "keys", "A": "balls", "B": "boxes"}
_KNOWN = (
    "two characters a cell: WG wall, GG goal, VR lava, `>>` the agent, two blanks free; "
    "F, D, L, K, A and B with a colour are floor, doors, keys, balls and boxes"
)


def read_minigrid(source: SourceFile) -> World:
    """Return the world of a MiniGrid text: its walls are blocked cells."""
    lines = text_rows(source)
    lost: dict[str, Lost] = {}
    rows = []
    for y, line in enumerate(lines):
        line += " " * (len(line) % 2)
        pairs = [line[x : x + 2] for x in range(0, len(line), 2)]
        rows.append("".join(_cell(source, pair, x, y, lost) for x, pair in enumerate(pairs)))
    cells = without_ring(without_surroundings(tuple(rows)))
    fields = {"version": 1, **drawn(cells)}
    comments = {"rewards": "Without what MiniGrid takes off for each step."}
    if any(LAVA in row for row in cells):
        fields["legend"] = {LAVA: {"color": LAVA_COLOR, "ends": True}}
        comments["legend"] = "Lava ends the episode."
    fields["rewards"] = {"step": 0, "exit": 1}
    return World(fields, "A text of MiniGrid's pprint_grid.", comments, tuple(lost.values()))


def _cell(source: SourceFile, pair: str, x: int, y: int, lost: dict[str, Lost]) -> str:
    if pair == "  ":
        return d.PLAIN
    if pair in AGENTS:
        lost["agent"] = Lost("agent", "the robot has no heading, and moves in four directions")
        return d.START
    kind, color = pair[0], pair[1]
    if pair == "__":
        kind = "D"
    elif kind not in _OBJECTS | _LEFT_OUT or color not in COLORS:
        raise _unknown(source, pair, x, y)
    if kind in _LEFT_OUT:
        lost[kind] = Lost(kind, f"{_LEFT_OUT[kind]} are left out: their cells are free")
        return d.PLAIN
    if kind == "F":
        lost[kind] = Lost(kind, "floor has the colour of the theme")
    return _OBJECTS[kind]


def _unknown(source: SourceFile, pair: str, x: int, y: int) -> ConversionError:
    above = next(number for number, line in enumerate(source.lines) if line.strip())
    place = Position(above + y + 1, 2 * x + 1)
    return ConversionError.at(source, place, f"`{pair}` is no cell of MiniGrid", _KNOWN)


def write_minigrid(level: Level) -> Conversion:
    """Return a level as a MiniGrid text, with a ring of walls and an agent that looks east."""
    rows, lost = block_map(level, PLACE, REWARDS, ends=None, many="E")
    pairs = {d.BLOCKED: "WG", d.PLAIN: "  ", d.START: ">>", d.EXIT: "GG", ENDS: "VR"}
    text = "\n".join("".join(map(pairs.__getitem__, row)) for row in rows)
    return Conversion(f"{text}\n", tuple(lost))
