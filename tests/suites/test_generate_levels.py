"""`generate_levels`: the files of a suite from Python, as the command writes them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from support.sessions import environment, run_here

import babyrobot_levels as brl
from babyrobot_levels.generation.candidates import Maker
from babyrobot_levels.language.suite import SuiteFields
from babyrobot_levels.suites.batch import Batch, origin_of

pytestmark = pytest.mark.usefixtures("here")
SUITE = {"version": 1, "kind": "suite", "name": "few", "count": 12, "size": [5, 4]}


def contents(folder: str) -> dict[str, bytes]:
    paths = sorted(path for path in Path(folder).rglob("*") if path.is_file())
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in paths}


@pytest.mark.parametrize("options", [{}, {"jobs": 2}, {"executor": "processes"}])
def test_the_files_are_those_of_the_command(options: dict[str, Any]) -> None:
    levels = list(brl.generate_levels("wet-mazes", "here", count=10, **options))
    call = ["generate", "wet-mazes", "--count", "10", "-o", "there"]
    assert run_here(call, environment(Path.cwd())).status == 0
    assert contents("here") == contents("there")
    assert [level.index for level in levels] == [*range(10)]
    assert {level.path.relative_to("here").as_posix() for level in levels} == set(contents("here"))
    assert all(level.is_new and level.error is None for level in levels)


def test_levels_are_generated_when_they_are_asked_for() -> None:
    levels = brl.generate_levels(SUITE, "out")
    assert not Path("out").exists()
    assert next(levels).path == Path("out", "few-00000.yaml")
    assert len(contents("out")) == 1
    levels.close()
    resumed = list(brl.generate_levels(SUITE, "out", resume=True))
    assert [level.is_new for level in resumed] == [False] + 11 * [True]


def test_the_theme_beside_a_suite_goes_with_its_levels() -> None:
    Path("themes").mkdir()
    Path("themes", "mine.yaml").write_text("colors: {walls: '#123456'}\n", encoding="utf-8")
    Path("own.yaml").write_text(
        "version: 1\nkind: suite\ncount: 2\ntheme: mine\n", encoding="utf-8"
    )
    for level in brl.generate_levels("own.yaml", "out", jobs=2):
        assert "#123456" in level.path.read_text("utf-8")


def test_wrong_calls_are_told_at_once() -> None:
    list(brl.generate_levels(SUITE, "out"))
    with pytest.raises(brl.FolderError, match="out already contains 12 of these levels"):
        brl.generate_levels(SUITE, "out")
    with pytest.raises(ValueError, match="lists its levels"):
        brl.generate_levels("classics", "out")
    with pytest.raises(ValueError, match="is a part of one"):
        brl.generate_levels(brl.load_suite(SUITE)[:3], "out")
    with pytest.raises(ValueError, match="no executor 'threads'"):
        brl.generate_levels(SUITE, "other", executor="threads")  # type: ignore[arg-type]


def test_processes_are_not_sent_what_is_excluded() -> None:
    fields = SuiteFields.model_validate(SUITE)
    few = Batch(fields, "level-{index}", "few", frozenset({"a" * 64}))
    many = Batch(fields, "level-{index}", "few", frozenset(f"{n:064}" for n in range(1000)))
    orders = few.order(), many.order()
    assert [len(str(order)) for order in orders] == 2 * [len(str(orders[0]))]
    # The files still tell the two apart.
    heads = [order.text(0, 0, Maker(fields, "level").draw(0, 0).level) for order in orders]
    assert [origin_of(head) for head in heads] == [(few.mark, 0, 0), (many.mark, 0, 0)]
    assert few.mark != many.mark
