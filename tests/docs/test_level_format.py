"""The reference of the language: its examples do what it says, and no field is missing.

A `yaml` block is a complete level. A comment on the line right before a block or a table says more:
`fragment` (fields to be put below `version: 1`), `error BRxxx` (a level with exactly that error),
`lint BRxxx` (a level of which lint reports that), `theme` (a theme file), `same digest` (as the
level after it). Of the level before them: `draws` its drawing, `report` the error report,
`outcomes of ACTION at [x, y]` a table of the outcomes, with `in [VALUES]` those in a configuration,
`configurations` the table of all of them, `skid rules` the table of the rules. `file: NAME` and
`no picture` are for others.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from level_pictures.examples import level_text
from pydantic import BaseModel
from support.places import DOCS
from support.reading import read_level

from babyrobot_levels.language.cells import PRECEDENCE
from babyrobot_levels.language.expectations import Expect
from babyrobot_levels.language.fields import LevelFields
from babyrobot_levels.language.looks import Colors, Theme, Widths
from babyrobot_levels.language.validation import parse
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.actions import Action
from babyrobot_levels.mdp.tables import Mdp
from babyrobot_levels.render.raster import to_rgb
from babyrobot_levels.render.scene.build import build_scene
from babyrobot_levels.text.diagnostics import Diagnostic
from babyrobot_levels.text.source import SourceFile

DOCUMENT = DOCS / "level-format.md"
TEXT = DOCUMENT.read_text(encoding="utf-8")
LINES = TEXT.splitlines()

OUTCOMES = re.compile(r"outcomes of ([\w-]+) at \[(\d+), (\d+)\](?: in \[([\d, ]+)\])?")
ERROR = re.compile(r"error (BR\d{3})")
KINDS = re.compile(
    "configurations|draws|file: .*|fragment|no picture|report|same digest|skid rules|theme|"
    rf"{ERROR.pattern}|lint( BR\d{{3}})+"
)


@dataclass(frozen=True)
class Block:
    """A fenced block or a table, and what the comment on the line before it says."""

    line: int
    kind: str
    language: str
    text: str

    def __str__(self) -> str:
        return f"line {self.line}"


def read_blocks() -> list[Block]:
    blocks: list[Block] = []
    number = 0
    while number < len(LINES):
        first = number
        note = re.fullmatch(r"<!-- (.*) -->", LINES[number - 1]) if number else None
        kind = note[1] if note else ""
        fence = re.fullmatch(r"```(\w*)", LINES[number])
        if fence:
            number = LINES.index("```", number + 1)
            text = "\n".join(LINES[first + 1 : number]) + "\n"
            blocks.append(Block(first + 1, kind, fence[1], text))
        elif kind and LINES[number].startswith("|"):
            while LINES[number + 1].startswith("|"):
                number += 1
            text = "\n".join(LINES[first : number + 1])
            blocks.append(Block(first + 1, kind, "table", text))
        number += 1
    return blocks


BLOCKS = read_blocks()
YAML = [block for block in BLOCKS if block.language == "yaml"]


def read_block(block: Block) -> tuple[Level | None, list[Diagnostic]]:
    # The path need not be there: only a theme that the language does not know is looked for.
    path = Path("levels", "first.yaml")
    return read_level(SourceFile(path.as_posix(), level_text(block.text, {block.kind})), path)


def level_of(block: Block) -> Level:
    level, diagnostics = read_block(block)
    assert level is not None, "\n\n".join(map(str, diagnostics))
    return level


def yaml_before(block: Block) -> Block:
    return [other for other in YAML if other.line < block.line][-1]


def of_kind(pattern: str) -> pytest.MarkDecorator:
    found = [block for block in BLOCKS if re.fullmatch(pattern, block.kind)]
    assert found, f"nothing in the document is marked {pattern!r}"
    return pytest.mark.parametrize("block", found, ids=str)


def cells_of(row: str) -> list[str]:
    return [cell.strip().strip("`") for cell in row.strip("|").split("|")]


def rows_of(table: Block) -> list[list[str]]:
    return [cells_of(row) for row in table.text.splitlines()[2:]]


def chances_of(mdp: Mdp, cell: tuple[int, int], action: Action) -> dict[tuple[int, int], Any]:
    """Return the probability of standing on each cell afterwards."""
    found: dict[tuple[int, int], float] = {}
    for chance, state, _, _ in mdp.outcomes(cell[1] * mdp.width + cell[0], action):
        there = (state % mdp.width, state // mdp.width)
        found[there] = found.get(there, 0) + chance
    return found


# -- the examples --------------------------------------------------------------------------


def test_every_mark_is_one_that_is_tested() -> None:
    marks = [block.kind for block in BLOCKS if block.kind]
    marks = [m for m in marks if not KINDS.fullmatch(m) and not OUTCOMES.fullmatch(m)]
    assert marks == []
    # Every mark stands right before a block: none is left over.
    comments = sum(bool(re.fullmatch(r"<!-- .* -->", line)) for line in LINES)
    assert comments == sum(bool(block.kind) for block in BLOCKS)


@pytest.mark.parametrize(
    "block", [b for b in YAML if not ERROR.fullmatch(b.kind) and b.kind != "theme"], ids=str
)
def test_the_example_is_a_level(block: Block) -> None:
    level, diagnostics = read_block(block)
    assert not diagnostics, "\n\n".join(map(str, diagnostics))
    assert level is not None
    if block.kind != "fragment":
        fields = [line for line in block.text.splitlines() if not line.startswith("#")]
        assert fields[0] == "version: 1"
    if not level.has_random_maze:
        level.compile()


@of_kind(ERROR.pattern)
def test_the_example_has_that_fault(block: Block) -> None:
    expected = ERROR.fullmatch(block.kind)
    assert expected is not None
    level, diagnostics = read_block(block)
    assert level is None
    assert [diagnostic.code for diagnostic in diagnostics] == [expected[1]]


@of_kind("report")
def test_the_report_is_what_is_reported(block: Block) -> None:
    _, diagnostics = read_block(yaml_before(block))
    assert block.text == "\n\n".join(map(str, diagnostics)) + "\n"


@of_kind("theme")
def test_the_example_is_a_theme(block: Block) -> None:
    theme, diagnostics = parse(SourceFile("dusk.yaml", block.text), Theme)
    assert not diagnostics
    assert theme is not None


@of_kind("draws")
def test_the_drawing_is_that_of_the_level_before(block: Block) -> None:
    assert block.language == "text"
    assert level_of(yaml_before(block)).draw() == block.text


@of_kind(OUTCOMES.pattern)
def test_the_outcomes_are_those_of_the_level_before(block: Block) -> None:
    match = OUTCOMES.fullmatch(block.kind)
    assert match is not None
    level = level_of(yaml_before(block))
    mdp = level.compile()
    configurations = [values_text(row) for row in mdp.configurations.tolist()]
    configuration = configurations.index(f"[{match[4]}]") if match[4] else 0
    state = configuration * mdp.cells + int(match[3]) * mdp.width + int(match[2])
    assert not mdp.is_terminal[state]
    found = [
        [values_text(mdp.cell(there)), configurations[mdp.configuration(there)], chance, reward]
        for chance, there, reward, _ in mdp.outcomes(
            state, Action[match[1].upper().replace("-", "_")]
        )
    ]
    names = ["next cell", "configuration", "probability", "reward"]
    assert level.has_things == bool(match[4])
    if not level.has_things:
        found, names = [[row[0], *row[2:]] for row in found], [names[0], *names[2:]]
    assert cells_of(block.text.splitlines()[0]) == names
    told = [[*texts, float(chance), float(reward)] for *texts, chance, reward in rows_of(block)]
    assert [[*texts, pytest.approx(chance), reward] for *texts, chance, reward in found] == told


def values_text(values: Iterable[int]) -> str:
    return f"[{', '.join(map(str, values))}]"


@of_kind("configurations")
def test_the_configurations_are_those_of_the_level_before(block: Block) -> None:
    level = level_of(yaml_before(block))
    assert cells_of(block.text.splitlines()[0]) == ["configuration", *level.things().names]
    told = [[int(value) for value in row] for row in rows_of(block)]
    configurations = level.compile().configurations.tolist()
    assert told == [[number, *row] for number, row in enumerate(configurations)]


@of_kind("skid rules")
def test_the_skid_rules_are_as_in_the_table(block: Block) -> None:
    level = level_of(yaml_before(block))
    assert not isinstance(level.skid, float | None)
    rows = rows_of(block)
    assert {row[0] for row in rows} == {"open", "sides", "others"}
    for rule, move, *told in rows:
        ruled = level.replace(skid={"probability": level.skid.probability, "to": rule})
        chances = chances_of(ruled.compile(), (1, 1), Action[move.upper()])
        around = [(1, 0), (2, 1), (1, 2), (0, 1), (1, 1)]
        assert [float(value) for value in told] == [
            pytest.approx(chances.get(cell, 0)) for cell in around
        ]


def test_a_start_can_be_hidden_as_shown() -> None:
    block = next(block for block in YAML if "start_text: transparent" in block.text)
    level = level_of(block)
    pictures = [to_rgb(build_scene(level.replace(start=cell))) for cell in ([0, 0], [1, 1])]
    assert np.array_equal(pictures[0], pictures[1])


def test_rewards_are_listed_by_their_precedence() -> None:
    first = next(number for number, line in enumerate(LINES) if "is the first of these" in line)
    lines = [line for line in LINES[first : first + 12] if re.match(r"\d\. ", line)]
    words = [name for line in lines for name in PRECEDENCE if re.search(rf"\b{name}\b", line)]
    assert [*dict.fromkeys(words)] == [*PRECEDENCE]


@of_kind("same digest")
def test_the_two_levels_are_one_game(block: Block) -> None:
    other = next(later for later in YAML if later.line > block.line)
    assert level_of(block).to_dict() != level_of(other).to_dict()
    assert level_of(block).digest == level_of(other).digest


# -- the whole language --------------------------------------------------------------------


def models_of(model: type[BaseModel]) -> set[type[BaseModel]]:
    found = {model}
    for info in model.model_fields.values():
        for inner in _models_in(info.annotation):
            found |= models_of(inner)
    return found


def _models_in(annotation: Any) -> list[type[BaseModel]]:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    return [model for part in getattr(annotation, "__args__", ()) for model in _models_in(part)]


# What can be stated are the metrics, which the page on mazes describes.
MODELS = sorted(models_of(LevelFields) - {Expect}, key=lambda model: model.__name__)


@pytest.mark.parametrize("model", MODELS, ids=[model.__name__ for model in MODELS])
def test_every_field_is_described(model: type[BaseModel]) -> None:
    names = [info.alias or name for name, info in model.model_fields.items()]
    assert [name for name in names if f"`{name}`" not in TEXT] == []


def test_the_table_of_all_fields_is_complete_and_in_order() -> None:
    begin = LINES.index("## All fields")
    end = LINES.index("## Metadata")
    rows = [cells_of(line)[0] for line in LINES[begin:end] if line.startswith("| `")]
    assert rows == list(LevelFields.model_fields)


@pytest.mark.parametrize("model", [Colors, Widths])
def test_the_defaults_of_themes_are_right(model: type[Colors | Widths]) -> None:
    for name, info in model.model_fields.items():
        default = info.default if isinstance(info.default, str) else f"{info.default:g}"
        assert any(line.startswith(f"| `{name}` | `{default}` |") for line in LINES), name
