"""What the commands make, beyond what they print."""

from __future__ import annotations

import json
import os
import re
import shlex
import sys
from functools import partial
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support import sessions

from babyrobot_levels.library.catalogue import levels, load
from babyrobot_levels.library.level import load_file
from babyrobot_levels.linter import runner
from babyrobot_levels.mdp.mazes import ALGORITHMS
from babyrobot_levels.text.budget import Limits

"""Levels that differ in what there is to tell of them."""


pytestmark = pytest.mark.usefixtures("here")
babyrobot = partial(sessions.babyrobot, status=0)


def test_the_whole_gallery_is_valid_and_listed() -> None:
    told = json.loads(babyrobot("list", "--format", "json").out)
    assert [entry["name"] for entry in told] == sorted(info.name for info in levels())
    paths = [entry["path"] for entry in told]
    result = babyrobot("validate", *paths)
    assert result.out == f"{len(paths)} files checked, all valid\n"


@pytest.mark.parametrize("command", ["validate", "lint", "format"])
def test_no_file_is_left_out(command: str, monkeypatch: pytest.MonkeyPatch) -> None:
    deep = Path("levels", *"abcdefghij")
    deep.mkdir(parents=True)
    (deep / "bad.yaml").write_text("version: 1\nnonsense: 1\n", encoding="utf-8")
    assert "unknown field `nonsense`" in babyrobot(command, status=1).out
    look = os.scandir

    def refuse(path: Any) -> Any:
        if Path(path).name == "d":
            raise PermissionError(13, "Permission denied", str(path))
        return look(path)

    monkeypatch.setattr(os, "scandir", refuse)
    refused = babyrobot(command, status=2)
    assert (refused.out, refused.err) == (
        "", f"error: Permission denied: {Path('levels', *'abcd')}\n",
    )  # fmt: skip


@pytest.mark.parametrize("command", ["validate", "lint", "format"])
def test_who_names_a_level_to_be_checked_is_told_its_file(command: str) -> None:
    (path,) = (info.path for info in levels() if info.name == "final-maze")
    told = babyrobot(command, "final-maze", status=1)
    assert "final-maze:1:1: error BR101: no such file" in told.out
    assert told.err.endswith(f"but this command takes files: {path}\n")
    assert babyrobot(command, "no-such-level", status=1).err == ""


def test_an_svg_to_a_pipe_is_that_of_the_file() -> None:
    babyrobot("preview", "maze", "-o", "maze.svg")
    text = babyrobot("preview", "maze", "--format", "svg").out
    file = Path("maze.svg").read_text(encoding="utf-8")
    # The file also says who made it.
    assert text == re.sub(r"<!-- babyrobot preview \w+ -->\n", "", file)


def test_a_picture_shows_what_is_asked_for() -> None:
    def picture(*options: str) -> str:
        return babyrobot("preview", "default", "--format", "svg", *options).out

    plain = picture()
    assert "#f4f0e7" in plain
    assert picture("--theme", "default") == plain
    assert "#f4f0e7" not in picture("--theme", "green")
    assert plain.count("<text") < picture("--coordinates").count("<text")


def test_a_random_maze_is_that_of_the_seed() -> None:
    level = load("random-maze")
    for seed in (0, 5, 12**30):
        shown = babyrobot("preview", "random-maze", "--maze-seed", str(seed)).out
        assert shown.startswith(level.with_maze_seed(seed).draw())


def test_the_colored_drawing_is_the_drawing() -> None:
    """The same cells and walls stand in the same places, whatever they are drawn with."""
    level = load("final-maze")
    colored = babyrobot("preview", "final-maze", FORCE_COLOR="1").out
    shown = re.sub(r"\x1b\[[0-9;]*m", "", colored).splitlines()
    plain = level.draw().splitlines()
    # The legend stands below.
    assert [len(line) for line in shown[: len(plain)]] == [len(line) for line in plain]
    for line, drawn in zip(shown, plain, strict=False):
        for mark, character in zip(line, drawn, strict=True):
            if character in "SE":
                assert mark == character
            elif character in "-|":
                assert 0x2500 <= ord(mark) < 0x2580


