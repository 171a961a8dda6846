"""`babyrobot generate`: what it writes and refuses, and that its files never depend on luck."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from support.combinations import swept
from support.folders import write_files
from support.sessions import babyrobot, environment

import babyrobot_levels as brl

pytestmark = pytest.mark.usefixtures("here")


def contents(folder: Path) -> dict[str, bytes]:
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }


def levels_in(folder: Path) -> list[brl.Level]:
    return [brl.load(path) for path in sorted(folder.rglob("*.yaml"))]


VARIED = (
    *("--size", "4x5..9x7", "--algorithm", "wilson", "--algorithm", "prim", "--seed", "5"),
    *("--loops", "0..1", "--puddles", "0..3", "--start", "random", "--exit", "random"),
    *("--split", "a=0.5,b=0.5"),
)
REWARDED = (
    *("--expect", "best_return=-1..", "--expect", "states=36..", "--coins", "1"),
    *("--size", "6x6", "--seed", "5", "--guards", "1", "--loops", "0.5", "--hit", "-7.5"),
    *("--rewards", "step=-0.5,exit=2", "--discount", "0.95", "--max-steps", "60"),
)
CONDITIONS = (
    *("--path-length", "24..30", "--dead-ends", "4..5", "--difficulty", "1..9"),
    *("--exit", "farthest", "--theme", "green", "--name", "maze-{index:03}"),
)


@pytest.mark.slow
@pytest.mark.parametrize("order", [VARIED, CONDITIONS], ids=["varied", "conditions"])
def test_levels_are_clean_different_and_solvable_whoever_makes_them(order: tuple[str, ...]) -> None:
    for jobs in ("1", "3"):
        done = babyrobot("generate", "--count", "20", *order, "--jobs", jobs, "-o", jobs)
        assert (done.status, done.err) == (0, "")
        assert done.out.startswith(f"wrote 20 levels to {jobs}")
    assert contents(Path("1")) == contents(Path("3"))
    found = levels_in(Path("1"))
    assert len(found) == len({level.digest for level in found}) == 20
    for level in found:
        metrics = brl.metrics(level)
        assert metrics.reachable == 1
        assert metrics.path_length is not None
        assert order == VARIED or (24 <= metrics.path_length <= 30 and metrics.dead_ends in (4, 5))
    assert babyrobot("lint", "1").out == "20 files checked, all clean\n"
    assert babyrobot("format", "--check", "1").status == 0


def test_ends_are_where_they_were_ordered() -> None:
    for place in ("corner", "random", "farthest"):
        order = ["--start", "corner", "--exit", place, "--size", "5x4"]
        assert babyrobot("generate", "--count", "8", *order, "-o", place).status == 0
    assert {level.exits for level in levels_in(Path("corner"))} == {((4, 3),)}
    assert len({level.exits for level in levels_in(Path("random"))}) > 3
    for level in levels_in(Path("farthest")):
        away = {cell: brl.metrics(level.replace(exit=cell)).path_length for cell in cells(level)}
        assert max(filter(None, away.values())) == away[level.exits[0]]


def cells(level: brl.Level) -> list[tuple[int, int]]:
    width, height = level.size
    every = [(x, y) for x in range(width) for y in range(height)]
    return [cell for cell in every if cell not in level.starts]


@pytest.mark.slow
@pytest.mark.parametrize(
    "order",
    [
        pytest.param(VARIED, id="varied"),
        pytest.param(REWARDED, id="rewarded", marks=pytest.mark.sweep),
    ],
)
def test_the_call_in_a_file_makes_the_file(order: tuple[str, ...]) -> None:
    babyrobot("generate", "--count", "20", *order, "-o", "one")
    (file,) = Path("one").rglob("level-00015.yaml")
    told = file.read_text("utf-8").splitlines()[1].removeprefix("# babyrobot ").split()
    assert babyrobot(*told, "--count", "20", "-o", "two").status == 0
    assert contents(Path("one")) == contents(Path("two"))


# -- splits and exclusions -------------------------------------------------------------------


@pytest.mark.slow
def test_no_game_of_another_folder_is_made() -> None:
    order = ["generate", "--size", "3x3", "--algorithm", "wilson", "--exit", "random"]
    assert babyrobot(*order, "--count", "20", "-o", "first").status == 0
    Path("first", "no-level.yaml").write_text("colour: red\n", "utf-8")
    assert babyrobot(*order, "--count", "20", "-o", "second", "--exclude", "first").status == 0
    assert babyrobot(*order, "--count", "20", "-o", "third").status == 0
    Path("first", "no-level.yaml").unlink()
    first, second, third = (
        {level.digest for level in levels_in(Path(name))} for name in ("first", "second", "third")
    )
    assert first == third
    assert first.isdisjoint(second)
    assert len(second) == 20


# -- orders that cannot be met ---------------------------------------------------------------


@pytest.mark.sweep
@pytest.mark.parametrize(
    ("order", "said"),
    [
        (
            ["--path-length", "90..99"],
            r"--path-length 90\.\.99: the largest of [\d,]+ candidates was 3",
        ),
        (
            ["--path-length", "14"],
            r"--path-length 14: the nearest of [\d,]+ candidates were 13 and 15",
        ),
        # The optimum is to stay where it costs nothing.
        (["--rewards", "step=0,exit=-1"], "--expect success=1: the largest of 1,000 .* was 0"),
        # The optimum never ends, and is inf.
        (["--rewards", "step=1"], "--expect success=1: none of 1,000 candidates has one"),
        (
            ["--expect", "best_steps=90.."],
            r"--expect best_steps=90\.\.: the largest of 1,000 .* \d",
        ),
        (["--expect", "turns=..1"], r"--expect turns=\.\.1: the smallest of [\d,]+ candidates was"),
        (
            ["--size", "7x7", "--keys", "2", "--expect", "needs=key"],
            r"--expect needs=\[key\]: none of 1,000 candidates has these",
        ),
        (["--difficulty", "50.."], r"--difficulty 50\.\.: the largest of 1,000 candidates was \d"),
        (
            ["--path-length", "35..", "--dead-ends", "9.."],
            r"--dead-ends 9\.\.: \d+ of 10,000 candidates met it, \d+ met --path-length 35",
        ),
    ],
)
def test_what_starves_is_told(order: list[str], said: str) -> None:
    done = babyrobot("generate", "--count", "3", *order, "-o", "out")
    assert done.status == 1
    first, second, *hint = done.err.splitlines()
    assert re.match("level 0: " + said, first)
    # A larger size helps where all values are too small, and only there.
    is_count = not re.search("difficulty|success|best_steps", first)
    assert ("  help: use a larger size" in "".join(hint)) == ("largest" in first and is_count)
    assert ("the best policy has to win" in "".join(hint)) == ("success=1" in first)
    assert second == "  0 of 3 levels are in out"
    assert contents(Path()) == {}


@pytest.mark.sweep
def test_levels_that_cannot_be_made_can_be_left_out() -> None:
    order = ["--count", "7", "--size", "3x3", "--loops", "0", "--path-length", "8"]
    done = babyrobot("generate", *order, "--keep-going", "--jobs", "2", "-o", "out")
    left_out = re.findall(
        r"^level (\d): --count 7: .* duplicates of earlier levels$", done.err, re.M
    )
    names = {f"level-{number:05}.yaml" for number in range(7)}
    assert 0 < len(left_out) == len(done.err.splitlines()) < 7
    assert set(contents(Path("out"))) == names - {f"level-0000{number}.yaml" for number in left_out}
    made = 7 - len(left_out)
    assert done.status == 1
    assert done.out == f"wrote {made} levels to out; left out {len(left_out)}\n"


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ([], "the number of levels is missing"),
        (["--count", "0"], "--count: must be at least 1"),
        (["--count", "2", "--size", "8"], "--size: invalid size '8'"),
        (["--count", "2", "--size", "2x1"], "--size: a level of 2 cells"),
        (["--count", "2", "--path-length", "9..5"], "--path-length: `min` (9) is above"),
        (["--count", "2", "--path-length", ".."], "--path-length: invalid range '..'"),
        (["--count", "2", "--puddles", "3.."], "--puddles: missing field `max`"),
        (["--count", "2", "--split", "a=0.5,b"], "--split: invalid value 'a=0.5,b'"),
        (["--count", "2", "--split", "a=0.9,b=0.1"], "--split: `b` gets none of the 2 levels"),
        (["--count", "2", "--split", "../x=1"], "--split: "),
        (["--count", "2", "--rewards", "step=-1,step=2"], "--rewards: invalid value 'step=-1,s"),
        (["--count", "2", "--rewards", "goal=1"], "--rewards: unknown field `goal`; did you mean"),
        (["--count", "2", "--hit", "-9"], "--hit: without guards nothing hits the robot"),
        (["--count", "2", "--discount", "1.5"], "--discount: must be at most 1"),
        (["--count", "2", "--max-steps", "0"], "--max-steps: must be at least 1"),
        (["--count", "2", "--expect", "states"], "--expect: invalid value 'states'"),
        (["--count", "2", "--expect", "sates=3"], "unknown field `sates`; did you mean `states`?"),
        (["--count", "2", "--expect", "lint=clean"], "it is for level files: generate the levels"),
        (["--count", "2", "--expect", "turns=9..5"], "--expect: the range is upside down: 9 is"),
        (["--count", "2", "--expect", "needs=key"], "only levels with things have `needs`"),
        (["--count", "2", "--theme", "pink"], "unknown theme `pink`"),
        (["--count", "2", "--name", "../{index}"], "--name: invalid pattern '../{index}'"),
        (["--count", "2", "--name", "{index.real}"], "--name: invalid pattern '{index.real}'"),
        (["--count", "2", "--exclude", "nowhere"], "--exclude: nowhere is not a folder"),
        (["--count", "5000000"], "--count must be at most 1,000,000"),
        (["small-mazes", "--count", "1"], "--count: `test` gets none of the 1 levels; use more"),
        (["small-mazes", "--size", "3x3"], "--size cannot be combined with a suite"),
        (["small-maze"], "there is no suite called 'small-maze'; did you mean 'small-mazes'?"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else "",
)
def test_wrong_calls(arguments: list[str], said: str) -> None:
    done = babyrobot("generate", *arguments, "-o", "out")
    assert said in done.err
    assert done.status == 2
    assert not Path("out").exists()


# -- suites with a theme of their own ----------------------------------------------------------


def test_levels_carry_the_theme_that_stands_beside_their_suite() -> None:
    suite = "version: 1\nkind: suite\nname: rains\nseed: 1\ncount: 4\nsize: [4, 4]\nmaze: {}\n"
    files = {
        "pack.yaml": "name: ark\nversion: 1.0.0\n",
        "themes/sea.yaml": "colors: {base: '#cceeff'}\n",
        "suites/rains.yaml": f"{suite}start: farthest\ntheme: sea\n",
        # Themes that are everywhere keep their names.
        "suites/green.yaml": f"{suite}theme: green\n",
    }
    path = write_files(Path("ark"), files) / "suites" / "rains.yaml"
    assert babyrobot("generate", path, "--count", "2", "-o", "out").status == 0
    written = levels_in(Path("out"))
    assert len(written) == 2
    for level, drawn in zip(written, brl.load_suite(path), strict=False):
        assert level.to_svg() == drawn.to_svg()
        assert level.digest == drawn.digest
        assert "colors" in level.to_dict()["theme"]
    assert babyrobot("generate", path, "--count", "2", "-o", "out", "--resume").status == 0
    babyrobot("generate", path.with_name("green.yaml"), "-o", "green")
    assert levels_in(Path("green"))[0].to_dict()["theme"] == "green"


# -- what is there already -------------------------------------------------------------------


def test_nothing_is_written_over_without_force() -> None:
    order = ["generate", "--count", "5", "-o", "out"]
    babyrobot(*order)
    before = contents(Path("out"))
    done = babyrobot(*order)
    assert (done.status, "use --resume to generate the missing ones" in done.err) == (2, True)
    done = babyrobot(*order, "--seed", "1", "--resume")
    assert (done.status, "was generated with other options" in done.err) == (2, True)
    assert contents(Path("out")) == before
    assert babyrobot(*order, "--seed", "1", "--force").status == 0
    assert contents(Path("out")).keys() == before.keys()
    assert not set(contents(Path("out")).values()) & set(before.values())


def test_levels_of_several_calls_are_in_one_folder() -> None:
    order = ["generate", "--count", "2", "-o", "out"]
    babyrobot(*order)
    before = contents(Path("out"))
    other = ["--seed", "1", "--name", "other-{index}"]
    assert babyrobot(*order, *other).status == 0
    assert babyrobot(*order, *other, "--resume").out == "wrote 0 levels to out; kept 2\n"
    assert contents(Path("out")).items() > before.items()
    assert babyrobot(*order, "--count", "3", "--resume").out == "wrote 1 level to out; kept 2\n"


def test_other_peoples_files_stay() -> None:
    Path("out").mkdir()
    Path("out", "level-00003.yaml").write_text("version: 1\n", "utf-8")
    Path("out", "mine.yaml").write_text("version: 1\n", "utf-8")
    done = babyrobot("generate", "--count", "5", "--resume", "-o", "out")
    assert done.status == 2
    assert "level-00003.yaml already exists and was not generated" in done.err
    assert len(contents(Path("out"))) == 2
    assert babyrobot("generate", "--count", "3", "-o", "out").status == 0
    assert Path("out", "mine.yaml").read_text("utf-8") == "version: 1\n"


@pytest.mark.slow
def test_resuming_ends_with_the_same_files() -> None:
    order = ["generate", *CONDITIONS]
    babyrobot(*order, "--count", "20", "-o", "whole")
    # It can grow, too.
    babyrobot(*order, "--count", "15", "-o", "part")
    for number in (*range(3), 12):
        Path("part", f"maze-{number:03}.yaml").unlink()
    done = babyrobot(*order, "--count", "20", "-o", "part", "--resume")
    assert done.out == "wrote 9 levels to part; kept 11\n"
    assert contents(Path("part")) == contents(Path("whole"))


@pytest.mark.slow
def test_resuming_knows_which_games_are_there() -> None:
    # So few games that many tries are of one that is there.
    order = ["generate", "--count", "30", "--size", "3x4", "--exit", "random"]
    babyrobot(*order, "-o", "whole")
    babyrobot(*order, "-o", "part")
    for number in range(10, 30):
        Path("part", f"level-{number:05}.yaml").unlink()
    babyrobot(*order, "-o", "part", "--resume", "--jobs", "2")
    assert contents(Path("part")) == contents(Path("whole"))


def test_a_file_that_was_changed_is_not_taken_for_one_of_the_order() -> None:
    babyrobot("generate", "--count", "5", "-o", "out")
    path = Path("out", "level-00002.yaml")
    path.write_text(path.read_text("utf-8") + "discount: 0.5\n", "utf-8")
    done = babyrobot("generate", "--count", "5", "-o", "out", "--resume")
    assert (done.status, "differs from the generated level" in done.err) == (2, True)
    assert path.read_text("utf-8").endswith("discount: 0.5\n")


@pytest.mark.slow
@pytest.mark.parametrize("jobs", swept(["2"], ["1"]))
def test_an_interrupted_call_leaves_whole_files_and_can_go_on(jobs: str, tmp_path: Path) -> None:
    order = ["generate", "--count", "200", "--size", "20x20", "--path-length", "60..", "-o"]
    command = [sys.executable, "-m", "babyrobot_levels", *order, "cut", "--jobs", jobs]
    process = subprocess.Popen(
        command, env=environment(tmp_path), stdout=subprocess.PIPE, stderr=subprocess.PIPE
    )
    while len(list(Path().glob("cut/*.yaml"))) < 20 and process.poll() is None:
        time.sleep(0.01)
    process.send_signal(signal.SIGINT)
    out, err = (text.decode() for text in process.communicate(timeout=60))
    assert process.returncode == 130, err
    assert out == ""
    made = contents(Path("cut"))
    assert 20 <= len(made) < 200
    assert err == (
        f"stopped: {len(made)} of 200 levels are in cut\n"
        "  help: continue with the same call and --resume\n"
    )
    assert babyrobot(*order, "whole").status == 0
    whole = contents(Path("whole"))
    assert made == {name: whole[name] for name in sorted(whole)[: len(made)]}
    assert babyrobot(*order, "cut", "--resume").status == 0
    assert contents(Path("cut")) == whole


@pytest.mark.skipif(os.name == "nt", reason="there are no permissions of this kind")
def test_a_folder_that_cannot_be_written_to_is_told_of() -> None:
    Path("out").write_text("", "utf-8")
    done = babyrobot("generate", "--count", "5", "-o", "out")
    assert (done.status, done.err) == (2, "error: out is not a folder\n")
