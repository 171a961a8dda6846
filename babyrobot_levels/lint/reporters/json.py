"""Diagnostics for programs: one JSON object."""

from __future__ import annotations

import json
from collections.abc import Iterable

from babyrobot_levels.text.diagnostics import Diagnostic

VERSION = 1
"""The version of the shape; it changes when a reader would have to."""


def render(diagnostics: Iterable[Diagnostic]) -> str:
    """Return `{"version": 1, "diagnostics": […]}`, indented."""
    data = {"version": VERSION, "diagnostics": [d.to_dict() for d in diagnostics]}
    return json.dumps(data, indent=2) + "\n"
