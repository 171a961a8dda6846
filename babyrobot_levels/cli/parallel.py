"""The same work for many files, over several processes where that pays, with a progress bar."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from itertools import chain
from typing import TYPE_CHECKING, Annotated, TypeVar

import typer

if TYPE_CHECKING:
    from rich.progress import Progress, TaskID

Item = TypeVar("Item")
Result = TypeVar("Result")

WORTH_IT = 200
"""With fewer items, starting processes takes longer than it saves."""

MAX_JOBS = 61
"""The largest number of processes that Windows can wait for."""

JobsOption = Annotated[
    int | None,
    typer.Option(
        "--jobs",
        "-j",
        min=1,
        metavar="N",
        help="Number of worker processes.  [default: one per processor if there are many files]",
        show_default=False,
    ),
]


def map_all(
    function: Callable[[Item], Result], items: Sequence[Item], jobs: int | None, label: str
) -> list[Result]:
    """Return the results of `function` for all items, in their order.

    Args:
        function: a function at module level, so that other processes can import it.
        items: its arguments.
        jobs: the number of processes; None chooses one.
        label: the label of the progress bar.
    """
    if jobs is None:
        jobs = (os.cpu_count() or 1) if len(items) >= WORTH_IT else 1
    jobs = min(jobs, len(items), MAX_JOBS)
    if jobs <= 1:
        return list(track(map(function, items), len(items), label))
    return list(track(_spread(function, items, jobs), len(items), label))


def _spread(
    function: Callable[[Item], Result], items: Sequence[Item], jobs: int
) -> Iterator[Result]:
    from concurrent.futures import ProcessPoolExecutor
    from functools import partial

    size = max(1, min(50, len(items) // (4 * jobs)))
    chunks = [items[first : first + size] for first in range(0, len(items), size)]
    with ProcessPoolExecutor(jobs) as pool:
        try:
            yield from chain.from_iterable(pool.map(partial(_each, function), chunks))
        except BaseException:
            pool.shutdown(cancel_futures=True)
            raise


def _each(function: Callable[[Item], Result], items: Sequence[Item]) -> list[Result]:
    return [function(item) for item in items]


PATIENCE = 1.0
"""Seconds before a progress bar appears."""


def track(items: Iterable[Item], total: int, label: str) -> Iterator[Item]:
    """Yield the items, with a progress bar on standard error if it is a terminal.

    Args:
        items: the items or results.
        total: their number.
        label: the label of the bar, such as `linting`.
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


@contextmanager
def working(label: str) -> Iterator[None]:
    """Show on a terminal that something is being done, if it takes longer than a moment."""
    if not sys.stderr.isatty():
        yield
        return
    from threading import Timer

    from rich.console import Console

    status = Console(stderr=True).status(f"{label} …")
    timer = Timer(PATIENCE, status.start)
    timer.daemon = True
    timer.start()
    try:
        yield
    finally:
        timer.cancel()
        timer.join()
        status.stop()


def _bar() -> Progress:
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn

    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn())
    return Progress(*columns, console=Console(stderr=True), transient=True)
