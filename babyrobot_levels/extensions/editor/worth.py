"""What a policy that is drawn by hand is worth."""

import math
from typing import Any

import numpy as np

from babyrobot_levels.analysis.solver.evaluation import evaluation_of
from babyrobot_levels.analysis.solver.horizon import worth_within
from babyrobot_levels.analysis.solver.policies import read_policy, space_of
from babyrobot_levels.extensions.editor.answers import Optimum, endless, finite
from babyrobot_levels.extensions.editor.changes.draft import RefusedError
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.actions import NUM_ACTIONS
from babyrobot_levels.mdp.tables import Floats
from babyrobot_levels.render.page_format import rounded
from babyrobot_levels.render.words.phrases import with_limit

NOT_DRAWN = -1


def worth_of(optimum: Optimum, actions: Any) -> dict[str, Any]:
    """Return what a policy drawn by hand is worth, exactly, within the level's time limit.

    In states for which none was drawn, it takes one of the actions that are possible, at random.

    Args:
        optimum: the solution of the level.
        actions: an `Action` for each state; -1 where none was drawn.

    Returns:
        `worth`, the expected return from the starts, and `best`, that of the optimal policy, both
        as texts (empty where undefined); `share`, how far the policy is on the way from random
        actions (0) to the best (1), None where unknown; `exits`, the probability of reaching an
        exit; and `reason`, why the return is infinite or undefined.

    Raises:
        RefusedError: there is not one action for each state.
    """
    level = optimum.level
    is_list = isinstance(actions, list) and len(actions) == level.compile().num_states
    if not is_list or not all(type(each) is int and -1 <= each < NUM_ACTIONS for each in actions):
        raise RefusedError("the policy does not fit the level")
    drawn = np.array(actions)
    weights = read_policy("random", space_of(level, "all"))
    (states,) = np.nonzero(drawn != NOT_DRAWN)
    weights[states] = np.eye(NUM_ACTIONS)[drawn[states]]
    guide = optimum.guide
    best = guide.expected_return if guide is not None else math.nan
    limit = level.max_steps
    told: dict[str, Any] = {"worth": "", "best": ""}
    if not math.isnan(best):
        told["best"] = with_limit(rounded(best), limit, limit)
    told |= {"share": None, "exits": None}
    try:
        worth, exits, reason = _evaluated(level, weights)
    except ArithmeticError as error:
        return {**told, "reason": str(error)}
    told |= {
        "worth": with_limit(rounded(worth), limit, limit),
        "exits": finite(exits),
        "reason": reason,
    }
    random = optimum.random_return
    if random is not None and math.isfinite(worth) and random < best < math.inf:
        told["share"] = finite((worth - random) / (best - random))
    return told


def _evaluated(level: Level, weights: Floats) -> tuple[float, float, str]:
    """Return a policy's expected return, its probability of reaching an exit, and a reason.

    Raises:
        ArithmeticError: the return is undefined.
    """
    if level.max_steps is None:
        found = evaluation_of(level, weights)
        return found.expected_return, found.exit_probability, endless(found)
    space = space_of(level, "all")
    worth = worth_within([space], [level.max_steps], [level.discount], [weights], quick=True)
    return float(worth.returns[0]), float(worth.success[0]), ""
