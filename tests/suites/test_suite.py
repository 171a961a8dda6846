"""Suites: levels that are made when they are asked for, the same ones whoever asks."""

from __future__ import annotations

import pickle
from pathlib import Path
from typing import Any

import pytest
from support.combinations import swept
from support.sessions import environment, run_here

import babyrobot_levels as brl
from babyrobot_levels.generation import search
from babyrobot_levels.library.catalogue import catalogue, suite_files
from babyrobot_levels.library.search_path import gallery_folder
from babyrobot_levels.suites.suite import Suite, load_suite, named_levels
from babyrobot_levels.text.emitter import emit

WITH_DOORS = ("bench-hard", "bench-keys", "locked-mazes", "text-easy", "text-hard")
SHIPPED = ("bench-easy", "classics", "long-ways", "small-mazes", "wet-mazes", *WITH_DOORS)

FIELDS: dict[str, Any] = {
    "version": 1,
    "kind": "suite",
    "name": "mixed",
    "seed": 7,
    "count": 120,
    "size": {"min": [4, 4], "max": [7, 6]},
    "maze": {"algorithm": ["wilson", "depth-first"], "loops": {"max": 0.4}},
    "puddles": {"max": 3},
    "exit": "random",
    "rewards": {"exit": 10},
    "discount": 0.9,
    "max_steps": 99,
    "theme": "green",
    "splits": {"train": 0.75, "test": 0.25},
}


@pytest.fixture(scope="module")
def mixed() -> Suite:
    return load_suite(FIELDS)


# -- as a sequence ---------------------------------------------------------------------------


def test_it_is_a_sequence_of_levels(mixed: Suite) -> None:
    assert len(mixed) == 120
    assert [level.name for level in mixed[3:6]] == ["mixed-00003", "mixed-00004", "mixed-00005"]
    assert mixed[-1].digest == mixed[119].digest
    assert [level.name for level in mixed[::-50]] == ["mixed-00119", "mixed-00069", "mixed-00019"]
    assert len(mixed[10:][5:20]) == 15
    assert mixed[10:][5].name == "mixed-00015"
    with pytest.raises(IndexError, match="there is no level 120: the suite has 120"):
        mixed[120]


@pytest.mark.slow
def test_a_level_does_not_depend_on_what_was_asked_before(mixed: Suite) -> None:
    fresh = load_suite(FIELDS)
    assert (
        fresh[77].to_yaml()
        == [*mixed][77].to_yaml()
        == pickle.loads(pickle.dumps(mixed))[77].to_yaml()
    )


def test_suites_are_equal_that_have_the_same_levels(mixed: Suite) -> None:
    fresh, part = load_suite(FIELDS), mixed.split("test")[4:9]
    assert mixed == fresh == mixed[:]
    assert mixed != mixed[:60]
    assert part == fresh[94:99] != fresh[95:100]
    assert part != load_suite({**FIELDS, "seed": 8})[94:99]
    assert mixed != list(mixed[:2])
    again = pickle.loads(pickle.dumps(part))
    assert again == part
    assert repr(again) == repr(part) == "<Suite 'mixed': 5 levels, split 'test'>"


def test_parts_have_the_theme_that_stands_beside_the_suite(tmp_path: Path) -> None:
    (tmp_path / "themes").mkdir()
    (tmp_path / "themes" / "sea.yaml").write_text("colors: {base: '#cceeff'}\n", "utf-8")
    (tmp_path / "seas.yaml").write_text(emit({**FIELDS, "theme": "sea"}), "utf-8")
    suite = load_suite(tmp_path / "seas.yaml")
    picture = suite[91].to_svg()
    assert "#cceeff" in picture
    for part in (suite[91:], suite.split("test")[1:], pickle.loads(pickle.dumps(suite))[91:]):
        assert part[0].to_svg() == picture
    assert suite.to_dict()["theme"] == "sea"
    assert load_suite(suite.to_dict(whole=True))[91].to_svg() == picture


