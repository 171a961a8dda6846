"""`babyrobot sheet`: what it says of letters that a format cannot show."""

from __future__ import annotations

from pathlib import Path

import pytest
from support.sessions import environment, run_here

pytestmark = pytest.mark.usefixtures("here")


@pytest.mark.parametrize(
    ("title", "suffix", "noted"),
    [("迷宫", "png", True), ("迷宫", "html", False), ("Žluťoučký kůň – §", "png", False)],
)
def test_letters_that_a_png_file_cannot_show_are_told_of(
    title: str, suffix: str, noted: bool
) -> None:
    Path("own.yaml").write_text(f"version: 1\ntitle: {title}\n", "utf-8")
    arguments = ["sheet", "own.yaml", "-o", f"sheet.{suffix}"]
    done = run_here(arguments, environment(Path.cwd()))
    assert done.status == 0
    assert ("Latin letters only" in done.err) == noted
