"""Break the package in small random ways and see whether the tests notice.

Usage: python scripts/mutants.py --table TABLE [--count 200] [--seed 1] [--jobs 1] [-- PYTEST ...]

Each mutant is one change of one file of the package: another comparison, a number that is one
more, a statement that is gone. It is tested in a temporary copy of the checkout, by the tests
named like its module, then those of its room, then all, until one fails. What follows `--` are
the arguments of pytest but for paths, by default those of the fast tests: `-m "not slow and not
libraries"`. They may hold `-n 2`; `--jobs` tests several mutants at the same time instead. First
of all the tests are run without a mutant, and have to pass.

TABLE gets one JSON object a line and is read first: an interrupted run continues where it was.
Run it with the Python that has the libraries of the tests.
"""

from __future__ import annotations

import argparse
import ast
import builtins
import contextlib
import copy
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass
from pathlib import Path
from queue import SimpleQueue

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = "babyrobot_levels"
FAST = ["-m", "not slow and not libraries"]
LIMITED = ["sh", "-c", 'ulimit -d "$0"; exec "$@"', f"{8 << 20}"]
"""Before a command: it gets at most 8 GiB of memory. A mutant may ask for more and more."""

NO_TESTS = 5
"""The status of pytest where it collects nothing."""

COMPARISONS: dict[type[ast.cmpop], type[ast.cmpop]] = {
    ast.Lt: ast.LtE,
    ast.LtE: ast.Lt,
    ast.Gt: ast.GtE,
    ast.GtE: ast.Gt,
    ast.Eq: ast.NotEq,
    ast.NotEq: ast.Eq,
    ast.Is: ast.IsNot,
    ast.IsNot: ast.Is,
    ast.In: ast.NotIn,
    ast.NotIn: ast.In,
}
OPERATORS: dict[type[ast.operator], type[ast.operator]] = {
    ast.Add: ast.Sub,
    ast.Sub: ast.Add,
    ast.Mult: ast.FloorDiv,
    ast.FloorDiv: ast.Mult,
    ast.Div: ast.Mult,
    ast.Mod: ast.FloorDiv,
    ast.Pow: ast.Mult,
    ast.LShift: ast.RShift,
    ast.RShift: ast.LShift,
    ast.BitAnd: ast.BitOr,
    ast.BitOr: ast.BitAnd,
    ast.BitXor: ast.BitOr,
}


@dataclass(frozen=True)
class Mutant:
    """A change: in `file`, the bytes from `start` to `end` become `new`."""

    kind: str
    file: str
    line: int
    start: int
    end: int
    old: str
    new: str


# -- what could be changed -------------------------------------------------------------------


def mutants_of(file: str, text: str) -> Iterator[Mutant]:
    """Yield every mutant of a file: none of its annotations and docstrings."""
    data = text.encode()
    starts = [0]
    for line in data.splitlines(keepends=True):
        starts.append(starts[-1] + len(line))
    for node in _nodes(ast.parse(text)):
        for kind, new in _changes(node):
            start = starts[node.lineno - 1] + node.col_offset
            end = starts[(node.end_lineno or 0) - 1] + (node.end_col_offset or 0)
            yield Mutant(kind, file, node.lineno, start, end, data[start:end].decode(), new)


def _nodes(node: ast.AST) -> Iterator[ast.expr | ast.stmt]:
    """Yield the nodes that run and that a change could be seen of."""
    for name, value in ast.iter_fields(node):
        if name in ("annotation", "returns", "type_params", "type_comment"):
            continue
        for child in value if isinstance(value, list) else [value]:
            if not isinstance(child, ast.AST):
                continue
            if type(child).__name__ in ("JoinedStr", "TypeAlias"):
                continue
            if isinstance(child, ast.If) and "TYPE_CHECKING" in ast.unparse(child.test):
                continue
            if isinstance(child, ast.expr | ast.stmt):
                yield child
            yield from _nodes(child)