@pytest.mark.slow
def test_levels_have_what_the_suite_states(mixed: Suite) -> None:
    seen: dict[str, set[Any]] = {"size": set(), "algorithm": set(), "puddles": set()}
    for level in mixed:
        assert 4 <= level.size[0] <= 7
        assert 4 <= level.size[1] <= 6
        assert level.maze is not None
        assert (level.rewards.exit, level.discount, level.max_steps) == (10, 0.9, 99)
        assert level.theme == "green"
        seen["size"].add(level.size)
        seen["algorithm"].add(level.maze.algorithm)
        seen["puddles"].add(len(level.puddles))
        assert brl.metrics(level).reachable == 1
    assert len(seen["size"]) == 12
    assert seen["algorithm"] == {"wilson", "depth-first"}
    assert seen["puddles"] == {0, 1, 2, 3}


# -- splits ----------------------------------------------------------------------------------


@pytest.mark.slow
def test_splits_share_no_maze() -> None:
    # There are 192 mazes of this size, most of which come several times.
    suite = load_suite(
        {**FIELDS, "size": [3, 3], "maze": {"algorithm": "wilson"}, "count": 400, "puddles": 2}
    )
    train, test = suite.split("train"), suite.split("test")
    assert (len(train), len(test)) == (300, 100)
    assert train[0].name == "mixed-00000"
    assert test[0].name == "mixed-00300"
    mazes = [{level.grid().open_bits for level in part} for part in (train, test)]
    assert len(mazes[0]) < 192
    assert mazes[0].isdisjoint(mazes[1])


@pytest.mark.slow
def test_the_same_shares_keep_all_suites_apart(mixed: Suite) -> None:
    other = load_suite({**FIELDS, "seed": 8, "size": [3, 3], "count": 200})
    third = load_suite({**FIELDS, "seed": 9, "size": [3, 3], "count": 200})
    train = {level.grid().open_bits for level in other.split("train")}
    assert train.isdisjoint(level.grid().open_bits for level in third.split("test"))
    assert not train.isdisjoint(level.grid().open_bits for level in third.split("train"))


def test_splits_have_names(mixed: Suite) -> None:
    assert mixed.splits == ("train", "test")
    with pytest.raises(ValueError, match=r"there is no split 'tset'.*did you mean `test`"):
        mixed.split("tset")
    with pytest.raises(ValueError, match="a slice of a suite has no splits"):
        mixed[:10].split("train")
    assert repr(mixed.split("test")) == "<Suite 'mixed': 30 levels, split 'test'>"


@pytest.mark.parametrize("count", [10, 11, 13, 1000, 10**9])
def test_every_level_is_in_one_split(count: int) -> None:
    suite = load_suite({**FIELDS, "count": count, "splits": {"a": 0.1, "b": 0.2, "c": 0.7}})
    parts: list[Any] = [suite.split(name).numbers for name in "abc"]
    assert [part.start for part in parts] == [0, parts[0].stop, parts[1].stop]
    assert parts[2].stop == count
    assert len(parts[0]) == pytest.approx(0.1 * count, abs=0.51)


# -- conditions ------------------------------------------------------------------------------


@pytest.mark.sweep
def test_conditions_hold_and_starve_aloud() -> None:
    fields = {**FIELDS, "size": [6, 6], "splits": {}, "exit": "corner"}
    del fields["max_steps"]
    suite = load_suite({**fields, "path_length": {"min": 12, "max": 14}, "dead_ends": 8})
    for level in suite[:10]:
        metrics = brl.metrics(level)
        assert metrics.path_length in (12, 13, 14)
        assert metrics.dead_ends == 8
    hungry = load_suite({**fields, "maze": {}, "path_length": {"min": 35}})
    with pytest.raises(
        brl.UnsatisfiableError, match=r"path_length 35\.\.: the largest of .* was \d\d"
    ):
        hungry[0]


def test_no_shortest_walk_is_cut_off() -> None:
    suite = load_suite({**FIELDS, "size": [6, 6], "max_steps": 11, "exit": "corner"})
    lengths = {brl.metrics(level).path_length for level in suite[:20]}
    assert lengths <= {10, 11}


