"""Levels as JAX environments: one compiled step plays any number of them. Needs the extra `jax`.

```python
import babyrobot_levels.jax as brl_jax

env, params = brl_jax.make("final-maze")
```
"""

from __future__ import annotations

try:
    import gymnax as _gymnax
    import jax as _jax
except ImportError as fault:
    from babyrobot_levels.text.errors import how_to_install

    raise ImportError(
        f"babyrobot_levels.jax needs JAX and gymnax 1.0 or later: {how_to_install('jax')}"
    ) from fault

from babyrobot_levels.jax.design import Designs as Designs
from babyrobot_levels.jax.design import Layout as Layout
from babyrobot_levels.jax.design import designs as designs
from babyrobot_levels.jax.env import EnvState as EnvState
from babyrobot_levels.jax.env import LevelEnvironment as LevelEnvironment
from babyrobot_levels.jax.env import UnderspecifiedEnv as UnderspecifiedEnv
from babyrobot_levels.jax.env import make as make
from babyrobot_levels.jax.estimators import learnability as learnability
from babyrobot_levels.jax.estimators import max_monte_carlo as max_monte_carlo
from babyrobot_levels.jax.estimators import (
    maximised_negative_advantage as maximised_negative_advantage,
)
from babyrobot_levels.jax.estimators import positive_value_loss as positive_value_loss
from babyrobot_levels.jax.params import EnvParams as EnvParams
from babyrobot_levels.jax.solver import Optimum as Optimum
from babyrobot_levels.jax.solver import Worth as Worth
from babyrobot_levels.jax.solver import evaluate as evaluate
from babyrobot_levels.jax.solver import optimum as optimum
from babyrobot_levels.jax.solver import positive_advantage as positive_advantage
from babyrobot_levels.jax.solver import random_policy as random_policy
from babyrobot_levels.jax.solver import regret as regret

__all__ = [
    "Designs",
    "EnvParams",
    "EnvState",
    "Layout",
    "LevelEnvironment",
    "Optimum",
    "UnderspecifiedEnv",
    "Worth",
    "designs",
    "evaluate",
    "learnability",
    "make",
    "max_monte_carlo",
    "maximised_negative_advantage",
    "optimum",
    "positive_advantage",
    "positive_value_loss",
    "random_policy",
    "regret",
]

del _gymnax, _jax