def _changes(node: ast.expr | ast.stmt) -> Iterator[tuple[str, str]]:
    """Yield what could stand in a node's place."""
    if isinstance(node, ast.Compare):
        for number, operator in enumerate(node.ops):
            changed = copy.deepcopy(node)
            changed.ops[number] = COMPARISONS[type(operator)]()
            yield "comparison", f"({ast.unparse(changed)})"
    elif isinstance(node, ast.BinOp) and type(node.op) in OPERATORS and not _is_of_types(node):
        changed_op = copy.deepcopy(node)
        changed_op.op = OPERATORS[type(node.op)]()
        yield "arithmetic", f"({ast.unparse(changed_op)})"
    elif isinstance(node, ast.AugAssign) and type(node.op) in OPERATORS:
        changed_sum = copy.deepcopy(node)
        changed_sum.op = OPERATORS[type(node.op)]()
        yield "arithmetic", ast.unparse(changed_sum)
        yield "removed", "pass"
    elif isinstance(node, ast.BoolOp):
        changed_bool = copy.deepcopy(node)
        changed_bool.op = ast.Or() if isinstance(node.op, ast.And) else ast.And()
        yield "boolean", f"({ast.unparse(changed_bool)})"
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not):
        yield "boolean", f"({ast.unparse(node.operand)})"
    elif isinstance(node, ast.IfExp):
        changed_if = copy.deepcopy(node)
        changed_if.test = ast.UnaryOp(ast.Not(), changed_if.test)
        yield "boolean", f"({ast.unparse(changed_if)})"
    elif isinstance(node, ast.Constant):
        yield from _constants(node)
    elif _can_go(node):
        yield "removed", "pass"


def _can_go(node: ast.expr | ast.stmt) -> bool:
    """Return whether the rest is still a program when this statement is removed."""
    match node:
        case ast.Raise() | ast.Break() | ast.Continue() | ast.Delete() | ast.Expr(ast.Call()):
            return True
        case ast.Assign([ast.Attribute() | ast.Subscript()]):
            return True
    return False


def _is_of_types(node: ast.BinOp) -> bool:
    """Return whether this is `X | None` or the like: an operation on types."""
    sides = [ast.unparse(side).split(".")[-1] for side in (node.left, node.right)]
    return isinstance(node.op, ast.BitOr) and any(
        side[:1].isupper() or hasattr(builtins, side) for side in sides
    )


def _constants(node: ast.Constant) -> Iterator[tuple[str, str]]:
    if isinstance(node.value, bool):
        yield "constant", str(not node.value)
    elif isinstance(node.value, int):
        yield "off by one", f"{node.value + 1}"
        yield "off by one", f"({node.value - 1})"
    elif isinstance(node.value, float):
        yield "constant", f"{node.value * 2 or 1.0!r}"


def drawn(count: int, seed: int) -> list[Mutant]:
    """Return `count` mutants of the package, the same ones for the same seed and package."""
    found = [
        mutant
        for path in sorted((ROOT / PACKAGE).rglob("*.py"))
        for mutant in mutants_of(path.relative_to(ROOT).as_posix(), path.read_text("utf-8"))
    ]
    return random.Random(seed).sample(found, min(count, len(found)))


# -- testing one -----------------------------------------------------------------------------


def stages(mutant: Mutant, tests: Path) -> list[list[str]]:
    """Return which tests to run one after the other: the nearest first, all at the end."""
    room, *_, module = Path(mutant.file).with_suffix("").parts[1:] * 2
    files = sorted(tests.rglob(f"test_{module}.py"))
    own = [path.relative_to(tests.parent).as_posix() for path in files]
    rooms = [f"tests/{room}"] if (tests / room).is_dir() else []
    return [stage for stage in (own, rooms) if stage] + [[]]


