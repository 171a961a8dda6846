"""Mutants and crossings: valid, won where asked, as expected, and the same for the same seed."""

from __future__ import annotations

import random
import re
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from support.combinations import swept
from support.sessions import environment, run_here
from support.worlds import level_of, worlds

import babyrobot_levels as brl
from babyrobot_levels.extensions.generate import mutation
from babyrobot_levels.extensions.generate.mutation import valid
from babyrobot_levels.generation import search
from babyrobot_levels.generation.edits import EDITABLE, EDITED, flat_fields
from babyrobot_levels.text.budget import Limits, OverBudgetError, within

untimed = settings(
    max_examples=15,
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.filter_too_much],
)
PARENTS = ("final-maze", "door-key", "night-watch", "windy-gridworld", "shell-game", "frozen-lake")
ICE = {"success": "0.1.."}


def things(level: brl.Level) -> dict[str, Any]:
    """Return what stands in a level, by fields."""
    return {name: value for name, value in flat_fields(level).items() if name != "version"}


@pytest.mark.parametrize("info", brl.levels(), ids=lambda info: info.name)
def test_lists_of_entries_are_the_same_level(info: brl.LevelInfo) -> None:
    level = brl.load(info.name)
    if level.has_random_maze:
        with pytest.raises(brl.LevelError, match="another maze at each reset"):
            brl.mutate(level, seed=0)
        return
    if level.robots:
        with pytest.raises(brl.LevelError, match="only for levels with one"):
            brl.mutate(level, seed=0)
        return
    flat = valid(flat_fields(level))
    assert flat is not None
    assert flat.digest == level.digest
    assert not any((flat.map, flat.maze, flat.expect, flat.title))


@pytest.mark.slow
@untimed
@given(worlds(5), st.integers(0, 2**53), st.integers(1, 8))
def test_mutants_of_any_level_are_valid_levels(
    world: dict[str, Any], seed: int, edits: int
) -> None:
    level = level_of(world)
    arguments: dict[str, Any] = {"seed": seed, "edits": edits, "kinds": EDITABLE}
    try:
        mutant = brl.mutate(level, solvable=False, **arguments)
    except brl.UnsatisfiableError:
        # No edit of the level is another MDP.
        assert level.width * level.height <= 4
        return
    assert brl.loads(mutant.to_yaml()).digest == mutant.digest != level.digest
    assert brl.mutate(level, solvable=False, **arguments) == mutant


@pytest.mark.slow
def test_edits_that_undo_each_other_are_no_mutant() -> None:
    level = brl.Level(version=1, size=[2, 2], exit=[1, 1])
    mutants = [brl.mutate(level, seed=seed, edits=2, kinds=["wall"]) for seed in range(20)]
    assert level.digest not in {mutant.digest for mutant in mutants}


@pytest.mark.slow
@untimed
@given(st.sampled_from(PARENTS), st.integers(0, 2**53), st.integers(1, 12))
def test_mutants_are_won_by_default(name: str, seed: int, edits: int) -> None:
    expect = ICE if name == "frozen-lake" else None
    state = random.getstate()
    mutant = brl.mutate(name, seed=seed, edits=edits, expect=expect)
    assert random.getstate() == state
    success = brl.solve(brl.loads(mutant.to_yaml())).exit_probability
    assert success == pytest.approx(1) or (expect is not None and success >= 0.1)


@pytest.mark.slow
@untimed
@given(st.sampled_from(EDITED), st.integers(0, 2**20))
def test_only_what_is_asked_for_is_edited(kind: str, seed: int) -> None:
    parent = brl.load("final-maze")
    before = things(parent)
    try:
        after = things(brl.mutate(parent, seed=seed, kinds=[kind], solvable=False))
    except brl.UnsatisfiableError:
        assert kind in ("item", "mover")
        return
    changed = {name for name in {*before, *after} if before.get(name) != after.get(name)}
    fields = {
        "door": {"doors", "items"},
        "mover": {"movers", "hit"},
        "start": {"start"},
        "exit": {"exit"},
        "wind": {"wind"},
    }
    assert changed <= fields.get(kind, {f"{kind}s"})


