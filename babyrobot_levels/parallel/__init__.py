"""The same function for many items: in this process, in several, or on a Ray cluster."""

import os
from collections.abc import Callable, Generator, Iterable
from typing import Literal

from babyrobot_levels.parallel.executor import Executor, Failure, Item, Result, outcome_of
from babyrobot_levels.text.budget import limited
from babyrobot_levels.text.words import check_choice

ExecutorName = Literal["processes", "ray"]


class InProcess:
    """Runs functions in this process, one item after the other."""

    def map(
        self, function: Callable[[Item], Result], items: Iterable[Item]
    ) -> Generator[Result | Failure]:
        """Yield the result of a function for each item; see `Executor.map`."""
        function = limited(function)
        for index, item in enumerate(items):
            yield outcome_of(function, index, item)


def executor_for(
    executor: Executor | ExecutorName | None = None, jobs: int | None = None
) -> Executor:
    """Return an executor.

    Args:
        executor: an executor, which is returned; `"processes"` of this machine; `"ray"`, the
            cluster that Ray is connected to, or else finds by `RAY_ADDRESS` or on this machine, or
            else a new local instance; None for this process, or for processes if `jobs` is more
            than 1.
        jobs: the number of processes, or of CPUs of a new local instance of Ray; None for one for
            each processor.

    Raises:
        ValueError: there is no executor of this name, or fewer than one job.
    """
    if jobs is not None and jobs < 1:
        raise ValueError(f"jobs must be at least 1, not {jobs}")
    if executor is None:
        executor = "processes" if jobs is not None and jobs > 1 else None
    if executor is None:
        return InProcess()
    if executor == "processes":
        from babyrobot_levels.parallel.processes import Processes

        return Processes(jobs or os.cpu_count() or 1)
    if executor == "ray":
        from babyrobot_levels.parallel.on_ray import OnRay

        return OnRay(cpus=jobs)
    if isinstance(executor, str):
        check_choice("executor", executor, ("processes", "ray"))
    return executor
