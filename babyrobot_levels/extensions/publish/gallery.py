"""Galleries: a folder of web pages on which many levels can be browsed and played, offline."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import closing, suppress
from dataclasses import dataclass
from functools import partial
from itertools import count
from pathlib import Path
from typing import Any

from babyrobot_levels.agents.sent import Item, received, sent
from babyrobot_levels.analysis import pictures
from babyrobot_levels.analysis.guides import guide_of
from babyrobot_levels.analysis.solver.results import Solution
from babyrobot_levels.extensions.publish.facts import Facts, Files, facts_of, measured
from babyrobot_levels.extensions.publish.level_page import level_html, values_svgs, with_neighbours
from babyrobot_levels.extensions.publish.wall import ASSETS, wall_html
from babyrobot_levels.language.play import program
from babyrobot_levels.language.share_code import is_code
from babyrobot_levels.language.suite import SuiteFields
from babyrobot_levels.library.catalogue import LevelLike, folder_named, load
from babyrobot_levels.library.level import Level
from babyrobot_levels.library.search_path import gallery_folder, gallery_order
from babyrobot_levels.parallel import executor_for
from babyrobot_levels.render.page import bare
from babyrobot_levels.render.raster import reduced, to_png
from babyrobot_levels.render.scene.layout import CELL
from babyrobot_levels.render.scene.shapes import Scene
from babyrobot_levels.render.svg import to_svg
from babyrobot_levels.suites.suite import Levels, Suite, named_levels
from babyrobot_levels.text.errors import BabyRobotError, FolderError
from babyrobot_levels.text.files import (
    GALLERY_FILES,
    RESERVED,
    is_file,
    is_folder,
    read_bytes,
    written_folder,
)
from babyrobot_levels.text.source import with_schema

FORMAT = 1
"""The version of the format of `gallery.json`."""

LIST, INDEX = GALLERY_FILES
ASSETS_FOLDER = "assets"

GALLERY_TITLE = "The babyrobot gallery"
"""The title of the package's own gallery."""

MAX_LIST = 1 << 28
"""The most bytes of the `gallery.json` of a gallery that is replaced."""

MAX_ID = 60
"""The most characters of an id, without the number that may follow."""

Progress = Callable[[int, int], None]
"""Is told how many of how many levels are done."""


@dataclass(frozen=True, slots=True)
class Gallery:
    """A gallery that was written.

    Attributes:
        folder: its folder; `index.html` in it is the page to open.
        title: its title.
        levels: the facts of its levels, as `gallery.json` has them.
        left_out: the errors of the levels that were left out, by their indices from 0.
    """

    __module__ = "babyrobot_levels"

    folder: Path
    title: str
    levels: tuple[Mapping[str, Any], ...]
    left_out: Mapping[int, Exception]


