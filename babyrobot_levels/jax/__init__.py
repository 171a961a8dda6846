"""Levels as JAX environments: one compiled step plays any number of them. Needs the extra `jax`.

```python
import babyrobot_levels.jax as brl_jax

env, params = brl_jax.make("final-maze")
```
"""

import lazy_loader

try:
    import gymnax as _gymnax
    import jax as _jax
except ImportError as fault:
    from babyrobot_levels.text.errors import how_to_install

    raise ImportError(
        f"babyrobot_levels.jax needs JAX and gymnax 1.0 or later: {how_to_install('jax')}"
    ) from fault

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

del _gymnax, _jax
