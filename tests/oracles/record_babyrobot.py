# mypy: disable-error-code="import-not-found,import-untyped"
"""Record what PyPI babyrobot 1.0.40 makes of random worlds, as an oracle for the tests.

To repeat the recording, from the top of the repository, in an environment of its own:

    pip install --no-deps babyrobot==1.0.40
    pip install numpy tqdm imageio gymnasium ipycanvas
    python tests/oracles/record_babyrobot.py

It writes `babyrobot.json` beside this script, the same bytes each time:

- `mazes`: `open` has a hex digit per cell, by rows: 1 open to the north, 2 east, 4 south, 8 west.
- `levels`: `level` is the world in our language and `setup` the same world as keywords of the
  package (to replay it, make its lists tuples again: a puddle that is a list means something else
  to the package). `open` is as above, 0 for the exit and for blocked cells; `transitions` maps
  "x,y,action" to [[probability, [x, y], reward], ...].

The package holds a simulator (`get_next_state`) and a model (`get_action_probabilities`), which
disagree. A refused move is recorded from the simulator (the model scatters it over the open
sides), every other one from the model. Left out are the exit, blocked cells, and those moves near
a 'prob' wall where the package does not do what the language says (see `outcomes`).
"""

import json
import random
from itertools import groupby, product
from pathlib import Path
from typing import Any

from babyrobot.envs.lib.direction import Direction
from babyrobot.envs.lib.grid_level import GridLevel
from babyrobot.envs.lib.maze import Maze

World = dict[str, Any]
Cell = tuple[int, int]
Rectangle = tuple[int, int, int, int]

SIDES = {"N": (0, -1), "E": (1, 0), "S": (0, 1), "W": (-1, 0)}
SEEDS = (0, 1, -1, 5, -5, -123456, 2**31, 2**32 + 1, 2**40, 2**64 + 1)
SIZES: tuple[Cell, ...] = ((1, 2), (2, 1), (1, 3), (3, 1), (1, 20), (30, 1), (2, 2), (3, 2))
SIZES += ((30, 20), (20, 20), (40, 40), (40, 40), (40, 40))


def record_maze(number: int) -> World:
    rng = random.Random(number)
    nx, ny = SIZES[number] if number < len(SIZES) else (rng.randint(1, 30), rng.randint(1, 20))
    start = (rng.randrange(nx), rng.randrange(ny))
    seed = SEEDS[number % len(SEEDS)] if number < 40 else rng.randrange(10**6)
    maze = Maze(nx, ny, *start, seed=seed)
    maze.make_maze()
    walls = [maze.cell_at(x, y).walls for y in range(ny) for x in range(nx)]
    masks = [sum(bit << i for i, bit in enumerate(not w[side] for side in SIDES)) for w in walls]
    digits = "".join(f"{mask:x}" for mask in masks)
    return {"size": (nx, ny), "seed": seed, "start": start, "open": digits}


def inside(rectangle: Rectangle) -> set[Cell]:
    x, y, w, h = rectangle
    return set(product(range(x, x + w), range(y, y + h)))


def free_rectangle(rng: random.Random, size: Cell, taken: set[Cell]) -> Rectangle | None:
    """Choose a rectangle of at most 3 x 3 cells, none of which is taken."""
    rectangles = [
        (x, y, w, h)
        for x, y, w, h in product(range(size[0]), range(size[1]), (1, 2, 3), (1, 2, 3))
        if x + w <= size[0] and y + h <= size[1] and not inside((x, y, w, h)) & taken
    ]
    return rng.choice(rectangles) if rectangles else None


