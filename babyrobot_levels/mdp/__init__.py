"""From a level's fields to walls and exact tables: mazes, grid, compiler, digest."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

load: Callable[[Any], Any]
"""The public `load`: names are found in a later room, and the package sets this when imported."""
