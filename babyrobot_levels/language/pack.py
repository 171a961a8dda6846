"""The fields of a `pack.yaml`: what a pack is called, and whose it is."""

from __future__ import annotations

from typing import Annotated, ClassVar, Self

from pydantic import StrictStr, StringConstraints, model_validator

from babyrobot_levels.language.base import Model, Slug, Text
from babyrobot_levels.text.diagnostics import Issue
from babyrobot_levels.text.errors import InvalidDocument
from babyrobot_levels.text.files import RESERVED

_NUMBER = r"(0|[1-9][0-9]{0,8})"
VERSION = rf"^{_NUMBER}\.{_NUMBER}\.{_NUMBER}$"
Version = Annotated[StrictStr, StringConstraints(pattern=VERSION)]


class PackFields(Model):
    """A pack: a folder of levels, suites and themes that is shared as a unit."""

    BEGINNING: ClassVar[str] = (
        "a pack.yaml has a `name`, a `version` such as `1.0.0`, and a `description`"
    )

    name: Slug
    """What its levels are found under: `name/level`."""
    version: Version
    """The version of the pack, three numbers such as `1.0.0`; a later one takes its place."""
    description: Text
    """What the pack is, for people."""
    author: Text | None = None
    """Who made it."""
    license: Text | None = None
    """Under which licence it may be used."""
    source: Text | None = None
    """Where the worlds are from: a citation."""

    @model_validator(mode="after")
    def _portable(self) -> Self:
        if self.name in RESERVED:
            message = f"no folder can be called `{self.name}` on Windows"
            raise InvalidDocument([Issue("BR207", ("name",), message, "choose another name")])
        return self


def version_order(version: str) -> tuple[int, ...]:
    """Return a version's numbers, by which versions are compared."""
    return tuple(int(number) for number in version.split("."))
