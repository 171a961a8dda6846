"""Packing a folder: what belongs to the pack, what is found first, and the same bytes for ever."""

from __future__ import annotations

import json
import os
import re
import sys
import zipfile
from pathlib import Path

import pytest
from support.folders import babyrobot, write_files
from support.packs import level, pack_text, packed, snapshot, zoo
from support.work import counted_calls

import babyrobot_levels as brl
from babyrobot_levels.extensions.packs.archive import MANIFEST, MAX_FILES

pytestmark = pytest.mark.usefixtures("here")
needs_posix = pytest.mark.skipif(sys.platform == "win32", reason="needs what POSIX has")


def findings(folder: str | Path = "zoo") -> list[tuple[str, str, int, int]]:
    """Return the findings that prevent a pack; nothing may be written."""
    before = snapshot(Path())
    result = babyrobot("pack", folder, "--format", "json")
    assert result.status == 1
    assert result.err == "no pack was written: fix the errors first\n"
    assert snapshot(Path()) == before
    told = json.loads(result.out)["diagnostics"]
    return [(each["code"], each["file"], each["line"], each["column"]) for each in told]


def messages(folder: str | Path = "zoo") -> str:
    return babyrobot("pack", folder).out


# -- there and back --------------------------------------------------------------------------


def test_the_archive_is_a_zip_that_everybody_can_read() -> None:
    with zipfile.ZipFile(packed()) as archive:
        assert archive.testzip() is None
        assert archive.namelist() == [MANIFEST, *sorted(zoo())]
        for name, text in zoo().items():
            assert archive.read(name) == text.encode()
        manifest = json.loads(archive.read(MANIFEST))
    assert manifest["format"] == "babyrobot-levels pack"
    assert (manifest["format_version"], manifest["name"], manifest["version"]) == (
        1,
        "zoo",
        "1.0.0",
    )
    assert manifest["levels"]["lion"] == {
        "file": "levels/lion.yaml",
        "digest": brl.load(Path("source-1.0.0/levels/lion.yaml")).digest,
    }


def test_the_same_files_are_the_same_bytes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    first = packed().read_bytes()
    backwards = dict(reversed(zoo().items()))
    mask = os.umask(0o077)
    try:
        folder = write_files(tmp_path / "elsewhere" / "of that name", backwards)
    finally:
        os.umask(mask)
    for number, path in enumerate(sorted(folder.rglob("*"))):
        os.utime(path, (number * 10**8, number * 10**8))
        path.chmod(0o700)
    monkeypatch.chdir(folder / "levels")
    monkeypatch.setenv("TZ", "Asia/Kathmandu")
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1")
    assert babyrobot("pack", "..", "-o", tmp_path / "again.brlpack").status == 0
    assert (tmp_path / "again.brlpack").read_bytes() == first


def test_these_bytes_are_those_of_version_1() -> None:
    # Packs that were published are identified by them.
    write_files(Path("zoo"), {"lion.yaml": level(), "pack.yaml": pack_text()})
    told = json.loads(babyrobot("pack", "zoo", "--format", "json").out)
    assert told["size"] == 1015
    assert told["sha256"] == "ff469f48c49686072e7af3c4202361faabc797252c8e0407f0e53e46510faf3d"


# -- what belongs to it ----------------------------------------------------------------------


def test_other_files_stay_out_and_are_named() -> None:
    more = {"notes.txt": "x", "a/b/picture.png": "x", ".hidden/x.yaml": "x", ".x.yaml": "x"}
    write_files(Path("zoo"), {**zoo(), **more, "deep/2/3/4/5/6/7/x.yaml": "x"})
    result = babyrobot("pack", "zoo")
    assert result.status == 0
    assert "left out: a/b/picture.png, deep/2/3/4/5/6/7/, notes.txt\n" in result.out
    with zipfile.ZipFile("zoo-1.0.0.brlpack") as archive:
        assert archive.namelist()[1:] == sorted(zoo())


def test_of_many_other_files_ten_are_named() -> None:
    write_files(Path("zoo"), {**zoo(), **{f"{letter}.txt": "x" for letter in "abcdefghijkl"}})
    (told,) = [line for line in babyrobot("pack", "zoo").out.splitlines() if "left out" in line]
    assert told == "left out: " + ", ".join(f"{each}.txt" for each in "abcdefghij") + " and 2 more"


