"""Linting a thousand levels of 25 lines in one process: `babyrobot lint` beside yamllint.

    python benchmarks/lint.py

yamllint looks at the writing. `babyrobot lint` validates, compiles and solves each level, so that
it can tell whether it can be won.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

from commands import BABYROBOT, COUNT, YAMLLINT, running, write_levels
from timing import rounds, table, versions


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
        rates = rounds(measures, count=3)
    print(versions(["babyrobot-levels", "yamllint"]))
    print(table(rates, "yamllint", f"{COUNT} files, files per second"))


if __name__ == "__main__":
    main()
