"""What is said of files that go too far: the right thing, at the right place, in few words."""

from __future__ import annotations

import pytest

from babyrobot_levels import validate
from babyrobot_levels.language.checks import MAX_PROBLEMS
from babyrobot_levels.library.level import loads
from babyrobot_levels.text.diagnostics import Diagnostic
from babyrobot_levels.text.source import Position


def only(text: str) -> Diagnostic:
    (found,) = validate(text)
    return found


def test_a_second_byte_order_mark_is_no_text() -> None:
    assert loads("\ufeffversion: 1\n").size == (3, 3)
    found = only("\ufeff\ufeffversion: 1\n")
    assert (found.code, found.line, found.column) == ("BR104", 1, 1)
    assert "U+FEFF" in found.message


def test_some_tag_directives_do_no_harm_and_many_are_refused() -> None:
    directives = [f"%TAG !a{number}! tag:x\n" for number in range(101)]
    assert validate("".join(directives[:100]) + "---\nversion: 1\n") == []
    found = only("".join(directives) + "---\nversion: 1\n")
    assert (found.code, found.line) == ("BR107", 101)


def test_too_many_values_are_not_laid_on_aliases_that_are_not_there() -> None:
    listed = "a, " * 100_001
    assert only(f"version: 1\ntags: [{listed}]\n").message.startswith("the file has")
    aliases = "- *a\n" * 40_000
    expanded = only(f"a: &a [x, y]\ntags:\n{aliases}")
    assert (expanded.code, expanded.message.partition(" more")[0]) == ("BR108", "aliases expand to")


@pytest.mark.parametrize("field", ["start", "exit"])
def test_a_list_of_faulty_cells_is_not_called_empty(field: str) -> None:
    found = only(f"version: 1\n{field}: [[x, 1]]\n")
    assert found.message == f"`{field}[0][0]` must be an integer from 0 on, not `x`"
    assert [each.code for each in validate(f"version: 1\n{field}: []\n")] == ["BR203"]


@pytest.mark.parametrize(
    "text",
    [
        "? {long}\n: 1\n",
        "legend: {{{long}: {{reward: x}}}}\nmap: x\n",
        '"{long}": 1\n"{long}": 1\n',
        "title: *{long}\n",
        "title: &{long} [*{long}]\n",
        "title: !{long} x\n",
        "max_steps: !!int {long}\n",
        "size: {long}\n",
        "size: [{long}, 1]\n",
        "theme: {long}\n",
        "maze: {{seed: {long}}}\n",
    ],
)
def test_long_names_are_shortened(text: str) -> None:
    found = validate("version: 1\n" + text.format(long="n" * 5000))
    assert found
    for diagnostic in found:
        assert len(str(diagnostic)) < 900


def test_so_many_faults_are_told_and_no_more() -> None:
    text = "version: 1\n" + "".join(f"f{number}: 1\n" for number in range(MAX_PROBLEMS + 1))
    assert len(validate(text)) == MAX_PROBLEMS
    assert len(validate(text.replace("f0: 1\n", ""))) == MAX_PROBLEMS


@pytest.mark.parametrize(
    ("text", "place"),
    [
        ("version: 1\ntitle: 'x\ny: 1", Position(2, 8)),
        ("version: [1", Position(1, 10)),
        ("version: 1\nmap: |\n  +---+---+\n  | S\n  +---+---+\n", Position(4, 6)),
        ("- a\nb", Position(2, 1)),
        ("a: b: c", Position(1, 5)),
        ("a:\n\t", Position(2, 1)),
    ],
)
def test_carets_stay_on_their_line(text: str, place: Position) -> None:
    lines = text.split("\n")
    for found in validate(text + "\n"):
        assert found.end.column <= len(lines[found.end.line - 1]) + 1
    assert place in [found.span.start for found in validate(text + "\n")]


def test_overlapping_areas_are_painted_in_turn() -> None:
    """The last area that says whether it ends the episode counts, whatever their shapes are."""
    size = "version: 1\nsize: [7, 5]\nstart: [3, 2]\n"
    wide, high = "{at: [0, 2], size: [7, 1], ends: %s}", "{at: [3, 0], size: [1, 5], ends: %s}"
    left, right = "{at: [0, 0], size: [3, 5], ends: true}", "{at: [4, 0], size: [3, 5], ends: true}"

    def codes(*areas: str) -> list[str]:
        return [each.code for each in validate(size + "areas:\n- " + "\n- ".join(areas) + "\n")]

    assert codes(wide % "true") == codes(high % "true") == ["BR316"]
    assert codes(wide % "true", high % "false") == codes(high % "true", wide % "false") == []
    assert codes(wide % "false", high % "true") == ["BR316"]
    assert codes(wide % "true", "{at: [3, 2]}") == ["BR316"]
    assert codes(left, right) == []
    # What is on the grid of an area that goes beyond it counts all the same.
    assert codes(high.replace("5", "9") % "true") == ["BR316", "BR301"]


@pytest.mark.parametrize("size", [(1, 5), (7, 1), (3, 4), (4, 3), (7, 5)])
@pytest.mark.parametrize("at", [(0, 0), (2, 1), (3, 2)])
def test_blocked_rectangles_block_what_they_cover(
    size: tuple[int, int], at: tuple[int, int]
) -> None:
    (width, height), (x, y) = size, at
    blocked = f"blocked: [{{at: {[*at]}, size: {[*size]}}}]\n"
    for column in range(7):
        for row in range(5):
            start = f"start: [{column}, {row}]\nexit: none\n"
            codes = [each.code for each in validate(f"version: 1\nsize: [7, 5]\n{start}{blocked}")]
            covered = x <= column < x + width and y <= row < y + height
            assert ("BR302" in codes) == covered