@pytest.mark.parametrize("template", ["grid", "maze", "drawing"])
@pytest.mark.parametrize(("size", "count"), [((1, 2), 0), ((8, 5), 38), ((1024, 1), 1022)])
def test_a_new_level_is_what_was_ordered(template: str, size: tuple[int, int], count: int) -> None:
    width, height = size
    babyrobot(
        *("new-level", "mine", "--template", template, "--size", f"{width}x{height}"),
        *("--puddles", str(count), "--theme", "blue_green"),
    )
    assert [path.name for path in Path().rglob("*.yaml")] == ["mine.yaml"]
    level = load_file(Path("levels", "mine.yaml"))
    assert (level.name, level.size, level.theme) == ("mine", size, "blue_green")
    assert level.start == (0, 0)
    assert template == "maze" or level.exit == (width - 1, height - 1)
    assert len({puddle.at for puddle in level.puddles}) == count
    assert (level.maze is not None) == (template == "maze")
    assert babyrobot("validate").out == "1 file checked, valid\n"
    assert babyrobot("preview", "mine").out.startswith(level.draw())
    assert not np.isnan(level.compile().probability).any()


@pytest.mark.slow
def test_new_mazes_can_be_walked_to_their_ends() -> None:
    """The exit stands at a dead end near the corner: there is nothing behind it."""
    orders = [*product(ALGORITHMS, range(3))]
    for algorithm, seed in orders:
        order = ("--maze-seed", str(seed), "--algorithm", algorithm, "--loops", "0.2")
        babyrobot("new-level", f"{algorithm}-{seed}", *order, "--puddles", "5")
    told = babyrobot("lint", "--select", "BR5").out
    assert told == f"{len(orders)} files checked, all clean\n"


@pytest.mark.skipif(sys.platform == "win32", reason="asks a POSIX shell")
def test_what_to_type_next_can_be_typed() -> None:
    told = babyrobot("new-level", "mine", "-o", "my $levels/it's ü n.yaml").out
    typed = [line.partition("babyrobot ")[2] for line in told.splitlines() if "babyrobot " in line]
    assert [shlex.split(line)[1:] for line in typed[:2]] == [["my $levels/it's ü n.yaml"]] * 2


def test_the_comments_of_a_new_level_are_valid_when_they_are_taken_in() -> None:
    """Who removes the `#` before a field has a valid level still."""
    babyrobot("new-level", "mine")
    path = Path("levels", "mine.yaml")
    lines = path.read_text(encoding="utf-8").splitlines()
    taken = [line[2:] if line.startswith("# ") and ":" in line else line for line in lines]
    taken = [line for line in taken if "$schema" not in line and not line.startswith("A grid")]
    taken = [line[2:] if line.startswith("#  ") else line for line in taken]
    path.write_text("\n".join(taken) + "\n", encoding="utf-8")
    level = load_file(path)
    assert (len(level.walls), len(level.puddles), level.max_steps) == (1, 1, 100)
    assert level.theme == "black_orange"


def test_the_same_seed_gives_the_same_file() -> None:
    order = ("--maze-seed", "5", "--puddles", "6", "--loops", "0.3", "--size", "9x9")
    babyrobot("new-level", "mine", *order)
    babyrobot("new-level", "mine", *order, "-o", "levels/again.yaml")
    texts = [path.read_bytes() for path in sorted(Path("levels").iterdir())]
    assert texts[0] == texts[1]