@needs_posix
def test_names_of_other_files_reach_the_terminal_as_plain_text() -> None:
    write_files(Path("zoo"), {**zoo(), "\x1b[2J\n.txt": "x"})
    told = babyrobot("pack", "zoo")
    assert "\x1b" not in told.out
    assert [line for line in told.out.splitlines() if "left out: " in line and ".txt" in line]


def test_a_pack_lies_in_the_current_folder_or_where_one_says() -> None:
    write_files(Path("zoo"), zoo())
    assert babyrobot("pack", "zoo", "-o", "made/of/zoo.brlpack").status == 0
    assert Path("made/of/zoo.brlpack").is_file()
    assert babyrobot("pack", "zoo").status == 0
    again = babyrobot("pack", "zoo")
    assert (again.status, again.out) == (2, "")
    assert "zoo-1.0.0.brlpack already exists" in again.err
    assert babyrobot("pack", "zoo", "--force").status == 0
    os.chdir("zoo")
    assert babyrobot("pack").status == 0
    # The archive in the folder does not become part of the next one.
    assert babyrobot("pack", "--force").status == 0
    assert Path("zoo-1.0.0.brlpack").read_bytes() == Path("../zoo-1.0.0.brlpack").read_bytes()


@pytest.mark.parametrize("name", ["nowhere", "file"])
def test_what_is_no_pack(name: str) -> None:
    Path("file").touch()
    result = babyrobot("pack", name)
    assert (result.status, result.out) == (2, "")
    assert name in result.err


@pytest.mark.parametrize(
    ("line", "is_local"),
    [
        ("# yaml-language-server: $schema=file:///home/ada/s.json", True),
        ("# yaml-language-server: $schema=C:\\Users\\ada\\s.json", True),
        ("# yaml-language-server: $schema=https://example.org/s.json", False),
    ],
)
def test_a_path_of_ones_machine_is_told(line: str, is_local: bool) -> None:
    text = level().partition("\n")[2]
    write_files(Path("zoo"), {"pack.yaml": pack_text(), "lion.yaml": f"{line}\n{text}"})
    result = babyrobot("pack", "zoo")
    assert result.status == 0
    note = "the $schema line contains a path of your machine: lion.yaml\n"
    assert (note in result.err) == is_local


def test_a_folder_with_a_pack_yml_is_told_to_rename_it() -> None:
    write_files(Path("zoo"), {"pack.yml": pack_text()})
    assert "  help: rename pack.yml\n" in babyrobot("pack", "zoo").err


def test_a_long_name_is_one() -> None:
    name = "x" * 115
    write_files(Path("zoo"), {"pack.yaml": pack_text(), f"{name}.yaml": level()})
    assert babyrobot("pack", "zoo").status == 0
    assert babyrobot("install", "zoo-1.0.0.brlpack").status == 0
    assert brl.load(f"zoo/{name}").size == (4, 3)


def test_a_folder_without_pack_yaml_is_told_how_one_looks() -> None:
    write_files(Path("zoo"), {"lion.yaml": level()})
    assert "no pack.yaml in" in babyrobot("pack", "zoo").err
    shown = babyrobot("pack", "--help").out
    assert {"name: zoo", "version: 1.0.0"} <= {line.strip() for line in shown.splitlines()}


def test_a_pack_has_levels() -> None:
    write_files(Path("zoo"), {"pack.yaml": pack_text()})
    result = babyrobot("pack", "zoo")
    assert (result.status, result.out) == (1, "")
    assert "zoo cannot be packed: it has neither levels nor suites" in result.err


def test_a_pack_may_have_suites_only() -> None:
    files = {name: zoo()[name] for name in ("pack.yaml", "suites/herd.yaml")}
    write_files(Path("zoo"), files)
    told = babyrobot("pack", "zoo")
    assert (told.status, told.err) == (0, "wrote zoo-1.0.0.brlpack (802 bytes)\n")
    assert re.fullmatch(r"zoo 1.0.0: 1 suite\n  herd  suite\n[\d,]+ bytes, sha256:.*\n", told.out)


