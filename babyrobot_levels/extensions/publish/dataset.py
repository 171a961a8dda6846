"""Data sets of levels: Parquet files with a row for each level, and descriptions of them."""

import json
import os
from collections.abc import Callable, Generator, Iterator
from contextlib import closing
from dataclasses import dataclass
from functools import partial
from hashlib import file_digest
from itertools import count, islice
from pathlib import Path
from typing import Any

from babyrobot_levels.agents.sent import Item, received, sent
from babyrobot_levels.analysis.metrics import Metrics, metrics
from babyrobot_levels.analysis.pictures import to_png
from babyrobot_levels.extensions.publish.gallery import MAZE_SEED, TILE_SIDE, Progress, title_of
from babyrobot_levels.language.metric_names import MAX_SOLVED, METRICS
from babyrobot_levels.language.play import program
from babyrobot_levels.parallel import executor_for
from babyrobot_levels.parallel.executor import Failure
from babyrobot_levels.render.page import bare
from babyrobot_levels.render.scene.layout import CELL
from babyrobot_levels.render.templates import as_html, html, static
from babyrobot_levels.suites.suite import Levels, Suite, named_levels
from babyrobot_levels.text.diagnostics import one_line
from babyrobot_levels.text.emitter import emit
from babyrobot_levels.text.errors import FolderError, how_to_install
from babyrobot_levels.text.files import is_file, is_folder, written_folder

CARD, CROISSANT, DATA = "README.md", "croissant.json", "data"

ROWS = 500
"""How many rows are kept in memory, and written as one group."""

TEXTS = {
    "name": "name of the level",
    "title": "its title; may be empty",
    "level": "its file: YAML",
    "digest": "digest of its MDP: equal for equal MDPs",
    "code": "its share code",
    "license": "its license; may be empty",
}
SIZES = {"width": "width of the grid, in cells", "height": "height of the grid, in cells"}


@dataclass(frozen=True, slots=True)
class Dataset:
    """A data set that was written.

    Attributes:
        folder: its folder.
        splits: how many levels each split has, by its name.
    """

    __module__ = "babyrobot_levels"

    folder: Path
    splits: dict[str, int]


def dataset(
    levels: Levels,
    folder: str | os.PathLike[str],
    *,
    title: str | None = None,
    license: str | None = None,  # noqa: A002 - as levels and suites have it
    force: bool = False,
    jobs: int | None = None,
    progress: Progress | None = None,
) -> Dataset:
    """Write levels as a data set that other tools read: a row for each level; needs `parquet`.

    A row has the level's file, digest, share code, metrics (among them the optimal return) and
    picture. There is a Parquet file for each split of a suite, or one for all levels, named
    `train`; a card, `README.md`, with which the Hugging Face Hub and `datasets` know the splits
    and the columns; and `croissant.json`, which describes the same in Croissant 1.1.

    The folder is written under a temporary name and renamed when it is whole.

    Args:
        levels: a suite, a folder, a pack or a level: a name, a path, a mapping, a `Suite` or a
            `Level`; or several levels. The maze of a level with `seed: random` is that of seed 0.
        folder: the folder of the data set.
        title: its title; by default that of the suite, the name of the folder or pack, or `Levels`.
        license: the license of the whole, such as `cc-by-4.0`; by default, none is stated.
        force: whether to replace a data set that is there already.
        jobs: the number of worker processes; None for none, as 1.
        progress: told how many of how many levels are done.

    Raises:
        ImportError: PyArrow is not installed.
        FolderError: there is something at the path, other than a data set with `force`.
        LevelNotFoundError: there is no level, folder, pack or suite of that name.
        ValueError: there are no levels.
        OSError: the folder cannot be written.
        Exception: what `load` and `metrics` raise for a level, with a note that gives its index.
    """
    try:
        import pyarrow  # noqa: F401
    except ImportError as error:
        raise ImportError(f"a data set needs PyArrow: {how_to_install('parquet')}") from error
    path = Path(folder)
    _check_place(path, force=force)
    named = named_levels(levels)
    found = named if isinstance(named, Suite) else [*named]
    if not found:
        raise ValueError("there are no levels for a data set")
    title = title if title is not None else title_of(levels, found)
    parts = _parts(found)
    made = Dataset(path, {split: len(part) for split, part in parts.items()})
    tell = progress or (lambda done, total: None)
    with written_folder(path) as new:
        (new / DATA).mkdir()
        numbers, total = count(1), sum(made.splits.values())
        for split, part in parts.items():
            with closing(_rows(part, jobs, lambda: tell(next(numbers), total))) as rows:
                _write(new / DATA / f"{split}.parquet", rows)
        recipe = found.to_yaml() if isinstance(found, Suite) else ""
        (new / CARD).write_text(_card(made, title, license, recipe), "utf-8")
        described = _croissant(new, made, title, license)
        (new / CROISSANT).write_text(json.dumps(described, indent=1) + "\n", "utf-8")
    return made


