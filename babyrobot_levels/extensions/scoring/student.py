"""The process in which a function of a student runs: it is limited from outside, and not believed.

Answers come as a head, which tells a fault or an array's type and shape, and the array's bytes.
Whatever else comes is a fault of the student's, and so is what takes too much time or memory.
"""

import ctypes
import io
import json
import math
import os
import re
import signal
import socket
import sys
import traceback
from collections.abc import Generator, Iterator, Sequence
from contextlib import contextmanager, suppress
from importlib import import_module
from inspect import signature
from multiprocessing import get_context
from pathlib import Path
from threading import Event
from time import monotonic, sleep
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

MAX_PROCESSES = 64
"""The most processes that a function may have at once."""

MAX_WRITTEN = 256 << 20
"""The most bytes of a file that a function writes."""

NOT_WRITTEN = "it is not written yet"

_HEAD = 4096
"""The bytes of a head."""

_ATTEMPTS = 3
"""How often a process is started, if what forks is ended each time."""

_NOT_KNOWN = 255
"""The exit status of a process whose own one was lost with what forks."""

_CHILD_SUBREAPER = 36
"""Of `prctl(2)`, on Linux."""

_LOOK = 0.1
"""Seconds after which the memory of a process is looked at again."""

Answer = str | NDArray[Any]
"""An array of numbers or names, or a fault."""


class NoAnswerError(BabyRobotError):
    """What a function returns is no answer, or there is no such function."""


def answers(
    code: Path,
    name: str,
    levels: Sequence[Path],
    seconds: float,
    memory: float,
    stop: Event | None = None,
    *,
    shown: bool = True,
) -> Generator[Answer]:
    """Yield the answer of a student's function in each level.

    Args:
        code: the folder of the student, with a file NAME.py.
        name: the name of the function.
        levels: the files of the levels.
        seconds: how long it may take in a level.
        memory: how many GiB it may take, with all processes that it starts. Only Linux limits it.
        stop: tells that answers are no longer wanted.
        shown: whether the beginning of what it prints is written to standard error.

    Raises:
        RuntimeError: the process does not start.
        InterruptedError: they are no longer wanted.
    """
    with _started(code, name, levels, memory, shown) as (process, ours):
        last = ""
        for level in levels:
            if last:
                yield f"it was not run, as {last}"
                continue
            try:
                yield _answer(ours, process, monotonic() + seconds, memory, stop or Event())
            except TimeoutError:
                last = f"it took too long in {level.stem}"
                yield f"it took longer than {seconds:g} seconds"
            except MemoryError:
                last = f"it took too much memory in {level.stem}"
                yield _too_much(memory)
            except ChildProcessError:
                last = f"it started too many processes in {level.stem}"
                yield f"it started more than {MAX_PROCESSES} processes"
            except InterruptedError:
                raise
            except (EOFError, OSError):
                last = f"its process ended in {level.stem}"
                yield "its process ended, perhaps for want of memory"
            except Exception:
                last = f"its answer in {level.stem} is none"
                yield "its answer cannot be read"


@contextmanager
def _started(
    code: Path, name: str, levels: Sequence[Path], memory: float, shown: bool
) -> Iterator[tuple[Any, socket.socket]]:
    """Start the process, and end it with all that it started."""
    for _ in range(_ATTEMPTS):
        process, ours = _start(code, name, levels, memory)
        if process is not None:
            break
        ours.close()
    else:
        raise RuntimeError("the processes for students' code do not start")
    with ours:
        try:
            with Path(os.devnull).open("wb") as nowhere:
                # What forks may have begun elsewhere, and has another standard error.
                if sys.platform != "win32":
                    socket.send_fds(ours, [b"!"], [2 if shown else nowhere.fileno()])
            yield process, ours
        finally:
            _end(process)


def _start(
    code: Path, name: str, levels: Sequence[Path], memory: float
) -> tuple[Any, socket.socket]:
    """Return a process that has begun; None in its place if what forks was ended meanwhile.

    Raises:
        RuntimeError: it cannot begin.
    """
    ours, theirs = socket.socketpair()
    # Forks of a process that has imported everything begin in no time; elsewhere they may fail.
    context: Any = get_context("forkserver" if sys.platform == "linux" else "spawn")
    if sys.platform == "linux":
        context.set_forkserver_preload([__name__, "babyrobot_levels.envs.single"])
    process = context.Process(target=_run, args=(code, name, levels, memory, theirs), daemon=True)
    try:
        with theirs, starting():
            process.start()
        if ours.recv(1):
            return process, ours
        process.join()
    except (OSError, EOFError):
        return None, ours
    # A student's code can end what forks: it has the same user.
    if process.exitcode == _NOT_KNOWN:
        return None, ours
    raise RuntimeError(
        "the process for the student's code did not start; in a script, grade below "
        '`if __name__ == "__main__":`'
    )


def _end(process: Any) -> None:
    """End a process with all that it started, and what these did."""
    with suppress(OSError, AttributeError):
        # What cannot go on starts nothing more, and keeps what others leave.
        os.kill(process.pid, signal.SIGSTOP)
    until = monotonic() + 2
    while (others := _family(process.pid).keys() - {process.pid}) and monotonic() < until:
        for other in others:
            with suppress(OSError):
                os.kill(other, signal.SIGKILL)
        sleep(0.001)
    # `process.kill` takes it for ended where what forks has been.
    with suppress(OSError, AttributeError):
        os.kill(process.pid, signal.SIGKILL)
    process.kill()
    process.join()


