"""What is formatted, what is refused, and what is left as it is."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest
from support.places import TESTS
from support.work import counted_calls

import babyrobot_levels as brl
from babyrobot_levels.language import formatting
from babyrobot_levels.language.formatting import format_source
from babyrobot_levels.text.errors import LevelError
from babyrobot_levels.text.source import SourceFile


def reason(text: str) -> str | None:
    """Return why a text is left as it is."""
    result = format_source(SourceFile("level.yaml", text))
    assert result.kept is None or result.text == text
    return result.kept


# -- refused -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("", "BR110"),
        ("# nothing\n", "BR110"),
        ("- 1\n", "BR110"),
        ("version: 1\nsize: [0, 1]\n", "BR205"),
        ("version: 1\nversion: 1\n", "BR105"),
        ("version: [1\n", "BR104"),
        ("version: 1\n---\nversion: 1\n", "BR106"),
        ("[" * 100_000, "BR109"),
        ("version: 1\n\x00", "BR104"),
        ("version: 1\nsize: *nothing\n", "BR108"),
    ],
    ids=["empty", "comment", "list", "value", "twice", "syntax", "second", "deep", "nul", "alias"],
)
def test_faulty_texts_are_refused(text: str, code: str) -> None:
    with pytest.raises(LevelError) as caught:
        format_source(SourceFile("mine.yaml", text))
    assert caught.value.diagnostics[0].code == code
    assert caught.value.diagnostics[0].file == "mine.yaml"


def test_a_theme_that_is_not_there_is_no_fault_of_a_text_without_a_folder(tmp_path: Path) -> None:
    source = SourceFile("mine.yaml", "version: 1\ntheme: dusk\n")
    assert format_source(source).text == source.text
    with pytest.raises(LevelError, match="BR401"):
        format_source(source, tmp_path / "mine.yaml")


def test_files_in_a_folder_of_themes_are_themes(tmp_path: Path) -> None:
    path = tmp_path / "themes" / "dusk.yaml"
    source = SourceFile("dusk.yaml", "widths:  {walls: 2}\ncolors: {base: 'navy'}")
    assert format_source(source, path).text == "colors: {base: navy}\nwidths: {walls: 2}\n"
    with pytest.raises(LevelError, match="BR20"):
        format_source(SourceFile("dusk.yaml", "version: 1\n"), path)


# -- left as it is -----------------------------------------------------------------------------


@pytest.mark.parametrize(
    "text",
    [
        "%YAML 1.2\n---\nversion:   1\n",
        "&level\nversion:   1\n",
        "&v version:   1\n",
        "version:   1\ntitle: &t one\n  two\n",
        "version:   1\ntitle: >1\n   indented\n",
        "version:   1\ntags: [a,#b\n  c]\n",
        "version:   1\ntitle: 'a\u2028 b'\n",
        "version:   1 # a comment\x85size: [3, 3]\n",
        "version:   1\ntitle: &t size\n*t : [3, 3]\n",
        "? >-\n  version\n: 1\n",
        "{}\n",
    ],
    ids=range(11),
)
def test_unusual_texts_are_left_as_they_are(text: str, tmp_path: Path) -> None:
    path = tmp_path / "themes" / "mine.yaml" if text == "{}\n" else None
    result = format_source(SourceFile("mine.yaml", text), path)
    assert result.kept
    assert result.text == text


@pytest.mark.parametrize(
    "spoilt",
    ["version: 1\n# why\nsize: [4, 4]\n", "version: 1\nsize: [3, 3]\n", "version: [\n", "# why\n"],
    ids=["data", "comments", "syntax", "nothing"],
)
def test_a_text_that_would_not_say_the_same_is_left(
    spoilt: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The formatter trusts nobody, itself included."""
    text = "version:   1\n# why\nsize: [3, 3]\n"
    assert reason(text) is None
    monkeypatch.setattr(formatting, "lines_of", lambda tree: spoilt.splitlines())
    assert reason(text) == "any other form would change its meaning"


# -- lines -------------------------------------------------------------------------------------