def _parts(found: Suite | list[Any]) -> dict[str, Any]:
    """Return the levels of each split that has some."""
    if not isinstance(found, Suite) or found.to_arguments() is None or not found.splits:
        return {"train": found}
    whole = found.whole()
    if len(whole) != len(found):
        return {found.to_arguments()["split"]: found}  # type: ignore[index]
    return {name: whole.split(name) for name, size in whole.split_sizes().items() if size}


def _check_place(path: Path, *, force: bool) -> None:
    if not os.path.lexists(path) or (is_folder(path) and not any(path.iterdir())):
        return
    names = {each.name for each in path.iterdir()} if is_folder(path) else set()
    if not is_file(path / CROISSANT) or names - {CARD, CROISSANT, DATA}:
        raise FolderError(f"{path} is there, and is no data set", "choose a new or empty folder")
    if not force:
        raise FolderError(f"there is a data set in {path}", "use --force to replace it")


# -- rows -------------------------------------------------------------------------------------


def columns() -> dict[str, tuple[str, str]]:
    """Return the type of each column, by PyArrow's names, and what it says."""
    found = {name: ("string", text) for name, text in TEXTS.items()}
    found |= {name: ("int64", text) for name, text in SIZES.items()}
    types = {"int": "int64", "float": "float64", "tuple[str, ...]": "list<string>"}
    for name in METRICS:
        # What a metric is stands at its property.
        metric = Metrics.__dict__[name].func
        kind = types[metric.__annotations__["return"].removesuffix(" | None")]
        found[name] = (kind, one_line(metric.__doc__.partition("\n\n")[0]))
    return found | {"picture": ("image", "its picture, at most 400 pixels wide and high: PNG")}


def _rows(
    part: Suite | list[Any], jobs: int | None, told: Callable[[], None]
) -> Generator[dict[str, Any]]:
    """Yield the row of each level, and tell of each."""
    suite, items = sent(part)
    with closing(executor_for(jobs=jobs).map(partial(_row, suite), items)) as outcomes:
        for index, row in enumerate(outcomes):
            if isinstance(row, Failure):
                row.error.add_note(f"in level {index}")
                raise row.error
            yield row
            told()


def _row(suite: str | None, item: Item) -> dict[str, Any]:
    """Return the row of a level that was sent."""
    level = received(suite, item)
    if level.has_random_maze:
        level = level.with_maze_seed(MAZE_SEED)
    found = metrics(level)
    scale = min(1.0, TILE_SIDE / (CELL * max(level.size)))
    return {
        "name": level.name or "",
        "title": level.title or "",
        "level": level.to_yaml(),
        "digest": level.digest,
        "code": level.share_code(),
        "license": level.license or "",
        "width": level.size[0],
        "height": level.size[1],
        **found.to_dict(solve=found.states <= MAX_SOLVED),
        "picture": {"bytes": to_png(bare(level), scale=scale), "path": None},
    }


