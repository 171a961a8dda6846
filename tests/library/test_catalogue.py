"""Finding levels: by name, in all their places, by path, with their themes; and telling of faults.

Every test has a current folder and a user's folder of its own.
"""

from __future__ import annotations

import importlib
import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import gymnasium
import pytest
from support.carriers import carry
from support.each import for_each
from support.playing import GALLERY
from support.sessions import run_here
from support.subprocesses import run

import babyrobot_levels as brl
from babyrobot_levels.library.catalogue import catalogue, level_files
from babyrobot_levels.library.search_path import places, yaml_files
from babyrobot_levels.text.files import user_folder

LEVEL = "version: 1\nsize: [4, 3]\n"

Write = Callable[..., Path]

pytestmark = pytest.mark.usefixtures("here")


def write(path: Path | str, text: str = LEVEL) -> Path:
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, "utf-8")
    return path


def titled(title: str) -> str:
    return f"{LEVEL}title: {title}\n"


# -- ways of telling a level -----------------------------------------------------------------


def test_a_path(here: Path, tmp_path: Path) -> None:
    path = write("first-maze.yaml")
    other = write("second.yml")
    write(tmp_path / "home" / "third.yaml")
    deep = write("some/where/fourth.yaml")
    ways: list[tuple[str | Path, str]] = [
        (path, "first-maze"),
        ("first-maze.yaml", "first-maze"),
        (str(here / "first-maze.yaml"), "first-maze"),
        (other, "second"),
        ("~/third.yaml", "third"),
        (Path("~/third.yaml"), "third"),
        ("some/where/fourth.yaml", "fourth"),
        (str(deep), "fourth"),
    ]
    for way, name in ways:
        assert brl.load(way).name == name, way


def test_a_file_with_another_suffix_is_a_path_where_it_is() -> None:
    write("maze.json", '{"version": 1, "size": [2, 5]}')
    assert brl.load("maze.json").size == (2, 5)
    assert run_here(["show", "maze.json"], dict(os.environ)).status == 0
    with pytest.raises(brl.LevelNotFoundError, match=r"no level called 'other\.json'"):
        brl.load("other.json")


def test_a_file_without_suffix_is_told_with_its_folder() -> None:
    write("mine/first-maze")
    assert brl.load("mine/first-maze").size == (4, 3)
    assert brl.load(Path("mine/first-maze")).size == (4, 3)


def test_of_many_files_with_a_name_a_few_are_told() -> None:
    for folder in "abcde":
        write(f"{folder}/first.yaml")
    with pytest.raises(brl.LevelNotFoundError) as error:
        brl.load("first")
    assert "'a/first.yaml', 'b/first.yaml' or 'c/first.yaml'?" in str(error.value)


def test_a_files_stem_becomes_a_name() -> None:
    assert brl.load(write("My First_Maze.yaml")).name == "my-first-maze"
    assert brl.load(write("迷路.yaml")).name is None


def test_a_mapping_and_a_level() -> None:
    level = brl.load({"version": 1, "size": (4, 3), "name": "mine"})
    assert (level.size, level.name) == ((4, 3), "mine")
    assert brl.load(level) is level


def test_a_text_is_for_loads() -> None:
    with pytest.raises(brl.LevelError, match="`loads` reads it"):
        brl.load(LEVEL)
    assert brl.loads(LEVEL).size == (4, 3)


@pytest.mark.parametrize("nothing", [5, None, ["final-maze"], b"final-maze"])
def test_what_cannot_be_a_level_is_a_type_error(nothing: Any) -> None:
    with pytest.raises(TypeError):
        brl.load(nothing)


# -- what is not there -----------------------------------------------------------------------


@pytest.mark.parametrize(
    ("asked", "nearest"),
    [
        ("final-maz", "final-maze"),
        ("Final-Maze", "final-maze"),
        ("frozenlake", "frozen-lake"),
        ("elsewhere/final-maze", "final-maze"),
    ],
)
def test_an_unknown_name_tells_the_nearest_ones(asked: str, nearest: str) -> None:
    with pytest.raises(brl.LevelNotFoundError) as caught:
        brl.load(asked)
    assert caught.value.name == asked
    assert caught.value.nearest[0] == nearest
    assert f"did you mean '{nearest}'" in str(caught.value)
    assert "babyrobot list" in str(caught.value)


