"""Many levels, solved, evaluated or measured by an executor: a row for each level."""

from __future__ import annotations

import os
import pickle
from collections.abc import Callable, Generator, Mapping
from contextlib import closing
from dataclasses import dataclass, fields
from functools import lru_cache, partial
from hashlib import sha256
from operator import length_hint
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from babyrobot_levels.agents.agents import MAX_BYTES, Table, load_policy
from babyrobot_levels.agents.sent import Item, portable_error, received, sent
from babyrobot_levels.analysis.metrics import metrics
from babyrobot_levels.analysis.solver.compiled import are_compiled
from babyrobot_levels.analysis.solver.evaluation import evaluation_of
from babyrobot_levels.analysis.solver.optimum import solve
from babyrobot_levels.analysis.solver.policies import space_of
from babyrobot_levels.analysis.solver.results import (
    Evaluation,
    check_actions,
    check_discount,
    check_within,
)
from babyrobot_levels.analysis.solver.within import optimum_within
from babyrobot_levels.language.plain_data import json_mapping
from babyrobot_levels.library.level import Level
from babyrobot_levels.parallel import ExecutorName, InProcess, executor_for
from babyrobot_levels.parallel.executor import Executor, Failure
from babyrobot_levels.suites.suite import Levels, named_levels
from babyrobot_levels.text.errors import BabyRobotError, LevelError
from babyrobot_levels.text.files import read_bytes
from babyrobot_levels.text.words import NAMED, Telling

LevelPolicy = str | os.PathLike[str] | Callable[[Level], Any]
"""A policy for each of many levels; see `evaluate_many`."""


@dataclass(frozen=True, slots=True)
class LevelValue(Telling, public=True):
    """What a policy is worth in one of many levels. With an `error`, None for what is unknown.

    Attributes:
        index: the place of the level among the others, from 0.
        name: its name.
        digest: its digest.
        states: the number of its states, without those that no episode can reach.
        expected_return: the expected return from the level's starts; may be inf or -inf.
        success: the probability of reaching an exit.
        steps: the expected number of steps.
        within: the number of steps after which episodes are truncated; None for no limit.
        discount: the factor by which each further reward counts less.
        error: why there are no values, with `keep_going`.
    """

    index: int
    name: str | None = None
    digest: str | None = None
    states: int | None = None
    expected_return: float | None = None
    success: float | None = None
    steps: float | None = None
    within: int | None = None
    discount: float | None = None
    error: Exception | None = None

    def to_dict(self) -> dict[str, Any]:
        """Return it as JSON can hold it: null for nan, texts for infinities and the error."""
        return _plain_row(self)


@dataclass(frozen=True, slots=True)
class LevelMetrics(Telling, public=True):
    """The metrics of one of many levels. With an `error`, None for what is unknown.

    Attributes:
        index: the place of the level among the others, from 0.
        name: its name.
        digest: its digest.
        states: the number of its states, one of its metrics.
        metrics: its metrics by their names, as `Metrics.to_dict` has them.
        error: why there are none, with `keep_going`.
    """

    index: int
    name: str | None = None
    digest: str | None = None
    states: int | None = None
    metrics: Mapping[str, Any] | None = None
    error: Exception | None = None

    def to_dict(self) -> dict[str, Any]:
        """Return it as JSON can hold it, with a key for each metric."""
        row = _plain_row(self)
        found, error = row.pop("metrics"), row.pop("error")
        return {**row, **json_mapping(dict(found or {})), "error": error}


def solve_many(
    levels: Levels,
    *,
    within: int | str | None = None,
    discount: float | None = None,
    actions: str = "all",
    executor: Executor | ExecutorName | None = None,
    jobs: int | None = None,
    keep_going: bool = False,
) -> Generator[LevelValue]:
    """Solve many levels exactly; see `solve`. Yield what an optimal policy is worth in each.

    A level is solved when its row is asked for, or a bounded number of levels ahead: iterate over
    the result. The rows do not depend on the executor. From 500 levels on, a limit of steps and the
    extra `fast` make it faster by far; the rows are then those of `solve` but for rounding errors.

    Args:
        levels: a suite, a folder, a pack or a level: a name, a path, a mapping, a `Suite` or a
            `Level`; or several levels. A suite that grows mazes is sent to workers once, and each
            of its levels as its number; other levels are sent as texts.
        within: as for `solve`.
        discount: as for `solve`.
        actions: as for `solve`.
        executor: None for this process, or for several if `jobs` is more than 1; `"processes"` of
            this machine; `"ray"`, the cluster that Ray is connected to, or else finds by
            `RAY_ADDRESS` or on this machine, or else a new local instance.
        jobs: the number of processes, or of CPUs of a new local instance of Ray; None for one for
            each processor.
        keep_going: whether a level that has no values gets a row with an `error`.

    Returns:
        A row for each level, in the order of the levels.

    Raises:
        LevelNotFoundError: there is no level, folder, pack or suite of that name.
        ExecutorError: Ray is not installed, or cannot be reached.
        ValueError: an argument has a value that it cannot have.
        Exception: without `keep_going`, what `solve` raises for a level, with a note that gives
            its index. The rows before it are yielded.
    """
    _check(within, discount, actions)
    named = named_levels(levels)
    is_quick = within is not None and are_compiled(length_hint(named))
    task = _solved_quickly if is_quick else _solved
    return _rows(
        LevelValue, partial(task, within, discount, actions), named, executor, jobs, keep_going
    )


