"""Archives that differ in a few bytes from a sound one: refused, or the very same levels."""

from __future__ import annotations

import json
import os
import tempfile
from pathlib import Path
from unittest import mock

from hypothesis import example, given, settings
from hypothesis import strategies as st
from hypothesis.strategies import DrawFn
from support.packs import good_files, manifest_of, sealed, snapshot

from babyrobot_levels.library.packs.archive import parse_archive, write_archive
from babyrobot_levels.library.packs.format import Manifest, PackError
from babyrobot_levels.library.packs.store import install
from babyrobot_levels.library.reading import load_file

GOOD = sealed()
FILES = good_files()
LION = "levels/lion.yaml"


@st.composite
def mutants(draw: DrawFn, data: bytes = GOOD) -> bytes:
    """Bytes of which a few are changed, taken away, put in, or put elsewhere."""
    changed = bytearray(data)
    for _ in range(draw(st.integers(1, 4))):
        place = draw(st.integers(0, len(changed)))
        length = draw(st.sampled_from([1, 1, 2, 4, 30, 100]))
        piece = bytes(changed[place : place + length])
        how = draw(st.sampled_from(["change", "flip", "delete", "insert", "repeat", "move"]))
        if how == "change":
            changed[place : place + length] = draw(st.binary(max_size=4))
        elif how == "flip" and piece:
            changed[place] ^= 1 << draw(st.integers(0, 7))
        elif how == "insert":
            changed[place:place] = draw(st.binary(min_size=1, max_size=4))
        elif how == "repeat":
            changed[place:place] = piece
        else:
            del changed[place : place + length]
            if how == "move":
                goal = draw(st.integers(0, len(changed)))
                changed[goal:goal] = piece
    return bytes(changed)


@settings(max_examples=800, deadline=None)
@given(mutants())
@example(GOOD)
def test_changed_bytes_are_noticed(data: bytes) -> None:
    try:
        archive = parse_archive(data)
    except PackError:
        assert data != GOOD
        return
    # There is one way only to write an archive.
    assert data == GOOD == write_archive(archive.manifest, archive.files)
    assert archive.files == FILES


def test_every_single_bit_counts() -> None:
    for place in range(len(GOOD)):
        changed = bytearray(GOOD)
        changed[place] ^= 1 << place % 8
        try:
            parse_archive(bytes(changed))
        except PackError:
            continue
        raise AssertionError(f"nobody notices another byte at {place}")


@st.composite
def resealed(draw: DrawFn) -> bytes:
    """Archives with other files or another manifest, for which all sums are right again."""
    files = dict(FILES)
    for name in draw(st.lists(st.sampled_from(sorted(FILES)), max_size=2)):
        files[name] = draw(mutants(FILES[name]))
    manifest = manifest_of(files).to_bytes()
    if draw(st.booleans()):
        manifest = draw(mutants(manifest))
    return sealed(files, manifest)


@settings(max_examples=250, deadline=None)
@given(resealed())
@example(sealed({**FILES, LION: FILES[LION] + b"# a comment\n"}))
def test_what_is_installed_is_what_the_manifest_says(data: bytes) -> None:
    with tempfile.TemporaryDirectory() as folder:
        places = {"XDG_DATA_HOME": folder, "HOME": folder}
        with mock.patch.dict(os.environ, places):
            try:
                done = install(parse_archive(data))
            except PackError:
                assert snapshot(Path(folder)) == {}
                return
        manifest: Manifest = parse_archive(data).manifest
        level = load_file(done.pack.folder / LION)
        assert {"lion": level.digest} == {
            name: entry.digest for name, entry in manifest.levels.items()
        }
        assert json.loads(manifest.to_bytes())["name"] == done.pack.name == "zoo"
