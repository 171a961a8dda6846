"""Installing, upgrading and removing: what is there afterwards, and what is never touched."""

from __future__ import annotations

import errno
import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from support.folders import babyrobot, write_files
from support.packs import level, packed, snapshot, users_files, zoo
from support.subprocesses import HOME

import babyrobot_levels as brl
from babyrobot_levels.extensions.packs import store
from babyrobot_levels.library.packs import fields, installed, packs
from babyrobot_levels.text.files import user_folder

pytestmark = pytest.mark.usefixtures("here")
needs_posix = pytest.mark.skipif(sys.platform == "win32", reason="needs what POSIX has")


def home() -> Path:
    return user_folder() / "packs"


def install(version: str, *options: str) -> str:
    """Install a version of the zoo, which must succeed, and return what is said."""
    result = babyrobot("install", packed(version), *options)
    assert (result.status, result.err) == (0, "")
    return result.out


def width() -> int:
    """Return how wide the installed bear is: each version's has another size."""
    return brl.load("zoo/bear").size[0]


# -- versions --------------------------------------------------------------------------------


def test_a_later_version_takes_the_place_of_an_earlier_one() -> None:
    assert install("1.9.0").startswith(
        "installed zoo 1.9.0: 2 levels, 1 suite, 1 theme\n  zoo/bear\n"
    )
    assert width() == 4
    assert install("2.0.0").startswith("replaced zoo 1.9.0 with 2.0.0: ")
    assert width() == 5
    # Numbers are compared, not letters.
    assert install("10.0.0").startswith("replaced zoo 2.0.0 with 10.0.0: ")
    (pack,) = packs()
    assert (pack.name, pack.version) == ("zoo", "10.0.0")
    # Of the others, nothing is left.
    assert sorted(path.name for path in (home() / "zoo").iterdir()) == [pack.folder.name, "current"]
    assert sorted(path.name for path in home().iterdir()) == ["zoo"]


def test_what_is_there_is_what_was_packed() -> None:
    install("1.0.0")
    (pack,) = packs()
    assert snapshot(pack.folder) == snapshot(Path("source-1.0.0"))
    told = fields(pack.folder)
    assert told is not None
    assert (told.name, told.version, told.description) == ("zoo", "1.0.0", "Animals.")


@needs_posix
def test_files_are_readable_for_whom_the_umask_lets() -> None:
    mask = os.umask(0o022)
    try:
        install("1.0.0")
    finally:
        os.umask(mask)
    for path in (home() / "zoo").rglob("*"):
        assert path.stat().st_mode & 0o777 == (0o755 if path.is_dir() else 0o644), path


def test_the_same_again_changes_nothing() -> None:
    install("1.0.0")
    before = users_files()
    assert install("1.0.0") == "zoo 1.0.0 is already installed\n"
    assert users_files() == before


def test_an_earlier_version_needs_force() -> None:
    install("2.0.0")
    before = users_files()
    refused = babyrobot("install", packed("1.0.0"))
    assert (refused.status, refused.out) == (2, "")
    assert "zoo 2.0.0 is installed, which is later than 1.0.0" in refused.err
    assert "--force" in refused.err
    assert users_files() == before
    assert install("1.0.0", "--force").startswith("replaced zoo 2.0.0 with 1.0.0: ")
    assert width() == 4


def test_another_pack_of_the_same_version_needs_force() -> None:
    install("1.0.0")
    other = packed("1.0.0", {**zoo("3.0.0"), "pack.yaml": zoo("1.0.0")["pack.yaml"]})
    refused = babyrobot("install", other)
    assert refused.status == 2
    assert "another zoo 1.0.0 is installed" in refused.err
    assert width() == 4
    assert "reinstalled zoo 1.0.0" in babyrobot("install", other, "--force").out
    assert width() == 6


def test_of_many_levels_the_first_are_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("babyrobot_levels.extensions.packs.commands.MAX_LISTED", 3)
    names = ["  zoo/bear", "  zoo/herd", "  zoo/lion"]
    assert install("1.0.0").splitlines()[1:] == names
    monkeypatch.setattr("babyrobot_levels.extensions.packs.commands.MAX_LISTED", 2)
    assert install("2.0.0").splitlines()[1:] == [*names[:2], "  and 1 more"]


def test_json_tells_what_happened() -> None:
    first = json.loads(install("1.0.0", "--format", "json"))
    again = json.loads(install("1.0.0", "--format", "json"))
    later = json.loads(install("2.0.0", "--format", "json"))
    assert [each["before"] for each in (first, again, later)] == [None, "1.0.0", "1.0.0"]
    assert [each["changed"] for each in (first, again, later)] == [True, False, True]
    assert Path(later["folder"]).is_dir()
    assert later["levels"][1] == {"name": "zoo/lion", "digest": brl.load("zoo/lion").digest}


# -- removing --------------------------------------------------------------------------------


