"""What the guides tell of the code, in tables, lists and examples, is so."""

from __future__ import annotations

import base64
import inspect
import io
import json
import re
import zlib
from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest
from doc_pictures import sheet
from PIL import Image
from renew import editor_page
from support.places import DOCS, EXAMPLES, GALLERY_FOLDER, ROOT
from support.sessions import babyrobot

import babyrobot_levels as brl
from babyrobot_levels.analysis.picture_formats import FORMATS as FORMATS_OF_PICTURES
from babyrobot_levels.extensions.formats.commands import PICTURES
from babyrobot_levels.extensions.formats.formats import FORMATS, MODELS, written
from babyrobot_levels.extensions.formats.setups import _PLAYING, KEYWORDS
from babyrobot_levels.extensions.generate.batch import origin_of
from babyrobot_levels.extensions.learning import algorithms
from babyrobot_levels.language.json_schema import SCHEMAS
from babyrobot_levels.language.metric_names import STATED
from babyrobot_levels.language.share_code import DICTIONARY_1
from babyrobot_levels.language.suite import SuiteFields
from babyrobot_levels.library.level import load_code
from babyrobot_levels.mdp.mazes import ALGORITHMS
from babyrobot_levels.render.templates import static
from babyrobot_levels.render.text import PLAIN_ROBOTS, ROBOTS
from babyrobot_levels.render.text_plan import ITEMS, LOCKED, MOVER

README = ROOT / "README.md"
PAGES = {path.stem: path.read_text("utf-8") for path in DOCS.glob("*.md")}


