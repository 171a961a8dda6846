"""`babyrobot lint`: former names of rules, notes, and the exit status."""

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


def test_former_names_of_rules_in_settings_work_with_a_warning() -> None:
    Path("pit.yaml").write_text(PIT.format(""))
    settings = Path("babyrobot.toml")
    settings.write_text('[lint]\nselect = ["trap", "endless"]\n')
    result = babyrobot("lint", "pit.yaml")
    assert "warning BR503" in result.out
    assert result.err == (
        f"warning: {settings.resolve()}: rule `trap` has been renamed to `inescapable-state`\n"
        f"warning: {settings.resolve()}: rule `endless` has been renamed to `non-terminating`\n"
    )
    settings.write_text('[lint.per-file-ignores]\n"pit*" = ["trap"]\n')
    result = babyrobot("lint", "pit.yaml")
    assert (result.status, result.out) == (0, "1 file checked, clean\n")
    assert result.err.startswith(f"warning: {settings.resolve()}: rule `trap` has been renamed")


def test_each_former_name_is_reported_once() -> None:
    for name in ("one.yaml", "two.yaml"):
        Path(name).write_text(PIT.format(""))
    result = babyrobot("lint", "--select", "TRAP,trap", ".")
    assert result.err == (
        "warning: rule `TRAP` has been renamed to `inescapable-state`\n"
        "warning: rule `trap` has been renamed to `inescapable-state`\n"
    )


@pytest.mark.parametrize("name", ["trap", "inescapable-state", "BR503"])
def test_former_names_in_comments_work_silently(name: str) -> None:
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
