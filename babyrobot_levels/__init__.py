"""babyrobot-levels: grid worlds as files.

A level is a YAML file: it is read, checked, compiled into exact tables and played as a Gymnasium
environment. Importing this package makes the environments known to Gymnasium (at once if
Gymnasium is loaded, else as soon as it is) and costs next to nothing: every name below is
imported when it is first used.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from babyrobot_levels import _gymnasium_hook

if TYPE_CHECKING:
    from babyrobot_levels.actions import Action as Action
    from babyrobot_levels.catalogue import LevelInfo as LevelInfo
    from babyrobot_levels.catalogue import levels as levels
    from babyrobot_levels.catalogue import load as load
    from babyrobot_levels.diagnostics import Diagnostic as Diagnostic
    from babyrobot_levels.diagnostics import Severity as Severity
    from babyrobot_levels.errors import BabyRobotError as BabyRobotError
    from babyrobot_levels.errors import LevelError as LevelError
    from babyrobot_levels.errors import LevelNotFoundError as LevelNotFoundError
    from babyrobot_levels.grid import Grid as Grid
    from babyrobot_levels.level import Level as Level
    from babyrobot_levels.mdp import Mdp as Mdp
    from babyrobot_levels.reading import check as check
    from babyrobot_levels.reading import loads as loads

__version__ = "0.1.0"

_HOMES = {
    "Action": "actions",
    "BabyRobotError": "errors",
    "Diagnostic": "diagnostics",
    "Grid": "grid",
    "Level": "level",
    "LevelError": "errors",
    "LevelInfo": "catalogue",
    "LevelNotFoundError": "errors",
    "Mdp": "mdp",
    "Severity": "diagnostics",
    "check": "reading",
    "levels": "catalogue",
    "load": "catalogue",
    "loads": "reading",
}

__all__ = sorted([*_HOMES, "__version__"])


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(importlib.import_module(f"{__name__}.{_HOMES[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return __all__


_gymnasium_hook.install()