def test_line_ends_stay_those_of_the_first_line() -> None:
    assert brl.format("size: [3,3]\r\nversion: 1\n") == "version: 1\r\nsize: [3, 3]\r\n"
    assert brl.format("size: [3,3]\nversion: 1\r\n") == "version: 1\nsize: [3, 3]\n"
    assert brl.format("size: [3,3]\rversion: 1\r") == "version: 1\nsize: [3, 3]\n"
    assert brl.format("version: 1") == "version: 1\n"
    map_ = "map: |\r\n  +---+---+\r\n  | S   E |\r\n  +---+---+\r\n"
    assert brl.format(f"{map_}version: 1\r\n") == f"version: 1\r\n{map_}"


def test_a_mark_at_the_beginning_is_dropped() -> None:
    assert brl.format("\ufeffversion: 1\n") == "version: 1\n"


def test_the_last_line_of_a_text_that_keeps_its_line_ends() -> None:
    text = "version: 1\ntitle: |+\n  A title\n\n\n"
    assert brl.format(text) == text


def test_a_block_that_begins_with_a_tab() -> None:
    text = "version: 1\ntitle: |2\n  \tIndented\n"
    assert brl.format(text) == text


# -- time --------------------------------------------------------------------------------------


def test_small_files_are_formatted_quickly() -> None:
    walls = "".join(f"- at: [{n}, 1]\n  side: E # {n}\n" for n in range(10))
    text = f"size: [20, 5]\nwalls:\n{walls}version: 1\n"
    brl.format(text)
    with counted_calls() as work:
        brl.format(text)
    assert work.calls < 40_000, work


@pytest.mark.slow
@pytest.mark.parametrize(
    "text",
    [
        pytest.param("version: 1\n" + "\n" * 200_000, marks=pytest.mark.sweep),
        pytest.param("version: 1\n" + "# c\n" * 20_000, marks=pytest.mark.sweep),
        "version: 1\ntags: [\n" + "a, # c\n" * 4_000 + "]\n",
        "version: 1\nsize: [3, 3]\nstart: [" + "[0, 0],\n" * 10_000 + "]\n",
        pytest.param(
            "version: 1\ndescription: '" + "word\n  " * 40_000 + "'\n", marks=pytest.mark.sweep
        ),
        "version: 1\ndescription: |\n" + " # no comment\n" * 30_000,
    ],
    ids=["blank lines", "comments", "comments in brackets", "entries", "quoted", "literal"],
)
def test_long_files(text: str) -> None:
    with counted_calls() as work, suppress(LevelError):
        result = brl.format(text)
        assert brl.format(result) == result
    assert work.calls < 5_000_000, work


# -- from Python -------------------------------------------------------------------------------


def test_one_level_is_formatted_and_written_if_asked_for(here: Path) -> None:
    path = here / "mine.yaml"
    path.write_text("size: [3,3]\nversion: 1\n", encoding="utf-8")
    canonical = "version: 1\nsize: [3, 3]\n"
    forms: list[Any] = [path, str(path), {"size": [3, 3], "version": 1}, [path]]
    for form in forms:
        assert brl.format(form) == canonical
    assert path.read_text("utf-8") != canonical
    assert brl.format(path, write=True) == path.read_text("utf-8") == canonical
    assert brl.format("final-maze") == brl.load("final-maze").to_yaml(comments=True)
    with pytest.raises(ValueError, match="takes one level, not 2"):
        brl.format([path, path])
    with pytest.raises(ValueError, match="from no file"):
        brl.format(canonical, write=True)


FOLDER = TESTS / "language" / "formatting" / "cases"
NAMES = [path.name.removesuffix(".in.yaml") for path in sorted(FOLDER.glob("*.in.yaml"))]


def text_of(name: str) -> str:
    return (FOLDER / name).read_text(encoding="utf-8")


def formatted(text: str) -> str:
    result = format_source(SourceFile("case.yaml", text))
    assert result.kept is None
    return result.text


@pytest.mark.parametrize("name", NAMES)
def test_the_canonical_form(name: str) -> None:
    canonical = text_of(f"{name}.out.yaml")
    assert formatted(text_of(f"{name}.in.yaml")) == formatted(canonical) == canonical


def test_every_case_is_a_pair() -> None:
    assert NAMES
    assert {path.name for path in FOLDER.iterdir()} == {
        f"{name}.{kind}.yaml" for name in NAMES for kind in ("in", "out")
    }
