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

_public, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

_OTHER_NAMES = {
    "load": ("level", "read", "open", "parse"),
    "load_suite": ("suite", "read_suite"),
    "make": ("BabyRobotEnv", "BabyRobot", "env", "Env", "environment"),
    "solve": ("train", "learn", "optimal_policy"),
    "preview": ("render", "draw", "plot"),
    "score": ("benchmark",),
    "validate": ("check",),
    "levels": ("list", "list_levels", "names"),
}
"""Public names, and what others expect them to be called."""


def __getattr__(name: str) -> object:
    """Import a public name when it is first used."""
    ours = next((each for each, others in _OTHER_NAMES.items() if name in others), None)
    if ours is not None:
        message = f"module {__name__!r} has no attribute {name!r}; did you mean {ours!r}?"
        # With a name, Python would add a guess of its own.
        raise AttributeError(message, name="", obj=None)
    return _public(name)


mdp.load = lambda level: _public("load")(level)
registration.install()
