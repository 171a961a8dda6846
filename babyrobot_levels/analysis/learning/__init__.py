"""Learning a level step by step: textbook algorithms that can be watched while they converge."""

from babyrobot_levels.analysis.learning.episodes import monte_carlo, q_learning, sarsa
from babyrobot_levels.analysis.learning.results import Sweep, Trials
from babyrobot_levels.analysis.learning.sweeps import (
    policy_evaluation,
    policy_iteration,
    value_iteration,
)

__all__ = [
    "Sweep",
    "Trials",
    "monte_carlo",
    "policy_evaluation",
    "policy_iteration",
    "q_learning",
    "sarsa",
    "value_iteration",
]
