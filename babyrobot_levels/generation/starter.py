"""Templates of `babyrobot new-level`: level files that are commented, valid and easy to change."""

import os
import random
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from textwrap import indent
from typing import Any

from babyrobot_levels.analysis.solver.results import check_count
from babyrobot_levels.generation.locks import Counts, Placer
from babyrobot_levels.language.names import slug
from babyrobot_levels.language.plain_data import plain
from babyrobot_levels.library.level import Level, load_source, loads
from babyrobot_levels.mdp.mazes import carve
from babyrobot_levels.mdp.mazes.lattice import below
from babyrobot_levels.text.emitter import flow, scalar
from babyrobot_levels.text.files import schema_for, write_new
from babyrobot_levels.text.source import SourceFile
from babyrobot_levels.text.words import check_choice

TEMPLATES = ("grid", "maze", "drawing")

_LEGEND = """\
# S start, E exit, o small puddle, O large puddle, ### blocked; --- and | are walls.
"""


@dataclass(frozen=True, slots=True)
class StarterOptions:
    """What a new level is like. With `maze_seed` None it has no maze, unless by its template."""

    name: str
    template: str = "grid"
    size: tuple[int, int] = (8, 5)
    maze_seed: int | None = None
    algorithm: str = "depth-first"
    loops: float = 0.0
    puddles: int = 0
    theme: str = "default"
    key: bool = False
    coins: int = 0

    @property
    def has_things(self) -> bool:
        """Whether there is a key, or a coin."""
        return self.key or self.coins > 0


def new_level(
    name: str,
    path: str | os.PathLike[str] | None = None,
    *,
    template: str = "grid",
    size: tuple[int, int] = (8, 5),
    maze_seed: int | None = None,
    algorithm: str = "depth-first",
    loops: float = 0.0,
    puddles: int = 0,
    theme: str = "default",
    key: bool = False,
    coins: int = 0,
    force: bool = False,
) -> Level:
    """Write a new level file, with comments that explain it, as `babyrobot new-level` does.

    Args:
        name: the name of the level: lower-case letters, digits and `-`.
        path: the file; by default `levels/NAME.yaml`.
        template: `"grid"`, `"maze"` or `"drawing"`.
        size: width and height in cells.
        maze_seed: the seed of a maze; None for no maze, unless by the template.
        algorithm: the algorithm of the maze.
        loops: the share of the maze's dead ends to open.
        puddles: the number of puddles.
        theme: the name of a theme.
        key: whether there is a locked door on the way to the exit, and its key.
        coins: the number of coins.
        force: whether to replace an existing file.

    Returns:
        The level of the file.

    Raises:
        ValueError: an argument has an invalid value, or there is no room for what is asked for.
        LevelError: the level would not be valid: there is no such theme, or no such size.
        FileExistsError: there is a file, and `force` is not given.
    """
    if slug(name) != name:
        raise ValueError(f"a name has lower-case letters, digits and `-`, not {name!r}")
    check_choice("template", template, TEMPLATES)
    check_count("puddles", puddles, 0)
    check_count("coins", coins, 0)
    maze = {"seed": maze_seed or 0, "algorithm": algorithm, "loops": loops}
    grown = Level.from_fields({"version": 1, "size": size, "maze": maze})
    file = Path("levels", f"{name}.yaml") if path is None else Path(path)
    options = StarterOptions(
        name, template, grown.size, maze_seed, algorithm, loops, puddles, theme, key, coins
    )
    text = starter(options, schema_for(file))
    level = load_source(SourceFile(str(file), text), file)
    write_new(file, text, force=force)
    return level


def starter(options: StarterOptions, schema: str | None) -> str:
    """Return the text of a new level file.

    Args:
        options: what the level is like.
        schema: where editors find the JSON schema, as the file's first line names it; None for
            no such line.

    Raises:
        ValueError: there are fewer free cells than puddles, coins and a key need.
    """
    title = options.name.replace("-", " ").capitalize()
    head = f"# yaml-language-server: $schema={schema}\n" if schema else ""
    head += f"""\
# A grid world. Coordinates are [x, y] from the top-left cell, [0, 0]; sides are N, E, S and W.
version: 1
name: {scalar(options.name)}
title: {scalar(title)}
description: A new level.  # say what it is about

"""
    body = _drawing(options) if options.template == "drawing" else _fields(options)
    return head + body + _rest(options)


def _fields(options: StarterOptions) -> str:
    width, height = options.size
    roomy = width > 2 and height > 2
    maze, exit_, seed = "", exit_of(options), _seed_of_maze(options)
    if seed is not None:
        parts = [f"seed: {seed}"]
        if options.algorithm != "depth-first":
            parts.append(f"algorithm: {options.algorithm}")
        if options.loops:
            parts.append(f"loops: {scalar(options.loops)}")
        maze = f"maze: {{{', '.join(parts)}}}  # the same seed grows the same maze\n"
    wet = _puddle_cells(options, _free_cells(width, height, [(0, 0), exit_]))
    puddles = _puddle_lines(wet)
    walls = _wall_lines(options) if options.key and seed is None else _WALLS if roomy else ""
    ground = f"""\
size: [{width}, {height}]  # width and height in cells
start: [0, 0]
exit: [{exit_[0]}, {exit_[1]}]  # entering it ends the episode
{maze}\
{walls}\
"""
    things = _thing_lines(options, ground, wet) if options.has_things else ""
    return f"""\
{ground}\
{things}\
{puddles if roomy or options.puddles else ""}\
"""


