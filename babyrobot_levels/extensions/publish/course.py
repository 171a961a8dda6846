"""Courses: a folder to begin with, and what students and teachers get of one."""

import math
import os
import shutil
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from babyrobot_levels.analysis.sharing import share
from babyrobot_levels.extensions.packs.archive import SUFFIX, PackError
from babyrobot_levels.extensions.packs.build import Course, read_course
from babyrobot_levels.extensions.publish.desk import write_desk
from babyrobot_levels.extensions.publish.gallery import gallery
from babyrobot_levels.extensions.publish.packing import pack
from babyrobot_levels.extensions.publish.schools import (
    classroom50,
    github_classroom,
    gradescope,
    packed,
    packed_wheel,
    prairielearn,
    requirements,
    scorm,
)
from babyrobot_levels.extensions.publish.sheet import MAX_CELLS, PAPERS, Sheet, sheet
from babyrobot_levels.language.names import slug
from babyrobot_levels.library.catalogue import load
from babyrobot_levels.library.search_path import data_folder
from babyrobot_levels.text.emitter import emit
from babyrobot_levels.text.errors import FolderError
from babyrobot_levels.text.files import (
    PACK_FILE,
    is_file,
    is_within,
    write_bytes,
    write_text,
    written_folder,
)

CONTENTS = "contents.txt"
"""The list of what was built, by which a folder is known as one that may be replaced."""

PER_PAGE = 2
"""The levels on a page of a sheet: their cells have room for numbers."""

_HEAD = "made by babyrobot course"


@dataclass(frozen=True, slots=True)
class BuiltCourse:
    """What was made of a course.

    Attributes:
        folder: the folder of what was made.
        title: the title of the course.
        files: all files, relative to the folder, in the order of their paths.
        size: their bytes, all together.
    """

    __module__ = "babyrobot_levels"

    folder: Path
    title: str
    files: tuple[str, ...]
    size: int


def new_course(folder: str | os.PathLike[str]) -> Path:
    """Write a course to change: levels, a skeleton of code for students, and `grade.py`.

    Args:
        folder: the folder, new or empty; its name becomes that of the course.

    Returns:
        The folder.

    Raises:
        FolderError: there is something in the folder.
        OSError: it cannot be written.
    """
    path = Path(folder)
    if os.path.lexists(path) and not (path.is_dir() and not any(path.iterdir())):
        raise FolderError(f"{path} is there already", "choose a folder that is new or empty")
    example = data_folder("course")
    with written_folder(path) as new:
        shutil.copytree(example, new, dirs_exist_ok=True, ignore=_IGNORED)
        text = (new / PACK_FILE).read_text("utf-8")
        name = slug(path.resolve().name) or "robot-course"
        write_text(new / PACK_FILE, text.replace("robot-course", name, 1))
    return path


_IGNORED = shutil.ignore_patterns("__pycache__", ".*", f"*{SUFFIX}")


