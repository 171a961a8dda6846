"""Whatever becomes of a good file, the answer is a level or diagnostics that can be trusted."""

from __future__ import annotations

import json
import re
import warnings
from xml.etree import ElementTree as Xml

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from support.mutants import BROKEN, WHOLE, mutants
from support.reading import read_level

from babyrobot_levels import validate
from babyrobot_levels.library.level import Level, loads
from babyrobot_levels.linter.reporters import render
from babyrobot_levels.text.diagnostics import Diagnostic
from babyrobot_levels.text.errors import LevelError
from babyrobot_levels.text.files import source_of
from babyrobot_levels.text.source import SourceFile

CHUNKS, IN_A_CHUNK = 10, 600
SMALL = 100
"""Levels of so many cells are compiled."""


def hold(data: bytes) -> bool:
    """Check that a file is answered well, and tell whether it is a level."""
    try:
        source = source_of(data, "x.yaml")
    except LevelError as fault:
        text = data.decode("utf-8", "replace").removeprefix("\ufeff")
        assert_can_be_told(fault.diagnostics[0], text)
        return False
    level, diagnostics = read_level(source)
    assert (level is None) == bool(diagnostics)
    for diagnostic in diagnostics:
        assert_can_be_told(diagnostic, source.text)
    Xml.fromstring(render("junit", diagnostics, ["x.yaml"], {}, "").encode())
    if level is not None:
        assert_is_whole(level)
    return level is not None


def assert_can_be_told(diagnostic: Diagnostic, text: str) -> None:
    """Check that a diagnostic points into the text, and can be shown anywhere."""
    assert re.fullmatch(r"BR[1-4]\d\d", diagnostic.code)
    lines = re.split("\r\n|\r|\n", text)
    start, end = diagnostic.span
    assert start <= end
    for place in (start, end):
        assert 1 <= place.line <= len(lines)
        assert 1 <= place.column <= len(lines[place.line - 1]) + 1
    assert all(line.isprintable() for line in str(diagnostic).split("\n"))
    assert len(str(diagnostic)) < 2000
    assert json.loads(json.dumps(diagnostic.to_dict())) == diagnostic.to_dict()


def assert_is_whole(level: Level) -> None:
    """Check that a level can be written and read again, and is the same game."""
    again = loads(level.to_yaml())
    assert again.to_dict() == level.to_dict()
    if not level.has_random_maze and level.size[0] * level.size[1] <= SMALL:
        assert again.digest == level.digest


@pytest.mark.sweep
@pytest.mark.parametrize("seed", range(CHUNKS))
def test_mutants_of_good_files(seed: int) -> None:
    levels = 0
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for number, data in enumerate(mutants(seed, IN_A_CHUNK)):
            try:
                levels += hold(data)
            except Exception as error:
                error.add_note(f"mutant {number}: {data!r}")
                raise
    # Neither all broken nor all whole: both ways are tried.
    assert IN_A_CHUNK * 0.05 < levels < IN_A_CHUNK * 0.6


@pytest.mark.sweep
def test_the_parents_are_what_they_should_be() -> None:
    assert all(map(hold, WHOLE))
    assert not any(map(hold, BROKEN))


@settings(deadline=None, max_examples=500)
@given(st.binary(max_size=300))
@example(b"")
@example(b"\xef\xbb\xbf\xef\xbb\xbf")
@example("version: 1\r\u2028size: 3\x85map: |\r\n  \u2029\n".encode())
def test_any_bytes(data: bytes) -> None:
    hold(data)


@settings(deadline=None, max_examples=500)
@given(st.text(st.characters() | st.sampled_from("\n:-[]{}&*!|>'\"%#? \ud800\x00"), max_size=200))
@example("version: 1\ntitle: \ud800\n")
@example("\ufeff\ufeff: \n")
def test_any_text(text: str) -> None:
    """A text from Python may hold what no file can: half a character."""
    for diagnostic in validate(text + "\n"):
        assert_can_be_told(diagnostic, SourceFile("", text + "\n").text)
