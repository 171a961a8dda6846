"""Whole outputs: what each command prints, to which stream, and how it ends."""

from __future__ import annotations

import pytest
from support.sessions import FOLDER, played, run_there

SESSIONS = sorted(path.stem for path in FOLDER.glob("*.txt"))


def session(name: str) -> str:
    return (FOLDER / f"{name}.txt").read_text(encoding="utf-8")


LONG = ("gallery", "generate", "list", "preview", "sheet")
"""Sessions that search for levels, read all of them, or draw many pictures, for seconds each."""

SLOW = ("compare", "course", "grade", "many", "score", "sight")
"""Those that score agents or start processes."""


def marks_of(name: str) -> list[pytest.MarkDecorator]:
    if name in LONG:
        return [pytest.mark.sweep]
    return [pytest.mark.slow] if name in SLOW else []


@pytest.mark.parametrize("name", [pytest.param(name, marks=marks_of(name)) for name in SESSIONS])
def test_what_the_commands_print(name: str) -> None:
    assert played(session(name)) == session(name)


@pytest.mark.sweep
@pytest.mark.parametrize("name", ["colors", "schema"])
def test_a_process_of_its_own_prints_the_same(name: str) -> None:
    assert played(session(name), run_there) == session(name)


def test_escape_sequences_are_printed_on_request_only() -> None:
    command = ""
    for line in "\n".join(map(session, SESSIONS)).splitlines():
        command = line if line.startswith("$ ") else command
        wanted = "FORCE_COLOR=1" in command and "NO_COLOR=1" not in command
        assert wanted or "\\e" not in line
