"""The command in a real process: in terminals and pipes, interrupted, and cut off."""

from __future__ import annotations

import os
import re
import signal
import struct
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest
from support.sessions import FILES, environment, run_here

from babyrobot_levels.library.catalogue import load
from babyrobot_levels.text.source import columns as columns_of

pty = pytest.importorskip("pty", reason="this system has no pseudo-terminals")
fcntl = pytest.importorskip("fcntl")
termios = pytest.importorskip("termios")

COMMAND = [sys.executable, "-m", "babyrobot_levels"]


def start(
    folder: Path,
    *arguments: str,
    stdin: int = subprocess.PIPE,
    stdout: Any = subprocess.PIPE,
    stderr: int = subprocess.PIPE,
    first: Callable[[], None] | None = None,
    variables: dict[str, str] | None = None,
) -> subprocess.Popen[bytes]:
    """Start the command; `first` is what the process does before it becomes the command."""
    return subprocess.Popen(
        [*COMMAND, *arguments],
        cwd=folder,
        env=environment(folder, TERM="xterm-256color") | (variables or {}),
        stdin=stdin,
        stdout=stdout,
        stderr=stderr,
        preexec_fn=first,
    )


def wait_until_it_rests(process: subprocess.Popen[bytes]) -> None:
    """Wait until a process has worked, and then has taken no time of the processor for a while."""
    stat, before = Path(f"/proc/{process.pid}/stat"), ""
    for _ in range(120):
        time.sleep(0.5 if stat.exists() else 1.5)
        used = " ".join(stat.read_text().split()[13:15]) if stat.exists() else "unknown"
        if used == before or used == "unknown":
            return
        before = used


def in_terminal(
    folder: Path, *arguments: str, columns: int = 80, **variables: Any
) -> tuple[str, int]:
    """Return what a terminal would be sent, and the exit status."""
    outer, inner = pty.openpty()
    fcntl.ioctl(inner, termios.TIOCSWINSZ, struct.pack("HHHH", 24, columns, 0, 0))
    process = start(folder, *arguments, stdin=inner, stdout=inner, stderr=inner,
                    variables=variables)  # fmt: skip
    os.close(inner)
    sent = rest_of(outer)
    return sent.decode().replace("\r\n", "\n"), process.wait(timeout=60)


def rest_of(outer: int) -> bytes:
    """Return what is still sent to a terminal, until it is closed at the other end."""
    sent = b""
    # Linux says by an error that the other end is closed.
    with suppress(OSError):
        while chunk := os.read(outer, 1 << 16):
            sent += chunk
    os.close(outer)
    return sent


def plain(text: str) -> str:
    return re.sub(r"\x1b\[[0-9;]*m", "", text)


def assert_ends_without_color(sent: str) -> None:
    for line in sent.splitlines():
        assert line.endswith("\x1b[0m") or "\x1b[" not in line.rpartition("\x1b[0m")[2]


def test_a_terminal_gets_colors_and_box_characters(tmp_path: Path) -> None:
    sent, status = in_terminal(tmp_path, "preview", "final-maze")
    assert status == 0
    assert "\x1b[" in sent
    assert "┌" in sent
    drawn, legend = plain(sent).replace("\r", "").split("\n\n")
    assert [len(line) for line in drawn.splitlines()] == [33] * 11
    assert [line.split()[0] for line in legend.splitlines()] == ["E", "∘", "◯", "S", "not"]
    assert_ends_without_color(sent)


def test_a_report_in_a_terminal_is_the_plain_one_in_color(tmp_path: Path) -> None:
    path = str(FILES / "bad.yaml")
    sent, status = in_terminal(tmp_path, "validate", path)
    without, same_status = in_terminal(tmp_path, "validate", path, NO_COLOR="1", FORCE_COLOR="1")
    assert status == same_status == 1
    assert sent != without == plain(sent)
    assert_ends_without_color(sent)