def gallery(
    levels: Levels,
    folder: str | os.PathLike[str],
    *,
    title: str | None = None,
    answers: bool = True,
    key: bool = False,
    home: str | None = None,
    editor: str | None = None,
    points: Mapping[str, float] | None = None,
    force: bool = False,
    keep_going: bool = False,
    jobs: int | None = None,
    progress: Progress | None = None,
) -> Gallery:
    """Write web pages on which levels can be browsed and played, with nothing installed.

    The pages need no server and no network. Beside them there are pictures, films, the files of
    the levels, and `gallery.json`, which other programs can read. The maze of a level with
    `seed: random` is that of seed 0.

    The folder is written under a temporary name and renamed when it is whole. A gallery that is
    there already is replaced.

    Args:
        levels: a suite, a folder, a pack or a level: a name, a path, a mapping, a `Suite` or a
            `Level`; or several levels.
        folder: the folder of the gallery.
        title: its title; by default that of the suite, the name of the folder or pack, or `Levels`.
        answers: whether the gallery knows the solutions of the levels. With False, no file
            contains anything of optimal values, policies, returns, and difficulty.
        key: whether pictures and pages show values and policies from the start.
        home: an address that the gallery links back to: https, or a path.
        editor: the address of a site of the editor (`babyrobot edit --site`), in which each level
            can be edited: https, or a path from the gallery's folder.
        points: what the levels of a course are worth, by their names; then they are numbered.
        force: whether to replace also a gallery to which other files were added, with these.
        keep_going: whether to leave out a level with an error.
        jobs: the number of worker processes; None for none, as 1.
        progress: told how many of how many levels are done.

    Returns:
        What was written, and what was left out.

    Raises:
        FolderError: there is something at the path that is no gallery of this program, or the
            current folder.
        LevelNotFoundError: there is no level, folder, pack or suite of that name.
        ValueError: there are no levels, or the arguments contradict each other.
        OSError: the folder cannot be written.
        Exception: without `keep_going`, what `load` raises for a level, with a note that gives its
            index. What was in the folder before is still there.
    """
    if key and not answers:
        raise ValueError("a teacher's copy (key) shows the answers; leave out answers=False")
    pictures.page_address("home", home)
    pictures.page_address("editor", editor)
    path = Path(folder)
    check_place(path, force=force)
    named = named_levels(levels)
    found = named if isinstance(named, Suite) else in_order(levels, [*named])
    title = title if title is not None else title_of(levels, found)
    shown = GalleryPages(title=title, answers=answers, key=key, editor=editor)
    facts: list[Facts] = []
    left_out: dict[int, Exception] = {}
    with written_folder(path) as new:
        suite, items = sent(found)
        work = zip(_ids(_names(found)), _splits(found), items, strict=True)
        outcomes = executor_for(jobs=jobs).map(partial(_written, new, shown, suite), work)
        with closing(outcomes):
            for index, outcome in enumerate(outcomes):
                if isinstance(outcome, Facts):
                    facts.append(outcome)
                elif keep_going and isinstance(outcome.error, BabyRobotError | ValueError):
                    # It is one of a level, and not of the disk.
                    left_out[index] = outcome.error
                else:
                    outcome.error.add_note(f"in level {index}")
                    raise outcome.error
                if progress is not None:
                    progress(index + 1, len(found))
        if not facts:
            raise ValueError("there are no levels for a gallery")
        _write_shared(new, facts, shown, home, points)
    return Gallery(path, title, tuple(each.to_dict() for each in facts), left_out)


def _written(
    folder: Path, shown: GalleryPages, suite: str | None, work: tuple[str, str, Item]
) -> Facts:
    """Write the files of a level that was sent, and return its facts."""
    name, split, item = work
    return write_level(received(suite, item), folder, name=name, split=split, shown=shown)


def _write_shared(
    folder: Path,
    facts: list[Facts],
    shown: GalleryPages,
    home: str | None,
    points: Mapping[str, float] | None,
) -> None:
    """Write what is there once for all levels."""
    for previous, each, following in zip(
        [None, *facts[:-1]], facts, [*facts[1:], None], strict=True
    ):
        page = folder / each.files.page
        page.write_text(with_neighbours(page.read_text("utf-8"), previous, following), "utf-8")
    assets = folder / ASSETS_FOLDER
    assets.mkdir()
    for name, text in ASSETS.items():
        (assets / name).write_text(text(), "utf-8")
    wall = wall_html(
        facts, title=shown.title, answers=shown.answers, key=shown.key, home=home, points=points
    )
    (folder / INDEX).write_text(wall, "utf-8")
    data = {
        "format": FORMAT,
        "title": shown.title,
        "made_by": program(),
        "levels": [each.to_dict() for each in facts],
    }
    (folder / LIST).write_text(json.dumps(data, indent=1, allow_nan=False) + "\n", "utf-8")


# -- names ---------------------------------------------------------------------------------


def title_of(levels: Levels, found: Suite | list[LevelLike]) -> str:
    """Return the title of many levels, from what was asked for and the levels that it is."""
    if isinstance(found, Suite):
        return found.fields.title or found.name or "Levels"
    if _is_package_gallery(levels):
        return GALLERY_TITLE
    if isinstance(levels, str | os.PathLike) and folder_named(levels) is not None:
        return Path(levels).resolve().name
    return "Levels"


def _is_package_gallery(levels: Levels) -> bool:
    folder = folder_named(levels) if isinstance(levels, str | os.PathLike) else None
    return folder is not None and folder.resolve() == gallery_folder().resolve()


