"""Peers that cannot live beside this project, each in a virtual environment of its own."""

from __future__ import annotations

import json
import subprocess
import sys
import venv
from pathlib import Path
from typing import Any

FOLDER = Path(__file__).parent / ".venvs"

BABYROBOT = (
    # It pins old versions of what it needs, and runs with new ones.
    ("--no-deps", "babyrobot==1.0.40"),
    ("numpy", "tqdm", "imageio", "gymnasium", "ipycanvas"),
)


class Peer:
    """A Python of its own that answers questions, one line of JSON each."""

    def __init__(self, name: str, script: Path, *installs: tuple[str, ...]) -> None:
        """Set the environment up, the first time that it is asked for, and start the script.

        Args:
            name: the environment's name.
            script: reads a line of JSON and prints one, again and again.
            installs: the arguments of `pip install`, one call each.
        """
        folder = FOLDER / name
        python = folder / ("Scripts" if sys.platform == "win32" else "bin") / "python"
        if not (folder / "ready").exists():
            print(f"setting up {name} in {folder}", file=sys.stderr)
            venv.create(folder, with_pip=True, clear=True)
            for arguments in installs:
                subprocess.run([python, "-m", "pip", "install", "--quiet", *arguments], check=True)
            (folder / "ready").touch()
        self._process = subprocess.Popen(
            [python, script], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )

    def ask(self, **question: Any) -> Any:
        """Return the script's answer to a question."""
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        print(json.dumps(question), file=self._process.stdin, flush=True)
        return json.loads(self._process.stdout.readline())

    def close(self) -> None:
        """End the script."""
        assert self._process.stdin is not None
        self._process.stdin.close()
        self._process.wait()
