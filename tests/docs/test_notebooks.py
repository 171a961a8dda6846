"""The notebooks run from top to bottom, and what is stored in them is what they put out."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from support.places import ROOT

NOTEBOOKS = sorted((ROOT / "notebooks").glob("*.ipynb"))
RUN = [path for path in NOTEBOOKS if path.stem != "jax"]
"""Those that need no library that learns; tests/jax_levels/test_docs.py runs the other."""

LONG = {"learning", "pomdp"}
"""They learn for half a minute, by functions that have tests of their own."""

MAX_BYTES = 1_000_000
"""Of a larger notebook, some sites show nothing."""

each_notebook = pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)


def read(path: Path) -> dict[str, Any]:
    """Read a notebook, but for the bytes of its PNGs: they depend on the version of Pillow."""
    notebook: dict[str, Any] = json.loads(path.read_text("utf-8"))
    for output in outputs(notebook):
        if "image/png" in output.get("data", {}):
            output["data"]["image/png"] = ""
    return notebook


def outputs(notebook: dict[str, Any]) -> Iterator[dict[str, Any]]:
    for cell in notebook["cells"]:
        yield from cell.get("outputs", [])


def test_there_is_a_tour() -> None:
    assert "tour" in [path.stem for path in NOTEBOOKS]


@pytest.mark.parametrize(
    "path",
    [
        pytest.param(path, marks=pytest.mark.sweep if path.stem in LONG else (), id=path.stem)
        for path in RUN
    ],
)
def test_a_notebook_runs_and_puts_out_what_is_stored(path: Path, tmp_path: Path) -> None:
    """Renew what is stored with `python scripts/renew.py notebooks`."""
    # In a process of its own: kernels leave sockets open, of which this one would be warned.
    done = subprocess.run(
        [sys.executable, ROOT / "scripts/renew.py", path.relative_to(ROOT), "--into", tmp_path],
        env={
            **os.environ,
            "HOME": str(tmp_path),
            "IPYTHONDIR": str(tmp_path / "ipython"),
            "PYTHONPATH": str(ROOT),
        },
        capture_output=True,
        text=True,
        encoding="utf-8",
        timeout=180,
        check=False,
    )
    assert done.returncode == 0, done.stderr[-4000:]
    run = read(tmp_path / path.relative_to(ROOT))
    assert [output for output in outputs(run) if output.get("name") == "stderr"] == []
    assert run == read(path)


@each_notebook
def test_a_stored_notebook_shows_pictures_without_a_kernel_and_is_small(path: Path) -> None:
    kinds = [set(output["data"]) for output in outputs(read(path)) if "data" in output]
    pictures = [kind for kind in kinds if "image/svg+xml" in kind]
    assert pictures
    # Where a notebook is not trusted, JupyterLab shows no SVG.
    assert all({"image/png", "text/plain"} <= kind for kind in pictures)
    assert path.stat().st_size < MAX_BYTES