def in_order(levels: Levels, found: list[LevelLike]) -> list[LevelLike]:
    """Return the levels of the package's gallery in the order chosen for them, others as found."""
    if not _is_package_gallery(levels):
        return found
    places = {name: place for place, name in enumerate(gallery_order())}
    return sorted(found, key=lambda level: places.get(Path(str(level)).stem, len(places)))


def _names(levels: Suite | list[LevelLike]) -> Iterator[str]:
    """Yield a name for each level, without loading files and growing mazes."""
    if isinstance(levels, Suite) and isinstance(levels.fields, SuiteFields):
        name = levels.name or "level"
        yield from (f"{name}-{number}" for number in levels.numbers)
        return
    for level in levels:
        if isinstance(level, str | os.PathLike) and not is_code(str(level)):
            yield Path(level).stem
        else:
            yield _own_name(level)


def _own_name(level: LevelLike) -> str:
    try:
        return load(level).name or "level"
    except BabyRobotError:
        # It is reported where the level is needed.
        return "level"


def _ids(names: Iterable[str]) -> Iterator[str]:
    """Yield an id for each name: lower-case letters, digits and hyphens, unique."""
    taken = {ASSETS_FOLDER, *RESERVED}
    last: dict[str, int] = {}
    for name in names:
        base = re.sub(r"[^a-z0-9]+", "-", name.lower())[:MAX_ID].strip("-") or "level"
        own = base
        if own in taken:
            numbers = count(last.get(base, 1) + 1)
            number = next(each for each in numbers if f"{base}-{each}" not in taken)
            last[base], own = number, f"{base}-{number}"
        taken.add(own)
        yield own


def _splits(levels: Suite | list[LevelLike]) -> Iterator[str]:
    """Yield the split of each level; "" for none."""
    if not isinstance(levels, Suite) or not levels.splits:
        yield from ("" for _ in range(len(levels)))
        return
    whole = levels.whole()
    sizes = levels.split_sizes()
    split_of = {
        number: name for name, size in sizes.items() if size for number in whole.split(name).numbers
    }
    yield from (split_of.get(number, "") for number in levels.numbers)


# -- the place -----------------------------------------------------------------------------


def check_place(path: Path, *, force: bool = False) -> None:
    """Check that a gallery may be written to a path.

    Args:
        path: the path.
        force: whether a gallery may have other files in it.

    Raises:
        FolderError: there is something that is not a gallery, one with other files in it, or the
            current folder.
    """
    if not os.path.lexists(path):
        return
    if not is_folder(path):
        raise FolderError(f"{path} is not a folder", "choose another path")
    if Path.cwd().is_relative_to(path.resolve()):
        # It would be deleted with the folder, which the shell would not notice.
        raise FolderError(
            f"{path} is or contains the current folder, which cannot be replaced",
            "run the command in another folder, or choose another path",
        )
    if not any(path.iterdir()):
        return
    known = _known_files(path)
    if known is None:
        raise FolderError(
            f"{path} is a folder that is not a gallery", "choose a folder that is new or empty"
        )
    others = sorted({each.relative_to(path).as_posix() for each in path.rglob("*")} - known)
    if others and not force:
        raise FolderError(
            f"there are other files in the gallery {path}: {others[0]}",
            "move them elsewhere, or use --force to delete them with the old gallery",
        )


def _known_files(path: Path) -> set[str] | None:
    """Return what a gallery consists of, by its `gallery.json`; None if there is no valid one."""
    if not is_file(path / LIST):
        return None
    try:
        data = json.loads(read_bytes(path / LIST, MAX_LIST))
        if data["format"] != FORMAT or not data["made_by"].startswith(program().split()[0]):
            return None
        listed = [names or [] for level in data["levels"] for names in level["files"].values()]
        files = {name for each in listed for name in ([each] if isinstance(each, str) else each)}
        folders = {name.partition("/")[0] for name in files}
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError):
        return None
    assets = {f"{ASSETS_FOLDER}/{name}" for name in _asset_names(path)}
    return {INDEX, LIST, ASSETS_FOLDER} | files | folders | assets


