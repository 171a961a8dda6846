"""Peers that cannot live beside this project, each in a virtual environment of its own."""

from __future__ import annotations

import json
import subprocess
import sys
import venv
from functools import cache
from pathlib import Path
from typing import Any

from timing import MissingPeer

HERE = Path(__file__).parent
FOLDER = HERE / ".venvs"

INSTALLS: dict[str, tuple[tuple[str, ...], ...]] = {
    # It pins old versions of what it needs, and runs with new ones.
    "babyrobot": (
        ("--no-deps", "babyrobot==1.0.40"),
        ("numpy", "tqdm", "imageio", "gymnasium", "ipycanvas"),
    ),
    "envpool": (("envpool", "gymnasium"),),
    "gym-sokoban": (("gym-sokoban==0.0.6",),),
    "mazelib": (("mazelib==0.9.16",),),
    "mdpsolver": (("mdpsolver==0.10.2", "numpy"),),
    "minigrid": (("minigrid==3.2.0",),),
    "stormpy": (("stormpy==2.0.0",),),
}
"""For each peer, the arguments of `pip install`, one call each."""


class Peer:
    """A Python of its own that answers questions, one line of JSON each."""

    def __init__(self, name: str, script: str) -> None:
        """Name the peer, one of `INSTALLS`, and the script beside this one that asks it.

        The script reads a line of JSON and prints one, again and again. It starts with the first
        question.
        """
        self.name = name
        self._script = HERE / script
        self._process: subprocess.Popen[str] | None = None

    @property
    def version(self) -> dict[str, str]:
        """The peer's version by its name; nothing if it is missing."""
        asked = f"from importlib.metadata import version; print(version({self.name!r}))"
        try:
            python = python_with(self.name)
            done = subprocess.run([python, "-c", asked], check=True, capture_output=True, text=True)
        except (MissingPeer, subprocess.CalledProcessError):
            return {}
        return {self.name: done.stdout.strip()}

    def ask(self, **question: Any) -> Any:
        """Return the script's answer to a question.

        Raises:
            MissingPeer: the peer cannot be installed.
            RuntimeError: it ended without an answer.
        """
        if self._process is None:
            command = [python_with(self.name), self._script]
            self._process = subprocess.Popen(
                command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
            )
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        try:
            print(json.dumps(question), file=self._process.stdin, flush=True)
            return json.loads(self._process.stdout.readline())
        except (BrokenPipeError, ValueError):
            message = f"{self.name} ended without an answer ({self._script.name})"
            raise RuntimeError(message) from None

    def close(self) -> None:
        """End the script."""
        if self._process is not None:
            self._process.communicate()


def python_with(name: str) -> Path:
    """Return the Python of a peer's environment, which the first call sets up.

    Raises:
        MissingPeer: it cannot be installed.
    """
    why = _set_up(name)
    if why is not None:
        raise MissingPeer(why)
    return _python(name)


@cache
def _set_up(name: str) -> str | None:
    """Set a peer's environment up, unless it is there; return why that cannot be done."""
    folder = FOLDER / name
    if (folder / "ready").exists():
        return None
    print(f"setting up {name} in {folder}", file=sys.stderr)
    try:
        venv.create(folder, with_pip=True, clear=True)
        for arguments in INSTALLS[name]:
            pip = ("-m", "pip", "install", "--quiet", *arguments)
            subprocess.run([_python(name), *pip], check=True, capture_output=True, text=True)
    except subprocess.CalledProcessError as error:
        lines = str(error.stderr or error.stdout or error).strip().splitlines()
        return f"{name} cannot be installed ({lines[-1] if lines else error})"
    except OSError as error:
        return f"{name} cannot be installed ({error})"
    (folder / "ready").touch()
    return None


def _python(name: str) -> Path:
    windows = sys.platform == "win32"
    return (
        FOLDER / name / ("Scripts" if windows else "bin") / ("python.exe" if windows else "python")
    )
