"""Archives that differ in a few bytes from a sound one: refused, or the very same levels."""

from __future__ import annotations

import json
import os
from pathlib import Path
from random import Random
from unittest import mock

from support.mutants import mutated
from support.packs import good_files, manifest_of, sealed, snapshot

from babyrobot_levels.extensions.packs.archive import (
    Manifest,
    PackError,
    parse_archive,
    write_archive,
)
from babyrobot_levels.extensions.packs.store import install
from babyrobot_levels.library.level import load_file

GOOD = sealed()
FILES = good_files()
LION = "levels/lion.yaml"


def changed(rng: Random, data: bytes) -> bytes:
    """Return bytes of which some are changed, taken away, put in, or put elsewhere."""
    return mutated(rng, data, [b"\0", b"PK\1\2", b"\xff" * 4], [GOOD])


def test_changed_bytes_are_noticed() -> None:
    for data in (GOOD, *(changed(Random(seed), GOOD) for seed in range(800))):
        try:
            archive = parse_archive(data)
        except PackError:
            assert data != GOOD
            continue
        # There is one way only to write an archive.
        assert data == GOOD == write_archive(archive.manifest, archive.files)
        assert archive.files == FILES


def resealed(seed: int) -> bytes:
    """Return an archive with other files or another manifest, for which all sums are right."""
    rng, files = Random(seed), dict(FILES)
    for name in rng.sample(sorted(FILES), rng.randint(0, 2)):
        files[name] = changed(rng, FILES[name])
    manifest = manifest_of(files).to_bytes()
    return sealed(files, changed(rng, manifest) if rng.random() < 0.5 else manifest)


def test_what_is_installed_is_what_the_manifest_says(tmp_path: Path) -> None:
    commented = sealed({**FILES, LION: FILES[LION] + b"# a comment\n"})
    installed = 0
    for number, data in enumerate((commented, *map(resealed, range(250)))):
        folder = tmp_path / str(number)
        folder.mkdir()
        with mock.patch.dict(os.environ, {"XDG_DATA_HOME": str(folder), "HOME": str(folder)}):
            try:
                done = install(parse_archive(data))
            except PackError:
                assert snapshot(folder) == {}
                continue
        installed += 1
        manifest: Manifest = parse_archive(data).manifest
        level = load_file(done.pack.folder / LION)
        assert {"lion": level.digest} == {
            name: entry.digest for name, entry in manifest.levels.items()
        }
        assert json.loads(manifest.to_bytes())["name"] == done.pack.name == "zoo"
    assert installed > 1
