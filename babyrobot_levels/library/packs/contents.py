"""The contents of a pack's folder: levels with their digests, suites and themes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from babyrobot_levels.language.documents import slug
from babyrobot_levels.language.looks import Theme
from babyrobot_levels.language.suite import SuiteTexts
from babyrobot_levels.language.suite_list import PackFields
from babyrobot_levels.language.validation import check
from babyrobot_levels.library.packs.format import TEXTS, LevelEntry, Manifest, PackError, is_theme
from babyrobot_levels.mdp.gridworld import GridWorld, check_world
from babyrobot_levels.text.diagnostics import Diagnostic, Issue
from babyrobot_levels.text.document import Document
from babyrobot_levels.text.errors import LevelError
from babyrobot_levels.text.files import PACK_FILE
from babyrobot_levels.text.reader import open_document

MAX_CELLS = 2 << 20
"""The limit of cells of all levels together: each level is compiled."""


@dataclass(slots=True)
class Contents:
    """The contents of a pack, and its errors.

    Attributes:
        fields: the fields of `pack.yaml`, None if it has errors.
        levels: the levels by name, with their files and digests.
        suites: the files of the suites by name.
        themes: the files of the themes.
        diagnostics: the errors, by file.
    """

    fields: PackFields | None = None
    levels: dict[str, LevelEntry] = field(default_factory=dict)
    suites: dict[str, str] = field(default_factory=dict)
    themes: list[str] = field(default_factory=list)
    diagnostics: list[Diagnostic] = field(default_factory=list)

    def summary(self) -> str:
        """Return the counts, as in `3 levels, 1 suite`."""
        counts = {
            "level": len(self.levels),
            "suite": len(self.suites),
            "theme": len(self.themes),
        }
        parts = [f"{count} {what}{'s' * (count != 1)}" for what, count in counts.items() if count]
        return ", ".join(parts) or "no levels"


def survey(folder: Path, paths: Iterable[str], shown: Path = Path()) -> Contents:
    """Read all files of a pack and compile its levels.

    Args:
        folder: the pack's folder.
        paths: its files, relative to the folder.
        shown: the prefix of paths in diagnostics.

    Raises:
        PackError: it has more cells than a pack may have.
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
            world, errors = check_world(document, GridWorld, folder / path)
            found.diagnostics += errors
            if world is None:
                continue
            problem = _taken(world, path, document, names)
            if problem is not None:
                found.diagnostics.append(document.diagnostic(problem))
            if isinstance(world, SuiteTexts):
                found.suites[str(world.name)] = path
                continue
            cells += world.size[0] * world.size[1]
            if cells > MAX_CELLS:
                raise PackError(f"its levels have more than {MAX_CELLS:,} cells together")
            digest = None if world.has_random_maze else world.digest
            found.levels[str(world.name)] = LevelEntry(digest=digest, file=path)
    return found


def check_contents(contents: Contents, manifest: Manifest) -> None:
    """Check that a pack is valid and agrees with its manifest.

    Raises:
        PackError: it is not, or does not.
    """
    for error in contents.diagnostics[:1]:
        raise PackError(f"{error.location}: {error.message}")
    fields = contents.fields
    if fields is None:
        raise PackError(f"it has no {PACK_FILE}")
    for what in ("name", "version"):
        own, stated = getattr(fields, what), getattr(manifest, what)
        if own != stated:
            raise PackError(f"its {what} is `{own}` in {PACK_FILE}, but `{stated}` in the manifest")
    _compare(contents.levels, manifest.levels)


def _compare(levels: Mapping[str, LevelEntry], stated: Mapping[str, LevelEntry]) -> None:
    for name in sorted({*levels, *stated}):
        own, entry = levels.get(name), stated.get(name)
        if own is None:
            raise PackError(f"its manifest lists a level `{name}` that it does not contain")
        if entry is None:
            raise PackError(f"it contains a level `{name}` that its manifest does not list")
        if own.file != entry.file:
            raise PackError(
                f"the file of `{name}` is {entry.file!r} in its manifest, but {own.file!r} here"
            )
        if own.digest != entry.digest:
            raise PackError(
                f"the level `{name}` differs from the manifest: its digest is {own.digest}, "
                f"not {entry.digest}"
            )


def _taken(
    world: GridWorld | SuiteTexts, path: str, document: Document, names: dict[str, str]
) -> Issue | None:
    """Return the problem with the names of a level, its own and that of its file, if any."""
    stem = slug(path.rpartition("/")[2].rpartition(".")[0])
    if stem is None or world.name is None:
        message = "the file's name has no letters or digits for a level's name"
        return Issue("BR701", (), message, "rename the file")
    for name in dict.fromkeys((world.name, stem)):
        other = names.setdefault(name, path)
        if other != path:
            own = ("name",) if name == world.name and "name" in document.data else ()
            advice = "in a pack, the names of levels and suites and of their files are unique"
            return Issue("BR701", own, f"`{name}` is already the name of {other}", advice)
    return None
