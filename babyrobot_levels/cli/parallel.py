"""The same work for many files, over several processes where that pays."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from itertools import chain
from typing import Annotated, TypeVar

import typer

from babyrobot_levels.cli.progress import track

Item = TypeVar("Item")
Result = TypeVar("Result")

WORTH_IT = 200
"""For fewer items, starting processes takes longer than it saves."""

MAX_JOBS = 61
"""Windows can wait for so many processes."""

JobsOption = Annotated[
    int | None,
    typer.Option(
        "--jobs",
        "-j",
        min=1,
        metavar="N",
        help="Work in so many processes.  [default: one for each processor, for many files]",
        show_default=False,
    ),
]


def map_all(
    function: Callable[[Item], Result], items: Sequence[Item], jobs: int | None, label: str
) -> list[Result]:
    """Return what `function` gives for each item, in their order, whatever `jobs` is.

    Args:
        function: a function of a module's own level, so that other processes find it.
        items: its arguments.
        jobs: the number of processes; None chooses.
        label: what is being done, for the progress bar.
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
