"""Texts to data with positions: YAML 1.2's scalars, places, and limits."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.work import counted_calls

from babyrobot_levels.text.diagnostics import Key
from babyrobot_levels.text.document import Document
from babyrobot_levels.text.errors import LevelError
from babyrobot_levels.text.files import read_source, source_of
from babyrobot_levels.text.reader import MAX_DEPTH
from babyrobot_levels.text.reader import read as read_file
from babyrobot_levels.text.source import MAX_BYTES, Position, SourceFile


def read(text: str) -> Document:
    return read_file(SourceFile("x.yaml", text))


def fault(text: str) -> tuple[str, Position]:
    """Return code and place of what keeps the text from being read."""
    with pytest.raises(LevelError) as caught:
        read(text)
    (found,) = caught.value.diagnostics
    return found.code, found.span.start


def value(scalar: str) -> Any:
    document = read(f"key: {scalar}\n")
    assert not document.issues
    return document.data["key"]


# -- scalars -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("10", 10),
        ("-10", -10),
        ("+10", 10),
        ("010", 10),
        ("0o10", 8),
        ("0x1F", 31),
        ("1e3", 1000.0),
        ("1.", 1.0),
        (".5", 0.5),
        ("-.5e-1", -0.05),
        (".inf", math.inf),
        ("-.INF", -math.inf),
        ("true", True),
        ("TRUE", True),
        ("null", None),
        ("~", None),
        ("", None),
        ("''", ""),
    ],
)
def test_scalars_of_the_core_schema(text: str, expected: object) -> None:
    found = value(text)
    assert found == expected
    assert type(found) is type(expected)


def test_not_a_number() -> None:
    assert math.isnan(value(".nan"))
    assert math.isnan(value(".NaN"))


@pytest.mark.parametrize(
    "text",
    [
        "yes",
        "off",
        "tRue",
        "12:30:00",
        "2024-01-01",
        "1_000",
        "0b11",
        "0O10",
        "0xg",
        "1e",
        "1.2.3",
        "-",
        "+.nan",
        "inf",
        "=",
        "<<",
    ],
)
def test_texts_that_other_readers_take_for_something_else(text: str) -> None:
    if text == "-":
        assert value("['-']") == ["-"]
    else:
        assert value(text) == text


@pytest.mark.parametrize("text", ["yes", "10", "null", "~", "1e3", ".nan", "true"])
def test_what_is_quoted_is_a_text(text: str) -> None:
    assert value(f"'{text}'") == text
    assert value(f'"{text}"') == text
    assert value(f"! {text}") == text
    assert value(f"!!str {text}") == text


def test_keys_are_the_texts_that_stand_there() -> None:
    document = read("1: a\nno: b\n010: c\n~: d\n'1.0': e\n0x1: f\ntrue: g\n")
    assert list(document.data) == ["1", "no", "010", "~", "1.0", "0x1", "true"]


def test_merge_keys_are_ordinary_keys() -> None:
    assert read("a: &a {b: 1}\n<<: *a\n").data == {"a": {"b": 1}, "<<": {"b": 1}}


def test_core_tags_are_read() -> None:
    assert read("{a: !!int 5, b: !!float 5, c: !!str 5, d: !!seq [], e: !!map {}}").data == {
        "a": 5,
        "b": 5,
        "c": "5",
        "d": [],
        "e": {},
    }


@given(
    st.recursive(
        st.none()
        | st.booleans()
        | st.integers(-(10**12), 10**12)
        | st.text("ab1 :#-,[]{}'\"\\\n\té", max_size=8),
        lambda inner: (
            st.lists(inner, max_size=3) | st.dictionaries(st.text("abc", min_size=1), inner)
        ),
        max_leaves=8,
    )
)
def test_what_is_json_reads_as_json(data: object) -> None:
    import json

    assert read(json.dumps(data, ensure_ascii=False)).data == data


# -- places ------------------------------------------------------------------------------------


def place(document: Document, *route: str | int, key: bool = False) -> tuple[int, int, int, int]:
    start, end = document.span(Key(route) if key else route)
    return (*start, *end)


BLOCK = """\
version: 1
walls:
  - at: [0, 1]
    side: E   # east
  -
    at:
      - 2
      - 3
