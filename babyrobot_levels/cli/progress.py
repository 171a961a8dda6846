"""Progress on standard error: only on a terminal, and only if something takes long."""

from __future__ import annotations

import sys
import time
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    from rich.progress import Progress, TaskID

Item = TypeVar("Item")

PATIENCE = 1.0
"""So many seconds pass before a bar is shown."""


def track(items: Iterable[Item], total: int, label: str) -> Iterator[Item]:
    """Yield the items, and show a bar of how many there have been.

    Args:
        items: what is worked on, or the results as they come.
        total: how many there will be.
        label: what is being done, such as `linting`.
    """
    if not sys.stderr.isatty():
        yield from items
        return
    bar: Progress | None = None
    task: TaskID | None = None
    begin = time.monotonic()
    try:
        for count, item in enumerate(items):
            yield item
            if bar is None and time.monotonic() - begin > PATIENCE:
                bar = _bar()
                bar.start()
                task = bar.add_task(label, total=total)
            if bar is not None and task is not None:
                bar.update(task, completed=count + 1)
    finally:
        if bar is not None:
            bar.stop()


def _bar() -> Progress:
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn

    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn())
    return Progress(*columns, console=Console(stderr=True), transient=True)
