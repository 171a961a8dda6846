"""What a step has changed, in words: things, doors, walls that refused, and who hit the robot."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from babyrobot_levels.language.base import SIDES
from babyrobot_levels.language.geometry import show_cell
from babyrobot_levels.mdp.actions import DELTAS, Action
from babyrobot_levels.mdp.grid import door_name, door_sides
from babyrobot_levels.render.words.rules import spoken

if TYPE_CHECKING:
    from babyrobot_levels.mdp.configurations import Configuration
    from babyrobot_levels.mdp.gridworld import GridWorld
    from babyrobot_levels.mdp.tables import Mdp


def happenings(
    level: GridWorld,
    before: int,
    action: int,
    after: int,
    *,
    skidded: bool,
    target_reached: bool,
    hit: bool,
    drawn: bool = False,
) -> Iterator[str]:
    """Yield what happened in a step, a sentence each.

    Args:
        level: the level.
        before: the state before the step, as in `level.compile()`.
        action: the action, an `Action`.
        after: the state after it.
        skidded: whether chance took the robot somewhere else.
        target_reached: whether it is where the action leads without chance.
        hit: whether a mover hit it.
        drawn: whether a picture shows where doors are, so that they are not told by their places.
    """
    mdp = level.compile()
    then, now = (level.configuration(mdp.configuration(state)) for state in (before, after))
    if skidded:
        yield "The robot skids."
    elif not mdp.action_mask[before, action]:
        yield bump(level, mdp, before, action, then)
    elif not target_reached:
        yield "The glass throws the robot back."
    else:
        way = str(Action(action))
        yield "The robot waits." if action == Action.STAY else f"The robot moves {way}."
    yield from changes(level, then, now, drawn=drawn)
    if hit:
        yield f"The {hitter(level, mdp, before, action, after)} hits the robot!"


def moves_of_team(
    level: GridWorld, before: int, action: int, after: int, *, only: int | None = None
) -> Iterator[str]:
    """Yield what each of several robots did in a step, a sentence each.

    Args:
        level: the level.
        before: the state before the step, as in `level.compile()`.
        action: the joint action.
        after: the state after it.
        only: the number of the robot that it is told of; None for all.
    """
    numbering = level.numbering()
    then, now = (level.configuration(numbering.configuration(each)) for each in (before, after))
    starts, ends = (numbering.cell(before), *then.robots), (numbering.cell(after), *now.robots)
    actions = numbering.robot_actions(action).tolist()
    for number, robot in enumerate(level.robots):
        if then.arrived[number] or only not in (None, number):
            continue
        way, (x, y), end = Action(actions[number]), starts[number], ends[number]
        side = str(way)
        dx, dy = DELTAS.get(way, (0, 0))
        if end == (x, y):
            told = "waits" if way is Action.STAY else f"cannot move {side}"
        else:
            told = f"moves {side}" if end == (x + dx, y + dy) else f"comes to {show_cell(end)}"
        home = ", and has arrived" if now.arrived[number] else ""
        name = spoken([robot.name])
        yield f"{name[:1].upper()}{name[1:]} {told}{home}."


def changes(
    level: GridWorld, then: Configuration, now: Configuration, *, drawn: bool = False
) -> Iterator[str]:
    """Yield what has changed since a configuration, a sentence each; not where movers are."""
    yield from (f"Took the {spoken([name])}." for name in now.held if name not in then.held)
    things = level.things()
    if then.boxes != now.boxes:
        yield "A box is pushed."
    for column, before, after in zip(things.fixed, then.on, now.on, strict=True):
        if before != after:
            state = things[column].states[after]
            yield f"The {spoken([things.names[column]])} is {state}."
    for door, before, after in zip(level.doors, then.doors, now.doors, strict=True):
        if before != after:
            name = "A door" if drawn else f"The {door_name(door)}"
            yield f"{name} {'closes' if after else 'opens'}."
    if then.exit_is_open != now.exit_is_open:
        yield f"The exit is {'open' if now.exit_is_open else 'closed'}."


def hitter(level: GridWorld, mdp: Mdp, before: int, action: int, after: int) -> str:
    """Return the name of the mover that hit the robot in a step.

    Args:
        level: the level.
        mdp: its tables, or those of a robot that turns.
        before: the state before the step.
        action: the action, as these tables number it.
        after: the state after it.
    """
    from babyrobot_levels.mdp.tables import hits_by_mover

    is_outcome = (mdp.probability[before, action] > 0) & (mdp.next_state[before, action] == after)
    hits = hits_by_mover(level, mdp, slice(before, before + 1))
    return next(
        name
        for name, by_mover in zip(level.things().names[level.things().static :], hits, strict=True)
        if by_mover[0, action][is_outcome].any()
    )


def bump(level: GridWorld, mdp: Mdp, state: int, move: int, then: Configuration) -> str:
    """Return what refuses a move, as a sentence.

    Args:
        level: the level.
        mdp: its tables, or those of a robot that turns.
        state: the state before the move.
        move: the move, an `Action`.
        then: what is where before the move.
    """
    where = str(Action(move))
    if move > Action.WEST:
        return f"Bump! The corner in the {where} is closed."
    cell, side = state % mdp.cells, SIDES[move - Action.NORTH]
    doors = door_sides(level, level.grid())
    is_door = any((cell, side) == (at, of) and then.doors[number] for at, of, number in doors)
    if is_door:
        return f"Bump! The door in the {where} is closed."
    return f"Bump! A wall in the {where}."