"""


@pytest.mark.parametrize(
    ("route", "key", "expected"),
    [
        (("version",), False, (1, 10, 1, 11)),
        (("version",), True, (1, 1, 1, 8)),
        (("walls",), True, (2, 1, 2, 6)),
        (("walls", 0, "at"), False, (3, 9, 3, 15)),
        (("walls", 0, "at", 1), False, (3, 13, 3, 14)),
        (("walls", 0, "side"), False, (4, 11, 4, 12)),
        (("walls", 0, "side"), True, (4, 5, 4, 9)),
        (("walls", 1, "at", 1), False, (8, 9, 8, 10)),
        # A route that goes deeper than the file gives the deepest part that is there.
        (("walls", 0, "at", 7), False, (3, 9, 3, 15)),
        (("walls", 0, "length"), False, (3, 5, 4, 12)),
    ],
)
def test_places_in_block_style(
    route: tuple[str | int, ...], key: bool, expected: tuple[int, ...]
) -> None:
    assert place(read(BLOCK), *route, key=key) == expected


def test_places_in_flow_style() -> None:
    document = read("{version: 1,\n walls: [{at: [0, 1],\n  side: E}]}")
    assert place(document, "walls", 0, "at", 1) == (2, 19, 2, 20)
    assert place(document, "walls", 0, "side", key=True) == (3, 3, 3, 7)
    assert place(document, "walls", 0) == (2, 10, 3, 11)
    assert place(document) == (1, 1, 3, 13)


def test_places_behind_wide_characters_count_characters() -> None:
    document = read("# 🤖🤖\nkey: {a: '迷路🤖', b: 2}\n")
    assert place(document, "key", "b") == (2, 20, 2, 21)


def test_a_byte_order_mark_is_no_character() -> None:
    document = read("\ufeffversion: 1\nsize: 3\n")
    assert place(document, "version") == (1, 10, 1, 11)
    assert place(document, "size") == (2, 7, 2, 8)
    assert document.source.line(1).removeprefix("\ufeff") == "version: 1"


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_all_line_ends_count(end: str) -> None:
    document = read(end.join(["a: 1", "# comment", "", "b: |", "  x", "  y", "c: 'd", "  e'", ""]))
    assert place(document, "a") == (1, 4, 1, 5)
    assert place(document, "c") == (7, 4, 8, 5)
    assert document.data == {"a": 1, "b": "x\ny\n", "c": "d e"}
    assert document.source.line(7) == "c: 'd"


def test_tabs_count_as_one_character() -> None:
    assert place(read("a:\t\tb\n"), "a") == (1, 5, 1, 6)


@pytest.mark.parametrize("separator", ["\x85", "\u2028", "\u2029"])
def test_unicode_separators_end_no_line(separator: str) -> None:
    """YAML 1.1 took them for line ends; editors, and YAML 1.2, do not."""
    document = read(f"a: 'x{separator}y'\nb: 2\n")
    assert place(document, "b") == (2, 4, 2, 5)


def test_an_alias_stands_where_it_stands() -> None:
    document = read("a: &a [1, 2]\nb: *a\n")
    assert document.data["b"] == [1, 2]
    assert place(document, "b") == (2, 4, 2, 6)


def test_an_empty_value_stands_behind_its_key() -> None:
    assert read("a:\nb: 1\n").span(("a",)).start == (1, 3)


# -- faults that do not stop it ----------------------------------------------------------------


def problems(text: str) -> list[tuple[str, Position]]:
    document = read(text)
    return [(issue.code, document.span(issue.location).start) for issue in document.issues]


def test_duplicate_keys() -> None:
    assert problems("a: 1\nb: {c: 1, d: 2, c: 3}\na: 2\n") == [
        ("BR105", (2, 17)),
        ("BR105", (3, 1)),
    ]
    assert read("a: 1\na: 2\n").data == {"a": 1}
    assert problems("1: a\n'1': b\n") == [("BR105", (2, 1))]


def test_keys_that_are_no_texts() -> None:
    assert problems("[1, 2]: 3\n") == [("BR203", (1, 1))]
    assert problems("? {a: 1}\n: 3\n") == [("BR203", (1, 3))]


def test_numbers_that_are_too_long() -> None:
    assert problems(f"a: {'9' * 5000}\n") == [("BR111", (1, 4))]
    assert problems(f"a: -{'9' * 39}\n") == []
    assert value("0x" + "f" * 38) == int("f" * 38, 16)


def test_tags_that_do_not_fit_their_value() -> None:
    assert problems("a: !!int x\nb: !!bool 1\nc: !!null x\n") == [
        ("BR107", (1, 4)),
        ("BR107", (2, 4)),
        ("BR107", (3, 4)),
    ]


# -- faults that stop it -----------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "code", "place"),
    [
        ("a: 1\n---\nb: 2\n", "BR106", (2, 1)),
        ("a: 1\n...\nb: 2\n", "BR104", (3, 1)),
        ("a: !!python/name:os.system x\n", "BR107", (1, 4)),
        ("a: !custom [1]\n", "BR107", (1, 4)),
        ("a: !!set {b}\n", "BR107", (1, 4)),
        ("a: !!timestamp 2001-01-01\n", "BR107", (1, 4)),
        ("a: !!binary aGVsbG8=\n", "BR107", (1, 4)),
        ("a: !!seq x\n", "BR107", (1, 4)),
        ("a: *b\n", "BR108", (1, 4)),
        ("a: &a [*a]\n", "BR108", (1, 8)),
        ("&a a: &b {c: [*b]}\n", "BR108", (1, 15)),
        ("a: b: c\n", "BR104", (1, 5)),
        ("a:\n\t- b\n", "BR104", (2, 1)),
        ("a: 'x\x07'\n", "BR104", (1, 6)),
        ("a: 1\nb: \x00\n", "BR104", (2, 4)),
        ("\ufeffa: 1\nb: \x1b\n", "BR104", (2, 4)),
        ("a: 1\r\nb: \x7f\r\n", "BR104", (2, 4)),
        ("a: 1\rb: \x08\r", "BR104", (2, 4)),
        ("a: \ud800\n", "BR104", (1, 4)),
        ("a: @b\n", "BR104", (1, 4)),
    ],
)
def test_faults(text: str, code: str, place: tuple[int, int]) -> None:
    assert fault(text) == (code, place)


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("a: [1, 2\n", 1),
        ("a:\n  b: {c: 1\n", 2),
        ("a: 'open\n\n\n", 1),
        ('a: 1\nb: "open\nc: 2\n', 2),
        ("a: 1\nb [1]\nc: 2\n", 2),
        ("a: 1\nb\n", 2),
    ],
)
def test_what_is_not_closed_is_shown_where_it_begins(text: str, line: int) -> None:
    """And not at the end of the file, where there is nothing to see."""
    assert fault(text)[1].line == line


def test_depth_is_limited() -> None:
    deep = "[" * (MAX_DEPTH - 1) + "]" * (MAX_DEPTH - 1)
    assert read(f"a: {deep}\n").data
    assert fault(f"a: [{deep}]\n") == ("BR109", (1, 3 + MAX_DEPTH))
    block = "".join(" " * depth + "a:\n" for depth in range(MAX_DEPTH + 1))
    assert fault(block)[0] == "BR109"


def bomb(width: int, height: int) -> str:
    lines = ["a0: &a0 [x]\n"]
    lines += [f"a{n}: &a{n} [{', '.join([f'*a{n - 1}'] * width)}]\n" for n in range(1, height)]
    return "".join(lines)


def bomb_of_mappings(height: int) -> str:
    lines = ["a0: &a0 {x: 1}\n"]
    lines += [f"a{n}: &a{n} {{x: *a{n - 1}, y: *a{n - 1}}}\n" for n in range(1, height)]
    return "".join(lines)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("make", "code"),
    [
        (lambda: "a: " + "[" * 100_000, "BR109"),
        (lambda: "{a: " * 100_000, "BR109"),
        (lambda: "- " * 100_000, "BR109"),
        (lambda: "? " * 100_000, "BR109"),
        (lambda: bomb(9, 30), "BR108"),
        (lambda: bomb_of_mappings(60), "BR108"),
        (lambda: "a: &a [*a, " + "*a, " * 1000 + "]", "BR108"),
        (lambda: "".join(f"a{n}: &anchor{n} 1\n" for n in range(3_000)) + "b: *anchr\n", "BR108"),
        (lambda: 'a: "' + "x\n" * 40_000, "BR104"),
        (lambda: "a: &" + "x" * 500_000 + " 1\nb: *y\n", "BR108"),
    ],
    ids=range(10),
)
def test_texts_that_mean_harm_are_refused_quickly(make: Callable[[], str], code: str) -> None:
    text = make()
    with counted_calls() as work:
        assert fault(text)[0] == code
    assert work.calls < 1_000_000, work


def test_an_empty_text_is_nothing() -> None:
    assert read("").data is None
    assert read("# only this\n").data is None


# -- files -------------------------------------------------------------------------------------


def read_fault(path: Path) -> tuple[str, int, int]:
    with pytest.raises(LevelError) as caught:
        read_source(path)
    found = caught.value.diagnostics[0]
    return found.code, found.line, found.column


def test_files_are_read_as_utf8_without_their_mark(tmp_path: Path) -> None:
    path = tmp_path / "x.yaml"
    path.write_bytes(b"\xef\xbb\xbfa: \xe8\xbf\xb7\r\n")
    source = read_source(path)
    assert (source.text, source.name) == ("a: 迷\r\n", str(path))
    assert read_source(path, "short").name == "short"


def test_a_file_may_hold_a_mebibyte_and_not_a_byte_more(tmp_path: Path) -> None:
    path = tmp_path / "x.yaml"
    path.write_bytes(b"#" * MAX_BYTES)
    assert len(read_source(path).text) == MAX_BYTES
    path.write_bytes(b"#" * (MAX_BYTES + 1))
    assert read_fault(path) == ("BR103", 1, 1)


@pytest.mark.parametrize(
    ("data", "place"),
    [
        (b"\xff", (1, 1)),
        (b"a: 1\nb: \xf6\n", (2, 4)),
        ("迷路".encode() + b"\xff", (1, 3)),
        ("a: 迷".encode("utf-16"), (1, 1)),
        (b"\xef\xbb\xbfa\xff", (1, 2)),
        (b"a: 1\r" + "é".encode() + b"\xe9\r", (2, 2)),
        (b"\xef\xbb\xbfa: 1\r\n" + "é".encode() + b"\xe9\r\n", (2, 2)),
    ],
)
def test_bytes_that_are_not_utf8(data: bytes, place: tuple[int, int]) -> None:
    """The column counts characters, here as everywhere."""
    with pytest.raises(LevelError) as caught:
        source_of(data, "x.yaml")
    found = caught.value.diagnostics[0]
    assert (found.code, (found.line, found.column)) == ("BR102", place)
