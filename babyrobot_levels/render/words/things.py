"""Things in words: what they open, close, pay and cost."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, Any

from babyrobot_levels.language.kinds import NEEDED
from babyrobot_levels.mdp.doors import door_name
from babyrobot_levels.render.words import phrases
from babyrobot_levels.text.words import listed

if TYPE_CHECKING:
    from babyrobot_levels.language.things import Door, Item, Mover
    from babyrobot_levels.mdp.gridworld import GridWorld

Names = tuple[str, ...]


def spoken(names: Sequence[str]) -> str:
    """Return names of things as a list in words, the names' hyphens as spaces."""
    return listed([phrases.name_of(name.replace("-", " ")) for name in names])


def item_count(count: int, shape: str) -> str:
    """Return a number of items of a shape: `6 coins`."""
    return phrases.counted(count, shape, "boxes" if shape == "box" else None)


def thing_rules(level: GridWorld) -> Iterator[tuple[str, str]]:
    """Yield what the things of a level do, movers last: each as a sample's name and a text."""
    acts = _acts(level)
    pays = {item.name: item.reward for item in level.items if item.reward is not None}
    told = {(name,) for name in pays} | {*acts}
    for (shape, _), items in _by_look(level.items).items():
        lone = [item.name for item in items if item.name in pays and (item.name,) not in acts]
        if len(lone) > 1:
            each = phrases.rewards(pays[name] for name in lone)
            yield f"item:{lone[0]}", f"{item_count(len(lone), shape)}: each {each}"
            told -= {(name,) for name in lone}
    known = {thing.name: (kind, thing) for kind in NEEDED for thing in kind.of(level)}
    order = [*known]
    for names in sorted(told, key=lambda names: [order.index(name) for name in names]):
        kind, thing = known[names[0]]
        parts = [f"{verb if len(names) == 1 else verb[:-1]} {what}" for verb, what in acts[names]]
        if len(names) == 1 and names[0] in pays:
            parts.append(phrases.reward(pays[names[0]]))
        when = _when(thing) if "on" in kind.properties and len(names) == 1 else ""
        yield f"{kind.name}:{names[0]}", f"{spoken(names)}: {when}{', '.join(parts)}"
    yield from _movers(level)


def _when(thing: Any) -> str:
    """Return when something that can be on does what it does."""
    return f"{'flips once, ' * thing.once}{'on at first, ' * thing.on}while on: "


def _acts(level: GridWorld) -> dict[Names, list[tuple[str, str]]]:
    """Return what things that belong together open and close, each as a verb and its object."""
    doors: dict[tuple[str, Names], list[Door]] = defaultdict(list)
    for door in level.doors:
        if door.keys:
            doors["opens", door.keys].append(door)
        for name in door.locks:
            doors["closes", (name,)].append(door)
    acts: dict[Names, list[tuple[str, str]]] = defaultdict(list)
    for (verb, names), found in doors.items():
        acts[names].append((verb, _doors(level, found)))
    if level.exit_keys:
        acts[level.exit_keys].append(("opens", "the exit" if len(level.exits) == 1 else "exits"))
    return acts


def _doors(level: GridWorld, doors: Sequence[Door]) -> str:
    """Return how doors are called: by their colour, if no other door has it."""
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


def _movers(level: GridWorld) -> Iterator[tuple[str, str]]:
    """Yield one text for all guards, and one for all wanderers."""
    hit = f"meeting it {phrases.reward(level.hit.reward)}"
    hit += ", ends the episode" if level.hit.ends else ""
    kinds: dict[str, list[tuple[int, Mover]]] = defaultdict(list)
    for number, mover in enumerate(level.movers):
        kinds["guard" if mover.within is None else "wanderer"].append((number, mover))
    for kind, movers in kinds.items():
        ways = "walks its path" if kind == "guard" else "wanders at random"
        number, mover = movers[0]
        name = phrases.counted(len(movers), kind)
        if len(movers) == 1:
            name = spoken([mover.name or kind])
        yield f"mover:{number}", f"{name}: {ways}, {hit}"
