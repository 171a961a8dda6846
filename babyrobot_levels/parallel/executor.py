"""The interface of what runs a function for many items, and how it reports failures."""

from __future__ import annotations

import pickle
from collections.abc import Callable, Generator, Iterable, Iterator
from dataclasses import dataclass
from typing import Protocol, TypeVar

from babyrobot_levels.text.errors import BabyRobotError

Item = TypeVar("Item")
Result = TypeVar("Result")


class ExecutorError(BabyRobotError):
    """Work cannot be done where it should be. `help` says what to do."""

    __module__ = "babyrobot_levels"

    def __init__(self, message: str, help_text: str):
        self.help = help_text
        super().__init__(message, help_text)

    def __str__(self) -> str:
        return str(self.args[0])


class WorkerDiedError(BabyRobotError):
    """The process that worked on an item ended, also when the item was tried again."""

    __module__ = "babyrobot_levels"


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
        pickle.loads(pickle.dumps(failure.error))
    except Exception:
        error = RuntimeError(f"{type(failure.error).__name__}: {failure.error}")
        return Failure(failure.index, error)
    return failure