def test_findings_of_the_json_report_are_those_of_the_text() -> None:
    with sessions.prepared_folder():
        text = babyrobot("validate", "bad.yaml", "rules.yaml", "broken.yaml", status=1).out
        report = babyrobot("validate", "--format", "json", "bad.yaml", "rules.yaml", "broken.yaml",
                           status=1).out  # fmt: skip
        told = json.loads(report)
    assert set(told) == {"version", "diagnostics"}
    for found in told["diagnostics"]:
        place = f"{found['file']}:{found['line']}:{found['column']}"
        assert f"{place}: {found['severity']} {found['code']}: {found['message']}" in text
    assert text.count(": error BR") == len(told["diagnostics"])


def test_writing_through_a_link_changes_its_target() -> None:
    target, link = Path("target.yaml"), Path("link.yaml")
    link.symlink_to(target)
    babyrobot("new-level", "mine", "-o", str(link))
    assert link.is_symlink()
    assert load_file(target).name == "mine"


# -- findings and sheets ----------------------------------------------------------------------

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
    result = sessions.babyrobot("lint", "--select", "BR503,BR699", "pit.yaml")
    assert (result.status, result.out, result.err) == (0, "1 file checked, clean\n", "")


def test_notes_do_not_affect_the_exit_status() -> None:
    maze = "version: 1\nsize: [5, 1]\nexit: [2, 0]\nmaze: {seed: 1}\n"
    Path("maze.yaml").write_text(maze)
    result = sessions.babyrobot("lint", "maze.yaml")
    assert result.status == 0
    assert "info BR502: 2 cells ([3, 0] and [4, 0]) cannot be reached\n" in result.out
    assert result.out.endswith("\n1 info in 1 file\n")
    Path("maze.yaml").write_text(maze + "walls: []\n")
    babyrobot("lint", "maze.yaml", status=1)


def test_fixes_keep_byte_order_mark_and_comments() -> None:
    path, wall = Path("twice.yaml"), "  - {at: [0, 0], side: E}"
    path.write_text(f"\ufeffversion: 1\nsize: [3, 1]\nwalls:\n{wall}\n{wall}  # again\n", "utf-8")
    sessions.babyrobot("lint", "--fix", path)
    assert path.read_text("utf-8") == (
        f"\ufeffversion: 1\nsize: [3, 1]\nwalls:\n{wall}\n  # again\n"
    )


@pytest.mark.parametrize("option", ["--fix", "--diff"])
def test_fixes_that_are_left_for_another_run_are_told(
    option: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    Path("own.yaml").write_text("version: 1\nsize: [3, 3]\nwalls: []\n")
    monkeypatch.setattr(runner, "COMMAND", Limits(0, 0))
    status = 1 if option == "--fix" else 0
    told = babyrobot("lint", option, "own.yaml", status=status).err
    assert told == "own.yaml: 0 fixed, and there was too much work for more: fix it again\n"


@pytest.mark.parametrize(
    ("title", "suffix", "noted"),
    [("迷宫", "png", True), ("迷宫", "html", False), ("Žluťoučký kůň – §", "png", False)],
)
def test_letters_that_a_png_file_cannot_show_are_told_of(
    title: str, suffix: str, noted: bool
) -> None:
    Path("own.yaml").write_text(f"version: 1\ntitle: {title}\n", "utf-8")
    done = babyrobot("sheet", "own.yaml", "-o", f"sheet.{suffix}")
    assert ("Latin letters only" in done.err) == noted


def test_a_difference_names_things_once() -> None:
    level = "version: 1\nsize: [4, 3]\nitems: [{name: mover-1, at: [1, 1]}]\nhit: {ends: false}\n"
    for name, end in (("a", "[3, 1]"), ("b", "[3, 1], [3, 2]")):
        movers = f"movers: [{{path: [[3, 0], {end}], back: true}}]\n"
        Path(f"{name}.yaml").write_text(level + movers, "utf-8")
    told = babyrobot("diff", "a.yaml", "b.yaml", status=1).out
    assert "\n  the-mover-1 walks [3, 0], [3, 1], [3, 2] and" in told