# -- what is found ---------------------------------------------------------------------------


def test_errors_stand_where_they_are() -> None:
    write_files(
        Path("zoo"),
        {
            "pack.yaml": "name: Zoo\nversion: 1.0\nautor: me\n",
            "a.yaml": "version: 1\nsize: [4, 0]\n",
            "b.yaml": "version: 1\nkind: suite\n",
            "themes/c.yaml": "colors: {base: rde}\n",
            "README.md": "Not YAML: [\n",
        },
    )
    assert findings() == [
        ("BR205", "zoo/a.yaml", 2, 11),
        ("BR202", "zoo/b.yaml", 1, 1),
        ("BR202", "zoo/pack.yaml", 1, 1),
        ("BR207", "zoo/pack.yaml", 1, 7),
        ("BR203", "zoo/pack.yaml", 2, 10),
        ("BR201", "zoo/pack.yaml", 3, 1),
        ("BR403", "zoo/themes/c.yaml", 1, 16),
    ]
    assert "  2 | size: [4, 0]\n    |           ^\n" in messages()


def test_warnings_are_shown_and_the_pack_is_written() -> None:
    """The linter's settings of the folder apply."""
    files = {"pack.yaml": pack_text(), "a.yaml": level() + "tags: []\n", "b.yaml": level()}
    write_files(Path("zoo"), files)
    linted = json.loads(babyrobot("lint", "zoo", "--format", "json").out)["diagnostics"]
    assert {each["code"] for each in linted} == {"BR604", "BR609", "BR515"}
    result = babyrobot("pack", "zoo", "--format", "json")
    assert result.status == 0
    assert json.loads(result.out)["file"] == "zoo-1.0.0.brlpack"
    assert Path("zoo-1.0.0.brlpack").exists()
    for each in linted:
        place = f"{each['file']}:{each['line']}:{each['column']}"
        assert f"{place}: {each['severity']} {each['code']}: {each['message']}\n" in result.err
    assert "\n1 warning, 2 infos in 2 of 3 files\nwrote " in result.err
    # A folder's settings are read once by each process.
    settings = {"five": '["BR5"]', "three": '["BR503"]', "none": '["BR999"]'}
    for name, select in settings.items():
        write_files(Path(name), {**files, "babyrobot.toml": f"[lint]\nselect = {select}\n"})
    assert "1 warning in 1 of 3 files\n" in babyrobot("pack", "five", "--force").err
    assert babyrobot("pack", "three", "--force").err.startswith("wrote ")
    assert babyrobot("pack", "none", "--force").status == 2


def test_errors_are_shown_with_all_warnings() -> None:
    files = {"pack.yaml": pack_text(), "a.yaml": level() + "tags: []\n", "b.yaml": "version: 2\n"}
    write_files(Path("zoo"), files)
    assert [code for code, *_ in findings()] == ["BR604", "BR609", "BR204"]


@pytest.mark.parametrize(
    ("version", "is_good"), [("999999999.0.1", True), ("1.0", False), ("01.0.0", False)]
)
def test_a_version_is_written_in_one_way(version: str, is_good: bool) -> None:
    write_files(Path("zoo"), {**zoo(), "pack.yaml": pack_text(version=version)})
    told = babyrobot("pack", "zoo")
    assert told.status == (0 if is_good else 1)
    assert is_good or "zoo/pack.yaml:2:10: error " in told.out


@pytest.mark.parametrize(
    ("first", "second"),
    [
        ({"a/lion.yaml": ""}, {"b/lion.yaml": ""}),
        ({"lion.yaml": ""}, {"x.yaml": "name: lion\n"}),
        ({"a.yaml": "name: b\n"}, {"b.yaml": "name: a\n"}),
        ({"Lion One.yaml": ""}, {"lion-one.yaml": ""}),
        ({"a/lion.yml": ""}, {"suites/lion.yaml": "kind: suite\ncount: 2\n"}),
    ],
)
def test_a_name_means_one_thing(first: dict[str, str], second: dict[str, str]) -> None:
    sizes = iter(["4, 3", "4, 4"])
    files = {
        name: "version: 1\n" + text if "kind" in text else level(next(sizes)) + text
        for name, text in {**first, **second}.items()
    }
    settings = '[lint]\nselect = ["BR5"]\n'
    write_files(Path("zoo"), {"pack.yaml": pack_text(), **files, "babyrobot.toml": settings})
    (found,) = findings()
    lines = files[max(files)].splitlines()
    places = [(number, 7) for number, line in enumerate(lines, 1) if line.startswith("name: ")]
    assert found == ("BR701", f"zoo/{max(files)}", *(places or [(1, 1)])[0])


