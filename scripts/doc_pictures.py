"""The pictures that pages of the documentation show, and a table of measured numbers."""

from __future__ import annotations

import io
from statistics import mean

from PIL import Image

import babyrobot_levels as brl
from babyrobot_levels.analysis.metrics import metrics
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.mazes import ALGORITHMS, carve_many
from babyrobot_levels.render.raster import to_png
from babyrobot_levels.render.scene.shapes import Path, Rect, Scene, Shape, rounded, scaled, shifted

# -- mazes -------------------------------------------------------------------------------------

_THEME = {
    "colors": {
        "base": "#ffffff",
        "lines": "#ffffff",
        "start": "#d9d9d9",
        "exit": "#d9d9d9",
        "walls": "#1f2937",
        "border": "#1f2937",
    },
    "widths": {"walls": 10, "border": 12},
}
_LOOKS = {"start_text": False, "exit_text": False, "robot": {"show": False}}

_SIZE, _SEEDS = 16, range(100)
_STRAIGHT = (1 | 4, 2 | 8)
_EAST = 2


def maze(algorithm: str, loops: float = 0.0) -> str:
    """Return the picture of an algorithm: all have the same size and seed."""
    level = Level.model_validate(
        {
            "version": 1,
            "title": f"A maze, {algorithm}" + " with loops" * bool(loops),
            "size": (24, 10),
            "maze": {"seed": 42, "algorithm": algorithm, "loops": loops},
            "theme": _THEME,
            "display": _LOOKS,
        }
    )
    return level.to_svg()


def maze_table() -> str:
    """Return the table of numbers that the page on mazes tells."""
    lines = [
        "| algorithm | dead ends | junctions | straight on | east or west | corner to corner |",
        "|---|---:|---:|---:|---:|---:|",
    ]
    for name in ALGORITHMS:
        cells = " | ".join(f"{number:.0f}" for number in _numbers(name))
        lines.append(f"| `{name}` | {cells} |")
    return "\n".join(lines) + "\n"


def _numbers(algorithm: str) -> tuple[float, ...]:
    """Return what is measured: four shares in percent, and steps."""
    rows = []
    for sides in carve_many(_SIZE, _SIZE, bytes(_SIZE * _SIZE), 0, _SEEDS, algorithm, 0.0):
        counts = [sum(bits.bit_count() == n for bits in sides) for n in range(5)]
        rows.append(
            (
                100 * counts[1] / len(sides),
                100 * (counts[3] + counts[4]) / len(sides),
                100 * sum(bits in _STRAIGHT for bits in sides) / counts[2],
                100 * sum(bool(bits & _EAST) for bits in sides) / (len(sides) - 1),
            )
        )
    ways = []
    for seed in _SEEDS:
        fields = {
            "version": 1,
            "size": (_SIZE, _SIZE),
            "maze": {"seed": seed, "algorithm": algorithm},
        }
        ways.append(metrics(Level.model_validate(fields)).path_length or 0)
    return (*map(mean, zip(*rows, strict=True)), mean(ways))


# -- things ------------------------------------------------------------------------------------

_VAULT = {
    "version": 1,
    "title": "A vault with a key, two gems and two guards",
    "size": [8, 5],
    "start": [0, 2],
    "exit": [7, 2],
    "exit_needs": "gem",
    "walls": [
        {"at": [4, 0], "side": "E", "length": 5},
        {"at": [0, 0], "side": "S", "length": 2},
        {"at": [3, 0], "side": "S", "length": 2},
    ],
    "openings": [{"at": [4, 2], "side": "E"}],
    "items": [
        {"name": "key", "at": [0, 0]},
        {"name": "coin", "at": [4, 4], "reward": 3},
        {"name": "gem", "one_of": [[6, 0], [6, 4]]},
    ],
    "doors": [
        {"at": [4, 2], "side": "E", "needs": "key"},
        {"at": [2, 0], "side": "S", "needs": "lever", "color": "#5b8def"},
    ],
    "switches": [{"name": "lever", "at": [0, 4], "color": "#5b8def"}],
    "movers": [
        {"path": [[2, 2], [2, 3], [3, 3], [3, 2]]},
        {"within": {"at": [6, 1], "size": [2, 1]}, "start": [6, 1]},
    ],
    "theme": "blue_green",
}


def things(*held: str) -> str:
    """Return the picture of a vault; with what the robot holds, of what is best then."""
    level = Level.from_fields(_VAULT)
    return level.to_svg(policy="best", held=held) if held else level.to_svg()


# -- answers -----------------------------------------------------------------------------------

ANSWERED = (
    "final-maze",
    "river-crossing",
    "teleport-pads",
    "cliff-walking",
    "gridworld-3-5",
    "frozen-lake",
    "frozen-lake-dry",
    "treasure-chests",
)


def answer(name: str) -> bytes:
    """Return the picture of a level of the gallery with values and arrows, as a PNG file."""
    return reduced(brl.load(name).to_png(values=True, policy=True, scale=40 / 64), 96)


def large_answer(side: int) -> bytes:
    """Return the picture of a large maze with the colours of its values, as a PNG file."""
    maze = brl.Level(version=1, size=(side, side), maze={"seed": 1})
    return reduced(maze.to_png(values=True, scale=10 / 64), 96)


def reduced(picture: bytes, colors: int) -> bytes:
    """Return a PNG file with few colours, which make it small."""
    buffer = io.BytesIO()
    image = Image.open(io.BytesIO(picture)).convert("RGB")
    image.quantize(colors).save(buffer, "PNG", optimize=True)
    return buffer.getvalue()


# -- sheets ------------------------------------------------------------------------------------

_SCALE, _GAP = 0.9, 12.0


def sheet() -> bytes:
    """Return the picture of a sheet and its key, side by side, as a PNG file."""
    levels = ("frozen-lake", "gridworld-3-5", "first-key")
    shapes: list[Shape] = []
    left = _GAP
    for key in (False, True):
        [page] = brl.sheet(levels, title="Value iteration", grids=3, key=key).pages
        width, height = _SCALE * page.width, _SCALE * page.height
        shapes.append(Rect(left, _GAP, width, height, "white"))
        shapes.append(Path(rounded(left, _GAP, width, height, 0), stroke="#b0b0b0"))
        shapes += shifted(scaled(page.shapes, _SCALE), left, _GAP)
        left += width + _GAP
    return to_png(Scene(left, height + 2 * _GAP, tuple(shapes)), colors=32)
