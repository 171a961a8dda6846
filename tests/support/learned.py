"""What Python learns, for the tests of the page's algorithms: options, and the numbers of runs."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

import numpy as np

import babyrobot_levels as brl
from babyrobot_levels.analysis.solver.results import UndefinedReturnError
from babyrobot_levels.extensions.learning.algorithms import MAX_SWEEPS
from babyrobot_levels.library.level import Level
from babyrobot_levels.render.page import page_data

RECORDED = ("gridworld-4-1", "cliff-walking", "frozen-lake", "first-key")
"""The levels whose runs are recorded."""

LEARNED = """([data, runs]) => runs.map(({options, number}) => {
    const learner = new Learner(data, options);
    while (learner.number < number && learner.finish() !== null);
    const values = learner.problem.states.map((state) => learner.values[state]);
    return [learner.number, values, learner.returns];
})"""
"""What a page runs to return the numbers, values and returns of runs."""


def runs_of(level: Level, *, all_starts: bool) -> Iterator[dict[str, Any]]:
    """Yield runs of all algorithms on a level: the page's options, and the numbers of Python.

    Args:
        level: the level.
        all_starts: whether exploring starts are possible, as they are without things.
    """
    episodes: dict[str, Any] = {"episodes": 3, "every": 1, "seed": 5}
    yield _run(level, "value_iteration", max_sweeps=3)
    yield _run(level, "value_iteration", max_sweeps=4, discount=0.9, actions="all")
    yield _run(level, "policy_evaluation", max_sweeps=10, policy="uniform")
    try:
        yield _run(level, "policy_iteration", max_sweeps=MAX_SWEEPS, discount=0.9)
        yield _run(level, "policy_iteration", max_sweeps=3)
    except UndefinedReturnError:
        pass
    yield _run(level, "monte_carlo", policy="random", **episodes)
    yield _run(level, "q_learning", **episodes)
    yield _run(level, "q_learning", **episodes, planning_steps=4, initial=1.5, discount=0.9)
    if all_starts:
        yield _run(level, "q_learning", **episodes, exploring_starts=True)
    yield _run(level, "sarsa", **episodes, epsilon=0.3)
    yield _run(level, "sarsa", **episodes, n_steps=4, step_size=0.5)
    yield _run(level, "value_iteration", max_sweeps=4, discount=0.9, actions="turns")
    yield _run(level, "monte_carlo", policy="random", **episodes, actions="turns")
    yield _run(level, "q_learning", **episodes, planning_steps=2, actions="turns")
    yield _run(level, "sarsa", **episodes, actions="turns")


def _run(
    level: Level,
    algorithm: str,
    *,
    discount: float | None = None,
    actions: str = "moves",
    **given: Any,
) -> dict[str, Any]:
    *_, last = getattr(brl, algorithm)(level, discount=discount, actions=actions, **given)
    options = {
        "algorithm": algorithm,
        "discount": level.discount if discount is None else discount,
        "actions": actions,
        **{
            name: str(value) if name == "seed" else value
            for name, value in given.items()
            if name not in ("episodes", "every", "max_sweeps")
        },
    }
    mdp = level.compile()
    goes_on = ~(mdp.turning(level.heading) if actions == "turns" else mdp).is_terminal
    values = last.values.ravel()[goes_on]
    return {
        "options": options,
        "number": last.number,
        "values": [float(value) if np.isfinite(value) else str(value) for value in values],
        "returns": last.returns.tolist() if isinstance(last, brl.Trials) else None,
    }


def recorded() -> str:
    """Return the runs of some levels as JSON, a level a line."""
    lines = []
    for name in RECORDED:
        level = brl.load(name)
        data = page_data(level, turns=True)
        kept = ["starts", "max_steps", "discount", "rows", "table", "possible", "policy"]
        kept += ["width", "height", "turns"]
        runs = list(runs_of(level, all_starts=not level.has_things))
        for run in runs:
            # The last digits differ between platforms.
            for key in ("values", "returns"):
                run[key] = run[key] and [float(f"{value:.12g}") for value in run[key]]
        entry = {"name": name, "data": {key: data[key] for key in kept}, "runs": runs}
        lines.append(json.dumps(entry, separators=(",", ":")))
    return "[\n" + ",\n".join(lines) + "\n]\n"
