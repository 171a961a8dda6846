"""What can be reached by one who does not see everything: the optimum of partial observation."""

from babyrobot_levels.analysis.solver.results import TooLargeError
from babyrobot_levels.extensions.sight.model import PartialModel
from babyrobot_levels.extensions.sight.policy import SightPolicy
from babyrobot_levels.extensions.sight.sights import NAMES
from babyrobot_levels.extensions.sight.solve import SightSolution, sight_cost, solve_sight
from babyrobot_levels.extensions.sight.writers import write_drn, write_pomdp, write_prism

__all__ = [
    "NAMES",
    "PartialModel",
    "SightPolicy",
    "SightSolution",
    "TooLargeError",
    "sight_cost",
    "solve_sight",
    "write_drn",
    "write_pomdp",
    "write_prism",
]
