"""Suites that list levels: files, folders, packs, other suites; weights, and splits by digest."""

from __future__ import annotations

import os
import pickle
from pathlib import Path
from typing import Any

import pytest
from support.sessions import environment, run_here

import babyrobot_levels as brl
from babyrobot_levels.suites.suite import Suite, load_suite
from babyrobot_levels.text.emitter import emit

SMALL = "version: 1\nsize: [{}, 2]\nmax_steps: {}\n"


def listed(*levels: Any, **fields: Any) -> dict[str, Any]:
    return {"version": 1, "kind": "suite", "levels": [*levels], **fields}


def inline(width: int, max_steps: int = 9) -> dict[str, Any]:
    return {"level": {"version": 1, "size": [width, 2], "max_steps": max_steps}}


@pytest.fixture
def course(tmp_path: Path) -> Path:
    """Return the file of a suite that lists everything that a suite can list."""
    for name, width in (("b", 4), ("a", 3), ("deep/c", 5)):
        path = tmp_path / "mazes" / f"{name}.yaml"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(SMALL.format(width, 10 * width), "utf-8")
    (tmp_path / "mazes" / "grows.yaml").write_text(
        "version: 1\nsize: [3, 3]\nmaze: {seed: random}\n", "utf-8"
    )
    (tmp_path / "mazes" / "more.yaml").write_text(emit(listed("maze")), "utf-8")
    (tmp_path / "lava.yaml").write_text(SMALL.format(2, 7), "utf-8")
    (tmp_path / "inner.yaml").write_text(emit(listed("lava.yaml", "maze")), "utf-8")
    entries: list[Any] = [
        "final-maze",
        {"level": "lava.yaml", "weight": 3},
        {"folder": "mazes"},
        {"suite": "small-mazes", "split": "test", "count": 10, "weight": 2},
        {"suite": "inner.yaml", "weight": 1},
    ]
    path = tmp_path / "course.yaml"
    path.write_text(emit(listed(*entries, max_steps=50)), "utf-8")
    return path


# -- as a sequence ---------------------------------------------------------------------------


def test_levels_come_in_the_order_of_the_entries(course: Path) -> None:
    suite = load_suite(course)
    names = [level.name for level in suite]
    assert names[:5] == ["final-maze", "lava", "a", "b", "c"]
    assert names[5:15] == [level.name for level in load_suite("small-mazes").split("test")[:10]]
    assert names[15:] == ["lava", "maze"]
    assert (len(suite), suite.name, suite.splits) == (17, "course", ())
    assert suite[-1].digest == brl.load("maze").digest
    assert [level.name for level in suite[::-8]] == ["maze", names[8], "final-maze"]
    assert suite.largest == (8, 8)
    with pytest.raises(IndexError, match="there is no level 17"):
        suite[17]


def test_weights_are_those_of_entries_shared_by_their_levels(course: Path) -> None:
    suite = load_suite(course)
    assert suite.groups == ((1, 1.0), (1, 3.0), (3, 1.0), (10, 0.2), (2, 0.5))
    assert suite[1:6].groups == ((1, 3.0), (3, 1.0), (1, 0.2))
    assert suite[::-2].groups == ((1, 0.5), (5, 0.2), (2, 1.0), (1, 1.0))
    nested = load_suite(listed({"suite": suite.to_dict(whole=True)}, {**inline(3), "weight": 2}))
    total = sum(count * weight for count, weight in nested.groups)
    assert total == pytest.approx(17 + 2)


def test_all_levels_have_the_limit_of_the_suite(course: Path) -> None:
    assert {level.max_steps for level in load_suite(course)} == {50}
    own = load_suite(listed(inline(2, 5), inline(3, 25)))
    assert (own.max_steps, {level.max_steps for level in own}) == (25, {25})
    without = load_suite(listed(inline(2, 5), {"level": {"version": 1, "size": [3, 2]}}))
    assert (without.max_steps, without[0].max_steps) == (None, None)


@pytest.mark.slow
def test_it_is_what_its_data_say(course: Path) -> None:
    suite = load_suite(course)
    for same in (
        pickle.loads(pickle.dumps(suite)),
        load_suite(course),
        load_suite(suite.to_dict(whole=True)),
        suite[:],
    ):
        assert same == suite
        assert [level.digest for level in same] == [level.digest for level in suite]
        assert [level.name for level in same] == [level.name for level in suite]
    part = suite[3:9]
    assert pickle.loads(pickle.dumps(part)) == part != suite[3:10]
    assert suite != load_suite(listed(*suite.to_dict(whole=True)["levels"], max_steps=51))
    assert load_suite(emit_to(course.with_name("again.yaml"), suite.to_yaml())) == suite


