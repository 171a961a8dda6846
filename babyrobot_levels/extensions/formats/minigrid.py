"""Environments of MiniGrid as levels: the grid that a seed gives."""

from collections.abc import Callable, Iterator
from typing import Any

from babyrobot_levels.analysis.environments import DIRECTIONS
from babyrobot_levels.extensions.formats.conversion import ConversionError, World
from babyrobot_levels.extensions.formats.minigrid_grids import (
    LAVA,
    Cell,
    Object,
    Snapshot,
    Task,
    cropped,
    world_of,
)
from babyrobot_levels.language import drawing as d
from babyrobot_levels.language.base import SIDES
from babyrobot_levels.mdp.configurations import MAX_OUTCOMES

SOURCE = (
    "M. Chevalier-Boisvert et al., Minigrid & Miniworld: Modular & Customizable Reinforcement "
    "Learning Environments for Goal-Oriented Tasks, NeurIPS 2023"
)
"""The publication of MiniGrid's environments."""

_MARKS = {"wall": d.BLOCKED, "goal": d.EXIT, "lava": LAVA}


def world_of_environment(env: Any, env_id: str, seed: int) -> World:
    """Return the world of an environment of MiniGrid that was reset, without its wrappers.

    Args:
        env: the environment.
        env_id: its id.
        seed: the seed of its reset.

    Raises:
        ConversionError: its task cannot be that of a level.
    """
    env_id = env_id.rpartition(":")[2]
    name = env_id.rpartition("-v")[0] or env_id
    mission = str(env.mission)
    texts: dict[str, Any] = {"title": f"{name}, seed {seed}"}
    if mission:
        texts["description"] = f"{mission[0].upper()}{mission[1:]}."
    world = world_of(
        cropped(snapshot_of(env)), f"{env_id} of MiniGrid, reset with seed {seed}.", texts
    )
    world.fields["max_steps"] = int(env.max_steps)
    world.fields["source"] = SOURCE
    return world


def snapshot_of(env: Any) -> Snapshot:
    """Return the grid and the task of an environment that was reset, without its wrappers.

    Raises:
        ConversionError: its task cannot be that of a level.
    """
    obstacles = getattr(env, "obstacles", ())
    rows = [[d.PLAIN] * env.grid.width for _ in range(env.grid.height)]
    objects = []
    floor: list[Cell] = []
    for (x, y), thing in _things(env):
        if thing.type in _MARKS:
            rows[y][x] = _MARKS[thing.type]
        elif thing.type == "floor":
            floor.append((x, y))
        else:
            is_obstacle = any(thing is each for each in obstacles)
            objects.append(_object(thing, (x, y), is_obstacle=is_obstacle))
    agent = (int(env.agent_pos[0]), int(env.agent_pos[1]))
    return Snapshot(
        tuple("".join(row) for row in rows),
        tuple(objects),
        (agent,),
        DIRECTIONS[env.agent_dir],
        _task(env),
        tuple(floor),
    )


def _things(env: Any) -> Iterator[tuple[Cell, Any]]:
    """Yield what is on the grid, row by row."""
    for y in range(env.grid.height):
        for x in range(env.grid.width):
            if (thing := env.grid.get(x, y)) is not None:
                yield (x, y), thing


def _object(thing: Any, at: Cell, *, is_obstacle: bool) -> Object:
    if is_obstacle:
        return Object("obstacle", thing.color, at)
    inside = getattr(thing, "contains", None)
    if inside is not None and inside.type == "key":
        return Object("key", inside.color, at, "boxed")
    state = ""
    if thing.type == "door":
        state = "open" if thing.is_open else "locked" if thing.is_locked else "closed"
    return Object(thing.type, thing.color, at, state)


# -- tasks -----------------------------------------------------------------------------------


def _task(env: Any) -> Task | None:
    """Return the task of an environment, by its class; None if it is to reach a goal."""
    for kind in type(env).__mro__:
        if kind.__name__ in _TASKS:
            return _TASKS[kind.__name__](env)
    return None


