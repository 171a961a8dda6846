"""Checking files, as whole processes: `babyrobot validate` beside others for YAML.

    python benchmarks/validate.py

The peers check less: yamllint the writing, check-jsonschema the shape. First one small file, then
a thousand in one process, then the same without the start of the process.
"""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import report
import yaml
from commands import (
    BABYROBOT,
    COUNT,
    FILES,
    SCRIPTS,
    YAMLLINT,
    reading_each,
    running,
    write_levels,
    yamllint_each,
)
from timing import Comparison, compare_in_turns, installed

from babyrobot_levels.library.level import Level, load_file

ROOT = Path(__file__).parents[1]
LEVEL = ROOT / "levels" / "final-maze.yaml"
SCHEMA = ROOT / "schemas" / "level.schema.json"
LOADING = "brl.load"
COMMAND, SHAPE = "babyrobot validate", "check-jsonschema"


def parts(path: Path) -> object:
    """Read and validate a level with what checking one is made of, and nothing else."""
    data = yaml.load(path.read_text("utf-8"), yaml.CSafeLoader)
    return Level.model_validate(data)


def compare(count: int) -> Iterator[Comparison]:
    """Measure one small file, a folder in one process, and the same without its start."""
    versions = installed("babyrobot-levels", SHAPE, "yamllint")
    schema = ("--schemafile", str(SCHEMA))
    yield compare_in_turns(
        "one file, runs per minute",
        {COMMAND: running(*BABYROBOT, "validate", str(LEVEL), worth=60)},
        {
            SHAPE: running(str(SCRIPTS / SHAPE), *schema, str(LEVEL), worth=60),
            "yamllint": running(*YAMLLINT, str(LEVEL), worth=60),
            "python -c pass": running(sys.executable, "-c", "pass", worth=60),
        },
        count,
        aims={(COMMAND, SHAPE): 1},
        versions=versions,
    )
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        write_levels(folder)
        yield compare_in_turns(
            FILES,
            {COMMAND: running(*BABYROBOT, "validate", "--jobs=1", name, worth=COUNT)},
            {"yamllint": running(*YAMLLINT, name, worth=COUNT)},
            count,
            aims={(COMMAND, "yamllint"): 8},
            versions=versions,
        )
        yield compare_in_turns(
            f"{FILES}, no start",
            {LOADING: reading_each(folder, load_file)},
            {
                "yamllint": yamllint_each(folder),
                "libyaml and pydantic, nothing else": reading_each(folder, parts),
            },
            count,
            aims={(LOADING, "yamllint"): 8},
            versions=versions,
        )


if __name__ == "__main__":
    report.main(__doc__, compare)
