"""Ctrl-C while a file is being written: the file is whole, and nothing else is left."""

from __future__ import annotations

import signal
import threading
from pathlib import Path
from typing import Any

import pytest

from babyrobot_levels.text.files import write_text


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
