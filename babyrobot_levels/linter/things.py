"""What becomes of a level's things: by configuration, and by transition, from the tables alone.

Also which movers the robot cannot avoid: from which starts, by whatever policy.
"""

from collections.abc import Iterable, Sequence
from functools import cached_property

import numpy as np

from babyrobot_levels.language.geometry import show_cell
from babyrobot_levels.language.kinds import KIND, Kind
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.graph import Graph
from babyrobot_levels.mdp.states import ends_by_hit
from babyrobot_levels.mdp.tables import Flags, Ints, Mdp, hits_by_mover
from babyrobot_levels.text.words import listed

MAX_OUTCOMES = 20_000_000
"""In larger tables (states times actions times outcomes), hits are not looked for."""


class ThingEffects:
    """What happens to the things of a level.

    A configuration *is played* if an episode can be in it and go on: others only occur in the step
    that ends an episode.

    Attributes:
        level: the level.
        mdp: its tables.
    """

    def __init__(self, level: Level, mdp: Mdp) -> None:
        self.level, self.mdp, self._things = level, mdp, level.things()

    # -- by configuration --------------------------------------------------------------------

    @cached_property
    def is_played(self) -> Flags:
        """In which configurations an episode can go on, `[configurations]`."""
        goes_on = ~self.mdp.is_terminal.reshape(self.mdp.num_configurations, -1)
        is_played: Flags = goes_on.max(axis=1)
        return is_played

    @cached_property
    def met(self) -> dict[str, Flags]:
        """For each thing that can be needed whether it is held, or on, when played."""
        values, things = self.mdp.configurations[self.is_played], self._things
        return {name: values[:, column] == met for name, (column, met) in things.needed.items()}

    def are_met(self, names: Iterable[str]) -> Flags:
        """Return in which of the played configurations all names are held or on."""
        found = np.ones(np.count_nonzero(self.is_played), bool)
        for name in names:
            found &= self.met[name]
        return found

    def is_closed(self, door: int) -> Flags:
        """Return in which of the played configurations a door is closed, by its index."""
        closed = ~self.are_met(self.level.doors[door].keys)
        for name in self.level.doors[door].locks:
            closed |= self.met[name]
        return closed

    @property
    def working_doors(self) -> list[int]:
        """The doors that are open in some played configurations and closed in others."""
        closed = [self.is_closed(number) for number in range(len(self.level.doors))]
        return [number for number, each in enumerate(closed) if each.any() and not each.all()]

    @property
    def exits_open(self) -> bool:
        """Whether what the exits need is ever met. They open before the robot arrives there."""
        return bool(self.are_met(self.level.exit_keys).any())

    def mover_name(self, number: int) -> str:
        """Return the name of a mover, also of one that has none."""
        return self._things.names[self._things.static + number]

    def is_item(self, name: str) -> bool:
        """Return whether a name is that of an item."""
        return any(item.name == name for item in self.level.items)

    # -- by transition -----------------------------------------------------------------------

    @cached_property
    def happens(self) -> Flags:
        """Which outcomes can happen in an episode, `[states, actions, outcomes]`."""
        return (self.mdp.probability > 0) & ~self.mdp.is_terminal[:, None, None]

    def places_left(self, item: int) -> list[int]:
        """Return the numbers of the places of an item from which it is never taken."""
        count = len(self.level.items[item].places)
        values = self.mdp.configurations[:, self._things.items.start + item]
        taken = np.zeros(count + 1, bool)
        before, after = self._changes
        taken[values[before][values[after] == count]] = True
        # What lies under a start is held from the beginning.
        starts = {*self.level.starts}
        places = self.level.items[item].places
        return [n for n, place in enumerate(places) if not taken[n] and place not in starts]

    @cached_property
    def _changes(self) -> tuple[Ints, Ints]:
        """The pairs of configurations of which one leads to the other in a step."""
        mdp, count = self.mdp, self.mdp.num_configurations
        before = np.arange(mdp.num_states)[:, None, None] // mdp.cells
        after = mdp.next_state // mdp.cells
        differs = self.happens & (before != after)
        pairs = np.unique(np.broadcast_to(before, after.shape)[differs] * count + after[differs])
        return np.divmod(pairs, count)

    def changed(self, before: int, after: int) -> tuple[Kind | None, int]:
        """Return the kind and number of what a transition takes or flips; None for nothing."""
        rows = self.mdp.configurations[[before // self.mdp.cells, after // self.mdp.cells]]
        for column in np.flatnonzero(rows[0] != rows[1]).tolist():
            kind = self._things.kinds[column]
            if not self._things[column].moves:
                return KIND[kind], column - self._things.of_kind(kind).start
        return None, 0

    @property
    def can_look_for_hits(self) -> bool:
        """Whether the tables are small enough to look for the hits of each mover in all of them."""
        return self.mdp.probability.size * len(self.level.movers) <= MAX_OUTCOMES

    @cached_property
    def hits(self) -> list[Flags]:
        """For each mover, which outcomes are a hit by it, `[states, actions, outcomes]`.

        The robot is hit if it stands where the mover stands after the step, or if both changed
        places.
        """
        return [hits & self.happens for hits in hits_by_mover(self.level, self.mdp)]

    # -- in words ----------------------------------------------------------------------------

    def told(self, state: int, alike: Sequence[int], among: Sequence[int]) -> str:
        """Return what distinguishes a state from others of its cell: `lever` on and `key` held.

        As few things as possible are named: those without which the words would also be true of a
        state that is not alike. Things that stand still come before movers.

        Args:
            state: the state.
            alike: the states of which the words may be true.
            among: these and those of which they must not be true.
        """
        size, configurations = self.mdp.cells, self.mdp.configurations
        same = {*alike}
        others = [
            each // size for each in among if each % size == state % size and each not in same
        ]
        values = configurations[state // size]
        named = list(range(len(values)))
        for column in reversed(range(len(values))):
            rest = [each for each in named if each != column]
            if not (configurations[others][:, rest] == values[rest]).all(axis=1).any():
                named = rest
        return listed([self._value(column, int(values[column])) for column in named])

    def _value(self, column: int, value: int) -> str:
        thing, name = self._things[column], f"`{self._things.names[column]}`"
        state = thing.states[value]
        if not isinstance(state, str):
            return f"{'the exit' if thing.kind == 'exit' else name} on {show_cell(state)}"
        need = KIND[thing.kind].need
        return f"{name} {need.met if value == thing.is_met else need.unmet}"


MAX_ROUNDS = 1_000
"""After so many rounds nothing is said."""


def unavoidable_starts(mdp: Mdp, hits: Flags, exits: Flags | None) -> list[int] | None:
    """Return the start states from which every policy that can reach an exit may be hit.

    A state is safe if some action leads from it, whatever happens, to safe states without a hit.
    A policy that is surely never hit takes such actions only; so a start is avoidable if it is
    safe and such actions lead from it to an exit.

    Args:
        mdp: the tables.
        hits: the outcomes to avoid, `[states, actions, outcomes]`.
        exits: the exits, `[states]`; None if surviving is all that counts.

    Returns:
        None if it takes too long.
    """
    happens = (mdp.probability > 0) & ~mdp.is_terminal[:, None, None]
    goes_on = happens & ~mdp.terminal
    safe: Flags = ~mdp.is_terminal
    actions = ~(hits & happens).any(axis=2) & safe[:, None]
    for _ in range(MAX_ROUNDS):
        still = actions & ~(goes_on & ~safe[mdp.next_state]).any(axis=2)
        safe_then: Flags = still.max(axis=1)
        if (safe_then == safe).all():
            break
        actions, safe = still, safe_then
    else:
        return None
    starts = np.flatnonzero(mdp.start)
    if exits is None:
        found = ~safe[starts]
    else:
        rows = happens & still[:, :, None] & ~ends_by_hit(mdp)
        states, taken, outcomes = rows.nonzero()
        back = Graph(mdp.num_states, mdp.next_state[states, taken, outcomes], states)
        found = back.distances(np.flatnonzero(exits)) < 0
        found = found[starts]
    unavoidable: list[int] = starts[found].tolist()
    return unavoidable
