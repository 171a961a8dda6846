"""The agent that earns a lower bound: it remembers its belief, and acts by it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.extensions.sight.bounds import Bounds
from babyrobot_levels.extensions.sight.tracking import Tracker
from babyrobot_levels.mdp.tables import Ints

if TYPE_CHECKING:
    from babyrobot_levels.extensions.sight.beliefs import BeliefGraph


class SightPolicy(Tracker):
    """An agent with memory, as `brl.score` takes it: `reset()` begins an episode, `act` goes on.

    In beliefs that were explored it does what is best by the lower bounds; where it comes to
    another one, it goes on as the memoryless agent of that bound, which may draw its actions.

    Args:
        graph: the beliefs.
        bounds: the memoryless agents.
        actions: an action for each belief, and an agent for each leaf, `[times, beliefs]`.
        within: the number of steps after which an episode is truncated; None for no limit.
        seed: what draws are made from.
    """

    __module__ = "babyrobot_levels.extensions.sight"

    def __init__(
        self, graph: BeliefGraph, bounds: Bounds, actions: Ints, within: int | None, seed: int
    ) -> None:
        self._graph, self._bounds, self._actions = graph, bounds, actions
        self._within, self._random = within, np.random.default_rng(seed)
        super().__init__(graph.model)

    def reset(self) -> None:
        """Forget the episode before."""
        super().reset()
        self._node: int | None = None
        self._agent: int | None = None
        self._action = -1

    def act(self, observation: Any, mask: Any = None, reward: float | None = None) -> int:
        """Return the action for the next observation of an episode.

        Args:
            observation: as the environment gives it, with the sight for which this was solved.
            mask: the action mask.
            reward: that of the last step, if the sight has rewards; None at reset.

        Raises:
            ValueError: no episode of these levels shows this after what was shown before.
        """
        key = self.model.sight.key(observation, mask, reward)
        self._node = self._next_node(self.observe(key, self._action))
        self._action = self._chosen()
        return self._action

    @property
    def belief(self) -> list[tuple[int, int, float]]:
        """What the agent believes: level, state in its tables, and probability of each."""
        model, states = self.model, self.states
        level, state = model.level[states], model.state[states]
        return list(zip(level.tolist(), state.tolist(), self.chances.tolist(), strict=True))

    def _next_node(self, observed: int) -> int | None:
        """Return the number of the present belief, None if it is none of the graph."""
        graph, after = self._graph, self._graph.roots
        if self.steps > 1:
            if self._node is None or graph.outcomes[self._node] is None:
                return None
            after = graph.after(self._node, self._action)[0].tolist()
        shown = (self.model.observation[graph.states[belief][0]] for belief in after)
        return next((b for b, by in zip(after, shown, strict=True) if by == observed), None)

    def _chosen(self) -> int:
        left = max(0, (self._within or 1) - self.steps)
        if self._agent is None:
            assert self._node is not None
            chosen = int(self._actions[left, self._node])
            if self._graph.outcomes[self._node] is not None:
                return chosen
            self._agent = chosen
        # All states of a belief look the same to an agent without memory.
        chances: NDArray[np.float64] = self._bounds.agents[self._agent, self.states[0]]
        return int(self._random.choice(chances.size, p=chances))
