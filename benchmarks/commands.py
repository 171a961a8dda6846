"""Commands to measure as whole processes, and a folder of files for them to check."""

from __future__ import annotations

import atexit
import os
import random
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from functools import cache
from importlib import import_module
from pathlib import Path

from timing import Measure, MissingPeer

SCRIPTS = Path(sys.executable).parent
BABYROBOT = (sys.executable, "-m", "babyrobot_levels")
YAMLLINT_RULES = "{extends: relaxed}"
YAMLLINT = (str(SCRIPTS / "yamllint"), "-d", YAMLLINT_RULES)
COUNT = 1000
FILES = f"{COUNT} files, files per second"


def running(*command: str, worth: float = 1) -> Measure:
    """Return a measure that runs a command.

    Args:
        command: the command and its arguments. It must succeed.
        worth: how many things it does, for the rate.
    """

    # As installed packages have it: what was imported once need not be compiled again.
    variables = {**os.environ, "PYTHONPYCACHEPREFIX": _compiled()}
    variables.pop("PYTHONDONTWRITEBYTECODE", None)

    def measure() -> float:
        # From an empty folder, so that no peer reads a configuration of ours.
        with tempfile.TemporaryDirectory() as folder:
            begin = time.perf_counter()
            try:
                subprocess.run(command, check=True, cwd=folder, env=variables, capture_output=True)
            except FileNotFoundError:
                raise MissingPeer(f"{Path(command[0]).name} is not installed") from None
            return worth / (time.perf_counter() - begin)

    return measure


def reading_each(folder: Path, look: Callable[[Path], object]) -> Measure:
    """Return a measure of looking at the files of a folder inside of this process."""

    def measure() -> float:
        begin = time.perf_counter()
        for path in folder.iterdir():
            look(path)
        return COUNT / (time.perf_counter() - begin)

    return measure


def yamllint_each(folder: Path) -> Measure:
    """Return the measure of yamllint inside of this process."""

    def measure() -> float:
        try:
            linter, config = import_module("yamllint.linter"), import_module("yamllint.config")
        except ModuleNotFoundError:
            raise MissingPeer("yamllint is not installed") from None
        rules = config.YamlLintConfig(YAMLLINT_RULES)
        return reading_each(folder, lambda path: list(linter.run(path.read_text("utf-8"), rules)))()

    return measure


@cache
def _compiled() -> str:
    """Return the folder for compiled modules, the same for all commands, until the end."""
    folder = tempfile.mkdtemp()
    atexit.register(shutil.rmtree, folder)
    return folder


def write_levels(folder: Path) -> None:
    """Write `COUNT` levels of 25 lines, no two alike, into a folder."""
    for number in range(COUNT):
        path = folder / f"level-{number:03}.yaml"
        path.write_text(level_text(number), encoding="utf-8")


def level_text(number: int) -> str:
    """Return a level of 25 lines that is clean in the eyes of all who check it."""
    rng = random.Random(number)
    width, height = rng.randint(9, 12), rng.randint(9, 12)
    # Walls on odd cells and all else on even ones, so that nothing meets and nothing is in vain.
    odd, even = ([[x, y] for y in range(n, 8, 2) for x in range(n, 8, 2)] for n in (1, 2))
    walled, wet = rng.sample(odd, 4), rng.sample(even, 5)
    walls = [f"  - {{at: {cell}, side: {rng.choice('ES')}}}" for cell in walled]
    puddles = [f"  - {{at: {cell}, size: {rng.choice(['small', 'large'])}}}" for cell in wet[:4]]
    lines = [
        "# yaml-language-server: $schema=level.schema.json",
        "version: 1",
        f"name: level-{number:03}",
        f"title: Level number {number}",
        f"description: A world of {width} by {height} cells with walls and puddles.",
        "author: nobody",
        "tags: [small, benchmark]",
        f"size: [{width}, {height}]",
        "start: [0, 0]",
        f"exit: [{width - 1}, {height - 1}]",
        "walls:",
        *walls,
        "puddles:",
        *puddles,
        "areas:",
        f"  - {{at: {wet[4]}, color: yellow, reward: -{rng.randint(2, 9)}}}",
        "rewards:",
        "  bump: -2",
        "max_steps: 500",
    ]
    return "\n".join(lines) + "\n"
