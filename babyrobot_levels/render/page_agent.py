"""An agent on the page of a level: its policy beside the optimum, and what the differences cost."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from babyrobot_levels.render.page_format import short
from babyrobot_levels.render.page_things import Marks
from babyrobot_levels.render.scene.layout import Overlay


@dataclass(frozen=True, slots=True)
class Difference:
    """A state in which an agent does not act optimally, as texts.

    Attributes:
        cell: the number of its cell.
        where: the cell, and what is held there.
        action: the actions of the agent.
        optimal: the optimal ones.
        cost: how much less the agent's action is worth than an optimal one.
        visits: how often an episode of the agent comes to the state, on average.
    """

    cell: int
    where: str
    action: str
    optimal: str
    cost: str
    visits: str


@dataclass(frozen=True, slots=True)
class PageAgent:
    """A policy that a page shows, beside the optimum if the page knows it.

    Attributes:
        policy: the probability of each `Action` in each state, `[states][actions]`; all 0 where
            the policy has none.
        overlay: its actions, and its values if the page knows the optimum.
        costs: what its actions cost in the cells in which it does not act optimally, and these
            actions; None where the page does not know the optimum.
        told: sentences about its return and regret.
        differences: the states in which it differs, those that cost most first.
        left_out: how many more there are.
    """

    policy: Sequence[Sequence[float]]
    overlay: Overlay
    costs: Overlay | None = None
    told: Sequence[str] = ()
    differences: Sequence[Difference] = ()
    left_out: int = 0


def agent_data(
    agent: PageAgent,
    marks: Marks,
    optimum: Sequence[Overlay],
    each: Callable[[Overlay], Sequence[Overlay]],
) -> dict[str, Any]:
    """Return what a page's script knows about an agent.

    `policy` has the number of the row of `choices` in each state, -1 for none.

    Args:
        agent: the agent.
        marks: the marks of the page.
        optimum: what is shown of the optimum in each configuration; nothing if it is unknown.
        each: returns what is shown of an overlay in each configuration.
    """
    rows: dict[tuple[float, ...], int] = {}
    numbers = [
        rows.setdefault(tuple(map(short, row)), len(rows)) if any(row) else -1
        for row in agent.policy
    ]
    overlays = each(agent.overlay)
    data: dict[str, Any] = {
        "choices": list(rows),
        "policy": numbers,
        "marks": {"policy": marks.actions(overlays), "values": marks.values(overlays)},
        "legend": marks.legend,
    }
    if agent.costs is not None:
        costs = each(agent.costs)
        own = marks.on_own_scale(costs)
        data["costs"] = {
            "marks": {"values": own.values(costs), "policy": own.actions(costs, optimum)},
            "legend": own.drawn_legend,
        }
    return data
