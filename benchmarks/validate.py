"""Checking files, as whole processes: `babyrobot validate` beside others for YAML.

    python benchmarks/validate.py

The peers check less: yamllint the writing, check-jsonschema the shape. First one small file, then
a thousand in one process, then the same without the start of the process.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import yaml
from commands import (
    BABYROBOT,
    COUNT,
    SCRIPTS,
    YAMLLINT,
    reading_each,
    running,
    write_levels,
    yamllint_each,
)
from timing import Measure, rounds, table, versions

from babyrobot_levels.level import Level
from babyrobot_levels.reading import read_file

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


def many_files(folder: Path) -> dict[str, Measure]:
    """Return the measures of checking a folder in one process, in files per second."""
    return {
        "babyrobot validate": running(*BABYROBOT, "validate", "--jobs=1", str(folder), worth=COUNT),
        "yamllint": running(*YAMLLINT, str(folder), worth=COUNT),
    }


def without_the_start(folder: Path) -> dict[str, Measure]:
    """Return the same measures inside of this process, and what the parts take at least."""

    def parts(path: Path) -> object:
        data = yaml.load(path.read_text("utf-8"), yaml.CSafeLoader)
        return Level.model_validate(data)

    return {
        "babyrobot_levels.check": reading_each(folder, read_file),
        "yamllint": yamllint_each(folder),
        "libyaml and pydantic, nothing else": reading_each(folder, parts),
    }


def main() -> None:
    """Measure, and print the tables."""
    print(versions(["babyrobot-levels", PEER, "yamllint"]))
    print(table(rounds(one_file()), PEER, "one file, runs per minute"))
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        write_levels(folder)
        files = f"{COUNT} files, files per second"
        print(table(rounds(many_files(folder)), "yamllint", files))
        print(table(rounds(without_the_start(folder)), "yamllint", f"{files}, no start"))


if __name__ == "__main__":
    main()
