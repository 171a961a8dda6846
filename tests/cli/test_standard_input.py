"""`-` is standard input for every command that takes a level, and standard output for `-o`."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from support.sessions import Result, babyrobot, prepared_folder

COMMANDS = [
    *("preview - --format svg", "show - --cite", "solve -", "resolve -", "export - --to maze-map"),
    *("share -", "diff default -", "diff - default", "compare - default", "compare default -"),
]
LEVEL = b"version: 1\nname: piped\nsize: [4, 3]\nmaze: {seed: 4}\ntheme: green  # as it is\n"


@pytest.fixture(autouse=True)
def folder() -> Iterator[Path]:
    with prepared_folder() as path:
        yield path


@pytest.mark.parametrize("command", COMMANDS)
def test_it_is_read_like_a_file(command: str, folder: Path) -> None:
    for text in (LEVEL, b"version: 1\nsize: [\n", b"\xff\n"):
        (folder / "piped.yaml").write_bytes(text)
        words = ["piped.yaml" if word == "-" else word for word in command.split()]
        named = babyrobot(*words)
        piped = babyrobot(*command.split(), given=text)
        assert piped.out == named.out.replace("piped.yaml", "<stdin>")
        assert piped.err == named.err.replace("piped.yaml", "<stdin>")
        assert piped.status == named.status
        assert piped.out if text == LEVEL else "\n<stdin>:" in piped.err


@pytest.mark.parametrize("command", ["diff", "compare"])
def test_it_is_one_level_only(command: str) -> None:
    expected = "error: only one of the two levels can be standard input\n"
    assert babyrobot(command, "-", "-", given=LEVEL) == Result("", expected, 2)


def test_a_file_of_that_name_has_another_one(folder: Path) -> None:
    (folder / "-").write_bytes(LEVEL)
    assert babyrobot("resolve", "./-").status == 0
    assert babyrobot("resolve", "-").status == 1


# -- what is put out ---------------------------------------------------------------------------


@pytest.mark.slow
def test_a_dash_is_standard_output(folder: Path) -> None:
    (folder / "lake.txt").write_text("SFFF\nFHFH\nFFFH\nHFFG\n", encoding="utf-8")
    for call in ("preview walls --format svg", "export walls --to maze-map", "resolve maze",
                 "schema", "import lake.txt"):  # fmt: skip
        assert babyrobot(*call.split(), "-o", "-") == babyrobot(*call.split())
        assert not (folder / "-").exists()


@pytest.mark.parametrize(
    "command", [("new-level", "mine"), ("share", "walls"), ("pack", "zoo")], ids=" ".join
)
def test_what_is_for_a_file_needs_its_name(command: tuple[str, ...], folder: Path) -> None:
    (folder / "zoo").mkdir()
    (folder / "zoo" / "pack.yaml").write_text(
        "name: zoo\nversion: 1.0.0\nauthor: A\nlicense: MIT\ndescription: D\n", encoding="utf-8"
    )
    (folder / "zoo" / "a.yaml").write_text("version: 1\n", encoding="utf-8")
    result = babyrobot(*command, "-o", "-")
    assert (result.status, result.out) == (2, "")
    assert "cannot be written to standard output" in result.err
    assert not (folder / "-").exists()


def test_it_is_checked_beside_files_with_processes(folder: Path) -> None:
    (folder / "good.yaml").write_bytes(LEVEL)
    result = babyrobot("validate", "--jobs", "2", "-", "good.yaml", given=LEVEL)
    assert result == Result("2 files checked, all valid\n", "", 0)
