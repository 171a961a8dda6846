"""All comparisons, one after another: one table, and a file that keeps it.

    python benchmarks/run.py                # about ten minutes; writes benchmarks/RESULTS.md
    python benchmarks/run.py --only solve --quick -o solve.md

Each script runs in a process of its own, so that none inherits another's memory. What is missing
and what failed is named, and the rest goes on; Ctrl-C ends the run, and what is done is kept.
"""

from __future__ import annotations

import argparse
import multiprocessing
import sys
import traceback
from collections.abc import Callable, Iterator, Sequence
from importlib import import_module
from multiprocessing.connection import Connection
from pathlib import Path

from page import Result, page, remarks, result_table
from timing import FEW, ROUNDS, Comparison

from babyrobot_levels.text.files import write_text

BENCHMARKS = (
    "step",
    "vector",
    "observations",
    "robots",
    "things",
    "frames",
    "solve",
    "checker",
    "score",
    "validate",
    "lint",
    "large",
    "mazes",
    "generate",
    "gallery",
    "parallel",
    "editor",
    "jax_envs",
    "jax_solve",
)
RESULTS = Path(__file__).with_name("RESULTS.md")

INTERRUPTED = "interrupted"

Measuring = Callable[[str, int], Iterator[Comparison]]
"""Yields the comparisons of a benchmark by its name, with a number of rounds."""


class BenchmarkError(Exception):
    """A benchmark that did not come to its end. Its text says why."""


def in_a_process(name: str, count: int) -> Iterator[Comparison]:
    """Yield the comparisons of a script as they come, from a process of its own.

    Raises:
        BenchmarkError: it failed; what came before has been yielded.
    """
    context = multiprocessing.get_context("spawn")
    receiver, sender = context.Pipe(duplex=False)
    process = context.Process(target=_send, args=(name, count, sender), daemon=True)
    process.start()
    sender.close()
    try:
        while True:
            try:
                found = receiver.recv()
            except EOFError:
                process.join()
                raise BenchmarkError(f"its process ended ({process.exitcode})") from None
            if found is None:
                return
            if isinstance(found, str):
                raise BenchmarkError(found)
            yield found
    finally:
        receiver.close()
        process.join(timeout=5)
        if process.is_alive():
            process.terminate()
            process.join()


def _send(name: str, count: int, sender: Connection) -> None:
    """Measure, and send each comparison, then None; or what went wrong."""
    try:
        for comparison in import_module(name).compare(count):
            sender.send(comparison)
        sender.send(None)
    except KeyboardInterrupt:
        # Whoever waits has been interrupted as well, and tells.
        pass
    except Exception as error:
        traceback.print_exc()
        sender.send("".join(traceback.format_exception_only(error)).strip())


def run(names: Sequence[str], count: int, measuring: Measuring) -> Iterator[Result]:
    """Yield what each benchmark came to, as soon as it has; a failure is a result too.

    An interrupted one is the last.
    """
    for name in names:
        done: list[Comparison] = []
        failure = None
        try:
            for comparison in measuring(name, count):
                done.append(comparison)  # noqa: PERF402  (what comes before a failure is kept)
        except KeyboardInterrupt:
            failure = INTERRUPTED
        except Exception as error:
            failure = str(error) or type(error).__name__
        yield Result(name, tuple(done), failure)
        if failure == INTERRUPTED:
            return


def main(arguments: Sequence[str] | None = None, measuring: Measuring = in_a_process) -> int:
    """Run what was asked for; return 0, or 1 if something failed or was interrupted."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--only", metavar="NAME", choices=BENCHMARKS, action="append", help=", ".join(BENCHMARKS)
    )
    parser.add_argument("--quick", action="store_true", help=f"{FEW} rounds, not {ROUNDS}")
    parser.add_argument(
        "-o", dest="file", metavar="FILE", type=Path, default=RESULTS, help="where the results go"
    )
    asked = parser.parse_args(arguments)
    names = [name for name in BENCHMARKS if name in (asked.only or BENCHMARKS)]
    count = FEW if asked.quick else ROUNDS
    results: list[Result] = []
    for result in run(names, count, measuring):
        results.append(result)
        print(f"{result.name}: {result.failure or 'done'}", file=sys.stderr, flush=True)
        # After each, so that even a run that is killed leaves what it had.
        write_text(asked.file, page(results, names, count))
    print(result_table(results))
    print(*remarks(results, names), sep="\n")
    return int(any(result.failure for result in results))


if __name__ == "__main__":
    sys.exit(main())
