"""`babyrobot edit`, run as a process: how it begins, and how it ends."""

from __future__ import annotations

import json
import os
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from urllib.request import Request, urlopen

import pytest
from support.subprocesses import HOME, python

TEXT = "version: 1\nsize: [3, 2]\nstart: [0, 0]\nexit: [2, 1]\n"


class Running:
    """A command that serves, with the address that it has printed."""

    def __init__(self, process: subprocess.Popen[str]) -> None:
        assert process.stdout
        self.process = process
        self.address = process.stdout.readline().strip()

    def ask(self, do: str, **fields: object) -> dict[str, object]:
        """Send a message, and return the reply."""
        data = json.dumps({"id": 1, "do": do, **fields}).encode()
        request = Request(f"{self.address}message", data, {"Content-Type": "application/json"})
        with urlopen(request, timeout=20) as response:
            reply = json.load(response)
        assert isinstance(reply, dict)
        return reply

    def told(self) -> str:
        """Return the next line of standard error."""
        assert self.process.stderr
        return self.process.stderr.readline()


@contextmanager
def editing(*arguments: str | Path, given: str | None = None, cwd: Path) -> Iterator[Running]:
    """Run the command; it is killed at the end if it has not ended."""
    process = subprocess.Popen(
        [sys.executable, "-m", "babyrobot_levels", "edit", *map(str, arguments), "--no-browser"],
        cwd=cwd,
        env={**os.environ, "PYTHONPATH": str(HOME)},
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert process.stdin
    if given is not None:
        process.stdin.write(given)
    process.stdin.close()
    try:
        yield Running(process)
    finally:
        process.kill()
        process.wait(20)
        for stream in (process.stdout, process.stderr):
            assert stream
            stream.close()


def test_a_file_is_changed_saved_and_closed_by_the_page(tmp_path: Path) -> None:
    file = tmp_path / "small.yaml"
    file.write_text(TEXT, "utf-8")
    with editing(file, cwd=tmp_path) as command:
        assert "small.yaml" in command.told()
        state = command.ask("state")["state"]
        assert isinstance(state, dict)
        reply = command.ask("text", text=TEXT + "max_steps: 9\n", revision=state["revision"])
        assert command.ask("quit")["unsaved"] is True
        state = reply["state"]
        assert isinstance(state, dict)
        command.ask("save", revision=state["revision"])
        assert file.read_text("utf-8") == TEXT + "max_steps: 9\n"
        command.ask("quit")
        assert command.process.wait(20) == 0


def test_standard_input_is_a_copy(tmp_path: Path) -> None:
    with editing("-", given=TEXT, cwd=tmp_path) as command:
        state = command.ask("state")["state"]
        assert isinstance(state, dict)
        assert (state["text"], state["path"]) == (TEXT, None)


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no such signal")
def test_ctrl_c_ends_it_but_tells_of_unsaved_changes_first(tmp_path: Path) -> None:
    with editing(tmp_path / "new.yaml", cwd=tmp_path) as command:
        assert "new.yaml" in command.told()
        command.ask("state")
        command.process.send_signal(signal.SIGINT)
        assert command.process.wait(20) == 130
    with editing(tmp_path / "new.yaml", cwd=tmp_path) as command:
        assert "new.yaml" in command.told()
        command.ask("text", text=TEXT, revision=1)
        command.process.send_signal(signal.SIGINT)
        assert "unsaved changes" in command.told()
        command.ask("state")
        command.process.send_signal(signal.SIGINT)
        assert command.process.wait(20) == 130
        assert command.process.stderr
        assert command.process.stderr.read() == ""
    assert [*tmp_path.iterdir()] == []


def test_a_port_in_use_is_said(tmp_path: Path) -> None:
    with socket.socket() as other:
        other.bind(("127.0.0.1", 0))
        other.listen()
        port = other.getsockname()[1]
        done = python("-m", "babyrobot_levels", "edit", "--port", str(port), cwd=tmp_path)
    assert done.returncode == 2
    assert done.stderr.startswith(f"error: port {port} cannot be used")
    assert "Traceback" not in done.stderr


@pytest.mark.parametrize("package", ["starlette", "uvicorn"])
def test_without_the_extra_it_says_how_to_get_it(tmp_path: Path, package: str) -> None:
    missing = f"raise ModuleNotFoundError('No module named {package}', name={package!r})\n"
    (tmp_path / f"{package}.py").write_text(missing, "utf-8")
    done = python("-m", "babyrobot_levels", "edit", cwd=tmp_path, path=tmp_path)
    assert done.returncode == 2
    assert "install the extra `editor`: pip install" in done.stderr
    assert len(done.stderr.splitlines()) == 2


@pytest.mark.parametrize(
    ("level", "status", "said"),
    [("no-such-level", 2, "no level called"), ("folder.yaml", 1, "directory")],
)
def test_what_cannot_be_opened_is_said(tmp_path: Path, level: str, status: int, said: str) -> None:
    (tmp_path / "folder.yaml").mkdir()
    done = python("-m", "babyrobot_levels", "edit", level, cwd=tmp_path)
    assert done.returncode == status
    assert said in done.stderr
    assert "Traceback" not in done.stderr


def test_a_site_needs_the_file_that_it_begins_with(tmp_path: Path) -> None:
    done = python("-m", "babyrobot_levels", "edit", "first.yml", "--site", "out", cwd=tmp_path)
    assert done.returncode == 2
    assert "first.yml does not exist" in done.stderr.replace("\n", "")
    assert [*tmp_path.iterdir()] == []
