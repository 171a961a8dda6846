"""What a manifest says: what an extension adds, by name, and where it is."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple


class Command(NamedTuple):
    """A command as the overview lists it.

    Attributes:
        group: what it is for, the heading under which it stands.
        place: where its function is, as `package.module:name`.
        summary: what it does, in a few words.
        limited: whether the work for a level is limited, unless with `--no-limit`.
    """

    group: str
    place: str
    summary: str
    limited: bool = False


@dataclass(frozen=True, kw_only=True)
class Extension:
    """What an extension adds: names, and the places where what they stand for is defined.

    A place is `package.module:name`. It is imported when the name is used, so that the manifest
    itself imports nothing. A name of the package itself cannot be taken.

    Attributes:
        summary: what the extension is for, in one sentence.
        needs: the extensions of the package whose modules it imports.
        commands: the commands of `babyrobot`.
        formats: the formats of other programs, each a `Format` of `convert.formats`.
        pictures: the formats of pictures, each a `PictureFormat` of `analysis.picture_formats`.
        rules: the rules of the linter by code, each a function with the decorator `rule` of
            `linter.rule`. They run where they are selected.
        observations: the observations of environments, each a class derived from `Observer` of
            `envs.observations.base`.
        methods: methods of `Level`, each a function whose first argument is the level.
    """

    summary: str
    needs: tuple[str, ...] = ()
    commands: Mapping[str, Command] = field(default_factory=dict)
    formats: Mapping[str, str] = field(default_factory=dict)
    pictures: Mapping[str, str] = field(default_factory=dict)
    rules: Mapping[str, str] = field(default_factory=dict)
    observations: Mapping[str, str] = field(default_factory=dict)
    methods: Mapping[str, str] = field(default_factory=dict)
