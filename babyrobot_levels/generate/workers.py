"""The levels of an order, one after the other, made in one process or in several."""

from __future__ import annotations

import signal
from collections import deque
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import islice
from typing import TYPE_CHECKING

from babyrobot_levels.generate.candidates import Maker
from babyrobot_levels.generate.order import Order
from babyrobot_levels.generate.search import Found, StarvedError, find_level

if TYPE_CHECKING:
    from concurrent.futures import Future
    from multiprocessing.synchronize import Event

    _Chunks = deque[Future[list["Made | StarvedError"]]]

Task = tuple[int, int | None]
"""A level's number, and the try that is known to be it, if one is."""

CHUNK = 16
AHEAD = 4
"""So many chunks for each process wait for their turn."""


@dataclass(frozen=True, slots=True)
class Made:
    """A level that was made: its number, which try it was, its file's text, and its digest."""

    number: int
    attempt: int
    text: str
    digest: str


def made_levels(order: Order, tasks: Sequence[Task], jobs: int) -> Iterator[Made]:
    """Yield the levels of an order, in the order of the tasks, no two of them the same game.

    Args:
        order: what is ordered.
        tasks: all levels, from number 0 on.
        jobs: the number of processes. What is yielded does not depend on it.

    Raises:
        StarvedError: no level meets the conditions. Those before it have been yielded.
    """
    maker = order.maker()
    games = set(order.excluded)
    each = _alone(order, maker, tasks) if jobs <= 1 else _spread(order, tasks, jobs)
    for made in each:
        if isinstance(made, StarvedError):
            raise made
        if made.digest in games:
            found = find_level(
                maker,
                made.number,
                first=made.attempt + 1,
                is_new=lambda level: level.digest not in games,
            )
            made = _written(order, found)
        games.add(made.digest)
        yield made


def _alone(order: Order, maker: Maker, tasks: Sequence[Task]) -> Iterator[Made | StarvedError]:
    return (_make(order, maker, task) for task in tasks)


def _spread(order: Order, tasks: Sequence[Task], jobs: int) -> Iterator[Made | StarvedError]:
    import multiprocessing
    from concurrent.futures import ProcessPoolExecutor

    stop = multiprocessing.Event()
    chunks = (tasks[first : first + CHUNK] for first in range(0, len(tasks), CHUNK))
    with ProcessPoolExecutor(jobs, initializer=_begin, initargs=(order, stop)) as pool:
        try:
            waiting: _Chunks = deque(pool.submit(_work, c) for c in islice(chunks, jobs * AHEAD))
            while waiting:
                made = waiting.popleft().result()
                waiting.extend(pool.submit(_work, chunk) for chunk in islice(chunks, 1))
                yield from made
        finally:
            stop.set()
            pool.shutdown(cancel_futures=True)


_desk: tuple[Order, Maker, Event]
"""What a process of its own works with."""


def _begin(order: Order, stop: Event) -> None:
    global _desk
    # Whoever interrupts means the process that writes; it tells the others by `stop`.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    _desk = order, order.maker(), stop


def _work(tasks: Sequence[Task]) -> list[Made | StarvedError]:
    order, maker, stop = _desk
    made: list[Made | StarvedError] = []
    for task in tasks:
        if stop.is_set():
            break
        made.append(_make(order, maker, task))
    return made


def _make(order: Order, maker: Maker, task: Task) -> Made | StarvedError:
    number, attempt = task
    if attempt is not None:
        return _written(order, Found(number, attempt, maker.draw(number, attempt).level))
    try:
        return _written(order, find_level(maker, number))
    except StarvedError as error:
        return error


def _written(order: Order, found: Found) -> Made:
    text = order.text(found.number, found.attempt, found.level)
    return Made(found.number, found.attempt, text, found.level.digest)
