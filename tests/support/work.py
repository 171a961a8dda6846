"""How much a call does, counted and not timed: the same on a busy machine and under coverage."""

from __future__ import annotations

import sys
import tracemalloc
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from types import FrameType
from typing import Any


@dataclass
class Work:
    """What was done inside a `with`: calls of functions, and bytes held at the same time."""

    calls: int = 0
    memory: int = 0


@contextmanager
def counted_calls() -> Iterator[Work]:
    """Count the calls of functions, those written in C included."""
    work = Work()

    def count(_frame: FrameType, event: str, _: Any) -> None:
        if event in ("call", "c_call"):
            work.calls += 1

    before = sys.getprofile()
    sys.setprofile(count)
    try:
        yield work
    finally:
        sys.setprofile(before)


@contextmanager
def traced_memory() -> Iterator[Work]:
    """Measure the most memory that was in use at a time."""
    work = Work()
    tracemalloc.start()
    try:
        yield work
    finally:
        work.memory = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
