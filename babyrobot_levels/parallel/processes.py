"""The executor that runs functions in processes of this machine."""

import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Generator, Iterable, Iterator
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing.synchronize import Event
from typing import Any

from babyrobot_levels.parallel.executor import (
    Chunk,
    Done,
    Failure,
    Item,
    Result,
    WorkerDiedError,
    stream,
    work_on,
)
from babyrobot_levels.text.files import uninterrupted

MAX_JOBS = 61
"""The largest number of processes that Windows can wait for."""

_SAFE_PATH, _OURS = "PYTHONSAFEPATH", "babyrobot"
_starting = threading.RLock()


@contextmanager
def starting() -> Iterator[None]:
    """Have processes that are started in the block import nothing from the working folder.

    Python looks there first, before it is told where the process that starts it does, and so do
    the processes that serve others. A process undoes it for its own ones by `begin`.
    """
    # Python drops what is raised while a process is forked.
    with _starting, uninterrupted():
        before = os.environ.get(_SAFE_PATH)
        os.environ[_SAFE_PATH] = before or _OURS
        try:
            yield
        finally:
            if not before:
                os.environ.pop(_SAFE_PATH, None)


def begin() -> None:
    """Begin a process that was started: it ends with the one that started it."""
    if os.environ.get(_SAFE_PATH) == _OURS:
        del os.environ[_SAFE_PATH]
    threading.Thread(target=_end_with_parent, daemon=True).start()


@dataclass(frozen=True)
class Processes:
    """Runs functions in processes that are started for the purpose.

    Attributes:
        jobs: the number of processes; at most 61 are started.
    """

    jobs: int

    def map(
        self, function: Callable[[Item], Result], items: Iterable[Item]
    ) -> Generator[Result | Failure]:
        """Yield the result of a function for each item; see `Executor.map`."""
        return stream(_Pool(min(self.jobs, MAX_JOBS)), function, items)


@dataclass(frozen=True, slots=True)
class _Ticket:
    function: Callable[[Any], Any]
    chunk: Chunk[Any]
    future: Future[Done[Any]]


class _Pool:
    """A pool of processes, which is replaced if one of them ends."""

    def __init__(self, count: int):
        self.count = count
        with starting():
            self._stop = multiprocessing.Event()
        self._pool = self._make(count)

    def _make(self, count: int) -> ProcessPoolExecutor:
        with starting():
            return ProcessPoolExecutor(count, initializer=_begin, initargs=(self._stop,))

    def send(self, function: Callable[[Any], Any], chunk: Chunk[Any]) -> _Ticket:
        try:
            future = _submit(self._pool, function, chunk)
        except BrokenProcessPool:
            self._pool = self._make(self.count)
            future = _submit(self._pool, function, chunk)
        return _Ticket(function, chunk, future)

    def wait_for(self, ticket: _Ticket) -> Done[Any]:
        try:
            return ticket.future.result()
        except BrokenProcessPool:
            return self._repeat(ticket)

    def _repeat(self, ticket: _Ticket) -> Done[Any]:
        """Do a chunk again, alone: when a process ends, all chunks that were sent are lost."""
        with self._make(1) as pool:
            try:
                return _submit(pool, ticket.function, ticket.chunk).result()
            except BrokenProcessPool:
                raise WorkerDiedError("the process that worked on it ended twice") from None

    def close(self, tickets: Iterable[_Ticket]) -> None:
        # Interrupted again, the pool could wait for ever for processes that nobody tells to end.
        with uninterrupted():
            self._stop.set()
            self._pool.shutdown(cancel_futures=True)


def _submit(
    pool: ProcessPoolExecutor, function: Callable[[Any], Any], chunk: Chunk[Any]
) -> Future[Done[Any]]:
    with starting():
        return pool.submit(_work, function, chunk)


_stop: Event
"""Of a worker process: whether the results are no longer wanted."""


def _begin(stop: Event) -> None:
    global _stop
    # Ctrl-C is for the process that takes the results; it stops the others by the event.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    _stop = stop
    begin()


def _end_with_parent() -> None:
    """End when the process that takes the results is killed: nobody would tell this one to."""
    if (parent := multiprocessing.parent_process()) is not None:
        parent.join()
        os._exit(1)  # noqa: TID251  (this process is ours, and `sys.exit` ends its thread only)


def _work(function: Callable[[Any], Any], chunk: Chunk[Any]) -> Done[Any]:
    return work_on(function, chunk, _stop.is_set)
