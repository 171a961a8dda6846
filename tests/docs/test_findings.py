"""The scripts of `findings/` have the form that CONTRIBUTING.md states. Nothing here runs them."""

from __future__ import annotations

import os
import re
from pathlib import Path

import pytest
from findings_page import FIELDS, FOLDER, head
from support.each import for_each
from support.places import ROOT

SCRIPTS = sorted(FOLDER.glob("*.sh"))


def code_of(path: Path) -> str:
    return re.sub(r"^#.*\n", "", path.read_text("utf-8"), flags=re.M)


def test_there_are_some_and_nothing_else() -> None:
    assert len(SCRIPTS) >= 12
    assert {*FOLDER.iterdir()} == {*SCRIPTS, FOLDER / "README.md"}


@for_each("path", SCRIPTS)
def test_its_head_says_all(path: Path) -> None:
    told = head(path)
    assert tuple(told) == ("", *FIELDS)
    assert all(text[0] != " " and len(text) > 5 for text in told.values())
    assert re.match(r"20\d\d-\d\d-\d\d, (Python 3|Node)", told["Tried"])


@for_each("path", SCRIPTS)
def test_it_works_in_a_folder_that_is_removed(path: Path) -> None:
    code = code_of(path)
    assert os.access(path, os.X_OK)
    assert path.read_text("utf-8").startswith("#!/usr/bin/env bash\n")
    start = [
        "set -euo pipefail",
        'folder="$(mktemp -d)"',
        "trap 'rm -rf \"$folder\"' EXIT",
        'cd "$folder"',
    ]
    assert code.splitlines()[: len(start)] == start
    assert re.search(r"\bassert\b|\bthrow\b|\bdiff\b", code)
    assert "expected" in code
    assert "seen" in code


@for_each("path", SCRIPTS)
def test_it_installs_the_versions_of_its_head_and_not_this_project(path: Path) -> None:
    told, code = head(path)["Packages"], code_of(path)
    lines = re.findall(r"^ *(?:venv/bin/pip|npm) install (.*)$", code, re.M)
    named = [each.strip('"') for line in lines for each in line.split() if each[0] != "-"]
    assert named
    for each in named:
        # Versions of a loop are named in the head, too.
        pin = re.fullmatch(r"([\w-]+)(?:==|@)(\d[\w.]*|\$version)", each)
        assert pin, each
        assert f"{pin[1]} {pin[2].removeprefix('$version')}" in told, each
    assert "babyrobot" not in code


@for_each("path", SCRIPTS)
def test_what_it_says_of_this_project_is_there(path: Path) -> None:
    told = head(path)["Here"]
    files = re.findall(r"\b(?:tests|docs|scripts|babyrobot_levels)/[\w/.-]+\w", told)
    assert files
    for file in files:
        assert (ROOT / file).exists(), file
    for name in re.findall(r"`(test_\w+)`", told):
        texts = [(ROOT / file).read_text("utf-8") for file in files if file.startswith("tests/")]
        assert any(f"def {name}(" in text for text in texts), name


def test_a_head_is_told_by_its_fields(tmp_path: Path) -> None:
    path = tmp_path / "some.sh"
    path.write_text(
        "#!/usr/bin/env bash\n# A title.\n#\n# Seen: this: and\n#   that.\nset -e\n# No head.\n"
    )
    assert head(path) == {"": "A title.", "Seen": "this: and that."}
    path.write_text("set -e\n")
    with pytest.raises(AssertionError):
        head(path)
