"""A level in words: its picture, for people who do not see it, and what there is to do."""

from collections import Counter
from collections.abc import Iterator, Sequence

from babyrobot_levels.language.base import SIDE_NAMES
from babyrobot_levels.language.cells import mean_of
from babyrobot_levels.language.geometry import Cell, show_cell
from babyrobot_levels.language.kinds import NEEDED
from babyrobot_levels.language.things import Item, Target
from babyrobot_levels.mdp.configurations import Configuration
from babyrobot_levels.mdp.grid import BIT, door_sides
from babyrobot_levels.mdp.gridworld import GridWorld
from babyrobot_levels.mdp.ground import exit_rewards
from babyrobot_levels.mdp.numeric import is_numeric
from babyrobot_levels.render.words import phrases
from babyrobot_levels.render.words.rules import grounds_of, item_count, spoken
from babyrobot_levels.text.words import listed

MOST_CHARACTERS = 400
"""The most characters of a description."""

_MOST_PLACES = 3
"""The most cells of a kind that are told one by one."""


def describe(level: GridWorld, state: int | None = None, *, robot: bool = True) -> str:
    """Return the picture of a level in words: its size, where the robot is, what is around it.

    Cells are `[x, y]`, counted from 0, as in level files. The text has at most `MOST_CHARACTERS`;
    what would make it longer is left out.

    Args:
        level: the level; a maze needs a seed.
        state: the configuration and the cell of the robot, as in `level.compile()`. None describes
            the level as a whole, with the robot on the first start.
        robot: whether the robot is in the picture; if not, the first start is told instead.

    Raises:
        LevelError: the maze has no seed yet (`seed: random`).
    """
    columns, rows = level.size
    text = f"A grid of {phrases.counted(columns, 'column')} and {phrases.counted(rows, 'row')}."
    now, cell = None, level.starts[0]
    if state is not None:
        number, place = divmod(state, columns * rows)
        now = level.configuration(number) if level.has_things else None
        cell = place % columns, place // columns
    subject = "The robot is" if robot else "A start is" if len(level.starts) > 1 else "The start is"
    for sentence in (
        f"{subject} at {show_cell(cell)}, {around(level, cell, now)}.",
        *_sentences(level, cell, now),
    ):
        if len(text) + 1 + len(sentence) > MOST_CHARACTERS:
            break
        text += f" {sentence}"
    return text


def _sentences(level: GridWorld, cell: Cell, now: Configuration | None) -> Iterator[str]:
    if level.robots:
        yield from _robots(level, now)
    if now is not None and now.held:
        yield f"It holds the {spoken(now.held)}."
    yield way_to_exit(level, cell, now)
    if ends := _ends(level):
        yield f"The episode {'also ' if level.exits else ''}ends in {ends}."
    if found := [*_things(level, now), *_features(level)]:
        yield f"On the grid: {listed(found)}."


def _robots(level: GridWorld, now: Configuration | None) -> Iterator[str]:
    """Yield where the robots but the first are; those of a level as a whole are at their starts."""
    cells = level.starts[1:] if now is None else now.robots
    arrived = (False,) * len(level.robots) if now is None else now.arrived
    for robot, cell, home in zip(level.robots[1:], cells, arrived[1:], strict=True):
        yield f"{robot.name} {'has arrived' if home else 'is'} at {show_cell(cell)}."


def around(level: GridWorld, cell: Cell, now: Configuration | None) -> str:
    """Return what closes the sides of a cell: walls, glass and closed doors."""
    grid = level.grid()
    place = cell[1] * grid.width + cell[0]
    closed = _closed(level, now)
    doors = {
        side for there, side, door in door_sides(level, grid) if there == place and closed[door]
    }
    kinds: dict[str, list[str]] = {}
    for name, side in SIDE_NAMES.items():
        if side in doors:
            kinds.setdefault("closed door", []).append(name)
        elif (place, side) in grid.glass:
            kinds.setdefault("glass wall", []).append(name)
        elif not grid.open_bits[place] & BIT[side]:
            kinds.setdefault("wall", []).append(name)
    told = [
        f"{f'{kind}s' if len(sides) > 1 else f'a {kind}'} to the {listed(sides)}"
        for kind, sides in kinds.items()
    ]
    return f"with {listed(told)}" if told else "with no wall around it"


