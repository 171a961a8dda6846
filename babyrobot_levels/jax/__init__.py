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

from babyrobot_levels.jax.design import Designs, Layout, designs
from babyrobot_levels.jax.env import EnvState, LevelEnvironment, UnderspecifiedEnv, make
from babyrobot_levels.jax.estimators import (
    learnability,
    max_monte_carlo,
    maximised_negative_advantage,
    positive_value_loss,
)
from babyrobot_levels.jax.params import EnvParams
from babyrobot_levels.jax.solver import (
    Optimum,
    Worth,
    evaluate,
    optimum,
    positive_advantage,
    random_policy,
    regret,
)

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
