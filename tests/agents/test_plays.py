"""Plays: what is recorded and written is read again, and what is damaged is refused."""

from __future__ import annotations

import io
import json
import zlib
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from support.plays import line_of, record, recorded

import babyrobot_levels as brl
from babyrobot_levels.agents import plays as files
from babyrobot_levels.agents.verify import verify_play
from babyrobot_levels.language import play as play_format


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
        (lambda line: line_of({**json.loads(line), "actions": [625]}), "invalid at 'actions/0'"),
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


# -- recording -------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("level", "actions"),
    [
        ("frozen-lake", "all"),
        ("frozen-lake", "moves"),
        ("first-key", "turns"),
        ("treasure-chests", "valid"),
        ("random-maze", "valid_moves"),
    ],
)
def test_what_is_recorded_is_valid(path: Path, level: str, actions: str) -> None:
    record(path, level, actions, episodes=3)
    plays = brl.read_plays(path)
    assert len(plays) == 3
    for play in plays:
        assert verify_play(play).fault is None
        assert play.action_set == {"valid": "all", "valid_moves": "moves"}.get(actions, actions)


def test_the_seed_gives_the_same_episode(path: Path) -> None:
    record(path, "frozen-lake", seed=4)
    (play,) = brl.read_plays(path)
    assert play.seed == "4"
    env = play.level.make()
    env.reset(seed=4)
    rewards = [env.step(action)[1] for action in play.actions]
    assert rewards == play.rewards


def test_a_suite_records_the_level_of_each_episode(path: Path) -> None:
    env = brl.RecordPlay(gymnasium.make("babyrobot/Suite-v0", suite="classics"), path)
    for seed in range(4):
        env.reset(seed=seed)
        env.step(0)
    env.close()
    plays = brl.read_plays(path)
    assert len({play.digest for play in plays}) > 1
    # The seed gave the level, too: in the level alone, it gives another episode.
    assert [play.seed for play in plays] == [None] * 4
    assert all(verify_play(play).is_valid for play in plays)


def test_episodes_that_do_not_end_are_unfinished(path: Path) -> None:
    env = brl.RecordPlay(brl.load("final-maze").make(), path)
    env.reset(seed=1)
    env.reset(seed=2)
    env.step(0)
    env.reset()
    env.step(0)
    env.step(0)
    env.close()
    env.close()
    plays = brl.read_plays(path)
    assert [(play.steps, play.end, play.seed) for play in plays] == [
        (1, "unfinished", "2"),
        (2, "unfinished", None),
    ]


def test_the_time_limit_is_that_of_the_environment(path: Path) -> None:
    env = brl.RecordPlay(brl.load("final-maze").make(max_episode_steps=2), path)
    env.reset()
    env.step(0)
    env.step(0)
    # A step after the end is no part of the episode.
    env.step(0)
    env.close()
    (play,) = brl.read_plays(path)
    assert (play.steps, play.max_steps, play.end) == (2, 2, "truncated")
    assert verify_play(play).is_valid


@pytest.mark.parametrize("limits", [(2, 5), (5, 2)])
def test_of_several_time_limits_the_first_to_end_counts(
    path: Path, limits: tuple[int, int]
) -> None:
    inner = brl.load("final-maze").make(max_episode_steps=limits[0])
    env = brl.RecordPlay(gymnasium.wrappers.TimeLimit(inner, limits[1]), path)
    env.reset()
    env.step(0)
    env.step(0)
    env.close()
    (play,) = brl.read_plays(path)
    assert (play.steps, play.max_steps, play.end) == (2, 2, "truncated")
    assert verify_play(play).is_valid


def test_any_observation_and_its_wrappers(path: Path) -> None:
    env: Any = brl.load("final-maze").make(observation=("view", "position"))
    env = brl.RecordPlay(gymnasium.wrappers.FlattenObservation(env), path)
    seen, _ = env.reset(seed=1)
    assert seen in env.observation_space
    env.step(np.int64(1))
    env.close()
    assert verify_play(brl.read_plays(path)[0]).is_valid


def test_the_wrapper_belongs_to_the_spec(path: Path) -> None:
    env = brl.RecordPlay(brl.load("maze").make(), path)
    assert env.spec is not None
    again = gymnasium.make(env.spec)
    again.reset(seed=1)
    again.step(0)
    again.close()
    (play,) = brl.read_plays(path)
    assert (play.name, play.seed, play.steps) == ("maze", "1", 1)


def test_what_cannot_be_recorded_is_refused(path: Path) -> None:
    with pytest.raises(TypeError, match=r"records environments, as of `level.make.*, not CartPole"):
        brl.RecordPlay(gymnasium.make("CartPole-v1"), path)
    scaled: Any = gymnasium.wrappers.TransformReward(brl.load("maze").make(), lambda reward: reward)
    with pytest.raises(TypeError, match="TransformReward changes actions or rewards"):
        brl.RecordPlay(scaled, path)
    assert not path.exists()


def test_there_is_no_file_in_a_sentence() -> None:
    for read in (brl.read_plays, brl.replay):
        with pytest.raises(brl.PlayError, match=r"^there is no file 'missing\.brlplay'$") as caught:
            read("missing.brlplay")
        assert isinstance(caught.value, FileNotFoundError)