def _closed(level: GridWorld, now: Configuration | None) -> Sequence[bool]:
    """Return for each door whether it is closed; in the level as a whole, at the beginning."""
    if now is not None or not level.doors:
        return now.doors if now is not None else ()
    things = [thing for kind in NEEDED for thing in kind.of(level)]
    boxes = {box.at for box in level.boxes}
    met = frozenset(
        thing.name
        for thing in things
        if getattr(thing, "on", False) or (isinstance(thing, Target) and thing.at in boxes)
    )
    return level.things().closed(met)


def way_to_exit(level: GridWorld, cell: Cell, now: Configuration | None) -> str:
    """Return where the nearest exit is from a cell, as a sentence."""
    exits = level.exits if now is None else now.exits
    if not exits:
        return _covered(level, now) if level.ends_covered else "There is no exit."
    x, y = min(exits, key=lambda other: abs(other[0] - cell[0]) + abs(other[1] - cell[1]))
    steps = [
        f"{phrases.counted(abs(distance), unit)} {sides[distance > 0]}"
        for distance, unit, sides in (
            (x - cell[0], "column", ("west", "east")),
            (y - cell[1], "row", ("north", "south")),
        )
        if distance
    ]
    if not steps:
        return "That is the exit."
    if level.exit_one_of is not None and now is None:
        return f"The exit is in one of {len(exits)} cells, the nearest {listed(steps)}."
    is_locked = level.exit_keys and not (now is not None and now.exit_is_open)
    name = f"{'locked ' if is_locked else ''}exit"
    subject = f"The {name}" if len(exits) == 1 else f"The nearest of {len(exits)} {name}s"
    return f"{subject} is {listed(steps)}."


def _covered(level: GridWorld, now: Configuration | None) -> str:
    """Return how many targets are covered, as a sentence."""
    boxes = {box.at for box in level.boxes} if now is None else {*now.boxes}
    covered = sum(target.at in boxes for target in level.targets)
    if level.robots:
        standing = zip(level.things().fixed, now.on if now is not None else (), strict=False)
        covered = sum(on for column, on in standing if level.things().kinds[column] == "target")
    of = phrases.counted(len(level.targets), "target")
    return f"{covered} of {of} {'is' if covered == 1 else 'are'} covered."


def _ends(level: GridWorld) -> str:
    """Return the cells other than exits that end the episode."""
    grounds = [ground for ground in grounds_of(level) if ground.end is not None]
    ends = [(ground.name, cell) for ground in grounds for cell in ground.places(level)]
    if len(ends) <= _MOST_PLACES:
        return listed([f"the {name} at {show_cell(cell)}" for name, cell in ends])
    names = {name for name, _ in ends}
    return phrases.counted(len(ends), names.pop() if len(names) == 1 else "cell")


def _things(level: GridWorld, now: Configuration | None) -> Iterator[str]:
    """Yield what lies, stands and moves."""
    places = [item.places for item in level.items]
    if now is not None:
        places = [() if cell is None else (cell,) for cell in now.items]
    lying = [(item, cells) for item, cells in zip(level.items, places, strict=True) if cells]
    if len(lying) <= _MOST_PLACES:
        for item, there in lying:
            at = f"at {show_cell(there[0])}" if len(there) == 1 else f"in one of {len(there)} cells"
            yield f"the {spoken([item.name])} {at}"
    else:
        for shape, count in Counter(item.picture for item, _ in lying).items():
            yield item_count(count, shape)
    closed = sum(_closed(level, now))
    for count, doors in ((closed, "closed door"), (len(level.doors) - closed, "open door")):
        if count:
            yield phrases.counted(count, doors)
    if level.boxes:
        yield phrases.counted(len(level.boxes), "box", "boxes")
    for kind in NEEDED:
        # Items are told by their shapes.
        if kind.model is not Item and (count := len(kind.of(level))):
            yield phrases.counted(count, kind.noun, kind.plural)
    for label in ("guard", "wanderer"):
        cells = [
            now.movers[number] if now is not None else None
            for number, mover in enumerate(level.movers)
            if mover.picture == label
        ]
        if cells:
            at = f" at {show_cell(cells[0])}" if len(cells) == 1 and cells[0] is not None else ""
            yield f"{phrases.counted(len(cells), label)}{at}"