def add_walls(rng: random.Random, setup: World, level: World) -> None:
    """Toggle some inner walls, no side twice: for us, those that stood are openings."""
    (width, height), start = level["size"], setup["start"]
    maze = Maze(width, height, *start, seed=setup.get("maze_seed"), no_walls="maze" not in level)
    if "maze" in level:
        maze.make_maze()
    cells = inside((0, 0, width, height))
    used: set[frozenset[Cell]] = set()
    glass = rng.random() < 0.6
    for _ in range(rng.randint(2, max(2, width * height // 2))):
        side, (dx, dy) = rng.choice(list(SIDES.items()))
        x, y, length = rng.randrange(width), rng.randrange(height), rng.choice((1, 1, 1, 2, 3))
        along = [(x + i, y) if dy else (x, y + i) for i in range(length)]
        edges = {frozenset({(x, y), (x + dx, y + dy)}) for x, y in along}
        if edges & used or not set().union(*edges) <= cells:
            continue
        used |= edges
        probability = rng.choice((0.1, 0.25, 0.3, 0.5, 0.8, 0.9, 1.0))
        added = {"pass": probability} if glass and rng.random() < 0.5 else {}
        properties = ({"prob": probability},) if added else ()
        location = (x, y, length) if length > 1 else (x, y)
        setup.setdefault("walls", []).append((location, side, *properties))
        for stood, run in groupby(along, lambda cell: maze.cell_at(*cell).walls[side]):  # noqa: B023
            at, *more = run
            entry: World = {"at": at, "side": side} | ({"length": 1 + len(more)} if more else {})
            entry |= {} if stood else added
            level.setdefault("openings" if stood else "walls", []).append(entry)


def add_blocked(rng: random.Random, setup: World, level: World) -> set[Cell]:
    """Take one or two rectangles off the grid, which do not touch; return their cells."""
    taken = {setup["start"], setup["end"]}
    blocked: set[Cell] = set()
    for _ in range(rng.randint(1, 2)):
        if rectangle := free_rectangle(rng, level["size"], taken):
            x, y, w, h = rectangle
            taken |= inside((x - 1, y - 1, w + 2, h + 2))
            blocked |= inside(rectangle)
            setup.setdefault("base_areas", []).append((rectangle, "gray"))
            level.setdefault("blocked", []).append({"at": (x, y), "size": (w, h)})
    return blocked


def add_puddles(rng: random.Random, setup: World, level: World, cells: list[Cell]) -> None:
    sizes = {cell: rng.randint(1, 2) for cell in rng.sample(cells, rng.randint(1, len(cells)))}
    setup["puddles"] = list(sizes.items())
    names = ("small", "large")
    level["puddles"] = [{"at": cell, "size": names[size - 1]} for cell, size in sizes.items()]
    if rng.random() < 0.5:
        setup["puddle_props"], level["puddle_types"] = {}, {}
        for name in names:  # `prob` is the probability not to skid
            probability = rng.choice((0.0, 0.05, 0.25, 0.3, 0.5, 0.75, 0.9, 1.0))
            reward = rng.randint(-9, 3)
            setup["puddle_props"] |= {f"{name}_reward": reward, f"{name}_prob": probability}
            level["puddle_types"][name] = {"reward": reward, "skid": round(1 - probability, 10)}


def add_areas(rng: random.Random, setup: World, level: World) -> None:
    for color in rng.sample(("lightblue", "pink", "#ccffcc", "gold"), rng.randint(1, 4)):
        if rectangle := free_rectangle(rng, level["size"], {setup["end"]}):
            at, size = rectangle[:2], rectangle[2:]
            reward = rng.randint(-9, 3) if rng.random() < 0.8 else None
            entry: World = {"at": at, "color": color}
            entry |= {} if size == (1, 1) else {"size": size}
            entry |= {} if reward is None else {"reward": reward}
            area = (rectangle if "size" in entry else at, color)
            setup.setdefault("grid_areas", []).append(area if reward is None else (*area, reward))
            level.setdefault("areas", []).append(entry)


def random_world(number: int) -> tuple[World, World]:
    """Return a world as the package's keywords and in our language."""
    rng = random.Random(1000 + number)
    width, height = rng.randint(2, 9), rng.randint(2, 7)
    cells = sorted(inside((0, 0, width, height)))
    start, end = rng.sample(cells, 2)
    setup: World = {"width": width, "height": height, "start": start, "end": end}
    level: World = {"version": 1, "size": (width, height), "start": start, "exit": end}
    level["rewards"] = {"exit": -1}  # the package's price of the last step
    if number % 4 >= 2:
        seed = rng.choice((rng.randrange(10**6), *SEEDS))
        setup |= {"add_maze": True, "maze_seed": seed}
        level["maze"] = {"seed": seed}
    if number % 4 in (1, 3):
        add_walls(rng, setup, level)
    blocked = add_blocked(rng, setup, level) if number % 4 == 0 else set()
    if rng.random() < 0.7:
        add_puddles(rng, setup, level, [c for c in cells if c != end and c not in blocked])
    if rng.random() < 0.6:
        add_areas(rng, setup, level)
    return setup, level


def outcomes(grid: Any, x: int, y: int, action: int) -> list[Any] | None:
    """Return what the action leads to; None where the package is at odds with the language."""
    if action == 0:
        return list(grid.get_action_probabilities(x, y, action))
    side, direction = list(SIDES)[action - 1], Direction.from_action(action)
    is_open = grid.grid_info.get_cell_directions(x, y)
    if not is_open.get(side, False):
        position, reward, _ = grid.get_next_state(x, y, direction)
        return [[1.0, position, reward]]
    glass = [s for s, v in grid.grid_base.maze.cell_at(x, y).properties.items() if "prob" in v]
    probability, _ = grid.grid_base.get_transition_probability(x, y, direction)
    opposite = Direction.get_opposite(side)
    if probability < 1 and side in glass and (opposite in glass or not is_open.get(opposite)):
        return None  # the package bounces to where a wall is in the way
    if probability < 1 and side not in glass and glass:
        return None  # the package skids through 'prob' walls, freely
    return list(grid.get_action_probabilities(x, y, action))


def record_level(number: int) -> World:
    setup, level = random_world(number)
    grid = GridLevel(**setup)
    cells = [(x, y) for y in range(setup["height"]) for x in range(setup["width"])]
    transitions = {
        f"{x},{y},{action}": [[float(p), position, int(reward)] for p, position, reward in found]
        for (x, y), action in product(cells, range(5))
        if grid.is_grid_state(x, y) and (found := outcomes(grid, x, y, action)) is not None
    }
    digits = "".join(f"{int(grid.get_directions(x, y)):x}" for x, y in cells)
    return {"level": level, "setup": setup, "open": digits, "transitions": transitions}


if __name__ == "__main__":
    record = {
        "package": "babyrobot 1.0.40",
        "mazes": [record_maze(number) for number in range(150)],
        "levels": [record_level(number) for number in range(200)],
    }
    text = json.dumps(record, separators=(",", ":"), sort_keys=True)
    Path(__file__).with_name("babyrobot.json").write_text(text + "\n", encoding="utf-8")