def emit_to(path: Path, text: str) -> Path:
    path.write_text(text, "utf-8")
    return path


def test_most_things_of_all_levels() -> None:
    suite = load_suite(listed("three-gems", "night-watch", {"suite": "locked-mazes", "count": 2}))
    levels = [brl.load("three-gems"), brl.load("night-watch")]
    assert suite.most_items == max(len(levels[0].items), 5)
    assert suite.has_guards
    assert suite.bounds.configurations >= max(
        level.compile().num_configurations for level in levels
    )
    assert not load_suite(listed("maze", "three-gems")).has_guards
    assert load_suite(listed("maze", "final-maze")).bounds.radices == ()


# -- splits ----------------------------------------------------------------------------------


@pytest.mark.slow
def test_digests_decide_on_splits() -> None:
    shares = {"train": 0.6, "test": 0.4}
    names = ["maze", "final-maze", "frozen-lake", "cliff-walking", "garden", "three-gems"]
    few = load_suite(listed(*names, splits=shares))
    more = load_suite(
        listed({"suite": "small-mazes", "count": 40}, *reversed(names), "maze", splits=shares)
    )
    found = {}
    for suite in (few, more):
        parts = [{level.digest for level in suite.split(name)} for name in shares]
        assert parts[0].isdisjoint(parts[1])
        assert sum(len(suite.split(name)) for name in shares) == len(suite)
        found[len(suite)] = parts
    assert found[6][0] <= found[47][0]
    assert found[6][1] <= found[47][1]
    assert 15 < len(more.split("train")) < 40
    assert repr(few.split("test")).endswith("split 'test'>")


def test_equal_levels_are_in_the_same_split() -> None:
    suite = load_suite(listed("maze", "garden", "maze", splits={"a": 0.5, "b": 0.5}))
    counts = [sum(level.name == "maze" for level in suite.split(name))
              for name in ("a", "b") if _has(suite, name)]  # fmt: skip
    assert sorted(counts) in ([0, 2], [2])


def _has(suite: Suite, split: str) -> bool:
    try:
        return bool(suite.split(split))
    except ValueError:
        return False


def test_an_empty_split_is_an_error() -> None:
    suite = load_suite(listed("maze", splits={"a": 0.5, "b": 0.5}))
    assert _has(suite, "a") != _has(suite, "b")
    empty = "a" if _has(suite, "b") else "b"
    with pytest.raises(ValueError, match=f"the split '{empty}' is empty: none of the 1 levels"):
        suite.split(empty)
    with pytest.raises(ValueError, match="there is no split 'c'"):
        suite.split("c")


def test_parts_with_splits_are_arguments_of_environments() -> None:
    suite = load_suite(listed("maze", "final-maze", "garden", splits={"a": 0.5, "b": 0.5}))
    name = "a" if _has(suite, "a") else "b"
    assert suite.split(name).to_arguments() == {"suite": suite.to_dict(whole=True), "split": name}
    assert suite[1:].to_arguments() is None


# -- files -----------------------------------------------------------------------------------


def check(path: Path, *levels: Any, **fields: Any) -> list[str]:
    path.write_text(emit(listed(*levels, **fields)), "utf-8")
    return [f"{each.code} {each.message}" for each in brl.validate(path)]


