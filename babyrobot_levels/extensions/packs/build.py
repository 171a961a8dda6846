"""Packs from folders: their contents, checked, and the archive that is made of them."""

import os
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from babyrobot_levels.extensions.packs.archive import (
    MAX_FILES,
    TEXTS,
    LevelEntry,
    Manifest,
    PackError,
    belongs,
    check_sizes,
    clashes,
    file_entry,
    is_theme,
    path_fault,
    write_archive,
)
from babyrobot_levels.language.looks import Theme
from babyrobot_levels.language.names import slug
from babyrobot_levels.language.suite import SuiteTexts
from babyrobot_levels.language.suite_list import PackFields
from babyrobot_levels.language.validation import check
from babyrobot_levels.mdp.gridworld import GridWorld, check_world
from babyrobot_levels.text.diagnostics import Diagnostic, Issue, Severity
from babyrobot_levels.text.document import Document
from babyrobot_levels.text.errors import LevelError
from babyrobot_levels.text.files import (
    MAX_DEPTH,
    PACK_FILE,
    NotRegularError,
    is_aside,
    is_file,
    is_within,
    read_bytes,
)
from babyrobot_levels.text.reader import open_document
from babyrobot_levels.text.source import MAX_BYTES, START, SourceFile
from babyrobot_levels.text.words import did_you_mean

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
        counts = {"level": len(self.levels), "suite": len(self.suites), "theme": len(self.themes)}
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
            described = document
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
            if (problem := _taken(world, path, document, names)) is not None:
                found.diagnostics.append(document.diagnostic(problem))
            if isinstance(world, SuiteTexts):
                found.suites[str(world.name)] = path
                continue
            cells += world.size[0] * world.size[1]
            if cells > MAX_CELLS:
                raise PackError(f"its levels have more than {MAX_CELLS:,} cells together")
            digest = None if world.has_random_maze else world.digest
            found.levels[str(world.name)] = LevelEntry(digest=digest, file=path)
    for number, each in enumerate(found.fields.levels if found.fields else ()):
        if each.level not in found.levels:
            known = [*found.levels]
            message = f"there is no level `{each.level}` here{did_you_mean(each.level, known)}"
            issue = Issue("BR207", ("levels", number, "level"), message, "name a level of the pack")
            found.diagnostics.append(described.diagnostic(issue))
    return found


@dataclass(frozen=True, slots=True)
class Course:
    """A folder of levels whose `pack.yaml` tells their order and points.

    Attributes:
        folder: the folder.
        fields: the fields of its `pack.yaml`.
        files: the file of each level, by its name.
        paths: the files of the pack, relative to the folder.
    """

    folder: Path
    fields: PackFields
    files: Mapping[str, Path]
    paths: Sequence[str]

    @property
    def given(self) -> dict[str, Path]:
        """The further files that students get, by their names, as far as they are in the folder."""
        paths = {name: self.folder / name for name in self.fields.given}
        return {
            name: path
            for name, path in paths.items()
            if ".." not in Path(name).parts and is_file(path) and is_within(path, self.folder)
        }


def read_course(path: str | os.PathLike[str]) -> Course:
    """Return the course in a folder.

    Raises:
        PackError: there is no `pack.yaml`, or it lists no levels.
        LevelError: a file has errors.
    """
    folder = Path(path)
    if not os.path.lexists(folder / PACK_FILE):
        advice = "name the folder of a course; `babyrobot course new DIR` writes one to change"
        raise PackError(f"there is no {PACK_FILE} in {os.fspath(path)}", advice)
    paths, _ = _paths(folder)
    contents = survey(folder, paths, folder)
    if contents.fields is None or contents.diagnostics:
        raise LevelError(contents.diagnostics)
    if not contents.fields.levels:
        advice = "list them in their order: `levels: [{level: NAME, points: 4}]`"
        raise PackError(f"{folder / PACK_FILE} is no course: it lists no `levels`", advice)
    files = {name: folder / entry.file for name, entry in contents.levels.items()}
    return Course(folder, contents.fields, files, paths)


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
        if (other := names.setdefault(name, path)) != path:
            own = ("name",) if name == world.name and "name" in document.data else ()
            advice = "in a pack, the names of levels and suites and of their files are unique"
            return Issue("BR701", own, f"`{name}` is already the name of {other}", advice)
    return None


_LOCAL_SCHEMA = re.compile(rb"^#.*\$schema=(?:file:|/|~|[A-Za-z]:[/\\])", re.MULTILINE)
"""A schema line that leads to a file of this machine."""


