"""The table of a class: what counts, and what does not."""

from __future__ import annotations

import csv
import errno
import io
import json
import math
import os
from dataclasses import replace
from pathlib import Path

import pytest
from support.plays import forged, record

import babyrobot_levels as brl
from babyrobot_levels.scoring.plays import append_play

LAKE = "frozen-lake"


def play_by_heart(path: Path, level: brl.Level, *episodes: list[int]) -> None:
    """Record episodes of given actions."""
    env = brl.RecordPlay(level.make(), path)
    for actions in episodes:
        env.reset()
        for action in actions:
            env.step(action)
    env.close()


def test_the_numbers_of_a_player(tmp_path: Path) -> None:
    level = brl.load({"version": 1, "size": [3, 1], "max_steps": 4, "name": "row"})
    path = tmp_path / "ada.brlplay"
    play_by_heart(path, level, [2, 2], [2, 0, 2], [0, 0, 0, 0], [2])
    (grade,) = brl.grade([path], level)
    assert (grade.player, grade.level) == ("ada", "row")
    assert (grade.episodes, grade.unfinished) == (3, 1)
    rewards = [play.return_ for play in brl.read_plays(path)[:3]]
    assert grade.best == max(rewards)
    assert grade.mean == pytest.approx(sum(rewards) / 3)
    assert grade.success == pytest.approx(2 / 3)
    assert grade.steps == 3
    # The second step of the best episode was the last one; that of the worst one cost most.
    assert grade.regret == 0
    assert grade.luck == pytest.approx(grade.best - grade.optimum)
    random = brl.score("random", level)[0]
    assert (grade.optimum, grade.random) == (random.optimum, random.random)
    way = random.optimum - random.random
    assert grade.share == pytest.approx((grade.mean - random.random) / way)
    assert grade.fault is None


def test_an_optimal_episode_has_a_share_of_one(tmp_path: Path) -> None:
    level = brl.load("maze")
    env = brl.RecordPlay(level.make(observation="index", actions="turns"), tmp_path / "a.brlplay")
    policy = brl.solve(level, actions="turns").policy.ravel()
    state, _ = env.reset()
    is_over = False
    while not is_over:
        state, _, is_over, _, _ = env.step(int(policy[state]))
    env.close()
    (grade,) = brl.grade([tmp_path / "a.brlplay"], level)
    assert grade.share == pytest.approx(1.0)
    assert grade.success == 1.0


def test_plays_that_do_not_count(tmp_path: Path) -> None:
    path = tmp_path / "eve.brlplay"
    record(path, LAKE, episodes=2)
    honest = brl.grade([path], LAKE)[0]
    first = brl.read_plays(path)[0]
    record(path, "first-key")
    assert brl.grade([path], LAKE)[0] == honest
    for changes, message in (
        ({"return": 1000.0}, "line 4: its rewards add up to"),
        ({"max_steps": 300}, "line 4: it has another time limit, 300, and not 100"),
        ({"discount": 0.5}, "line 4: it has another discount, 0.5, and not 1"),
        ({"start": "chosen"}, "line 4: the player chose its start"),
    ):
        other = tmp_path / "mallory.brlplay"
        other.write_bytes(path.read_bytes())
        append_play(other, forged(first, **changes))
        grades = brl.grade([other], LAKE)
        assert not grades.are_valid
        assert grades[0].fault is not None
        assert grades[0].fault.startswith(message)
        assert replace(grades[0], fault=None, player="eve") == honest


def test_equal_plays_count_once(tmp_path: Path) -> None:
    ada, ben, eve = (tmp_path / f"{name}.brlplay" for name in ("ada", "ben", "eve"))
    record(ada, LAKE, episodes=3)
    record(ben, LAKE, episodes=2, seed=7)
    (honest,) = brl.grade([ada], LAKE)
    assert (honest.copies, honest.shared, honest.unseeded) == (0, 0, 0)
    first = brl.read_plays(ada)[0]
    for copy in (first, forged(first, seed="000", hints=3), forged(first, seed_kind="page")):
        append_play(ada, copy)
    append_play(eve, first)
    append_play(eve, forged(first, seed=None))
    grades = brl.grade([ada, ben, eve], LAKE)
    assert replace(grades[0], copies=0, shared=0, shared_with="") == honest
    told = [(each.copies, each.shared, each.shared_with, each.unseeded) for each in grades]
    assert told == [(3, 1, "eve", 0), (0, 0, "", 0), (0, 1, "ada", 1)]
    assert grades.are_valid


def test_files_that_cannot_be_read_have_a_row(tmp_path: Path) -> None:
    (tmp_path / "half.brlplay").write_bytes(b'{"format":')
    (tmp_path / "folder.brlplay").mkdir()
    record(tmp_path / "other.brlplay", "first-key")
    names = ["half", "folder", "nobody", "other"]
    grades = brl.grade([tmp_path / f"{name}.brlplay" for name in names], LAKE)
    assert [grade.player for grade in grades] == names
    faults = [grade.fault or "" for grade in grades]
    assert faults[0].startswith("line 1: the line is cut off")
    assert faults[1] == os.strerror(errno.EISDIR)
    assert faults[2] == os.strerror(errno.ENOENT)
    assert faults[3] == "it has no play of this level, but of first-key"
    assert all(grade.episodes == 0 and math.isnan(grade.mean) for grade in grades)


def test_each_level_has_a_row_of_its_own(tmp_path: Path) -> None:
    path = tmp_path / "ada.brlplay"
    record(path, LAKE)
    record(path, "first-key", "turns")
    grades = brl.grade([path])
    assert [grade.level for grade in grades] == [LAKE, "first-key"]
    assert grades[1].random == brl.score("random", "first-key", actions="turns")[0].random


def test_without_an_optimum_there_is_no_share(tmp_path: Path) -> None:
    endless = brl.load({"version": 1, "size": [3, 1], "walls": [{"at": [0, 0], "side": "E"}]})
    path = tmp_path / "ada.brlplay"
    play_by_heart(path, endless, [0, 0])
    (grade,) = brl.grade([path])
    assert (grade.episodes, grade.unfinished) == (0, 1)
    assert math.isnan(grade.share)


def test_tables(tmp_path: Path) -> None:
    record(tmp_path / "ada.brlplay", LAKE)
    grades = brl.grade([tmp_path / "ada.brlplay"])
    (row,) = csv.DictReader(io.StringIO(grades.to_csv(tmp_path / "class.csv")))
    (told,) = json.loads(grades.to_json())["grades"]
    assert (tmp_path / "class.csv").exists()
    assert row["player"] == told["player"] == "ada"
    assert float(row["mean"]) == told["mean"] == grades[0].mean
    assert repr(grades) == "<Grades of 1 players>"
