"""What pages tell of an agent is what scores tell."""

from __future__ import annotations

import numpy as np
import pytest

import babyrobot_levels as brl
from babyrobot_levels.analysis.agent_guides import page_agent
from babyrobot_levels.analysis.guides import guide_of
from babyrobot_levels.render.page_format import rounded


@pytest.mark.slow
@pytest.mark.parametrize(
    "name",
    ["frozen-lake", "first-key", "cliff-walking", "puddles", "treasure-chests", "gridworld-3-5"],
)
def test_the_regret_is_that_of_scores(name: str) -> None:
    level, solution = brl.load(name), brl.solve(name)
    policy = np.random.default_rng(1).dirichlet(np.ones(5), level.compile().num_states)
    (score,) = brl.score([name], policy)
    limit = f"within {score.within:,} steps" if score.within else "without a limit"
    assert (
        page_agent(level, policy, solution, guide_of(level, solution).expected_return)
        .told[0]
        .startswith(
            f"Return {rounded(score.expected_return)}, optimum {rounded(score.optimum)}: "
            f"regret {rounded(score.regret)} {limit}"
        )
    )