def course(
    folder: str | os.PathLike[str],
    output: str | os.PathLike[str],
    *,
    browser: bool = False,
    runtime: str | os.PathLike[str] | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> BuiltCourse:
    """Make of a course all that students and teachers get.

    For students, without hidden levels and answers: a site, sheets, a pack, share codes, and the
    code with the levels. For teachers: the site and the sheets with the answers, and autograders.

    Args:
        folder: the folder of the course, whose `pack.yaml` lists `levels`.
        output: the folder to write to: new, empty, or made by this function.
        browser: whether there is a page, too, in which students write the functions, and run them
            without installing.
        runtime: a folder with the files of Python for browsers, which `babyrobot editor --site`
            takes, too: then there is that page. By default, npm fetches them.
        progress: told how many of how many parts are done.

    Raises:
        PackError: there is no course in the folder, or a level is too large for sheets.
        LevelError: a file of the course has errors, or a maze is random.
        FolderError: the output is a folder of something else, or inside the course.
        RuntimeFileError: a file of Python for browsers cannot be had.
        OSError: a folder cannot be written.
    """
    found, path = read_course(folder), Path(output)
    _check_place(path, found.folder)
    title = found.fields.title or found.fields.name
    with written_folder(path) as new:
        parts = [*_parts(found, title, new)]
        if browser or runtime is not None:
            given = None if runtime is None else Path(runtime)
            parts.insert(0, lambda: write_desk(found, title, new / "students" / "browser", given))
        for number, make in enumerate(parts, 1):
            make()
            if progress is not None:
                progress(number, len(parts))
        files = sorted(
            each.relative_to(new).as_posix() for each in new.rglob("*") if each.is_file()
        )
        size = sum((new / each).stat().st_size for each in files)
        write_text(new / CONTENTS, "\n".join([f"{_HEAD}: {title}", *files, ""]))
    return BuiltCourse(path, title, (*files,), size)


def _check_place(path: Path, course: Path) -> None:
    if is_within(path, course) or is_within(course, path) or is_within(Path(), path):
        advice = "choose a folder beside it"
        raise FolderError(f"{path} is not apart from the course and the current folder", advice)
    if not os.path.lexists(path) or (path.is_dir() and not any(path.iterdir())):
        return
    contents = (path / CONTENTS).read_text("utf-8", "replace") if is_file(path / CONTENTS) else ""
    head, *known = contents.splitlines() or [""]
    if not head.startswith(_HEAD):
        advice = "choose a folder that is new or empty"
        raise FolderError(f"{path} is something else than a course that was built", advice)
    others = {each.relative_to(path).as_posix() for each in path.rglob("*") if each.is_file()}
    others -= {*known, CONTENTS}
    if others:
        raise FolderError(f"there are other files in {path}: {min(others)}", "move them elsewhere")


def _parts(course: Course, title: str, new: Path) -> Iterator[Callable[[], object]]:
    """Yield what makes each part: first the code, of which files may be missing."""
    entries = course.fields.levels
    everything = {each.level: load(course.files[each.level]) for each in entries}
    for name, level in everything.items():
        if (cells := math.prod(level.size)) > MAX_CELLS:
            told = f"the level {name} has {cells:,} cells; sheets show at most {MAX_CELLS:,}"
            raise PackError(told, "use a smaller level")
    given = [everything[each.level] for each in entries if not each.hidden]
    students, teacher, code = new / "students", new / "teacher", new / "students" / "code"
    yield lambda: _copy(course, code)
    if course.fields.functions:
        yield lambda: _add_package(code)
    pages = partial(gallery, title=title, points={each.level: each.points for each in entries})
    yield lambda: pages(given, students / "site", answers=False)
    yield lambda: pages([*everything.values()], teacher / "site", key=True)
    made = partial(sheet, title=title, per_page=PER_PAGE)
    for paper in PAPERS:
        path, of_key = students / f"sheet-{paper}.pdf", teacher / f"sheet-key-{paper}.pdf"
        yield partial(_save, partial(made, given, paper=paper), path)
        yield partial(_save, partial(made, [*everything.values()], paper=paper, key=True), of_key)
    archive = students / f"{course.fields.name}-{course.fields.version}{SUFFIX}"
    yield lambda: pack(code, archive)
    codes = "".join(f"{level.name}\n{share(level)}\n\n" for level in given)
    yield lambda: write_text(students / "codes.txt", codes)
    yield lambda: write_bytes(teacher / "scorm.zip", packed(scorm(given, title)))
    if course.fields.functions:
        yield lambda: write_bytes(teacher / "gradescope.zip", packed(gradescope(course)))
        yield lambda: write_bytes(teacher / "classroom50.zip", packed(classroom50(course)))
        yield lambda: write_bytes(teacher / "prairielearn.zip", packed(prairielearn(course, title)))
        yield lambda: write_text(teacher / "github-classroom.yml", github_classroom())


def _save(make: Callable[[], Sheet], path: Path) -> None:
    make().save(path)


def _add_package(code: Path) -> None:
    """Add the package, so that students need nothing but Python, and what it needs from PyPI."""
    name, data = packed_wheel()
    if name:
        write_bytes(code / name, data)
    write_text(code / "requirements.txt", requirements())


def _copy(course: Course, target: Path) -> None:
    """Copy what students get: the pack without hidden levels, the code, and what is given.

    Raises:
        PackError: what is given is no file of the course.
    """
    hidden = {course.files[each.level] for each in course.fields.levels if each.hidden}
    code = [f"{name}.py" for name in course.fields.functions]
    for name in code:
        if not is_file(course.folder / name):
            told = f"there is no {name} in {course.folder}, which students fill in"
            raise PackError(told, "write it, or leave its function out of `functions`")
    code += ["grade.py"] * is_file(course.folder / "grade.py")
    paths = [*course.paths, *code]
    for name in (*paths, *course.fields.given):
        path = course.folder / name
        if ".." in Path(name).parts or not (is_file(path) and is_within(path, course.folder)):
            raise PackError(f"students cannot get {name}: it is no file in {course.folder}")
        if path not in hidden:
            write_bytes(target / path.relative_to(course.folder), path.read_bytes())
    fields = course.fields.model_dump(mode="json", exclude_defaults=True)
    fields["levels"] = [each for each in fields["levels"] if not each.get("hidden")]
    write_text(target / PACK_FILE, emit(fields))
