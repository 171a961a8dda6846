"""Learning a level step by step: textbook algorithms that can be watched while they converge."""

from babyrobot_levels.analysis.learning.algorithms import (
    monte_carlo,
    policy_evaluation,
    policy_iteration,
    q_learning,
    sarsa,
    value_iteration,
)
from babyrobot_levels.analysis.learning.results import Sweep, Trials

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