@pytest.mark.parametrize("variable", [{"NO_COLOR": "1"}, {"TERM": "dumb"}])
def test_a_terminal_without_color(tmp_path: Path, variable: dict[str, Any]) -> None:
    for arguments in (("preview", "maze"), ("list",)):
        assert "\x1b" not in in_terminal(tmp_path, *arguments, **variable)[0]


def test_a_terminal_that_knows_no_box_characters(tmp_path: Path) -> None:
    variables: dict[str, Any] = {"PYTHONUTF8": "0", "PYTHONIOENCODING": "ascii"}
    sent, status = in_terminal(tmp_path, "preview", "maze", **variables)
    assert (sent.startswith(load("maze").draw()), sent.isascii(), status) == (True, True, 0)


def test_a_png_is_not_thrown_at_a_terminal(tmp_path: Path) -> None:
    sent, status = in_terminal(tmp_path, "preview", "maze", "--format", "png")
    assert status == 2
    assert "-o FILE" in sent
    assert "PNG\r" not in sent


@pytest.mark.parametrize("arguments", [["list"], ["preview", "large"]], ids=str)
def test_a_reader_that_goes_early(tmp_path: Path, arguments: list[str]) -> None:
    (tmp_path / "levels").mkdir()
    level = "version: 1\nsize: [300, 300]\n"
    (tmp_path / "levels" / "large.yaml").write_text(level, encoding="utf-8")
    with start(tmp_path, *arguments, stdin=subprocess.DEVNULL) as process:
        assert process.stdout
        assert process.stderr
        process.stdout.read(1)
        process.stdout.close()
        assert process.stderr.read() == b""


@pytest.mark.parametrize("arguments", [["--help"], ["validate"]], ids=str)
def test_a_reader_that_was_never_there(tmp_path: Path, arguments: list[str]) -> None:
    (tmp_path / "levels").mkdir()
    (tmp_path / "levels" / "a.yaml").write_text("version: 1\n", encoding="utf-8")
    reading, writing = os.pipe()
    os.close(reading)
    process = start(tmp_path, *arguments, stdout=writing)
    os.close(writing)
    assert process.communicate(timeout=60)[1] == b""


def test_an_interrupt_ends_quietly(tmp_path: Path) -> None:
    process = start(tmp_path, "validate", "-")
    # It waits for its standard input: once it has loaded what it needs, it rests.
    wait_until_it_rests(process)
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=60)
    assert process.returncode == 130
    assert out == b""
    assert b"Traceback" not in err


_INTERRUPTED_IMPORT = """
import os, signal, sys
from babyrobot_levels.cli import app

module = sys.argv[1]

class Finder:
    def find_spec(self, name, path=None, target=None):
        if name == module:
            os.kill(os.getpid(), signal.SIGINT)

sys.meta_path.insert(0, Finder())
sys.argv[:2] = ["babyrobot"]
app.main()
"""


@pytest.mark.parametrize(
    "module",
    ["typer", "pydantic", "babyrobot_levels.cli.commands", "babyrobot_levels.linter.runner"],
)
def test_an_interrupt_during_imports_ends_quietly(tmp_path: Path, module: str) -> None:
    (tmp_path / "a.yaml").write_text("version: 1\n")
    done = subprocess.run(
        [sys.executable, "-c", _INTERRUPTED_IMPORT, module, "lint", "a.yaml"],
        cwd=tmp_path,
        env=environment(tmp_path),
        capture_output=True,
        timeout=60,
        check=False,
    )
    assert (done.returncode, done.stdout, done.stderr) == (130, b"", b"")


@pytest.mark.parametrize("milliseconds", [0, 300, 1000])
def test_an_interrupt_of_several_processes_ends_quietly(tmp_path: Path, milliseconds: int) -> None:
    for number in range(300):
        (tmp_path / f"{number}.yaml").write_text(f"version: 1\nmaze: {{seed: {number}}}\n")
    code = "from babyrobot_levels.cli import app; print('ready', flush=True); app.main()"
    process = subprocess.Popen(
        [sys.executable, "-c", code, "lint", "-j2", "."],
        cwd=tmp_path,
        env=environment(tmp_path),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        start_new_session=True,
    )
    assert process.stdout is not None
    assert process.stdout.readline() == b"ready\n"
    time.sleep(0.02 + milliseconds / 1000)
    os.killpg(process.pid, signal.SIGINT)
    _, err = process.communicate(timeout=60)
    assert (process.returncode, err) == (130, b"")


