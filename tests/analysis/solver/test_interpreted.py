"""What is compiled for large levels, run by Python itself on small ones: that takes seconds.

Compiling it takes half a minute, which `test_sweeps.py` waits for.
"""

from __future__ import annotations

from pathlib import Path

import pytest
from support.subprocesses import run

TESTS = Path(__file__).parents[2]

SOLVED_TWICE = """
from random import Random

import numpy as np
from oracles.random_things import random_level

import babyrobot_levels as brl
from babyrobot_levels.analysis.solver import compiled
from babyrobot_levels.analysis.solver.policies import space_of
from babyrobot_levels.analysis.solver.within import optimum_within
from babyrobot_levels.analysis.solver.compiled import iteration, values

compiled._has_numba = lambda: True
calls = dict.fromkeys(("advance", "settle", "sweep", "climb", "improved"), 0)


def counted(module, name):
    function = getattr(module, name)

    def call(*args):
        calls[name] += 1
        return function(*args)

    return call


for name in calls:
    module = iteration if name == "improved" else values
    setattr(module, name, counted(module, name))
SKID = {"version": 1, "size": [7, 6], "skid": 0.4}
LEVELS = [
    SKID,
    {**SKID, "maze": {"seed": 3, "loops": 0.2}},
    {**SKID, "size": [8, 8], "skid": {"probability": 0.8, "to": "sides"}},
    {**SKID, "rewards": {"step": 0, "exit": 1}},
    {**SKID, "areas": [{"at": [3, 3], "ends": True, "reward": 20}]},
    {**SKID, "areas": [{"at": [2, 1], "size": [3, 2], "reward": 3}, {"at": [0, 4], "reward": -5}]},
    {**SKID, "exit": "none"},
    {**SKID, "wind": {"west": [0, 1, 0, 1, 1, 0]}, "skid": {"probability": 0.6, "to": "open"}},
    {**SKID, "warps": [{"at": [1, 1], "to": [4, 4]}], "exit": [[6, 5], [0, 5]]},
    *(random_level(Random(seed)) for seed in range(3)),
    # All ways that end in time are equally good, and the shortest of them is meant.
    {"version": 1, "size": [7, 6], "rewards": {"step": 0, "exit": 1}},
]


def solved(level, discount, **options):
    try:
        return brl.solve(level, discount, **options)
    except (brl.UndefinedReturnError, brl.EpisodeTooLongError) as error:
        return type(error)


for number, fields in enumerate(LEVELS):
    level = brl.load(fields)
    limited = {"discount": 0.9 if number % 2 else 1.0, "within": 12}
    for options in ({"discount": 0.95}, {"discount": 1.0}, limited):
        compiled.MANY_STATES = 1 << 40
        expected = solved(level, **options)
        compiled.MANY_STATES = 0
        found = solved(level, **options)
        if isinstance(expected, type):
            assert found is expected, (number, options)
            continue
        # Where machine code does not find the values, what is used without it does.
        assert number > 8 or "within" in options or found.method.startswith("sweeps"), number
        size = np.abs(expected.values[np.isfinite(expected.values)]).max(initial=1.0)
        where = f"level {number}, {options}"
        for each in ("values", "action_values", "margin"):
            pair = getattr(found, each), getattr(expected, each)
            np.testing.assert_allclose(*pair, rtol=0, atol=1e-9 * size, err_msg=where)
        assert (found.greedy == expected.greedy).all(), where
        assert np.isclose(found.expected_steps, expected.expected_steps, rtol=1e-7), where
        pair = found.exit_probability, expected.exit_probability
        assert np.isclose(*pair, atol=1e-7, equal_nan=True), where
        if "within" in options:
            of_many = optimum_within(space_of(level, "all"), options["discount"], 12)
            one = expected.expected_return, expected.exit_probability, expected.expected_steps
            np.testing.assert_allclose(of_many, one, rtol=1e-9, atol=1e-12, err_msg=where)
assert all(calls.values()), calls
print("the same")
"""


def test_small_levels_are_solved_alike(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("NUMBA_DISABLE_JIT", "1")
    assert run(SOLVED_TWICE, tmp_path, TESTS, timeout=300) == "the same\n"
