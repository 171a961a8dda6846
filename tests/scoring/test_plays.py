"""Files of plays: what is written is read again, and what is damaged is refused with its line."""

from __future__ import annotations

import io
import json
import zlib
from pathlib import Path
from typing import Any

import pytest
from support.plays import line_of, record, recorded

import babyrobot_levels as brl
from babyrobot_levels.language import play as play_format
from babyrobot_levels.scoring import plays as files


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "ada.brlplay"


def refusal(path: Path) -> str:
    with pytest.raises(brl.PlayError) as caught:
        brl.read_plays(path)
    message = str(caught.value)
    assert "\n" not in message
    return message.removeprefix(f"{path}:")


def test_a_line_is_a_play(path: Path) -> None:
    record(path, "frozen-lake", episodes=3)
    plays = brl.read_plays(path)
    assert [play.seed for play in plays] == ["0", "1", "2"]
    lines = path.read_bytes().splitlines()
    assert [play.to_line().encode() for play in plays] == lines
    data = json.loads(lines[0])
    assert data["name"] == "frozen-lake"
    assert plays[0].level.digest == brl.load("frozen-lake").digest
    assert plays[0].steps == len(data["actions"]) == len(data["states"]) - 1
    assert repr(plays[0]).startswith("<Play of 'frozen-lake': ")


def test_no_byte_of_a_line_can_be_changed_unnoticed(path: Path) -> None:
    record(path, "frozen-lake")
    line = path.read_bytes()
    for place in range(len(line) - 1):
        changed = bytearray(line)
        changed[place] ^= 1
        with pytest.raises(brl.PlayError):
            brl.Play.from_line(bytes(changed))
        with pytest.raises(brl.PlayError):
            brl.Play.from_line(line[:place])


def test_plays_are_appended(path: Path) -> None:
    record(path, "frozen-lake")
    before = path.read_bytes()
    record(path, "frozen-lake", seed=5)
    assert path.read_bytes().startswith(before)
    assert len(brl.read_plays(path)) == 2


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda line: line[:-20], "the line is cut off"),
        (lambda line: line.replace(b'"hints":0', b'"hints":1'), "its checksum is wrong"),
        (lambda line: b"hello\n", "is no play"),
        (lambda line: line_of({"format": "a song"}), "JSON, but no play"),
        (lambda line: line_of({**json.loads(line), "format_version": 2}), "a newer one may read"),
        (lambda line: line_of({**json.loads(line), "extra": 1}), "invalid at 'extra'"),
        (lambda line: line_of({**json.loads(line), "actions": [7]}), "invalid at 'actions/0'"),
        (lambda line: line_of({**json.loads(line), "rewards": [1.0]}), "need as many rewards"),
        (
            lambda line: line_of({**json.loads(line), "return": float("nan")}),
            "the line is not JSON",
        ),
        (lambda line: deep(), "the line is not JSON"),
    ],
)
def test_a_line_that_is_no_play_is_refused(path: Path, change: Any, message: str) -> None:
    record(path, "frozen-lake", episodes=2)
    first, second = path.read_bytes().splitlines(keepends=True)
    path.write_bytes(first + change(second))
    assert refusal(path).startswith("2: ")
    assert message in refusal(path)


def deep() -> bytes:
    """Return a line of arrays in arrays."""
    body = b'{"x":' + b"[" * 100_000
    return body + f',"checksum":"{zlib.crc32(body):08x}"}}\n'.encode()


def test_files_are_bounded(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    record(path, "frozen-lake", episodes=3)
    monkeypatch.setattr(files, "MAX_PLAYS", 2)
    assert refusal(path) == "3: the file has more than 2 plays"
    monkeypatch.setattr(files, "MAX_BYTES", 100)
    assert "is larger than" in refusal(path)
    path.write_bytes(b"")
    assert "the file is empty" in refusal(path)


def test_a_line_without_end_is_not_read_whole(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(files, "MAX_LINE", 1000)
    monkeypatch.setattr(play_format, "MAX_LINE", 1000)
    path.write_bytes(b"x" * 5000)
    assert refusal(path) == "1: the line is longer than 1,000 bytes"


def test_ten_million_lines_are_refused_at_the_first(path: Path) -> None:
    path.write_bytes(b"\n" * 10_000_000)
    assert refusal(path).startswith("1: ")


def test_half_a_line_is_told_before_anything_is_recorded(path: Path) -> None:
    record(path, "frozen-lake", episodes=2)
    half = path.read_bytes()[:-30]
    path.write_bytes(half)
    with pytest.raises(brl.PlayError, match="the last line is cut off; remove it"):
        brl.RecordPlay(brl.load("frozen-lake").make(), path)
    assert path.read_bytes() == half


def test_a_disk_that_is_full_leaves_no_half_line(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    play = recorded(path.parent, "frozen-lake")
    files.append_play(path, play)
    before = path.read_bytes()
    written: list[int] = []

    class Full(io.FileIO):
        def write(self, data: Any) -> int:
            if written:
                raise OSError(28, "No space left on device")
            written.append(super().write(bytes(data)[:10]))
            return 10

    with monkeypatch.context() as patches:
        patches.setattr(Path, "open", lambda self, *_, **__: Full(str(self), "a+"))
        with pytest.raises(OSError, match="No space"):
            files.append_play(path, play)
    assert written == [10]
    assert path.read_bytes() == before
