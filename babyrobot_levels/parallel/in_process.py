"""The executor that needs no other process."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterable

from babyrobot_levels.parallel.executor import Failure, Item, Result, outcome_of


class InProcess:
    """Runs functions in this process, one item after the other."""

    def map(
        self, function: Callable[[Item], Result], items: Iterable[Item]
    ) -> Generator[Result | Failure]:
        """Yield the result of a function for each item; see `Executor.map`."""
        for index, item in enumerate(items):
            yield outcome_of(function, index, item)
