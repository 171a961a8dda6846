"""Generating levels on a cluster: the same files as in one process, whatever happens to nodes."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Generator, Iterable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from threading import Thread
from typing import Any

import pytest
from support.sessions import environment

import babyrobot_levels as brl
from babyrobot_levels.parallel.executor import Executor, Failure, Item, Result
from babyrobot_levels.parallel.on_ray import OnRay

pytestmark = pytest.mark.usefixtures("cluster", "here")

SUITE = {
    "version": 1,
    "kind": "suite",
    "name": "small",
    "count": 2000,
    "size": {"min": [4, 4], "max": [7, 7]},
    "splits": {"train": 0.9, "test": 0.1},
    "puddles": {"max": 2},
}


def contents(folder: str) -> dict[str, bytes]:
    paths = sorted(path for path in Path(folder).rglob("*") if path.is_file())
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in paths}


def generate(folder: str, **options: Any) -> list[brl.Generated]:
    return brl.generate(SUITE, folder, **options)


def said_by(process: subprocess.Popen[bytes]) -> tuple[int, str, str]:
    """Wait for a command, and return its status and what it wrote."""
    out, err = (text.decode() for text in process.communicate(timeout=120))
    return process.returncode, out, err


def babyrobot(*arguments: str) -> subprocess.Popen[bytes]:
    return subprocess.Popen(
        [sys.executable, "-m", "babyrobot_levels", *arguments],
        env=environment(Path.cwd()),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )


@dataclass(frozen=True)
class Wrapped:
    """An executor that runs functions inside another one, which is given the index as well."""

    executor: Executor
    wrapper: Callable[..., Any]

    def map(
        self, function: Callable[[Item], Result], items: Iterable[Item]
    ) -> Generator[Result | Failure]:
        return self.executor.map(partial(self.wrapper, function), enumerate(items))


def noted(folder: str, function: Callable[[Any], Any], numbered: tuple[int, Any]) -> Any:
    """Note the index in a file of the node's, and take some time: a minute on a slow node."""
    import ray

    node = ray.get_runtime_context().get_node_id()
    with Path(folder, f"{node}-{os.getpid()}").open("a", encoding="utf-8") as notes:
        notes.write(f"{numbered[0]}\n")
    if Path(f"{folder}-slow").read_text("utf-8") == node:
        Path(f"{folder}-waits").touch()
        time.sleep(60)
    time.sleep(0.001)
    return function(numbered[1])


def test_a_node_that_is_removed_costs_nothing(cluster: Any, here: Path) -> None:
    import ray

    notes = here / "notes"
    notes.mkdir()
    others = {each["NodeID"] for each in ray.nodes()}
    node: Any = cluster.add_node(num_cpus=2)
    cluster.wait_for_nodes()
    (node_id,) = {each["NodeID"] for each in ray.nodes()} - others
    slow, waits = Path(f"{notes}-slow"), Path(f"{notes}-waits")
    slow.write_text("", "utf-8")

    def remove() -> None:
        while not waits.exists():
            time.sleep(0.05)
        cluster.remove_node(node, allow_graceful=False)

    removing = Thread(target=remove, daemon=True)
    removing.start()
    executor = Wrapped(OnRay(), partial(noted, str(notes)))

    def watch(done: int, total: int) -> None:
        if done == 301:
            # From now on, the node is at work on a level until it is removed.
            slow.write_text(node_id, "utf-8")

    seen = [each.index for each in brl.generate(SUITE, "ray", executor=executor, progress=watch)]
    removing.join(60)
    assert seen == [*range(2000)]
    generate("alone")
    assert contents("ray") == contents("alone")
    begun = [line for path in notes.iterdir() for line in path.read_text("utf-8").splitlines()]
    # What was being done on the node was done again.
    assert len(set(begun)) == 2000 < len(begun)


def fail_at(index: int, function: Callable[[Any], Any], numbered: tuple[int, Any]) -> Any:
    if numbered[0] == index:
        raise MemoryError("too large")
    return function(numbered[1])


def test_a_poisoned_level_is_told_by_its_index() -> None:
    poisoned, told = Wrapped(OnRay(), partial(fail_at, 37)), list[int]()
    with pytest.raises(MemoryError, match="too large"):
        brl.generate(
            SUITE,
            "out",
            count=60,
            executor=poisoned,
            progress=lambda done, total: told.append(done),
        )
    assert told == [*range(1, 38)]


def test_a_poisoned_level_can_be_left_out() -> None:
    poisoned = Wrapped(OnRay(), partial(fail_at, 37))
    levels = generate("out", count=60, executor=poisoned, keep_going=True)
    assert [(each.index, str(each.error)) for each in levels if each.error] == [(37, "too large")]
    generate("alone", count=60)
    whole = contents("alone")
    del whole["train/small-00037.yaml"]
    assert contents("out") == whole
    # What is missing can be made later, elsewhere.
    assert sum(each.is_new for each in generate("out", count=60, resume=True)) == 1
    assert contents("out") == contents("alone")


