"""Calls that are killed half-way: `python -m support.killing CALL` prints what each left, as JSON.

It runs in a process of its own, which has everything imported and no threads: each call is forked
from it, so that hundreds of them are cheap. The current folder has to hold `old.brlpack` and
`new.brlpack`, and a folder `source`, of which `pack` makes the new one.
"""

from __future__ import annotations

import json
import os
import shutil
import signal
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from types import FrameType
from typing import Any

from babyrobot_levels.cli import commands  # noqa: F401
from babyrobot_levels.extensions.packs import build as packing  # noqa: F401  (so that the calls need not import it)
from babyrobot_levels.extensions.packs import store
from babyrobot_levels.extensions.packs.archive import read_archive
from babyrobot_levels.library.packs import packs
from babyrobot_levels.text.files import user_folder
from support.packs import snapshot
from support.sessions import run_here

STEPS = {
    "BufferedWriter.write",
    *(function.__qualname__ for function in (os.mkdir, os.rename, os.replace, os.unlink)),
    *(function.__qualname__ for function in (os.rmdir, os.chmod)),
}
"""The functions that change files."""
OUTPUT = Path("made", "zoo.brlpack")

Call = Callable[[], None]


def install() -> None:
    """Install the new version."""
    store.install(read_archive(Path("new.brlpack")), force=True)


def uninstall() -> None:
    """Take the pack away."""
    store.uninstall("zoo")


def pack() -> None:
    """Pack the source."""
    result = run_here(["pack", "source", "-o", str(OUTPUT), "--force"], dict(os.environ))
    assert result.status == 0


CALLS: dict[str, tuple[Call, bool]] = {
    "upgrade": (install, True),
    "install": (install, False),
    "uninstall": (uninstall, True),
    "pack": (pack, True),
}
"""What is called, and whether the old version is there already."""


def forked(call: Call, at_step: int | None = None) -> bool:
    """Run a call in a process of its own, and say whether it came to its end.

    Args:
        call: what it does.
        at_step: the number of changes of files that it may make before it is killed.
    """
    child = os.fork()
    if child == 0:
        if at_step is not None:
            sys.setprofile(killer(at_step))
        call()
        os._exit(0)
    _, status = os.waitpid(child, 0)
    assert status in (0, signal.SIGKILL), status
    return status == 0


def killer(left: int) -> Callable[[FrameType, str, Any], None]:
    """Return a hook that kills the process as it is about to change one file more than so many."""

    def count(_: FrameType, event: str, called: Any) -> None:
        nonlocal left
        if event == "c_call" and called.__qualname__ in STEPS:
            left -= 1
            if left < 0:
                os.kill(os.getpid(), signal.SIGKILL)

    return count


def prepared(before: Path | None) -> None:
    """Bring all back to what it was before the call."""
    for place in (user_folder(), OUTPUT.parent):
        shutil.rmtree(place, ignore_errors=True)
    if before is not None:
        shutil.copytree(before, user_folder())
        OUTPUT.parent.mkdir()
        shutil.copyfile("old.brlpack", OUTPUT)


def found() -> dict[str, Any]:
    """Return what a reader finds now, and what lies about besides."""
    there = [{"version": each.version, "files": _texts(each.folder)} for each in packs()]
    names = [*_hidden(user_folder()), *_hidden(OUTPUT.parent)]
    output = OUTPUT.read_bytes().hex() if OUTPUT.exists() else None
    return {"packs": there, "remains": names, "output": output}


def _texts(folder: Path) -> dict[str, str]:
    return {name: data.decode() for name, data in snapshot(folder).items() if data is not None}


def _hidden(folder: Path) -> list[str]:
    return [name for name in snapshot(folder) if any(p[0] == "." for p in name.split("/"))]


def outcomes(name: str) -> Iterator[dict[str, Any]]:
    """Yield what is found after each killed call, and at last after one that was left in peace."""
    call, is_there = CALLS[name]
    prepared(None)
    # What the calls import is there from now on.
    pack()
    store.install(read_archive(Path("old.brlpack")))
    before = Path("before")
    shutil.copytree(user_folder(), before)
    start = before if is_there else None
    number, ended = 0, False
    while not ended:
        prepared(start)
        ended = forked(call, at_step=number)
        yield {"how": f"at step {number}", "ended": ended, **found()}
        number += 1
    # What the last call finds is what a killed one has left.
    prepared(start)
    forked(call, at_step=number // 2)
    assert forked(pack if call is pack else install)
    yield {"how": "in peace", "ended": True, **found()}


if __name__ == "__main__":
    # A killed process takes nothing with it that the system has; only a crash of the machine does.
    os.fsync = lambda _: None  # type: ignore[assignment]
    for outcome in outcomes(sys.argv[1]):
        print(json.dumps(outcome))
