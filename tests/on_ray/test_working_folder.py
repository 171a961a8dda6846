"""Workers of a cluster import nothing from the working folder of whoever connects to it."""

from __future__ import annotations

import sys
from pathlib import Path

from support.strangers import run_among, strangers

PROGRAM = """\
import babyrobot_levels as brl
from babyrobot_levels.parallel.on_ray import OnRay

if __name__ == "__main__":
    values = brl.solve_many(["first-key", "frozen-lake"], executor=OnRay("local", 1))
    print([each.states for each in values])
"""


def test_workers_of_a_cluster(tmp_path: Path) -> None:
    (tmp_path / "program.py").write_text(PROGRAM, "utf-8")
    folder = strangers(tmp_path / "working")
    assert run_among(folder, sys.executable, tmp_path / "program.py") == "[23, 16]\n"
