"""Archives that nobody has packed: each is refused by a sentence, and leaves nothing behind."""

from __future__ import annotations

import io
import json
import os
import re
import stat
import struct
import sys
import zipfile
from collections.abc import Callable
from pathlib import Path

import pytest
from support.folders import babyrobot
from support.packs import (
    Entry,
    forged,
    good_files,
    level,
    manifest_of,
    pack_text,
    packed,
    sealed,
    users_files,
)
from support.work import counted_calls

from babyrobot_levels.extensions.packs import archive
from babyrobot_levels.extensions.packs.archive import MANIFEST

pytestmark = pytest.mark.usefixtures("here")

LION = "levels/lion.yaml"
GOOD = good_files()


def with_entry(name: str, **how: object) -> bytes:
    """Return a sound archive and one more level in it."""
    return sealed(more=[Entry(name, level("5, 5", "4, 4").encode(), **how)])  # type: ignore[arg-type]


def with_lion(**how: object) -> bytes:
    """Return a sound archive, but for one thing about the entry of its level."""
    rest = {"pack.yaml": GOOD["pack.yaml"]}
    lion = Entry(LION, GOOD[LION], **how)  # type: ignore[arg-type]
    return sealed(rest, manifest_of(GOOD).to_bytes(), [lion])


def with_manifest(change: Callable[[dict[str, object]], object]) -> bytes:
    """Return a sound archive with another manifest, written as manifests are."""
    data = json.loads(manifest_of(GOOD).to_bytes())
    change(data)
    return sealed(manifest=(json.dumps(data, indent=2, sort_keys=True) + "\n").encode())


def overlapping() -> bytes:
    """Return an archive in which two entries share their data."""
    first, second = Entry("a.yaml", GOOD[LION]), Entry("b.yaml", GOOD[LION])
    whole = [Entry(MANIFEST, manifest_of(GOOD).to_bytes()), first, second]
    second.offset = len(whole[0].local())
    return forged(whole)


def nested_quotes() -> bytes:
    """Return an archive whose first entry holds the whole of the others."""
    inner = Entry("b.yaml", GOOD[LION])
    outer = Entry("a.yaml", inner.local())
    manifest = Entry(MANIFEST, manifest_of(GOOD).to_bytes())
    inner.offset = len(manifest.local()) + len(outer.local()) - len(inner.local())
    body = manifest.local() + outer.local()
    directory = manifest.central(0) + outer.central(len(manifest.local())) + inner.central(0)
    end = struct.pack("<4s4H2IH", b"PK\5\6", 0, 0, 3, 3, len(directory), len(body), 0)
    return body + directory + end


def ghost() -> bytes:
    """Return an archive whose directory has an entry that is not counted, and is not there."""
    manifest = Entry(MANIFEST, manifest_of({}).to_bytes())
    body, directory = manifest.local(), manifest.central(0) + Entry("x.yaml").central(0)
    end = struct.pack("<4s4H2IH", b"PK\5\6", 0, 0, 1, 1, len(directory), len(body), 0)
    return body + directory + end


def bomb() -> bytes:
    """Return an archive of a few kilobytes that would unpack to a megabyte."""
    data = b"# " + b"x" * ((1 << 20) - 3) + b"\n"
    with io.BytesIO() as file:
        with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as packing:
            packing.writestr(MANIFEST, manifest_of({"a.yaml": data}).to_bytes())
            packing.writestr("a.yaml", data)
        return file.getvalue()


def plain_zip() -> bytes:
    """Return a pack's files as any program packs them."""
    with io.BytesIO() as file:
        with zipfile.ZipFile(file, "w") as packing:
            for name, data in {MANIFEST: manifest_of(GOOD).to_bytes(), **GOOD}.items():
                packing.writestr(zipfile.ZipInfo(name, (2026, 1, 1, 0, 0, 0)), data)
        return file.getvalue()


def zip64() -> bytes:
    """Return an archive that gives its numbers in the records of large files."""
    body = sealed()[:-22]
    record = struct.pack("<4sQ2H2I4Q", b"PK\6\6", 44, 45, 45, 0, 0, 3, 3, 100, 100)
    locator = struct.pack("<4sIQI", b"PK\6\7", 0, len(body), 1)
    end = struct.pack("<4s4H2IH", b"PK\5\6", 0, 0, *[0xFFFF] * 2, *[0xFFFFFFFF] * 2, 0)
    return body + record + locator + end


WINDOWS = "has a name that Windows reserves for a device"
UNPORTABLE = "has a name that is not portable"