@pytest.mark.slow
@pytest.mark.parametrize("kind", swept(["wind"], EDITABLE))
def test_a_kind_is_added_moved_and_removed(kind: str) -> None:
    """Each of these happens, to what a level has of every kind."""
    level = brl.Level(
        version=1,
        size=[5, 5],
        exit=[3, 0],
        walls=[{"at": [2, 2], "side": "E"}],
        puddles=[{"at": [1, 1]}],
        items=[{"name": "gem", "at": [0, 2]}],
        switches=[{"name": "lever", "at": [2, 0]}],
        doors=[{"at": [3, 3], "side": "S", "needs": "lever"}],
        boxes=[{"at": [3, 1]}],
        targets=[{"at": [4, 2]}],
        movers=[{"path": [[1, 4], [2, 4]], "back": True}],
        warps=[{"at": [4, 0], "to": [0, 4]}],
        blocked=[{"at": [4, 4]}],
        areas=[{"at": [0, 3], "reward": -3}],
        wind={"north": [0, 1, 0, 0, 0]},
    )
    counts = set()
    for seed in range(60):
        mutant = brl.mutate(level, seed=seed, kinds=[kind], solvable=False)
        there = flat_fields(mutant)
        if kind == "wind":
            pushes = there.get("wind") or {}
            counts.add(sum(map(sum, pushes.values())) - 1)
        elif kind in ("start", "exit"):
            counts.add(0)
        else:
            field = next(
                name for name in (f"{kind}s", f"{kind}es", kind) if name in flat_fields(level)
            )
            counts.add(len(there.get(field, [])) - 1)
    expected = {"start": {0}, "exit": {0}, "area": {0, -1}, "switch": {0, 1}}
    assert counts == expected.get(kind, {-1, 0, 1})


def test_mutants_are_as_expected(monkeypatch: pytest.MonkeyPatch) -> None:
    for seed in range(3):
        mutant = brl.mutate("final-maze", seed=seed, edits="1..5", expect={"path_length": "16..22"})
        assert 16 <= (brl.metrics(mutant).path_length or 0) <= 22
    monkeypatch.setattr(search, "MOST_TRIES", 100)
    with pytest.raises(brl.UnsatisfiableError, match=r"^expect items 9\.\.: the largest of"):
        brl.mutate({"version": 1, "size": [2, 2]}, seed=0, expect={"items": "9.."})


@pytest.mark.slow
def test_an_evolution_of_many_edits_stays_playable(tmp_path: Path) -> None:
    level, seen = brl.load("default"), set()
    for seed in range(100):
        level = brl.mutate(level, seed=seed, expect={"items": "..2", "movers": "..1"})
        seen.add(level.digest)
        assert brl.solve(level).exit_probability == pytest.approx(1)
    assert len(seen) > 75
    path = tmp_path / "evolved.yaml"
    level.save(path)
    assert brl.load(path).digest == level.digest
    assert not [finding for finding in brl.lint(path) if finding.severity == "error"]


@pytest.mark.slow
@untimed
@given(st.sampled_from(PARENTS[:3]), st.integers(0, 2**53))
def test_what_stands_in_a_crossing_stands_in_one_of_its_parents(name: str, seed: int) -> None:
    one = brl.load(name)
    other = brl.mutate(one, seed=seed, edits=20)
    crossed = brl.crossover(one, other, seed=seed)
    assert brl.crossover(one, other, seed=seed) == crossed
    assert brl.solve(crossed).exit_probability == pytest.approx(1)
    first, second, made = (things(level) for level in (one, other, crossed))
    for field, entries in made.items():
        if isinstance(entries, list) and entries and isinstance(entries[0], dict):
            assert all(entry in first.get(field, []) + second.get(field, []) for entry in entries)


@pytest.mark.slow
def test_crossings_have_parts_of_both() -> None:
    wet = [[x, y] for x in range(6) for y in range(6)][1:-1]
    base = {"version": 1, "size": [6, 6], "puddles": [{"at": cell} for cell in wet]}
    large = {**base, "puddles": [{"at": cell, "size": "large"} for cell in wet]}
    shares = set()
    for seed in range(40):
        crossed = brl.crossover(base, large, seed=seed)
        at = {puddle.at: puddle.size for puddle in crossed.puddles}
        assert {*at} == {*map(tuple, wet)}
        shares.add(sum(size == "large" for size in at.values()))
        columns = [{at.get((x, y)) for y in range(1, 5)} for x in range(6)]
        rows = [{at.get((x, y)) for x in range(1, 5)} for y in range(6)]
        assert all(len(line) == 1 for line in columns) or all(len(line) == 1 for line in rows)
    assert {5, 11, 17, 23, 29} == shares


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"edits": 0}, "edits must be from 1 to 1,000, not 0"),
        ({"edits": "5..1"}, "edits must be from 1 to 1,000, not 5..1"),
        ({"edits": "many"}, "edits must be a whole number or a range such as '1..5', not 'many'"),
        ({"edits": 1.5}, "edits must be a whole number or a range such as '1..5', not 1.5"),
        ({"kinds": ["walls"]}, "kinds must be one of 'item', 'door', 'switch', 'box', 'target', "),
        ({"kinds": []}, "kinds must name at least one kind"),
        ({"kinds": "walls"}, "kinds must be one of 'item', 'door', 'switch', 'box', 'target', "),
        ({"seed": -1}, "seed must be a whole number from 0 to 9,007,199,254,740,992, not -1"),
        ({"seed": "7"}, "seed must be a whole number from 0 to 9,007,199,254,740,992, not '7'"),
    ],
)
def test_wrong_arguments_are_named(arguments: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match="^" + re.escape(message)):
        brl.mutate("final-maze", **{"seed": 0, **arguments})