@pytest.mark.parametrize("asked", ["", "qqqqqq", "a\0b", "x" * 5000, "\ud800"])
def test_an_unknown_name_that_is_near_nothing(asked: str) -> None:
    with pytest.raises(brl.LevelNotFoundError) as caught:
        brl.load(asked)
    assert caught.value.nearest == ()
    assert "did you mean" not in str(caught.value)


def test_a_missing_path_tells_its_nearest_neighbours(here: Path) -> None:
    write("first-maze.yaml")
    write("qqqqqq.yaml")
    write("first-maze.txt")
    for asked in ("frist-maze.yaml", "./frist-maze.yaml", here / "frist-maze.yaml"):
        with pytest.raises(brl.LevelNotFoundError) as caught:
            brl.load(asked)
        assert [Path(path).name for path in caught.value.nearest] == ["first-maze.yaml"], asked


def test_the_neighbours_of_a_missing_path_are_found_in_deep_folders(here: Path) -> None:
    deep = here / ("d" * 40) / ("e" * 40)
    write(deep / "first-maze.yaml")
    with pytest.raises(brl.LevelNotFoundError, match=r"first-maze\.yaml"):
        brl.load(deep / "frist-maze.yaml")


def test_neighbours_are_not_near_for_their_folder_alone() -> None:
    write("a-folder-with-a-long-name/qqqqqq.yaml")
    with pytest.raises(brl.LevelNotFoundError) as caught:
        brl.load("a-folder-with-a-long-name/cave.yaml")
    assert caught.value.nearest == ()


@pytest.mark.parametrize(
    "asked",
    [
        "nowhere/first-maze.yaml",
        "a\0b.yaml",
        f"{'x' * 300}.yaml",
        "~nobody-of-this-name/first-maze.yaml",
    ],
)
def test_paths_that_cannot_be_are_not_found(asked: str) -> None:
    with pytest.raises(brl.LevelNotFoundError):
        brl.load(asked)


def test_a_folder_is_no_level(here: Path) -> None:
    with pytest.raises(brl.LevelError, match="this is a directory"):
        brl.load(here)


def test_a_broken_file_tells_all_its_faults() -> None:
    path = write("mine.yaml", "version: 1\nsize: [0, 3]\nexits: [1, 1]\n")
    with pytest.raises(brl.LevelError) as caught:
        brl.load(path)
    assert [found.code for found in caught.value.diagnostics] == ["BR205", "BR201"]
    assert f"{path}:2:" in str(caught.value)
    assert f"{path}:3:1: error BR201" in str(caught.value)


# -- the places ------------------------------------------------------------------------------


