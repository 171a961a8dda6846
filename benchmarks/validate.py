"""Checking files, as whole processes: `babyrobot validate` beside others for YAML.

    python benchmarks/validate.py

The peers check less: yamllint the writing, check-jsonschema the shape. All start a fresh Python,
and check one small file, then a thousand.
"""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path

import yaml
from commands import BABYROBOT, COUNT, SCRIPTS, YAMLLINT, level_text, running, write_levels
from timing import Measure, rounds, table, versions

from babyrobot_levels.level import Level

ROOT = Path(__file__).parents[1]
LEVEL = ROOT / "levels" / "final-maze.yaml"
SCHEMA = ROOT / "schemas" / "level.schema.json"
PEER = "check-jsonschema"


def one_file() -> dict[str, Measure]:
    """Return the measures of checking one small file, in runs per minute."""
    check = (str(SCRIPTS / PEER), "--schemafile", str(SCHEMA), str(LEVEL))
    return {
        "babyrobot validate": running(*BABYROBOT, "validate", str(LEVEL), worth=60),
        PEER: running(*check, worth=60),
        "yamllint": running(*YAMLLINT, str(LEVEL), worth=60),
        "python -c pass": running(sys.executable, "-c", "pass", worth=60),
    }


def many_files(folder: str) -> dict[str, Measure]:
    """Return the measures of checking a folder in one process, in files per second."""
    texts = [level_text(number) for number in range(COUNT)]

    def parts() -> float:
        begin = time.perf_counter()
        for text in texts:
            Level.model_validate(yaml.load(text, yaml.CSafeLoader))
        return COUNT / (time.perf_counter() - begin)

    return {
        "babyrobot validate": running(*BABYROBOT, "validate", folder, worth=COUNT),
        "yamllint": running(*YAMLLINT, folder, worth=COUNT),
        "libyaml and pydantic alone, without places": parts,
    }


def main() -> None:
    """Measure, and print the tables."""
    print(versions(["babyrobot-levels", PEER, "yamllint"]))
    print(table(rounds(one_file()), PEER, "one file, runs per minute"))
    with tempfile.TemporaryDirectory() as folder:
        write_levels(Path(folder))
        print(table(rounds(many_files(folder)), "yamllint", f"{COUNT} files, files per second"))


if __name__ == "__main__":
    main()
