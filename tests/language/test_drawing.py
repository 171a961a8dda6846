"""The ASCII drawing, both ways, and what its faults are told like."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import Any

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from support.worlds import LEGEND, World, drawings, level_of, level_of_text, worlds

from babyrobot_levels.language import drawing as d
from babyrobot_levels.language import parsing
from babyrobot_levels.language.drawing import consecutive, rectangles, runs
from babyrobot_levels.language.validation import parse as load
from babyrobot_levels.library.level import Level
from babyrobot_levels.text.diagnostics import Diagnostic, Issue, Mark
from babyrobot_levels.text.source import SourceFile

MAX_SIZE = 1024
SHOWN = """\
+---+---+---+
| S     |   |
+   +---+- -+
|###  o : E |
+---+---+---+
"""


def parse(text: str, known: str = "~x9") -> tuple[d.Drawing | None, list[Issue]]:
    return parsing.parse(text, lambda character: character in known, MAX_SIZE)


def mark(issue: Issue) -> tuple[int, int, int]:
    """Return row, column and length of what an issue points to."""
    assert isinstance(issue.location, Mark)
    return issue.location.row, issue.location.column, issue.location.length


def drawn(text: str, **fields: Any) -> Level:
    return level_of({"version": 1, "map": text, **fields})


# -- both ways -------------------------------------------------------------------------------


@pytest.mark.slow
@given(drawings(marks=" |:/"))
def test_what_is_composed_parses_to_the_same(drawing: d.Drawing) -> None:
    text = d.compose(drawing)
    assert parse(text) == (drawing, [])
    assert d.compose(drawing) == text


@given(drawings())
@pytest.mark.slow
def test_the_drawing_of_a_drawn_level_stays_the_same(drawing: d.Drawing) -> None:
    """Draw, parse, draw. Walls that nobody can meet may get lost the first time."""
    first = drawn(d.compose(drawing), legend=LEGEND).draw()
    assert drawn(first, legend=LEGEND).draw() == first


def doors_of(drawing: d.Drawing) -> list[World]:
    """Return an entry for each drawn door, from one of its sides."""
    return [
        {"at": list(cell), "side": side, "length": length}
        for cell, side, length in drawing.runs(d.DOOR)
    ]


@given(drawings(cells=" SEoO~x9", marks=" |:/"))
def test_doors_are_drawn_as_they_were_drawn(drawing: d.Drawing) -> None:
    text = d.compose(drawing)
    level = drawn(text, legend=LEGEND, doors=doors_of(drawing))
    assert level.draw() == text
    # All of them are open, as nothing closes them.
    without = drawn(text.replace("-/-", "   ").replace("/", " "), legend=LEGEND)
    assert (level.grid().open == without.grid().open).all()


@given(worlds())
def test_the_drawing_of_any_level_can_be_pasted_back(world: World) -> None:
    level = level_of(world)
    copy = drawn(level.draw())
    assert copy.draw() == level.draw()
    assert copy.size == level.size
    assert set(copy.starts) == set(level.starts)
    assert set(copy.exits) == set(level.exits)
    assert (copy.grid().open == level.grid().open).all()
    assert (copy.grid().blocked == level.grid().blocked).all()
    assert copy.grid().glass.keys() == level.grid().glass.keys()


@given(drawings())
def test_a_drawing_is_the_same_game_as_its_fields(drawing: d.Drawing) -> None:
    level = drawn(d.compose(drawing), legend=LEGEND)
    fields: World = {
        "version": 1,
        "size": [drawing.width, drawing.height],
        "start": [list(cell) for cell in drawing.find("S")],
        "exit": [list(cell) for cell in drawing.find("E")] or "none",
        "puddles": [{"at": list(cell)} for cell in drawing.find("o")]
        + [{"at": list(cell), "size": "large"} for cell in drawing.find("O")],
        "blocked": [{"at": list(cell)} for cell in drawing.find("#")],
        "areas": [
            {"at": list(cell), **traits}
            for character, traits in LEGEND.items()
            for cell in drawing.find(character)
        ],
        "walls": [
            {"at": [x, y], "side": side} | ({"pass": 0.5} if mark == d.GLASS else {})
            for side, rows in (("E", drawing.east), ("S", drawing.south))
            for y, row in enumerate(rows)
            for x, mark in enumerate(row)
            if mark != d.OPEN
        ],
    }
    assert level_of(fields).digest == level.digest


def test_a_drawing_says_all_the_fields_it_stands_for() -> None:
    level = drawn(SHOWN)
    assert level.size == (3, 2)
    assert level.start == (0, 0)
    assert level.exit == (2, 1)
    assert [(p.at, p.size) for p in level.puddles] == [((1, 1), "small")]
    assert [(r.at, r.size) for r in level.blocked] == [((0, 1), (1, 1))]
    assert level.grid().glass == {(2, "S"): 0.5, (5, "N"): 0.5, (4, "E"): 0.5, (5, "W"): 0.5}


def test_many_starts_and_no_exit() -> None:
    level = drawn("+---+---+\n| S   S |\n+---+---+\n")
    assert level.starts == ((0, 0), (1, 0))
    assert level.exit == "none"


def test_a_wall_entry_gives_drawn_glass_its_probability() -> None:
    level = drawn(SHOWN, walls=[{"at": [2, 0], "side": "S", "pass": 0.25, "color": "red"}])
    assert level.grid().glass[2, "S"] == 0.25
    assert level.grid().glass[4, "E"] == 0.5
    assert level.draw() == SHOWN
    colored = drawn(SHOWN, walls=[{"at": [2, 0], "side": "S", "color": "red"}])
    assert colored.grid().glass[2, "S"] == 0.5


def test_areas_beside_a_map_lie_on_the_legend() -> None:
    text = "+---+---+\n| S   ~ |\n+---+---+\n"
    legend = {"~": {"reward": -3, "skid": 0.5}}
    level = drawn(text, legend=legend, areas=[{"at": [1, 0], "reward": -8}])
    ((_, _, reward, _),) = level.compile().outcomes(0, 2)
    assert reward == -8
    assert len(level.compile().outcomes(1, 4)) == 2


def test_openings_and_mazes_go_with_a_drawing() -> None:
    level = drawn(SHOWN, openings=[{"at": [1, 0], "side": "E"}])
    assert level.draw() == SHOWN.replace("| S     |   |", "| S         |")
    assert drawn(SHOWN, maze={"seed": 1}).draw() != SHOWN


def test_a_start_hides_a_puddle() -> None:
    level = level_of({"version": 1, "size": [2, 1], "puddles": [{"at": [0, 0]}]})
    assert level.draw() == "+---+---+\n| S   E |\n+---+---+\n"


# -- what does not matter ----------------------------------------------------------------------


@given(drawings(4), st.integers(0, 5), st.integers(0, 3), st.integers(0, 3), st.data())
def test_indentation_blank_lines_and_blanks_at_the_end_do_not_matter(
    drawing: d.Drawing, indent: int, before: int, after: int, data: st.DataObject
) -> None:
    lines = d.compose(drawing).splitlines()
    ends = [" " * data.draw(st.integers(0, 3)) for _ in lines]
    blank = [" " * data.draw(st.integers(0, 9)) for _ in range(before + after)]
    shown = [" " * indent + line + end for line, end in zip(lines, ends, strict=True)]
    text = "\n".join([*blank[:before], *shown, *blank[before:]])
    assert parse(text) == (drawing, [])


@given(drawings(3), st.data())
def test_a_drawing_with_one_other_character_is_faulty_or_another_drawing(
    drawing: d.Drawing, data: st.DataObject
) -> None:
    text = d.compose(drawing)
    place = data.draw(st.integers(0, len(text) - 1))
    character = data.draw(st.sampled_from("+-|:/ #SEoO~?\n\t"))
    assume(text[place] != character)
    changed = text[:place] + character + text[place + 1 :]
    other, problems = parse(changed)
    if other is None:
        assert problems
        lines = changed.split("\n")
        for problem in problems:
            row, column, length = mark(problem)
            assert 0 <= row < len(lines)
            assert 0 <= column <= len(lines[row])
            assert length >= 1
    else:
        assert not problems
        assert parse(d.compose(other)) == (other, [])


# -- faults ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "row", "column", "length", "message"),
    [
        ("", 0, 0, 1, "empty"),
        ("+--+\n| S|\n+--+", 0, 0, 4, "first line"),
        ("+---+", 0, 0, 5, "ends in the middle"),
        ("+---+\n| S |", 1, 0, 5, "ends in the middle"),
        ("+---+\n| S |\n+---+\n| S |", 3, 0, 5, "ends in the middle"),
        ("+---+\n| S  |\n+---+", 1, 4, 1, "has 6 characters, the first one has 5"),
        ("+---+\n| S\n+---+", 1, 3, 1, "has 3 characters, the first one has 5"),
        ("+---+\n\n+---+", 0, 0, 5, "below this line is an empty one"),
        ("*---+\n| S |\n+---+", 0, 0, 1, "expected the corner `+`, found `*`"),
        ("+---+\n| S |\n+ - +\n|   |\n+---+", 2, 1, 3, "` - ` is not a wall"),
        ("+---+\n| S |\n+ / +\n|   |\n+---+", 2, 1, 3, "` / ` is not a wall"),
        ("+-/-+\n| S |\n+---+", 0, 1, 3, "the outer wall must be solid"),
        ("+---+\n/ S |\n+---+", 1, 0, 1, "the outer wall must be solid"),
        ("+---+\n| / |\n+---+", 1, 2, 1, "`/` is in the middle of the cell [0, 0]"),
        ("+   +\n| S |\n+---+", 0, 1, 3, "the outer wall must be solid"),
        ("+---+\n: S |\n+---+", 1, 0, 1, "the outer wall must be solid"),
        ("+---+---+\n| S ;   |\n+---+---+", 1, 4, 1, "`;` is between two cells"),
        ("+---+\n|SS |\n+---+", 1, 1, 2, "`SS` is more than one character"),
        ("+---+\n|## |\n+---+", 1, 1, 2, "`##` is not a cell"),
        ("+---+\n| ? |\n+---+", 1, 2, 1, "`?` is not in the legend"),
        ("\n  +---+\n  | ? |\n  +---+", 2, 4, 1, "is not in the legend"),
    ],
)
def test_faults(text: str, row: int, column: int, length: int, message: str) -> None:
    drawing, problems = parse(text)
    assert drawing is None
    assert (row, column, length) in map(mark, problems)
    (fault,) = [p for p in problems if mark(p)[:2] == (row, column)]
    assert message in fault.message


def test_all_faults_are_told_at_once() -> None:
    _, problems = parse("+---+---+\n| ?   ! |\n+ - + - +\n|SS     ;\n+---+---*\n")
    assert [mark(p)[:2] for p in problems] == [
        (1, 2),
        (1, 6),
        (2, 1),
        (2, 5),
        (3, 1),
        (3, 8),
        (4, 8),
    ]


@given(drawings(), st.data())
def test_a_mark_beside_its_place_is_told_and_put_back(
    drawing: d.Drawing, data: st.DataObject
) -> None:
    rows = d.compose(drawing).splitlines()
    places = [
        (number, *token.span())
        for number in range(1, len(rows), 2)
        for token in re.finditer(r"###|[^ |]|(?<=[^+])\|(?=.)", rows[number])
    ]
    number, first, last = data.draw(st.sampled_from(places))
    off, row = data.draw(st.sampled_from([-1, 1])), rows[number]
    assume(row[first - 1 if off < 0 else last] == " ")
    mark = row[first:last]
    moved = row[:first] + " " * len(mark) + row[last:]
    moved = moved[: first + off] + mark + moved[last + off :]
    changed = "\n".join([*rows[:number], moved, *rows[number + 1 :]])
    found, (fault, *others) = parse(changed)
    assert found is None
    assert not others
    assert f"`{mark}` is one column {'left' if off < 0 else 'right'} of" in fault.message
    assert fault.redrawn == ((Mark(number, 0, len(row)), row),)


@given(drawings(largest=3), st.data())
def test_a_drawing_is_read_or_something_is_told(drawing: d.Drawing, data: st.DataObject) -> None:
    text = d.compose(drawing)
    place = data.draw(st.integers(0, len(text) - 1))
    character = data.draw(st.sampled_from(["", *" \n+-|:/#SEok?\t\xa0│"]))
    found, faults = parse(text[:place] + character + text[place + 1 :])
    assert (found is None) == bool(faults)


def test_a_drawing_can_be_too_large() -> None:
    cells = "+---" * 5 + "+\n" + "|   " * 5 + "|\n" + "+---" * 5 + "+\n"
    assert parsing.parse(cells, lambda _: False, 5)[0] is not None
    drawing, problems = parsing.parse(cells, lambda _: False, 4)
    assert drawing is None
    assert "more than 4 columns or rows" in problems[0].message


# -- faults in a file --------------------------------------------------------------------------


def faults(text: str) -> list[Diagnostic]:
    level, diagnostics = load(SourceFile("level.yaml", text), Level)
    assert level is None
    return diagnostics


@pytest.mark.parametrize("indent", [1, 2, 4, 8])
@pytest.mark.parametrize("deeper", [0, 3])
@pytest.mark.parametrize("blank_lines", [0, 2])
def test_a_fault_points_into_the_file(indent: int, deeper: int, blank_lines: int) -> None:
    """The block may be indented more than once, and may begin with blank lines."""
    mark = f"|{indent}" if deeper else "|"
    lines = [" " * (indent + deeper) + line for line in ("+---+", "| ? |", "+---+")]
    text = "\n".join(["version: 1", f"map: {mark}", *[""] * blank_lines, *lines, ""])
    (fault,) = faults(text)
    assert fault.code == "BR312"
    assert (fault.line, fault.column) == (4 + blank_lines, indent + deeper + 3)
    assert fault.source is not None
    assert fault.source.line(fault.line)[fault.column - 1] == "?"


def test_a_fault_in_a_quoted_drawing_points_at_the_text() -> None:
    (fault,) = faults('version: 1\nmap: "+---+\\n| ? |\\n+---+"\n')
    assert (fault.code, fault.line, fault.column) == ("BR312", 2, 6)


def test_a_fault_in_a_drawing_behind_an_alias_points_at_a_place_in_the_file() -> None:
    text = "version: 1\ndescription: &drawing |\n  +---+\n  | ? |\n  +---+\nmap: *drawing\n"
    (fault,) = faults(text)
    assert fault.code == "BR312"
    assert (fault.line, fault.column) in [(6, 6), (4, 5)]


@pytest.mark.parametrize(
    "field", ["size: [1, 1]", "start: [0, 0]", "exit: none", "puddles: []", "blocked: []"]
)
def test_what_the_drawing_says_cannot_be_said_again(field: str) -> None:
    (fault,) = faults(f"version: 1\nmap: |\n  +---+\n  | S |\n  +---+\n{field}\n")
    assert (fault.code, fault.line, fault.column) == ("BR206", 6, 1)


def test_walls_beside_a_map_must_be_drawn() -> None:
    fields = """\