def test_all_places_are_searched_in_their_order(
    tmp_path: Path, site: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    one, two = tmp_path / "one", tmp_path / "two"
    monkeypatch.setenv("BABYROBOT_LEVELS", os.pathsep.join([str(one), str(two), "", "nowhere"]))
    carry(site, "brl_test_pack", "carried = brl_test_pack")
    files = [
        write("levels/shared.yaml", titled("current")),
        write(one / "shared.yaml", titled("one")),
        write(two / "shared.yaml", titled("two")),
        write(user_folder() / "levels" / "shared.yaml", titled("user")),
    ]
    write(user_folder() / "packs" / "zoo" / "shared.yaml", titled("zoo"))
    write(user_folder() / "packs" / "ark" / "shared.yaml", titled("ark"))
    write(site / "brl_test_pack" / "shared.yaml", titled("carried"))
    assert user_folder() == tmp_path / "data" / "babyrobot-levels"
    assert [place.pack for place in places()] == [None] * 5 + ["ark", "zoo", "carried"]
    for path in files:
        assert brl.load("shared").title == path.read_text("utf-8").split("title: ")[1].strip()
        path.unlink()
    # Levels of packs are told with their pack.
    with pytest.raises(brl.LevelNotFoundError) as caught:
        brl.load("shared")
    assert set(caught.value.nearest) <= {"ark/shared", "zoo/shared", "carried/shared"}
    for pack in ("ark", "zoo", "carried"):
        assert brl.load(f"{pack}/shared").title == pack
    assert "brl_test_pack" not in sys.modules


def test_a_level_of_the_project_comes_before_one_of_the_gallery() -> None:
    write(user_folder() / "levels" / "final-maze.yaml")
    assert brl.load("final-maze").size == (8, 5)
    write("levels/final-maze.yaml")
    assert brl.load("final-maze").size == (4, 3)
    infos = {info.name: info for info in brl.levels()}
    assert (infos["final-maze"].size, infos["final-maze"].origin) == ((4, 3), "levels/")
    assert brl.load("gallery/final-maze").size == (8, 5)
    with gymnasium.make("babyrobot/final-maze-v0") as env:
        assert env.get_wrapper_attr("level").size == (8, 5)
    with pytest.raises(brl.LevelNotFoundError):
        brl.load("gallery/mine")


def test_a_file_of_that_name_is_listed_rather_than_one_that_says_so() -> None:
    write("levels/other.yaml", "version: 1\nname: final-maze\nsize: [2, 2]\n")
    (info,) = (info for info in brl.levels() if info.name == "final-maze")
    assert info.size == brl.load("final-maze").size == (8, 5)


def test_a_place_that_is_told_twice_counts_once(
    here: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write("levels/mine.yaml")
    twice = os.pathsep.join([str(here / "levels"), str(here / "levels" / ".." / "levels")])
    monkeypatch.setenv("BABYROBOT_LEVELS", twice)
    assert [file.name for file in level_files()].count("mine") == 1


# -- which files are levels ------------------------------------------------------------------


def test_levels_lie_in_folders_too_but_not_all_files_are_levels() -> None:
    write("levels/a.yaml")
    write("levels/b.yml")
    write("levels/easy/c.yaml")
    write("levels/easy/very/d.yaml")
    write("levels/themes/sea.yaml", "colors: {base: red}\n")
    write("levels/easy/themes/sky.yaml", "colors: {base: red}\n")
    write("levels/.hidden.yaml")
    write("levels/.git/e.yaml")
    write("levels/pack.yaml", "name: mine\n")
    write("levels/notes.txt")
    write("levels/picture.yaml.png")
    Path("levels/folder.yaml").mkdir()
    found = [path.relative_to("levels").as_posix() for path in yaml_files(Path("levels"))]
    assert found == ["a.yaml", "b.yml", "easy/c.yaml", "easy/very/d.yaml"]
    assert catalogue()[1] == []
    assert brl.load("d").size == (4, 3)


def test_folders_that_hold_themselves_do_not_hang(here: Path) -> None:
    write("levels/mine.yaml")
    Path("levels/again").symlink_to(here / "levels", target_is_directory=True)
    Path("levels/up").symlink_to(here, target_is_directory=True)
    Path("levels/loop.yaml").symlink_to("loop.yaml")
    Path("levels/gone.yaml").symlink_to("nowhere.yaml")
    found, broken = catalogue()
    assert [info.name for info in found if info.name not in GALLERY] == ["mine"]
    assert [path.name for path in broken] == ["gone.yaml", "loop.yaml"]


def test_places_that_are_no_folders_are_told(here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write("file.yaml")
    monkeypatch.setenv("BABYROBOT_LEVELS", os.pathsep.join(["file.yaml", "nowhere", str(here)]))
    told = run_here(["list", "--tag", "no-such"], dict(os.environ)).err.splitlines()
    assert told[1:] == [
        f"BABYROBOT_LEVELS contains {name}, which is not a readable folder"
        for name in ("file.yaml", "nowhere")
    ]


def test_a_place_that_is_a_loop_is_none(monkeypatch: pytest.MonkeyPatch) -> None:
    Path("levels").symlink_to("levels")
    monkeypatch.setenv("BABYROBOT_LEVELS", "levels")
    assert brl.load("default").name == "default"


@pytest.mark.slow
@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no named pipes")
def test_a_pipe_among_the_levels_does_not_hang(here: Path) -> None:
    Path("levels").mkdir()
    os.mkfifo("levels/pipe.yaml")
    code = """
import babyrobot_levels as brl
from babyrobot_levels.library.catalogue import catalogue
print([path.name for path in catalogue()[1]])
try:
    brl.load("nobody-is-called-so")
except brl.LevelNotFoundError:
    print("not found")
"""
    assert run(code, here, timeout=15) == "['pipe.yaml']\nnot found\n"


def test_a_name_of_its_own_is_found() -> None:
    write("levels/0001.yaml", "version: 1\nname: dark-cellar\nsize: [2, 2]\n")
    write("levels/0002.yaml", '# a cellar\nversion: 1\nname: "light-cellar"  # light\n')
    write(user_folder() / "packs" / "zoo" / "0001.yaml", "version: 1\nname: lion\n")
    assert brl.load("dark-cellar").size == (2, 2)
    assert brl.load("light-cellar").name == "light-cellar"
    assert brl.load("0001").name == "dark-cellar"
    assert brl.load("zoo/lion").name == "lion"
    with pytest.raises(brl.LevelNotFoundError):
        brl.load("lion")
    with pytest.raises(brl.LevelNotFoundError):
        brl.load("dark")


# -- the catalogue ---------------------------------------------------------------------------


@pytest.mark.slow
def test_the_catalogue_tells_of_each_level() -> None:
    path = write(
        "levels/mine.yaml", f"{LEVEL}title: Mine\ntags: [easy, small]\nsource: a book\nauthor: me\n"
    )
    found = {info.name: info for info in brl.levels()}
    assert list(found) == sorted(found)
    assert found.keys() == {*GALLERY, "mine"}
    mine = found["mine"]
    assert isinstance(mine, brl.LevelInfo)
    assert mine.to_dict() == {
        "name": "mine",
        "title": "Mine",
        "size": [4, 3],
        "tags": ["easy", "small"],
        "source": "a book",
        "path": str(path),
        "from": "levels/",
    }
    assert found["final-maze"].size == (8, 5)
    for info in found.values():
        assert brl.load(info.name).size == info.size
        assert brl.load(info.path).size == info.size


@pytest.mark.slow
def test_broken_files_do_not_stop_the_catalogue() -> None:
    write("levels/a.yaml")
    for name, text in [("b", "version: 2\n"), ("c", "[" * 100_000), ("d", ""), ("e", "- x\n")]:
        write(f"levels/{name}.yaml", text)
    Path("levels/f.yaml").write_bytes(b"\xff\xfe")
    Path("levels/g.yaml").write_bytes(b"#" * (2 << 20))
    write("levels/h.yaml")
    assert {info.name for info in brl.levels()} == {*GALLERY, "a", "h"}
    assert [path.stem for path in catalogue()[1]] == list("bcdefg")


# -- themes beside the level -----------------------------------------------------------------


def test_a_theme_beside_the_level_is_used() -> None:
    write("worlds/themes/sea.yaml", "colors: {base: '#123456'}\nwidths: {walls: 7}\n")
    level = brl.load(write("worlds/mine.yaml", f"{LEVEL}theme: sea\n"))
    assert level.theme == "sea"
    assert level.resolved_theme.colors.base == "#123456"
    assert level.resolved_theme.widths.walls == 7
    assert brl.validate("worlds/mine.yaml") == []
    # It goes with the level, wherever that goes.
    assert level.replace(size=(5, 5)).resolved_theme == level.resolved_theme
    whole = brl.load(level.to_dict(whole=True))
    assert whole.resolved_theme.colors.base == "#123456"


def test_a_builtin_theme_wins_over_a_file() -> None:
    write("themes/green.yaml", "colors: {base: '#123456'}\n")
    level = brl.load(write("mine.yaml", f"{LEVEL}theme: green\n"))
    assert level.resolved_theme.colors.base != "#123456"


def test_an_unknown_theme_is_told_with_those_that_are_known() -> None:
    write("themes/ocean.yaml", "colors: {base: '#123456'}\n")
    path = write("mine.yaml", f"{LEVEL}theme: ocaen\n")
    (found,) = brl.validate(path)
    assert (found.code, found.line, found.file) == ("BR401", 3, str(path))
    assert "did you mean `ocean`" in found.message
    assert found.help is not None
    assert "blue_green" in found.help
    with pytest.raises(brl.LevelError, match="BR401"):
        brl.load(path)
    (found,) = brl.validate(f"{LEVEL}theme: gren\n")
    assert (found.code, found.line) == ("BR401", 3)
    assert "did you mean `green`" in found.message


def test_a_broken_theme_is_told_where_it_is_broken() -> None:
    theme = write("themes/sea.yaml", "colors:\n  base: blau\n  lines: '#12'\n")
    path = write("mine.yaml", f"{LEVEL}theme: sea\n")
    found = brl.validate(path)
    assert [(d.code, Path(d.file), d.line) for d in found] == [
        ("BR403", theme, 2),
        ("BR403", theme, 3),
    ]
    with pytest.raises(brl.LevelError, match=r"sea\.yaml:2:9: error BR403"):
        brl.load(path)
    theme.write_bytes(b"colors: \xff")
    assert [d.code for d in brl.validate(path)] == ["BR102"]


# -- checking --------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("told", "message"),
    [
        ("nowhere.yaml", "no such file"),
        (Path("nowhere/mine.yaml"), "no such file"),
        ("a\0b.yaml", "cannot be read"),
        ("x" * 300 + ".yaml", "cannot be read"),
    ],
)
def test_check_tells_what_cannot_be_read(told: Any, message: str) -> None:
    (found,) = brl.validate(told)
    assert found.code == "BR101"
    assert message in found.message


def test_validate_takes_whatever_names_levels(here: Path) -> None:
    with pytest.raises(ValueError, match="no level files"):
        brl.validate(here)
    with pytest.raises(brl.LevelNotFoundError, match="did you mean 'frozen-lake'"):
        brl.validate("frozen-lak")
    good = write("some/good.yaml")
    bad = write("some/bad.yaml", "version: 1\nsiz: [3, 3]\n")
    code = brl.load(good).share_code()
    all_well: list[Any] = ["final-maze", "small-mazes", code, brl.load(good), []]
    for each in all_well:
        assert brl.validate(each) == [], each
        assert repr(brl.validate(each)) == "no findings"
    faulty: list[Any] = ["some", here / "some", [good, bad], (bad,), {"version": 1, "siz": [3, 3]}]
    for named in faulty:
        assert [found.code for found in brl.validate(named)] == ["BR201"]
    found = brl.validate(["some", "version: 1\nsize: 3"])
    assert [one.file for one in found] == ["some/bad.yaml", "<text>"]
    assert repr(found) == "\n\n".join(map(str, found))
    with pytest.raises(TypeError, match="not int"):
        brl.validate(3)  # type: ignore[arg-type]


# -- the public names ------------------------------------------------------------------------


def test_the_public_names() -> None:
    assert sorted(brl.__all__) == dir(brl)
    assert len(set(brl.__all__)) == len(brl.__all__)


@for_each("name", brl.__all__)
def test_each_public_name_can_be_had(name: str) -> None:
    value = getattr(brl, name)
    assert getattr(brl, name) is value
    if name != "__version__":
        assert value.__name__ == name
        assert value.__doc__
        assert getattr(importlib.import_module(value.__module__), name) is value


def test_an_unknown_name_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="no attribute 'laod'; did you mean `load`"):
        brl.laod  # type: ignore[attr-defined]  # noqa: B018
    with pytest.raises(ImportError, match="laod"):
        exec("from babyrobot_levels import laod")
    assert not hasattr(brl, "__path_of_nothing__")
