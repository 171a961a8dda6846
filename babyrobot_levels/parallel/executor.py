"""Executors: functions run for many items; chunks of items that workers get, again if one died."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import islice
from operator import length_hint
from time import perf_counter
from typing import Any, Generic, Protocol, TypeVar

from babyrobot_levels.text.budget import limited
from babyrobot_levels.text.errors import BabyRobotError, HelpfulError

Item = TypeVar("Item")
Result = TypeVar("Result")


class ExecutorError(HelpfulError, public=True):
    """Work cannot be done where it should be. `help` says what to do."""


class WorkerDiedError(BabyRobotError, public=True):
    """The process that worked on an item ended, also when the item was tried again."""


@dataclass(frozen=True, slots=True)
class Failure:
    """An item without a result: its index among the items, from 0, and the error."""

    index: int
    error: Exception


class Executor(Protocol):
    """Runs functions for many items. Results do not depend on which executor it is."""

    def map(
        self, function: Callable[[Item], Result], items: Iterable[Item]
    ) -> Generator[Result | Failure]:
        """Yield the result of a function for each item, in the order of the items.

        Items are taken and results are kept only a bounded number ahead of what is yielded. Closing
        the generator cancels what has not been done.

        Args:
            function: a function at module level, or a `partial` of one, so that other processes can
                import it. The arguments of a `partial` are sent many times and have to be small:
                what takes long to build is built from them by a function with a cache.
            items: what it is called with. They have to be small, too.

        Yields:
            For each item its result, or a `Failure` if the function raised an exception.

        Raises:
            ExecutorError: the workers cannot be reached, or cannot import the function.
        """


def results(outcomes: Iterable[Result | Failure]) -> Iterator[Result]:
    """Yield what `Executor.map` yields, and raise the error of the first failure."""
    for outcome in outcomes:
        if isinstance(outcome, Failure):
            raise outcome.error
        yield outcome


def outcome_of(function: Callable[[Item], Result], index: int, item: Item) -> Result | Failure:
    """Return the result for an item, or its failure."""
    try:
        return function(item)
    except Exception as error:
        return Failure(index, error)


def portable(failure: Failure) -> Failure:
    """Return a failure whose error another process can read."""
    try:
        import pickle

        pickle.loads(pickle.dumps(failure.error))
    except Exception:
        error = RuntimeError(f"{type(failure.error).__name__}: {failure.error}")
        return Failure(failure.index, error)
    return failure


SECONDS = 0.2
"""The work of a chunk: long beside what it costs to send one, short beside a run."""

MOST_ITEMS = 1000
"""The largest size of a chunk, which bounds the memory for results that nobody has taken yet."""

AHEAD = 4
"""The number of chunks per worker that are sent, but not yet taken as results."""


@dataclass(frozen=True, slots=True)
class Chunk(Generic[Item]):
    """Items that follow one another, and the index of the first of them."""

    first: int
    items: Sequence[Item]

    def halves(self) -> list[Chunk[Item]]:
        """Return two chunks with the same items."""
        middle = len(self.items) // 2
        return [
            Chunk(self.first, self.items[:middle]),
            Chunk(self.first + middle, self.items[middle:]),
        ]


@dataclass(frozen=True, slots=True)
class Done(Generic[Result]):
    """What a worker returns for a chunk: the outcome of each item, and the seconds it took."""

    outcomes: list[Result | Failure]
    seconds: float


def work_on(
    function: Callable[[Item], Result], chunk: Chunk[Item], is_stopped: Callable[[], bool] = bool
) -> Done[Result]:
    """Run a function for the items of a chunk, in a worker.

    Args:
        function: the function.
        chunk: the items.
        is_stopped: is asked between items whether the results are still wanted.
    """
    began = perf_counter()
    outcomes: list[Result | Failure] = []
    for index, item in enumerate(chunk.items, chunk.first):
        if is_stopped():
            break
        outcome = outcome_of(function, index, item)
        outcomes.append(portable(outcome) if isinstance(outcome, Failure) else outcome)
    return Done(outcomes, perf_counter() - began)


Ticket = TypeVar("Ticket")


class Workers(Protocol[Ticket]):
    """Workers that chunks are sent to. A ticket stands for a chunk that was sent."""

    @property
    def count(self) -> int:
        """The number of chunks that are worked on at a time."""

    def send(self, function: Callable[[Any], Any], chunk: Chunk[Any]) -> Ticket:
        """Send a chunk to a worker."""

    def wait_for(self, ticket: Ticket) -> Done[Any]:
        """Return what was done.

        Raises:
            WorkerDiedError: the worker ended, also when the chunk was tried again.
        """

    def close(self, tickets: Iterable[Ticket]) -> None:
        """Cancel chunks, and give up the workers."""


@dataclass(slots=True)
class _Source(Generic[Item]):
    """Cuts items into chunks, whose size follows the time that items take."""

    items: Iterator[Item]
    left: int
    """The number of items that are left, at most 0 if it is not known."""
    first: int = 0
    size: int = field(default=1, init=False)

    def next(self, workers: int) -> Chunk[Item] | None:
        """Return the next chunk, down to half of the size at the end; None if there are none."""
        size = self.size
        if self.left > 0:
            size = min(size, max(1, size // 2, self.left // (2 * workers)))
        chunk = Chunk(self.first, list(islice(self.items, size)))
        self.first += len(chunk.items)
        self.left -= len(chunk.items)
        return chunk if chunk.items else None

    def learn(self, count: int, seconds: float) -> None:
        """Adapt the size to a chunk of so many items that took so long."""
        fitting = int(SECONDS * count / max(seconds, 1e-9))
        # Chunks grow slowly, since the first items of a worker include its imports.
        self.size = max(1, min(2 * self.size, fitting, MOST_ITEMS))


def stream(
    workers: Workers[Ticket], function: Callable[[Item], Result], items: Iterable[Item]
) -> Generator[Result | Failure]:
    """Yield the outcome of each item, in the order of the items; see `Executor.map`.

    A chunk whose worker dies is halved until the item is found that is to blame.
    """
    function = limited(function)
    source = _Source(iter(items), length_hint(items))
    waiting: deque[tuple[Chunk[Item], Ticket]] = deque()

    def fill() -> None:
        while len(waiting) < AHEAD * workers.count:
            chunk = source.next(workers.count)
            if chunk is None:
                return
            waiting.append((chunk, workers.send(function, chunk)))

    try:
        fill()
        while waiting:
            chunk, ticket = waiting[0]
            try:
                done: Done[Result] = workers.wait_for(ticket)
            except WorkerDiedError as error:
                waiting.popleft()
                if len(chunk.items) == 1:
                    done = Done([Failure(chunk.first, error)], SECONDS)
                else:
                    again = [(half, workers.send(function, half)) for half in chunk.halves()]
                    waiting.extendleft(reversed(again))
                    continue
            else:
                waiting.popleft()
                source.learn(len(chunk.items), done.seconds)
            # The workers go on while the results are used.
            fill()
            yield from done.outcomes
    finally:
        workers.close(ticket for _, ticket in waiting)
