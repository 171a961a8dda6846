"""The table of a class: what counts, and what does not."""

from __future__ import annotations

import csv
import io
import json
import math
import zlib
from dataclasses import astuple, replace
from pathlib import Path
from typing import Any
from unittest.mock import ANY

import pytest
from support.plays import forged, record

import babyrobot_levels as brl
from babyrobot_levels.agents.plays import append_play
from babyrobot_levels.mdp import compiler
from babyrobot_levels.text.budget import COMMAND, left, within

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
    random = brl.score(level, "random")[0]
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


@pytest.mark.slow
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
    names = ["half", "folder", "other"]
    grades = brl.grade([tmp_path / f"{name}.brlplay" for name in names], LAKE)
    assert [grade.player for grade in grades] == ["half", "folder.brlplay", "other"]
    faults = [grade.fault or "" for grade in grades]
    assert faults[0].startswith("line 1: the line is cut off")
    assert faults[1] == "there is no file to grade"
    assert faults[2] == "it has no play of this level, but of first-key"
    assert all(grade.episodes == 0 and math.isnan(grade.mean) for grade in grades)


def test_what_is_not_read_is_told_in_the_rows_of_levels_without_a_play(tmp_path: Path) -> None:
    (tmp_path / "ada").mkdir()
    record(tmp_path / "ada" / "lake.brlplay", LAKE)
    (tmp_path / "ada" / "half.brlplay").write_bytes(b'{"format":')
    (tmp_path / "ben.zip").write_bytes(b"PK")
    grades = brl.grade(tmp_path, [LAKE, "first-key"])
    told = {(each.player, each.level): each.fault or "" for each in grades}
    assert told["ada", LAKE] == ""
    assert told["ada", "first-key"].startswith("half.brlplay: line 1: the line is cut off")
    for level in (LAKE, "first-key"):
        assert told["ben", level].startswith("ben.zip: the zip file is damaged")


def test_a_missing_file_is_an_error_and_no_player(tmp_path: Path) -> None:
    record(tmp_path / "ada.brlplay", LAKE)
    files = [tmp_path / "ada.brlplay", tmp_path / "nosuch.zip"]
    missing: list[Any] = [files, files[1], str(files[1])]
    for given in missing:
        with pytest.raises(FileNotFoundError) as caught:
            brl.grade(given, LAKE)
        assert caught.value.filename == str(files[1])
    # One file is a list of one.
    assert [each.player for each in brl.grade(str(files[0]), LAKE)] == ["ada"]


def test_each_level_has_a_row_of_its_own(tmp_path: Path) -> None:
    path = tmp_path / "ada.brlplay"
    record(path, LAKE)
    record(path, "first-key", "turns")
    grades = brl.grade([path])
    assert [grade.level for grade in grades] == [LAKE, "first-key"]
    assert grades[1].random == brl.score("first-key", "random", actions="turns")[0].random


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


# -- a class -------------------------------------------------------------------------------------

ROW = {"version": 1, "size": [4, 1], "max_steps": 9, "name": "row"}
ICE = {**ROW, "name": "ice", "skid": {"probability": 0.5, "to": "others"}, "size": [3, 2]}


def hand_in(folder: Path, name: str, *episodes: list[int], level: Any = ROW, seed: int = 0) -> Path:
    """Record episodes of given actions, with seeds from one on, under the name of the folder."""
    path = folder / name / f"{level['name']}.brlplay"
    path.parent.mkdir(parents=True, exist_ok=True)
    env = brl.RecordPlay(brl.load(level).make(), path)
    for number, actions in enumerate(episodes):
        env.reset(seed=seed + number)
        is_over = False
        for action in actions:
            if not is_over:
                _, _, terminated, truncated, _ = env.step(action)
                is_over = terminated or truncated
    env.close()
    named = [forged(play, player=name).to_line() for play in brl.read_plays(path)]
    path.write_text("".join(f"{line}\n" for line in named))
    return path


DIRECT, DETOUR, LATE = [2, 2, 2], [0, 0, 2, 2, 2], [0] * 9


@pytest.mark.parametrize(
    ("rule", "earned"), [("regret", 1), ("share", 1), ("success", 1), ("tries", 1 / 2)]
)
def test_points_are_those_of_the_best_play_by_a_rule(
    tmp_path: Path, rule: str, earned: float
) -> None:
    hand_in(tmp_path, "ada", LATE, DIRECT, DETOUR)
    hand_in(tmp_path, "ben", LATE)
    grades = brl.grade([tmp_path], [brl.load(ROW), brl.load(ICE)], points=rule)
    assert grades.totals["ada"] == {"row": pytest.approx(earned), "ice": 0, "total": ANY}
    assert grades.totals["ben"]["total"] == 0
    assert [(each.player, each.level) for each in grades] == [
        ("ada", "row"), ("ada", "ice"), ("ben", "row"), ("ben", "ice"),
    ]  # fmt: skip
    assert grades.are_valid
    assert grades.totals_to_csv().splitlines()[0] == "player,row,ice,total"
    with pytest.raises(ValueError, match="'tries', not 'regrets'; did you mean"):
        brl.grade([tmp_path], points="regrets")


