"""Wrapped environments as the last line of a notebook's cell.

Gymnasium's wrappers hand on neither methods nor the way an environment shows itself. IPython asks
its formatters before it asks an object, so one is told about wrappers.
"""

from __future__ import annotations

import sys
from typing import Any

import gymnasium

from babyrobot_levels.envs.rendering import RenderedEnv


def show_wrapped_environments() -> None:
    """Have IPython, if it is what runs us, show wrapped environments of ours as it shows bare ones.

    A formatter that is there already stays.
    """
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython is not None else None
    if shell is not None:
        formatter = shell.display_formatter.mimebundle_formatter
        if gymnasium.Wrapper not in formatter.type_printers:
            formatter.for_type(gymnasium.Wrapper, _mimebundle)


def _mimebundle(wrapper: gymnasium.Wrapper[Any, Any, Any, Any]) -> Any:
    """Return what IPython shows of a wrapper; None has it do what it does without us."""
    own = getattr(wrapper, "_repr_mimebundle_", None)
    if own is None and isinstance(wrapper.unwrapped, RenderedEnv):
        own = wrapper.unwrapped._repr_mimebundle_
    return own() if own is not None else None
