"""What names of levels stand for, the same wherever levels are given."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import babyrobot_levels as brl
from babyrobot_levels.library.search_path import gallery_folder
from babyrobot_levels.suites.named import named_levels

LEVEL = {"version": 1, "size": [2, 1]}
SUITE = {"version": 1, "kind": "suite", "count": 3, "size": [4, 4]}


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder of two levels and a suite, below an empty current folder."""
    monkeypatch.chdir(tmp_path)
    folder = tmp_path / "week-1"
    (folder / "more").mkdir(parents=True)
    for name, width in {"b": 3, "more/a": 2}.items():
        text = f"version: 1\nname: level-{width}\nsize: [{width}, 1]\n"
        (folder / f"{name}.yaml").write_text(text, encoding="utf-8")
    suite = "version: 1\nkind: suite\ncount: 2\nsize: [4, 4]\n"
    (folder / "drawn.yaml").write_text(suite, encoding="utf-8")
    return folder


def names(levels: Any) -> list[str | None]:
    return [brl.load(each).name for each in named_levels(levels)]


@pytest.mark.usefixtures("folder")
@pytest.mark.parametrize(
    ("given", "expected"),
    [
        ("maze", ["maze"]),
        ("gallery/maze", ["maze"]),
        ("week-1/b.yaml", ["level-3"]),
        (Path("week-1", "b.yaml"), ["level-3"]),
        (LEVEL, [None]),
        (brl.load("maze"), ["maze"]),
        (brl.load("maze").share_code(), ["maze"]),
        (["maze", LEVEL], ["maze", None]),
        # The suite in the folder is no level.
        ("week-1", ["level-3", "level-2"]),
        ("week-1/", ["level-3", "level-2"]),
        (Path("week-1"), ["level-3", "level-2"]),
        ("week-1/drawn.yaml", ["drawn-00000", "drawn-00001"]),
        (Path("week-1", "drawn.yaml"), ["drawn-00000", "drawn-00001"]),
        (SUITE, ["level-00000", "level-00001", "level-00002"]),
        (brl.load_suite("small-mazes")[3:5], ["small-mazes-00003", "small-mazes-00004"]),
    ],
    ids=repr,
)
def test_levels_are_named_by_names_paths_folders_and_suites(
    given: Any, expected: list[str | None]
) -> None:
    assert names(given) == expected


@pytest.mark.usefixtures("folder")
def test_a_pack_is_all_of_its_levels() -> None:
    assert len(names("gallery")) == len([*gallery_folder().rglob("*.yaml")]) - len(
        [*gallery_folder().rglob("suites/*.yaml")]
    )
    # A path is never the name of a pack.
    with pytest.raises(brl.LevelNotFoundError):
        named_levels(Path("gallery"))


@pytest.mark.usefixtures("folder")
def test_a_level_comes_before_a_folder_and_a_folder_before_a_pack() -> None:
    Path("maze").mkdir()
    assert names("maze") == ["maze"]
    Path("gallery").mkdir()
    Path("gallery", "own.yaml").write_text("version: 1\nname: own\nsize: [2, 1]\n")
    assert names("gallery") == ["own"]


@pytest.mark.usefixtures("folder")
def test_what_is_not_there_is_told() -> None:
    with pytest.raises(
        brl.LevelNotFoundError, match="no level called 'mazee'; did you mean 'maze'"
    ):
        named_levels("mazee")
    with pytest.raises(brl.LevelNotFoundError, match=r"there is no file 'week-2/a\.yaml'"):
        named_levels("week-2/a.yaml")
    Path("empty").mkdir()
    with pytest.raises(ValueError, match=r"no level files \(\.yaml\) in empty"):
        named_levels("empty")
    with pytest.raises(TypeError, match=r"levels are a name, a path, .* not int"):
        named_levels(3)  # type: ignore[arg-type]


def test_all_that_take_levels_take_a_folder(folder: Path, tmp_path: Path) -> None:
    assert [each.name for each in brl.solve_many(folder)] == ["level-3", "level-2"]
    assert [each.level for each in brl.score("random", folder)] == ["level-3", "level-2"]
    assert len(brl.sheet(folder, per_page=1).pages) == 2
    made = brl.gallery(folder, tmp_path / "site")
    assert made.title == "week-1"
    assert [each["name"] for each in made.levels] == ["level-3", "level-2"]