def test_levels_of_different_sizes_are_not_crossed() -> None:
    with pytest.raises(ValueError, match="must have the same size, not 8x5 and 4x4"):
        brl.crossover("final-maze", "frozen-lake", seed=0)


# -- files -----------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.usefixtures("here")
def test_files_of_mutants_are_those_of_the_command() -> None:
    options = ["--from", "final-maze", "--edits", "1..5", "--path-length", "10..", "--seed", "3"]
    call = ["generate", *options, "--count", "6"]
    assert run_here([*call, "-o", "there"], environment(Path.cwd())).status == 0
    made = brl.generate(
        base="final-maze", edits="1..5", path_length="10..", seed=3, count=6, jobs=2, folder="here"
    )
    digests = {brl.load("final-maze").digest}
    for each in made:
        there = brl.load(Path("there") / each.path.name)
        assert there.digest == brl.load(each.path).digest not in digests
        assert (brl.metrics(there).path_length or 0) >= 10
        digests.add(there.digest)
    second = Path("there/level-00002.yaml")
    assert second.read_text("utf-8").splitlines()[1] == (
        "# babyrobot generate --from final-maze --edits 1..5 --path-length 10.. --seed 3"
    )
    text = second.read_text("utf-8")
    second.unlink()
    assert run_here([*call, "-o", "there", "--resume"], environment(Path.cwd())).status == 0
    assert second.read_text("utf-8") == text


@pytest.mark.usefixtures("here")
@pytest.mark.parametrize(
    ("call", "message"),
    [
        (["--from", "final-maze", "--size", "3x3"], "--size cannot be combined with --from"),
        (["small-mazes", "--from", "final-maze"], "a suite cannot be combined with --from"),
        (["--edits", "3"], "--edits needs a level to edit"),
        (["--from", "final-maze", "--edits", "0"], "--edits must be from 1 to 1,000, not 0"),
        (["--from", "final-maze", "--edits", "few"], "--edits: invalid range 'few'"),
        (["--from", "final-mase"], "there is no level called 'final-mase'"),
        (["--from", "random-maze"], "the maze of this level is random"),
    ],
)
def test_wrong_options_end_the_command(call: list[str], message: str) -> None:
    result = run_here(["generate", "--count", "2", *call], environment(Path.cwd()))
    assert result.status in (1, 2)
    assert message in result.err
    assert not Path("levels").exists()


def test_all_candidates_for_a_mutant_have_one_budget(monkeypatch: pytest.MonkeyPatch) -> None:
    # Nobody wins, so that another candidate is drawn each time.
    hopeless = {"version": 1, "size": [3, 3], "rewards": {"step": 1}, "discount": 0.9}
    monkeypatch.setattr(search, "MOST_SOLVED", 20)
    with (
        within(Limits(700_000, 10_000, help="use less")),
        pytest.raises(OverBudgetError, match=r"success 1: .*; the level takes more than 700,000"),
    ):
        brl.mutate(hopeless, seed=0)
    with pytest.raises(brl.UnsatisfiableError, match="of 20 candidates"):
        brl.mutate(hopeless, seed=0)


def test_that_tables_of_mutants_are_too_large_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mutation, "ROOM", Limits(1_000_000, 80))
    monkeypatch.setattr(search, "MOST_TRIES", 3)
    with pytest.raises(brl.UnsatisfiableError) as caught:
        brl.mutate({"version": 1, "size": [9, 9], "skid": 0.3}, seed=0)
    assert str(caught.value) == "edits: the tables of 3 of 3 candidates are too large"


@pytest.mark.parametrize("side", [200, pytest.param(130, marks=pytest.mark.slow)])
def test_a_level_too_large_to_write_out_has_no_files_of_mutants(side: int, tmp_path: Path) -> None:
    large = {"version": 1, "size": [side, side], "maze": {"seed": 1}}
    with pytest.raises(brl.LevelError, match="each wall written by itself, as in its mutants"):
        brl.generate(base=large, count=1, folder=tmp_path / "made")
    assert not (tmp_path / "made").exists()


def test_conditions_that_mutants_do_not_have_are_refused() -> None:
    with pytest.raises(ValueError, match="size cannot be combined with the level that is mutated"):
        brl.generate(base="final-maze", size=(3, 3), count=1)
    with pytest.raises(ValueError, match="a suite cannot be combined with"):
        brl.generate("small-mazes", base="final-maze")
