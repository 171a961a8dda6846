"""A first level file: commented, valid at once, and easy to change."""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass

from babyrobot_levels.mdp.mazes import carve
from babyrobot_levels.mdp.mazes.draws import below
from babyrobot_levels.text.emitter import scalar

TEMPLATES = ("grid", "maze", "drawing")


@dataclass(frozen=True, slots=True)
class Order:
    """What a new level shall be. `maze_seed` None means that it has no maze."""

    name: str
    template: str = "grid"
    size: tuple[int, int] = (8, 5)
    maze_seed: int | None = None
    algorithm: str = "depth-first"
    loops: float = 0.0
    puddles: int = 0
    theme: str = "default"


def starter(order: Order, schema: str | None) -> str:
    """Return the text of a new level file.

    Args:
        order: what it shall be.
        schema: where editors find the JSON schema, as the file's first line names it; None for
            no such line.

    Raises:
        ValueError: there is no room for that many puddles.
    """
    title = order.name.replace("-", " ").capitalize()
    head = f"# yaml-language-server: $schema={schema}\n" if schema else ""
    head += f"""\
# A grid world. Coordinates are [x, y] from the top-left cell, [0, 0]; sides are N, E, S and W.
version: 1
name: {scalar(order.name)}
title: {scalar(title)}
description: A new level.  # say what it is about

"""
    body = _drawing(order) if order.template == "drawing" else _fields(order)
    return head + body + _rest(order)


def _fields(order: Order) -> str:
    width, height = order.size
    roomy = width > 2 and height > 2
    maze, exit_ = "", (width - 1, height - 1)
    if order.maze_seed is not None or order.template == "maze":
        seed = order.maze_seed if order.maze_seed is not None else 42
        exit_ = _exit_of_maze(order, seed)
        parts = [f"seed: {seed}"]
        if order.algorithm != "depth-first":
            parts.append(f"algorithm: {order.algorithm}")
        if order.loops:
            parts.append(f"loops: {scalar(order.loops)}")
        maze = f"maze: {{{', '.join(parts)}}}  # the same seed grows the same maze\n"
    cells = _free_cells(width, height, [(0, 0), exit_])
    puddles = _puddle_lines(_puddle_cells(order, cells))
    walls = (
        "# walls:  # on N and S, `length` goes on to the east, on E and W to the south\n"
        "#   - {at: [1, 0], side: E, length: 2}\n"
    )
    return f"""\
size: [{width}, {height}]  # width and height in cells
start: [0, 0]
exit: [{exit_[0]}, {exit_[1]}]  # entering it ends the episode
{maze}\
{walls if roomy else ""}\
{puddles if roomy or order.puddles else ""}\
"""


def _exit_of_maze(order: Order, seed: int) -> tuple[int, int]:
    """Return the dead end that is nearest to the lower right corner; without one, that corner.

    An exit in a corridor would keep the robot from what lies behind it.
    """
    width, height = order.size
    is_open = carve(width, height, bytes(width * height), 0, seed, order.algorithm, order.loops)
    x, y = width - 1, height - 1
    dead_ends = (
        divmod(cell, width)[::-1]
        for cell, sides in enumerate(is_open)
        if sides.bit_count() == 1 and cell != 0
    )
    nearest = min((((x - i) ** 2 + (y - j) ** 2, i, j) for i, j in dead_ends), default=(0, x, y))
    return nearest[1:]


def _drawing(order: Order) -> str:
    width, height = order.size
    cells = [[" "] * width for _ in range(height)]
    cells[0][0], cells[-1][-1] = "S", "E"
    free = _free_cells(width, height, [(0, 0), (width - 1, height - 1)])
    for number, (x, y) in enumerate(_puddle_cells(order, free)):
        cells[y][x] = "O" if number % 2 else "o"
    border = "  +" + "---+" * width + "\n"
    between = "  +" + "   +" * width + "\n"
    rows = ["  |" + " ".join(f" {cell} " for cell in row) + "|\n" for row in cells]
    return f"""\
# S start, E exit, o small puddle, O large puddle, ### blocked; --- and | are walls.
map: |
{border}{between.join(rows)}{border}\
"""


def _puddle_lines(cells: Sequence[tuple[int, int]]) -> str:
    if not cells:
        return (
            "# puddles:  # slippery and costly; small or large\n#   - {at: [1, 1], size: small}\n"
        )
    lines = [
        f"  - {{at: [{x}, {y}], size: {'large' if number % 2 else 'small'}}}\n"
        for number, (x, y) in enumerate(cells)
    ]
    return "puddles:  # slippery and costly; small or large\n" + "".join(lines)


def _rest(order: Order) -> str:
    theme = "# theme: black_orange" if order.theme == "default" else f"theme: {scalar(order.theme)}"
    return f"""\

# rewards: {{step: -1, exit: 0}}  # as they are if nothing is said
# max_steps: 100  # the episode is cut off after so many steps
{theme}  # default, black_orange, blue_green, green, high_contrast, print
"""


def _free_cells(width: int, height: int, taken: Sequence[tuple[int, int]]) -> list[tuple[int, int]]:
    return [(x, y) for y in range(height) for x in range(width) if (x, y) not in taken]


def _puddle_cells(order: Order, free: list[tuple[int, int]]) -> list[tuple[int, int]]:
    """Return as many cells as there shall be puddles, drawn from the maze's seed."""
    if order.puddles > len(free):
        raise ValueError(
            f"there is no room for {order.puddles} puddle{'s' * (order.puddles > 1)}: "
            f"{len(free)} cells are free beside start and exit"
        )
    rng = random.Random(order.maze_seed or 0)
    return [free.pop(below(rng, len(free))) for _ in range(order.puddles)]
