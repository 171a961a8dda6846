"""The rules of a level in words: what is in it, what it does, what it pays, and how often.

They are also the legend of a picture: each names the sample that is drawn beside it.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import compress, islice
from typing import TYPE_CHECKING, NamedTuple

from babyrobot_levels.language.cells import (
    Area,
    RandomReward,
    Skid,
    Told,
    Warp,
    Wind,
    as_skid,
    mean_of,
    shifts,
)
from babyrobot_levels.language.geometry import show_cell
from babyrobot_levels.language.kinds import NEEDED
from babyrobot_levels.language.things import Door, Item, Mover
from babyrobot_levels.mdp.actions import NUM_MOVES
from babyrobot_levels.mdp.grid import door_name
from babyrobot_levels.mdp.ground import exit_rewards, rows_of
from babyrobot_levels.render.situation import End, effects_of
from babyrobot_levels.render.words import phrases
from babyrobot_levels.text.words import listed

if TYPE_CHECKING:
    from babyrobot_levels.mdp.gridworld import GridWorld

_PROPERTIES = ("color", "label", "reward", "skid", "ends")


@dataclass(frozen=True, slots=True)
class Ground:
    """A kind of ground.

    Attributes:
        cells: the numbers of its cells, row by row.
        name: what it is called: by its label, by its mark in pictures, or by its colour.
        reward: the reward for entering it.
        skid: its own skid; None for that of the level.
        end: how it ends the episode; None if it does not.
        warp: the warp in it.
    """

    cells: tuple[int, ...]
    name: str
    reward: float | RandomReward
    skid: Skid | None
    end: End | None
    warp: Warp | None

    def places(self, level: GridWorld) -> list[tuple[int, int]]:
        """Return its cells as `(x, y)`."""
        width = level.size[0]
        return [(cell % width, cell // width) for cell in self.cells]


def grounds_of(level: GridWorld) -> Iterator[Ground]:
    """Yield the kinds of ground that areas and warps make, in the order of their first cells.

    Exits, blocked cells and puddles are left out, except for puddles with a warp, and those in
    which episodes end.
    """
    if not (level.areas or level.warps):
        return
    width, height = level.size
    # For each property, and for warps, the number of the last entry that gives it in a cell.
    layers = [[-1] * (width * height) for _ in range(len(_PROPERTIES) + 1)]
    for number, area in enumerate(level.areas):
        given = [getattr(area, name) is not None for name in _PROPERTIES]
        for cells in rows_of(area.at, area.size, width):
            for layer in compress(layers, given):
                layer[cells] = [number] * area.size[0]
    for number, warp in enumerate(level.warps):
        layers[-1][warp.at[1] * width + warp.at[0]] = number
    left_out = bytearray(level.grid().blocked_cells)
    for x, y in level.exits:
        left_out[y * width + x] = 1
    wet = {puddle.at[1] * width + puddle.at[0]: puddle.size for puddle in level.puddles}
    places: dict[tuple[tuple[int, ...], str], list[int]] = {}
    for cell, kind in enumerate(zip(*layers, strict=True)):
        if not left_out[cell] and any(number >= 0 for number in kind):
            places.setdefault((kind, wet.get(cell, "")), []).append(cell)
    told = effects_of(level).ends if any(area.ends for area in level.areas) else {}
    for ((*areas, last), puddle), found in places.items():
        ground = _ground(level, tuple(found), areas, last, told)
        if puddle:
            ground = replace(ground, reward=getattr(level.puddle_types, puddle).reward, skid=None)
        if ground.end or ground.warp or not puddle:
            yield ground


def _ground(
    level: GridWorld,
    cells: tuple[int, ...],
    areas: list[int],
    warp: int,
    told: Mapping[tuple[int, int], End],
) -> Ground:
    def given(name: str) -> Area | None:
        number = areas[_PROPERTIES.index(name)]
        return level.areas[number] if number >= 0 else None

    color, label, reward, skid, ends = (given(name) for name in _PROPERTIES)
    y, x = divmod(cells[0], level.size[0])
    end = told.get((x, y)) if ends and ends.ends else None
    name = phrases.worded(phrases.name_of(label.label)) if label else ""
    if not name and end is not None:
        name = "chest" if end.is_good else "trap" if end.costs else "hole"
    elif not name and warp >= 0:
        name = "warp"
    elif not name:
        shown = color.color if color else None
        theme = level.resolved_theme.colors
        name = "some cells" if shown is None else f"{phrases.color_name(shown, theme)} cell"
    return Ground(
        cells=cells,
        name=name,
        reward=reward.reward if reward and reward.reward is not None else level.rewards.step,
        skid=as_skid(skid.skid) if skid and skid.skid is not None else None,
        end=end,
        warp=level.warps[warp] if warp >= 0 else None,
    )


# -- the rules ------------------------------------------------------------------------------------

MOST = 20
"""The most rules that are told: pages take no more from links."""

_MOST_GROUNDS = 6
"""The most kinds of ground that are told one by one."""


class Rule(NamedTuple):
    """A rule in words.

    Attributes:
        sample: the name of the sample that is drawn beside it, for `sample_shapes`; empty for
            none.
        text: one printable line.
        cells: the numbers of the cells that it is about, row by row; none if it is about more
            than cells.
    """

    sample: str
    text: str
    cells: tuple[int, ...] = ()


Rules = Iterator[Rule]


def rules_of(level: GridWorld, *, drawn: bool = True) -> tuple[Rule, ...]:
    """Return the rules of a level, the most important first.

    Args:
        level: the level; a maze needs a seed.
        drawn: whether they stand beside a picture, which shows the doors and warps that are meant,
            and has room for `MOST`: where there are more, the last one says how many. If not, the
            rules say where doors stand and warps lead, and all are told.

    Raises:
        LevelError: the maze has no seed yet (`seed: random`).
    """
    rules = tuple(_told(level, drawn))
    if len(rules) <= MOST or not drawn:
        return rules
    rest = rules[MOST - 1 :]
    cells = tuple(sorted({cell for rule in rest for cell in rule.cells}))
    return (*rules[: MOST - 1], Rule("", f"and {len(rest):,} further rules", cells))


def _told(level: GridWorld, drawn: bool) -> Rules:
    grounds = [*grounds_of(level)]
    ends = sorted(
        (ground for ground in grounds if ground.end is not None),
        key=lambda ground: -mean_of(ground.reward),
    )
    others = sorted(
        (ground for ground in grounds if ground.end is None),
        key=lambda ground: -abs(mean_of(ground.reward)),
    )
    yield from _exits(level)
    yield from _robots(level)
    yield from _targets(level)
    yield from _grounds(level, ends, drawn)
    yield Rule("ground", f"each step: {phrases.reward(level.rewards.step)}")
    if level.moves > NUM_MOVES:
        yield Rule("", "moves: also diagonal, where both ways around the corner are open")
    yield from (Rule(sample, text) for sample, text in thing_rules(level, drawn))
    if level.skid is not None:
        yield Rule("ground", f"each move: {phrases.skidding(as_skid(level.skid))}")
    yield from _puddles(level)
    yield from _grounds(level, others, drawn)
    yield from _wind(level)
    yield from _glass(level, drawn)
    yield from _step_rewards(level)
    if level.max_steps is not None:
        yield Rule("", f"the episode ends after {phrases.counted(level.max_steps, 'step')}")
    if level.discount != 1:
        yield Rule("", f"discount {phrases.amount(level.discount)}")
    if blocked := tuple(cell for cell, found in enumerate(level.grid().blocked_cells) if found):
        yield Rule("blocked", "blocked: cannot be entered", blocked)
    if level.robots:
        return
    text = "start: episodes begin here"
    if len(level.starts) > 1:
        text = f"start: one of {len(level.starts):,} cells, drawn at random"
        if level.start_weights:
            text = f"start: {_weighed(level.starts, level.start_weights)}"
    yield Rule("start", text, _numbers(level, level.starts))


def _weighed(cells: Sequence[tuple[int, int]], weights: Sequence[float]) -> str:
    """Return cells of which one is drawn, with how often each is, unless there are many."""
    if len(cells) > phrases.MOST_WEIGHED:
        return f"one of {len(cells):,} cells, some more often than others"
    total = sum(weights)
    told = zip(cells, weights, strict=True)
    return listed([f"{show_cell(at)} {phrases.chance(each / total)}" for at, each in told], "or")


def _numbers(level: GridWorld, cells: Iterable[tuple[int, int]]) -> tuple[int, ...]:
    return tuple(sorted(y * level.size[0] + x for x, y in cells))


def _exits(level: GridWorld) -> Rules:
    if not level.exits:
        return
    where = ""
    if level.exit_one_of is not None:
        where = f"in one of {len(level.exits)} cells, "
        if level.exit_weights:
            where = f"in {_weighed(level.exit_one_of, level.exit_weights)}, "
    worth = exit_rewards(level, level.exits)
    if 1 < len({*worth}) <= _MOST_GROUNDS and level.exit_one_of is None and not level.robots:
        for reward in dict.fromkeys(worth):
            alike = (cell for cell, each in zip(level.exits, worth, strict=True) if each == reward)
            text = f"exit: ends the episode, {phrases.reward(reward)}"
            yield Rule("exit", text, _numbers(level, alike))
        return
    pays = phrases.rewards(worth)
    text = f"exit: {where}ends the episode, {pays}"
    if level.robots:
        leaves = "leaves" if level.team.arrived == "leave" else "stays"
        last = "last" if level.team.ends == "all" else "first"
        text = f"exit: {where}{pays}, and a robot {leaves}; the {last} ends the episode"
    yield Rule("exit", text, _numbers(level, level.exits))


_MEETINGS = {
    "block": "robots that want one cell, or to change places, stay",
    "order": "of robots that want one cell the first goes, the others stay",
    "pass": "robots do not hinder each other",
    "end": "robots that meet end the episode",
}


def _robots(level: GridWorld) -> Rules:
    """Yield where several robots begin, by which exit they leave, and what meeting means."""
    for robot, start in level.team_starts:
        leaves = "" if robot.exit is None else f", leaves at {show_cell(robot.exit)}"
        yield Rule("start", f"{robot.name}: begins at {show_cell(start)}{leaves}")
    if level.robots:
        yield Rule("", _MEETINGS[level.team.meet])


def _targets(level: GridWorld) -> Rules:
    if level.targets:
        what = "robot" if level.robots else "box"
        text = f"target: a {what} belongs there"
        if level.ends_covered:
            every = f"when all have a {what}"
            if len(level.targets) == 1:
                every = f"when a {what} stands there"
            worth = level.rewards.exit
            pays = "pays what the robot's cell does"
            if not isinstance(worth, str):
                pays = phrases.reward(worth)
            text = f"target: the episode ends {every}, {pays}"
        yield Rule("target", text, _numbers(level, (target.at for target in level.targets)))
    if level.boxes:
        yield Rule("box", "box: the robot pushes it, if nothing stands behind it")


def _puddles(level: GridWorld) -> Rules:
    for size in ("small", "large"):
        if cells := [puddle.at for puddle in level.puddles if puddle.size == size]:
            kind = getattr(level.puddle_types, size)
            skids = phrases.skidding(as_skid(kind.skid))
            text = f"{size} puddle: {phrases.reward(kind.reward)}, {skids}"
            yield Rule(f"puddle-{size}", text, _numbers(level, cells))


def _grounds(level: GridWorld, grounds: list[Ground], drawn: bool) -> Rules:
    """Yield what kinds of ground do; those of the same name that do the same once."""
    arrows = drawn and sum(ground.name == "warp" for ground in grounds) > 1
    told: dict[str, list[int]] = defaultdict(list)
    for ground in grounds:
        if effects := list(_effects(level, ground, arrows=arrows)):
            told[f"{ground.name}: {', '.join(effects)}"] += ground.cells
    kinds = iter(told.items())
    for text, cells in islice(kinds, _MOST_GROUNDS if drawn else None):
        y, x = divmod(cells[0], level.size[0])
        yield Rule(f"cell:{x},{y}", text, tuple(sorted(cells)))
    if more := list(kinds):
        text = f"{phrases.counted(len(more), 'further kind')} of cells with effects of their own"
        yield Rule("", text, tuple(sorted(number for _, cells in more for number in cells)))


def _effects(level: GridWorld, ground: Ground, *, arrows: bool) -> Iterator[str]:
    """Yield what a kind of ground does that no other ground does."""
    step, reward = level.rewards.step, ground.reward
    warp = ground.warp if ground.end is None else None
    if warp is not None:
        # Without a reward of its own, it pays what the cell pays to which it leads.
        reward = step if warp.reward is None else warp.reward
        if warp.when == "leave" and ground.reward != step:
            yield f"entering it {phrases.reward(ground.reward)}"
    if ground.end is not None:
        yield "ends the episode"
    if ground.end is not None or reward != step:
        yield phrases.reward(reward)
    if warp is not None:
        yield from _leads(level, warp, arrows=arrows and ground.name == "warp")
    elif (
        ground.skid is not None and ground.end is None and ground.skid != as_skid(level.skid or 0.0)
    ):
        yield phrases.skidding(ground.skid)


def _leads(level: GridWorld, warp: Warp, *, arrows: bool) -> Iterator[str]:
    """Yield how often a warp acts, and where it leads."""
    moves = "every move " if warp.when == "leave" else ""
    if warp.probability < 1:
        moves = f"{'a move ' if moves else ''}{phrases.chance(warp.probability)} "
    leads = () if isinstance(warp.to, str) else level.leads_of(warp)
    if not leads:
        yield f"{moves}leads back to {'a' if level.starts[1:] else 'the'} start"
    elif len({weight for _, weight in leads}) > 1:
        cells, weights = zip(*leads, strict=True)
        yield f"{moves}leads to {_weighed(cells, weights)}"
    elif arrows:
        yield f"{moves}leads along {'one of its arrows' if leads[1:] else 'its arrow'}"
    else:
        yield f"{moves}leads to {listed([show_cell(cell) for cell, _ in leads], 'or')}"


def _wind(level: GridWorld) -> Rules:
    """Yield one rule for each direction in which wind pushes."""
    souths, easts = shifts(level.wind, *level.size)
    for lines, pushes, (forward, backward) in (
        ("column", souths, ("south", "north")),
        ("row", easts, ("east", "west")),
    ):
        for side, sign in ((forward, 1), (backward, -1)):
            places: dict[int, list[int]] = defaultdict(list)
            for number, push in enumerate(pushes):
                if sign * push > 0:
                    places[sign * push].append(number)
            if places:
                pushing = f"{_pushes(places, side, lines)}{_how(level.wind)}"
                yield Rule(f"wind:{side}", f"wind: pushes {pushing}")


def _how(wind: Wind | None) -> str:
    """Return how often a wind blows, and whether it varies."""
    varies = ", a cell less or more 2 times in 3" if wind is not None and wind.varies else ""
    if wind is None or wind.probability == 1:
        return varies
    return f", {phrases.chance(wind.probability)}{varies}"


def _pushes(places: dict[int, list[int]], side: str, lines: str) -> str:
    if len(places) > 2:
        strengths = f"{min(places)} to {max(places)} cells {side}"
        places = {0: [number for numbers in places.values() for number in numbers]}
    else:
        strengths = ""
    parts: list[str] = []
    for strength, numbers in sorted(places.items()):
        cells = strengths or f"{phrases.counted(strength, 'cell')} {side if not parts else ''}"
        which = lines if len(numbers) == 1 else f"{lines}s"
        parts.append(f"{cells.strip()} in {which} {phrases.ranges(numbers)}")
    return ", ".join(parts)


def _glass(level: GridWorld, drawn: bool) -> Rules:
    passes = {*level.grid().glass.values()}
    if not passes:
        return
    least, most = min(passes), max(passes)
    if least != most and not drawn:
        yield from _each_glass(level)
        return
    often = phrases.chance(least)
    if least != most:
        often = f"{100 * least:.3g} to {100 * most:.3g} % of the time"
    bounce = level.rewards.bounce
    more = f", a bounce {phrases.reward(bounce)} more" if bounce else ""
    yield Rule("glass", f"glass wall: lets through {often}{more}")


def _each_glass(level: GridWorld) -> Rules:
    """Yield one rule for each strength of glass, with its walls; each is known to both cells."""
    walls: dict[float, list[str]] = defaultdict(list)
    for (cell, side), passing in sorted(level.grid().glass.items()):
        if side in "ES":
            y, x = divmod(cell, level.size[0])
            way = "east" if side == "E" else "south"
            walls[passing].append(f"{way} of {phrases.cells([(x, y)])}")
    bounce = level.rewards.bounce
    more = f", a bounce {phrases.reward(bounce)} more" if bounce else ""
    for passing, places in walls.items():
        often = f"lets through {phrases.chance(passing)}{more}"
        yield Rule("glass", f"glass wall {listed(places)}: {often}")


def _step_rewards(level: GridWorld) -> Rules:
    for name, field in type(level.rewards).model_fields.items():
        reward = getattr(level.rewards, name)
        for told in field.metadata if reward is not None else ():
            if isinstance(told, Told):
                yield Rule(told.sample, f"{told.text}: {phrases.reward(reward)}")


# -- what things do --------------------------------------------------------------------------------

Names = tuple[str, ...]


def spoken(names: Sequence[str]) -> str:
    """Return names of things as a list in words, the names' hyphens as spaces."""
    return listed([phrases.name_of(name.replace("-", " ")) for name in names])


