"""Writing files: a file is whole, old or new, whatever happens, and nothing else is left."""

from __future__ import annotations

import errno
import os
import signal
import stat
import sys
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from babyrobot_levels.text.files import write_text, written_folder


def test_ctrl_c_waits_until_the_file_is_whole(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    replace = Path.replace

    def pressed(self: Path, target: Any) -> Path:
        signal.raise_signal(signal.SIGINT)
        return replace(self, target)

    monkeypatch.setattr(Path, "replace", pressed)
    before = signal.getsignal(signal.SIGINT)
    with pytest.raises(KeyboardInterrupt):
        write_text(tmp_path / "a.txt", "whole")
    assert [path.name for path in tmp_path.iterdir()] == ["a.txt"]
    assert (tmp_path / "a.txt").read_text("utf-8") == "whole"
    assert signal.getsignal(signal.SIGINT) is before


def test_other_threads_write_too(tmp_path: Path) -> None:
    thread = threading.Thread(target=write_text, args=(tmp_path / "a.txt", "whole"))
    thread.start()
    thread.join()
    assert (tmp_path / "a.txt").read_text("utf-8") == "whole"


def test_writing_makes_folders_and_replaces_files(tmp_path: Path) -> None:
    path = tmp_path / "a" / "b" / "level.yaml"
    write_text(path, "one\n")
    write_text(path, "zwölf\r\n")
    assert path.read_bytes() == "zwölf\r\n".encode()
    assert [p.name for p in path.parent.iterdir()] == ["level.yaml"]


@pytest.mark.parametrize("broken", ["replace", "fsync", "chmod"])
def test_a_failing_write_leaves_the_old_file_and_no_other(
    broken: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "level.yaml"
    path.write_text("old\n")

    def fail(*_: object, **__: object) -> None:
        raise OSError("the disk is full")

    monkeypatch.setattr(os, broken, fail)
    with pytest.raises(OSError, match="full"):
        write_text(path, "new\n")
    assert path.read_text() == "old\n"
    assert [p.name for p in tmp_path.iterdir()] == ["level.yaml"]


def test_a_text_that_cannot_be_encoded_leaves_the_old_file(tmp_path: Path) -> None:
    path = tmp_path / "level.yaml"
    path.write_text("old\n")
    with pytest.raises(UnicodeEncodeError):
        write_text(path, "\ud800")
    assert path.read_text() == "old\n"
    assert [p.name for p in tmp_path.iterdir()] == ["level.yaml"]


@pytest.mark.skipif(os.name == "nt", reason="paths are short there")
def test_a_name_may_be_as_long_as_names_can_be(tmp_path: Path) -> None:
    path = tmp_path / f"{'x' * 250}.yaml"
    write_text(path, "new\n")
    assert path.read_text() == "new\n"


def test_on_windows_a_file_that_may_not_be_written_stays_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """There, a file without the permission to write can be neither replaced nor taken away."""

    def is_kept(path: Path) -> bool:
        return path.exists() and not path.stat().st_mode & stat.S_IWUSR

    replace, unlink = Path.replace, Path.unlink

    def replacing(path: Path, target: Path) -> Path:
        if is_kept(target):
            raise PermissionError(13, "Access is denied")
        return replace(path, target)

    def unlinking(path: Path, missing_ok: bool = False) -> None:
        if is_kept(path):
            raise PermissionError(13, "Access is denied")
        unlink(path, missing_ok)

    path = tmp_path / "level.yaml"
    path.write_text("old\n")
    path.chmod(0o444)
    monkeypatch.setattr(sys, "platform", "win32")
    monkeypatch.setattr(Path, "replace", replacing)
    monkeypatch.setattr(Path, "unlink", unlinking)
    with pytest.raises(PermissionError):
        write_text(path, "new\n")
    assert path.read_text() == "old\n"
    assert [p.name for p in tmp_path.iterdir()] == ["level.yaml"]


@pytest.mark.skipif(os.name == "nt", reason="permissions of POSIX")
def test_permissions_are_kept(tmp_path: Path) -> None:
    path = tmp_path / "level.yaml"
    path.write_text("old\n")
    path.chmod(0o640)
    write_text(path, "new\n")
    assert stat.S_IMODE(path.stat().st_mode) == 0o640
    mask = os.umask(0o027)
    try:
        write_text(tmp_path / "fresh.yaml", "new\n")
    finally:
        os.umask(mask)
    assert stat.S_IMODE((tmp_path / "fresh.yaml").stat().st_mode) == 0o640


@pytest.mark.skipif(os.name == "nt", reason="links of POSIX")
def test_writing_through_a_link_keeps_the_link(tmp_path: Path) -> None:
    (tmp_path / "real.yaml").write_text("old\n")
    (tmp_path / "link.yaml").symlink_to("real.yaml")
    write_text(tmp_path / "link.yaml", "new\n")
    assert (tmp_path / "link.yaml").is_symlink()
    assert (tmp_path / "real.yaml").read_text() == "new\n"


# -- folders -----------------------------------------------------------------------------------

forks = pytest.mark.skipif(sys.platform == "win32", reason="Windows does not fork")


def make(path: Path, text: str, then: Callable[[], object] = bool) -> None:
    with written_folder(path) as new:
        (new / "a.txt").write_text(text, "utf-8")
        then()


def killed(call: Callable[[], object]) -> None:
    """Run a call in a process that it kills."""
    child = os.fork()
    if child == 0:
        call()
        os._exit(0)
    assert os.waitpid(child, 0)[1] == signal.SIGKILL


def kill() -> None:
    os.kill(os.getpid(), signal.SIGKILL)


@forks
def test_what_a_killed_process_has_left_is_removed_by_the_next(tmp_path: Path) -> None:
    site = tmp_path / "site"
    make(site, "one")
    (tmp_path / ".site.mine1234").mkdir()
    for _ in range(2):
        killed(lambda: make(site, "two", kill))
    assert len([*tmp_path.iterdir()]) == 3
    assert (site / "a.txt").read_text("utf-8") == "one"
    make(site, "three")
    assert {each.name for each in tmp_path.iterdir()} == {"site", ".site.mine1234"}
    assert (site / "a.txt").read_text("utf-8") == "three"


@forks
def test_a_folder_comes_back_whose_replacement_was_killed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    site, rename = tmp_path / "site", Path.rename

    def once(self: Path, target: Any) -> None:
        rename(self, target)
        kill()

    make(site, "one")
    with monkeypatch.context() as patched:
        patched.setattr(Path, "rename", once)
        killed(lambda: make(site, "two"))
    assert not site.exists()
    with pytest.raises(ZeroDivisionError):
        make(site, "three", lambda: 1 / 0)
    assert [each.name for each in tmp_path.iterdir()] == ["site"]
    assert (site / "a.txt").read_text("utf-8") == "one"


@forks
def test_what_another_process_writes_stays(tmp_path: Path) -> None:
    site = tmp_path / "site"
    with written_folder(site) as new:
        (new / "a.txt").write_text("one", "utf-8")
        child = os.fork()
        if child == 0:
            make(site, "two")
            os._exit(0)
        assert os.waitpid(child, 0)[1] == 0
        assert (site / "a.txt").read_text("utf-8") == "two"
    assert (site / "a.txt").read_text("utf-8") == "one"
    assert [each.name for each in tmp_path.iterdir()] == ["site"]


def test_errors_of_writing_a_folder_name_it_or_the_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    missing = errno.ENOENT, "no such file"
    errors: tuple[tuple[Callable[[Path], OSError], str], ...] = (
        (lambda new: OSError(errno.ENOSPC, "No space left on device"), "site"),
        (lambda new: FileNotFoundError(*missing, str(new / "b" / "c")), "b/c"),
        (lambda new: FileNotFoundError(*missing, "other"), "other"),
    )
    for then, name in errors:
        with (
            pytest.raises(OSError, match=r"such|space") as told,
            written_folder(Path("site")) as new,
        ):
            raise then(new)
        expected = Path(name) if name in ("site", "other") else Path("site", name)
        assert told.value.filename == str(expected)
        assert [*tmp_path.iterdir()] == []
