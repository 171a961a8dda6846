"""Boxes in generated levels and mutants: all targets can be covered, and a push is needed."""

from __future__ import annotations

import random
from typing import Any

import pytest

import babyrobot_levels as brl
from babyrobot_levels.generation import search
from babyrobot_levels.generation.boxes import pulled
from babyrobot_levels.suites.sources import Bounds

FIELDS: dict[str, Any] = {
    "version": 1,
    "kind": "suite",
    "seed": 3,
    "count": 3,
    "size": {"min": [4, 4], "max": [5, 4]},
    "boxes": "1..2",
    "start": "random",
    "max_steps": 60,
}


def test_levels_are_won_by_pushes_alone_and_fit_into_the_suite() -> None:
    suite = brl.load_suite(FIELDS)
    levels = [*suite]
    assert {len(level.boxes) for level in levels} == {1, 2}
    for level in levels:
        metrics = brl.metrics(level)
        assert (metrics.success, level.exits) == (1, ())
        assert metrics.pushes is not None
        assert metrics.pushes >= len(level.boxes) == len(level.targets)
        assert metrics.best_steps is not None
        assert metrics.best_steps <= 60
        assert not {box.at for box in level.boxes} & {target.at for target in level.targets}
    own = Bounds.joined(map(Bounds.of, levels))
    assert suite.bounds.configurations >= own.configurations
    assert len(suite.bounds.radices) == len(own.radices) == 4
    assert all(most >= each for most, each in zip(suite.bounds.radices, own.radices, strict=True))
    assert suite.bounds.has_boxes


def test_a_level_depends_on_seed_and_number_alone() -> None:
    (level,) = brl.load_suite({**FIELDS, "count": 1, "seed": 5})
    again = brl.load_suite({**FIELDS, "count": 9, "seed": 5})[0]
    assert level.to_yaml() == again.to_yaml()
    assert brl.loads(level.to_yaml()).digest == level.digest
    assert brl.load_suite({**FIELDS, "seed": 6})[0].digest != level.digest


def test_vector_environments_draw_them() -> None:
    suite = brl.load_suite(FIELDS)
    envs = brl.LevelVectorEnv(levels=suite, draw_levels=True, num_envs=5, engine="numpy")
    observed, _ = envs.reset(seed=1)
    assert observed.shape == (5, 2 + 4)
    for _ in range(3):
        observed, *_ = envs.step(envs.action_space.sample())
        assert envs.single_observation_space.contains(observed[0])


def test_boxes_begin_off_their_targets_where_pushes_lead_back() -> None:
    grid = brl.load({"version": 1, "size": [6, 5], "exit": "none"}).grid()
    found = [pulled(grid, 7, 3, random.Random(seed)) for seed in range(20)]
    placed = [each for each in found if each is not None]
    assert len(placed) > 10
    for boxes, targets in placed:
        assert len({*boxes, *targets}) == 6
        assert 7 not in boxes
    square = brl.load({"version": 1, "size": [2, 2], "exit": "none"}).grid()
    assert pulled(square, 0, 1, random.Random(1)) is None
    assert pulled(square, 0, 4, random.Random(1)) is None


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"keys": 1}, "levels with boxes are made without keys"),
        ({"puddles": 1}, "levels with boxes are made without puddles"),
        ({"exit": "random"}, "levels with boxes have no exit"),
        ({"start": "farthest"}, "no exit to be far from"),
        ({"boxes": "0..2"}, "there must be a box at least"),
        ({"boxes": 9}, "a level has at most 8 boxes"),
        ({"boxes": 4, "size": [9, 9]}, "4 boxes in 81 cells have 134,762,940 states"),
    ],
)
def test_what_cannot_be_is_an_error(fields: dict[str, Any], message: str) -> None:
    with pytest.raises(brl.LevelError, match=message):
        brl.load_suite({**FIELDS, **fields})


def test_too_little_room_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(search, "MOST_TRIES", 100)
    suite = brl.load_suite({**FIELDS, "size": [2, 2], "boxes": 1})
    with pytest.raises(brl.UnsatisfiableError, match="was there room to push all of them"):
        suite[0]


@pytest.mark.slow
def test_mutants_with_boxes_are_won() -> None:
    (level,) = brl.load_suite({**FIELDS, "count": 1, "boxes": 2, "size": [4, 4]})
    kinds = ["box", "target", "wall", "start"]
    mutants = [brl.mutate(level, seed=seed, edits=2, kinds=kinds) for seed in range(3)]
    assert [brl.metrics(mutant).success for mutant in mutants] == [1, 1, 1]
    assert len({mutant.digest for mutant in mutants} - {level.digest}) == 3
