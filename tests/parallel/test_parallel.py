"""The executors: what they yield does not depend on which one it is."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import closing
from functools import partial
from typing import Any

import pytest
from support import tasks

from babyrobot_levels.parallel import InProcess, executor_for
from babyrobot_levels.parallel.executor import Executor, Failure, WorkerDiedError, results
from babyrobot_levels.parallel.processes import Processes

EXECUTORS: list[Executor] = [InProcess(), Processes(2)]
BOTH = pytest.mark.parametrize("executor", EXECUTORS, ids=["in process", "processes"])


def told(outcomes: list[Any]) -> list[Any]:
    """Return outcomes that can be compared: failures as index, class and message."""
    return [
        (each.index, type(each.error), str(each.error)) if isinstance(each, Failure) else each
        for each in outcomes
    ]


@pytest.mark.slow
@BOTH
@pytest.mark.parametrize("items", [range(0), range(1), [3, 1, 2], range(5000)])
def test_results_are_in_the_order_of_the_items(executor: Executor, items: Any) -> None:
    assert list(executor.map(tasks.square, items)) == [number**2 for number in items]


@pytest.mark.slow
@BOTH
def test_items_may_come_from_a_generator(executor: Executor) -> None:
    items = (number for number in range(500))
    assert list(executor.map(tasks.slow, items)) == [*range(500)]


@BOTH
def test_a_failure_is_told_with_its_index_and_the_others_go_on(executor: Executor) -> None:
    outcomes = told(list(executor.map(tasks.no_sevens, range(1, 30))))
    expected: list[Any] = list(range(1, 30))
    for number in (7, 14, 21, 28):
        expected[number - 1] = (number - 1, ValueError, f"{number} is a multiple of 7")
    assert outcomes == expected


@BOTH
def test_results_raises_the_error_of_the_first_failure(executor: Executor) -> None:
    taken: list[int] = []
    with pytest.raises(ValueError, match=r"^7 is a multiple of 7$"):
        taken.extend(results(executor.map(tasks.no_sevens, range(1, 30))))
    # `extend` has taken what came before.
    assert taken == [1, 2, 3, 4, 5, 6]


def test_an_error_that_cannot_be_sent_is_told_by_its_text() -> None:
    (failure,) = Processes(2).map(tasks.unreadable, [5])
    assert isinstance(failure, Failure)
    assert str(failure.error) == "UnreadableError: 5 and 5"


@pytest.mark.slow
@BOTH
def test_few_items_are_taken_ahead_of_what_is_yielded(executor: Executor) -> None:
    items = tasks.Counted(100_000)
    ahead = 0
    with closing(executor.map(tasks.square, items)) as outcomes:
        for index, _ in enumerate(outcomes):
            ahead = max(ahead, items.taken - index)
    assert items.taken == 100_000
    # Of two workers: the chunks that were sent, and the one that is being yielded.
    assert ahead <= (2 * 4 + 1) * 1000


@pytest.mark.slow
def test_work_is_done_by_several_processes() -> None:
    seen = set()
    # A minute's work: the second process may take long to start on a busy machine.
    with closing(Processes(2).map(tasks.process_of, range(6000))) as processes:
        for process in processes:
            seen.add(process)
            if len(seen) == 2:
                return
    pytest.fail("one process did all the work", pytrace=False)


@pytest.mark.slow
def test_closing_cancels_what_has_not_been_done() -> None:
    items = tasks.Counted(100_000)
    with closing(Processes(2).map(tasks.slow, items)) as outcomes:
        assert [next(outcomes) for _ in range(50)] == [*range(50)]
        began = time.perf_counter()
    assert time.perf_counter() - began < 5
    assert items.taken < 1000


@pytest.mark.slow
def test_a_process_that_dies_costs_no_results_but_its_own() -> None:
    outcomes = told(list(Processes(2).map(partial(tasks.deadly, (150, 151)), range(300))))
    message = "the process that worked on it ended twice"
    expected: list[Any] = list(range(300))
    expected[150] = (150, WorkerDiedError, message)
    expected[151] = (151, WorkerDiedError, message)
    assert outcomes == expected


@pytest.mark.parametrize(
    ("call", "kind"),
    [
        (lambda: executor_for(), InProcess),
        (lambda: executor_for(jobs=1), InProcess),
        (lambda: executor_for(jobs=2), Processes),
        (lambda: executor_for("processes"), Processes),
        (lambda: executor_for(EXECUTORS[1], jobs=5), Processes),
    ],
)
def test_executors_are_chosen_by_name(call: Callable[[], Executor], kind: type) -> None:
    assert type(call()) is kind


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ({"executor": "threads"}, "one of 'processes', 'ray', not 'threads'"),
        ({"jobs": 0}, "jobs must be at least 1, not 0"),
    ],
)
def test_a_wrong_choice_is_told(arguments: dict[str, Any], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        executor_for(**arguments)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="processes are not forked here")
def test_ctrl_c_while_a_process_is_forked_is_not_lost() -> None:
    program = """
import multiprocessing, os, signal
from babyrobot_levels.parallel.processes import Processes

multiprocessing.set_start_method("fork")
os.register_at_fork(after_in_parent=lambda: signal.raise_signal(signal.SIGINT))
try:
    list(Processes(2).map(abs, range(10)))
except KeyboardInterrupt:
    print("interrupted")
"""
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, timeout=60, check=False
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "interrupted\n", "")


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="pipes show which processes are there")
def test_no_process_stays_when_the_one_that_started_it_is_killed() -> None:
    program = """
from babyrobot_levels.parallel.processes import Processes
for _ in Processes(2).map(abs, range(10**9)):
    print(flush=True)
"""
    with subprocess.Popen(
        [sys.executable, "-c", program], stdout=subprocess.PIPE, start_new_session=True
    ) as process:
        assert process.stdout is not None
        process.stdout.readline()
        process.kill()
        try:
            # The workers have the other end of the pipe, too: it is closed when they have ended.
            process.communicate(timeout=30)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            raise
