"""Packs among the places of levels: names, themes, suites, and what is broken."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import pytest
from support.carriers import LEVEL, carry, write
from support.sessions import Result, environment, run_here

import babyrobot_levels as brl
from babyrobot_levels.extensions.packs.store import uninstall
from babyrobot_levels.language.documents import theme_folders
from babyrobot_levels.library.catalogue import catalogue
from babyrobot_levels.library.packs import unusable_packs
from babyrobot_levels.library.search_path import places
from babyrobot_levels.suites.suite import load_suite
from babyrobot_levels.text.files import user_folder

SEA = "colors: {base: '#123456'}\n"
THEMED = f"{LEVEL}theme: sea\n"
SUITE = "version: 1\nkind: suite\nseed: 1\ncount: 5\nsize: [4, 4]\nmaze: {}\ntheme: sea\n"
PACK = "name: zoo\nversion: 1.0.0\ndescription: A zoo\n"


def base(level: brl.Level) -> str | None:
    return level.resolved_theme.colors.base


def listed(here: Path, *arguments: str) -> Result:
    """Return what `babyrobot list` prints where the user's folder is that of this test."""
    data = str(user_folder().parent)
    return run_here(["list", *arguments], environment(here, XDG_DATA_HOME=data))


# -- names -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("asked", "told"),
    [("zoo/loin", "zoo/lion"), ("zo/lion", "zoo/lion"), ("lion", "zoo/lion"),
     ("zoo/final-maze", "final-maze"), ("zoo/default", "default")],
)  # fmt: skip
def test_unknown_names_tell_those_of_packs(asked: str, told: str, users_pack: Path) -> None:
    write(users_pack / "lion.yaml")
    write(users_pack / "suites" / "lions.yaml", SUITE)
    with pytest.raises(brl.LevelNotFoundError) as caught:
        brl.load(asked)
    assert "zoo/lions" not in caught.value.nearest
    assert caught.value.nearest[0] == told


def test_unknown_suites_tell_those_of_packs(users_pack: Path) -> None:
    write(users_pack / "suites" / "monkeys.yaml", SUITE.replace("theme: sea\n", ""))
    for asked in ("zoo/monkey", "monkeys"):
        with pytest.raises(brl.SuiteNotFoundError, match="did you mean 'zoo/monkeys'"):
            load_suite(asked)
    assert len(load_suite("zoo/monkeys")) == 5


@pytest.mark.parametrize(
    "text",
    [
        "{version: 1, name: wolf, size: [4, 3]}\n",
        '"name": wolf\nversion: 1\nsize: [4, 3]\n',
        "name:\n  wolf\nversion: 1\nsize: [4, 3]\n",
        'name: "w\\x6flf"\nversion: 1\nsize: [4, 3]\n',
        "name: wolf  # at night\nversion: 1\nsize: [4, 3]\n",
        "name: 'wolf'\r\nversion: 1\r\nsize: [4, 3]\r\n",
    ],
)
def test_a_level_is_found_however_its_name_is_written(text: str, users_pack: Path) -> None:
    write(users_pack / "beast.yaml", text)
    assert [info.name for info in catalogue()[0] if info.name.startswith("zoo/")] == ["zoo/wolf"]
    assert brl.load("zoo/wolf").size == brl.load("zoo/beast").size == (4, 3)


def test_levels_are_found_as_deep_as_a_pack_may_have_them(users_pack: Path) -> None:
    write(users_pack / "1/2/3/4/5/6/lion.yaml")
    write(users_pack / "1/2/3/4/5/6/7/bear.yaml")
    assert brl.load("zoo/lion").size == (4, 3)
    with pytest.raises(brl.LevelNotFoundError):
        brl.load("zoo/bear")


def test_a_suite_is_found_by_its_own_name_too(users_pack: Path) -> None:
    write(users_pack / "cows.yaml", "version: 1\nkind: suite\nname: herd\ncount: 5\n")
    assert len(load_suite("zoo/herd")) == len(load_suite("zoo/cows")) == 5
    with pytest.raises(brl.SuiteNotFoundError, match="did you mean 'zoo/herd'"):
        load_suite("zoo/hert")
    assert not [info for info in catalogue()[0] if info.name.startswith("zoo/")]
    assert catalogue()[1] == []


