"""The public names, and where they are defined: the package imports each when it is first used."""

from .design import Designs as Designs
from .design import Layout as Layout
from .design import designs as designs
from .env import EnvState as EnvState
from .env import LevelEnvironment as LevelEnvironment
from .env import UnderspecifiedEnv as UnderspecifiedEnv
from .env import make as make
from .estimators import learnability as learnability
from .estimators import max_monte_carlo as max_monte_carlo
from .estimators import maximised_negative_advantage as maximised_negative_advantage
from .estimators import positive_value_loss as positive_value_loss
from .params import EnvParams as EnvParams
from .solver import Optimum as Optimum
from .solver import Worth as Worth
from .solver import evaluate as evaluate
from .solver import optimum as optimum
from .solver import positive_advantage as positive_advantage
from .solver import random_policy as random_policy
from .solver import regret as regret
from .team import TeamEnvironment as TeamEnvironment
from .team import TeamParams as TeamParams
from .team import make_team as make_team