def test_uninstalling_leaves_nothing_behind() -> None:
    install("1.0.0")
    result = babyrobot("uninstall", "zoo")
    assert (result.status, result.out) == (0, "uninstalled zoo 1.0.0\n")
    assert users_files() == {}
    with pytest.raises(brl.LevelNotFoundError):
        brl.load("zoo/lion")
    again = babyrobot("uninstall", "zoo")
    assert (again.status, again.out) == (2, "")


@pytest.mark.parametrize("name", ["Zoo", "zoo/", "..", "", "x\0"])
def test_only_the_name_of_a_pack_removes_it(name: str) -> None:
    install("1.0.0")
    before = users_files()
    result = babyrobot("uninstall", name)
    assert (result.status, result.out) == (2, "")
    assert "no pack named" in result.err
    assert ("did you mean 'zoo'?" in result.err) == (name in ("Zoo", "zoo/"))
    assert users_files() == before


# -- folders that were put there by hand -----------------------------------------------------


def by_hand() -> Path:
    return write_files(home() / "zoo", {"lion.yaml": "version: 1\nsize: [7, 7]\n"})


def test_a_folder_put_there_by_hand_is_a_pack_and_is_left_alone() -> None:
    folder = by_hand()
    (pack,) = packs()
    assert (pack.name, pack.folder, pack.version) == ("zoo", folder, None)
    before = users_files()
    archive = packed()
    for call in (["install", archive], ["install", archive, "--force"], ["uninstall", "zoo"]):
        result = babyrobot(*call)
        assert (result.status, result.out) == (2, "")
        assert "by hand" in result.err
        assert users_files() == before
    assert brl.load("zoo/lion").size == (7, 7)


@needs_posix
def test_a_link_put_there_by_hand_is_not_followed(tmp_path: Path) -> None:
    archive = packed()
    babyrobot("install", archive)
    (home() / "zoo").rename(tmp_path / "elsewhere")
    (home() / "zoo").symlink_to(tmp_path / "elsewhere")
    before = snapshot(tmp_path / "elsewhere")
    for call in (["install", archive, "--force"], ["uninstall", "zoo"]):
        assert babyrobot(*call).status == 2
    assert snapshot(tmp_path / "elsewhere") == before
    assert (home() / "zoo").is_symlink()


@pytest.mark.slow
@needs_posix
def test_a_lock_that_is_a_link_is_refused(tmp_path: Path) -> None:
    archive = packed()
    home().mkdir(parents=True)
    (home() / ".lock").symlink_to(tmp_path / "nowhere" / "lock")
    # In a process of its own: who waits for such a lock waits for ever.
    done = subprocess.run(
        [sys.executable, "-m", "babyrobot_levels", "install", archive],
        env={**os.environ, "PYTHONPATH": str(HOME)},
        capture_output=True,
        text=True,
        timeout=30,
        check=False,
    )
    assert (done.returncode, done.stdout) == (2, "")
    assert str(home() / ".lock") in done.stderr


# -- what `current` says ---------------------------------------------------------------------


@pytest.mark.parametrize(
    "line", [b"", b"../ark\n", b"1.0.0-0123456789ab\n", b"other\n", b"\xff\xfe\n", b"x" * 100_000]
)
def test_current_is_not_believed(line: bytes) -> None:
    install("1.0.0")
    (home() / "zoo" / "other").mkdir()
    (home() / "zoo" / "current").write_bytes(line)
    assert list(packs()) == []
    with pytest.raises(brl.LevelNotFoundError):
        brl.load("zoo/lion")
    # It is mended by installing the pack once more, and can be removed.
    assert install("1.0.0").startswith("installed zoo 1.0.0: ")
    assert width() == 4
    (home() / "zoo" / "current").write_bytes(line)
    assert babyrobot("uninstall", "zoo").status == 0
    assert users_files() == {}


@needs_posix
def test_current_is_no_link_and_names_none(tmp_path: Path) -> None:
    install("1.0.0")
    (pack,) = packs()
    (home() / "zoo" / "current").rename(tmp_path / "current")
    (home() / "zoo" / "current").symlink_to(tmp_path / "current")
    assert installed("zoo") is None
    (home() / "zoo" / "current").unlink()
    (tmp_path / "current").rename(home() / "zoo" / "current")
    assert installed("zoo") == pack
    pack.folder.rename(tmp_path / "elsewhere")
    pack.folder.symlink_to(tmp_path / "elsewhere")
    assert installed("zoo") is None


# -- what interrupted calls leave ------------------------------------------------------------


def test_remains_are_not_seen_and_are_swept() -> None:
    install("1.0.0")
    remains = {
        ".part-abc/zoo/3.0.0-0123456789ab/lion.yaml": "version: 1\n",
        ".part-abc/zoo/current": "3.0.0-0123456789ab\n",
        ".lock": "",
        "zoo/3.0.0-0123456789ab/levels/bear.yaml": "version: 1\n",
        "zoo/.current.x1y2z3": "3.0.0",
    }
    write_files(home(), remains)
    assert [pack.version for pack in packs()] == ["1.0.0"]
    assert width() == 4
    install("2.0.0")
    assert sorted(path.name for path in home().iterdir()) == ["zoo"]
    assert len(list((home() / "zoo").iterdir())) == 2