def item_count(count: int, shape: str) -> str:
    """Return a number of items of a shape: `6 coins`."""
    return phrases.counted(count, shape, "boxes" if shape == "box" else None)


def thing_rules(level: GridWorld, drawn: bool) -> Iterator[tuple[str, str]]:
    """Yield what the things of a level do, movers last: each as a sample's name and a text."""
    acts = _acts(level, drawn)
    pays = {item.name: item.reward for item in level.items if item.reward is not None}
    only = {item.name: item.robot for item in level.items if item.robot is not None}
    told = {(name,) for name in (*pays, *only)} | {*acts}
    for (shape, _), items in _by_look(level.items).items():
        lone = [
            item.name
            for item in items
            if item.name in pays and item.name not in only and (item.name,) not in acts
        ]
        if len(lone) > 1 and (drawn or len({pays[name] for name in lone}) == 1):
            each = phrases.rewards(pays[name] for name in lone)
            yield f"item:{lone[0]}", f"{item_count(len(lone), shape)}: each {each}"
            told -= {(name,) for name in lone}
    known = {thing.name: (kind, thing) for kind in NEEDED for thing in kind.of(level) if thing.name}
    order = [*known]
    for names in sorted(told, key=lambda names: [order.index(name) for name in names]):
        kind, thing = known[names[0]]
        parts = [f"{verb if len(names) == 1 else verb[:-1]} {what}" for verb, what in acts[names]]
        if len(names) == 1 and names[0] in pays:
            parts.append(phrases.reward(pays[names[0]]))
        if len(names) == 1 and names[0] in only:
            parts.append(f"only {only[names[0]]} takes it")
        when = ""
        if kind.name == "target":
            when = "while covered: "
        elif "on" in kind.properties and len(names) == 1:
            when = f"{'flips once, ' * thing.once}{'on at first, ' * thing.on}while on: "
        yield f"{kind.name}:{names[0]}", f"{spoken(names)}: {when}{', '.join(parts)}"
    yield from _movers(level)


