"""POMDPs as files of others: Cassandra's format, the language of PRISM, and Storm's DRN.

All three number states, actions and observations. After the hidden states comes the end of
episodes, a state that is not left, with an observation of its own; and, where several first
observations are possible (in PRISM and DRN, several starts), a state from which every action draws
a start, for nothing, so that the first observation is made there. It adds a step, which a discount
counts.

What readers of Cassandra's format disagree on is avoided: names, which some do not read, are
comments; numbers have digits on both sides of the point and no exponent; each line sets one number,
each number is set once, transitions first, then observations, then rewards; a reward depends on
state and action alone; `*` stands only where it must. Many solvers refuse a discount of 1.
PRISM and Storm know no discount in the file; there, observations stand first, because Storm looks
for them there (storm #701), rewards belong to actions, because Storm drops those of states
(storm #689), and costs are rewards with the other sign, for solvers that take no negative ones.
"""

from collections import defaultdict
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from babyrobot_levels.extensions.sight.model import PartialModel

_LARGEST = 1_000_000
"""The largest denominator of a probability that is written as a fraction."""

_ROUNDING = 1e-12
"""Probabilities that add up to 1 but for this add up to 1."""

_EPS = 4e-16
"""A number is a fraction but for this share of it, or of 1, which is rounding."""

Row = list[tuple[int, Fraction]]
"""Next states and their probabilities, which add up to 1."""


@dataclass(frozen=True, eq=False)
class _Table:
    """A POMDP with an end, and a state that draws a start if `draws`."""

    model: PartialModel
    draws: bool

    @property
    def end(self) -> int:
        """The state of what is over."""
        return self.model.size

    @property
    def size(self) -> int:
        """The number of states."""
        return self.end + 1 + self.draws

    @property
    def initial(self) -> Row:
        """The starts: a state that draws them, or all."""
        return [(self.end + 1, Fraction(1))] if self.draws else self._starts

    @property
    def _starts(self) -> Row:
        starts = np.flatnonzero(self.model.start)
        return _row(starts.tolist(), self.model.start[starts].tolist())

    @property
    def observations(self) -> list[int]:
        """The observation of each state."""
        kinds = int(self.model.observation[-1]) + 1
        return [*self.model.observation.tolist(), *range(kinds, kinds + self.size - self.end)]

    def outcomes(self, state: int, action: int) -> Row:
        """Return where an action leads."""
        model = self.model
        if state >= self.end:
            return [(self.end, Fraction(1))] if state == self.end else self._starts
        first, last = model.rows[state * model.num_actions + action :][:2]
        chances: dict[int, float] = defaultdict(float)
        for after, chance in zip(
            model.target[first:last], model.probability[first:last], strict=True
        ):
            chances[int(after)] += float(chance)
        if (ends := 1.0 - sum(chances.values())) > _ROUNDING:
            chances[self.end] = ends
        return _row([*chances], [*chances.values()])

    def reward(self, state: int, action: int) -> float:
        """Return the expected reward of an action, without what rounding adds to short numbers."""
        return (
            float(_fraction(float(self.model.reward[state, action]))) if state < self.end else 0.0
        )

    def rows(self) -> Iterator[tuple[int, int]]:
        """Yield all states and actions."""
        return ((s, a) for s in range(self.size) for a in range(self.model.num_actions))


def _row(states: list[int], chances: list[float]) -> Row:
    """Return probabilities as fractions; the likeliest outcome takes what rounding left."""
    fractions = [_fraction(chance) for chance in chances]
    fractions[int(np.argmax(chances))] += 1 - sum(fractions)
    return list(zip(states, fractions, strict=True))


def _fraction(number: float) -> Fraction:
    near = Fraction(number).limit_denominator(_LARGEST)
    is_near = abs(float(near) - number) <= _EPS * max(1.0, abs(number))
    return near if is_near else Fraction(number)


def _decimal(number: float) -> str:
    return np.format_float_positional(number, trim="0")


def _comments(model: PartialModel, sign: str) -> Iterator[str]:
    """Yield what the file is, as comments in ASCII."""
    names = [space.level.name or space.level.digest for space in model.spaces]
    for name in names[:10]:
        yield f"{sign} {name.encode('ascii', 'replace').decode()}"
    yield f"{sign} seen: {model.sight.name}; actions: {', '.join(_actions(model))}"