def test_places_are_looked_for_one_by_one(
    users_pack: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def torn() -> None:
        raise AssertionError("nobody has asked for packs")

    monkeypatch.setattr("babyrobot_levels.library.packs.carried_packs", torn)
    write(users_pack / "lion.yaml")
    assert brl.load("final-maze").name == "final-maze"
    assert brl.load("zoo/lion").name == "lion"
    with pytest.raises(AssertionError, match="nobody"):
        brl.load("zoo/nobody")


# -- themes ----------------------------------------------------------------------------------


@pytest.mark.parametrize("inside", [".", "apes", "apes/old/grey"])
def test_a_theme_of_the_pack_applies_in_all_its_folders(inside: str, users_pack: Path) -> None:
    write(users_pack / "pack.yaml", PACK)
    write(users_pack / "themes" / "sea.yaml", SEA)
    path = write(users_pack / inside / "lion.yaml", THEMED)
    level = brl.load("zoo/lion")
    assert base(level) == "#123456"
    assert base(brl.load(path)) == "#123456"
    assert base(level.replace(size=[5, 5])) == "#123456"
    assert base(brl.load("default").replace(theme="green").replace(theme="blue_green")) != "#123456"
    assert brl.validate(path) == []
    assert base(brl.load(level.share_code())) == "#123456"


def test_the_nearest_theme_is_meant(users_pack: Path) -> None:
    write(users_pack / "pack.yaml", PACK)
    write(users_pack / "themes" / "sea.yaml", SEA)
    write(users_pack / "apes" / "themes" / "sea.yaml", SEA.replace("123456", "654321"))
    write(users_pack / "apes" / "old" / "lion.yaml", THEMED)
    write(users_pack / "bear.yaml", THEMED)
    assert base(brl.load("zoo/lion")) == "#654321"
    assert base(brl.load("zoo/bear")) == "#123456"


def test_themes_outside_the_pack_are_not_looked_at(users_pack: Path) -> None:
    write(users_pack / "pack.yaml", PACK)
    write(users_pack.parent / "themes" / "sea.yaml", SEA)
    write(users_pack.parent / "pack.yaml", PACK)
    path = write(users_pack / "apes" / "lion.yaml", THEMED)
    with pytest.raises(brl.LevelError, match="unknown theme `sea`"):
        brl.load("zoo/lion")
    # Nor those of a pack in which a link leads to the level.
    other = user_folder() / "packs" / "ark"
    write(other / "pack.yaml", PACK)
    write(other / "themes" / "sea.yaml", SEA)
    (users_pack / "linked").symlink_to(other, target_is_directory=True)
    write(other / "dove.yaml", THEMED)
    assert theme_folders(users_pack / "linked" / "deep")[-1] == users_pack / "linked" / "themes"
    assert theme_folders(path.parent) == [path.parent / "themes", users_pack / "themes"]


def test_themes_of_folders_around_are_for_packs_only(here: Path) -> None:
    write(here / "themes" / "sea.yaml", SEA)
    path = write(here / "apes" / "lion.yaml", THEMED)
    with pytest.raises(brl.LevelError, match="unknown theme `sea`"):
        brl.load(path)
    write(here / "pack.yaml", PACK)
    assert base(brl.load(path)) == "#123456"


def test_the_theme_of_a_suite_of_a_pack(users_pack: Path) -> None:
    write(users_pack / "pack.yaml", PACK)
    write(users_pack / "themes" / "sea.yaml", SEA)
    write(users_pack / "suites" / "monkeys.yaml", SUITE)
    assert base(load_suite("zoo/monkeys")[0]) == "#123456"


# -- what is broken --------------------------------------------------------------------------


@pytest.mark.slow
def test_a_broken_pack_stops_nobody_else(users_pack: Path, site: Path) -> None:
    write(users_pack / "lion.yaml", "version: [\n")
    write(users_pack / "ape.yaml")
    write(users_pack / "pack.yaml", "[" * 9000)
    carry(site, "brl_ark", "ark = brl_ark\nnowhere = brl_nowhere")
    write(site / "brl_ark" / "dove.yaml")
    for name, text in [
        ("torn", "nowhere\n"),
        ("left", "../zoo\n"),
        ("empty", ""),
        ("big", "x" * 9999),
    ]:
        write(user_folder() / "packs" / name / "current", text)
        write(user_folder() / "packs" / name / "cow.yaml")
    (user_folder() / "packs" / "folder" / "current").mkdir(parents=True)
    assert [place.pack for place in places() if place.pack] == ["zoo", "ark"]
    assert brl.load("zoo/ape").size == brl.load("ark/dove").size == (4, 3)
    assert [path.name for path in catalogue()[1]] == ["lion.yaml"]
    told = listed(users_pack, "--packs")
    assert told.out == (
        "NAME  VERSION  LEVELS  SUITES  FROM                 DESCRIPTION\n"
        "ark   -        1       0       package brl_ark 1.0\n"
        "zoo   -        2       0       folder\n"
    )
    home = user_folder() / "packs"
    faults = [
        f"{home / name} is left out: its file `current` is damaged; install the pack again"
        for name in ("big", "empty", "folder", "left", "torn")
    ]
    faults.append(
        "the pack 'nowhere' of package brl_ark 1.0 is left out: 'brl_nowhere' is not a folder"
    )
    assert told.err.splitlines() == faults
    told = listed(users_pack)
    assert told.err.splitlines()[1:] == faults
    assert {"zoo/ape", "ark/dove"} <= {line.split()[0] for line in told.out.splitlines()}
    assert "zoo/lion" not in told.out


@pytest.fixture
def locked_pack(users_pack: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A pack's folder into which we may not look, beside one into which we may."""
    folder = users_pack.with_name("ark")
    write(folder / "dove.yaml")
    write(users_pack / "ape.yaml")
    lstat, scan = Path.lstat, os.walk

    # Permissions do not stop everybody who runs tests, so the refusal is played.
    def refuse(path: Path) -> os.stat_result:
        if path.parent == folder:
            raise PermissionError(13, "Permission denied", str(path))
        return lstat(path)

    def skip(top: Path, *arguments: Any, **options: Any) -> Any:
        return iter(()) if top == folder else scan(top, *arguments, **options)

    monkeypatch.setattr(Path, "lstat", refuse)
    monkeypatch.setattr(os, "walk", skip)
    return folder


def test_a_folder_that_may_not_be_entered_is_told_and_left_out(locked_pack: Path) -> None:
    assert [place.pack for place in places() if place.pack] == ["zoo"]
    assert [*unusable_packs()] == [f"{locked_pack} is left out: permission denied"]
    with pytest.raises(PermissionError):
        uninstall("ark")


def test_a_folder_of_packs_that_may_not_be_read_is_told(
    users_pack: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(path: Path) -> None:
        raise PermissionError(13, "Permission denied", str(path))

    monkeypatch.setattr(Path, "iterdir", refuse)
    assert [place.pack for place in places() if place.pack] == []
    assert [*unusable_packs()] == [f"{users_pack.parent} is left out: Permission denied"]


def test_what_a_pack_says_reaches_the_terminal_as_plain_text(users_pack: Path) -> None:
    text = PACK.replace("A zoo", '"\\e[31mred\\nand more \\u202e"')
    write(users_pack / "pack.yaml", text)
    told = listed(users_pack, "--packs")
    assert told.out.count("\n") == 2
    assert not {"\x1b", "\u202e"} & {*told.out}


def test_packs_have_no_tags(here: Path) -> None:
    told = listed(here, "--packs", "--tag", "maze")
    assert (told.status, told.out) == (2, "")
    assert told.err == "error: --tag cannot be combined with --packs\n  help: leave out --tag\n"


def test_no_packs(here: Path) -> None:
    assert listed(here, "--packs", "--format", "json").out == "[]\n"
    told = listed(here, "--packs")
    assert (told.out, told.status) == ("", 0)
    assert told.err == "no packs are installed (see `babyrobot install`)\n"
