"""The page on JAX names the examples, and the notebook learns."""

from __future__ import annotations

import json
import re
from typing import Any

import pytest
from support.places import DOCS, EXAMPLES, ROOT

PAGE = (DOCS / "jax.md").read_text(encoding="utf-8")


def test_the_page_names_the_examples() -> None:
    named = set(re.findall(r"\.\./examples/(\w+)\.py", PAGE))
    assert named == {path.stem for path in EXAMPLES.glob("*_jax.py")}


def test_the_notebook_learns_the_optimum(capsys: pytest.CaptureFixture[str]) -> None:
    cells = json.loads((ROOT / "notebooks" / "jax.ipynb").read_text("utf-8"))["cells"]
    codes = ["".join(cell["source"]) for cell in cells if cell["cell_type"] == "code"]
    names: dict[str, Any] = {}
    exec(compile("\n".join(codes), "jax.ipynb", "exec"), names)
    assert names["shares"][-1].mean() > 0.99
    stored = [
        "".join(output["text"])
        for cell in cells
        for output in cell.get("outputs", [])
        if output["output_type"] == "stream"
    ]
    # What is learned may differ between devices; what is counted or solved may not.
    printed = capsys.readouterr().out
    assert printed.startswith(stored[0])
    assert stored[2] in printed
