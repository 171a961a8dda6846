"""babyrobot-levels: grid worlds as files.

A level is a YAML file: it is read, checked, compiled into exact tables and played as a Gymnasium
environment. Importing this package makes the environments known to Gymnasium (at once if
Gymnasium is loaded, else as soon as it is) and costs next to nothing: every public name, listed in
`__init__.pyi`, is imported when it is first used.
"""

import sys
from types import FunctionType
from typing import Any

import lazy_loader

from babyrobot_levels import mdp
from babyrobot_levels.envs import registration

__version__ = "0.1.0"

_public, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)


def __getattr__(name: str) -> object:
    """Import a public name when it is first used; a function then tells what is misspelt."""
    from babyrobot_levels.text.words import no_attribute, telling

    if name not in __all__:
        raise no_attribute(sys.modules[__name__], name)
    found: Any = _public(name)
    if isinstance(found, FunctionType):
        found = telling(found)
        # As such it is found again where it is unpickled.
        found.__module__ = __name__
    globals()[name] = found
    return found  # type: ignore[no-any-return]


mdp.public = lambda name: globals().get(name) or __getattr__(name)
registration.install()