def _asset_names(path: Path) -> Iterator[str]:
    """Yield the names of the shared files of a gallery, which another version may have written."""
    folder = path / ASSETS_FOLDER
    for each in folder.iterdir() if is_folder(folder) else ():
        if each.suffix in (".css", ".js", ".svg") and is_file(each):
            yield each.name


# -- the files of a level --------------------------------------------------------------------------

MAZE_SEED = 0
"""The seed of the maze that is shown of a level whose maze is random."""

MAX_SIDE = 1600
"""The largest width and height of a picture in pixels."""

TILE_SIDE = 400
"""The largest width and height of a picture on the wall in pixels."""

FILM_SIDE = 280
"""The largest width and height of a film in pixels."""

MAX_FILM_STEPS = 150
"""Episodes of more steps have no film."""


@dataclass(frozen=True, slots=True)
class GalleryPages:
    """What the pages of a gallery show.

    Attributes:
        title: the title of the gallery.
        answers: whether it knows the answers.
        key: whether it is the teacher's copy, which shows the answers from the start.
        editor: the address of a site of the editor; None for none.
    """

    title: str
    answers: bool
    key: bool
    editor: str | None = None


def write_level(level: Level, folder: Path, *, name: str, split: str, shown: GalleryPages) -> Facts:
    """Write the files of a level, and return its facts.

    Args:
        level: the level.
        folder: the folder of the gallery.
        name: the name of the level's own folder in it.
        split: the split of the suite that the level belongs to; may be empty.
        shown: what the pages show.
    """
    (folder / name).mkdir()
    # Comments may tell what the level is worth, and what is expected of it does.
    told = level if shown.answers else level.replace(expect=None)
    text = with_schema(told.to_yaml(comments=shown.answers))
    is_random = level.has_random_maze
    level = level.with_maze_seed(MAZE_SEED) if is_random else level
    found = measured(level) if shown.answers else None
    solution = found.solution if found is not None else None
    # In a small picture, the texts of panels cannot be read.
    plain = bare(level)
    film = _film(plain, solution, shown) if solution is not None else None
    guide = guide_of(level, solution) if solution is not None else None
    values = values_svgs(level, guide, f"{name}/values.svg") if guide is not None else {}
    files = Files(
        page=f"{name}/index.html",
        level=f"{name}/level.yaml",
        svg=f"{name}/picture.svg",
        png=f"{name}/picture.png",
        tile=f"{name}/tile.png",
        film=f"{name}/film.gif" if film is not None else None,
        values=next(iter(values), None),
        sets=[*values][1:],
    )
    facts = facts_of(
        level, name, files, split=split, metrics=found, maze_seed=MAZE_SEED if is_random else None
    )
    over = solution if shown.key else None
    scene = pictures.still(level, values=over, policy=over)
    png = _png(scene)
    has_panels = plain.display != level.display
    small = _png(pictures.still(plain, values=over, policy=over)) if has_panels else png
    made = {
        files.level: text,
        files.svg: to_svg(scene),
        files.png: png,
        files.tile: reduced(small, TILE_SIDE),
        files.film: film,
    }
    written = {
        path: data.encode("utf-8") if isinstance(data, str) else data
        for path, data in (*made.items(), *values.items())
        if path is not None and data is not None
    }
    page = level_html(
        level,
        facts,
        text=text,
        guide=guide,
        answers=shown.answers,
        key=shown.key,
        title=shown.title,
        editor=shown.editor,
        sizes={path: len(data) for path, data in written.items()},
    )
    for path, data in {**written, files.page: page.encode("utf-8")}.items():
        (folder / path).write_bytes(data)
    return facts


def _png(scene: Scene) -> bytes:
    scale = min(1.0, MAX_SIDE / max(scene.width, scene.height))
    return to_png(scene, (round(scale * scene.width), round(scale * scene.height)))


def _film(level: Level, solution: Solution, shown: GalleryPages) -> bytes | None:
    """Return an episode of the optimal policy as a film; None if it is too long, or too large."""
    if not solution.expected_steps <= MAX_FILM_STEPS:
        return None
    with suppress(ValueError):
        return pictures.to_gif(
            level,
            policy=solution,
            values=solution if shown.key else None,
            scale=min(1.0, FILM_SIDE / (CELL * max(level.size))),
            tell=lambda _: None,
        )
    return None
