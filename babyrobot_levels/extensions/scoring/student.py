"""The process in which a function of a student runs: it is limited from outside, and not believed.

Answers come as a head, which tells a fault or an array's type and shape, and the array's bytes.
Whatever else comes is a fault of the student's, and so is what takes too much time or memory.
"""

import io
import json
import math
import os
import re
import signal
import socket
import sys
import traceback
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from importlib import import_module
from multiprocessing import get_context
from pathlib import Path
from time import monotonic
from typing import Any

import numpy as np
from numpy.typing import NDArray

from babyrobot_levels.mdp.gridworld import world_of
from babyrobot_levels.parallel.processes import begin, starting
from babyrobot_levels.text.errors import BabyRobotError
from babyrobot_levels.text.source import printable

MAX_ANSWER = 64 << 20
"""The most bytes of an answer, with 8 for each number, also of an array that has none."""

MAX_PRINTED = 10_000
"""The most characters of what a function prints that are shown."""

_HEAD = 4096
"""The bytes of a head."""

_LOOK = 0.1
"""Seconds after which the memory of a process is looked at again."""

Answer = str | NDArray[Any]
"""An array of numbers or names, or a fault."""


class NoAnswerError(BabyRobotError):
    """What a function returns is no answer, or there is no such function."""


def answers(
    code: Path, name: str, levels: Sequence[Path], seconds: float, memory: float
) -> Iterator[Answer]:
    """Yield the answer of a student's function in each level.

    Args:
        code: the folder of the student, with a file NAME.py.
        name: the name of the function.
        levels: the files of the levels.
        seconds: how long it may take in a level.
        memory: how many GiB it may take, with all processes that it starts. Only Linux limits it.

    Raises:
        RuntimeError: the process does not start.
    """
    with _started(code, name, levels, memory) as (process, ours):
        last = ""
        for level in levels:
            if last:
                yield f"it was not run, as {last}"
                continue
            try:
                yield _answer(ours, process, monotonic() + seconds, memory)
            except TimeoutError:
                last = f"it took too long in {level.stem}"
                yield f"it took longer than {seconds:g} seconds"
            except MemoryError:
                last = f"it took too much memory in {level.stem}"
                yield _too_much(memory)
            except (EOFError, OSError):
                last = f"its process ended in {level.stem}"
                yield "its process ended, perhaps for want of memory"
            except Exception:
                last = f"its answer in {level.stem} is none"
                yield "its answer cannot be read"


@contextmanager
def _started(
    code: Path, name: str, levels: Sequence[Path], memory: float
) -> Iterator[tuple[Any, socket.socket]]:
    """Start the process, and end it with all that it started."""
    ours, theirs = socket.socketpair()
    context = get_context("spawn")
    process = context.Process(target=_run, args=(code, name, levels, memory, theirs), daemon=True)
    with ours:
        with theirs, starting():
            process.start()
        try:
            if not ours.recv(1):
                raise RuntimeError(
                    "the process for the student's code did not start; in a script, grade below "
                    '`if __name__ == "__main__":`'
                )
            yield process, ours
        finally:
            process.kill()
            process.join()
            for other in _family(process.pid or 0):
                with suppress(OSError):
                    os.kill(other, signal.SIGKILL)


def _answer(ours: socket.socket, process: Any, until: float, memory: float) -> Answer:
    def read(size: int) -> bytes:
        found, look = bytearray(), monotonic() + _LOOK
        while len(found) < size:
            if monotonic() > until:
                raise TimeoutError
            if monotonic() > look:
                look = monotonic() + _LOOK
                if _memory(process.pid) > memory * 2**30:
                    raise MemoryError
            with suppress(TimeoutError):
                part = ours.recv(min(size - len(found), 1 << 20))
                if not part:
                    raise EOFError
                found += part
        return bytes(found)

    ours.settimeout(_LOOK)
    head = json.loads(read(_HEAD))
    if isinstance(head, str):
        return head
    kind, shape = head
    return np.ndarray(shape, kind, read(_size(kind, shape)))


