"""Random small levels with several robots, as plain data."""

from __future__ import annotations

from random import Random

from oracles.random_things import Cell, Fields, random_level

NAMES = ("red", "blue", "green")


def random_team(random: Random) -> Fields | None:
    """Return the fields of a random valid level with two or three robots; None for too few cells.

    It is a random level with things, without boxes, in which robots have starts and exits.
    """
    fields = random_level(random)
    for name in ("boxes", "heading", "start", "start_weights"):
        fields.pop(name, None)
    width, height = fields.get("size", (3, 3))
    taken = {cell for name in ("items", "switches", "targets") for cell in _places(fields, name)}
    taken |= {tuple(warp["at"]) for warp in fields.get("warps", [])}
    endings = [area for area in fields.get("areas", []) if area.get("ends")]
    for entry in (*fields.get("blocked", []), *endings):
        taken |= _rectangle(entry)
    exits = fields.get("exit", fields.get("exit_one_of", [[width - 1, height - 1]]))
    if exits != "none":
        taken |= {tuple(cell) for cell in ([exits] if isinstance(exits[0], int) else exits)}
    free = [(x, y) for y in range(height) for x in range(width) if (x, y) not in taken]
    if len(free) < 2:
        return None
    count = 3 if width * height <= 6 and random.random() < 0.4 else 2
    robots: list[Fields] = []
    for name, start in zip(NAMES, random.sample(free, min(count, len(free))), strict=False):
        robots.append({"name": name, "start": [*start]})
        if random.random() < 0.5:
            robots[-1]["exit"] = [*random.choice([cell for cell in free if cell != start])]
    fields["robots"] = robots
    rules = {
        "meet": ("block", "order", "pass", "end"),
        "arrived": ("leave", "stay"),
        "ends": ("all", "first"),
    }
    team = {name: random.choice(values) for name, values in rules.items() if random.random() < 0.6}
    if team:
        fields["team"] = team
    if random.random() < 0.5:
        fields.setdefault("rewards", {})["meet"] = random.choice((-3.5, 2.0, -7))
    for item in fields.get("items", []):
        if random.random() < 0.4:
            item["robot"] = random.choice(robots)["name"]
    return fields


def _places(fields: Fields, name: str) -> list[Cell]:
    return [
        (cell[0], cell[1])
        for entry in fields.get(name, [])
        for cell in entry.get("one_of", [entry.get("at")])
    ]


def _rectangle(entry: Fields) -> set[Cell]:
    (x, y), (width, height) = entry["at"], entry.get("size", (1, 1))
    return {(x + dx, y + dy) for dy in range(height) for dx in range(width)}