@pytest.mark.parametrize(
    ("name", "why"),
    [
        ("caf\xe9.yaml", "not portable"),
        ("con.yaml", "Windows reserves for a device"),
        ("a/pack.yaml", "a pack cannot contain other packs"),
        ("LEVELS/x.yaml", "only in upper and lower case"),
    ],
)
@needs_posix
def test_files_that_would_not_be_the_same_everywhere(name: str, why: str) -> None:
    write_files(Path("zoo"), {**zoo(), name: level("9, 9", "8, 8")})
    found = findings()
    assert {code for code, *_ in found} == {"BR702"}
    assert why in messages()


@needs_posix
def test_links_are_not_followed(tmp_path: Path) -> None:
    secret = write_files(tmp_path / "secret", {"x.yaml": level("9, 9", "8, 8")})
    folder = write_files(Path("zoo"), zoo())
    for link, target in (
        ("x.yaml", secret / "x.yaml"),
        ("more", secret),
        ("LICENSE.md", "LICENSE"),
    ):
        (folder / link).symlink_to(target)
        assert findings() == [("BR702", f"zoo/{link}", 1, 1)]
        assert "is a link" in messages()
        (folder / link).unlink()
    # What does not belong to a pack may be whatever it likes, also a circle.
    (folder / "notes.txt").symlink_to("notes.txt")
    assert babyrobot("pack", "zoo").status == 0


@needs_posix
@pytest.mark.parametrize("name", ["README.md", "themes/x.yml"])
def test_pipes_are_not_waited_for(name: str) -> None:
    path = write_files(Path("zoo"), zoo()) / name
    path.parent.mkdir(exist_ok=True)
    os.mkfifo(path)
    result = babyrobot("pack", "zoo")
    assert (result.status, result.out) == (1, "")
    assert f"'{name}' is not a regular file" in result.err


def test_a_folder_that_may_not_be_read_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    folder = write_files(Path("zoo"), zoo())
    scan = os.scandir

    # Permissions do not stop everybody who runs tests, so the refusal is played.
    def refuse(path: str | Path) -> object:
        if Path(path) == folder / "suites":
            raise PermissionError(13, "Permission denied", str(path))
        return scan(path)

    monkeypatch.setattr(os, "scandir", refuse)
    result = babyrobot("pack", "zoo")
    assert (result.status, result.out) == (2, "")
    assert "Permission denied" in result.err
    assert str(folder / "suites") in result.err
    assert not Path("zoo-1.0.0.brlpack").exists()


def test_a_large_file_and_a_file_that_is_no_text() -> None:
    folder = write_files(Path("zoo"), {**zoo(), "x.yaml": b"version: 1\ntitle: \xff\n"})
    assert findings() == [("BR102", "zoo/x.yaml", 2, 8)]
    (folder / "x.yaml").write_bytes(b"#" * ((1 << 20) + 1))
    assert "'x.yaml' is larger than 1 MiB" in babyrobot("pack", "zoo").err


@pytest.mark.sweep
def test_a_folder_with_a_hundred_thousand_files() -> None:
    folder = write_files(Path("zoo"), zoo())
    for number in range(100_000):
        # An empty file of each name is the cheapest way to so many.
        os.close(os.open(folder / f"{number}.yaml", os.O_CREAT))
    with counted_calls() as work:
        result = babyrobot("pack", "zoo")
    assert (result.status, result.out) == (1, "")
    assert f"it contains more than {MAX_FILES:,} files" in result.err
    assert work.calls < 10_000_000, work


def test_a_folder_in_the_place_of_the_packs_file(here: Path) -> None:
    (here / "pack.yaml").mkdir()
    result = babyrobot("pack")
    assert (result.status, result.out) == (2, "")
    assert "pack.yaml is a folder" in result.err