def _acts(level: GridWorld, drawn: bool) -> dict[Names, list[tuple[str, str]]]:
    """Return what things that belong together open and close, each as a verb and its object."""
    doors: dict[tuple[str, Names], list[Door]] = defaultdict(list)
    for door in level.doors:
        if door.keys:
            doors["opens", door.keys].append(door)
        for name in door.locks:
            doors["closes", (name,)].append(door)
    acts: dict[Names, list[tuple[str, str]]] = defaultdict(list)
    for (verb, names), found in doors.items():
        acts[names].append((verb, _doors(level, found, drawn)))
    if level.exit_keys:
        acts[level.exit_keys].append(("opens", "the exit" if len(level.exits) == 1 else "exits"))
    return acts


def _doors(level: GridWorld, doors: Sequence[Door], drawn: bool) -> str:
    """Return how doors are called: by their colour, if no other door has it."""
    if not drawn:
        return listed([f"the {door_name(door)}" for door in doors])
    if len(level.doors) == len(doors) == 1:
        return "the door"
    if len(doors) > 1:
        return f"{len(doors)} doors"
    colors = [_color(level, door) for door in level.doors]
    color = _color(level, doors[0])
    is_own = color is not None and colors.count(color) == 1
    return f"the {color} door" if is_own else f"the {door_name(doors[0])}"


