"""The page on plays describes all fields of a line."""

from __future__ import annotations

from support.places import DOCS

from babyrobot_levels.language.json_schema import SCHEMAS

TEXT = (DOCS / "plays.md").read_text("utf-8")


def test_all_fields_of_a_line_are_described() -> None:
    described = TEXT.partition("## The format")[2]
    for name in SCHEMAS["play"]()["properties"]:
        assert f"`{name}`" in described, name