def _features(level: GridWorld) -> Iterator[str]:
    """Yield what the level is made of."""
    puddles = Counter(puddle.size for puddle in level.puddles)
    for size in ("small", "large"):
        if puddles[size]:
            yield phrases.counted(puddles[size], f"{size} puddle")
    if level.warps:
        yield phrases.counted(len(level.warps), "warp")
    if level.grid().glass:
        # Each wall is known to both of its cells.
        yield phrases.counted(len(level.grid().glass) // 2, "glass wall")
    if level.wind is not None:
        yield "wind"
    if blocked := sum(level.grid().blocked_cells):
        yield phrases.counted(blocked, "blocked cell")
    ends = {ground.name for ground in grounds_of(level) if ground.end is not None}
    labels = dict.fromkeys(phrases.worded(phrases.name_of(area.label)) for area in level.areas)
    if shown := [label for label in labels if label and label not in ends]:
        yield f"the area{'s' if len(shown) > 1 else ''} {listed(shown)}"


# -- what there is to do ---------------------------------------------------------------------------

_MOST_NAMES = 3
"""The most things that the sentence names."""


def goal_of(level: GridWorld) -> str:
    """Return what there is to do as one sentence, such as "Fetch the key, then go to the exit.".

    What has to be fetched or switched on is what is held or on in every episode that ends at an
    exit. Of other good ends, the one that pays most is named if it pays more than the exit.

    Raises:
        LevelError: the maze has no seed yet (`seed: random`).
    """
    good = [ground for ground in grounds_of(level) if ground.end is not None and ground.end.is_good]
    best = max((mean_of(ground.reward) for ground in good), default=0.0)
    exits = [*map(mean_of, exit_rewards(level, level.exits or [level.starts[0]]))]
    if good and (best > max(exits) or not level.has_goal):
        return _reach({ground.name for ground in good if mean_of(ground.reward) == best}, best)
    if level.ends_covered:
        push = "Move a robot onto" if level.robots else "Push a box onto"
        return f"{push} {'each' if level.targets[1:] else 'the'} target."
    if not level.exits:
        limit = level.max_steps
        within = "" if limit is None else f" in {phrases.counted(limit, 'step')}"
        return f"Collect as much reward as you can{within}."
    several = len(level.exits) > 1 and level.exit_one_of is None
    exit_ = "an exit" if several else "the exit"
    if level.robots:
        return _team_goal(level, exit_)
    errands = _errands(level)
    return f"{errands}, then go to {exit_}." if errands else f"Move the robot to {exit_}."


def _team_goal(level: GridWorld, exit_: str) -> str:
    """Return which of several robots have to arrive, and where."""
    own = any(robot.exit is not None for robot in level.robots)
    if level.team.ends == "first":
        return f"Move a robot to {'its exit' if own else exit_}."
    return f"Move all robots to {'their exits' if own else exit_}."


def _reach(names: set[str], reward: float) -> str:
    """Return the sentence for the ends that pay most."""
    if len(names) == 1:
        return f"Reach the {names.pop()}."
    return f"Reach a cell that ends the episode and {phrases.reward(reward)}."


def _errands(level: GridWorld) -> str:
    """Return what has to be done before the exit; empty for nothing."""
    needed = _needed(level)
    errands: dict[str, list[str]] = {}
    for kind in NEEDED:
        names = [thing.name for thing in kind.of(level) if thing.name in needed]
        if names:
            errands[kind.need.get] = names
    if sum(map(len, errands.values())) > _MOST_NAMES:
        return f"{listed([*errands])} what is needed".capitalize()
    told = [f"{get} the {spoken(names)}" for get, names in errands.items()]
    return " and ".join(told).capitalize()


def _needed(level: GridWorld) -> frozenset[str]:
    """Return what is held or on in each configuration in which an episode ends at an exit."""
    if not any(kind.of(level) for kind in NEEDED):
        return frozenset()
    things = level.things()
    begins = [things.met(each) for each in things.draws()]
    return _met_at_exits(level) - frozenset.intersection(*begins)


def _met_at_exits(level: GridWorld) -> frozenset[str]:
    if not is_numeric():
        return frozenset(level.exit_keys)
    import numpy as np

    mdp, things = level.compile(), level.things()
    is_exit = np.zeros(mdp.cells, bool)
    is_exit[[y * mdp.width + x for x, y in level.exits]] = True
    # Episodes do not go on from terminal states, among which are all that none reaches.
    happens = (mdp.probability > 0) & mdp.terminal & ~mdp.is_terminal[:, None, None]
    reached = np.unique(mdp.next_state[happens & is_exit[mdp.next_state % mdp.cells]])
    values = mdp.configurations[np.unique(reached // mdp.cells)].tolist()
    met = [things.met(each) for each in values if things.exit_is_open(each)]
    return frozenset.intersection(*met) if met else frozenset()
