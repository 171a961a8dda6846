"""The pictures of the site: which examples have one, and what is marked in them."""

from __future__ import annotations

import re

import pytest
from level_pictures.examples import Example, example_of
from support.reports import each_rule

from babyrobot_levels.linter.rule import Rule
from babyrobot_levels.linter.rules import all_pages
from babyrobot_levels.render.scene.marks import MARK
from babyrobot_levels.render.scene.shapes import Path
from babyrobot_levels.render.svg import to_svg

WALL = "version: 1\nwalls:\n  - {at: [1, 1], side: E}\n"

UNPLACED = {
    # About the text, or values of the whole level.
    *("BR104", "BR105", "BR106", "BR107", "BR108", "BR110", "BR111"),
    *("BR201", "BR203", "BR205", "BR206", "BR207", "BR208", "BR209"),
    *("BR317", "BR321", "BR326", "BR328", "BR330", "BR401", "BR403", "BR404", "BR405"),
    *(
        "BR512",
        "BR519",
        "BR520",
        "BR521",
        "BR522",
        "BR523",
        "BR525",
        "BR526",
        "BR533",
        "BR534",
        "BR539",
        "BR540",
    ),
    *("BR602", "BR604", "BR607", "BR609", "BR612", "BR699"),
    # Drawings that are none.
    *("BR312", "BR313", "BR314", "BR315", "BR329"),
}
"""Errors and rules whose findings are at no cell and no side that can be drawn."""

EXAMPLES = [page for page in all_pages() if "```yaml" in page.page]


def rings_of(example: Example) -> list[tuple[float, float, float, float]]:
    """Return left, top, right and bottom of each ring."""
    found = []
    for shape in [] if example.scene is None else example.scene.shapes:
        if isinstance(shape, Path) and shape.stroke == MARK:
            pieces = "".join(letter for letter, _ in shape.commands).split("Z")[:-1]
            rest = [numbers for _, numbers in shape.commands]
            for piece in pieces:
                numbers, rest = rest[: len(piece)], rest[len(piece) + 1 :]
                across = [x for each in numbers for x in each[::2]]
                down = [y for each in numbers for y in each[1::2]]
                found.append((min(across), min(down), max(across), max(down)))
    return found


def blocks_of(page: Rule) -> list[str]:
    return re.findall(r"```yaml\n(.*?)```", page.page, re.DOTALL)


def test_a_level_has_a_picture_in_which_nothing_is_marked() -> None:
    example = example_of(WALL)
    assert example.scene is not None
    assert "grid of 3 columns and 3 rows" in example.scene.description
    assert rings_of(example) == []
    assert (example.lines, example.messages) == ((), "")


def test_a_fragment_is_completed() -> None:
    fragment = example_of(WALL.removeprefix("version: 1\n"), frozenset({"fragment"}))
    assert fragment.scene == example_of(WALL).scene


def test_a_theme_is_shown_in_a_level() -> None:
    example = example_of('colors: {base: "#463f5e"}\n', frozenset({"theme"}))
    assert example.scene is not None
    assert "#463f5e" in to_svg(example.scene)


def test_a_random_maze_is_shown_as_one_of_its_mazes() -> None:
    assert example_of("version: 1\nmaze: {seed: random}\n").scene is not None


@pytest.mark.parametrize(
    "text",
    ["version: 1\nkind: suite\nlevels:\n  - maze\n", "repos:\n  - repo: local\n", "- 1\n", ": :\n"],
)
def test_other_yaml_has_no_picture(text: str) -> None:
    example = example_of(text)
    assert example.scene is None
    assert not example.messages
    assert not example.is_broken


def test_a_level_with_an_error_that_no_mark_names_is_told() -> None:
    broken = WALL.replace("side", "sides")
    assert example_of(broken).is_broken
    named = example_of(broken, frozenset({"error BR201"}))
    assert not named.is_broken
    assert named.lines == (3,)
    assert named.messages.startswith("levels/first.yaml:3:")


def test_the_ring_is_around_the_cell_and_the_line_is_that_of_the_entry() -> None:
    example = example_of(
        "version: 1\nsize: [4, 3]\nblocked:\n  - {at: [2, 1]}\npuddles:\n  - {at: [2, 1]}\n",
        frozenset({"error BR306"}),
    )
    plain = example_of("version: 1\nsize: [4, 3]\n").scene
    assert example.lines == (6,)
    assert example.scene is not None
    assert plain is not None
    margin = (plain.width - 4 * 64) / 2
    ((left, top, right, bottom),) = rings_of(example)
    assert margin + 2 * 64 < left < right < margin + 3 * 64
    assert margin + 64 < top < bottom < margin + 2 * 64


def test_a_ring_around_a_side_reaches_both_cells() -> None:
    example = example_of(WALL + WALL.splitlines()[2] + "\n", code="BR506")
    assert example.scene is not None
    margin = (example.scene.width - 3 * 64) / 2
    ((left, top, right, bottom),) = rings_of(example)
    assert left < margin + 2 * 64 < right
    assert margin + 64 < top < bottom < margin + 2 * 64


def test_what_is_off_the_grid_is_in_the_picture() -> None:
    beyond = example_of("version: 1\npuddles:\n  - {at: [3, 4]}\n", code="BR301")
    far = example_of("version: 1\npuddles:\n  - {at: [900, 900]}\n", code="BR301")
    assert beyond.scene is not None
    assert far.scene is not None
    assert beyond.scene.width >= 4 * 64
    assert beyond.scene.height >= 5 * 64
    assert rings_of(beyond)
    assert far.scene.width < 4 * 64


@pytest.mark.parametrize("page", each_rule(EXAMPLES), ids=lambda page: page.code)
def test_the_example_of_a_rule_is_marked(page: Rule) -> None:
    bad, good = blocks_of(page)
    faulty, better = example_of(bad, code=page.code), example_of(good)
    assert page.code in faulty.messages
    assert bool(rings_of(faulty)) == (page.code not in UNPLACED)
    assert faulty.lines or faulty.messages.splitlines()[0].startswith("levels/first.yaml:1:")
    assert "kind: suite" in good or better.scene is not None
    assert not better.messages
