"""A level as a model checker takes it: numbered states, actions, labels, and what is not kept."""

import re
from collections.abc import Container, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.analysis.solver.results import action_names
from babyrobot_levels.extensions.formats.conversion import Lost, fields_lost, shown
from babyrobot_levels.language.fields import Role, fields_with
from babyrobot_levels.language.names import numbered
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.states import ends_by_hit, exit_states
from babyrobot_levels.mdp.tables import Flags, Ints, Mdp

ABOUT = ("title", "description", "author", "license", "source")
"""The fields that say what the level is, and whose."""

_CARRIED = frozenset(
    {*fields_with(Role.GEOMETRY, Role.DYNAMICS, Role.REWARD), *ABOUT, "max_steps", "discount"}
)
"""The fields that are kept, or of which `losses` has more to say."""

_ALWAYS = ("exit", "end", "hit", "puddle", "small_puddle", "large_puddle")
"""Labels that every level has, so that a property can be asked of all."""


@dataclass(frozen=True, eq=False)
class Process:
    """A Markov decision process for a model checker.

    The first states are those of the tables, with their numbers. If hits can end the episode where
    others go on, there follows the state of these; if there are several starts, the one that draws
    one of them.

    Attributes:
        mdp: the tables.
        acting: int `[n]`: the states of the tables in which the episode goes on.
        next_state: int `[n, actions, outcomes]`: the numbers of the next states.
        size: the number of all states.
        initial: the number of the initial state.
        starts: the starts and their probabilities, if the initial state draws one.
        labels: for each label whether a state has it, `[size]`.
        renamed: the texts of areas whose label is not their letters and digits.
    """

    mdp: Mdp
    acting: NDArray[np.intp]
    next_state: NDArray[np.int32]
    size: int
    initial: int
    starts: dict[int, float]
    labels: dict[str, Flags]
    renamed: dict[str, str]

    @property
    def actions(self) -> list[str]:
        """The names of the actions, in the order of their numbers."""
        # PRISM has no names with a hyphen.
        return [name.replace("-", "_") for name in action_names("all", self.mdp)]


def process_of(level: Level) -> Process:
    """Return the process of a level.

    Raises:
        LevelError: the maze has no seed yet (`seed: random`).
    """
    mdp = level.compile()
    acting = np.flatnonzero(~mdp.is_terminal)
    hits = ends_by_hit(mdp)[acting]
    starts = np.flatnonzero(mdp.start)
    drawn = starts.size > 1
    size = mdp.num_states + bool(hits.any()) + drawn
    labels = {name: np.zeros(size, bool) for name in _ALWAYS}
    labels["exit"][: mdp.num_states] = exit_states(level, mdp) & mdp.is_terminal
    labels["end"][: mdp.num_states] = mdp.is_terminal
    if hits.any():
        labels["end"][mdp.num_states] = labels["hit"][mdp.num_states] = True
    for name, states in _places(level, mdp):
        labels.setdefault(name, np.zeros(size, bool))[: mdp.num_states] |= states
    named: dict[str, str] = {}
    for text, states in _labelled_areas(level, mdp):
        if text not in named:
            named[text] = _free(f"area_{_word(text)}".strip("_"), labels)
            labels[named[text]] = np.zeros(size, bool)
        labels[named[text]][: mdp.num_states] |= states
    return Process(
        mdp=mdp,
        acting=acting,
        next_state=np.where(hits, np.int32(mdp.num_states), mdp.next_state[acting]),
        size=size,
        initial=size - 1 if drawn else int(starts[0]),
        starts={int(start): float(mdp.start[start]) for start in starts} if drawn else {},
        labels=labels,
        renamed={text: name for text, name in named.items() if name != f"area_{_word(text)}"},
    )


def _places(level: Level, mdp: Mdp) -> Iterator[tuple[str, Flags]]:
    """Yield labels for the puddle where the robot is, and for what it has, each with its states."""
    x, y = _cells(mdp)
    for puddle in level.puddles:
        here = (x == puddle.at[0]) & (y == puddle.at[1])
        yield "puddle", here
        yield f"{puddle.size}_puddle", here
    things, configuration = level.things(), np.arange(mdp.num_states) // mdp.cells
    for name, (column, value) in things.needed.items():
        met = mdp.configurations[configuration, column] == value
        yield f"{_word(name)}_{things[column].met}", met


def _labelled_areas(level: Level, mdp: Mdp) -> Iterator[tuple[str, Flags]]:
    """Yield the label of each area that has one, with the states in it."""
    x, y = _cells(mdp)
    for area in level.areas:
        (left, top), (width, height) = area.at, area.size
        if area.label:
            inside = (left <= x) & (x < left + width) & (top <= y) & (y < top + height)
            yield area.label, inside


def _cells(mdp: Mdp) -> tuple[Ints, Ints]:
    """Return the column and the row of each state's cell."""
    cells = np.arange(mdp.num_states) % mdp.cells
    return cells % mdp.width, cells // mdp.width


def _word(text: str) -> str:
    """Return a text as a part of a label: letters, digits and `_`."""
    return re.sub(r"[^a-z0-9]+", "_", text.lower()).strip("_")


def _free(label: str, taken: Container[str]) -> str:
    """Return a label that no other has, with a number if it is taken."""
    return next(name for name in numbered(label, "_") if name not in taken)


def losses(level: Level, process: Process, place: str) -> tuple[Lost, ...]:
    """Return what the file of a model checker, `place`, does not say of a level."""
    lost = list(fields_lost(level, _CARRIED, place))
    for text, name in process.renamed.items():
        lost.append(Lost("areas.label", f"{shown(text)} is the label {name}"))
    if process.starts:
        text = f"the first step draws one of {len(process.starts)}: add it to a limit of steps"
        lost.append(Lost("start", text))
    if level.discount < 1:
        text = f'a property can say it (Storm: R{{"reward"}}max=? [Cdiscount={level.discount}])'
        lost.append(Lost("discount", f"{place} cannot hold it; {text}"))
    if level.max_steps is not None:
        text = f'a property can say it: Pmax=? [F<={level.max_steps} "exit"]'
        lost.append(Lost("max_steps", f"{place} cannot hold it; {text}"))
    return tuple(lost)