def _cells_of(env: Any, *wanted: Any) -> tuple[Cell, ...]:
    return tuple(cell for cell, thing in _things(env) if any(thing is each for each in wanted))


def _cell(position: Any) -> Cell:
    return int(position[0]), int(position[1])


def _opening(env: Any) -> Task:
    return Task(_cells_of(env, env.door), note=_note("in the doorway", "the door is opened"))


def _picking_up(env: Any) -> Task:
    where = f"on the cell of the {env.obj.color} {env.obj.type}"
    return Task(_cells_of(env, env.obj), note=_note(where, "it is picked up"))


def _fetching(env: Any) -> Task:
    """Any object is picked up once; the one that is asked for is a success."""
    goals, others = [], []
    for cell, thing in _things(env):
        if thing.type == env.targetType and thing.color == env.targetColor:
            goals.append(cell)
        elif thing.type in ("key", "ball"):
            others.append(cell)
    return Task(
        tuple(goals), tuple(others), note=_note("on the cell of any object", "one is picked up")
    )


def _going_to(env: Any) -> Task:
    what = env.grid.get(*env.target_pos)
    where = f"on the cell of the {what.color} {what.type}"
    return Task(
        (_cell(env.target_pos),), beside=True, note=_note(where, "`done` is chosen next to it")
    )


def _remembering(env: Any) -> Task:
    shown = tuple(cell for cell, thing in _things(env) if thing.type != "wall")
    note = "what to remember is the same in each episode; in MiniGrid, it is drawn at each reset"
    return Task((_cell(env.success_pos),), (_cell(env.failure_pos),), shown=shown, note=note)


def _two_doors(env: Any) -> Task:
    red, blue = _cells_of(env, env.red_door), _cells_of(env, env.blue_door)
    return Task(blue, blue, red, note=_note("in the blue doorway", "the blue door is opened"))


def _instruction(env: Any) -> Task:
    """Return the task of an environment of BabyAI: one instruction about one description."""
    kind = type(env.instrs).__name__
    ends = {
        "GoToInstr": "it is in front of the agent",
        "OpenInstr": "it is opened",
        "PickupInstr": "it is picked up",
    }
    if kind == "PutNextInstr":
        return _putting(env)
    if kind not in ends:
        raise ConversionError(f"`{env.mission}` is a sequence of tasks; a level has one")
    cells = tuple(sorted(map(_cell, env.instrs.desc.obj_poss), key=lambda cell: cell[::-1]))
    where = "in the doorway" if kind == "OpenInstr" else "on the cell of what is asked for"
    return Task(cells, beside=kind == "GoToInstr", note=_note(where, ends[kind]))


def _putting(env: Any) -> Task:
    raise ConversionError(f"`{env.mission}`: in a level, nothing is put down")


def _avoiding(env: Any) -> None:
    """Refuse more obstacles than the tables of a level have room for."""
    count, outcomes = len(env.obstacles), (1 + len(SIDES)) ** len(env.obstacles)
    if outcomes > MAX_OUTCOMES:
        raise ConversionError(
            f"{count} obstacles that walk at random have {outcomes:,} ways to go in a step; a "
            f"level has room for {MAX_OUTCOMES}",
            "choose fewer, for example with --kwargs '{\"n_obstacles\": 2}'",
        )


def _note(where: str, when: str) -> str:
    return f"the episode ends {where}; in MiniGrid, when {when}"


_TASKS: dict[str, Callable[[Any], Task | None]] = {
    "UnlockEnv": _opening,
    "UnlockPickupEnv": _picking_up,
    "BlockedUnlockPickupEnv": _picking_up,
    "KeyCorridorEnv": _picking_up,
    "ObstructedMazeEnv": _picking_up,
    "FetchEnv": _fetching,
    "GoToObjectEnv": _going_to,
    "GoToDoorEnv": _going_to,
    "MemoryEnv": _remembering,
    "RedBlueDoorEnv": _two_doors,
    "PutNearEnv": _putting,
    "DynamicObstaclesEnv": _avoiding,
    "RoomGridLevel": _instruction,
}
"""What the tasks of MiniGrid's classes are; others are to reach a goal."""