def _size(kind: str, shape: Sequence[int]) -> int:
    """Return the bytes of an array.

    Raises:
        NoAnswerError: it is none of numbers or names, or is too large.
    """
    if not re.fullmatch(r"[<>|][biufU]\d+", kind):
        raise NoAnswerError("it returns no array of numbers")
    width, cells = np.dtype(kind).itemsize, math.prod(max(1, side) for side in shape)
    if cells * max(8, width) > MAX_ANSWER:
        raise NoAnswerError(f"its answer is too large, an array of shape {[*shape]}")
    return 0 if 0 in shape else cells * width


def _family(session: int) -> Iterator[int]:
    """Yield the processes of a session; none where the system does not tell."""
    for place in Path("/proc").glob("[0-9]*"):
        with suppress(OSError):
            if os.getsid(int(place.name)) == session:
                yield int(place.name)


def _memory(session: int) -> int:
    """Return the bytes of memory that a session has, also what its processes share."""
    pages = 0
    for process in _family(session):
        with suppress(OSError):
            pages += int(Path(f"/proc/{process}/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") if pages else 0


def _too_much(memory: float) -> str:
    return f"it took more than {memory:g} GiB of memory"


# -- in the process of the student ---------------------------------------------------------


def _run(code: Path, name: str, levels: Sequence[Path], memory: float, to: socket.socket) -> None:
    """Run a function in each level."""
    begin()
    if sys.platform != "win32":
        os.setsid()
    with suppress(ImportError, ValueError, OSError):
        import resource

        # It is told where the memory is asked for; what is shared does not count in it.
        resource.setrlimit(resource.RLIMIT_DATA, (int(memory * 2**30),) * 2)
    sys.stdout = sys.stderr = _Output()  # noqa: TID251  (those of the student)
    with Path(os.devnull).open("wb") as nowhere:
        os.dup2(nowhere.fileno(), 1)
        os.dup2(nowhere.fileno(), 2)
    sys.path.insert(0, str(code))
    sys.modules.pop(name, None)
    os.chdir(code)
    to.sendall(b"!")
    for level in levels:
        head: Any
        data = b""
        try:
            function = getattr(import_module(name), name, None)
            if not callable(function):
                raise NoAnswerError(f"{name}.py has no function {name}")
            table = _table(function(world_of(level)))
            head, data = (table.dtype.str, table.shape), table.tobytes()
        except NotImplementedError:
            head = "it is not written yet"
        except NoAnswerError as error:
            head = str(error)
        except MemoryError as error:
            head = _too_much(memory) + _place(error, code)
        except BaseException as error:
            head = f"{type(error).__name__}{_place(error, code)}: {error}"
        if isinstance(head, str):
            # The longest that has room in a head, whatever it consists of.
            head = head[:500]
        text = json.dumps(head, ensure_ascii=False).encode("utf-8", "replace")
        to.sendall(text.ljust(_HEAD) + data)


class _Output(io.TextIOBase):
    """Shows the beginning of what a function prints, with control characters as escapes."""

    def __init__(self) -> None:
        self._to, self._left = os.dup(2), MAX_PRINTED

    def write(self, text: str) -> int:
        shown = printable(text)[: self._left]
        self._left -= len(shown)
        if shown:
            more = "" if self._left else "\n… what else it prints is not shown\n"
            os.write(self._to, (shown + more).encode("utf-8", "backslashreplace"))
        return len(text)


def _table(answer: Any) -> NDArray[Any]:
    """Return an answer as an array.

    Raises:
        NoAnswerError: it is none.
    """
    if answer is None:
        raise NoAnswerError("it returns nothing: it has to end with `return`")
    try:
        table = np.asarray(answer)
    except ValueError:
        raise NoAnswerError("it returns rows that differ in length") from None
    if table.dtype.kind not in "biufU":
        raise NoAnswerError(f"it returns a {type(answer).__name__}, not an array of numbers")
    _size(table.dtype.str, table.shape)
    return table


def _place(error: BaseException, code: Path) -> str:
    """Return the place in the student's code at which an error was raised."""
    frames = traceback.extract_tb(error.__traceback__)
    own = [frame for frame in frames if code in Path(frame.filename).parents]
    return f" in {Path(own[-1].filename).name}, line {own[-1].lineno}" if own else ""
