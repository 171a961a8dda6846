"""Packs that Python packages carry: found by entry points, whatever else is installed."""

from __future__ import annotations

import sys
import zipfile
from importlib.machinery import ModuleSpec
from importlib.util import spec_from_file_location
from pathlib import Path

import pytest
from support.carriers import LEVEL, carry, write
from support.folders import babyrobot

import babyrobot_levels as brl
from babyrobot_levels.library.packs import (
    carried_packs,
    known_packs,
    package_folder,
    unusable_packs,
)
from babyrobot_levels.library.search_path import pack_places, places

pytestmark = pytest.mark.usefixtures("here")


def names() -> list[str]:
    return [pack.name for pack in known_packs()]


# -- where an import path leads --------------------------------------------------------------


def test_a_folder_inside_a_package_need_not_be_a_package(site: Path) -> None:
    carry(site, "brl_zoo", "zoo = brl_zoo.cages.big")
    write(site / "brl_zoo" / "cages" / "big" / "lion.yaml")
    assert package_folder("brl_zoo.cages.big") == site / "brl_zoo" / "cages" / "big"
    assert brl.load("zoo/lion").name == "lion"


def test_packages_are_not_run(site: Path) -> None:
    carry(site, "brl_torn.cages", "torn = brl_torn.cages", code="raise SystemExit('torn cable')\n")
    write(site / "brl_torn" / "cages" / "lion.yaml")
    assert brl.load("torn/lion").size == (4, 3)
    assert not [name for name in sys.modules if name.startswith("brl_torn")]


