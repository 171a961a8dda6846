"""Levels in the language of PRISM, which model checkers read: `babyrobot export --to prism`."""

from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping
from fractions import Fraction
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.analysis.solver.exact import ROUNDING, denominators
from babyrobot_levels.extensions.formats.conversion import Conversion
from babyrobot_levels.extensions.formats.processes import ABOUT, Process, losses, process_of
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.tables import Ints
from babyrobot_levels.text.diagnostics import one_line

_TOGETHER = 50
"""How many alternatives stand side by side: readers nest each in the one before."""

_MOST_STARTS = 10**6
"""The largest denominator of the probability of a start."""

_MAX_INTEGER = 2**31 - 1
"""PRISM's largest integer; others are floats."""

Numbers = Callable[[float], Fraction]
Rows = dict[tuple[str, Any], Ints]
"""For each action and its updates as text, or what it pays on average: the states."""


def write_prism(level: Level) -> Conversion:
    """Return a level as a module of PRISM."""
    process = process_of(level)
    text = "".join(f"{line}\n" for line in _lines(level, process))
    return Conversion(text, losses(level, process, "a PRISM module"))


def _lines(level: Level, process: Process) -> Iterator[str]:
    mdp = process.mdp
    chance, unit = denominators(level)
    commands, rewards = _rows(process, _fractions(chance), _fractions(unit))
    for name in ABOUT:
        for line in (getattr(level, name) or "").splitlines():
            yield f"// {one_line(line)}".rstrip()
    yield from ("mdp", "", "// The cell, and the number of the configuration of things.")
    for name, value in (
        ("x", f"mod(s, {mdp.width})"),
        ("y", f"mod(floor(s / {mdp.width}), {mdp.height})"),
        ("configuration", f"floor(s / {mdp.cells})"),
    ):
        is_cell = f"s < {mdp.num_states} ? {value} : -1" if process.size > mdp.num_states else value
        yield f"formula {name} = {is_cell};"
    yield from ("", "module robot", f"  s : [0..{process.size - 1}] init {process.initial};")
    for (action, updates), states in commands.items():
        yield f"  [{action}] {_among(states)} -> {updates};"
    if process.starts:
        chances = {
            f"(s'={start})": Fraction(chance).limit_denominator(_MOST_STARTS)
            for start, chance in process.starts.items()
        }
        yield f"  [] s={process.initial} -> {_updates(chances)};"
    if (over := np.flatnonzero(process.labels["end"])).size:
        yield f"  [] {_among(over)} -> true;"
    yield "endmodule"
    for name, sign in (("reward", 1), ("cost", -1)):
        yield from ("", f'rewards "{name}"')
        for (action, reward), states in rewards.items():
            yield f"  [{action}] {_among(states)} : {_text(sign * reward)};"
        if not rewards:
            # Readers take no empty structure.
            yield "  true : 0;"
        yield "endrewards"
    yield ""
    for name, has in process.labels.items():
        yield f'label "{name}" = {_among(np.flatnonzero(has))};'


def _rows(process: Process, chance: Numbers, unit: Numbers) -> tuple[Rows, Rows]:
    """Return where each action has which updates, and where it pays what on average."""
    mdp, acting = process.mdp, process.acting
    beyond = 2 * mdp.num_states
    moved = process.next_state - acting[:, None, None]
    moved[process.next_state == mdp.num_states] = beyond
    commands: dict[tuple[str, Any], list[Ints]] = defaultdict(list)
    rewards: dict[tuple[str, Any], list[Ints]] = defaultdict(list)
    for number, action in enumerate(process.actions):
        probability, reward = mdp.probability[acting, number], mdp.reward[acting, number]
        rows = np.concatenate([moved[:, number], probability, reward], axis=1)
        rows *= np.tile(probability > 0, 3)
        kinds, which = np.unique(rows, axis=0, return_inverse=True)
        order = np.argsort(which.ravel(), kind="stable")
        ends = np.cumsum(np.bincount(which.ravel(), minlength=len(kinds)))
        for kind, members in zip(kinds, np.split(acting[order], ends[:-1]), strict=True):
            chances: dict[str, Fraction] = defaultdict(Fraction)
            paid = Fraction(0)
            for by, p, r in kind.reshape(3, -1).T.tolist():
                if p:
                    target = mdp.num_states if by == beyond else f"s{int(by):+}" if by else "s"
                    chances[f"(s'={target})"] += chance(p)
                    paid += chance(p) * unit(r)
            commands[action, _updates(chances)].append(members)
            if paid:
                rewards[action, paid].append(members)
    return _joined(commands), _joined(rewards)


def _joined(rows: Mapping[tuple[str, Any], list[Ints]]) -> Rows:
    return {key: np.sort(np.concatenate(parts)) for key, parts in rows.items()}


def _updates(chances: Mapping[str, Fraction]) -> str:
    """Return the updates of a command; what rounding left over goes to the likeliest."""
    likeliest = max(chances, key=lambda update: chances[update])
    sure = {**chances, likeliest: chances[likeliest] + 1 - sum(chances.values())}
    if len(sure) == 1:
        return likeliest
    return " + ".join(f"{_text(chance)}:{update}" for update, chance in sure.items())


def _among(states: NDArray[Any]) -> str:
    """Return the condition that the state is one of some, which rise."""
    runs = np.split(states, np.flatnonzero(np.diff(states) > 1) + 1) if states.size else []
    terms = [f"s={run[0]}" if run.size == 1 else f"(s>={run[0]} & s<={run[-1]})" for run in runs]
    while len(terms) > _TOGETHER:
        parts = (terms[at : at + _TOGETHER] for at in range(0, len(terms), _TOGETHER))
        terms = [f"({' | '.join(part)})" for part in parts]
    return " | ".join(terms) or "false"


# -- numbers -----------------------------------------------------------------------------------


def _fractions(denominator: int) -> Numbers:
    """Return what reads a number of the tables: as a fraction with a denominator, if it is one."""

    @cache
    def read(number: float) -> Fraction:
        exact = Fraction(number)
        near = Fraction(round(exact * denominator), denominator)
        room = abs(exact) * Fraction(ROUNDING)
        is_sure = room * denominator < Fraction(1, 4) and abs(near - exact) <= room
        return near if is_sure else Fraction(repr(number))

    return read


def _text(number: Fraction) -> str:
    """Return a number as a fraction, which readers take as it is: decimals may lose a digit."""
    parts = [number.numerator, *[number.denominator] * (number.denominator > 1)]
    return "/".join(f"{part}{'.0' * (abs(part) > _MAX_INTEGER)}" for part in parts)
