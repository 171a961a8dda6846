"""Texts beside their canonical form: `cases/NAME.in.yaml` and `cases/NAME.out.yaml`."""

from __future__ import annotations

import pytest
from support.places import TESTS

from babyrobot_levels.language.formatting.formatter import format_source
from babyrobot_levels.text.source import SourceFile

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
    assert formatted(text_of(f"{name}.in.yaml")) == text_of(f"{name}.out.yaml")


@pytest.mark.parametrize("name", NAMES)
def test_the_canonical_form_stays(name: str) -> None:
    text = text_of(f"{name}.out.yaml")
    assert formatted(text) == text


def test_every_case_is_a_pair() -> None:
    assert NAMES
    assert {path.name for path in FOLDER.iterdir()} == {
        f"{name}.{kind}.yaml" for name in NAMES for kind in ("in", "out")
    }
