"""The executor that runs functions on a Ray cluster. Ray is imported when work begins."""

from __future__ import annotations

import logging
import os
import re
import socket
import sys
from collections.abc import Callable, Generator, Iterable
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec
from pathlib import Path
from time import monotonic
from typing import Any

from babyrobot_levels.parallel.executor import (
    Chunk,
    Done,
    ExecutorError,
    Failure,
    Item,
    Result,
    WorkerDiedError,
    stream,
    work_on,
)
from babyrobot_levels.text.errors import DISTRIBUTION, how_to_install

RETRIES = 3
"""How often Ray repeats a chunk whose worker or node died."""

PATIENCE = 3.0
"""Seconds in which a cluster has to accept a connection."""

GREETING = b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n" + bytes((0, 0, 0, 4, 0, 0, 0, 0, 0))
"""What a client of gRPC, by which Ray is reached, begins with; the answer is of the same type 4."""

REFRESH = 5.0
"""Seconds after which the number of CPUs is asked for again: clusters grow and shrink."""


@dataclass(frozen=True)
class OnRay:
    """Runs functions on a Ray cluster, whose nodes have the same version of this package.

    A connection that exists is used, and stays when the work is done.

    Attributes:
        address: the address of the cluster as `ray.init` takes it; None for that of `RAY_ADDRESS`,
            or else of a cluster on this machine, or else a new local instance.
        cpus: the number of CPUs of a new local instance; None for one for each processor.
    """

    address: str | None = None
    cpus: int | None = None

    def map(
        self, function: Callable[[Item], Result], items: Iterable[Item]
    ) -> Generator[Result | Failure]:
        """Yield the result of a function for each item; see `Executor.map`."""
        connect(self.address, self.cpus)
        return stream(_Cluster(), function, items)


class _Cluster:
    """The CPUs of the cluster that this process is connected to."""

    def __init__(self) -> None:
        import ray

        self._work = ray.remote(num_cpus=1, max_retries=RETRIES)(_worker(installed()))
        self._count, self._until = 1, 0.0

    @property
    def count(self) -> int:
        import ray

        if monotonic() >= self._until:
            self._count = max(1, int(ray.cluster_resources().get("CPU", 1)))
            self._until = monotonic() + REFRESH
        return self._count

    def send(self, function: Callable[[Any], Any], chunk: Chunk[Any]) -> Any:
        from ray import cloudpickle

        # It sends functions of a script or a notebook by value, since workers cannot import those.
        return self._work.remote(cloudpickle.dumps((function, chunk)))

    def wait_for(self, ticket: Any) -> Done[Any]:
        import ray
        from ray import exceptions

        try:
            done: Done[Any] | str = ray.get(ticket)
        except (
            exceptions.NodeDiedError,
            exceptions.ObjectLostError,
            exceptions.OutOfMemoryError,
            exceptions.WorkerCrashedError,
        ) as error:
            kind = type(error).__name__
            message = f"the worker died {RETRIES + 1} times ({kind})"
            raise WorkerDiedError(message) from None
        except exceptions.RayTaskError:
            raise
        except exceptions.RayError as error:
            message = f"the Ray cluster failed: {_beginning(error)}"
            raise ExecutorError(message, "see the logs of the cluster, then try again") from None
        if isinstance(done, str):
            help_text = f"install {DISTRIBUTION} {installed() or ''} on all nodes of the cluster"
            raise ExecutorError(done, help_text.replace("  ", " "))
        return done

    def close(self, tickets: Iterable[Any]) -> None:
        """Leave the chunks that were sent: they end in a moment, or with this process.

        Ray ends this process if a task is cancelled while its result arrives.
        """


def _worker(wanted: str | None) -> Callable[[bytes], Any]:
    """Return the function that works on chunks, for a version of this package.

    Ray sends it by its code, as it is defined inside a function: it works on nodes that lack the
    package, and tells of it.
    """

    def work(sent: bytes) -> Any:
        import pickle
        import platform

        try:
            from babyrobot_levels.parallel.on_ray import installed

            if (here := installed()) != wanted:
                return f"the node {platform.node()} has babyrobot-levels {here}, not {wanted}"
            function, chunk = pickle.loads(sent)
        except ImportError as error:
            return f"the node {platform.node()} cannot import babyrobot-levels: {error}"
        return work_on(function, chunk)

    return work


def installed() -> str | None:
    """Return the version of this package that is installed; None if it is not."""
    try:
        return version(DISTRIBUTION)
    except PackageNotFoundError:
        return None


def connect(address: str | None = None, cpus: int | None = None) -> None:
    """Connect to a Ray cluster, or start a local instance; see `OnRay`.

    Raises:
        ExecutorError: Ray is not installed; there is no cluster at the address; the number of CPUs
            is given for a cluster that exists.
    """
    if find_spec("ray") is None:
        raise ExecutorError("Ray is not installed", how_to_install("ray"))
    address = address or os.environ.get("RAY_ADDRESS") or None
    _check(address)
    # Ray reads these when it is imported: no report of usage, fewer attempts at what is no cluster.
    os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")
    os.environ.setdefault("RAY_NUM_REDIS_GET_RETRIES", "4")
    import ray
    from ray.job_config import JobConfig

    if is_connected():
        return
    # Unless a client of Ray comes from elsewhere, workers look for modules in its working folder
    # first, even if it does not itself.
    is_elsewhere = str(Path.cwd()) not in map(os.path.abspath, sys.path)
    try:
        ray.init(
            address,
            job_config=JobConfig(_client_job=is_elsewhere),
            num_cpus=cpus,
            include_dashboard=False,
            log_to_driver=False,
            logging_level=logging.ERROR,
        )
    except Exception as error:
        if cpus is not None and "num_cpus" in str(error):
            message = "the Ray cluster runs already, so its number of CPUs cannot be chosen"
            raise ExecutorError(message, "leave out the number of jobs") from None
        raise _unreachable(address, _beginning(error)) from None


def is_connected() -> bool:
    """Tell whether this process is connected to a Ray cluster."""
    ray = sys.modules.get("ray")
    return ray is not None and bool(ray.is_initialized())


def disconnect() -> None:
    """End the connection to a Ray cluster, and a local instance that was started for it."""
    if is_connected():
        import ray

        ray.shutdown()


def _check(address: str | None) -> None:
    """Check that Ray may be at an address: where it is not, it would try for minutes."""
    if address in (None, "auto", "local"):
        return
    match = re.fullmatch(r"(?:ray://)?(\[[^]]+\]|[^:/]+):([0-9]{1,5})", address)
    if not match:
        raise _unreachable(address, "it is not HOST:PORT")
    try:
        with socket.create_connection((match[1].strip("[]"), int(match[2])), PATIENCE) as peer:
            if os.environ.get("RAY_USE_TLS") == "1":
                return
            peer.sendall(GREETING)
            answer = peer.recv(len(GREETING))
    except (OSError, OverflowError, UnicodeError) as error:
        raise _unreachable(address, getattr(error, "strerror", None) or str(error)) from None
    if answer[3:4] != GREETING[-6:-5]:
        raise _unreachable(address, "what answers there is not Ray")


def _unreachable(address: str | None, reason: str) -> ExecutorError:
    if address is None:
        return ExecutorError(f"Ray cannot be started: {reason}", "try again, or use processes")
    message = f"no Ray cluster can be reached at {address}: {reason}"
    return ExecutorError(message, "check the address, HOST:PORT as `ray start --head` tells it")


def _beginning(error: Exception) -> str:
    """Return the first sentence of an error of Ray, which can be long."""
    return re.split(r"\.\s|\n", str(error))[0] or type(error).__name__
