"""Whatever the handwriting: the same data, the same comments, and a form that stays."""

from __future__ import annotations

import random
from collections import Counter
from pathlib import Path
from typing import Any

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from support.each import for_each
from support.handwriting import Scribe
from support.places import TESTS
from support.things import thing_worlds
from support.worlds import decorated_worlds, level_of_text, worlds

from babyrobot_levels.generation.starter import TEMPLATES, StarterOptions, starter
from babyrobot_levels.language.formatting import format_source, tidy
from babyrobot_levels.library.level import Level, load_file
from babyrobot_levels.library.search_path import gallery_folder, yaml_files
from babyrobot_levels.text.document import Document, comments
from babyrobot_levels.text.emitter import scalar
from babyrobot_levels.text.errors import LevelError
from babyrobot_levels.text.reader import read
from babyrobot_levels.text.source import SourceFile

GOOD = sorted((TESTS / "levels" / "good").glob("*.yaml"))
GALLERY = list(yaml_files(gallery_folder()))


def document(text: str) -> Document:
    return read(SourceFile("level.yaml", text))


def formatted(text: str) -> str:
    result = format_source(SourceFile("level.yaml", text))
    assert result.kept is None, result.kept
    return result.text


def is_exactly(one: Any, other: Any) -> bool:
    """Tell whether two values are equal and of the same types, in lists and mappings too."""
    if type(one) is not type(other):
        return False
    if isinstance(one, dict):
        return one.keys() == other.keys() and all(is_exactly(one[key], other[key]) for key in one)
    if isinstance(one, list):
        return len(one) == len(other) and all(map(is_exactly, one, other))
    return bool(one == other)


def handwritten(scribe: Scribe, world: dict[str, Any]) -> tuple[str, Document]:
    """Return a text that says the world; now and then a scribe writes something else."""
    text = scribe.write(world)
    try:
        read_back = document(text)
    except LevelError:
        assume(False)
    assume(read_back.data == world)
    return text, read_back


@pytest.mark.slow
@given(
    decorated_worlds() | thing_worlds(),
    st.randoms(use_true_random=False),
    st.sampled_from([0.0, 0.1, 0.4]),
)
def test_any_handwriting(world: dict[str, Any], rng: random.Random, chatty: float) -> None:
    scribe = Scribe(rng, chatty)
    text, before = handwritten(scribe, world)
    result = formatted(text)
    after = document(result)
    assert is_exactly(after.data, before.data)
    assert Counter(each.text for each in comments(after)) == Counter(map(tidy, scribe.comments))
    assert formatted(result) == result


@pytest.mark.slow
@given(worlds(5) | thing_worlds(), st.randoms(use_true_random=False))
def test_the_digest_stays(world: dict[str, Any], rng: random.Random) -> None:
    text, _ = handwritten(Scribe(rng), world)
    before, after = level_of_text(text), level_of_text(formatted(text))
    assert after == before
    assert after.digest == before.digest


class Copyist(Scribe):
    """Writes each number and each word in one way, but lists and mappings in any."""

    def scalar(self, value: Any, indent: str, *, in_flow: bool = False) -> str:
        return scalar(value, in_flow=in_flow)

    def block(self, text: str, indent: str) -> list[str]:
        return []


@pytest.mark.slow
@given(worlds(4) | thing_worlds(), st.randoms(use_true_random=False))
def test_lists_and_mappings_come_to_one_form(world: dict[str, Any], rng: random.Random) -> None:
    text, _ = handwritten(Copyist(rng, chatty=0.0), world)
    assert formatted(text).replace("\r\n", "\n") == Level.from_fields(world).to_yaml()


@given(decorated_worlds() | thing_worlds())
def test_what_levels_write_is_canonical(world: dict[str, Any]) -> None:
    text = Level.from_fields(world).to_yaml()
    assert formatted(text) == text


@pytest.mark.parametrize("template", TEMPLATES)
@pytest.mark.parametrize(
    "order",
    [
        {},
        {"size": (1, 2)},
        {"size": (30, 30), "puddles": 40, "theme": "green"},
        {"name": "1", "size": (2, 2)},
    ],
)
def test_what_new_level_writes_is_canonical(template: str, order: dict[str, Any]) -> None:
    text = starter(
        StarterOptions(**{"name": "first", "template": template, **order}), "level.schema.json"
    )
    assert formatted(text) == text


def test_a_new_maze_is_canonical() -> None:
    text = starter(StarterOptions("first", maze_seed=-3, loops=0.25), "level.schema.json")
    assert formatted(text) == text


@for_each("path", GALLERY)
def test_the_gallery_is_canonical(path: Path) -> None:
    text = path.read_bytes().decode()
    assert formatted(text) == text


@pytest.mark.parametrize(
    "path",
    [
        pytest.param(path, marks=[pytest.mark.slow] if path.stem == "things" else [])
        for path in GOOD
    ],
    ids=lambda path: path.stem,
)
def test_good_files(path: Path) -> None:
    text = path.read_bytes().decode("utf-8-sig")
    result = formatted(text)
    assert is_exactly(document(result).data, document(text).data)
    level = level_of_text(result)
    assert level == level_of_text(text)
    if not level.has_random_maze:
        assert level.digest == load_file(path).digest
    assert formatted(result) == result