HOSTILE: dict[str, tuple[str, Callable[[], bytes]]] = {
    # Paths.
    "one folder up": ("'../x.yaml' is outside", lambda: with_entry("../x.yaml")),
    "an absolute path": ("has an absolute path", lambda: with_entry("/etc/x.yaml")),
    "a drive": ("has a drive in its path", lambda: with_entry("C:/x.yaml")),
    "backslashes": ("has a backslash", lambda: with_entry("..\\x.yaml")),
    "a stream": (UNPORTABLE, lambda: with_entry("levels/lion.yaml:x.yaml")),
    "a folder": (UNPORTABLE, lambda: with_entry("a/", mode=stat.S_IFDIR | 0o755)),
    "a zero": (UNPORTABLE, lambda: with_entry("x\0.yaml")),
    "an escape": (UNPORTABLE, lambda: with_entry("\x1b[2Jx.yaml")),
    "a dot at the end": (UNPORTABLE, lambda: with_entry("levels./x.yaml")),
    "the console": (WINDOWS, lambda: with_entry("con.yaml")),
    "the last port": (WINDOWS, lambda: with_entry("lpt9/x.yaml")),
    "a device and a blank": (WINDOWS, lambda: with_entry("aux .yaml")),
    "a long path": ("more than 120 characters", lambda: with_entry("x" * 116 + ".yaml")),
    "a deep path": ("in more than 6 folders", lambda: with_entry("a/b/c/d/e/f/g/x.yaml")),
    "accents": ("is not ASCII", lambda: with_entry("\xe9.yaml")),
    "other bytes": ("is not ASCII", lambda: with_entry("x", raw_name=b"\xff\xfe.yaml")),
    # Names that are taken.
    "the same twice": ("is duplicated", lambda: with_entry(LION)),
    "capitals": ("only in upper and lower", lambda: with_entry("levels/LION.yaml")),
    "a file as a folder": ("a file and a folder", lambda: with_entry(f"{LION}/x.yaml")),
    "a second manifest": ("is duplicated", lambda: with_entry(MANIFEST)),
    "a level's name": (
        "`lion` is already the name of levels/lion.yaml",
        lambda: with_entry("lion.yaml"),
    ),
    # Kinds of files.
    "code": ("is neither YAML nor", lambda: with_entry("levels/__init__.py")),
    "a pack below": ("a pack cannot contain other packs", lambda: with_entry("inner/pack.yaml")),
    # What an entry is.
    "a link": ("is a link", lambda: with_lion(mode=stat.S_IFLNK | 0o777)),
    "a program": ("not in canonical form", lambda: with_lion(mode=stat.S_IFREG | 0o4755)),
    "an encrypted entry": ("is encrypted", lambda: with_lion(flags=1)),
    "a later date": ("contradict each other|as in a pack", lambda: with_lion(date=34)),
    "extra data": ("not in canonical form", lambda: with_lion(extra=b"\x01\0\0\0")),
    "a comment": ("not in canonical form", lambda: with_lion(comment=b"hello")),
    "another name inside": (
        "contradict each other",
        lambda: with_lion(local_name="levels/bear.yaml"),
    ),
    "a wrong crc": ("its CRC-32 is wrong", lambda: with_lion(crc=1)),
    # Sizes.
    "a bomb": ("is compressed", bomb),
    "a huge size": ("not in canonical form", lambda: with_lion(size=0xFFFFFFFE)),
    "a large file": (
        "is too large: 1,048,577 bytes",
        lambda: sealed(more=[Entry("x.yaml", b"#" * ((1 << 20) + 1))]),
    ),
    "large files": (
        "larger than 16 MiB together",
        lambda: sealed(more=[Entry(f"{n:02}.yaml", b"#" * (1 << 20)) for n in range(17)]),
    ),
    "a huge manifest": (
        "'MANIFEST.json' is too large",
        lambda: sealed(manifest=b" " * ((8 << 20) + 1)),
    ),
    "10,001 files": (
        "contains more than 10,000 files",
        lambda: sealed(more=[Entry(f"{n:05}.yaml") for n in range(9_999)]),
    ),
    "many cells": (
        "more than 2,097,152 cells",
        lambda: sealed(
            {
                **GOOD,
                **{
                    f"{n}.yaml": b"version: 1\nsize: [1024, 1024]\nmaze: {seed: random}\n"
                    for n in (1, 2)
                },
            }
        ),
    ),
    "overlapping entries": ("overlap", overlapping),
    "an entry in an entry": ("overlap", nested_quotes),
    # The whole.
    "nothing": ("does not begin like a ZIP file", lambda: b""),
    "an empty zip": ("does not begin like a ZIP file", lambda: forged([])),
    "a foreign zip": ("canonical|contradict|manifest", plain_zip),
    "a zip without manifest": ("its first entry is not", lambda: forged([Entry(LION, GOOD[LION])])),
    "another order": (
        "not in order",
        lambda: forged(
            [
                Entry(MANIFEST, manifest_of(GOOD).to_bytes()),
                *(Entry(name, GOOD[name]) for name in sorted(GOOD, reverse=True)),
            ]
        ),
    ),
    "a truncated file": ("it is cut off", lambda: sealed()[:-1]),
    "something before": ("does not begin like", lambda: b"#!/bin/sh\n" + sealed()),
    "something behind": ("after its end", lambda: sealed() + b"x"),
    "a comment at the end": ("after its end", lambda: sealed()[:-2] + b"\5\0hello"),
    "a comment that is not there": ("contradicts the rest", lambda: sealed()[:-2] + b"\5\0"),
    "fewer entries than there are": ("between its last entry and", lambda: _recounted(-1)),
    "an entry in the directory only": ("its directory is longer", ghost),
    "more entries than there are": ("its directory is damaged", lambda: _recounted(1)),
    "numbers of large files": ("contains more than 10,000 files", zip64),
    # The manifest.
    "no JSON": ("its manifest is not JSON", lambda: sealed(manifest=b"{")),
    "deep JSON": ("its manifest is not JSON", lambda: sealed(manifest=b"[" * 200_000)),
    "another format": ("not that of a pack", lambda: with_manifest(lambda m: m.update(format="x"))),
    "a later format": (
        "it has version 2 of the format, and this babyrobot-levels reads version 1",
        lambda: with_manifest(lambda m: m.update(format_version=2)),
    ),
    "a pack's name that leads up": (
        "invalid, at 'name'",
        lambda: with_manifest(lambda m: m.update(name="../zoo")),
    ),
    "a field more": ("invalid, at 'x'", lambda: with_manifest(lambda m: m.update(x=1))),
    "blanks": (
        "manifest is not in canonical",
        lambda: sealed(manifest=manifest_of(GOOD).to_bytes() + b" "),
    ),
    "a file that is not listed": (
        "'x.yaml' is in the archive, but not in its manifest",
        lambda: sealed({**GOOD, "x.yaml": b""}, manifest_of(GOOD).to_bytes()),
    ),
    "a file that is not there": (
        "'x.yaml' is in its manifest, but not in the archive",
        lambda: sealed(GOOD, manifest_of({**GOOD, "x.yaml": b""}).to_bytes()),
    ),
    "a wrong sum of as many bytes": (
        "'levels/lion.yaml' is damaged: its SHA-256",
        lambda: sealed({**GOOD, LION: GOOD[LION].upper()}, manifest_of(GOOD).to_bytes()),
    ),
    "a wrong digest": (
        "`lion` differs from the manifest",
        lambda: sealed({**GOOD, LION: level("9, 9", "8, 8").encode()}),
    ),
    "no digest": (
        "`lion` differs from the manifest: its digest is sha256:.*, not None",
        lambda: with_manifest(lambda m: _put(m, "levels", "lion", {"digest": None, "file": LION})),
    ),
    "another name": (
        "its name is `ark` in pack.yaml, but `zoo` in the manifest",
        lambda: sealed({**GOOD, "pack.yaml": pack_text("ark").encode()}),
    ),
    "a level's name that no level has": (
        r"invalid, at 'levels/\\x1b\[31mred",
        lambda: with_manifest(
            lambda m: _put(m, "levels", "\x1b[31mred", {"digest": None, "file": "x.yaml"})
        ),
    ),
    "a level's file without end": (
        "invalid, at 'levels/x/file'",
        lambda: with_manifest(
            lambda m: _put(m, "levels", "x", {"digest": None, "file": "x" * 1_000_000})
        ),
    ),
    "a device as name": (
        "pack.yaml:1:7: no folder can be called `con`",
        lambda: sealed({**GOOD, "pack.yaml": pack_text("con").encode()}),
    ),
    "no pack.yaml": ("it has no pack.yaml", lambda: sealed({LION: GOOD[LION]})),
    "a level that is listed nowhere": (
        "contains a level `x` that its manifest does not list",
        lambda: with_entry("x.yaml"),
    ),
    "a level that is listed and not there": (
        "lists a level `lion` that it does not contain",
        lambda: sealed(
            {"pack.yaml": GOOD["pack.yaml"], "x.yaml": b"version: 1\nkind: suite\ncount: 1\n"}
        ),
    ),
    "a level elsewhere": (
        "the file of `lion` is 'levels/lion.yaml' in its manifest, but 'lion.yaml' here",
        lambda: sealed({"lion.yaml": GOOD[LION], "pack.yaml": GOOD["pack.yaml"]}),
    ),
    "no valid level": (
        "levels/lion.yaml:1:1: the file is empty",
        lambda: sealed({**GOOD, LION: b""}),
    ),
    "a level out of the folder": (
        "x.yaml:2:8: `../../sea` is not the name of a theme",
        lambda: sealed({**GOOD, "x.yaml": b"version: 1\ntheme: ../../sea\n"}),
    ),
    "no valid suite": ("x.yaml:1:1: ", lambda: sealed({**GOOD, "x.yaml": b"kind: suite\n"})),
}
"""Archives that are refused: a pattern in what is said of them, and the archive."""


