"""The page on scoring names each attribute of a score."""

from __future__ import annotations

from support.places import DOCS

TEXT = (DOCS / "scoring.md").read_text("utf-8")


def test_each_attribute_of_a_score_is_described() -> None:
    from dataclasses import fields

    from babyrobot_levels.scoring.results import LevelScore, Summary

    for name in [field.name for kind in (LevelScore, Summary) for field in fields(kind)]:
        assert f"`{name}`" in TEXT or name in {"level", "levels", "digest"}, name