def test_a_namespace_that_lies_in_two_folders(
    site: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    other = tmp_path / "other"
    monkeypatch.syspath_prepend(str(other))
    for folder, name in ((site, "north"), (other, "south")):
        carry(folder, f"brl_poles.{name}", f"{name} = brl_poles.{name}", is_namespace=True)
        write(folder / "brl_poles" / name / "bear.yaml")
    assert package_folder("brl_poles.north") == site / "brl_poles" / "north"
    assert package_folder("brl_poles.south") == other / "brl_poles" / "south"
    assert brl.load("north/bear").size == brl.load("south/bear").size == (4, 3)


class EditableFinder:
    """Finds packages where their source is, as the finders of editable installs do."""

    def __init__(self, known: dict[str, Path]):
        self.known = known

    def find_spec(
        self, fullname: str, path: object = None, target: object = None
    ) -> ModuleSpec | None:
        if fullname not in self.known:
            return None
        return spec_from_file_location(fullname, self.known[fullname] / "__init__.py")


@pytest.mark.parametrize("module", ["brl_source", "brl_labs.source"])
def test_an_editable_install_that_hooks_into_imports(
    module: str, site: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    source = tmp_path / "checkout" / "src"
    write(source / "__init__.py", "raise SystemExit('run')\n")
    write(source / "inner" / "lion.yaml")
    carry(site, module, f"zoo = {module}.inner", is_there=False)
    monkeypatch.setattr(sys, "meta_path", [*sys.meta_path, EditableFinder({module: source})])
    assert brl.load("zoo/lion").name == "lion"
    assert package_folder(module) == source


@pytest.mark.parametrize(
    "value",
    [
        *("../..", "", "brl_zoo..cages", "brl_zoo\0", "sys", "os.path"),
        *("nowhere.to.be.found", "brl_zoo.lion", f"brl_zoo.{'x' * 5000}"),
    ],
)
def test_values_that_lead_to_no_folder(value: str, site: Path) -> None:
    carry(site, "brl_zoo", "zoo = brl_zoo")
    write(site / "brl_zoo" / "lion.py", "raise SystemExit('run')\n")
    assert package_folder(value) is None
    assert package_folder("brl_zoo") == site / "brl_zoo"


def test_a_finder_that_fails_stops_nobody_else(site: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    class Torn:
        @staticmethod
        def find_spec(fullname: str, *rest: object) -> None:
            if fullname.startswith("brl_nowhere"):
                raise RuntimeError("torn cable")

    monkeypatch.setattr(sys, "meta_path", [Torn(), *sys.meta_path])
    carry(site, "brl_zoo", "zoo = brl_zoo")
    assert package_folder("brl_nowhere.at.all") is None
    assert names() == ["zoo"]


@pytest.mark.slow
def test_asking_for_packs_leaves_gymnasiums_hook_alone(tmp_path: Path) -> None:
    from support.subprocesses import run

    carry(tmp_path, "brl_zoo", "zoo = gymnasium.envs")
    code = """
import babyrobot_levels as brl
from babyrobot_levels.library.packs import known_packs
list(known_packs())
import gymnasium
print(gymnasium.make("babyrobot/final-maze-v0").unwrapped.level.name)
"""
    assert run(code, tmp_path, tmp_path) == "final-maze\n"


# -- what else is installed ------------------------------------------------------------------


def test_an_archive_is_passed_over(site: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    archive = site / "zoo.zip"
    with zipfile.ZipFile(archive, "w") as file:
        file.writestr("brl_zipped/__init__.py", "")
        file.writestr("brl_zipped/lion.yaml", LEVEL)
        info = "brl_zipped-1.0.dist-info"
        file.writestr(f"{info}/METADATA", "Metadata-Version: 2.1\nName: brl-zipped\nVersion: 1.0\n")
        file.writestr(f"{info}/entry_points.txt", "[babyrobot_levels.packs]\nzoo = brl_zipped\n")
    monkeypatch.syspath_prepend(str(archive))
    assert [pack.name for pack in carried_packs()] == ["zoo"]
    assert names() == []
    assert list(unusable_packs()) == [
        "the pack 'zoo' of package brl-zipped 1.0 is left out: 'brl_zipped' is not a folder"
    ]
    assert brl.load("default").name == "default"


@pytest.mark.parametrize("text", ["[babyrobot_levels.packs]\nzoo\n", "\0"])
def test_a_damaged_package_stops_nobody_else(text: str, site: Path) -> None:
    write(site / "aaa-1.0.dist-info" / "entry_points.txt", text)
    write(site / "bbb-1.0.dist-info" / "METADATA", "")
    (site / "ccc-1.0.dist-info" / "entry_points.txt").mkdir(parents=True)
    (site / "ddd-1.0.dist-info").mkdir()
    (site / "ddd-1.0.dist-info" / "entry_points.txt").write_bytes(b"[babyrobot_levels.packs]\n\xff")
    carry(site, "brl_zoo", "zoo = brl_zoo")
    write(site / "brl_zoo" / "lion.yaml")
    assert brl.load("zoo/lion").size == (4, 3)
    assert names() == ["zoo"]


def test_a_package_without_metadata(site: Path) -> None:
    carry(site, "brl_zoo", "zoo = brl_zoo\nark = nowhere")
    (site / "brl_zoo-1.0.dist-info" / "METADATA").unlink()
    assert names() == ["zoo"]
    assert [pack.origin for pack in known_packs()] == ["package without a name"]
    assert len(list(unusable_packs())) == 1


def test_a_pack_of_a_package_is_removed_with_the_package(site: Path) -> None:
    carry(site, "brl_zoo", "zoo = brl_zoo")
    refused = babyrobot("uninstall", "zoo")
    assert (refused.status, refused.out) == (2, "")
    assert refused.err == (
        "error: zoo is part of the Python package brl_zoo\n  help: pip uninstall brl_zoo\n"
    )
    assert names() == ["zoo"]


@pytest.mark.parametrize("name", ["my zoo", "..", "zoo.cages", "动物园"])
def test_a_name_that_no_pack_can_have(name: str, site: Path) -> None:
    carry(site, "brl_zoo", f"{name} = brl_zoo\nark = brl_zoo")
    write(site / "brl_zoo" / "lion.yaml")
    assert names() == ["ark"]
    with pytest.raises(brl.LevelNotFoundError):
        brl.load(f"{name}/lion")
    (told,) = unusable_packs()
    assert told.startswith(f"the pack {name!r} of package brl_zoo 1.0 is left out: invalid name")


# -- packs of one name -----------------------------------------------------------------------


def test_the_users_pack_hides_the_one_of_a_package(site: Path, users_pack: Path) -> None:
    carry(site, "brl_zoo", "zoo = brl_zoo\nark = brl_zoo")
    write(site / "brl_zoo" / "ape.yaml")
    write(site / "brl_zoo" / "lion.yaml")
    write(users_pack / "lion.yaml", f"{LEVEL}title: mine\n")
    assert brl.load("zoo/lion").title == "mine"
    # The packs are not mixed: what is hidden is hidden whole.
    with pytest.raises(brl.LevelNotFoundError) as caught:
        brl.load("zoo/ape")
    assert caught.value.nearest == ("ark/ape",)
    assert brl.load("ark/ape").size == (4, 3)
    assert [(place.pack, place.folder) for place in pack_places()] == [
        ("zoo", users_pack),
        ("ark", site / "brl_zoo"),
    ]


def test_a_folder_is_a_pack_also_where_it_is_a_place_already(
    site: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    carry(site, "brl_zoo", "zoo = brl_zoo")
    write(site / "brl_zoo" / "lion.yaml")
    monkeypatch.setenv("BABYROBOT_LEVELS", str(site / "brl_zoo"))
    assert brl.load("lion").digest == brl.load("zoo/lion").digest
    assert [place.pack for place in places()].count("zoo") == 1