def _put(manifest: dict[str, object], field: str, key: str, entry: dict[str, object]) -> None:
    inner = manifest[field]
    assert isinstance(inner, dict)
    inner[key] = {"sha256": "0" * 64, **entry} if field == "files" else entry


def _recounted(change: int) -> bytes:
    data = bytearray(sealed())
    (count,) = struct.unpack_from("<H", data, len(data) - 14)
    struct.pack_into("<2H", data, len(data) - 14, count + change, count + change)
    return bytes(data)


def refused(data: bytes) -> str:
    """Return what is said when an archive is refused; all else must be as it was."""
    before = users_files()
    path = Path("hostile.brlpack")
    path.write_bytes(data)
    with counted_calls() as work:
        result = babyrobot("install", path)
    assert (result.status, result.out) == (1, ""), result
    assert result.err.count("\n") == 1
    assert len(result.err) < 500
    assert result.err.startswith("error: hostile.brlpack was not installed: ")
    assert users_files() == before
    assert sorted(found.name for found in Path().iterdir()) == ["hostile.brlpack"]
    assert work.calls < 500_000, work
    return result.err


def test_the_archive_made_by_hand_is_one_that_is_installed() -> None:
    # What is changed about it below is what it is refused for.
    Path("good.brlpack").write_bytes(sealed())
    assert babyrobot("install", "good.brlpack").status == 0
    assert babyrobot("show", "zoo/lion").status == 0