@dataclass(frozen=True, slots=True, repr=False)
class Packed:
    """What became of a folder.

    Attributes:
        contents: what is in it.
        paths: the files that belong to the pack.
        left_out: the files that do not.
        diagnostics: all findings, by file and position.
        data: the archive, None if there are errors among the diagnostics.
        local: the files that say where something lies on this machine, in their schema line.
        path: the file of the archive, None if none was written.
    """

    __module__ = "babyrobot_levels"

    contents: Contents
    paths: list[str]
    left_out: list[str]
    diagnostics: list[Diagnostic]
    data: bytes | None = None
    local: Sequence[str] = ()
    path: Path | None = None

    def __repr__(self) -> str:
        return f"<Packed {self.path or 'nothing'}: {self.contents.summary()}>"


def pack(folder: Path, lint: Callable[[Sequence[Path]], list[Diagnostic]]) -> Packed:
    """Check a folder and, if there are no errors, make a pack's archive of it.

    Its files are all YAML files below it, and those called `README.md` or `LICENSE`; hidden files
    are left out. Findings that are no errors do not prevent the archive.

    Args:
        folder: the folder.
        lint: returns the findings in level files, such as `brl.lint`.

    Raises:
        PackError: the folder has no `pack.yaml`, or contains more than a pack may.
        OSError: the folder cannot be read.
    """
    if not os.path.lexists(folder / PACK_FILE):
        raise PackError(f"it has no {PACK_FILE}")
    paths, left_out = _paths(folder)
    if unfit := list(_unfit(folder, paths)):
        return Packed(Contents(), paths, left_out, unfit)
    files = _read(folder, paths)
    contents = survey(folder, paths, folder)
    levels = [
        folder / path
        for path in paths
        if path != PACK_FILE and not is_theme(path) and Path(path).name not in TEXTS
    ]
    diagnostics = _merged(contents.diagnostics, lint(levels), paths, folder)
    fields = contents.fields
    if fields is None or any(each.severity is Severity.ERROR for each in diagnostics):
        return Packed(contents, paths, left_out, diagnostics)
    if not contents.levels and not contents.suites:
        raise PackError("it has neither levels nor suites")
    entries = {path: file_entry(data) for path, data in files.items()}
    manifest = Manifest(
        name=fields.name, version=fields.version, files=entries, levels=contents.levels
    )
    local = [path for path, data in files.items() if _LOCAL_SCHEMA.search(data)]
    return Packed(contents, paths, left_out, diagnostics, write_archive(manifest, files), local)


def _paths(folder: Path) -> tuple[list[str], list[str]]:
    """Return the files that belong to a pack, and those that do not, relative to its folder."""
    found: list[str] = []
    others: list[str] = []

    def fail(error: OSError) -> None:
        raise error

    for here, folders, names in os.walk(folder, onerror=fail):
        inside = Path(here).relative_to(folder)
        folders[:] = [name for name in folders if not name.startswith(".")]
        # Links are not followed, and must not be missed in silence.
        found += [(inside / name).as_posix() for name in folders if Path(here, name).is_symlink()]
        if len(inside.parts) == MAX_DEPTH:
            others += [f"{(inside / name).as_posix()}/" for name in folders]
            folders.clear()
        aside = [name for name in folders if is_aside(Path(here, name))]
        others += [f"{(inside / name).as_posix()}/" for name in aside]
        folders[:] = [name for name in folders if name not in aside]
        for name in names:
            if not name.startswith("."):
                (found if belongs(name) else others).append((inside / name).as_posix())
        if len(found) > MAX_FILES:
            raise PackError(f"it contains more than {MAX_FILES:,} files")
    return sorted(found), sorted(others)


def _unfit(folder: Path, paths: list[str]) -> Iterator[Diagnostic]:
    """Yield what keeps files out of a pack, whatever is in them."""
    twins = dict(clashes(paths))
    for path in paths:
        why = path_fault(path) or twins.get(path)
        if (folder / path).is_symlink():
            why = "is a link, and a pack contains only files"
        if why:
            name = str(folder / path)
            yield Diagnostic(
                "BR702",
                Severity.ERROR,
                f"this file {why}",
                name,
                1,
                1,
                START,
                help="rename it, or move it out of the pack's folder",
                source=SourceFile(name, ""),
            )


def _read(folder: Path, paths: list[str]) -> dict[str, bytes]:
    files = {}
    for path in paths:
        try:
            files[path] = read_bytes(folder / path, MAX_BYTES)
        except (IsADirectoryError, NotRegularError):
            raise PackError(f"{path!r} is not a regular file") from None
    check_sizes(files)
    return files


def _merged(
    errors: list[Diagnostic], linted: list[Diagnostic], paths: list[str], folder: Path
) -> list[Diagnostic]:
    """Return all that was found, each once, by file and place."""
    order: Mapping[str, int] = {str(folder / path): number for number, path in enumerate(paths)}
    return sorted(
        [*errors, *(each for each in linted if each not in errors)],
        key=lambda each: (order.get(each.file, -1), each.line, each.column, each.code),
    )
