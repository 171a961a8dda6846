"""The front end of a kernel: a notebook with a person, a program that runs it, or none."""

from __future__ import annotations

import os
import sys
from enum import Enum, auto
from typing import Any


class Frontend(Enum):
    """What happens to displayed output."""

    NONE = auto()
    """There is no notebook."""
    PROGRAM = auto()
    """A program runs the notebook, as nbconvert and Papermill do: only the final output counts."""
    PICTURES = auto()
    """A person sees pictures, but not ipycanvas."""
    CANVAS = auto()
    """A person sees pictures, and ipycanvas if the front end has its extension."""


def in_notebook() -> bool:
    """Return whether this is a Jupyter kernel; IPython in a terminal is not."""
    return _kernel() is not None


def frontend() -> Frontend:
    """Return the current front end."""
    kernel = _kernel()
    if kernel is None:
        return Frontend.NONE
    if "google.colab" in sys.modules:
        return Frontend.CANVAS if _colab_shows_widgets() else Frontend.PICTURES
    is_voila = os.environ.get("SERVER_SOFTWARE", "").startswith("voila")
    if is_voila or _takes_input(kernel):
        return Frontend.CANVAS
    return Frontend.PROGRAM


def _kernel() -> Any:
    # A kernel has imported IPython.
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython is not None else None
    return getattr(shell, "kernel", None)


def _takes_input(kernel: Any) -> bool:
    """Return whether `input()` would be answered; programs report that they do not."""
    parent = kernel.get_parent() if hasattr(kernel, "get_parent") else {}
    return bool(parent.get("content", {}).get("allow_stdin", True))


def _colab_shows_widgets() -> bool:
    """Return whether custom widgets have been enabled."""
    widgets = sys.modules.get("google.colab.output._widgets")
    return getattr(widgets, "_installed_url", None) is not None
