"""ARCHITECTURE.md names the rooms that exist, in their order, and functions that exist."""

from __future__ import annotations

import re
import tomllib

from support.places import ROOT

TEXT = (ROOT / "ARCHITECTURE.md").read_text(encoding="utf-8")
PACKAGE = ROOT / "babyrobot_levels"
CALLS = [
    (path, name)
    for path, names in re.findall(
        r"^\| `(babyrobot_levels/[\w/]+\.py)` \| (`.*?`) \|", TEXT, re.MULTILINE
    )
    for name in re.findall(r"\w+", names)
]
CLASSES = re.findall(r"^\| `(\w+)` \| `(babyrobot_levels/[\w/]+\.py)` \|", TEXT, re.MULTILINE)
ROOMS = re.findall(
    r"^\| `(\w+)` \|", TEXT.partition("## The rooms")[2].partition("\n###")[0], re.MULTILINE
)


def test_the_rooms_are_those_of_the_package() -> None:
    folders = {path.name for path in PACKAGE.iterdir() if path.is_dir()} - {"__pycache__"}
    assert set(ROOMS) == folders
    assert len(ROOMS) == len(folders) == 16


def test_the_rooms_are_in_the_order_that_is_enforced() -> None:
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    contracts = settings["tool"]["importlinter"]["contracts"]
    layers = next(each["layers"] for each in contracts if each["type"] == "layers")
    enforced = [room for layer in reversed(layers) for room in layer.split(" | ")]
    assert [room for room in enforced if room in ROOMS] == ROOMS


def test_the_functions_of_the_route_and_the_classes_exist() -> None:
    assert len(CALLS) > 15
    assert len(CLASSES) == 4
    for path, name in (*CALLS, *((path, name) for name, path in CLASSES)):
        text = (ROOT / path).read_text(encoding="utf-8")
        assert re.search(rf"^ *(def|class) {name}\b", text, re.MULTILINE), name
