"""A plain search in a level of boxes, compiled by Numba, which shares nothing with the compiler."""

from typing import Any

import numba
import numpy as np

STEPS = ((0, -1), (1, 0), (0, 1), (-1, 0))


def searched(fields: dict[str, Any]) -> tuple[int, int]:
    """Return the states that a plain search reaches before the end, and the fewest moves."""
    width, height = fields["size"]
    blocked = {tuple(entry["at"]) for entry in fields["blocked"]}
    cells = [(x, y) for y in range(height) for x in range(width) if (x, y) not in blocked]
    number = {cell: index for index, cell in enumerate(cells)}
    near = [[number.get((x + dx, y + dy), -1) for dx, dy in STEPS] for x, y in cells]
    # A set of cells is a word with a bit for each; maps of Boxoban have 64 at most inside.
    boxes, goal = (
        np.uint64(sum(1 << number[tuple(entry["at"])] for entry in fields[name]))
        for name in ("boxes", "targets")
    )
    found: tuple[int, int] = search(
        np.array(near, np.int64), number[tuple(fields["start"])], boxes, goal
    )
    return found


@numba.njit
def slot(table, robots, sets, robot, boxes):  # type: ignore[no-untyped-def]
    """Return where a table has a state, or has room for it."""
    mixed = (boxes ^ (np.uint64(robot) << np.uint64(57))) * np.uint64(0x9E3779B97F4A7C15)
    place = np.int64(mixed >> np.uint64(20)) & (table.size - 1)
    while table[place] >= 0 and (robots[table[place]] != robot or sets[table[place]] != boxes):
        place = (place + 1) & (table.size - 1)
    return place


@numba.njit("UniTuple(int64, 2)(int64[:, ::1], int64, uint64, uint64)")
def search(near, robot, boxes, goal):  # type: ignore[no-untyped-def]
    """Search breadth-first from a state on; `near` has the four cells around each, -1 for none."""
    one, room = np.uint64(1), 1 << 16
    robots, sets = np.empty(room, np.int64), np.empty(room, np.uint64)
    table = np.full(4 * room, -1, np.int64)
    robots[0], sets[0], count, here, moves, layer = robot, boxes, 1, 0, 0, 1
    table[slot(table, robots, sets, robot, boxes)] = 0
    fewest = -1
    while here < count:
        if here == layer:
            moves, layer = moves + 1, count
        if count + 4 > room:
            room *= 2
            robots, sets = np.append(robots, robots), np.append(sets, sets)
            table = np.full(4 * room, -1, np.int64)
            for state in range(count):
                table[slot(table, robots, sets, robots[state], sets[state])] = state
        for way in range(4):
            robot, boxes = near[robots[here], way], sets[here]
            if robot < 0:
                continue
            if boxes >> np.uint64(robot) & one:
                beyond = near[robot, way]
                if beyond < 0 or boxes >> np.uint64(beyond) & one:
                    continue
                boxes ^= (one << np.uint64(robot)) | (one << np.uint64(beyond))
                if goal & ~boxes == 0:
                    fewest = moves + 1 if fewest < 0 else fewest
                    continue
            place = slot(table, robots, sets, robot, boxes)
            if table[place] < 0:
                table[place], robots[count], sets[count] = count, robot, boxes
                count += 1
        here += 1
    return count, fewest