@pytest.mark.parametrize("name", HOSTILE)
def test_hostile_archives_are_refused(name: str) -> None:
    pattern, make = HOSTILE[name]
    told = refused(make())
    assert re.search(pattern, told), told


def test_as_many_files_as_a_pack_may_have(monkeypatch: pytest.MonkeyPatch) -> None:
    Path("good.brlpack").write_bytes(sealed())
    monkeypatch.setattr(archive, "MAX_FILES", len(GOOD) - 1)
    told = babyrobot("install", "good.brlpack")
    assert (told.status, "it contains more than 1 files" in told.err) == (1, True)
    monkeypatch.setattr(archive, "MAX_FILES", len(GOOD))
    assert babyrobot("install", "good.brlpack").status == 0


@pytest.mark.parametrize("name", ["one folder up", "a link", "a wrong digest", "no valid level"])
def test_an_installed_pack_is_left_as_it_is(name: str) -> None:
    archive = packed()
    assert babyrobot("install", archive).status == 0
    before = users_files()
    Path("hostile.brlpack").write_bytes(HOSTILE[name][1]())
    assert babyrobot("install", "--force", "hostile.brlpack").status == 1
    assert users_files() == before


def test_a_million_entries_are_refused_before_they_are_read() -> None:
    entry = Entry("x.yaml")
    local, central = entry.local(), entry.central(0)
    count = 1_000_000
    end = struct.pack(
        "<4s4H2IH",
        b"PK\5\6",
        0,
        0,
        count % 65536,
        count % 65536,
        len(central) * count,
        len(local),
        0,
    )
    small = local + central * 200_000
    assert "larger than the limit" in refused(local + central * count + end)
    # As many as fit into the size of a pack; the count at the end is a lie.
    for stated in (3, 10_001, 0xFFFF):
        size = len(small) - len(local)
        liar = struct.pack("<4s4H2IH", b"PK\5\6", 0, 0, stated, stated, size, len(local), 0)
        refused(small + liar)


@pytest.mark.skipif(sys.platform == "win32", reason="needs what POSIX has")
def test_a_files_own_name_is_told_in_one_line() -> None:
    Path("a\nb\x1b[2J.brlpack").write_bytes(b"")
    told = babyrobot("install", "a\nb\x1b[2J.brlpack")
    assert (told.status, told.err.count("\n"), "\x1b" in told.err) == (1, 1, False)


@pytest.mark.skipif(sys.platform == "win32", reason="needs what POSIX has")
def test_what_is_no_file_is_not_waited_for() -> None:
    Path("folder").mkdir()
    os.mkfifo("pipe")
    for name in ("folder", "pipe", "nothing"):
        result = babyrobot("install", name)
        assert (result.status, result.out) == (2, "")
        assert name in result.err
    assert users_files() == {}
