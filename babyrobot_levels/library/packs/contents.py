"""What is in a pack's folder: its levels with their digests, its suites and its themes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from babyrobot_levels.language.documents import slug
from babyrobot_levels.language.looks import Theme
from babyrobot_levels.language.pack import PackFields
from babyrobot_levels.language.suite import SuiteFields
from babyrobot_levels.language.validation import check
from babyrobot_levels.library.level import Level
from babyrobot_levels.library.packs.errors import PackError
from babyrobot_levels.library.packs.manifest import LevelEntry, Manifest
from babyrobot_levels.library.packs.paths import TEXTS, is_theme
from babyrobot_levels.library.reading import check_document
from babyrobot_levels.text.diagnostics import Diagnostic, Issue
from babyrobot_levels.text.document import Document
from babyrobot_levels.text.errors import LevelError
from babyrobot_levels.text.files import PACK_FILE
from babyrobot_levels.text.reader import open_document

MAX_CELLS = 2 << 20
"""So many cells a pack's levels have at most, all together: they are compiled one by one."""


@dataclass(slots=True)
class Contents:
    """What is in a pack, and all that is wrong with it.

    Attributes:
        fields: what `pack.yaml` says, None where it has errors.
        levels: the levels by their names, each with its file and its digest.
        suites: the files of the suites by their names.
        themes: the files of the themes.
        diagnostics: the errors, file by file.
    """

    fields: PackFields | None = None
    levels: dict[str, LevelEntry] = field(default_factory=dict)
    suites: dict[str, str] = field(default_factory=dict)
    themes: list[str] = field(default_factory=list)
    diagnostics: list[Diagnostic] = field(default_factory=list)

    def summary(self) -> str:
        """Return how much there is, as in `3 levels, 1 suite`."""
        counts = {
            "level": len(self.levels),
            "suite": len(self.suites),
            "theme": len(self.themes),
        }
        told = [f"{count} {what}{'s' * (count != 1)}" for what, count in counts.items() if count]
        return ", ".join(told) or "no levels"


def survey(folder: Path, paths: Iterable[str], shown: Path = Path()) -> Contents:
    """Read all files of a pack and compile its levels.

    Args:
        folder: the pack's folder.
        paths: its files, relative to the folder.
        shown: what diagnostics put before a path.

    Raises:
        PackError: there are more cells in it than a pack may have.
    """
    found = Contents()
    names: dict[str, str] = {}
    cells = 0
    for path in paths:
        if path.rpartition("/")[2] in TEXTS:
            continue
        try:
            document = open_document(folder / path, str(shown / path))
        except LevelError as error:
            found.diagnostics += error.diagnostics
            continue
        if path == PACK_FILE:
            found.fields, errors = check(document, PackFields)
            found.diagnostics += errors
        elif is_theme(path):
            found.themes.append(path)
            found.diagnostics += check(document, Theme).diagnostics
        else:
            world, errors = check_document(document, folder / path)
            found.diagnostics += errors
            if world is None:
                continue
            problem = _taken(world, path, document, names)
            if problem is not None:
                found.diagnostics.append(document.diagnostic(problem))
            if isinstance(world, SuiteFields):
                found.suites[str(world.name)] = path
                continue
            cells += world.size[0] * world.size[1]
            if cells > MAX_CELLS:
                raise PackError(f"its levels have more than {MAX_CELLS:,} cells all together")
            digest = None if world.has_random_maze else world.digest
            found.levels[str(world.name)] = LevelEntry(digest=digest, file=path)
    return found


def check_contents(contents: Contents, manifest: Manifest) -> None:
    """Make sure that a pack holds what its manifest says.

    Raises:
        PackError: it does not, or something in it is not valid.
    """
    for told in contents.diagnostics[:1]:
        raise PackError(f"{told.location}: {told.message}")
    fields = contents.fields
    if fields is None:
        raise PackError(f"it has no {PACK_FILE}")
    for what in ("name", "version"):
        own, stated = getattr(fields, what), getattr(manifest, what)
        if own != stated:
            raise PackError(f"its {PACK_FILE} gives `{own}` as its {what}, its manifest `{stated}`")
    _compare(contents.levels, manifest.levels)


def _compare(levels: Mapping[str, LevelEntry], stated: Mapping[str, LevelEntry]) -> None:
    for name in sorted({*levels, *stated}):
        own, entry = levels.get(name), stated.get(name)
        if own is None:
            raise PackError(f"its manifest lists a level `{name}`, which it does not hold")
        if entry is None:
            raise PackError(f"it holds a level `{name}`, which its manifest does not list")
        if own.file != entry.file:
            raise PackError(f"its manifest says that `{name}` is {entry.file!r}; it is {own.file}")
        if own.digest != entry.digest:
            raise PackError(
                f"the level `{name}` is not the game that the manifest says: its digest is "
                f"{own.digest}, not {entry.digest}"
            )


def _taken(
    world: Level | SuiteFields, path: str, document: Document, names: dict[str, str]
) -> Issue | None:
    """Return what is wrong with a level's names: its own, and that of its file."""
    stem = slug(path.rpartition("/")[2].rpartition(".")[0])
    if stem is None or world.name is None:
        message = "nothing of the file's name can be a level's name"
        return Issue("BR701", (), message, "rename the file")
    for name in dict.fromkeys((world.name, stem)):
        other = names.setdefault(name, path)
        if other != path:
            own = ("name",) if name == world.name and "name" in document.data else ()
            advice = "in a pack, all names of levels and suites differ, and those of their files"
            return Issue("BR701", own, f"`{name}` is {other} already", advice)
    return None