def _actions(model: PartialModel) -> list[str]:
    from babyrobot_levels.analysis.solver.results import action_names

    space = model.spaces[0]
    names = action_names(space.actions, space.mdp)[space.first_action :]
    # PRISM has no names with a hyphen.
    return [name.replace("-", "_") for name in names]


def write_pomdp(model: PartialModel) -> str:
    """Return a POMDP in Cassandra's format.

    Raises:
        ValueError: its levels have several discounts.
    """
    discounts = np.unique(model.discount)
    if discounts.size > 1:
        raise ValueError("the format has one discount; give one for all levels")
    table = _Table(model, draws=len(model.initial()) > 1)
    return "".join(f"{line}\n" for line in _cassandra(table, float(discounts[0])))


def _cassandra(table: _Table, discount: float) -> Iterator[str]:
    model, seen = table.model, table.observations
    yield from _comments(model, "#")
    yield f"# state {table.end}: the episode is over"
    if table.draws:
        yield f"# state {table.end + 1}: the start is drawn by the first step"
    yield f"discount: {_decimal(discount)}"
    yield "values: reward"
    yield f"states: {table.size}"
    yield f"actions: {model.num_actions}"
    yield f"observations: {max(seen) + 1}"
    chances = dict(table.initial)
    starts = (_decimal(float(chances.get(state, 0))) for state in range(table.size))
    yield f"start: {' '.join(starts)}"
    for state, action in table.rows():
        for after, chance in table.outcomes(state, action):
            yield f"T: {action} : {state} : {after} {_decimal(float(chance))}"
    for state, action in table.rows():
        yield f"O: {action} : {state} : {seen[state]} 1.0"
    for state, action in table.rows():
        if reward := table.reward(state, action):
            yield f"R: {action} : {state} : * : * {_decimal(reward)}"


def write_prism(model: PartialModel) -> str:
    """Return a POMDP as a module of PRISM."""
    table = _Table(model, draws=bool(np.count_nonzero(model.start) > 1))
    return "".join(f"{line}\n" for line in _prism(table))


def _prism(table: _Table) -> Iterator[str]:
    model, seen, names = table.model, table.observations, _actions(table.model)
    ((initial, _),) = table.initial
    yield from ("pomdp", "observables", "  o", "endobservables", *_comments(model, "//"))
    yield from ("module robot", f"  s : [0..{table.size - 1}] init {initial};")
    yield f"  o : [0..{max(seen)}] init {seen[initial]};"
    for state, action in table.rows():
        row = table.outcomes(state, action)
        updates = (f"{chance}:(s'={after})&(o'={seen[after]})" for after, chance in row)
        yield f"  [{names[action]}] s={state} -> {' + '.join(updates)};"
    yield "endmodule"
    paid = [(*row, reward) for row in table.rows() if (reward := table.reward(*row))]
    for name, sign in (("reward", 1), ("cost", -1)):
        yield f'rewards "{name}"'
        for state, action, reward in paid:
            yield f"  [{names[action]}] s={state} : {_decimal(sign * reward)};"
        if not paid:
            yield "  true : 0;"
        yield "endrewards"
    yield f'label "end" = s={table.end};'


def write_drn(model: PartialModel) -> str:
    """Return a POMDP in Storm's explicit format."""
    table = _Table(model, draws=bool(np.count_nonzero(model.start) > 1))
    return "".join(f"{line}\n" for line in _drn(table))


def _drn(table: _Table) -> Iterator[str]:
    model, seen, names = table.model, table.observations, _actions(table.model)
    ((initial, _),) = table.initial
    yield from _comments(model, "//")
    yield from ("@type: POMDP", "@parameters", "", "@reward_models", "reward cost")
    yield from ("@nr_states", f"{table.size}")
    yield from ("@nr_choices", f"{table.size * model.num_actions}", "@model")
    for state, action in table.rows():
        if not action:
            labels = " init" * (state == initial) + " end" * (state == table.end)
            yield f"state {state} {{{seen[state]}}} [0, 0]{labels}"
        reward = table.reward(state, action)
        yield f"\taction {names[action]} [{_decimal(reward)}, {_decimal(-reward or 0.0)}]"
        for after, chance in table.outcomes(state, action):
            yield f"\t\t{after} : {chance}"


Writer = Callable[[PartialModel], str]

WRITERS: dict[str, Writer] = {
    "pomdp": write_pomdp,
    "pomdp-prism": write_prism,
    "pomdp-drn": write_drn,
}
"""What writes each format, by its name for `babyrobot export`."""
