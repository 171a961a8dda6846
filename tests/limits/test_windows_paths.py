"""Paths as Windows writes them: what they name, and what reports make of them."""

from __future__ import annotations

import dataclasses
import json
import os
import re
from pathlib import PureWindowsPath

import pytest

import babyrobot_levels as brl
from babyrobot_levels.library import catalogue
from babyrobot_levels.linter import reporters
from babyrobot_levels.text.diagnostics import Diagnostic
from babyrobot_levels.text.errors import LevelNotFoundError

PATHS = [
    ("levels\\a b\\x.yaml", "levels/a b/x.yaml", "levels/a%20b/x.yaml"),
    ("C:\\levels\\x.yaml", "C:/levels/x.yaml", "file:///C:/levels/x.yaml"),
    ("\\\\server\\share\\x.yaml", "//server/share/x.yaml", "file://server/share/x.yaml"),
    ("..\\x.yaml", "../x.yaml", "../x.yaml"),
]


class WindowsPath(PureWindowsPath):
    """A path on a machine of Windows on which there are no files."""

    def expanduser(self) -> WindowsPath:
        return self

    def stat(self) -> os.stat_result:
        raise FileNotFoundError

    def iterdir(self) -> list[WindowsPath]:
        raise FileNotFoundError


@pytest.mark.parametrize(
    "text",
    [*(path for path, *_ in PATHS), "C:\\levels\\x", "\\\\server\\share\\x", ".\\x", "C:/levels/x"],
)
def test_a_path_is_a_path(text: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(catalogue, "Path", WindowsPath)
    name = re.escape(repr(str(WindowsPath(text))))
    with pytest.raises(LevelNotFoundError, match=f"there is no file {name}"):
        brl.load(text)


@pytest.mark.parametrize("text", ["no-such-level", "no-such-pack/level", "CON"])
def test_a_name_is_a_name(text: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(catalogue, "Path", WindowsPath)
    with pytest.raises(LevelNotFoundError, match=f"no level called '{text}'"):
        brl.load(text)


# Python 3.14 deprecates it for paths of other systems.
@pytest.mark.filterwarnings("ignore:pathlib.PurePath.as_uri")
@pytest.mark.parametrize(("path", "posix", "uri"), PATHS, ids=[uri for *_, uri in PATHS])
def test_reports_write_slashes(
    path: str, posix: str, uri: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(reporters, "Path", PureWindowsPath)
    found = [at(path, each) for each in brl.validate("version: 1\nnonsense: 1\n")]

    def report(form: reporters.MachineFormat) -> str:
        return reporters.render(form, found, [path], {}, "")

    assert report("github").startswith(f"::error file={posix.replace(':', '%3A')},")
    assert f'<testcase name="{posix}"' in report("junit")
    (result,) = json.loads(report("sarif"))["runs"][0]["results"]
    place = result["locations"][0]["physicalLocation"]["artifactLocation"]
    assert place["uri"] == uri
    assert ("uriBaseId" in place) == (not uri.startswith("file:"))


def at(path: str, diagnostic: Diagnostic) -> Diagnostic:
    return dataclasses.replace(diagnostic, file=path)
