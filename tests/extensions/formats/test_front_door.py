"""Files of other programs where levels are expected, and many of them at once."""

from __future__ import annotations

import os
import warnings
from pathlib import Path
from zipfile import ZipFile

import pytest
from support.sessions import babyrobot

import babyrobot_levels as brl
from babyrobot_levels.extensions.formats import sources

MAZE = "o---o---o\n| S   G |\no---o---o\n"
LAKE = "SFF\nFHG\n"
SET = "; 1\n####\n#@.#\n####\n\n; 2\n####\n#.@#\n####\n"
EITHER = "#####\n#S E#\n#####"

pytestmark = pytest.mark.usefixtures("here")


@pytest.fixture
def mazes() -> Path:
    """Return a folder of files of all kinds."""
    folder = Path("mazes")
    (folder / "sub").mkdir(parents=True)
    files = {
        "one.txt": MAZE,
        "sub/One.txt": MAZE,
        "set.txt": SET,
        "either.txt": EITHER,
        "bad.txt": MAZE.replace("S  ", "S X"),
        "notes.md": "What these are.\n",
        ".hidden.txt": MAZE,
    }
    for name, text in files.items():
        (folder / name).write_text(text, encoding="utf-8")
    (folder / "picture.png").write_bytes(b"\x89PNG\r\n\x1a\n")
    return folder


EXPECTED = ["one.yaml", "set-1.yaml", "set-2.yaml", "sub/one.yaml"]


def written(folder: str) -> list[str]:
    return sorted(path.relative_to(folder).as_posix() for path in Path(folder).rglob("*.yaml"))


def test_all_of_a_folder_is_imported(mazes: Path) -> None:
    result = babyrobot("import", str(mazes), "-o", "levels")
    assert (result.status, result.out) == (1, "")
    assert result.err.replace(os.sep, "/").splitlines() == [
        "mazes/bad.txt:2:1: error: this is no row of a micromouse maze (rows of posts (`o` or `+`) "
        "with `---` between them, and rows of cells with `|`, S and G)",
        "mazes/either.txt may be a maze-dataset ASCII or a map of # and blanks "
        "(give its format: maze-dataset or sokoban)",
        "note: in no known format: mazes/notes.md, mazes/picture.png",
        "wrote 4 levels of 7 files to levels, 2 refused, 2 in no known format",
    ]
    assert written("levels") == EXPECTED
    assert brl.load("levels/one.yaml").exits == ((1, 0),)


def test_a_zip_file_is_a_folder(mazes: Path) -> None:
    with ZipFile("mazes.zip", "w") as archive:
        for path in mazes.rglob("*.*"):
            archive.write(path, path.relative_to(mazes))
    assert babyrobot("import", "mazes.zip", "-o", "levels").status == 1
    assert written("levels") == EXPECTED
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        levels = brl.read("mazes.zip")
    assert [level.name for level in levels] == ["one", "set-1", "set-2", "one"]
    assert len(told) == 4


def test_names_in_a_zip_file_lead_nowhere_else() -> None:
    with ZipFile("evil.zip", "w") as archive:
        for name in ("../../up.txt", "/etc/root.txt", "a/../b.txt", "CON.txt"):
            archive.writestr(name, MAZE)
    assert babyrobot("import", "evil.zip", "-o", "inner/levels").status == 0
    expected = ["con-level.yaml", "level/etc/root.yaml"]
    assert written(".") == [f"inner/levels/{name}" for name in expected]


def test_archives_are_bounded(monkeypatch: pytest.MonkeyPatch) -> None:
    with ZipFile("outer.zip", "w") as archive:
        archive.writestr("inner.zip", b"PK\x03\x04" + b"\0" * 99)
        archive.writestr("one.txt", MAZE)
    assert babyrobot("import", "outer.zip", "-o", "levels").status == 0
    assert written("levels") == ["one.yaml"]
    monkeypatch.setattr(sources, "MAX_UNPACKED", 50)
    result = babyrobot("import", "outer.zip", "-o", "levels")
    assert (result.status, len(result.err.splitlines())) == (1, 2)
    Path("broken.zip").write_bytes(Path("outer.zip").read_bytes()[:80])
    result = babyrobot("import", "broken.zip", "-o", "levels")
    assert (result.status, len(result.err.splitlines())) == (1, 1)


def test_several_files_need_a_folder_and_keep_what_is_there(mazes: Path) -> None:
    Path("lake.txt").write_text(LAKE, encoding="utf-8")
    files = [str(mazes / "one.txt"), "lake.txt"]
    assert "-o FOLDER" in babyrobot("import", *files).err
    assert babyrobot("import", *files, "-o", "levels").status == 0
    Path("levels/one.yaml").write_text("mine", encoding="utf-8")
    result = babyrobot("import", *files, "-o", "levels")
    assert (result.status, result.err.count("already exists")) == (1, 2)
    assert Path("levels/one.yaml").read_text(encoding="utf-8") == "mine"
    assert babyrobot("import", *files, "-o", "levels", "--force").status == 0


def test_one_of_a_collection_or_all_of_it(mazes: Path) -> None:
    path = str(mazes / "set.txt")
    result = babyrobot("import", path)
    assert (result.status, "has 2 worlds" in result.err) == (2, True)
    assert babyrobot("import", path, "--number", "2", "-o", "two.yaml").status == 0
    assert brl.load("two.yaml").starts == brl.import_(path, number=2).starts == ((1, 0),)
    assert babyrobot("import", path, "-o", "levels").status == 0
    assert written("levels") == ["set-1.yaml", "set-2.yaml"]
    result = babyrobot("import", "-", "-o", "levels", given=SET.encode())
    assert (result.status, "--number N" in result.err) == (2, True)


def test_strict_refuses_each_that_would_lose_something() -> None:
    starts = SET.replace("#@.#", "#+.#", 1)
    Path("set.txt").write_text(starts, encoding="utf-8")
    result = babyrobot("import", "set.txt", "-o", "levels", "--strict")
    assert (result.status, written("levels")) == (1, ["set-2.yaml"])
    assert "set.txt:3:2: error: +: a start cannot be an exit" in result.err


def test_commands_take_such_a_file_directly(mazes: Path) -> None:
    path = str(mazes / "one.txt")
    assert "2 x 1" in babyrobot("show", path).out
    assert "reaches an exit: 100 %" in babyrobot("solve", path).out
    assert babyrobot("preview", path, "-o", "one.png").status == 0
    assert babyrobot("validate", path).status == 0
    assert brl.load(path).exits == ((1, 0),)


def test_what_is_lost_is_told_there_too() -> None:
    Path("maze.txt").write_text(MAZE.replace("S", " "), encoding="utf-8")
    result = babyrobot("show", "maze.txt")
    told = (
        "warning: maze.txt:2:3: S: none is drawn, so it is the bottom-left cell, as in contests\n"
    )
    assert (result.status, result.err) == (0, told)


@pytest.mark.parametrize("command", ["show", "validate"])
def test_a_doubtful_file_is_asked_about(mazes: Path, command: str) -> None:
    result = babyrobot(command, str(mazes / "either.txt"))
    assert result.status == 1
    assert "may be a maze-dataset ASCII or a map of # and blanks" in result.out + result.err


def test_a_text_in_no_format_has_the_errors_of_a_level_file(mazes: Path) -> None:
    assert "a level begins with `version: 1`" in babyrobot("show", str(mazes / "notes.md")).err