EXPECTING = {
    "version": 1,
    "kind": "suite",
    "count": 6,
    "size": [6, 6],
    "maze": {"algorithm": "wilson", "loops": 0.4},
    "keys": {"max": 1},
    "coins": 1,
    "guards": {"max": 1},
}


@pytest.mark.slow
def test_all_levels_are_as_a_suite_expects() -> None:
    expect = {"states": "60..", "best_return": {"max": -6}, "turns": "4..9", "decisions": "2.."}
    suite = load_suite({**EXPECTING, "expect": expect})
    assert load_suite(suite.to_dict())[5].to_yaml() == suite[5].to_yaml()
    for level in suite:
        assert level.expect is None
        measured = brl.metrics(level).to_dict()
        assert measured["states"] >= 60
        assert measured["best_return"] <= -6
        assert 4 <= measured["turns"] <= 9
        assert measured["decisions"] >= 2
        assert measured["success"] == 1
        assert not brl.broken_expectations(level.replace(expect=expect))
    free = load_suite(EXPECTING)
    assert [level.digest for level in free] != [level.digest for level in suite]


@pytest.mark.sweep
def test_success_is_expected_unless_a_suite_asks_for_less() -> None:
    risky = {**EXPECTING, "keys": 0, "guards": 1, "hit": {"reward": -1}, "count": 12}
    won = {brl.metrics(level).success for level in load_suite(risky)}
    assert won == {1}
    lost = load_suite({**risky, "expect": {"success": "..0.5"}})
    assert {brl.metrics(level).success for level in lost} == {0}
    either = [
        brl.metrics(level).success for level in load_suite({**risky, "expect": {"success": "0.."}})
    ]
    assert {*either} == {0, 1}


