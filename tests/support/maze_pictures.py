"""What `docs/mazes.md` shows of the algorithms: a picture of each, and measured numbers."""

from __future__ import annotations

from statistics import mean

from babyrobot_levels.analysis.metrics import metrics
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.mazes import ALGORITHMS, carve_many
from support.places import DOCS

DOCUMENT = DOCS / "mazes.md"
FOLDER = DOCUMENT.parent / "images" / "mazes"

THEME = {
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
LOOKS = {"start_text": False, "exit_text": False, "robot": {"show": False}}

SIZE, SEEDS = 16, range(100)
STRAIGHT = (1 | 4, 2 | 8)
EAST = 2


def pictures() -> dict[str, str]:
    """Return the pictures by the names of their files."""
    found = {f"{name}.svg": picture(name) for name in ALGORITHMS}
    return found | {"depth-first-loops.svg": picture("depth-first", loops=1.0)}


def picture(algorithm: str, loops: float = 0.0) -> str:
    """Return one picture: all have the same size and seed."""
    level = Level.model_validate(
        {
            "version": 1,
            "title": f"A maze, {algorithm}" + " with loops" * bool(loops),
            "size": (24, 10),
            "maze": {"seed": 42, "algorithm": algorithm, "loops": loops},
            "theme": THEME,
            "display": LOOKS,
        }
    )
    return level.to_svg()


def table() -> str:
    """Return the numbers that the document tells, as its table."""
    lines = [
        "| algorithm | dead ends | junctions | straight on | east or west | corner to corner |",
        "|---|---:|---:|---:|---:|---:|",
    ]
    for name in ALGORITHMS:
        cells = " | ".join(f"{number:.0f}" for number in numbers(name))
        lines.append(f"| `{name}` | {cells} |")
    return "\n".join(lines) + "\n"


def numbers(algorithm: str) -> tuple[float, ...]:
    """Return what is measured: four shares in percent, and steps."""
    rows = []
    for sides in carve_many(SIZE, SIZE, bytes(SIZE * SIZE), 0, SEEDS, algorithm, 0.0):
        counts = [sum(bits.bit_count() == n for bits in sides) for n in range(5)]
        rows.append(
            (
                100 * counts[1] / len(sides),
                100 * (counts[3] + counts[4]) / len(sides),
                100 * sum(bits in STRAIGHT for bits in sides) / counts[2],
                100 * sum(bool(bits & EAST) for bits in sides) / (len(sides) - 1),
            )
        )
    ways = []
    for seed in SEEDS:
        fields = {
            "version": 1,
            "size": (SIZE, SIZE),
            "maze": {"seed": seed, "algorithm": algorithm},
        }
        ways.append(metrics(Level.model_validate(fields)).path_length or 0)
    return (*map(mean, zip(*rows, strict=True)), mean(ways))
