"""Exceptions as users meet them."""

from __future__ import annotations

import re
from pathlib import Path

from support.subprocesses import run

CODE = """\
from IPython.core.interactiveshell import InteractiveShell

InteractiveShell().run_cell("import babyrobot_levels as brl\\nlevel = brl.loads('sise: 3')")
"""


def test_in_a_notebook_an_error_shows_the_call_and_the_diagnostics(tmp_path: Path) -> None:
    shown = re.sub("\x1b\\[[0-9;]*m", "", run(CODE, tmp_path))
    assert "level = brl.loads('sise: 3')" in shown
    assert "<text>:1:1: error BR201: unknown field `sise`; did you mean `size`?" in shown
    assert "babyrobot_levels/" not in shown.replace("\\", "/")