def test_the_command_line_knows_it(course: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(course.parent)
    for command in ("validate", "lint", "format"):
        assert run_here([command, "course.yaml"], environment(course.parent)).status == 0


def test_no_file_is_outside_the_folder_of_the_suite(course: Path) -> None:
    outside = course.parent / "outside"
    outside.mkdir()
    path = outside / "suite.yaml"
    (outside / "link.yaml").symlink_to(course.parent / "lava.yaml")
    (outside / "linked").mkdir()
    (outside / "linked" / "link.yaml").symlink_to(course.parent / "lava.yaml")
    for name in ("../lava.yaml", str(course.parent / "lava.yaml"), "link.yaml", "x\\lava.yaml"):
        assert "is not in the folder of the suite" in check(path, name)[0]
        assert "is not in the folder" in check(path, {"suite": name})[0]
    assert check(path, {"folder": ".."}) == ["BR209 `..` is not in the folder of the suite"]
    assert check(path, {"folder": "linked"}) == [
        "BR209 `link.yaml` is a link that leads out of the folder"
    ]
    (outside / "pack.yaml").write_text("name: mine\nversion: 1.0.0\ndescription: A.\n", "utf-8")
    assert check(path, "mine/link") == ["BR209 `mine/link` is a link that leads out of its pack"]
    assert check(path, {"pack": "mine"}) == [
        "BR209 `link.yaml` is a link that leads out of the folder"
    ]


def test_no_suite_lists_itself(tmp_path: Path) -> None:
    one, two = tmp_path / "one.yaml", tmp_path / "two.yaml"
    two.write_text(emit(listed("maze", {"suite": "one.yaml"})), "utf-8")
    assert check(one, {"suite": "one.yaml"}) == [
        "BR209 the suite lists itself: `one.yaml` → `one.yaml`"
    ]
    assert check(one, {"suite": "two.yaml"}) == [
        "BR209 `two.yaml` is not valid: the suite lists itself: "
        "`one.yaml` → `two.yaml` → `one.yaml`"
    ]
    with pytest.raises(brl.LevelError, match="the suite lists itself"):
        load_suite(one)


def test_what_is_listed_must_be_valid(tmp_path: Path) -> None:
    (tmp_path / "bad.yaml").write_text("version: 1\nsize: [0, 2]\n", "utf-8")
    (tmp_path / "empty").mkdir()
    assert check(tmp_path / "suite.yaml", "bad.yaml", {"folder": "empty"}, {"folder": "no"}) == [
        "BR209 `bad.yaml` is not valid: line 2: `size[0]` must be at least 1, not `0`",
        "BR209 there is no level in `empty`",
        "BR208 there is no folder `no`",
    ]


@pytest.mark.slow
def test_what_is_listed_is_bounded(tmp_path: Path) -> None:
    path = tmp_path / "suite.yaml"
    many = {"suite": listed(*["maze"] * 5001)}
    assert check(path, many, many) == [
        "BR209 the suite is not valid: the suite lists more than 10,000 levels"
    ]
    deep: dict[str, Any] = listed("maze")
    for _ in range(9):
        deep = listed({"suite": deep})
    assert "suites are nested more than 8 deep" in check(path, {"suite": deep})[0]
    grown = {"suite": "small-mazes"}
    assert (
        "11,000 levels are grown"
        in check(path, grown, {"suite": "long-ways"}, splits={"a": 1.0})[0]
    )
    assert check(path, {**grown, "split": "test"}, splits={"a": 1.0}) == []


def test_a_pack_lists_its_own_levels_before_it_is_installed(tmp_path: Path) -> None:
    for name, text in {
        "pack.yaml": "name: zoo\nversion: 1.0.0\ndescription: A zoo.\n",
        "lion.yaml": SMALL.format(2, 7),
        "apes/gorilla.yaml": SMALL.format(3, 7),
        "suites/all.yaml": emit(listed({"pack": "zoo"}, "zoo/lion", "maze")),
    }.items():
        path = tmp_path / name
        path.parent.mkdir(exist_ok=True)
        path.write_text(text, "utf-8")
    suite = load_suite(tmp_path / "suites" / "all.yaml")
    assert [level.name for level in suite] == ["lion", "gorilla", "lion", "maze"]
    assert check(tmp_path / "suites" / "other.yaml", "zoo/tiger", {"pack": "zoos"}) == [
        "BR208 there is no level called `zoo/tiger`",
        "BR208 there is no pack called `zoos`; did you mean `zoo`?",
    ]


def test_mappings_list_levels_without_files(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    level = brl.load("maze")
    suite = load_suite(listed({"level": level.to_dict()}, {"level": level.share_code()}, "maze"))
    assert {each.digest for each in suite} == {level.digest}
    with pytest.raises(brl.LevelError, match=r"there is no file `lava\.yaml`"):
        load_suite(listed("lava.yaml"))
    (tmp_path / "lava.yaml").write_text(SMALL.format(2, 7), "utf-8")
    assert load_suite(listed("lava.yaml"))[0].size == (2, 2)
    assert os.listdir(tmp_path) == ["lava.yaml"]  # noqa: PTH208
