"""A Jupyter kernel, and what it puts out cell by cell.

Run as a program, in a process of its own, because kernels leave sockets open: it reads cells of
code as JSON, and prints for each cell what the kernel sent.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

from jupyter_client.kernelspec import KernelSpecManager
from jupyter_client.manager import KernelManager

from support.places import TESTS
from support.subprocesses import HOME

Message = tuple[str, dict[str, Any]]
"""The kind and the content of a message."""


def run_cells(*cells: str, person: bool, home: Path) -> list[list[Message]]:
    """Run cells in a fresh kernel; return the messages that each of them has it send.

    Args:
        cells: the code.
        person: whether to say, as programs do not, that `input()` would be answered.
        home: an empty folder.
    """
    done = subprocess.run(
        [sys.executable, __file__, "person" if person else "program"],
        input=json.dumps(cells),
        cwd=home,
        env={
            **os.environ,
            "HOME": str(home),
            "IPYTHONDIR": str(home),
            "PYTHONPATH": os.pathsep.join([str(HOME), str(TESTS)]),
        },
        capture_output=True,
        text=True,
        encoding="utf-8",
        timeout=120,
        check=False,
    )
    assert done.returncode == 0, done.stderr[-4000:]
    return [[(kind, content) for kind, content in cell] for cell in json.loads(done.stdout)]


def main() -> None:
    """Run what `run_cells` asks for."""
    # Told no folders, the manager knows only the kernel of the running interpreter.
    manager = KernelManager(kernel_spec_manager=KernelSpecManager(kernel_dirs=[]))
    manager.start_kernel(stderr=subprocess.DEVNULL)
    client = manager.client()
    client.start_channels()
    client.wait_for_ready(timeout=60)
    found: list[list[Message]] = []
    for cell in json.load(sys.stdin):
        messages: list[Message] = []
        client.execute_interactive(
            cell,
            allow_stdin=sys.argv[1] == "person",
            stdin_hook=lambda _: None,
            output_hook=lambda message, seen=messages: seen.append(
                (message["msg_type"], message["content"])
            ),
            timeout=60,
        )
        found.append(messages)
    client.stop_channels()
    manager.shutdown_kernel(now=True)
    print(json.dumps(found))


if __name__ == "__main__":
    main()
