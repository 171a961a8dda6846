"""`babyrobot format` and the files: what is written, how, and what is left alone."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from support.sessions import Result, babyrobot, environment, run_there
from support.work import counted_calls

import babyrobot_levels as brl
from babyrobot_levels.text import files

pytestmark = pytest.mark.usefixtures("here")

UNTIDY = "size: [3,3]\nversion: 1 # one\n"
TIDY = "version: 1  # one\nsize: [3, 3]\n"


def write(name: str, text: str = UNTIDY) -> Path:
    path = Path(name)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(text.encode())
    return path


@pytest.mark.parametrize(
    ("code", "things"),
    [
        ("BR322", "items: [{name: key, at: [1, 0]}]\ndoors: [{at: [1, 1], side: E, needs: key}]\n"),
        ("BR323", "movers: [{path: [[1, 1], [2, 1]], back: true}]\n"),
    ],
)
def test_what_does_not_fit_the_walls_is_an_error(code: str, things: str) -> None:
    text = f"{UNTIDY}walls: [{{at: [1, 1], side: E}}]\n{things}"
    path = write("a.yaml", text)
    result = babyrobot("format", path)
    assert (result.status, path.read_text()) == (1, text)
    assert f"error {code}: " in result.out
    with pytest.raises(brl.LevelError, match=code):
        brl.format(text)


def test_files_below_the_usual_folder() -> None:
    paths = [write("levels/a.yaml"), write("levels/deep/b.yml")]
    others = [write("levels/themes/a.yaml", "widths:  {}\n"), write("levels/c.txt")]
    before = [path.read_bytes() for path in others]
    result = babyrobot("format")
    assert (result.status, result.out) == (0, "2 files reformatted\n")
    assert [path.read_text() for path in paths] == [TIDY, TIDY]
    assert [path.read_bytes() for path in others] == before


@pytest.mark.parametrize("option", ["--check", "--diff"])
def test_looking_writes_nothing(option: str) -> None:
    path = write("a.yaml")
    assert babyrobot("format", option, "a.yaml").status == 1
    assert path.read_text() == UNTIDY
    write("a.yaml", TIDY)
    assert babyrobot("format", option, "a.yaml").status == 0


def test_tidy_files_are_not_touched() -> None:
    path = write("a.yaml", TIDY)
    os.utime(path, (1, 1))
    assert babyrobot("format", "a.yaml").out == "1 file left unchanged\n"
    assert path.stat().st_mtime == 1


@pytest.mark.slow
def test_line_ends_stay() -> None:
    # And a byte order mark goes.
    path = write("a.yaml", "\ufeff" + UNTIDY.replace("\n", "\r\n"))
    babyrobot("format", "a.yaml")
    assert path.read_bytes() == TIDY.replace("\n", "\r\n").encode()
    assert babyrobot("format", "--check", "a.yaml").status == 0
    given = "\ufeffsize: [3,3]\r\ntitle: 迷路 🤖\r\nversion: 1\r\n".encode()
    variables = environment(Path.cwd(), PYTHONIOENCODING="ascii", PYTHONUTF8="0")
    done = run_there(["format", "-"], variables, given)
    assert done == Result("version: 1\r\ntitle: 迷路 🤖\r\nsize: [3, 3]\r\n", "", 0)


def test_what_is_left_as_it_is_is_said() -> None:
    path = write("a.yaml", "\ufeff%YAML 1.2\n---\nversion:   1\n")
    before = path.read_bytes()
    result = babyrobot("format", "a.yaml")
    assert result.status == 0
    assert result.out.startswith("left unchanged: a.yaml: ")
    assert result.out.endswith("\n1 file left unchanged\n")
    assert path.read_bytes() == before
    assert babyrobot("format", "--check", "a.yaml").status == 0


@pytest.mark.skipif(sys.platform == "win32", reason="needs links and permissions")
def test_links_and_permissions_stay() -> None:
    target = write("kept/real.yaml")
    target.chmod(0o640)
    link = Path("link.yaml")
    link.symlink_to(target)
    assert babyrobot("format", "link.yaml").status == 0
    assert link.is_symlink()
    assert target.read_text() == TIDY
    assert target.stat().st_mode & 0o777 == 0o640


def test_a_file_that_cannot_be_written_does_not_stop_the_others(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    first, second = write("a.yaml"), write("b.yaml")
    whole = files.write_bytes

    def failing(path: Path, data: bytes, **how: bool) -> None:
        if path == first:
            raise PermissionError(13, "Permission denied")
        whole(path, data, **how)

    monkeypatch.setattr(files, "write_bytes", failing)
    result = babyrobot("format", "a.yaml", "b.yaml")
    assert result.status == 2
    assert result.err == "error: a.yaml cannot be written (Permission denied)\n"
    assert result.out.endswith("1 file reformatted\n")
    assert (first.read_text(), second.read_text()) == (UNTIDY, TIDY)


@pytest.mark.slow
def test_the_same_whatever_the_jobs() -> None:
    names = [f"levels/{number:02}.yaml" for number in range(7)]
    outputs = []
    for jobs in ("1", "3"):
        for number, name in enumerate(names):
            write(name, f"size: [{number}, 2]\nversion: 1\n")
        outputs.append(babyrobot("format", "--jobs", jobs))
        assert Path(names[5]).read_text() == "version: 1\nsize: [5, 2]\n"
    assert outputs[0] == outputs[1]
    assert outputs[0].out.endswith("\n6 files reformatted, 1 file with errors\n")


# Not read, not parsed, not valid: which bytes these are is a matter of `validate`.
BYTES = {
    "binary": bytes(range(256)) * 20,
    "endless": b"a: &a [*a]",
    "number": b"version: " + b"9" * 10_000,
}


@pytest.mark.parametrize("name", BYTES)
def test_files_that_hold_no_level(name: str) -> None:
    path = Path("level.yaml")
    path.write_bytes(BYTES[name])
    other = write("other.yaml")
    result = babyrobot("format", "level.yaml", "other.yaml")
    assert result.status == 1
    assert result.out.startswith("level.yaml:")
    assert path.read_bytes() == BYTES[name]
    assert other.read_text() == TIDY
    shown = babyrobot("format", "-", given=BYTES[name])
    assert (shown.status, shown.out) == (1, "")
    assert shown.err.startswith("<stdin>:")


@pytest.mark.slow
def test_many_files_are_formatted_quickly() -> None:
    walls = "".join(f"- at: [{number}, 1]\n  side: E # {number}\n" for number in range(10))
    for number in range(200):
        write(f"levels/{number}.yaml", f"size: [20, 5]\nwalls:\n{walls}version: 1\n")
    with counted_calls() as work:
        result = babyrobot("format", "--jobs", "1")
    assert result.out == "200 files reformatted\n"
    # A thousand take about three seconds on a quiet machine.
    assert work.calls < 200 * 20_000, work


@pytest.mark.skipif(sys.platform == "win32", reason="such names are not allowed there")
@pytest.mark.parametrize("options", [(), ("--check",), ("--diff",)])
def test_nothing_can_steer_the_terminal(options: tuple[str, ...]) -> None:
    write("levels/\x1b[31m\r\n.yaml", UNTIDY.replace("one", "\u202e"))
    write("levels/b.yaml", "%YAML 1.2\n---\nversion: 1\n")
    result = babyrobot("format", *options)
    shown = result.out + result.err
    assert all(character.isprintable() or character == "\n" for character in shown)
    assert "\n.yaml" not in shown


KILLED = """
import os, signal, sys

whole, number = os.fsync, getattr(signal, sys.argv.pop(1))
os.fsync = lambda file: (os.kill(os.getpid(), number), whole(file))
from {module} import {function} as go
{call}
"""


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="needs signals")
@pytest.mark.parametrize("name", ["SIGINT", "SIGTERM", "SIGHUP"])
@pytest.mark.parametrize("is_command", [True, False])
def test_what_is_killed_leaves_no_temporary_files(name: str, is_command: bool) -> None:
    write("level.yaml")
    module, function, call = (
        ("babyrobot_levels.cli.app", "main", "go()")
        if is_command
        else ("babyrobot_levels", "load", "go('level.yaml').save('level.yaml')")
    )
    code = KILLED.format(module=module, function=function, call=call)
    done = subprocess.run(
        [sys.executable, "-c", code, name, "format", "level.yaml"],
        env={**os.environ, **environment(Path.cwd())},
        capture_output=True,
        check=False,
    )
    number = getattr(signal, name)
    assert done.returncode == (128 + number if is_command else -number)
    assert [path.name for path in Path().iterdir()] == ["level.yaml"]
    brl.load("level.yaml")
