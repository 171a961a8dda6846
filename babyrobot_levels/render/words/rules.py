"""The rules of a level in words: what is in it, what it does, what it pays, and how often.

They are also the legend of a picture: each names the sample that is drawn beside it.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator
from itertools import islice
from typing import TYPE_CHECKING, NamedTuple

from babyrobot_levels.language.cells import Told, as_skid, shifts
from babyrobot_levels.render.words import phrases
from babyrobot_levels.render.words.grounds import Ground, grounds_of
from babyrobot_levels.render.words.things import thing_rules

if TYPE_CHECKING:
    from babyrobot_levels.mdp.gridworld import GridWorld

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


def rules_of(level: GridWorld) -> tuple[Rule, ...]:
    """Return the rules of a level, the most important first, at most `MOST`.

    Where there are more, the last one says how many.

    Raises:
        LevelError: the maze has no seed yet (`seed: random`).
    """
    rules = tuple(_told(level))
    if len(rules) <= MOST:
        return rules
    rest = rules[MOST - 1 :]
    cells = tuple(sorted({cell for rule in rest for cell in rule.cells}))
    return (*rules[: MOST - 1], Rule("", f"and {len(rest):,} further rules", cells))


def _told(level: GridWorld) -> Rules:
    grounds = [*grounds_of(level)]
    ends = sorted(
        (ground for ground in grounds if ground.end is not None), key=lambda ground: -ground.reward
    )
    others = sorted(
        (ground for ground in grounds if ground.end is None), key=lambda ground: -abs(ground.reward)
    )
    yield from _exits(level)
    yield from _grounds(level, ends)
    yield Rule("ground", f"each step: {phrases.reward(level.rewards.step)}")
    yield from (Rule(sample, text) for sample, text in thing_rules(level))
    if level.skid is not None:
        yield Rule("ground", f"each move: {phrases.skidding(as_skid(level.skid))}")
    yield from _puddles(level)
    yield from _grounds(level, others)
    yield from _wind(level)
    yield from _glass(level)
    yield from _step_rewards(level)
    if level.max_steps is not None:
        yield Rule("", f"the episode ends after {phrases.counted(level.max_steps, 'step')}")
    if level.discount != 1:
        yield Rule("", f"discount {phrases.amount(level.discount)}")
    blocked = tuple(cell for cell, found in enumerate(level.grid().blocked_cells) if found)
    if blocked:
        yield Rule("blocked", "blocked: cannot be entered", blocked)
    text = "start: episodes begin here"
    if len(level.starts) > 1:
        text = f"start: one of {len(level.starts):,} cells, drawn at random"
    yield Rule("start", text, _numbers(level, level.starts))


def _numbers(level: GridWorld, cells: Iterable[tuple[int, int]]) -> tuple[int, ...]:
    return tuple(sorted(y * level.size[0] + x for x, y in cells))


def _exits(level: GridWorld) -> Rules:
    if not level.exits:
        return
    where = ""
    if level.exit_one_of is not None:
        where = f"in one of {len(level.exits)} cells, "
    pays = phrases.reward(level.rewards.exit)
    text = f"exit: {where}ends the episode, {pays}"
    yield Rule("exit", text, _numbers(level, level.exits))


def _puddles(level: GridWorld) -> Rules:
    for size in ("small", "large"):
        if cells := [puddle.at for puddle in level.puddles if puddle.size == size]:
            kind = getattr(level.puddle_types, size)
            skids = phrases.skidding(as_skid(kind.skid))
            text = f"{size} puddle: {phrases.reward(kind.reward)}, {skids}"
            yield Rule(f"puddle-{size}", text, _numbers(level, cells))


def _grounds(level: GridWorld, grounds: list[Ground]) -> Rules:
    """Yield what kinds of ground do; those of the same name that do the same once."""
    arrows = sum(ground.name == "warp" for ground in grounds) > 1
    told: dict[str, list[int]] = defaultdict(list)
    for ground in grounds:
        effects = list(_effects(level, ground, arrows=arrows))
        if effects:
            told[f"{ground.name}: {', '.join(effects)}"] += ground.cells
    kinds = iter(told.items())
    for text, cells in islice(kinds, _MOST_GROUNDS):
        y, x = divmod(cells[0], level.size[0])
        yield Rule(f"cell:{x},{y}", text, tuple(sorted(cells)))
    if more := list(kinds):
        text = f"{phrases.counted(len(more), 'further kind')} of cells with effects of their own"
        yield Rule("", text, tuple(sorted(number for _, cells in more for number in cells)))


def _effects(level: GridWorld, ground: Ground, *, arrows: bool) -> Iterator[str]:
    """Yield what a kind of ground does that no other ground does."""
    warp, reward = ground.warp, ground.reward
    if warp is not None and warp.reward is not None:
        reward = warp.reward
    if ground.end is not None:
        yield "ends the episode"
    if ground.end is not None or reward != level.rewards.step:
        yield phrases.reward(reward)
    if warp is not None:
        moves = "every move " if warp.when == "leave" else ""
        if warp.to == "start":
            yield f"{moves}leads back to the start"
        elif arrows and ground.name == "warp":
            yield f"{moves}leads along its arrow"
        else:
            yield f"{moves}leads to {phrases.cells([warp.to])}"
    elif ground.skid is not None and ground.end is None and ground.skid != _usual(level):
        yield phrases.skidding(ground.skid)


def _usual(level: GridWorld) -> object:
    return as_skid(level.skid or 0.0)


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
                yield Rule(f"wind:{side}", f"wind: pushes {_pushes(places, side, lines)}")


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


def _glass(level: GridWorld) -> Rules:
    passes = {*level.grid().glass.values()}
    if not passes:
        return
    least, most = min(passes), max(passes)
    often = phrases.chance(least)
    if least != most:
        often = f"{100 * least:.3g} to {100 * most:.3g} % of the time"
    bounce = level.rewards.bounce
    more = f", a bounce {phrases.reward(bounce)} more" if bounce else ""
    yield Rule("glass", f"glass wall: lets through {often}{more}")


def _step_rewards(level: GridWorld) -> Rules:
    for name, field in type(level.rewards).model_fields.items():
        reward = getattr(level.rewards, name)
        for told in field.metadata if reward is not None else ():
            if isinstance(told, Told):
                yield Rule(told.sample, f"{told.text}: {phrases.reward(reward)}")
