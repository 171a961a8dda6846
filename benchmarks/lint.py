"""Linting a thousand levels of 25 lines in one process: `babyrobot lint` beside yamllint.

    python benchmarks/lint.py

yamllint looks at the writing. `babyrobot lint` validates, compiles and solves each level, so that
it can tell whether it can be won.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

from commands import (
    BABYROBOT,
    COUNT,
    YAMLLINT,
    reading_each,
    running,
    write_levels,
    yamllint_each,
)
from timing import rounds, table, versions

from babyrobot_levels.lint.registry import select
from babyrobot_levels.lint.runner import lint_file


def main() -> None:
    """Measure, and print the table."""
    with tempfile.TemporaryDirectory() as folder:
        write_levels(Path(folder))
        measures = {
            "babyrobot lint": running(*BABYROBOT, "lint", "--jobs=1", folder, worth=COUNT),
            "babyrobot lint --select BR6 (style)": running(
                *BABYROBOT, "lint", "--jobs=1", "--select=BR6", folder, worth=COUNT
            ),
            "yamllint": running(*YAMLLINT, folder, worth=COUNT),
        }
        rates = rounds(measures, count=5)
        print(versions(["babyrobot-levels", "yamllint"]))
        print(table(rates, "yamllint", f"{COUNT} files, files per second"))
        rules = select(None)
        inside = {
            "babyrobot lint": reading_each(Path(folder), lambda path: lint_file(path, rules)),
            "yamllint": yamllint_each(Path(folder)),
        }
        print(table(rounds(inside, 5), "yamllint", f"{COUNT} files, files per second, no start"))


if __name__ == "__main__":
    main()