class Copy:
    """A copy of the checkout, in which one mutant after the other is tested."""

    def __init__(self, folder: Path, pytest: list[str], limit: float) -> None:
        self._folder = folder
        self._pytest = pytest
        self._limit = limit
        self._written = int(time.time())
        listed = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
        names = subprocess.run(listed, cwd=ROOT, capture_output=True, text=True, check=True).stdout
        for name in filter(None, names.split("\0")):
            if (ROOT / name).is_file():
                (folder / name).parent.mkdir(parents=True, exist_ok=True)
                shutil.copy2(ROOT / name, folder / name, follow_symlinks=False)

    def passes(self) -> bool:
        """Return whether all tests pass as the copy is."""
        return self._run([], {}) == 0

    def test(self, mutant: Mutant) -> dict[str, object]:
        """Return whether a mutant is killed, by which of its stages, and in how many seconds."""
        path = self._folder / mutant.file
        original = path.read_bytes()
        started = time.monotonic()
        before, after = original[: mutant.start], original[mutant.end :]
        self._write(path, before + mutant.new.encode() + after)
        by: str | None = None
        with tempfile.TemporaryDirectory() as cache:
            # numba does not see that what a cached function calls has changed.
            texts = [each.read_text("utf-8") for each in path.parent.glob("*.py")]
            compiled = any("import numba" in text for text in texts)
            environment = {"NUMBA_CACHE_DIR": cache} if compiled else {}
            for stage in stages(mutant, self._folder / "tests"):
                if self._run(stage, environment) not in (0, NO_TESTS):
                    by = " ".join(stage) or "all"
                    break
        self._write(path, original)
        seconds = round(time.monotonic() - started, 1)
        return {"killed": by is not None, "by": by, "seconds": seconds}

    def _write(self, path: Path, data: bytes) -> None:
        path.write_bytes(data)
        # Compiled files are told apart by size and by time, in whole seconds.
        self._written += 1
        os.utime(path, (self._written, self._written))

    def _run(self, tests: list[str], environment: dict[str, str]) -> int:
        call = [sys.executable, "-m", "pytest", "-x", "-p", "no:cacheprovider"]
        process = subprocess.Popen(
            [*LIMITED, *call, *self._pytest, *tests],
            cwd=self._folder,
            env=os.environ | {"PYTHONPATH": str(self._folder)} | environment,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
        )
        try:
            return process.wait(self._limit)
        except subprocess.TimeoutExpired:
            return 1
        finally:
            # With the processes that the tests have started.
            with contextlib.suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)
            process.wait()


# -- many ------------------------------------------------------------------------------------


def main() -> int:
    """Test the mutants that the table does not hold yet, and print what came out."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--table", type=Path, required=True, help="where results are kept")
    parser.add_argument("--count", type=int, default=200, help="how many mutants")
    parser.add_argument("--seed", type=int, default=1, help="which ones")
    parser.add_argument("--jobs", type=int, default=1, help="how many at the same time")
    parser.add_argument("--limit", type=float, default=1200, help="seconds for a run of pytest")
    parser.add_argument("pytest", nargs="*", help="arguments of pytest, after --")
    options = parser.parse_args()
    mutants = drawn(options.count, options.seed)
    pytest = options.pytest or FAST
    done: dict[Mutant, bool] = {}
    if options.table.exists():
        for line in options.table.read_text("utf-8").splitlines():
            row = json.loads(line)
            if row.pop("pytest") == pytest:
                done[Mutant(**{name: row[name] for name in Mutant.__annotations__})] = row["killed"]
    waiting = [mutant for mutant in mutants if mutant not in done]
    with tempfile.TemporaryDirectory(prefix="mutants-") as folder:
        copies: SimpleQueue[Copy] = SimpleQueue()
        for number in range(options.jobs if waiting else 0):
            copies.put(Copy(Path(folder, str(number)), pytest, options.limit))
        if waiting and not done:
            first = copies.get()
            if not first.passes():
                print("the tests fail without any mutant", file=sys.stderr)
                return 1
            copies.put(first)

        def test(mutant: Mutant) -> None:
            place = copies.get()
            try:
                result = place.test(mutant)
            finally:
                copies.put(place)
            done[mutant] = bool(result["killed"])
            with options.table.open("a", encoding="utf-8") as table:
                table.write(json.dumps(asdict(mutant) | result | {"pytest": pytest}) + "\n")
            killed = f"killed by {result['by']}" if result["killed"] else "SURVIVED"
            print(f"{mutant.file}:{mutant.line}: {mutant.kind}: {killed}", flush=True)

        with ThreadPoolExecutor(options.jobs) as pool:
            list(pool.map(test, waiting))
    _print_summary(mutants, done)
    return 0


def _print_summary(mutants: list[Mutant], done: dict[Mutant, bool]) -> None:
    killed = sum(done[mutant] for mutant in mutants)
    print(f"\n{killed} of {len(mutants)} mutants killed")
    drawn_of = Counter(mutant.kind for mutant in mutants)
    killed_of = Counter(mutant.kind for mutant in mutants if done[mutant])
    for kind, number in sorted(drawn_of.items()):
        print(f"  {kind:12}{killed_of[kind]:4} of {number}")
    for mutant in mutants:
        if not done[mutant]:
            old, new = (" ".join(text.split()) for text in (mutant.old, mutant.new))
            print(f"survived: {mutant.file}:{mutant.line}: {mutant.kind}: {old}  ->  {new}")


if __name__ == "__main__":
    sys.exit(main())