def test_an_interrupted_call_goes_on_elsewhere(cluster: Any) -> None:
    order = ("generate", "--count", "400", "--size", "20x20", "--path-length", "60..", "-o", "out")
    process = babyrobot(*order, "--ray-address", cluster.address)
    while len(list(Path("out").glob("*.yaml"))) < 20 and process.poll() is None:
        time.sleep(0.01)
    process.send_signal(signal.SIGINT)
    status, out, err = said_by(process)
    made = contents("out")
    assert (status, out) == (130, ""), err
    assert 20 <= len(made) < 400
    assert err == (
        f"stopped: {len(made)} of 400 levels are in out\n"
        "  help: continue with the same call and --resume\n"
    )
    assert said_by(babyrobot(*order, "--resume", "--jobs", "2"))[0] == 0
    whole = contents("out")
    assert len(whole) == 400
    assert made == {name: whole[name] for name in made}


def test_what_ray_says_at_the_end_is_not_shown(cluster: Any) -> None:
    script = """
import os, sys
from ray._private import worker
from babyrobot_levels.cli.app import main

disconnect = worker.disconnect

def loud(*arguments):
    if worker.global_worker.connected:
        os.write(2, b"Failed to push error to driver")
    disconnect(*arguments)

worker.disconnect = loud
main()
"""
    order = ("generate", "--count", "3", "-o", "out", "--ray-address", cluster.address)
    done = subprocess.run(
        [sys.executable, "-c", script, *order],
        # Ray is imported before the command could have it keep its news to itself.
        env=environment(Path.cwd(), RAY_DEDUP_LOGS_SKIP_REGEX="."),
        capture_output=True,
        timeout=100,
        check=False,
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, b"wrote 3 levels to out\n", b"")


def test_news_of_the_cluster_are_no_results(cluster: Any) -> None:
    from ray._private.utils import publish_error_to_driver
    from ray._private.worker import global_worker

    order = ("generate", "--count", "100", "--size", "20x20", "--path-length", "60..", "-o", "out")
    process = babyrobot(*order, "--ray-address", cluster.address)
    while process.poll() is None:
        # As Ray does when a node is lost.
        publish_error_to_driver("lost", "a node is lost", gcs_client=global_worker.gcs_client)
        time.sleep(0.05)
    assert said_by(process) == (0, "wrote 100 levels to out\n", "")


def test_a_wrong_address_is_one_message_within_seconds() -> None:
    began = time.monotonic()
    said = said_by(babyrobot("generate", "--count", "3", "--ray-address", "127.0.0.1:9"))
    assert time.monotonic() - began < 10
    assert said == (
        2,
        "",
        "error: no Ray cluster can be reached at 127.0.0.1:9: Connection refused\n"
        "  help: check the address, HOST:PORT as `ray start --head` tells it\n",
    )


@pytest.mark.parametrize("answer", [b"SSH-2.0-OpenSSH_9.9\r\n", b""], ids=["another", "silent"])
def test_what_answers_may_not_be_ray(answer: bytes) -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:

        def serve() -> None:
            peer, _ = server.accept()
            with peer:
                peer.sendall(answer)
                # Until the other side hangs up.
                while peer.recv(1024):
                    pass

        Thread(target=serve, daemon=True).start()
        address = f"127.0.0.1:{server.getsockname()[1]}"
        began = time.monotonic()
        status, _, errors = said_by(babyrobot("generate", "--count", "3", "--ray-address", address))
    assert time.monotonic() - began < 10
    reason = "what answers there is not Ray" if answer else "timed out"
    assert (status, errors.splitlines()[0]) == (
        2,
        f"error: no Ray cluster can be reached at {address}: {reason}",
    )


def test_the_cpus_of_a_cluster_cannot_be_chosen(cluster: Any) -> None:
    call = ("generate", "--count", "3", "--jobs", "4", "--ray-address", cluster.address)
    assert said_by(babyrobot(*call)) == (
        2,
        "",
        "error: the Ray cluster runs already, so its number of CPUs cannot be chosen\n"
        "  help: leave out the number of jobs\n",
    )


def test_a_new_local_instance_says_nothing() -> None:
    order = ("generate", "--count", "20", "-o")
    assert said_by(babyrobot(*order, "out", "--ray-address", "local", "--jobs", "1")) == (
        0,
        "wrote 20 levels to out\n",
        "",
    )
    assert said_by(babyrobot(*order, "alone"))[0] == 0
    assert contents("out") == contents("alone")