def evaluate_many(
    levels: Levels,
    policy: LevelPolicy,
    *,
    within: int | str | None = None,
    discount: float | None = None,
    actions: str = "all",
    executor: Executor | ExecutorName | None = None,
    jobs: int | None = None,
    keep_going: bool = False,
) -> Generator[LevelValue]:
    """Evaluate a policy in many levels exactly; see `evaluate`. Yield what it is worth in each.

    Args:
        levels: as for `solve_many`.
        policy: one of

            - `"best"`, `"random"` or `"uniform"`, as `evaluate` takes them;
            - a function from a `Level` to a policy as `evaluate` takes it. For other processes it
              has to be at the top level of a module, which they import;
            - the path of a file of policies by the names or digests of levels, as
              `babyrobot score` reads it (.json, .npy, .npz). Workers read it, so it has to be in
              a folder that all machines share.
        within: as for `evaluate`.
        discount: as for `evaluate`.
        actions: as for `evaluate`.
        executor: as for `solve_many`.
        jobs: as for `solve_many`.
        keep_going: as for `solve_many`.

    Returns:
        A row for each level, in the order of the levels.

    Raises:
        LevelNotFoundError: there is no level, folder, pack or suite of that name.
        ExecutorError: Ray is not installed, or cannot be reached.
        ValueError: an argument has a value that it cannot have, or the file is no saved policy.
        TypeError: other processes cannot import the function.
        OSError: the file of policies cannot be read.
        Exception: without `keep_going`, what `evaluate` raises for a level, with a note that gives
            its index. The rows before it are yielded.
    """
    _check(within, discount, actions)
    if not callable(policy) and policy not in NAMED:
        if not Path(policy).suffix:
            known = "'best', 'random', 'uniform', a function of a level, or a file of policies"
            raise ValueError(f"there is no policy {policy!r}; use {known}")
        policy = SavedPolicies.of(Path(policy))
    return _rows(
        LevelValue,
        partial(_evaluated, policy, within, discount, actions),
        levels,
        executor,
        jobs,
        keep_going,
    )


def metrics_many(
    levels: Levels,
    *,
    max_states: int | None = None,
    seen: Mapping[str, Any] | None = None,
    executor: Executor | ExecutorName | None = None,
    jobs: int | None = None,
    keep_going: bool = False,
) -> Generator[LevelMetrics]:
    """Measure many levels; see `metrics`. Yield the metrics of each.

    Args:
        levels: as for `solve_many`.
        max_states: in levels of more states, the metrics are left out for which a level must be
            solved; None for no limit.
        seen: the sight of an agent, and its options, as `solve` takes them: with it, `sight_cost`
            is that of this sight, at least and at most.
        executor: as for `solve_many`.
        jobs: as for `solve_many`.
        keep_going: as for `solve_many`.

    Returns:
        A row for each level, in the order of the levels.

    Raises:
        LevelNotFoundError: there is no level, folder, pack or suite of that name.
        ExecutorError: Ray is not installed, or cannot be reached.
        ValueError: an argument has a value that it cannot have.
        Exception: without `keep_going`, what `metrics` raises for a level, with a note that gives
            its index. The rows before it are yielded.
    """
    return _rows(
        LevelMetrics, partial(_measured, max_states, seen), levels, executor, jobs, keep_going
    )


def reason(error: Exception) -> str:
    """Return in one line why a level has no row."""
    if isinstance(error, LevelError) and error.diagnostics:
        found = error.diagnostics[0]
        return f"{found.file}:{found.line}:{found.column}: {found.message}"
    text = str(error).partition("\n")[0]
    is_ours = isinstance(error, BabyRobotError | ValueError)
    return text if is_ours else f"{type(error).__name__}: {text}".removesuffix(": ")


# -- rows ----------------------------------------------------------------------------------

Row = TypeVar("Row", LevelValue, LevelMetrics)
_Task = Callable[[Level], dict[str, Any]]
"""What is done with a level, as the fields of its row."""


def _plain_row(row: LevelValue | LevelMetrics) -> dict[str, Any]:
    data = {field.name: getattr(row, field.name) for field in fields(row)}
    return json_mapping({**data, "error": row.error and reason(row.error)})