def test_what_is_not_ours_is_not_swept() -> None:
    mine = {
        "zoo/notes.txt": "x",
        "zoo/.hidden": "x",
        "ark/1.0.0-0123456789ab/x.yaml": "",
        ".git/x": "",
    }
    install("1.0.0")
    write_files(home(), mine)
    install("2.0.0")
    assert {name for name in mine if (home() / name).exists()} == set(mine)


def test_a_folder_that_cannot_be_made() -> None:
    # Permissions do not stop everybody who runs tests; a file in the way does.
    user_folder().parent.mkdir(parents=True)
    user_folder().write_text("mine", "utf-8")
    result = babyrobot("install", packed())
    assert (result.status, result.out) == (2, "")
    assert str(user_folder()) in result.err
    assert user_folder().read_text("utf-8") == "mine"


def test_a_full_disk_is_told_and_leaves_the_old_pack(monkeypatch: pytest.MonkeyPatch) -> None:
    install("1.0.0")
    before = users_files()
    later = packed("2.0.0")

    def fail(path: Path) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(store, "_sync", fail)
    result = babyrobot("install", later)
    assert (result.status, result.out) == (2, "")
    assert result.err == f"error: {later} was not installed: No space left on device\n"
    assert users_files() == before


@needs_posix
@pytest.mark.parametrize("before", [None, "1.0.0"])
def test_the_disk_has_the_whole_pack_before_it_is_found(
    before: str | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A killed call loses nothing that it wrote; a machine that crashes may, until it is synced."""
    if before is not None:
        install(before)
    later = packed("2.0.0")
    disk = Disk()
    monkeypatch.setattr(os, "fsync", disk.sync)
    monkeypatch.setattr(os, "rename", disk.moving(os.rename))
    monkeypatch.setattr(os, "replace", disk.moving(os.replace))
    assert babyrobot("install", later).status == 0
    (pack,) = packs()
    assert disk.found == (["zoo"] if before is None else [pack.folder.name, "current"])
    assert disk.unsure() == []
    # With another pack, there still is a folder of packs afterwards.
    write_files(home(), {"ark/dove.yaml": level()})
    assert babyrobot("uninstall", "zoo").status == 0
    assert disk.unsure() == []


class Disk:
    """What a disk has for sure: files and folders as they were when somebody waited for it.

    Attributes:
        found: what was put where readers look, in this order.
    """

    def __init__(self) -> None:
        self.found: list[str] = []
        self._has: set[int] = set()
        self._changed: set[Path] = set()

    def sync(self, descriptor: int) -> None:
        """Wait for the disk."""
        self._has.add(os.fstat(descriptor).st_ino)

    def unsure(self, *places: Path) -> list[Path]:
        """Return which files and folders it may not have as they are now."""
        changed = [place for place in self._changed if place.exists()]
        return [place for place in places or changed if place.stat().st_ino not in self._has]

    def moving(self, move: Callable[[Path, Path], None]) -> Callable[[Path, Path], None]:
        """Return a way to move that first looks whether all is there that will be found then."""

        def moved(source: Path, target: Path) -> None:
            if ".part-" not in str(target):
                self.found.append(target.name)
                needed = [source, *source.rglob("*")]
                if target.name == "current":
                    named = target.parent / source.read_text("ascii").strip()
                    needed += [target.parent, named, *named.rglob("*")]
                assert self.unsure(*needed) == []
            move(source, target)
            changed = {source.parent, target.parent}
            self._has -= {folder.stat().st_ino for folder in changed}
            self._changed |= {folder for folder in changed if ".part-" not in str(folder)}

        return moved


# -- several at once -------------------------------------------------------------------------


@pytest.mark.slow
def test_calls_at_once_do_not_break_one_another() -> None:
    archives = [packed(f"{number}.0.0") for number in range(1, 5)]
    code = (
        "import sys; from pathlib import Path\n"
        "from babyrobot_levels.extensions.packs import archive, store\n"
        "from babyrobot_levels.extensions.packs.archive import PackNotFoundError\n"
        "for round in range(6):\n"
        "    if sys.argv[1] == 'uninstall':\n"
        "        try: store.uninstall('zoo')\n"
        "        except PackNotFoundError: pass\n"
        "    else:\n"
        "        store.install(archive.read_archive(Path(sys.argv[1])), force=True)\n"
    )
    calls = [
        subprocess.Popen(
            [sys.executable, "-c", code, word],
            env={**os.environ, "PYTHONPATH": str(HOME)},
            stderr=subprocess.PIPE,
        )
        for word in [*map(str, archives), "uninstall"]
    ]
    for call in calls:
        _, errors = call.communicate(timeout=120)
        assert (call.returncode, errors) == (0, b"")
    install("9.0.0")
    assert width() == 12
    assert sorted(path.name for path in home().iterdir()) == ["zoo"]
    assert len(list((home() / "zoo").iterdir())) == 2