@pytest.mark.parametrize("columns", [30, 80, 200])
def test_the_list_fits_and_breaks_no_words(tmp_path: Path, columns: int) -> None:
    sent, _ = in_terminal(tmp_path, "list", columns=columns)
    whole = run_here(["list"], environment(tmp_path)).out
    heading, *rows = plain(sent).partition("suites:")[0].splitlines()
    assert set(heading.split()) <= {"NAME", "SIZE", "TITLE", "TAGS"}
    assert len(rows) == len(whole.splitlines()) - 1
    for row, line in zip(rows, whole.splitlines()[1:], strict=True):
        assert columns_of(row) <= columns
        words = row.replace(",", "").replace("…", "").split()
        assert words[0] == line.split()[0]
        assert set(words) <= set(line.replace(",", "").split())
    if columns == 200:
        # Where all are from the gallery, that is not repeated.
        assert [line.split() for line in whole.splitlines()] == [
            [*row.split(), "FROM" if row == heading else "gallery"] for row in (heading, *rows)
        ]


def test_the_list_tells_levels_apart(tmp_path: Path) -> None:
    (tmp_path / "levels").mkdir()
    (tmp_path / "levels" / "mine.yaml").write_text("version: 1\ntags: [own]\n", encoding="utf-8")
    narrow, wide = (plain(in_terminal(tmp_path, "list", columns=each)[0]) for each in (80, 120))
    assert re.search(r"\nfrozen-lake +4x4 +textbook, gymnasium, skid, drawn\n", narrow)
    assert re.search(r"\nfrozen-lake +4x4 +Frozen Lake +textbook, gymnasium, skid, drawn\n", wide)
    # Where levels are from several places, each is a heading.
    for sent in (narrow, wide):
        assert sent.count("gallery") == sent.count("\ngallery:\n") == 1
        assert re.search(r"\n\nlevels/:\nmine +3x3 +own\nsuites:", sent)


def test_facts_break_no_words(tmp_path: Path) -> None:
    for arguments in (("show", "final-maze"), ("show", "final-maze", "frozen-lake"), ("rule",)):
        whole = run_here([*arguments], environment(tmp_path)).out
        lines = plain(in_terminal(tmp_path, *arguments)[0]).splitlines()
        assert max(map(columns_of, lines)) <= 80
        words = {word for line in lines for word in line.split() if word.isascii()}
        assert words <= {*whole.split()}
    assert "\n               this is a level to solve.\n" in plain(
        in_terminal(tmp_path, "show", "final-maze")[0]
    )


@pytest.mark.parametrize(("columns", "color"), [(40, ""), (60, "1"), (200, "")])
def test_carets_stand_under_their_words(tmp_path: Path, columns: int, color: str) -> None:
    """Lines that are cut have an ellipsis where they go on, and are whole in files and pipes."""
    title = "迷路 \t" + 20 * "tall "
    text = f'{{version: 1, title: "{title}", walls: [{{at: [1, 0], side: Q, pass: 0.5}}]}}\n'
    (tmp_path / "long.yaml").write_text(text, encoding="utf-8")
    for command in (["validate", "long.yaml"], ["preview", "long.yaml"]):
        sent, _ = in_terminal(tmp_path, *command, columns=columns, NO_COLOR=color)
        lines = plain(sent).splitlines()
        [number] = (number for number, line in enumerate(lines) if line.strip(" |") == "^")
        shown, carets = lines[number - 1], lines[number]
        assert max(columns_of(shown), columns_of(carets)) <= columns
        assert columns_of(shown[: shown.index("Q")]) == carets.index("^")
        assert ("…" in shown) == (columns < 200)


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a device that is always full")
@pytest.mark.parametrize("arguments", [["--help"], ["preview", "maze"]], ids=str)
def test_a_full_disk(tmp_path: Path, arguments: list[str]) -> None:
    with Path("/dev/full").open("wb") as full:
        process = start(tmp_path, *arguments, stdout=full)
    _, err = process.communicate(timeout=60)
    assert process.returncode != 0
    assert b"No space left" in err
    assert b"Traceback" not in err


