"""From a level's fields to walls and exact tables: mazes, grid, compiler, digest."""

from collections.abc import Callable
from typing import Any

public: Callable[[str], Callable[..., Any]]
"""Returns a public function by its name: one of a later room, and the package sets this."""
