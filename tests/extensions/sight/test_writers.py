"""POMDPs as files of others: read back, with the values that they had."""

from __future__ import annotations

import re
from typing import Any

import pytest
from extensions.sight import cassandra
from extensions.sight.cases import blind, levels_of, sight_of, walls

import babyrobot_levels as brl
from babyrobot_levels.extensions.sight.solve import solve_sight
from babyrobot_levels.extensions.sight.writers import WRITERS, write_drn, write_pomdp, write_prism

CORRIDOR = {
    "version": 1,
    "name": "corridor",
    "size": [3, 1],
    "start": [[0, 0], [1, 0]],
    "skid": {"probability": 0.25, "to": "others"},
    "rewards": {"step": -1, "exit": 0.5},
}


@pytest.mark.slow
def test_cassandra_files_have_the_same_values() -> None:
    draws = 0
    for seed in range(22):
        levels, options = levels_of(seed), sight_of(seed)
        found = solve_sight(levels, within=3, discount=0.5, **options)
        file = cassandra.read(write_pomdp(found.model))
        first = len(found.model.initial()) > 1
        draws += first
        for row in file.transitions.values():
            assert sum(chance for _, chance in row) == pytest.approx(1, abs=1e-12)
        # Where the first observation tells something, a step that draws the start comes first.
        value = file.within(3 + first) / (file.discount if first else 1)
        assert value == pytest.approx(found.upper, abs=1e-9)
    assert 0 < draws < 22


def test_a_cassandra_file() -> None:
    model = solve_sight(CORRIDOR, blind, actions="moves", beliefs=10).model
    assert write_pomdp(model).splitlines()[:12] == [
        "# corridor",
        "# seen: blind; actions: north, east, south, west",
        "# state 2: the episode is over",
        "discount: 1.0",
        "values: reward",
        "states: 3",
        "actions: 4",
        "observations: 2",
        "start: 0.5 0.5 0.0",
        "T: 0 : 0 : 0 0.9166666666666666",
        "T: 0 : 0 : 1 0.08333333333333333",
        "T: 1 : 0 : 0 0.25",
    ]


def test_a_prism_module() -> None:
    model = solve_sight(CORRIDOR, walls, actions="moves", beliefs=10).model
    text = write_prism(model)
    # Storm looks for observables at the beginning only.
    assert text.startswith("pomdp\nobservables\n  o\nendobservables\n")
    assert "  s : [0..3] init 3;\n  o : [0..3] init 3;\n" in text
    assert "  [north] s=0 -> 11/12:(s'=0)&(o'=0) + 1/12:(s'=1)&(o'=1);\n" in text
    assert "[north] s=1 -> 1/12:(s'=0)&(o'=0) + 5/6:(s'=1)&(o'=1) + 1/12:(s'=2)&(o'=2)" in text
    # Three times in four 0.5, else -1 or 0.5.
    assert 'rewards "reward"\n' in text
    assert "  [east] s=1 : 0.125;\n" in text
    assert "  [east] s=3 -> 1/2:(s'=0)&(o'=0) + 1/2:(s'=1)&(o'=1);\n" in text
    assert text.endswith('label "end" = s=2;\n')


def test_a_drn_file() -> None:
    model = solve_sight(CORRIDOR, walls, actions="moves", beliefs=10).model
    text = write_drn(model)
    assert "@nr_states\n4\n@nr_choices\n16\n@model\n" in text
    assert "state 3 {3} [0, 0] init\n\taction north [0.0, 0.0]\n\t\t0 : 1/2\n\t\t1 : 1/2\n" in text
    assert "state 2 {2} [0, 0] end\n\taction north [0.0, 0.0]\n\t\t2 : 1\n" in text
    assert "\taction east [-1.0, 1.0]\n" in text


@pytest.mark.parametrize("name", WRITERS)
def test_files_are_ascii_and_the_same_each_time(name: str) -> None:
    level = brl.load({**CORRIDOR, "name": "korridor", "title": "Gänge\nendmodule"})
    texts = {WRITERS[name](solve_sight(level, "view", beliefs=5).model) for _ in range(2)}
    (text,) = texts
    assert text.isascii()
    assert "endmodule\nendmodule" not in text
    assert not re.search(r"\d[eE][+-]?\d", text)


def test_several_discounts_are_no_cassandra_file() -> None:
    levels: list[Any] = [{**CORRIDOR, "discount": rate} for rate in (0.5, 0.9)]
    model = solve_sight(levels, "view").model
    with pytest.raises(ValueError, match="the format has one discount"):
        write_pomdp(model)
