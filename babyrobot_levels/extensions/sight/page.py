"""A level's page that is played through a sight: what is seen, what may be, how the best acts."""

import math
from collections.abc import Sequence
from itertools import chain
from typing import Any

import numpy as np

from babyrobot_levels.analysis.solver.policies import space_of
from babyrobot_levels.envs.observations.base import Extent, Observation
from babyrobot_levels.envs.observations.views import ViewObserver
from babyrobot_levels.extensions.sight.model import PartialModel
from babyrobot_levels.extensions.sight.sights import ObservationSight, sight_of
from babyrobot_levels.extensions.sight.solve import SightSolution, solve_sight
from babyrobot_levels.library.catalogue import load
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.gridworld import GridWorld
from babyrobot_levels.render.page_format import TooLargeError, rounded, short
from babyrobot_levels.render.page_sight import PageSight
from babyrobot_levels.render.words.phrases import with_limit

MOST_BELIEFS = 5_000
"""So many beliefs are explored for the best agent of a page."""

MOST_STATES = 20_000
"""The most states of a level on a page with a sight."""

_ALL_CELLS = frozenset({"planes", "image"})
"""The observations that show the whole level."""


def page_sight(
    level: GridWorld, sight: str | Sequence[str] = "view", *, has_agent: bool = True, **options: Any
) -> PageSight:
    """Return what a page needs to show a level through a sight.

    Args:
        level: the level; a maze needs a seed.
        sight: an observation of environments, or several.
        has_agent: whether the page knows the best agent, and what it can expect.
        options: those of the observation, such as `view_radius`.

    Raises:
        LevelError: the level has several robots.
        ValueError: it is no observation of environments.
        TooLargeError: the level has too many states.
        UndefinedReturnError: it has no optimum.
        EpisodeTooLongError: its episodes are too long.
    """
    own = load(level.to_dict(whole=True))
    chosen = sight_of(sight, Extent.of([own], turns=False), **options)
    if not isinstance(chosen, ObservationSight):
        raise ValueError(
            f"a page is seen through what environments show, such as 'view', not {chosen.name!r}"
        )
    states = space_of(own, "all").mdp.num_states
    if states > MOST_STATES:
        raise TooLargeError(
            f"a level of {states:,} states is too large for a page with a sight; "
            f"the limit is {MOST_STATES:,} states"
        )
    found = solve_sight(own, sight, beliefs=MOST_BELIEFS if has_agent else 0, **options)
    data = {"shown": _shown(found.model, states), **_fields(own, chosen.observation, found.model)}
    if not has_agent or not math.isfinite(found.lower):
        return PageSight("", data)
    best = " to ".join(dict.fromkeys(map(rounded, (found.lower, found.upper))))
    return PageSight(with_limit(best, None, level.max_steps), data | _controller(found))


def _shown(model: PartialModel, states: int) -> list[int]:
    """Return the number of what is shown in each state; -1 where no episode goes on."""
    numbers = np.full(states, -1)
    numbers[model.state] = model.observation
    shown: list[int] = numbers.tolist()
    return shown


def _fields(level: Level, observation: Observation, model: PartialModel) -> dict[str, Any]:
    """Return which cells are seen in each state, as steps right and down from the robot's cell.

    `fields` has each set of cells once, `field` the number of its set for each state. Without
    them, all cells are seen.
    """
    names = {observation.name} if isinstance(observation.name, str) else {*observation.name}
    if names & _ALL_CELLS:
        return {}
    numbers: dict[bytes, int] = {}
    field = [0] * level.compile().num_states
    fields: list[list[int]] = []
    observer = ViewObserver(level, Extent.of([level]), observation)
    radius = observation.view_radius
    for state in model.state.tolist():
        seen = np.zeros((2 * radius + 1, 2 * radius + 1), bool)
        seen[radius, radius] = True
        if "view" in names:
            seen |= observer.view(state)[..., 0] > 0
        field[state] = numbers.setdefault(seen.tobytes(), len(numbers))
        if field[state] == len(fields):
            fields.append((np.argwhere(seen)[:, ::-1] - radius).ravel().tolist())
    return {"field": field, "fields": fields}


def _controller(found: SightSolution) -> dict[str, Any]:
    """Return the agent that earns the lower bound as a graph of its beliefs.

    `roots` and each entry of a node are pairs of what is shown and the node that follows. A node
    has the number of its action and its entries, a list for each action; one that was not explored
    has -1 less the number of an agent of `agents`, without memory, and no entries. Such an agent
    has the chances of all actions for what is shown.
    """
    search, model = found._search, found.model
    graph, actions = search.graph, search.found.actions[-1]

    def pairs(beliefs: Sequence[int]) -> list[int]:
        shown = (int(model.observation[graph.states[belief][0]]) for belief in beliefs)
        return [*chain.from_iterable(zip(shown, beliefs, strict=True))]

    nodes: list[list[Any]] = []
    used: dict[int, int] = {}
    for belief, outcomes in enumerate(graph.outcomes):
        chosen = int(actions[belief])
        if outcomes is None:
            nodes.append([-1 - used.setdefault(chosen, len(used))])
            continue
        after = (graph.after(belief, action)[0].tolist() for action in range(model.num_actions))
        nodes.append([chosen, *map(pairs, after)])
    first = np.unique(model.observation, return_index=True)[1]
    agents = [
        [[short(chance) for chance in row] for row in search.bounds.agents[agent][first].tolist()]
        for agent in used
    ]
    return {"roots": pairs(graph.roots), "nodes": nodes, "agents": agents}