def _rows(
    kind: type[Row],
    task: _Task,
    levels: Levels,
    executor: Executor | ExecutorName | None,
    jobs: int | None,
    keep_going: bool,
) -> Generator[Row]:
    """Return the rows of what a task finds in each level."""
    chosen = executor_for(executor, jobs)
    if not isinstance(chosen, InProcess):
        _check_portable(task)
    suite, items = sent(levels)
    return _yielded(kind, chosen.map(partial(_work, task, suite), items), keep_going)


def _check_portable(task: _Task) -> None:
    try:
        pickle.dumps(task)
    except (pickle.PicklingError, AttributeError, TypeError):
        raise TypeError(
            "other processes cannot import the policy; define it as a function at the top level of "
            "a module"
        ) from None


def _yielded(
    kind: type[Row], outcomes: Generator[dict[str, Any] | Failure], keep_going: bool
) -> Generator[Row]:
    with closing(outcomes):
        for index, found in enumerate(outcomes):
            known = {"error": found.error} if isinstance(found, Failure) else found
            row = kind(index, **known)
            if row.error is not None and not keep_going:
                row.error.add_note(f"in level {index}" + (f", {row.name}" if row.name else ""))
                raise row.error
            yield row


# -- in workers ----------------------------------------------------------------------------


def _work(task: _Task, suite: str | None, item: Item) -> dict[str, Any]:
    """Return the fields of a level's row, except for its index."""
    level = received(suite, item)
    found: dict[str, Any] = {"name": level.name}
    try:
        found["digest"] = level.digest
        return found | task(level)
    except Exception as error:
        return found | {"error": portable_error(error)}


def _solved(
    within: int | str | None, discount: float | None, actions: str, level: Level
) -> dict[str, Any]:
    return _values(solve(level, discount, actions=actions, within=within))


def _solved_quickly(
    within: int | str | None, discount: float | None, actions: str, level: Level
) -> dict[str, Any]:
    space = space_of(level, actions)
    factor, limit = check_discount(discount, level.discount), check_within(within, level.max_steps)
    assert limit is not None
    earned, success, steps = optimum_within(space, factor, limit)
    return {
        "states": int(np.count_nonzero(~space.without_value)),
        "expected_return": earned,
        "success": success,
        "steps": steps,
        "within": limit,
        "discount": factor,
    }


def _evaluated(
    policy: SavedPolicies | str | Callable[[Level], Any],
    within: int | str | None,
    discount: float | None,
    actions: str,
    level: Level,
) -> dict[str, Any]:
    own = policy(level) if callable(policy) else policy
    return _values(evaluation_of(level, own, discount, actions, within))


def _values(found: Evaluation) -> dict[str, Any]:
    return {
        "states": int(np.count_nonzero(~np.isnan(found.values))),
        "expected_return": found.expected_return,
        "success": found.exit_probability,
        "steps": found.expected_steps,
        "within": found.within,
        "discount": found.discount,
    }


def _measured(
    max_states: int | None, seen: Mapping[str, Any] | None, level: Level
) -> dict[str, Any]:
    found = metrics(level)
    is_small = max_states is None or found.states <= max_states
    cost = {} if seen is None else {"sight_cost": solve(level, **seen).cost}
    return {"states": found.states, "metrics": found.to_dict(solve=is_small) | cost}


@dataclass(frozen=True, slots=True)
class SavedPolicies:
    """A file of policies by the names or digests of levels, which workers read.

    Attributes:
        path: the file.
        digest: what it contained when the work began.
    """

    path: Path
    digest: str

    @classmethod
    def of(cls, path: Path) -> SavedPolicies:
        """Return the policies of a file.

        Raises:
            OSError: it cannot be read.
            AgentError: it is no saved policy.
        """
        load_policy(path)
        return cls(path.absolute(), _digest(path))

    def __call__(self, level: Level) -> Any:
        """Return the policy of a level.

        Raises:
            OSError: this machine has no such file.
            ValueError: there is none, or this machine has another file.
        """
        return _read(self).of(level.name, level.digest)


@lru_cache(maxsize=2)
def _read(saved: SavedPolicies) -> Table:
    if _digest(saved.path) != saved.digest:
        raise ValueError(f"{saved.path} has changed, or is another file on another machine")
    return Table(load_policy(saved.path))


def _digest(path: Path) -> str:
    return sha256(read_bytes(path, MAX_BYTES)).hexdigest()


def _check(within: int | str | None, discount: float | None, actions: str) -> None:
    """Check arguments that all levels share.

    Raises:
        ValueError: one has a value that it cannot have.
    """
    check_actions(actions)
    check_discount(discount, 1.0)
    # Whether a level has `max_steps` is found out later.
    check_within(within, 1)