def _answer(ours: socket.socket, process: Any, until: float, memory: float, stop: Event) -> Answer:
    def read(size: int) -> bytes:
        found, look = bytearray(), monotonic() + _LOOK
        while len(found) < size:
            if stop.is_set():
                raise InterruptedError
            if monotonic() > until:
                raise TimeoutError
            if monotonic() > look:
                look = monotonic() + _LOOK
                family = _family(process.pid)
                if len(family) > MAX_PROCESSES:
                    raise ChildProcessError
                if sum(family.values()) > memory * 2**30:
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


def _family(first: int) -> dict[int, int]:
    """Return the bytes of memory of a process, of its session, and of all that they started.

    What processes share counts for each. It is empty where the system does not tell.
    """
    found: dict[int, tuple[int, int, int]] = {}
    for place in Path("/proc").glob("[0-9]*"):
        with suppress(OSError, ValueError, IndexError):
            # Behind the name, which may have spaces: state, parent, group, session, ...
            told = (place / "stat").read_text("utf-8", "replace").rpartition(")")[2].split()
            if told[0] not in "ZX":
                found[int(place.name)] = int(told[1]), int(told[3]), int(told[21])
    family, size = {first}, 0
    while size < len(family):
        size = len(family)
        family |= {
            number
            for number, (parent, session, _) in found.items()
            if session == first or parent in family
        }
    page = os.sysconf("SC_PAGE_SIZE") if found else 0
    return {each: found[each][2] * page for each in family if each in found}


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
        resource.setrlimit(resource.RLIMIT_FSIZE, (MAX_WRITTEN,) * 2)
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    with suppress(OSError, AttributeError):
        # What its children leave behind becomes its own child: so it is found, and ended.
        ctypes.CDLL(None).prctl(_CHILD_SUBREAPER, 1, 0, 0, 0)
    to.sendall(b"!")
    if sys.platform != "win32":
        os.dup2(socket.recv_fds(to, 1, 1)[1][0], 2)
    sys.stdout = sys.stderr = _Output()  # noqa: TID251  (those of the student)
    with Path(os.devnull).open("wb") as nowhere:
        os.dup2(nowhere.fileno(), 1)
        os.dup2(nowhere.fileno(), 2)
    sys.path.insert(0, str(code))
    sys.modules.pop(name, None)
    os.chdir(code)
    for level in levels:
        head: Any
        data = b""
        try:
            table = _table(_function(name)(world_of(level)))
            head, data = (table.dtype.str, table.shape), table.tobytes()
        except NotImplementedError:
            head = NOT_WRITTEN
        except NoAnswerError as error:
            head = str(error)
        except MemoryError as error:
            head = _too_much(memory) + _place(error, code)
        except BaseException as error:
            said = [f"{type(error).__name__}{_place(error, code)}", str(error), _help(error)]
            head = ": ".join(filter(None, said))
        if isinstance(head, str):
            # The longest that has room in a head, whatever it consists of.
            head = head[:500]
        text = json.dumps(head, ensure_ascii=False).encode("utf-8", "replace")
        to.sendall(text.ljust(_HEAD) + data)
    # It is ended with all that it started; what it left behind would have no parent any more.
    to.recv(1)


def _function(name: str) -> Any:
    """Return the function of the student.

    Raises:
        NoAnswerError: there is none, or it does not take a level alone.
    """
    found = getattr(import_module(name), name, None)
    if not callable(found):
        help_text = f"write `def {name}(level):` at the left margin"
        raise NoAnswerError(f"{name}.py has no function {name}: {help_text}")
    with suppress(ValueError):
        told = signature(found)
        try:
            told.bind(None)
        except TypeError:
            wanted = f"`def {name}(level):`, as it is called with the level alone"
            raise NoAnswerError(f"it is `def {name}{told}:`: write {wanted}") from None
    return found


_HELP = {
    ModuleNotFoundError: "it is neither among the files that were handed in nor installed here",
    FileNotFoundError: "only what was handed in is there",
    EOFError: "nobody can type while it is graded",
    SystemExit: "`return` the answer, and do not end Python",
}
"""What to do about errors that are of the place where code is graded."""


def _help(error: BaseException) -> str:
    if "read-only" in str(error):
        return "the tables of a level cannot be changed, but copied"
    return _HELP.get(type(error), "")


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


def checked_table(answer: Any) -> Answer:
    """Return an answer as an array, or why it is none."""
    try:
        return _table(answer)
    except NoAnswerError as error:
        return str(error)


def _table(answer: Any) -> NDArray[Any]:
    """Return an answer as an array.

    Raises:
        NoAnswerError: it is none.
    """
    if answer is None:
        raise NoAnswerError("it returns nothing: it has to end with `return`")
    try:
        table = np.asarray(answer)
        if table.dtype == object:
            table = np.asarray(table.tolist())
    except ValueError:
        raise NoAnswerError("it returns rows that differ in length") from None
    if table.dtype.kind not in "biufU":
        kinds = [type(each).__name__ for each in (answer, table.ravel()[0])]
        told = " of ".join(kinds if table.ndim else kinds[1:])
        raise NoAnswerError(f"it returns a {told}: return an array, a number for each state")
    _size(table.dtype.str, table.shape)
    return table


def _place(error: BaseException, code: Path) -> str:
    """Return the place in the student's code at which an error was raised."""
    frames = traceback.extract_tb(error.__traceback__)
    own = [frame for frame in frames if code in Path(frame.filename).parents]
    return f" in {Path(own[-1].filename).name}, line {own[-1].lineno}" if own else ""
