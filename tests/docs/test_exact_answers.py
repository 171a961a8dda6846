"""The page on exact answers: the numbers that it shows are those that come out."""

from __future__ import annotations

import ast
import re
from typing import Any

import numpy as np
from support.places import DOCS

TEXT = (DOCS / "exact-answers.md").read_text("utf-8")
BLOCKS = re.findall(r"^```python\n(.*?)^```", TEXT, re.MULTILINE | re.DOTALL)


def test_numbers_behind_an_expression_are_its_value() -> None:
    count = 0
    for block in BLOCKS:
        names: dict[str, Any] = {}
        exec(block, names)
        for expression, shown in re.findall(r"^(\S.*\S)  # (-?\d[\d.]*)(?=[…:\n])", block, re.M):
            count += 1
            # Digits that are not shown are cut off.
            unit = 10.0 ** -len(shown.partition(".")[2])
            assert abs(eval(expression, names) - float(shown)) < unit, expression
    assert count >= 4


def test_the_articles_numbers_come_out_without_stay() -> None:
    block = next(block for block in BLOCKS if "glass-wall" in block)
    names: dict[str, Any] = {}
    exec(block, names)
    expression = next(line for line in block.splitlines() if line.endswith(".tolist()"))
    shown = "".join(re.findall(r"^# *(\[.*)", block, re.M))
    expected = ast.literal_eval(shown.replace("nan", "None"))
    given = np.array(eval(expression, names), float)
    assert np.array_equal(given, np.array(expected, float), equal_nan=True)
