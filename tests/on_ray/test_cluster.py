"""Functions on a Ray cluster: order, failures, lost nodes and workers, memory, what is refused."""

from __future__ import annotations

from contextlib import closing
from functools import partial
from typing import Any

import pytest
from support import tasks

from babyrobot_levels.parallel import executor_for, on_ray
from babyrobot_levels.parallel.executor import ExecutorError, Failure, WorkerDiedError
from babyrobot_levels.parallel.on_ray import OnRay

pytestmark = pytest.mark.usefixtures("cluster")


def test_ray_is_chosen_by_its_name() -> None:
    assert executor_for("ray") == OnRay()


def test_results_are_in_the_order_of_the_items() -> None:
    assert list(OnRay().map(tasks.slow, range(1000))) == [*range(1000)]


def test_work_is_done_on_both_nodes() -> None:
    seen = set()
    # A minute's work: the second worker may take long to start on a busy machine.
    with closing(OnRay().map(tasks.process_of, range(6000))) as processes:
        for process in processes:
            seen.add(process)
            if len(seen) == 2:
                return
    pytest.fail("one process did all the work", pytrace=False)


def test_the_drivers_memory_is_bounded() -> None:
    items = tasks.Counted(100_000)
    ahead = 0
    with closing(OnRay().map(tasks.square, items)) as outcomes:
        for index, square in enumerate(outcomes):
            assert square == index**2
            ahead = max(ahead, items.taken - index)
    assert items.taken == 100_000
    # Of two CPUs: the chunks that were sent, and the one that is being yielded.
    assert 0 < ahead <= (2 * 4 + 1) * 1000


def test_a_failure_is_told_with_its_index_and_is_not_tried_again() -> None:
    outcomes = list(OnRay().map(tasks.no_sevens, range(1, 30)))
    failures = {each.index: str(each.error) for each in outcomes if isinstance(each, Failure)}
    assert failures == {n - 1: f"{n} is a multiple of 7" for n in (7, 14, 21, 28)}
    assert len(outcomes) == 29


def test_an_item_that_kills_its_worker_is_found_and_told() -> None:
    outcomes: list[Any] = list(OnRay().map(partial(tasks.deadly, (2,)), range(20)))
    failure = outcomes.pop(2)
    assert isinstance(failure, Failure)
    assert isinstance(failure.error, WorkerDiedError)
    assert str(failure.error) == "the worker died 4 times (WorkerCrashedError)"
    assert outcomes == [0, 1, *range(3, 20)]


def test_nodes_with_another_version_are_told(monkeypatch: pytest.MonkeyPatch) -> None:
    here = on_ray.installed()
    monkeypatch.setattr(on_ray, "installed", lambda: "9.9.9")
    with pytest.raises(ExecutorError, match=rf"has babyrobot-levels {here}, not 9\.9\.9") as caught:
        list(OnRay().map(tasks.square, [1]))
    assert caught.value.help == "install babyrobot-levels 9.9.9 on all nodes of the cluster"


def test_functions_that_nodes_cannot_import_are_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tasks.square, "__module__", "only_here")
    monkeypatch.setitem(__import__("sys").modules, "only_here", tasks)
    with pytest.raises(ExecutorError, match="No module named 'only_here'"):
        list(OnRay().map(tasks.square, [1]))
