"""`--watch`: a report or picture at once, and another whenever something is saved."""

from __future__ import annotations

import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from support.sessions import environment, run_here

CLEAN = "1 file checked, clean\n"

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="Ctrl-C is sent as a signal")


class Watch:
    """The command as it watches, and what it has printed into a file."""

    def __init__(self, folder: Path, *arguments: str) -> None:
        self._path = folder / "printed.txt"
        with self._path.open("w", encoding="utf-8") as out:
            self.process = subprocess.Popen(
                [sys.executable, "-m", "babyrobot_levels", *arguments, "--watch"],
                cwd=folder,
                env=environment(folder),
                stdout=out,
                stderr=subprocess.STDOUT,
            )

    def until(self, begin: str, end: str = "") -> str:
        """Wait until it has printed what begins and ends so, and return all of it."""
        last = time.monotonic() + 30
        while not (self.printed.startswith(begin) and self.printed[len(begin) :].endswith(end)):
            assert time.monotonic() < last, f"not {begin!r} and {end!r}, but {self.printed!r}"
            assert self.process.poll() is None, self.printed
            time.sleep(0.05)
        return self.printed

    @property
    def printed(self) -> str:
        return self._path.read_text("utf-8")


@pytest.fixture
def watch(tmp_path: Path) -> Iterator[Watch]:
    (tmp_path / "levels").mkdir()
    (tmp_path / "levels" / "a.yaml").write_text("version: 1\n", encoding="utf-8")
    watch = Watch(tmp_path, "lint", "levels")
    yield watch
    watch.process.kill()
    watch.process.wait()


def save(path: Path, text: str) -> None:
    """Write a file at once: a look between its beginning and its end would be a look more."""
    new = path.with_suffix(".new")
    new.write_text(text, encoding="utf-8")
    new.replace(path)


@pytest.mark.slow
def test_every_save_is_answered(watch: Watch, tmp_path: Path) -> None:
    first, second = tmp_path / "levels" / "a.yaml", tmp_path / "levels" / "b.yaml"
    watch.until(CLEAN)
    save(first, "version: 1\nexit: [9, 9]\n")
    shown = Path("levels", "a.yaml")
    told = watch.until(f"{CLEAN}{shown}:2:7: error BR301: ", "\n1 error in 1 file\n")
    save(first, "version: 1\n")
    told = watch.until(told + CLEAN)
    save(second, "version: 1\n")
    told = watch.until(told, "\n1 warning in 1 of 2 files\n")
    second.unlink()
    told = watch.until(told + CLEAN)
    # Settings count from the next time on.
    save(tmp_path / "babyrobot.toml", '[lint]\nselect = ["no-description"]\n')
    save(first, "version: 1\ntitle: A level\n")
    told = watch.until(told, "\n1 info in 1 file\n")
    watch.process.send_signal(signal.SIGINT)
    assert watch.process.wait(timeout=30) == 130
    assert watch.printed == told


@pytest.mark.slow
def test_a_picture_is_drawn_again_whenever_its_level_is_saved(tmp_path: Path) -> None:
    (tmp_path / "levels").mkdir()
    path = tmp_path / "levels" / "a.yaml"
    save(path, "version: 1\n")
    watch = Watch(tmp_path, "preview", "levels/a.yaml", "-o", "a.svg")
    try:
        told = watch.until("wrote a.svg (198 × 198, ", ")\n")
        save(path, "version: 1\nsize: [0, 1]\n")
        told = watch.until(told + "1 error\n\nlevels/a.yaml:2:8: error BR205", "^\n")
        save(path, "version: 1\nsize: [4, 1]\n")
        told = watch.until(told + "wrote a.svg (262 × 70, ", ")\n")
    finally:
        watch.process.send_signal(signal.SIGINT)
        assert watch.process.wait(timeout=30) == 130
    assert "<svg" in (tmp_path / "a.svg").read_text("utf-8")


@pytest.mark.parametrize("arguments", [["-"], ["final-maze", "--format", "png"]], ids=str)
def test_what_cannot_be_watched(arguments: list[str], tmp_path: Path) -> None:
    result = run_here(["preview", *arguments, "--watch"], environment(tmp_path))
    assert result.status == 2
    assert result.err.startswith("error: --watch needs ")
