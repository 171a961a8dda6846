"""Search among beliefs: two bounds of the optimum, which close.

The explored beliefs are a decision process of their own, whose leaves pay a bound of what is to
come: solved exactly with the upper bounds it bounds the optimum from above, and with the lower ones
from below, by what a policy earns. Loops that cost nothing do no harm, as the process is solved and
not iterated. What is explored next is chosen as in heuristic search (HSVI: Smith and Simmons 2005;
SARSOP: Kurniawati, Hsu and Lee 2008; without a discount: Horak, Bosansky and Chatterjee 2018): the
leaves with the widest gaps, weighted by how likely the policy that the upper bounds make best comes
there. In turn with that, leaves are explored in the order in which they were found, which ends
where few beliefs can be reached; and those to which an agent comes that believes in the most likely
state, whose episodes end, which lifts lower bounds. Everything depends on numbers of beliefs alone:
the same level has the same bounds everywhere, unless a limit of time was asked for.
"""

import heapq
import time
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice

import numpy as np

from babyrobot_levels.analysis.solver.optimum import undiscounted
from babyrobot_levels.extensions.sight.beliefs import BeliefGraph, Steps
from babyrobot_levels.extensions.sight.bounds import bounds_of
from babyrobot_levels.extensions.sight.model import PartialModel, as_model, ranges
from babyrobot_levels.mdp.tables import Floats, Ints

FIRST_ROUND = 64
"""How many beliefs the first round explores; each further one explores as many as there are."""

_BATCH = 64
"""The most beliefs that are explored at a time, of each kind."""

_MOST_NUMBERS = 5_000_000
"""The most probabilities in all beliefs."""

_MOST_PLACES = 50_000_000
"""The most outcomes of explored beliefs, and the most actions of beliefs with steps left."""

_AT_A_TIME = 300_000
"""About so many probabilities are in beliefs that are explored at a time."""

_VISITS = 1000
"""For so many steps the best policy is followed to see which leaves matter."""

_FAR = 1e100
"""The difference between a bound and none."""

_NEGLIGIBLE = 1e-9
"""What is less likely than this is not followed."""


@dataclass(frozen=True, eq=False)
class Evaluated:
    """What the explored beliefs say.

    Attributes:
        lower: the lower bound of the optimum.
        upper: the upper bound.
        actions: what attains the lower bound: an action for each belief, `[times, beliefs]`, and
            an agent of `Bounds` for each leaf.
        visits: how often the best policy by the upper bounds comes to each belief, `[beliefs]`.
        gaps: by how much the bounds differ in each belief, `[beliefs]`; 0 where it is explored.
    """

    lower: float
    upper: float
    actions: Ints
    visits: Floats
    gaps: Floats


