"""A process that carries out the calls of tools, and can be ended when one takes too long."""

import multiprocessing
from contextlib import suppress
from multiprocessing.connection import Connection
from pathlib import Path
from threading import Lock
from typing import Any

from babyrobot_levels.extensions.assistants.results import Result
from babyrobot_levels.extensions.assistants.tools import RefusedError, Tools
from babyrobot_levels.parallel.processes import begin, starting
from babyrobot_levels.text.budget import COMMAND, within
from babyrobot_levels.text.errors import BabyRobotError


class Worker:
    """Tools in a process of their own, which begins with the first call.

    Args:
        folder: the folder of the tools.
        seconds: how long a call may take.
    """

    def __init__(self, folder: Path | None, seconds: float) -> None:
        self._folder, self._seconds = folder, seconds
        self._lock = Lock()
        self._process: Any = None
        self._ours: Any = None

    def call(self, tool: str, arguments: dict[str, Any]) -> Result:
        """Carry out a call, when those before it are done.

        Raises:
            RefusedError: the tool refuses it, it takes too long, or the process has ended.
        """
        with self._lock:
            try:
                if self._process is None or not self._process.is_alive():
                    self._start()
                self._ours.send((tool, arguments))
                if self._ours.poll(self._seconds):
                    answer = self._ours.recv()
                else:
                    self._end()
                    raise RefusedError(
                        f"not done within {self._seconds:g} seconds; all plays have ended"
                    )
            except (EOFError, OSError):
                self._end()
                message = "the tools' process has ended, perhaps for want of memory, with all plays"
                raise RefusedError(message) from None
        if isinstance(answer, BaseException):
            raise answer
        result: Result = answer
        return result

    def _start(self) -> None:
        # A fork would copy the locks of the server's threads.
        context = multiprocessing.get_context("spawn")
        self._ours, theirs = context.Pipe()
        self._process = context.Process(target=_serve, args=(theirs, self._folder), daemon=True)
        with starting():
            self._process.start()
        theirs.close()
        # To start it takes seconds on a busy machine, which are not counted.
        self._ours.recv()

    def _end(self) -> None:
        self._process.kill()
        self._process.join()
        self._process = None


def _serve(calls: Connection, folder: Path | None) -> None:
    begin()
    tools = Tools(folder)
    # Ctrl-C, and the end of the server, end this process too.
    with suppress(EOFError, OSError, KeyboardInterrupt):
        calls.send("ready")
        while True:
            tool, arguments = calls.recv()
            answer: Result | Exception
            try:
                with within(COMMAND):
                    answer = getattr(tools, tool)(**arguments)
            except (BabyRobotError, ValueError, OSError, ArithmeticError, ImportError) as error:
                answer = RefusedError(str(error))
            except MemoryError:
                answer = RefusedError("the level takes too much memory")
            calls.send(answer)
