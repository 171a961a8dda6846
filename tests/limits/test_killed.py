"""Kill -9 in the middle: of a pack, the old one or the new one is there, whole, or none."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from support.folders import write_files
from support.packs import level, pack_text, packed
from support.subprocesses import HOME

pytestmark = [
    pytest.mark.usefixtures("here"),
    pytest.mark.skipif(sys.platform == "win32", reason="needs fork"),
]

LEVELS = 8


def files(version: str) -> dict[str, str]:
    """Return a pack of many levels; no file but the licence is the same in two versions."""
    grown = 4 + int(version[0])
    levels = {
        f"levels/n{number}.yaml": level(f"{grown}, {number + 3}", f"{grown - 1}, 1")
        for number in range(LEVELS)
    }
    return {"LICENSE": "Yours.\n", "pack.yaml": pack_text(version=version), **levels}


def killed(call: str) -> list[dict[str, Any]]:
    """Return what was found after each killed call."""
    packed("1.0.0", files("1.0.0")).rename("old.brlpack")
    packed("2.0.0", files("2.0.0")).rename("new.brlpack")
    write_files(Path("source"), files("2.0.0"))
    done = subprocess.run(
        [sys.executable, "-m", "support.killing", call],
        env={
            **os.environ,
            "PYTHONPATH": os.pathsep.join([str(HOME), str(HOME / "tests")]),
            "OPENBLAS_NUM_THREADS": "1",
        },
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return [json.loads(line) for line in done.stdout.splitlines()]


CALLS = [
    pytest.param("upgrade", "1.0.0", "2.0.0"),
    pytest.param("install", None, "2.0.0", marks=pytest.mark.sweep),
    pytest.param("uninstall", "1.0.0", None, marks=pytest.mark.sweep),
]
"""What is called, and which version is there before it and after it."""


@pytest.mark.parametrize(("call", "before", "after"), CALLS)
def test_a_killed_call_leaves_a_whole_pack(
    call: str, before: str | None, after: str | None
) -> None:
    *found, last = killed(call)
    whole = {
        version: [{"version": version, "files": files(version)}] if version else []
        for version in (before, after)
    }
    for outcome in found:
        assert outcome["packs"] in whole.values(), outcome["how"]
        assert not outcome["ended"] or outcome["packs"] == whole[after]
    # They were killed at all stages: before anything was done, half-way, and when it was over.
    assert {tuple(pack["version"] for pack in outcome["packs"]) for outcome in found} == {
        (version,) if version else () for version in (before, after)
    }
    assert any(outcome["remains"] for outcome in found)
    # Whatever they left, an ordinary installation succeeds, and nothing lies about.
    assert last["packs"] == [{"version": "2.0.0", "files": files("2.0.0")}]
    assert last["remains"] == []


def test_a_killed_pack_leaves_a_whole_file() -> None:
    *found, last = killed("pack")
    old, new = (Path(name).read_bytes().hex() for name in ("old.brlpack", "new.brlpack"))
    for outcome in found:
        assert outcome["output"] in (old, new), outcome["how"]
        assert not outcome["ended"] or outcome["output"] == new
        # A file under another name is all that can be left: nobody takes it for a pack.
        assert all(name.startswith(".zoo.brlpack.") for name in outcome["remains"])
    assert {outcome["output"] for outcome in found} == {old, new}
    assert last["output"] == new
