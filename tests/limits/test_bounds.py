"""Short files that ask for large tables: what they cost, and which of them are refused."""

from __future__ import annotations

import json
import re
from random import Random
from typing import Any

import numpy as np
import pytest
from oracles.random_things import random_level
from support.work import traced_memory

import babyrobot_levels as brl
from babyrobot_levels.library.level import loads
from babyrobot_levels.linter.rules import select
from babyrobot_levels.linter.runner import is_note, lint_source
from babyrobot_levels.mdp import compiler, configurations, tables
from babyrobot_levels.mdp.compiler import layers, outcomes, things
from babyrobot_levels.mdp.configurations import most_outcomes, surely_fits
from babyrobot_levels.mdp.gridworld import GridWorld
from babyrobot_levels.mdp.tables import Mdp
from babyrobot_levels.text.budget import Limits, OverBudgetError, within
from babyrobot_levels.text.source import SourceFile

WANDERER = {"movers": [{"within": {"at": [0, 0], "size": [31, 31]}}]}
DOOR = {"doors": [{"at": [0, 0], "side": "E", "length": 1024}]}


def arrays(mdp: Mdp) -> dict[str, np.ndarray]:
    return {name: value for name, value in vars(mdp).items() if isinstance(value, np.ndarray)}


@pytest.mark.parametrize(("side", "fields"), [(31, WANDERER), (1024, DOOR)])
def test_levels_whose_fields_show_that_they_fit_are_valid_uncompiled(
    side: int, fields: dict[str, Any]
) -> None:
    level = loads(json.dumps({"version": 1, "size": [side, side], **fields}))
    assert "_mdp" not in vars(level)


def test_what_the_fields_show_is_so() -> None:
    fitting = [brl.load(random_level(Random(number))) for number in range(150)]
    fitting = [level for level in fitting if surely_fits(level)]
    assert len(fitting) > 100
    for level in fitting:
        assert level.compile().probability.shape[2] <= most_outcomes(level)


def test_too_many_starts_of_a_warp() -> None:
    starts = [[x, 1] for x in range(200)]
    level = {"version": 1, "size": [1024, 1024], "start": starts}
    loads(json.dumps({**level, "warps": [{"at": [5, 5], "to": [6, 6]}]}))
    with pytest.raises(brl.LevelError, match="1,048,576 states, and 200 outcomes") as caught:
        loads(json.dumps({**level, "warps": [{"at": [5, 5], "to": "start"}]}))
    assert [each.code for each in caught.value.diagnostics] == ["BR404"]
    small = {**level, "size": [200, 100], "warps": [{"at": [5, 5], "to": "start"}]}
    assert brl.load(small).compile().probability.shape == (20_000, 5, 200)


@pytest.mark.parametrize("seed", range(20))
def test_outcomes_are_sorted_and_those_alike_are_one(seed: int) -> None:
    rng = np.random.default_rng(seed)
    row, target, by_chance = (rng.integers(0, most, 200) for most in (9, 7, 1 + seed % 3))
    # In every second case the rewards follow from the states that rows lead to.
    reward = -(target if seed % 2 else by_chance).astype(np.float64)
    terminal = target == 3 if seed % 4 < 2 else rng.random(200) < 0.5
    found = outcomes.merged(row, np.full(200, 0.125), target, reward, terminal)
    keys = [*zip(row.tolist(), target.tolist(), reward.tolist(), terminal.tolist(), strict=True)]
    columns = (found.row, found.next_state, found.reward, found.terminal, found.probability)
    assert [*zip(*(column.tolist() for column in columns), strict=True)] == [
        (*key, keys.count(key) / 8) for key in sorted({*keys})
    ]


@pytest.mark.parametrize("number", range(25))
def test_parts_do_not_matter(number: int, monkeypatch: pytest.MonkeyPatch) -> None:
    fields = random_level(Random(number))
    whole = brl.load(fields).compile()
    monkeypatch.setattr(tables, "PART", 4)
    monkeypatch.setattr(things, "PART", 9)
    # Steps of one pair after the other, and of a few together.
    for many in (1, 10**9):
        monkeypatch.setattr(layers, "MANY", many)
        monkeypatch.setattr(layers, "BATCH", 7)
        parts = brl.load(fields).compile()
        for name, values in arrays(whole).items():
            assert np.array_equal(values, arrays(parts)[name]), name


