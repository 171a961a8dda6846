"""The scripts around the tests, and what the tests themselves are built on."""

from __future__ import annotations

import ast
import re
import tomllib
from pathlib import Path

import pytest
from mutants import Mutant, mutants_of
from support.each import for_each
from support.places import ROOT

SOURCE = '''\
"""A docstring with 1 + 1."""

from __future__ import annotations


def price(count: int = 3, *, old: bool = False) -> float | None:
    """Return 2."""
    if count <= 0 or not old:
        raise ValueError(f"{count + 1}")
    total = 2.5 * count
    while True:
        total -= 1
        if total < 5:
            break
    print(total)
    return total if old else None
'''


def changed(mutant: Mutant) -> str:
    data = SOURCE.encode()
    return (data[: mutant.start] + mutant.new.encode() + data[mutant.end :]).decode()


def test_each_mutant_is_one_change_of_what_runs() -> None:
    mutants = list(mutants_of("price.py", SOURCE))
    found = sorted((mutant.line, mutant.kind, mutant.old, mutant.new) for mutant in mutants)
    assert found == [
        (6, "constant", "False", "True"),
        (6, "off by one", "3", "(2)"),
        (6, "off by one", "3", "4"),
        (8, "boolean", "count <= 0 or not old", "(count <= 0 and (not old))"),
        (8, "boolean", "not old", "(old)"),
        (8, "comparison", "count <= 0", "(count < 0)"),
        (8, "off by one", "0", "(-1)"),
        (8, "off by one", "0", "1"),
        (9, "removed", 'raise ValueError(f"{count + 1}")', "pass"),
        (10, "arithmetic", "2.5 * count", "(2.5 // count)"),
        (10, "constant", "2.5", "5.0"),
        (11, "constant", "True", "False"),
        (12, "arithmetic", "total -= 1", "total += 1"),
        (12, "off by one", "1", "(0)"),
        (12, "off by one", "1", "2"),
        (12, "removed", "total -= 1", "pass"),
        (13, "comparison", "total < 5", "(total <= 5)"),
        (13, "off by one", "5", "(4)"),
        (13, "off by one", "5", "6"),
        (14, "removed", "break", "pass"),
        (15, "removed", "print(total)", "pass"),
        (16, "boolean", "total if old else None", "(total if not old else None)"),
    ]
    for mutant in mutants:
        assert ast.unparse(ast.parse(changed(mutant))) != ast.unparse(ast.parse(SOURCE))


def test_a_law_of_many_values_names_the_one_that_breaks_it(tmp_path: Path) -> None:
    seen = []

    @for_each("number", [1, 2, 3, 4])
    def law(number: int, tmp_path: Path) -> None:
        seen.append((number, tmp_path))
        if number == 2:
            pytest.skip("needs an odd number")
        assert number < 3

    with pytest.raises(AssertionError) as caught:
        law(tmp_path=tmp_path)
    assert caught.value.__notes__ == ["with number = 3"]
    assert seen == [(number, tmp_path) for number in (1, 2, 3)]


def test_the_steps_for_libraries_run_all_their_tests() -> None:
    """They name where these are, so that not all others are collected."""
    script = (ROOT / "scripts" / "check.sh").read_text("utf-8")
    chosen = '-m "libraries and $1" "${workers[@]}" "${again[@]}" '
    named = tuple(script.partition(chosen)[2].partition("}")[0].replace("\\", "").split())
    mark = "pytest.mark." + "libraries"
    marked = [
        path.relative_to(ROOT).as_posix()
        for path in (ROOT / "tests").rglob("test_*.py")
        if mark in path.read_text("utf-8")
    ]
    assert marked
    assert [path for path in marked if not path.startswith(named)] == []


def test_slow_and_flaky_places_are_places(pytestconfig: pytest.Config) -> None:
    plugins = pytestconfig.pluginmanager.get_plugins()
    shared = next(plugin for plugin in plugins if hasattr(plugin, "FLAKY"))
    for place in (*shared.SLOW, *shared.FLAKY):
        assert (ROOT / "tests" / place).exists(), place


def test_the_lowest_versions_are_those_that_the_project_allows() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    bounds = [*project["dependencies"], *project["optional-dependencies"]["fast"]]
    lines = (ROOT / "scripts" / "lowest.txt").read_text(encoding="utf-8").splitlines()
    lowest = sorted(line.replace("==", ">=") for line in lines if "==" in line)
    # Version 11 is 11.0.0.
    assert [re.sub(r"(\.0)+$", "", line) for line in lowest] == sorted(bounds)