def _write(path: Path, rows: Iterator[dict[str, Any]]) -> None:
    """Write rows to a Parquet file."""
    import pyarrow as pa
    from pyarrow import parquet

    kinds: dict[str, tuple[Any, dict[str, Any]]] = {
        "int64": (pa.int64(), {"dtype": "int64", "_type": "Value"}),
        "float64": (pa.float64(), {"dtype": "float64", "_type": "Value"}),
        "string": (pa.string(), text := {"dtype": "string", "_type": "Value"}),
        "list<string>": (pa.list_(pa.string()), {"feature": text, "_type": "List"}),
        "image": (pa.struct({"bytes": pa.binary(), "path": pa.string()}), {"_type": "Image"}),
    }
    found = {name: kinds[kind] for name, (kind, _) in columns().items()}
    # `datasets` looks here for what is no type of Parquet.
    features = {"info": {"features": {name: feature for name, (_, feature) in found.items()}}}
    fields = [(name, kind) for name, (kind, _) in found.items()]
    schema = pa.schema(fields, {"huggingface": json.dumps(features)})
    with parquet.ParquetWriter(path, schema, compression="zstd") as file:
        while group := list(islice(rows, ROWS)):
            file.write_table(pa.Table.from_pylist(group, schema))


# -- descriptions -----------------------------------------------------------------------------


def _card(made: Dataset, title: str, terms: str | None, recipe: str) -> str:
    """Return the card: what the Hub reads, and what people read."""
    files = [{"split": split, "path": f"{DATA}/{split}.parquet"} for split in made.splits]
    about: dict[str, Any] = {"pretty_name": title} | ({"license": terms} if terms else {})
    about["tags"] = ["reinforcement-learning", "gridworld", "gymnasium"]
    about["configs"] = [{"config_name": "default", "data_files": files}]
    lines = [f"| `{name}` | {kind} | {text} |" for name, (kind, text) in columns().items()]
    sizes = [f"- `{split}`: {size:,} levels" for split, size in made.splits.items()]
    texts = {
        "about": emit(about),
        "title": one_line(title),
        "made_by": program(),
        "sizes": "\n".join(sizes),
        "first": next(iter(made.splits)),
        "columns": "\n".join(lines),
        "most": f"{MAX_SOLVED:,}",
        "recipe": recipe,
    }
    marked = {name: as_html(text) for name, text in texts.items()}
    return html("extensions/publish/static/dataset.md.jinja", **marked)


def _croissant(folder: Path, made: Dataset, title: str, terms: str | None) -> dict[str, Any]:
    """Return the description in Croissant."""
    files, records = [], []
    for split in made.splits:
        path = f"{DATA}/{split}.parquet"
        with (folder / path).open("rb") as file:
            digest = file_digest(file, "sha256").hexdigest()
        files.append(
            {
                "@type": "cr:FileObject",
                "@id": path,
                "name": path,
                "contentUrl": path,
                "encodingFormat": "application/x-parquet",
                "sha256": digest,
            }
        )
        fields = [_field(split, path, name, *about) for name, about in columns().items()]
        records.append({"@type": "cr:RecordSet", "@id": split, "name": split, "field": fields})
    return {
        "@context": json.loads(static("extensions/publish/static/croissant.json")),
        "@type": "sc:Dataset",
        "name": title,
        "description": f"Levels of grid worlds with their exact metrics. Written by {program()}.",
        "conformsTo": "http://mlcommons.org/croissant/1.1",
        **({"license": terms} if terms else {}),
        "distribution": files,
        "recordSet": records,
    }


def _field(split: str, path: str, name: str, kind: str, text: str) -> dict[str, Any]:
    source = {"fileObject": {"@id": path}, "extract": {"column": name}}
    return {
        "@type": "cr:Field",
        "@id": f"{split}/{name}",
        "name": name,
        "description": text,
        "dataType": _CROISSANT_TYPES[kind],
        "source": source | ({"transform": {"jsonPath": "bytes"}} if kind == "image" else {}),
        **({"isArray": True, "arrayShape": "-1"} if kind == "list<string>" else {}),
    }


_CROISSANT_TYPES = {
    "string": "sc:Text",
    "list<string>": "sc:Text",
    "int64": "sc:Integer",
    "float64": "sc:Float",
    "image": "sc:ImageObject",
}
