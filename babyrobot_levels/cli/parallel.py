"""The same work for many files, over several processes where that pays, with a progress bar."""

import atexit
import os
import platform
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import closing, contextmanager
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NamedTuple

from babyrobot_levels.cli.app import end_if_interrupted
from babyrobot_levels.cli.console import flag, value_option
from babyrobot_levels.cli.reporting import STANDARD_INPUT
from babyrobot_levels.parallel import executor_for
from babyrobot_levels.parallel.executor import Executor, ExecutorError, Item, Result, results
from babyrobot_levels.text.files import uninterrupted

if TYPE_CHECKING:
    from rich.progress import Progress

WORTH_IT = 200
"""With fewer items, starting processes takes longer than it saves."""

JobsOption = Annotated[
    int | None,
    value_option(
        "N",
        "Number of worker processes.  [default: one per processor if there are many files]",
        "--jobs",
        "-j",
        min=1,
    ),
]
RayOption = Annotated[
    bool,
    flag(
        "--ray",
        "Work on a Ray cluster: that of RAY_ADDRESS or of this machine, else a new local one.",
    ),
]
RayAddressOption = Annotated[
    str | None,
    value_option("HOST:PORT", "Work on the Ray cluster at this address.", "--ray-address"),
]


class Workers(NamedTuple):
    """The options that say where work is done: --jobs, --ray and --ray-address."""

    jobs: int | None = None
    ray: bool = False
    ray_address: str | None = None

    @property
    def are_elsewhere(self) -> bool:
        """Whether the work may be done on other machines."""
        return self.ray or self.ray_address is not None

    def executor(self, count: int) -> Executor:
        """Return the executor for a number of items."""
        if self.are_elsewhere:
            from babyrobot_levels.parallel.on_ray import OnRay, connect, is_connected

            # Ray reads it when it is imported. It would write among our results what happens to
            # the cluster, such as the loss of a node.
            os.environ.setdefault("RAY_DEDUP_LOGS_SKIP_REGEX", ".")
            if not is_connected():
                connect(self.ray_address, self.jobs)
                # What is registered last is done first: Ray would disconnect by itself.
                atexit.register(_leave_cluster)
            return OnRay(self.ray_address, self.jobs)
        return executor_for(jobs=jobs_for(count, self.jobs))


def _leave_cluster() -> None:
    """Disconnect without what Ray may tell of chunks that are left by an interrupted command."""
    from babyrobot_levels.parallel.on_ray import disconnect

    with _silent_errors():
        disconnect()


@contextmanager
def _silent_errors() -> Iterator[None]:
    """Drop what is written to standard error, also by libraries in C++."""
    try:
        kept = os.dup(2)
    except OSError:
        # There is none.
        yield
        return
    with Path(os.devnull).open("wb") as nowhere:
        os.dup2(nowhere.fileno(), 2)
    try:
        yield
    finally:
        os.dup2(kept, 2)
        os.close(kept)


def jobs_for(count: int, jobs: int | None, worth_it: int = WORTH_IT) -> int:
    """Return the number of processes for a number of items.

    Args:
        count: the number of items.
        jobs: the number that --jobs asks for, if it does.
        worth_it: with fewer items, starting processes takes longer than it saves.
    """
    if jobs is None:
        jobs = (os.cpu_count() or 1) if count >= worth_it else 1
    return max(1, min(jobs, count))


def map_all(
    function: Callable[[Item], Result], items: Sequence[Item], workers: Workers, label: str
) -> list[Result]:
    """Return the results of `function` for all items, in their order.

    Args:
        function: a function at module level, so that other processes can import it. It may read
            files.
        items: its arguments.
        workers: where it runs.
        label: the label of the progress bar.
    """
    if not items:
        return []
    if STANDARD_INPUT in items:
        # Other processes have no standard input.
        workers = Workers(1)
    if workers.are_elsewhere:
        function = partial(in_folder, str(Path.cwd()), function)
    with closing(workers.executor(len(items)).map(function, items)) as outcomes:
        return list(track(results(outcomes), len(items), label))


def in_folder(folder: str, function: Callable[[Item], Result], item: Item) -> Result:
    """Return the result of a function that is called in a folder.

    Raises:
        ExecutorError: this machine has no such folder.
    """
    try:
        os.chdir(folder)
    except OSError:
        message = f"the node {platform.node()} has no folder {folder}"
        help_text = "the files have to be in a folder that all nodes of the cluster share"
        raise ExecutorError(message, help_text) from None
    return function(item)


PATIENCE = 1.0
"""Seconds before a progress bar appears."""

Report = Callable[[int, int], None]
"""Is told how much of how much is done."""


def track(items: Iterable[Item], total: int, label: str) -> Iterator[Item]:
    """Yield the items, with a progress bar as that of `working`.

    Args:
        items: the items or results.
        total: their number.
        label: the label of the bar, such as `linting`.
    """
    with working(label) as report:
        for count, item in enumerate(items, 1):
            yield item
            report(count, total)


@contextmanager
def working(label: str) -> Iterator[Report]:
    """Show on a terminal that something is being done, if it takes longer than a moment.

    Yields a function that is told how much is done, which a bar on standard error then shows. It
    ends the command if an interrupt was lost meanwhile.
    """
    if not sys.stderr.isatty():
        yield lambda done, total: end_if_interrupted()
        return
    from threading import Timer

    bar = _Bar(label)
    timer = Timer(PATIENCE, bar.start)
    timer.daemon = True
    timer.start()
    try:
        yield bar.report
    finally:
        # A bar that is half removed leaves no cursor.
        with uninterrupted():
            timer.cancel()
            timer.join()
            bar.stop()


class _Bar:
    """A progress bar that need not be shown."""

    def __init__(self, label: str) -> None:
        self._label = label
        self._progress: Progress | None = None
        self._done: int | None = None
        self._total: int | None = None

    def start(self) -> None:
        from rich.console import Console
        from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

        columns = TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn()
        # The streams stay as they are: what is drawn depends on what they are.
        self._progress = Progress(
            *columns,
            console=Console(stderr=True),
            transient=True,
            redirect_stdout=False,
            redirect_stderr=False,
        )
        self._progress.add_task(self._label, total=self._total, completed=self._done or 0)
        self._progress.start()

    def report(self, done: int, total: int) -> None:
        end_if_interrupted()
        self._done, self._total = done, total
        if self._progress is not None:
            for task in self._progress.task_ids:
                self._progress.update(task, completed=done, total=total)

    def stop(self) -> None:
        if self._progress is not None:
            self._progress.stop()
