"""Linting a thousand levels of 25 lines in one process: `babyrobot lint` beside yamllint.

    python benchmarks/lint.py

yamllint looks at the writing. `babyrobot lint` validates, compiles and solves each level, so that
it can tell whether it can be won; levels that state facts are held to them.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import report
from commands import (
    BABYROBOT,
    COUNT,
    FILES,
    YAMLLINT,
    reading_each,
    running,
    write_levels,
    yamllint_each,
)
from timing import Aims, Comparison, compare_in_turns, installed

import babyrobot_levels as brl
from babyrobot_levels.linter.linting import Options, lint_path


def compare(count: int) -> Iterator[Comparison]:
    """Measure linting a folder as whole processes, and then inside of this one."""
    versions = installed("babyrobot-levels", "yamllint")
    aims: Aims = {("babyrobot lint", "yamllint"): 3}
    with tempfile.TemporaryDirectory() as name, tempfile.TemporaryDirectory() as stated:
        folder = Path(name)
        write_levels(folder)
        write_levels(Path(stated))
        for path in Path(stated).glob("*.yaml"):
            brl.expect(path, write=True)
        yield compare_in_turns(
            FILES,
            {
                "babyrobot lint": running(*BABYROBOT, "lint", "--jobs=1", name, worth=COUNT),
                "babyrobot lint --select BR6 (style)": running(
                    *BABYROBOT, "lint", "--jobs=1", "--select=BR6", name, worth=COUNT
                ),
                "babyrobot lint, with `expect`": running(
                    *BABYROBOT, "lint", "--jobs=1", stated, worth=COUNT
                ),
            },
            {"yamllint": running(*YAMLLINT, name, worth=COUNT)},
            count,
            aims=aims,
            versions=versions,
        )
        yield compare_in_turns(
            f"{FILES}, no start",
            {"babyrobot lint": reading_each(folder, partial(lint_path, Options()))},
            {"yamllint": yamllint_each(folder)},
            count,
            aims=aims,
            versions=versions,
        )


if __name__ == "__main__":
    report.main(__doc__, compare)
