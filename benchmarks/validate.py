"""Checking one small file, as whole processes: `babyrobot validate` beside others for YAML.

    python benchmarks/validate.py

The peers check less: yamllint the writing, check-jsonschema the shape. All start a fresh Python.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
import time
from pathlib import Path

from timing import Measure, rounds, table, versions

ROOT = Path(__file__).parents[1]
LEVEL = ROOT / "levels" / "final-maze.yaml"
SCHEMA = ROOT / "schemas" / "level.schema.json"
PEER = "check-jsonschema"


def running(*command: str) -> Measure:
    """Return a measure of how often a second the command could run, one after the other."""

    def measure() -> float:
        begin = time.perf_counter()
        # From an empty folder, so that no peer reads a configuration of ours.
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run(command, check=True, cwd=folder, capture_output=True)
        return 1 / (time.perf_counter() - begin)

    return measure


def main() -> None:
    """Measure, and print the table."""
    scripts = Path(sys.executable).parent
    yaml_rules = "{extends: relaxed}"
    measures = {
        "babyrobot validate": running(
            sys.executable, "-m", "babyrobot_levels", "validate", str(LEVEL)
        ),
        PEER: running(str(scripts / PEER), "--schemafile", str(SCHEMA), str(LEVEL)),
        "yamllint": running(str(scripts / "yamllint"), "-d", yaml_rules, str(LEVEL)),
        "python -c pass": running(sys.executable, "-c", "pass"),
    }
    rates = rounds(measures)
    print(versions(["babyrobot-levels", PEER, "yamllint"]))
    print(table(rates, PEER, "runs per second"))


if __name__ == "__main__":
    main()