def test_a_detour_costs_a_part_and_watching_all(tmp_path: Path) -> None:
    path = hand_in(tmp_path, "ada", DETOUR)
    (grade,) = brl.grade([tmp_path], ROW)
    way = grade.optimum - grade.random
    assert grade.points == pytest.approx((way - 2) / way)
    (play,) = brl.read_plays(path)
    path.write_text(forged(play, watched=1).to_line() + "\n")
    (grade,) = brl.grade([tmp_path], ROW)
    assert (grade.points, grade.episodes, grade.watched) == (0, 1, 1)


def test_the_levels_of_a_course_have_points(tmp_path: Path) -> None:
    course = tmp_path / "robots"
    for level in (ROW, ICE, {**ROW, "name": "exam", "size": (5, 1)}):
        brl.load(level).save(course / "levels" / f"{level['name']}.yaml")
    (course / "pack.yaml").write_text(
        "name: robots\nversion: 1.0.0\ndescription: A course.\n"
        "levels: [{level: ice, points: 3}, {level: row, points: 7},\n"
        "  {level: exam, hidden: true}]\n"
    )
    hand_in(tmp_path / "plays", "ada", DIRECT)
    grades = brl.grade([tmp_path / "plays"], course)
    assert grades.totals == {"ada": {"ice": 0, "row": 7, "total": 7}}
    assert [(each.level, each.worth) for each in grades] == [("ice", 3), ("row", 7)]


def test_what_is_not_the_players_own_does_not_count(tmp_path: Path) -> None:
    seed = zlib.crc32(b"ada")
    path = hand_in(tmp_path, "ada", [2, 3] * 5, level=ICE, seed=seed)
    (own,) = brl.read_plays(path)
    hand_in(tmp_path, "ben", [3], level=ICE)
    for name, play in (("cy", own), ("ben", forged(own, player="ben"))):
        (tmp_path / name).mkdir(exist_ok=True)
        (tmp_path / name / "ice.brlplay").write_text(play.to_line() + "\n")
    grades = brl.grade([tmp_path], ICE)
    assert [astuple(defect) for defect in grades.defects] == [
        ("ben", "ice.brlplay, line 1", "it is the same play as that of ada"),
        ("cy", "ice.brlplay, line 1", "it is under the name of ada"),
    ]
    assert [each.episodes for each in grades] == [1, 0, 0]
    assert not grades.are_valid


@pytest.mark.parametrize("seed", [0, 20_261_126])
def test_plays_with_seeds_of_anybody_count_for_all_who_have_them(tmp_path: Path, seed: int) -> None:
    for name in ("ada", "ben"):
        hand_in(tmp_path, name, DIRECT, seed=seed)
    grades = brl.grade([tmp_path], ROW)
    assert [(each.points, each.shared_with) for each in grades] == [(1, "ben"), (1, "ada")]


def test_another_version_of_a_level_and_wrong_seeds_are_named(tmp_path: Path) -> None:
    hand_in(tmp_path, "ada", DIRECT, level={**ROW, "rewards": {"step": -2}})
    path = hand_in(tmp_path, "ben", [2, 3, 2, 2], level=ICE, seed=3)
    (play,) = brl.read_plays(path)
    path.write_text(forged(play, seed="5").to_line() + "\n")
    grades = brl.grade([tmp_path], [brl.load(ROW), brl.load(ICE)])
    reasons = {defect.player: defect.reason for defect in grades.defects}
    assert reasons["ada"] == "it is of another version of row"
    assert reasons["ben"].startswith("with its seed 5, ")
    assert {each.points for each in grades} == {0}


def test_plays_of_the_level_that_was_asked_for_take_its_tables(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "row.yaml"
    path.write_text("version: 1\nsize: [4, 1]\n", "utf-8")
    play_by_heart(tmp_path / "ada.brlplay", brl.load(path), [2, 2, 2])
    compiled, compile_mdp = [], compiler.compile_mdp

    def counted(level: Any, grid: Any) -> Any:
        compiled.append(level)
        return compile_mdp(level, grid)

    monkeypatch.setattr(compiler, "compile_mdp", counted)
    (grade,) = brl.grade([tmp_path / "ada.brlplay"], path)
    assert (grade.fault, len(compiled)) == (None, 1)


def test_levels_of_plays_that_were_not_asked_for_count_together(tmp_path: Path) -> None:
    level = brl.load({"version": 1, "size": [4, 1], "name": "row"})
    play_by_heart(tmp_path / "ada.brlplay", level, [2, 2, 2])
    play = brl.read_plays(tmp_path / "ada.brlplay")[0]
    for side in (30, 31):
        other = brl.load({"version": 1, "size": [side, side], "skid": 0.1, "name": "row"})
        append_play(tmp_path / "eve.brlplay", forged(play, code=other.share_code()))
    append_play(tmp_path / "eve.brlplay", play)
    with within(COMMAND):
        other.compile()
        steps = COMMAND.steps - left()
    with within(replace(COMMAND, steps=1.5 * steps)):
        found = brl.grade([tmp_path / "ada.brlplay", tmp_path / "eve.brlplay"], level)
    first, second = (each.reason for each in found.defects if each.player == "eve")
    assert "its digest is not that of the level" in first
    assert "it cannot be verified: the level takes more than" in second
    assert [each.episodes for each in found] == [1, 1]
