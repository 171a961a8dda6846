"""One at a time: whoever changes the packs in a folder holds its lock."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

LOCK = ".lock"


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Hold a folder's lock, having made the folder; wait for it if somebody else does.

    The system gives the lock back when its holder ends, in whatever way. Afterwards neither lock
    nor folder stay behind if there is nothing in the folder.
    """
    path = folder / LOCK
    descriptor = _opened(path)
    try:
        yield
    finally:
        with suppress(OSError):
            # Windows keeps a file that is open, which does no harm.
            path.unlink()
            folder.rmdir()
            folder.parent.rmdir()
        os.close(descriptor)


def _opened(path: Path) -> int:
    """Return the lock file's descriptor, locked."""
    while True:
        path.parent.mkdir(parents=True, exist_ok=True)
        with suppress(FileNotFoundError):
            # A link that leads nowhere would never be there.
            flags = os.O_RDWR | os.O_CREAT | getattr(os, "O_NOFOLLOW", 0)
            descriptor = os.open(path, flags, 0o666)
            try:
                _wait(descriptor)
                # Whoever had it may have taken the file away, and others a new one.
                if os.path.samestat(os.fstat(descriptor), path.stat()):
                    return descriptor
            except BaseException:
                os.close(descriptor)
                raise
            os.close(descriptor)


if sys.platform == "win32":
    import msvcrt
    import time

    def _wait(descriptor: int) -> None:
        while True:
            try:
                msvcrt.locking(descriptor, msvcrt.LK_NBLCK, 1)
            except PermissionError:
                time.sleep(0.05)
            else:
                return
else:
    import fcntl

    def _wait(descriptor: int) -> None:
        fcntl.flock(descriptor, fcntl.LOCK_EX)