def closed(descriptor: int) -> Callable[[], None]:
    """Return what closes a stream before the command runs, as a shell's `>&-` does."""
    return lambda: os.close(descriptor)


@pytest.mark.parametrize("descriptor", [0, 1, 2])
@pytest.mark.parametrize("arguments", [["validate", "-"], ["preview", "nonsense"]], ids=str)
def test_streams_that_are_closed(tmp_path: Path, descriptor: int, arguments: list[str]) -> None:
    process = start(tmp_path, *arguments, first=closed(descriptor))
    _, err = process.communicate(b"version: 1\n", timeout=60)
    assert process.returncode in (0, 1, 2)
    assert b"Traceback" not in err


# -- pictures --------------------------------------------------------------------------------

ALL, PALETTE, SIXTEEN = "\x1b[38;2;", "\x1b[38;5;", None


@pytest.mark.parametrize(
    ("variables", "expected"),
    [
        ({"TERM": "xterm", "COLORTERM": "truecolor"}, ALL),
        ({"TERM": "screen-256color", "TERM_PROGRAM": "Apple_Terminal"}, PALETTE),
        ({"TERM": "xterm"}, SIXTEEN),
    ],
)
def test_colors_are_those_that_the_terminal_knows(
    tmp_path: Path, variables: dict[str, Any], expected: str | None
) -> None:
    sent, _ = in_terminal(tmp_path, "preview", "puddles", **variables)
    assert "┌" in sent
    found = {escape for escape in (ALL, PALETTE) if escape in sent}
    assert found == ({expected} if expected else set())
    assert re.search(r"\x1b\[(3|9)\d;(4|10)\dm", sent) or expected


def test_values_and_policy_are_in_the_picture(tmp_path: Path) -> None:
    truecolor: dict[str, Any] = {"COLORTERM": "truecolor"}
    for arguments in (["preview", "puddles", "--values", "--policy"], ["solve", "puddles"]):
        sent, status = in_terminal(tmp_path, *arguments, **truecolor)
        assert status == 0
        rows = [
            line for line in plain(sent).splitlines() if line.startswith("│") and "·" not in line
        ]
        assert rows[0].startswith("│S")
        assert len(rows) == 3
        assert rows[2].split()[-2:] == ["E", "│"]
        assert re.search(r"[∘◯][↑→↓←] *-\d", "".join(rows))
        # What would be read twice is not there.
        assert sent.count("-5") == "".join(rows).count("-5")


def test_values_with_things_are_in_the_picture(tmp_path: Path) -> None:
    """Not every configuration occurs in every cell: some have no value."""
    sent, status = in_terminal(tmp_path, "preview", "first-key", "--values", "--held", "key")
    assert status == 0
    assert "-3" in plain(sent)


@pytest.mark.parametrize(("columns", "is_whole"), [(80, False), (129, True), (257, True)])
def test_a_large_level_fits(tmp_path: Path, columns: int, is_whole: bool) -> None:
    text = "version: 1\nsize: [64, 64]\nmaze: {seed: 3}\nstart: [40, 30]\n"
    (tmp_path / "large.yaml").write_text(text, encoding="utf-8")
    sent, _ = in_terminal(tmp_path, "preview", "large.yaml", columns=columns)
    drawn, legend = plain(sent).replace("\r", "").split("\n\n")
    lines = drawn.splitlines()
    assert all(len(line) <= columns for line in [*lines, *legend.splitlines()])
    if columns == 257:
        assert len(lines) == 129
    elif is_whole:
        assert len(lines) == 65
        assert {*"".join(lines)} == {"▀"}
    else:
        assert len(lines) + 1 + len(legend.splitlines()) <= 22
        assert sum(line.count("S") for line in lines) == 1
        assert re.fullmatch(r"cells \[\d+, \d+\] to \[\d+, \d+\] of 64 x 64", lines[-1])