@pytest.mark.slow
def test_needs_are_names() -> None:
    suite = load_suite({**EXPECTING, "keys": {"min": 1, "max": 2}, "expect": {"needs": ["key"]}})
    assert {brl.metrics(level).needs for level in suite} == {("key",)}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("expect", "message"),
    [
        pytest.param(
            {"best_steps": "90.."},
            r"expect best_steps 90\.\.: the largest of 40 candidates was \d",
            marks=pytest.mark.sweep,
        ),
        ({"needs": ["lever"]}, r"expect needs \[lever\]: none of 40 candidates has these"),
        pytest.param(
            {"success": 0.5},
            r"expect success 0.5: the smallest of \d+ candidates was 1",
            marks=pytest.mark.sweep,
        ),
        pytest.param(
            {"turns": {"max": 0}},
            r"expect turns \.\.0: the smallest of \d+ candidates was \d",
            marks=pytest.mark.sweep,
        ),
    ],
)
def test_what_cannot_be_expected_starves_aloud(
    expect: dict[str, Any], message: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(search, "MOST_SOLVED", 40)
    monkeypatch.setattr(search, "MOST_TRIES", 400)
    with pytest.raises(brl.UnsatisfiableError, match=message):
        load_suite({**EXPECTING, "expect": expect})[0]


@pytest.mark.slow
def test_large_tables_are_not_compiled_again_and_again(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(search, "MOST_STATES", 1000)
    fields = {**EXPECTING, "guards": 1, "expect": {"path_length": "90.."}}
    with pytest.raises(brl.UnsatisfiableError, match=r"of (1?\d\d) candidates"):
        load_suite(fields)[0]


# -- files -----------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("name", swept(["classics", "long-ways", "small-mazes"], SHIPPED))
def test_the_shipped_suites(name: str) -> None:
    suite = load_suite(name)
    assert suite.name == name
    # Each candidate with doors is solved several times.
    count = 15 if name in WITH_DOORS else 100
    for part in [suite.split(split) for split in suite.splits] or [suite]:
        assert len({level.digest for level in part[:count]}) == min(count, len(part))


def test_the_catalogue_knows_suites_from_levels(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert set(SHIPPED) <= set(suite_files())
    infos, broken = catalogue()
    assert not {info.name for info in infos} & set(SHIPPED)
    assert broken == []


def test_a_suite_is_no_level_and_says_so() -> None:
    with pytest.raises(brl.LevelError, match="this is a suite of levels, not a level"):
        brl.load("small-mazes")
    with pytest.raises(brl.SuiteNotFoundError, match="no suite called 'small-maze'; did you mean"):
        load_suite("small-maze")
    with pytest.raises(brl.SuiteNotFoundError, match=r"it is a level: `brl\.load"):
        brl.load_suite("first-key")
    with pytest.raises(brl.LevelNotFoundError, match=r"`brl.levels\(\)` returns all levels"):
        brl.load("levels")
    with pytest.raises(brl.SuiteNotFoundError, match="there is no file"):
        load_suite(Path("nowhere.yaml"))
    with pytest.raises(TypeError, match="not int"):
        load_suite(3)  # type: ignore[arg-type]


FAULTS = """\
version: 1
kind: suite
count: 0
size: {min: [5, 5], max: [4, 8]}
splits: {train: 0.8, test: 0.3}
path_lenght: 3
theme: pink
"""


def test_faults_are_told_where_they_stand(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    path = Path("faulty.yaml")
    told = []
    # Fields first, then what is between them, then what is beside the file.
    for text in (FAULTS, FAULTS.replace(": 0\n", ": 9\n").replace("path_lenght: 3\n", "")):
        path.write_text(text, "utf-8")
        told += [(each.line, each.column, each.code) for each in brl.validate(path)]
    path.write_text("version: 1\nkind: suite\ncount: 9\ntheme: pink\n", "utf-8")
    told += [(each.line, each.column, each.code) for each in brl.validate(path)]
    assert told == [
        (3, 8, "BR205"),
        (6, 1, "BR201"),
        (4, 13, "BR205"),
        (5, 9, "BR205"),
        (4, 8, "BR401"),
    ]
    for command in ("validate", "lint", "format"):
        done = run_here([command, str(path)], environment(tmp_path))
        assert done.status == 1
        assert "faulty.yaml:4:8: error BR401: unknown theme `pink`" in done.out


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"kind": "suit"}, "`kind` must be `suite`"),
        ({"count": 2.5}, "`count` must be an integer"),
        ({"size": 5}, r"`size` must be `\[width, height\]`, or a mapping"),
        ({"size": [2, 1]}, "a level of 2 cells is too small"),
        ({"puddles": [1, 2]}, "`puddles` must be an integer, or a range"),
        ({"puddles": {"min": 2}}, "missing field `max`"),
        ({"puddles": 23}, "only 14 cells"),
        ({"maze": {"algorithm": []}}, "must not be an empty list"),
        ({"maze": {"loops": {"min": 0.5, "max": 0.2}}}, "`min` .0.5. is above"),
        ({"start": "middle"}, "`start` must be one of `corner`, `random`, `farthest`"),
        ({"start": "farthest", "size": [300, 3], "puddles": 0}, "drawn as a map"),
        ({"splits": {"a": 0.5, "b": 0.4}}, "the shares add up to 0.9"),
        ({"splits": {"a": 0.999, "b": 0.001}}, "`b` gets none of the 120 levels"),
        ({"path_length": {"min": 60}}, "a shortest path in 42 cells has at most 41 steps"),
        ({"path_length": 1}, "at least two steps"),
        ({"expect": {"states": "9..5"}}, "the range is upside down: 9 is above 5"),
        ({"expect": {"lint": "clean"}}, "unknown field `lint`"),
        ({"expect": {"needs": ["key"]}}, "only levels with things have `needs`"),
        ({"dead_ends": 60}, "a level of 42 cells cannot have so many dead ends"),
    ],
)
def test_what_cannot_be_is_an_error(fields: dict[str, Any], message: str) -> None:
    with pytest.raises(brl.LevelError, match=message):
        load_suite({**FIELDS, **fields})


# -- what levels are named by --------------------------------------------------------------

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
