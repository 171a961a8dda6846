"""`generate`: the files of a suite from Python, as the command writes them."""

from __future__ import annotations

import pickle
from pathlib import Path
from typing import Any

import pytest
from support.sessions import environment, run_here

import babyrobot_levels as brl
from babyrobot_levels.extensions.generate.batch import Batch, origin_of
from babyrobot_levels.generation.candidates import Maker
from babyrobot_levels.language.suite import SuiteFields

pytestmark = pytest.mark.usefixtures("here")
SUITE = {"version": 1, "kind": "suite", "name": "few", "count": 12, "size": [5, 4]}


def contents(folder: str) -> dict[str, bytes]:
    paths = sorted(path for path in Path(folder).rglob("*") if path.is_file())
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in paths}


@pytest.mark.slow
@pytest.mark.parametrize("options", [{}, {"jobs": 2}, {"executor": "processes"}])
def test_the_files_are_those_of_the_command(options: dict[str, Any]) -> None:
    levels = brl.generate("wet-mazes", "here", count=10, **options)
    call = ["generate", "wet-mazes", "--count", "10", "-o", "there"]
    assert run_here(call, environment(Path.cwd())).status == 0
    assert contents("here") == contents("there")
    assert [level.index for level in levels] == [*range(10)]
    assert {level.path.relative_to("here").as_posix() for level in levels} == set(contents("here"))
    assert all(level.is_new and level.error is None for level in levels)


def test_levels_that_were_made_before_an_interruption_are_kept() -> None:
    def interrupt(done: int, total: int) -> None:
        assert total == 12
        if done == 3:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        brl.generate(SUITE, "out", progress=interrupt)
    assert [*contents("out")] == [f"few-0000{number}.yaml" for number in range(3)]
    resumed = brl.generate(SUITE, "out", resume=True)
    assert [level.is_new for level in resumed] == 3 * [False] + 9 * [True]
    assert repr(resumed).startswith("12 levels\n  out/few-00000.yaml\n")


@pytest.mark.slow
def test_conditions_are_the_fields_of_a_suite() -> None:
    conditions: dict[str, Any] = {"size": (6, 4), "keys": 1, "path_length": {"min": 8}, "seed": 3}
    made = brl.generate(None, "here", count=4, **conditions)
    call = ["generate", "--size", "6x4", "--keys", "1", "--path-length", "8..", "--seed", "3"]
    assert run_here([*call, "--count", "4", "-o", "there"], environment(Path.cwd())).status == 0
    levels = [brl.load(level.path) for level in made]
    assert [each.digest for each in levels] == [
        brl.load(Path("there", level.path.name)).digest for level in made
    ]
    with pytest.raises(brl.LevelError, match="`keys` must be"):
        brl.generate(count=1, keys="many")
    with pytest.raises(brl.LevelError, match="unknown field `key`"):
        brl.generate(count=1, key=2)
    with pytest.raises(ValueError, match="keys cannot be combined with a suite"):
        brl.generate(SUITE, "other", keys=2)
    with pytest.raises(ValueError, match=r"names: expected a text such as 'maze-\{index:02\}'"):
        brl.generate(SUITE, "other", names="maze")


def test_what_is_excluded_is_not_generated_again() -> None:
    first = brl.generate(None, "first", count=3, size=(4, 3), names="a-{index}", title="A {index}")
    assert brl.load("first/a-0.yaml").title == "A 0"
    others = brl.generate(None, "others", count=3, size=(4, 3), exclude="first")
    digests = [[brl.load(each.path).digest for each in made] for made in (first, others)]
    assert not {*digests[0]} & {*digests[1]}


def test_the_theme_beside_a_suite_goes_with_its_levels() -> None:
    Path("themes").mkdir()
    Path("themes", "mine.yaml").write_text("colors: {walls: '#123456'}\n", encoding="utf-8")
    Path("own.yaml").write_text(
        "version: 1\nkind: suite\ncount: 2\ntheme: mine\n", encoding="utf-8"
    )
    for level in brl.generate("own.yaml", "out", jobs=2):
        assert "#123456" in level.path.read_text("utf-8")


def test_wrong_calls_are_told_at_once() -> None:
    brl.generate(SUITE, "out")
    with pytest.raises(brl.FolderError, match="out already contains 12 of these levels"):
        brl.generate(SUITE, "out")
    with pytest.raises(ValueError, match="lists its levels"):
        brl.generate("classics", "out")
    with pytest.raises(ValueError, match="is a part of one"):
        brl.generate(brl.load_suite(SUITE)[:3], "out")
    with pytest.raises(ValueError, match="'processes', 'ray', not 'threads'"):
        brl.generate(SUITE, "other", executor="threads")  # type: ignore[arg-type]


def test_processes_are_not_sent_what_is_excluded() -> None:
    fields = SuiteFields.model_validate(SUITE)
    few = Batch(fields, "level-{index}", "few", frozenset({"a" * 64}))
    many = Batch(fields, "level-{index}", "few", frozenset(f"{n:064}" for n in range(1000)))
    sent = [pickle.dumps(each) for each in (few, many)]
    assert len(sent[0]) == len(sent[1])
    # The files still tell the two apart.
    level = Maker(fields, "level").draw(0, 0).level
    heads = [pickle.loads(each).text(0, 0, level) for each in sent]
    assert [origin_of(head) for head in heads] == [(few.mark, 0, 0), (many.mark, 0, 0)]
    assert few.mark != many.mark


MIXED: dict[str, Any] = {
    "version": 1,
    "kind": "suite",
    "name": "mixed",
    "seed": 7,
    "count": 120,
    "size": {"min": [4, 4], "max": [7, 6]},
    "maze": {"algorithm": ["wilson", "depth-first"], "loops": {"max": 0.4}},
    "puddles": {"max": 3},
    "exit": "random",
    "rewards": {"exit": 10},
    "discount": 0.9,
    "max_steps": 99,
    "theme": "green",
    "splits": {"train": 0.75, "test": 0.25},
}


@pytest.mark.slow
def test_a_level_of_a_suite_is_the_file_that_generate_writes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    mixed = brl.load_suite(MIXED)
    Path("mixed.yaml").write_text(mixed.to_yaml(), "utf-8")
    assert run_here(["generate", "mixed.yaml", "-o", "out"], environment(tmp_path)).status == 0
    for number in (0, 5, 89, 90, 119):
        folder = "train" if number < 90 else "test"
        text = Path("out", folder, f"mixed-{number:05}.yaml").read_text("utf-8")
        assert text.split("\n", 2)[2] == mixed[number].to_yaml()
        assert "suite mixed, seed 7" in text


def test_a_suite_that_lists_its_levels_has_nothing_to_generate(here: Path) -> None:
    Path("course.yaml").write_text("version: 1\nkind: suite\nlevels: [maze]\n", "utf-8")
    done = run_here(["generate", "course.yaml", "-o", "out"], environment(here))
    assert (done.status, done.err.splitlines()[0]) == (
        2,
        "error: course lists its levels, so there is nothing to generate",
    )
