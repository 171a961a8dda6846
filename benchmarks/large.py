"""The largest levels, as whole processes: how time and memory grow with the number of cells.

    python benchmarks/large.py

Mazes and open levels of 256, 512 and 1024 cells a side, and short files that ask for large tables.
Seconds are those of the processor, the start of Python included; nothing comparable is known.
"""

from __future__ import annotations

import json
import math
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import report
from commands import BABYROBOT
from timing import Comparison, installed

SIDES = (256, 512, 1024)
SECONDS = {"validate": 2, "lint": 5, "show": 5}
"""How long a level may take, whatever is in its file."""

KINDS: dict[str, dict[str, Any]] = {"maze": {"maze": {"seed": 1}}, "open": {}}
SHORT: dict[str, dict[str, Any]] = {
    "a wanderer in 31x31": {
        "size": [31, 31],
        "movers": [{"within": {"at": [0, 0], "size": [31, 31]}}],
    },
    "a row of doors in 1024x1024": {
        "size": [1024, 1024],
        "doors": [{"at": [0, 0], "side": "E", "length": 1024}],
    },
    "skids in 1024x1024": {"size": [1024, 1024], "skid": {"probability": 0.5, "to": "others"}},
    "wind in 1024x1024": {"size": [1024, 1024], "wind": {"north": [1023] * 1024}},
}


def cost(command: str, fields: dict[str, Any]) -> tuple[float, int]:
    """Return the seconds and the MiB that a command takes for a level."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "level.json"
        file.write_text(json.dumps({"version": 1, **fields}), "utf-8")
        process = subprocess.Popen([*BABYROBOT, command, str(file)], stdout=subprocess.DEVNULL)
        _, _, usage = os.wait4(process.pid, 0)
    # Linux counts kilobytes here, macOS bytes.
    memory = usage.ru_maxrss >> (20 if sys.platform == "darwin" else 10)
    return usage.ru_utime + usage.ru_stime, memory


def compare(count: int) -> Iterator[Comparison]:
    """Measure each command once for each level: it takes long enough."""
    versions = installed("babyrobot-levels", "numpy", "scipy")
    for command, most in SECONDS.items():
        start, _ = cost(command, {"size": [3, 3]})
        rates, notes = {}, []
        for kind, fields in KINDS.items():
            took = [cost(command, {"size": [side, side], **fields}) for side in SIDES]
            seconds, memory = took[-1]
            # Four times as many cells: this power of them, without the start of the process.
            growth = math.log(max(seconds - start, 0.01) / max(took[-2][0] - start, 0.01), 4)
            name = f"{command}, {kind}, {SIDES[-1]}x{SIDES[-1]}"
            rates[name] = [SIDES[-1] ** 2 / seconds]
            notes.append(f"{name}: {seconds:.1f} s, {memory} MiB, cells to the power {growth:.2f}")
        for name, fields in SHORT.items():
            seconds, memory = cost(command, fields)
            notes.append(f"{command}, {name}: {seconds:.1f} s, {memory} MiB")
        yield Comparison(
            f"cells per second, babyrobot {command}",
            rates,
            aims={(name, None): SIDES[-1] ** 2 / most for name in rates},
            versions=versions,
            note="; ".join(notes),
        )


if __name__ == "__main__":
    report.main(__doc__, compare)