def test_arrows_of_a_large_level_are_seen_in_a_part_of_it(tmp_path: Path) -> None:
    text = "version: 1\nsize: [24, 3]\n"
    (tmp_path / "long.yaml").write_text(text, encoding="utf-8")
    sent, _ = in_terminal(tmp_path, "preview", "long.yaml", "--policy")
    assert "▀" not in sent
    assert "cells [0, 0] to [18, 2] of 24 x 3" in plain(sent).splitlines()
    assert "S→" in plain(sent)


def test_a_picture_that_takes_long_is_in_color_after_the_bar(tmp_path: Path) -> None:
    text = "version: 1\nsize: [90, 90]\nmaze: {seed: 1, loops: 0.5}\n"
    (tmp_path / "large.yaml").write_text(text, encoding="utf-8")
    sent, _ = in_terminal(tmp_path, "preview", "large.yaml", "--values", columns=200)
    before, _, after = sent.partition("▀")
    # No bar on a machine that is done within a second.
    assert "drawing" in before or re.fullmatch(r"(\x1b\[[\d;]*m)*", before)
    assert "drawing" not in after


def test_an_interrupt_while_a_picture_is_painted_leaves_no_file(tmp_path: Path) -> None:
    # It takes some seconds.
    text = "version: 1\nsize: [500, 500]\nmaze: {seed: 1}\n"
    (tmp_path / "large.yaml").write_text(text, encoding="utf-8")
    outer, inner = pty.openpty()
    process = start(tmp_path, "preview", "large.yaml", "-o", "large.png", stdin=inner, stdout=inner,
                    stderr=inner)  # fmt: skip
    os.close(inner)
    sent = b""
    while b"drawing" not in sent:
        sent += os.read(outer, 1 << 16)
    process.send_signal(signal.SIGINT)
    assert process.wait(timeout=60) == 130
    sent += rest_of(outer)
    assert b"Traceback" not in sent
    # The cursor is shown again.
    assert sent.rfind(b"\x1b[?25h") > sent.rfind(b"\x1b[?25l")
    assert [path.name for path in tmp_path.iterdir()] == ["large.yaml"]


def test_an_interrupt_while_a_bar_is_removed_shows_the_cursor_again() -> None:
    program = """
import signal, time
from rich.live import Live
from babyrobot_levels.cli.parallel import PATIENCE, working

stop = Live.stop

def interrupted(self):
    signal.raise_signal(signal.SIGINT)
    stop(self)

Live.stop = interrupted
try:
    with working("waiting"):
        time.sleep(PATIENCE + 1)
except KeyboardInterrupt:
    print("interrupted")
"""
    outer, inner = pty.openpty()
    process = subprocess.Popen([sys.executable, "-c", program], stdout=inner, stderr=inner)
    os.close(inner)
    sent = rest_of(outer)
    assert process.wait(timeout=60) == 0
    assert sent.endswith(b"interrupted\r\n")
    assert sent.rfind(b"\x1b[?25h") > sent.rfind(b"\x1b[?25l") >= 0


def test_an_interrupt_ends_the_show_of_an_episode_and_not_the_command(tmp_path: Path) -> None:
    outer, inner = pty.openpty()
    call = ("replay", str(FILES / "plays" / "ben.brlplay"), "--episode", "2")
    process = start(tmp_path, *call, stdin=inner, stdout=inner, stderr=inner)
    os.close(inner)
    sent = b""
    while b"step 1 " not in sent:
        sent += os.read(outer, 1 << 16)
    process.send_signal(signal.SIGINT)
    sent += rest_of(outer)
    assert process.wait(timeout=60) == 0
    assert "\N{BLACK SMILING FACE}".encode() in sent
    assert b"step 4 " not in sent
    assert sent.rstrip().endswith(b"yes")