def _color(level: GridWorld, door: Door) -> str | None:
    """Return the colour of a door in words: its own, or that of the first item that it needs."""
    named = {item.name: item.color for item in level.items}
    color = door.color or next((named[name] for name in door.keys if name in named), None)
    return None if color is None else phrases.color_name(color, level.resolved_theme.colors)


def _by_look(items: Iterable[Item]) -> dict[tuple[str, str | None], list[Item]]:
    looks: dict[tuple[str, str | None], list[Item]] = defaultdict(list)
    for item in items:
        looks[item.picture, item.color].append(item)
    return looks


_LONG = 16
"""Longer paths are not told cell by cell beside a drawing."""


def mover_names(level: GridWorld) -> list[str]:
    """Return what movers are called: by their names, else by their kinds and numbers."""
    pictures = Counter(mover.picture for mover in level.movers)
    return [
        f"the {spoken([mover.name])}"
        if mover.name
        else f"{mover.picture} {number}"
        if pictures[mover.picture] > 1
        else f"the {mover.picture}"
        for number, mover in enumerate(level.movers, 1)
    ]


def ways_of(level: GridWorld, *, longest: int = _LONG) -> Iterator[str]:
    """Yield where movers go; of a path of more cells than `longest`, only where it begins."""
    for mover, name in zip(level.movers, mover_names(level), strict=True):
        if mover.within is not None:
            (x, y), (columns, rows) = mover.within.at, mover.within.size
            begins = "" if mover.start else ", and begins in any of them"
            yield (
                f"{name} stays in columns {x} to {x + columns - 1} and rows {y} to "
                f"{y + rows - 1}{begins}: in each step it stays or goes to a cell beside it, each "
                "equally often"
            )
        elif len(mover.phases) <= longest:
            yield f"{name} walks {phrases.cells(mover.phases)}, and again from the first cell"
        else:
            there = phrases.cells([mover.phases[0]])
            yield f"{name} walks a path of {len(mover.phases):,} steps, which begins in {there}"


def _movers(level: GridWorld) -> Iterator[tuple[str, str]]:
    """Yield one text for all guards, and one for all wanderers."""
    hit = f"meeting it {phrases.reward(level.hit.reward)}"
    hit += ", ends the episode" if level.hit.ends else ""
    kinds: dict[str, list[tuple[int, Mover]]] = defaultdict(list)
    for number, mover in enumerate(level.movers):
        kinds[mover.picture].append((number, mover))
    for kind, movers in kinds.items():
        ways = "walks its path" if kind == "guard" else "wanders at random"
        number, mover = movers[0]
        name = phrases.counted(len(movers), kind)
        if len(movers) == 1:
            name = spoken([mover.name or kind])
        yield f"mover:{number}", f"{name}: {ways}, {hit}"