def blocks(page: str, language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```", PAGES[page], re.MULTILINE | re.DOTALL)


def rows(page: str, after: str) -> list[list[str]]:
    """Return the cells of the first table after a text, without its head."""
    lines = PAGES[page].partition(after)[2].splitlines()
    first = next(number for number, line in enumerate(lines) if line.startswith("|---"))
    table = [*lines[first + 1 :], ""]
    last = next(number for number, line in enumerate(table) if not line.startswith("|"))
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in table[:last]]


# -- converting ------------------------------------------------------------------------------


def test_the_table_has_all_formats_of_other_programs() -> None:
    table = rows("converting", "| format | what it is | read from | written as |")
    names = {name: row for row in table for name in re.findall(r"`([a-z-]+)`", row[0])}
    assert [*names] == [*FORMATS, *MODELS, *PICTURES]
    assert [name for name, row in names.items() if row[2]] == [*FORMATS]
    assert [name for name, row in names.items() if row[3]] == [*written(), *PICTURES]
    for name, each in FORMATS.items():
        for suffix in {*each.suffixes, *each.written_suffixes}:
            assert f"`{suffix}`" in "".join(names[name]), name


def test_the_keywords_of_set_ups_are_all_explained() -> None:
    explained = set(re.findall(r"`(\w+)`", PAGES["converting"]))
    assert KEYWORDS - set(_PLAYING) <= explained


# -- the editor ------------------------------------------------------------------------------


def test_the_keys_are_those_of_the_editor() -> None:
    # `python scripts/renew.py docs/editor.md` writes them.
    assert len(rows("editor", "\n## Keys\n")) > 20
    assert editor_page() == PAGES["editor"]


def test_the_tools_are_those_of_the_editor() -> None:
    found = json.loads(static("extensions/editor/static/tools.json"))
    tools = [(each["key"], each["title"]) for each in found["tools"] + found["modifiers"]]
    shown = [
        pair
        for keys, titles, _ in rows("editor", "\n## Tools\n")
        for pair in zip(keys.split(", "), titles.split(", "), strict=True)
    ]
    assert len(tools) > 10
    assert shown == tools


# -- formatting ------------------------------------------------------------------------------


def test_the_formatter_does_what_its_example_shows() -> None:
    before, after = (
        re.findall(rf"<!-- {name} -->\n```yaml\n(.*?)```", PAGES["formatting"], re.DOTALL)[0]
        for name in ("before", "after")
    )
    assert brl.format(before) == brl.format(after) == after


def test_numbers_and_words_are_written_as_told() -> None:
    told = PAGES["formatting"].split("| numbers |")[1]
    pairs = re.findall(r"`([^`]+)` becomes `([^`]+)`", told)
    assert pairs == [("+3", "3"), (".50", "0.5"), ("1E+3", "1e3"), ("True", "true")]
    for before, after in pairs:
        field = "display: {compass: %s}" if before == "True" else "rewards: {step: %s}"
        assert brl.format(f"version: 1\n{field % before}\n") == f"version: 1\n{field % after}\n"


# -- generating and mazes --------------------------------------------------------------------


@pytest.mark.usefixtures("here")
def test_a_generated_file_begins_as_it_is_shown() -> None:
    shown = blocks("generating", "yaml")[0]
    calls = blocks("generating", "sh")[0].splitlines()
    command = next(line for line in calls if line.endswith("-o wet"))
    assert babyrobot(*command.split()[1:]).status == 0
    assert origin_of(shown) is not None
    assert Path("wet", "level-00003.yaml").read_text("utf-8").startswith(shown)
    assert brl.validate(blocks("generating", "yaml")[1]) == []


def test_no_field_of_a_suite_and_no_shipped_suite_is_missing() -> None:
    table = rows("generating", "### The fields of a suite")
    assert {name for row in table for name in re.findall(r"`(\w+)`", row[0])} == set(
        SuiteFields.model_fields
    )
    for path in (GALLERY_FOLDER / "suites").iterdir():
        assert f"`{path.stem}`" in PAGES["generating"]


def test_algorithms_and_metrics_are_explained_in_order() -> None:
    text = PAGES["mazes"]
    assert re.findall(r"^### `(.*)`$", text, flags=re.MULTILINE) == list(ALGORITHMS)
    for path in (DOCS / "images" / "mazes").iterdir():
        assert f"images/mazes/{path.name}" in text
    named = re.findall(r"^\| `(\w+)` \|", text[text.index("## Metrics") :], flags=re.MULTILINE)
    assert [name for name in named if name != "path"] == [*STATED]


def test_the_examples_and_difficulties_of_mazes_are_right() -> None:
    for example in blocks("mazes", "yaml"):
        brl.loads(example).compile()
    told = re.findall(r"^\| ([a-z0-9-]+) \| ([0-9.]+) \|", PAGES["mazes"], flags=re.MULTILINE)
    assert len(told) >= 6
    for name, difficulty in told:
        assert f"{brl.metrics(name).difficulty:.1f}" == difficulty


# -- pictures --------------------------------------------------------------------------------


def test_the_table_has_all_formats_with_their_files_methods_and_options() -> None:
    table = [
        [re.findall(r"`(.*?)`", cell) for cell in row]
        for row in rows("pictures", "| format | files | in Python | options |")
    ]
    known = FORMATS_OF_PICTURES
    assert [name for row in table for name in row[0]] == [*known]
    for names, files, methods, options in table:
        formats = [known[name] for name in names]
        assert files == list(dict.fromkeys(file for each in formats for file in each.suffixes))
        assert methods == [f"to_{each.name}" for each in formats if each.make is not None]
        assert all([*each.shows.__annotations__] == options for each in formats)


def test_the_characters_of_things_are_those_of_the_table() -> None:
    text = PAGES["pictures"]
    assert all(f"images/{name}.svg" in text for name in ("things", "things-held"))
    unicode, ascii_ = (" ".join(f"`{pair[kind]}`" for pair in ITEMS.values()) for kind in (0, 1))
    assert f"| {', '.join(ITEMS)} | {unicode} | {ascii_} |" in text
    assert f"| mover | `{MOVER[0]}` | `{MOVER[1]}` |" in text
    robots = (" ".join(f"`{robot}`" for robot in robots[:4]) for robots in (ROBOTS, PLAIN_ROBOTS))
    assert f"| robot that turns | {' | '.join(robots)} |" in text
    assert f"| exit whose needs are not met | `{LOCKED}` | `{LOCKED}` |" in text


@pytest.mark.slow
def test_the_picture_of_a_sheet_is_what_is_drawn() -> None:
    # `python scripts/renew.py docs/images/sheet.png` draws it anew.
    stored, drawn = (
        np.asarray(Image.open(source).convert("L"), int)
        for source in (DOCS / "images" / "sheet.png", io.BytesIO(sheet()))
    )
    assert stored.shape == drawn.shape
    assert (np.abs(stored - drawn) > 64).mean() < 0.002
    assert "](images/sheet.png)" in PAGES["sheets"]


# -- levels ----------------------------------------------------------------------------------


@pytest.mark.slow
def test_complete_levels_have_exactly_the_findings_that_are_named() -> None:
    """A page names them in a comment on the line before: `<!-- lint BR504 -->`."""
    block = re.compile(r"^(?:<!-- lint ([^>]*?) -->\n)?```yaml\n(.*?)^```", re.M | re.S)
    count = 0
    for name, text in {"README": README.read_text("utf-8"), **PAGES}.items():
        found = block.findall(text)
        assert sum(bool(codes) for codes, _ in found) == text.count("<!-- lint "), name
        for codes, level in found:
            if brl.validate(level):
                continue
            count += 1
            findings = [each for each in brl.lint(level) if each.severity != "info"]
            assert {each.code for each in findings} == {*codes.split()}, f"{name}: {findings}"
    assert count > 30


# -- what names everything there is ----------------------------------------------------------


def test_each_algorithm_that_learns_has_an_example() -> None:
    code = "".join(blocks("learning", "python"))
    own = [each for each in vars(algorithms).values() if inspect.isfunction(each)]
    for name in {each.__name__ for each in own} & {*brl.__all__}:
        assert name in code, name


def test_all_fields_of_plays_and_attributes_of_scores_are_described() -> None:
    described = PAGES["plays"].partition("## The format")[2]
    for name in SCHEMAS["play"]()["properties"]:
        assert f"`{name}`" in described, name
    for name in [field.name for kind in (brl.LevelScore, brl.Summary) for field in fields(kind)]:
        assert f"`{name}`" in PAGES["scoring"] or name in {"level", "levels", "digest"}, name


def test_the_page_on_training_names_all_examples() -> None:
    named = set(re.findall(r"\.\./examples/(\w+\.py)", PAGES["training"]))
    examples = {path.name for path in EXAMPLES.glob("*.py")}
    assert named == examples - {"arguments.py", "cluster.py", "comparison.py", "play.py"}


def test_a_reader_of_codes_without_dictionaries_can_use_a_stored_block() -> None:
    code = brl.load("final-maze").share_code()
    body = code.split(".")[2]
    stream = base64.urlsafe_b64decode(body + "=" * (-len(body) % 4))[4:]
    size = len(DICTIONARY_1)
    head = b"\0" + size.to_bytes(2, "little") + (size ^ 0xFFFF).to_bytes(2, "little")
    data = zlib.decompress(head + DICTIONARY_1 + stream, -15)[size:]
    assert brl.loads(data.decode()).digest == load_code(code).digest
