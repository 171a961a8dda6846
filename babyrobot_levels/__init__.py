"""babyrobot-levels: grid worlds as files.

A level is a YAML file: it is read, checked, compiled into exact tables and played as a Gymnasium
environment. Importing this package makes the environments known to Gymnasium (at once if
Gymnasium is loaded, else as soon as it is) and costs next to nothing: every public name, listed in
`__init__.pyi`, is imported when it is first used.
"""

from __future__ import annotations

import lazy_loader

from babyrobot_levels import mdp
from babyrobot_levels.envs import registration

__version__ = "0.1.0"

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

mdp.load = lambda level: __getattr__("load")(level)
registration.install()
