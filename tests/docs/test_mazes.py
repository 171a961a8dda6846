"""The document about mazes shows what the algorithms really do."""

from __future__ import annotations

import re

import pytest
from support.places import DOCS

import babyrobot_levels as brl
from babyrobot_levels.analysis.metrics import PATHS, RETURNS, SHAPE, THINGS
from babyrobot_levels.mdp.mazes import ALGORITHMS

TEXT = (DOCS / "mazes.md").read_text(encoding="utf-8")


def test_each_algorithm_has_its_picture() -> None:
    for path in (DOCS / "images" / "mazes").iterdir():
        assert f"images/mazes/{path.name}" in TEXT


def test_each_algorithm_has_its_section_in_order() -> None:
    assert re.findall(r"^### `(.*)`$", TEXT, flags=re.MULTILINE) == list(ALGORITHMS)


def test_each_metric_is_explained_in_order() -> None:
    rows = re.findall(r"^\| `(\w+)` \|", TEXT[TEXT.index("## Metrics") :], flags=re.MULTILINE)
    assert [row for row in rows if row != "path"] == [*SHAPE, *PATHS, *THINGS, *RETURNS]


@pytest.mark.parametrize("text", re.findall(r"```yaml\n(.*?)```", TEXT, flags=re.DOTALL))
def test_the_examples_are_levels(text: str) -> None:
    brl.loads(text).compile()


def test_the_difficulties_that_are_told_are_right() -> None:
    rows = re.findall(r"^\| ([a-z0-9-]+) \| ([0-9.]+) \|", TEXT, flags=re.MULTILINE)
    assert len(rows) >= 6
    for name, told in rows:
        assert f"{brl.metrics(name).difficulty:.1f}" == told
