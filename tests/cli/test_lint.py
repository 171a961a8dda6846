"""`babyrobot lint`: suppressions, notes, and the exit status."""

from __future__ import annotations

from pathlib import Path

import pytest
from support.packs import babyrobot

pytestmark = pytest.mark.usefixtures("here")

PIT = """\
version: 1
map: |{}
  +---+---+---+
  | S     |   |
  +   +   +---+
  |         E |
  +---+---+---+
warps:
  - {{at: [0, 1], to: [2, 0]}}
"""


@pytest.mark.parametrize("name", ["inescapable-state", "BR503"])
def test_comments_suppress_by_name_and_code(name: str) -> None:
    Path("pit.yaml").write_text(PIT.format(f"  # babyrobot: ignore[{name}] a pit"))
    result = babyrobot("lint", "--select", "BR503,BR699", "pit.yaml")
    assert (result.status, result.out, result.err) == (0, "1 file checked, clean\n", "")


def test_notes_do_not_affect_the_exit_status() -> None:
    maze = "version: 1\nsize: [5, 1]\nexit: [2, 0]\nmaze: {seed: 1}\n"
    Path("maze.yaml").write_text(maze)
    result = babyrobot("lint", "maze.yaml")
    assert result.status == 0
    assert "info BR502: 2 cells ([3, 0] and [4, 0]) cannot be reached\n" in result.out
    assert result.out.endswith("\n1 info in 1 file\n")
    Path("maze.yaml").write_text(maze + "walls: []\n")
    assert babyrobot("lint", "maze.yaml").status == 1


def test_fixes_keep_byte_order_mark_and_comments() -> None:
    path, wall = Path("twice.yaml"), "  - {at: [0, 0], side: E}"
    path.write_text(f"\ufeffversion: 1\nsize: [3, 1]\nwalls:\n{wall}\n{wall}  # again\n", "utf-8")
    babyrobot("lint", "--fix", str(path))
    assert path.read_text("utf-8") == (
        f"\ufeffversion: 1\nsize: [3, 1]\nwalls:\n{wall}\n  # again\n"
    )