@pytest.mark.parametrize(
    ("side", "fields", "times"),
    [
        (512, {"skid": {"probability": 0.5, "to": "others"}}, 1.6),
        (512, {"wind": {"north": [511] * 512}}, 2.2),
        (512, {"doors": [{"at": [0, 0], "side": "E", "length": 512}]}, 5),
        (16, {"movers": [{"within": {"at": [0, 0], "size": [16, 16]}}]}, 2.1),
    ],
)
def test_compiling_needs_little_more_than_the_tables(
    side: int, fields: dict[str, Any], times: float
) -> None:
    level = brl.load({"version": 1, "size": [side, side], **fields})
    level.grid()
    with traced_memory() as work:
        mdp = level.compile()
    assert work.memory < times * sum(array.nbytes for array in arrays(mdp).values())


def test_what_is_checked_without_tables_can_be_compiled(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(things, "SMALL", 0)
    refused, counted = 0, 0
    for number in range(120):
        level, most = brl.load(random_level(Random(number))), 10 + 7 * number
        for module in (configurations, things):
            monkeypatch.setattr(module, "MAX_WIDE_STATES", most)
        try:
            expected = compiler.compile_mdp(level, level.grid())
        except brl.LevelError as error:
            refused += 1
            with pytest.raises(brl.LevelError, match=re.escape(str(error))):
                compiler.checked_mdp(level, level.grid())
            continue
        found = compiler.checked_mdp(level, level.grid())
        counted += found is None
        if found is not None:
            assert [*map(bytes, arrays(found).values())] == [*map(bytes, arrays(expected).values())]
    assert refused > 20
    assert counted > 20


def test_a_large_level_is_valid_by_its_states_alone() -> None:
    wall = {"at": [0, 298], "side": "S", "length": 300}
    places = [[5, 5], [9, 9], *([x, 299] for x in range(5))]
    items = [{"at": at, "name": f"item-{number}"} for number, at in enumerate(places)]
    data = {"version": 1, "size": [300, 300], "exit": [299, 298], "walls": [wall], "items": items}
    level = loads(json.dumps(data))
    assert not surely_fits(level)
    assert "_mdp" not in vars(level)
    assert level.compile().num_configurations == 4


def compiled_within(level: GridWorld, entries: int) -> None:
    with within(Limits(10**9, entries)):
        level.compile()


def test_tables_are_made_within_a_bound_and_no_larger() -> None:
    for number in range(60):
        level = brl.load(random_level(Random(number)))
        states, _, width = brl.load(level.to_dict()).compile().probability.shape
        with pytest.raises(OverBudgetError, match=r"together at most|too many here"):
            compiled_within(level, states * width - 1)
        compiled_within(level, 5 * states * width)
        compiled_within(level, states * width)
        assert level.compile().probability.shape == (states, 5, width)
        # Also those that are made already.
        with pytest.raises(OverBudgetError, match=f"{states:,} states, and {width} or more out"):
            compiled_within(level, states * width - 1)


@pytest.mark.parametrize(
    ("side", "fields", "field"),
    [
        (1024, {"skid": {"probability": 0.5, "to": "others"}}, "size"),
        (24, {"movers": [{"within": {"at": [0, 0], "size": [24, 24]}}]}, "movers"),
    ],
)
def test_lint_and_show_say_what_they_leave_out(
    side: int, fields: dict[str, Any], field: str
) -> None:
    data = {"version": 1, "size": [side, side], **fields}
    text = json.dumps(data)
    report = lint_source(SourceFile("x.yaml", text), select(["BR5"]))
    assert report.level is not None
    assert "_mdp" not in vars(report.level)
    (found,) = report.diagnostics
    assert found.code == "BR539"
    assert is_note(found)
    assert text[: found.column - 1].endswith(f'"{field}": ')
    assert re.search(
        "rules of play do not check it: .* 1,048,576|more than [0-9,]+ steps", found.message
    )
    facts = brl.show(data)
    assert facts["digest"] is facts["metrics"] is None
    assert facts["drawing"] == brl.load(data).draw()
    assert facts.lines()["digest"] == facts.lines()["metrics"]
    assert re.search(
        "^not computed: the level has .* 1,048,576|more than [0-9,]+ steps", facts.lines()["digest"]
    )


def test_a_text_counts_more_than_another_shape() -> None:
    level = brl.load({"version": 1, "size": [60, 60]})
    with within(Limits(9_000_000, 50_000)):
        level.to_svg()
        with pytest.raises(OverBudgetError, match="too many shapes"):
            level.to_pdf(coordinates=True)