class Search:
    """A search for the optimum of a POMDP.

    Args:
        model: the POMDP.
        within: the number of steps after which an episode is truncated; None for no limit.

    Attributes:
        graph: the beliefs.
        bounds: what is known of each without looking ahead.
        found: what the explored beliefs say.
    """

    def __init__(self, model: PartialModel, within: int | None) -> None:
        self.model, self.within = model, within
        self.graph, self.bounds = BeliefGraph(model), bounds_of(model, within)
        self.found = self._evaluated()
        self._oldest = 0
        self._walked: set[int] = set()
        self._walk = sorted(zip((-self.graph.root_chances).tolist(), self.graph.roots, strict=True))

    @property
    def is_full(self) -> bool:
        """Whether there is no room for more beliefs."""
        graph = self.graph
        choices = graph.explored * self.model.num_actions * (graph.widest + 1)
        return (
            len(graph) * (self.within or 1) >= _MOST_PLACES
            or graph.numbers >= _MOST_NUMBERS
            or choices >= _MOST_PLACES
        )

    @property
    def is_closed(self) -> bool:
        """Whether all beliefs that can be reached are explored."""
        return self.graph.explored == len(self.graph)

    def advance(self, beliefs: int, deadline: float | None = None) -> None:
        """Explore at most some further beliefs, and evaluate all.

        Args:
            beliefs: how many.
            deadline: the value of `time.monotonic()` at which to stop; None for no limit.
        """
        last = beliefs // 2
        while beliefs > last and self._goes_on(deadline) and (walked := self._walk_on(self._room)):
            self.graph.explore(walked)
            beliefs -= len(walked)
        queue = self._queue()
        while beliefs > 0 and self._goes_on(deadline):
            room = min(self._room, -(-beliefs // 2))
            urgent = dict(islice(self._urgent(queue), room))
            batch = [*dict.fromkeys([*urgent, *islice(self._unexplored(), room)])]
            if not batch:
                break
            self.graph.explore(batch)
            self._push(queue, urgent)
            beliefs -= len(batch)
        self.found = self._evaluated()

    def _goes_on(self, deadline: float | None) -> bool:
        return not self.is_full and (deadline is None or time.monotonic() < deadline)

    @property
    def _room(self) -> int:
        """How many beliefs are explored at a time, of each kind: fewer of large ones."""
        return max(1, min(_BATCH, _AT_A_TIME * len(self.graph) // self.graph.numbers))

    # -- what to explore -------------------------------------------------------------------

    def _queue(self) -> list[tuple[float, int, float]]:
        """Return the leaves that matter as a heap: minus urgency, belief, how likely it is."""
        urgency, visits = self.found.visits * self.found.gaps, self.found.visits
        leaves = np.flatnonzero(urgency > 0).tolist()
        queue = [(-float(urgency[leaf]), leaf, float(visits[leaf])) for leaf in leaves]
        heapq.heapify(queue)
        return queue

    def _urgent(self, queue: list[tuple[float, int, float]]) -> Iterator[tuple[int, float]]:
        """Yield the leaves that matter most, and how likely each is."""
        while queue:
            _, belief, visits = heapq.heappop(queue)
            if self.graph.outcomes[belief] is None:
                yield belief, visits

    def _push(self, queue: list[tuple[float, int, float]], explored: dict[int, float]) -> None:
        """Add what comes after the best actions of beliefs that were just explored."""
        chosen = [*explored]
        rewards = self.graph.expected(chosen, self.model.reward)
        after = {belief: self.graph.outcomes[belief] for belief in chosen}
        following = np.array(sorted({at for part in after.values() if part for at in part[1]}), int)
        upper, gaps = self._leaf_bounds(following.tolist())
        for belief, reward in zip(chosen, rewards, strict=True):
            outcomes = after[belief]
            assert outcomes is not None
            actions, targets, weights = outcomes
            places = np.searchsorted(following, targets)
            ahead = reward + np.bincount(actions, weights * upper[places], reward.size)
            for index in np.flatnonzero(ahead[actions] == ahead.max()).tolist():
                visits, target = explored[belief] * float(weights[index]), int(targets[index])
                urgency = visits * float(gaps[places[index]])
                if urgency > 0 and visits > _NEGLIGIBLE and self.graph.outcomes[target] is None:
                    heapq.heappush(queue, (-urgency, target, visits))

    def _leaf_bounds(self, beliefs: list[int]) -> tuple[Floats, Floats]:
        """Return upper bounds of beliefs with all steps left, and how far lower ones are below."""
        upper = self.graph.expected(beliefs, self.bounds.upper[-1]).max(axis=1)
        lower = self.graph.expected(beliefs, self.bounds.lower[-1]).max(axis=1)
        return upper, _differences(upper, lower)

    def _walk_on(self, room: int) -> list[int]:
        """Return unexplored beliefs of an agent that believes in the most likely state."""
        graph = self.graph
        found: list[tuple[float, int]] = []
        while self._walk and len(found) < room:
            chance, belief = heapq.heappop(self._walk)
            if graph.outcomes[belief] is None:
                found.append((chance, belief))
            elif belief not in self._walked:
                self._walked.add(belief)
                likeliest = graph.states[belief][graph.chances[belief].argmax()]
                after, weights = graph.after(belief, int(self.bounds.guess[likeliest]))
                for target, weight in zip(after.tolist(), weights.tolist(), strict=True):
                    if -chance * weight > _NEGLIGIBLE:
                        heapq.heappush(self._walk, (chance * weight, target))
        for each in found:
            heapq.heappush(self._walk, each)
        return [belief for _, belief in found]

    def _unexplored(self) -> Iterator[int]:
        """Yield the beliefs that are not explored, in the order in which they were found."""
        outcomes = self.graph.outcomes
        while self._oldest < len(outcomes) and outcomes[self._oldest] is not None:
            self._oldest += 1
        return (at for at in range(self._oldest, len(outcomes)) if outcomes[at] is None)

    # -- what is known ---------------------------------------------------------------------

    def _evaluated(self) -> Evaluated:
        steps = self.graph.steps()
        return self._unlimited(steps) if self.within is None else self._limited(steps, self.within)

    def _leaves(self, leaves: list[int], time: int) -> tuple[Floats, Floats, Ints]:
        """Return upper and lower bounds of leaves, and the agent that earns the lower one."""
        upper = self.graph.expected(leaves, self.bounds.upper[time]).max(axis=1)
        lower = self.graph.expected(leaves, self.bounds.lower[time])
        return upper, lower.max(axis=1), lower.argmax(axis=1)

    def _unlimited(self, steps: Steps) -> Evaluated:
        leaves = np.flatnonzero(steps.is_leaf)
        upper, lower, agents = self._leaves(leaves.tolist(), 0)
        gaps = np.zeros(len(self.graph))
        gaps[leaves] = _differences(upper, lower)
        above, best = self._optimum(steps, leaves, upper)
        below, actions = self._optimum(steps, leaves, lower)
        actions[leaves] = agents
        visits = self._visits(steps, best[None], _VISITS)
        return Evaluated(below, above, actions[None], visits, gaps)

    def _optimum(self, steps: Steps, leaves: Ints, payoffs: Floats) -> tuple[float, Ints]:
        """Return the optimum of the explored beliefs, whose leaves pay something and end.

        Returns:
            The optimum at the start, and an action for each belief.
        """
        graph, count, size = self.graph, self.model.num_actions, len(self.graph)
        paid = np.zeros(size)
        paid[leaves] = np.where(np.isinf(payoffs), 0.0, payoffs)
        is_inner = ~steps.is_leaf
        is_inner[leaves] = np.isinf(payoffs)
        inner = np.flatnonzero(is_inner)
        # What leaves pay is a part of the reward of the step to them, so that they need no states.
        row = np.repeat(np.arange(size * count), np.diff(steps.rows))
        more = np.bincount(row, steps.weight * paid[steps.target], size * count)
        kept = is_inner[steps.target]
        counts = np.bincount(row[kept], minlength=size * count).reshape(size, count)[inner]
        number = np.cumsum(is_inner) - 1
        first = [graph.states[belief][0] for belief in inner.tolist()]
        process = as_model(
            np.append(0, np.cumsum(counts)),
            number[steps.target[kept]],
            steps.weight[kept],
            (steps.reward + more.reshape(size, count))[inner],
            np.minimum(self.model.state[first], self.model.spaces[0].mdp.num_states - 1),
        )
        # What is infinitely good or bad is a loop without end.
        endless = leaves[np.isinf(payoffs)]
        places = number[endless]
        process.probability[places] = 0.0
        process.probability[places, :, 0] = 1.0
        process.next_state[places, :, 0] = places[:, None]
        process.reward[places] = np.sign(payoffs[np.isinf(payoffs)])[:, None]
        optimum = undiscounted(process, self.model.spaces[0])
        values, actions = paid, np.zeros(size, np.intp)
        values[inner], actions[inner] = optimum.found.values, optimum.ending.policy
        return self._at_start(values), actions

    def _at_start(self, values: Floats) -> float:
        chances, ahead = self.graph.root_chances, values[self.graph.roots]
        return float(np.inf) if np.isposinf(ahead).any() else float(chances @ ahead)

    def _limited(self, steps: Steps, within: int) -> Evaluated:
        from scipy.sparse import csr_array  # type: ignore[import-untyped]

        size, count = len(self.graph), self.model.num_actions
        moves = csr_array((steps.weight, steps.target, steps.rows), shape=(size * count, size))
        leaves = np.flatnonzero(steps.is_leaf)
        values, gaps = np.zeros((size, 2)), np.zeros(size)
        best = np.zeros((within, size, 2), np.int8)
        for left in range(1, within + 1):
            ahead = steps.reward[..., None] + (moves @ values).reshape(size, count, 2)
            best[left - 1], values = ahead.argmax(axis=1), ahead.max(axis=1)
            if leaves.size:
                upper, lower, best[left - 1, leaves, 1] = self._leaves(leaves.tolist(), left)
                values[leaves] = np.stack([upper, lower], axis=1)
                gaps[leaves] = np.maximum(gaps[leaves], upper - lower)
        above, below = self._at_start(values[:, 0]), self._at_start(values[:, 1])
        visits = self._visits(steps, best[::-1, :, 0], within)
        return Evaluated(below, above, best[..., 1], visits, gaps)

    def _visits(self, steps: Steps, actions: Ints, most: int) -> Floats:
        """Return how often a policy comes to each belief.

        Args:
            steps: what is explored.
            actions: its actions, `[steps, beliefs]`, of which the last ones go on.
            most: for so many steps it is followed.
        """
        count, size = self.model.num_actions, len(self.graph)
        now: Floats = np.zeros(size)
        total = np.zeros(size)
        np.add.at(now, self.graph.roots, self.graph.root_chances)
        for step in range(most):
            total += now
            here = np.flatnonzero(now > _NEGLIGIBLE)
            rows = here * count + actions[min(step, len(actions) - 1), here]
            lengths = steps.rows[rows + 1] - steps.rows[rows]
            from_here = ranges(steps.rows[rows], lengths)
            weights = np.repeat(now[here], lengths) * steps.weight[from_here]
            now = np.zeros(size)
            np.add.at(now, steps.target[from_here], weights)
            if now.sum() < _NEGLIGIBLE:
                break
        return total


def _differences(upper: Floats, lower: Floats) -> Floats:
    """Return how far bounds are apart, finite also where they are not."""
    none = np.zeros_like(upper)
    return np.minimum(np.subtract(upper, lower, out=none, where=upper > lower), _FAR)