version: 1
walls:
  - {at: [0, 0], side: E, color: red}
  - {at: [0, 0], side: S, pass: 0.5}
  - {at: [1, 0], side: S, pass: 0}
  - {at: [0, 0], side: W}
map: |
  +---+---+
  | S     |
  +---+- -+
  |     E |
  +---+---+
"""
    assert [(f.code, f.line, f.column) for f in faults(fields)] == [
        ("BR314", 3, 5),
        ("BR314", 4, 33),
        ("BR314", 5, 33),
    ]


def test_a_drawn_text_level() -> None:
    text = "version: 1\nmap: |\n" + "".join(f"  {line}\n" for line in SHOWN.splitlines())
    assert level_of_text(text).draw() == SHOWN


@pytest.mark.parametrize(
    ("values", "wanted", "expected"),
    [
        ([], 1, []),
        ([0, 0], 1, []),
        ([1], True, [(0, 1)]),
        ([0, 1, 1, 0, 1], 1, [(1, 2), (4, 1)]),
        ("##  #", "#", [(0, 2), (4, 1)]),
        (b"\1\0\0\1", 0, [(1, 2)]),
    ],
)
def test_runs_have_a_start_and_a_length(
    values: Iterable[object], wanted: object, expected: list[object]
) -> None:
    assert list(runs(values, wanted)) == expected


def test_consecutive_items_are_on_one_line_and_one_place_apart() -> None:
    cells = [(0, 0), (0, 1), (0, 3), (1, 3), (1, 4), (2, 5)]
    found = list(consecutive(cells, lambda cell: (cell[0], cell[1])))
    assert found == [[(0, 0), (0, 1)], [(0, 3)], [(1, 3), (1, 4)], [(2, 5)]]
    assert list(consecutive([], lambda cell: cell)) == []


def test_rectangles_cover_each_mark_once() -> None:
    marks = bytes([1, 1, 0, 1, 1, 1, 0, 0, 0, 1, 1, 1])
    found = sorted(rectangles(marks, 4))
    assert found == [(0, 0, 2, 2), (1, 2, 3, 1), (3, 0, 1, 1)]