_WALLS = """\
# walls:  # on N and S, `length` goes on to the east, on E and W to the south
#   - {at: [1, 0], side: E, length: 2}
"""


def _wall_lines(options: StarterOptions) -> str:
    """Return a wall across the level, with a gap of one cell for the door."""
    width, height = options.size
    across, along = (width, height) if width >= height else (height, width)
    if across < 3:
        raise ValueError("no room for a wall with a door, and a key in front of it")
    line, gap = (across - 1) // 2, along // 2
    side, parts = ("E" if width >= height else "S"), []
    for first, length in ((0, gap), (gap + 1, along - gap - 1)):
        if length:
            cell = [line, first] if side == "E" else [first, line]
            parts.append(f"  - {{at: {cell}, side: {side}, length: {length}}}\n")
    if not parts:
        return ""
    return (
        "walls:  # on N and S, `length` goes on to the east, on E and W to the south\n"
        + "".join(parts)
    )


def _thing_lines(options: StarterOptions, ground: str, wet: Sequence[tuple[int, int]]) -> str:
    """Return the lines of a key, its door, and coins."""
    level = loads(f"version: 1\n{ground}")
    (width, _), (x, y) = level.size, level.exits[0]
    taken = {y * width + x for x, y in wet}
    placer = Placer(level.grid(), 0, y * width + x, random.Random(options.maze_seed or 0), taken)
    keys = int(options.key)
    fields = placer.fields(Counts(keys, keys, options.coins))
    if fields is None:
        coins = f"{options.coins} coin{'s' * (options.coins > 1)}" if options.coins else ""
        what = " and ".join(part for part in ("a key with its door" * keys, coins) if part)
        raise ValueError(f"no room for {what}")
    return _entry_lines(fields)


def _entry_lines(fields: Mapping[str, Any]) -> str:
    """Return the lines of doors and items, each entry on one."""
    about = {
        "doors": "a door is a wall until what it needs is held",
        "items": "taken by coming to stand there, and kept",
    }
    lines = []
    for name, entries in fields.items():
        lines.append(f"{name}:  # {about[name]}\n")
        given = (plain(entry.model_dump(exclude_unset=True)) for entry in entries)
        lines += [f"  - {flow(entry)}\n" for entry in given]
    return "".join(lines)


def _seed_of_maze(options: StarterOptions) -> int | None:
    return 42 if options.maze_seed is None and options.template == "maze" else options.maze_seed


def exit_of(options: StarterOptions) -> tuple[int, int]:
    """Return where the exit of a new level is: in the lower right corner.

    In a maze, it is in the dead end that is nearest to that corner, if there is one: in a corridor
    it would cut off the cells behind it.
    """
    (width, height), seed = options.size, _seed_of_maze(options)
    if seed is None:
        return width - 1, height - 1
    is_open = carve(width, height, bytes(width * height), 0, seed, options.algorithm, options.loops)
    x, y = width - 1, height - 1
    dead_ends = (
        divmod(cell, width)[::-1]
        for cell, sides in enumerate(is_open)
        if sides.bit_count() == 1 and cell != 0
    )
    nearest = min((((x - i) ** 2 + (y - j) ** 2, i, j) for i, j in dead_ends), default=(0, x, y))
    return nearest[1:]


def _drawing(options: StarterOptions) -> str:
    if options.maze_seed is not None or options.has_things:
        level = loads(f"version: 1\n{_fields(options)}")
        things = {name: getattr(level, name) for name in ("doors", "items")}
        lines = _entry_lines({name: values for name, values in things.items() if values})
        legend = _LEGEND.replace("walls.", "walls, -/- and / doors.") if options.key else _LEGEND
        return legend + "map: |\n" + indent(level.draw(), "  ") + lines
    width, height = options.size
    cells = [[" "] * width for _ in range(height)]
    cells[0][0], cells[-1][-1] = "S", "E"
    free = _free_cells(width, height, [(0, 0), (width - 1, height - 1)])
    for number, (x, y) in enumerate(_puddle_cells(options, free)):
        cells[y][x] = "O" if number % 2 else "o"
    border = "  +" + "---+" * width + "\n"
    between = "  +" + "   +" * width + "\n"
    rows = ["  |" + " ".join(f" {cell} " for cell in row) + "|\n" for row in cells]
    return f"""\
{_LEGEND}\
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


def _rest(options: StarterOptions) -> str:
    theme = (
        "# theme: black_orange" if options.theme == "default" else f"theme: {scalar(options.theme)}"
    )
    return f"""\

# rewards: {{step: -1, exit: 0}}  # the defaults
# max_steps: 100  # episodes are truncated after so many steps
{theme}  # default, babyrobot, black_orange, blue_green, dark, green, high_contrast, print
"""


def _free_cells(width: int, height: int, taken: Sequence[tuple[int, int]]) -> list[tuple[int, int]]:
    return [(x, y) for y in range(height) for x in range(width) if (x, y) not in taken]


def _puddle_cells(options: StarterOptions, free: list[tuple[int, int]]) -> list[tuple[int, int]]:
    """Return the cells of the puddles, drawn from the maze's seed."""
    if options.puddles > len(free):
        raise ValueError(
            f"no room for {options.puddles} puddle{'s' * (options.puddles > 1)}: "
            f"only {len(free)} cells are neither start nor exit"
        )
    rng = random.Random(options.maze_seed or 0)
    return [free.pop(below(rng, len(free))) for _ in range(options.puddles)]
