"""`babyrobot generate`: what it writes and refuses, and that its files never depend on luck."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from support.sessions import Result, environment, run_here

import babyrobot_levels as brl

Babyrobot = Callable[..., Result]


@pytest.fixture
def babyrobot(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Babyrobot:
    """Return a function that runs the command in an empty folder."""
    monkeypatch.chdir(tmp_path)

    def run(*arguments: str | Path) -> Result:
        return run_here([*map(str, arguments)], environment(tmp_path))

    return run


def contents(folder: Path) -> dict[str, bytes]:
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }


def levels_in(folder: Path) -> list[brl.Level]:
    return [brl.load(path) for path in sorted(folder.rglob("*.yaml"))]


ORDERS = {
    "plain": [],
    "sizes and characters": [
        *("--size", "4x5..9x7", "--algorithm", "wilson", "--algorithm", "prim"),
        *("--loops", "0..1", "--puddles", "0..3", "--start", "random", "--exit", "random"),
    ],
    "ends far apart": ["--start", "farthest", "--exit", "farthest", "--puddles", "2"],
    "conditions": [
        *("--path-length", "24..30", "--dead-ends", "4..5", "--difficulty", "1..9"),
        *("--exit", "farthest", "--theme", "green", "--name", "maze-{index:03}"),
    ],
    "splits": ["--split", "train=0.6,test=0.4", "--size", "4x4"],
}


@pytest.mark.parametrize("name", ORDERS)
def test_levels_are_clean_different_and_solvable(name: str, babyrobot: Babyrobot) -> None:
    done = babyrobot("generate", "--count", "30", *ORDERS[name], "-o", "out")
    assert (done.status, done.err) == (0, "")
    assert done.out.startswith("wrote 30 levels to out")
    found = levels_in(Path("out"))
    assert len(found) == len({level.digest for level in found}) == 30
    for level in found:
        assert brl.solve(level).expected_steps < float("inf")
        assert brl.metrics(level).reachable == 1
    assert babyrobot("lint", "out").out == "30 files checked, all clean\n"
    assert babyrobot("format", "--check", "out").status == 0


@pytest.mark.parametrize("name", ORDERS)
def test_the_files_do_not_depend_on_the_jobs(name: str, babyrobot: Babyrobot) -> None:
    order = ["generate", "--count", "50", *ORDERS[name]]
    for jobs in ("1", "2", "3"):
        assert babyrobot(*order, "-o", jobs, "--jobs", jobs).status == 0
    assert len(contents(Path("1"))) == 50
    assert contents(Path("1")) == contents(Path("2")) == contents(Path("3"))


def test_another_seed_gives_other_levels(babyrobot: Babyrobot) -> None:
    for seed in ("1", "2"):
        babyrobot("generate", "--count", "10", "--seed", seed, "-o", seed)
    digests = [{level.digest for level in levels_in(Path(seed))} for seed in ("1", "2")]
    assert digests[0].isdisjoint(digests[1])


def test_conditions_hold(babyrobot: Babyrobot) -> None:
    order = ["--path-length", "14..18", "--dead-ends", "5", "--puddles", "2..3", "--size", "6x6"]
    assert babyrobot("generate", "--count", "15", *order, "-o", "out").status == 0
    for level in levels_in(Path("out")):
        metrics = brl.metrics(level)
        assert metrics.path_length is not None
        assert 14 <= metrics.path_length <= 18
        assert metrics.dead_ends == 5
        assert 2 <= len(level.puddles) <= 3
        assert level.size == (6, 6)


def test_ends_are_where_they_were_ordered(babyrobot: Babyrobot) -> None:
    for place in ("corner", "random", "farthest"):
        order = ["--start", "corner", "--exit", place, "--size", "7x6"]
        assert babyrobot("generate", "--count", "12", *order, "-o", place).status == 0
    assert {level.exits for level in levels_in(Path("corner"))} == {((6, 5),)}
    assert len({level.exits for level in levels_in(Path("random"))}) > 5
    for level in levels_in(Path("farthest")):
        away = {cell: brl.metrics(level.replace(exit=cell)).path_length for cell in cells(level)}
        assert max(filter(None, away.values())) == away[level.exits[0]]


def cells(level: brl.Level) -> list[tuple[int, int]]:
    width, height = level.size
    every = [(x, y) for x in range(width) for y in range(height)]
    return [cell for cell in every if cell not in level.starts]


def test_a_file_says_where_it_comes_from(babyrobot: Babyrobot) -> None:
    babyrobot("generate", "--count", "12", "--size", "5x5", "--seed", "3", "-o", "out")
    first, second, *rest = Path("out", "level-00011.yaml").read_text("utf-8").splitlines()
    assert re.fullmatch(r"# Level 11 of the order [0-9a-f]{12}, try \d+:", first)
    assert second == "# babyrobot generate --size 5x5 --seed 3"
    assert rest[:2] == ["version: 1", "name: level-00011"]


def test_the_call_in_a_file_makes_the_file(babyrobot: Babyrobot) -> None:
    order = [*ORDERS["sizes and characters"], "--seed", "5", "--split", "a=0.5,b=0.5"]
    babyrobot("generate", "--count", "20", *order, "-o", "one")
    told = Path("one", "b", "level-00015.yaml").read_text("utf-8").splitlines()[1]
    assert babyrobot(*told.removeprefix("# babyrobot ").split(), "-o", "two").status == 0
    assert contents(Path("one")) == contents(Path("two"))


# -- splits and exclusions -------------------------------------------------------------------


def test_splits_share_no_maze(babyrobot: Babyrobot) -> None:
    order = ["--size", "3x3..4x4", "--algorithm", "wilson", "--puddles", "0..2"]
    done = babyrobot("generate", "--count", "150", *order, "--split", "a=0.7,b=0.3", "-o", "out")
    assert done.out == "wrote 150 levels to out: 105 in a, 45 in b\n"
    mazes = [
        {(level.size, level.grid().open_bits) for level in levels_in(Path("out", part))}
        for part in "ab"
    ]
    # Mazes do come again inside of a split, with other puddles: the sizes are small.
    assert len(mazes[0]) < 105
    assert mazes[0].isdisjoint(mazes[1])


def test_no_game_of_another_folder_is_made(babyrobot: Babyrobot) -> None:
    order = ["generate", "--size", "3x3", "--algorithm", "wilson", "--exit", "random"]
    assert babyrobot(*order, "--count", "40", "-o", "first").status == 0
    Path("first", "no-level.yaml").write_text("colour: red\n", "utf-8")
    assert babyrobot(*order, "--count", "40", "-o", "second", "--exclude", "first").status == 0
    assert babyrobot(*order, "--count", "40", "-o", "third").status == 0
    Path("first", "no-level.yaml").unlink()
    first, second, third = (
        {level.digest for level in levels_in(Path(name))} for name in ("first", "second", "third")
    )
    assert first == third
    assert first.isdisjoint(second)
    assert len(second) == 40


# -- orders that cannot be met ---------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize(
    ("order", "said"),
    [
        (
            ["--path-length", "90..99"],
            r"--path-length 90\.\.99: the largest of [\d,]+ candidates was 3",
        ),
        (["--path-length", "..3"], r"--path-length \.\.3: the smallest of [\d,]+ candidates was 1"),
        (
            ["--path-length", "14"],
            r"--path-length 14: the nearest of [\d,]+ candidates were 13 and 15",
        ),
        (["--dead-ends", "30.."], r"--dead-ends 30\.\.: the largest of [\d,]+ candidates was \d+"),
        (["--difficulty", "50.."], r"--difficulty 50\.\.: the largest of 1,000 candidates was \d"),
        (
            ["--path-length", "35..", "--dead-ends", "9.."],
            r"--dead-ends 9\.\.: \d+ of 10,000 candidates met it, \d+ met --path-length 35",
        ),
    ],
)
def test_what_starves_is_told(order: list[str], said: str, babyrobot: Babyrobot) -> None:
    done = babyrobot("generate", "--count", "3", *order, "-o", "out")
    assert done.status == 1
    first, second, *hint = done.err.splitlines()
    assert re.match("level 0: " + said, first)
    # A larger size helps where all values are too small, and only there.
    assert bool(hint) == ("largest" in first and "difficulty" not in first)
    assert second == "  0 of 3 levels are in out"
    assert contents(Path()) == {}


@pytest.mark.slow
@pytest.mark.parametrize("jobs", ["1", "2"])
def test_levels_that_cannot_be_made_can_be_left_out(jobs: str, babyrobot: Babyrobot) -> None:
    order = ["--count", "7", "--size", "3x3", "--loops", "0", "--path-length", "8"]
    done = babyrobot("generate", *order, "--keep-going", "--jobs", jobs, "-o", "out")
    left_out = re.findall(
        r"^level (\d): --count 7: .* duplicates of earlier levels$", done.err, re.M
    )
    names = {f"level-{number:05}.yaml" for number in range(7)}
    assert 0 < len(left_out) == len(done.err.splitlines()) < 7
    assert set(contents(Path("out"))) == names - {f"level-0000{number}.yaml" for number in left_out}
    made = 7 - len(left_out)
    assert done.status == 1
    assert done.out == f"wrote {made} levels to out; left out {len(left_out)}\n"


@pytest.mark.slow
@pytest.mark.parametrize("jobs", ["1", "2"])
def test_what_was_made_before_is_there(jobs: str, babyrobot: Babyrobot) -> None:
    order = ["--size", "3x3", "--exit", "random", "--jobs", jobs]
    done = babyrobot("generate", "--count", "1000", *order, "-o", "out")
    assert done.status == 1
    first, second, hint = done.err.splitlines()
    assert re.match(r"level \d+: --count 1000: ", first)
    assert first.endswith("duplicates of earlier levels")
    assert hint == "  help: use a larger size, for example 5x5"
    found = levels_in(Path("out"))
    assert second == f"  {len(found)} of 1,000 levels are in out"
    assert 10 < len(found) == len({level.digest for level in found}) < 1000


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ([], "the number of levels is missing"),
        (["--count", "0"], "--count: must be at least 1"),
        (["--count", "2", "--size", "8"], "--size: invalid size '8'"),
        (["--count", "2", "--size", "8x8..4x4"], "--size: `min` ([8, 8]) is above"),
        (["--count", "2", "--size", "2x1"], "--size: a level of 2 cells"),
        (["--count", "2", "--size", "2000x2"], "--size: must be at most 1024"),
        (["--count", "2", "--path-length", "9..5"], "--path-length: `min` (9) is above"),
        (["--count", "2", "--path-length", ".."], "--path-length: invalid range '..'"),
        (["--count", "2", "--puddles", "3.."], "--puddles: missing field `max`"),
        (["--count", "2", "--puddles", "40"], "--puddles: the smallest level has only 38 cells"),
        (["--count", "2", "--loops", "2"], "--loops: must be at most 1"),
        (["--count", "2", "--split", "a=0.5,b"], "--split: invalid shares 'a=0.5,b'"),
        (["--count", "2", "--split", "a=0.5,b=0.6"], "--split: the shares add up to 1.1"),
        (["--count", "2", "--split", "a=0.9,b=0.1"], "--split: `b` gets none of the 2 levels"),
        (["--count", "2", "--split", "../x=1"], "--split: "),
        (["--count", "2", "--theme", "pink"], "unknown theme `pink`"),
        (["--count", "2", "--name", "level"], "--name: invalid pattern 'level'"),
        (["--count", "2", "--name", "../{index}"], "--name: invalid pattern '../{index}'"),
        (["--count", "2", "--name", "{index.real}"], "--name: invalid pattern '{index.real}'"),
        (["--count", "2", "--start", "farthest", "--size", "300x3"], "--start: levels with"),
        (["--count", "2", "--exclude", "nowhere"], "--exclude: nowhere is not a folder"),
        (["--count", "5000000"], "--count must be at most 1,000,000"),
        (["small-mazes", "--size", "3x3"], "--size cannot be combined with a suite"),
        (["small-maze"], "there is no suite called 'small-maze'; did you mean 'small-mazes'?"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else "",
)
def test_wrong_calls(arguments: list[str], said: str, babyrobot: Babyrobot) -> None:
    done = babyrobot("generate", *arguments, "-o", "out")
    assert said in done.err
    assert done.status == 2
    assert not Path("out").exists()


# -- suites with a theme of their own ----------------------------------------------------------


SUITE = "version: 1\nkind: suite\nname: rains\nseed: 1\ncount: 4\nsize: [4, 4]\nmaze: {}\n"


@pytest.mark.parametrize("start", ["corner", "farthest"])
@pytest.mark.parametrize("count", [[], ["--count", "2"]], ids=["whole", "counted"])
def test_levels_carry_the_theme_that_stands_beside_their_suite(
    start: str, count: list[str], babyrobot: Babyrobot
) -> None:
    pack = Path("ark")
    (pack / "suites").mkdir(parents=True)
    (pack / "themes").mkdir()
    (pack / "pack.yaml").write_text("name: ark\nversion: 1.0.0\n", "utf-8")
    (pack / "themes/sea.yaml").write_text("colors: {base: '#cceeff'}\n", "utf-8")
    path = pack / "suites/rains.yaml"
    path.write_text(f"{SUITE}start: {start}\ntheme: sea\n", "utf-8")
    assert babyrobot("generate", path, *count, "-o", "out").status == 0
    suite = brl.load_suite(path)
    written = levels_in(Path("out"))
    assert len(written) == (2 if count else 4)
    for level, drawn in zip(written, suite, strict=False):
        assert level.to_svg() == drawn.to_svg()
        assert level.digest == drawn.digest
        assert "colors" in level.to_dict()["theme"]
    assert babyrobot("generate", path, *count, "-o", "out", "--resume").status == 0
    # Themes that are everywhere keep their names.
    path.write_text(f"{SUITE}theme: green\n", "utf-8")
    babyrobot("generate", path, "-o", "green")
    assert levels_in(Path("green"))[0].to_dict()["theme"] == "green"


# -- what is there already -------------------------------------------------------------------


def test_nothing_is_written_over_without_force(babyrobot: Babyrobot) -> None:
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


def test_levels_of_several_calls_are_in_one_folder(babyrobot: Babyrobot) -> None:
    order = ["generate", "--count", "2", "-o", "out"]
    babyrobot(*order)
    before = contents(Path("out"))
    other = ["--seed", "1", "--name", "other-{index}"]
    assert babyrobot(*order, *other).status == 0
    assert babyrobot(*order, *other, "--resume").out == "wrote 0 levels to out; kept 2\n"
    assert contents(Path("out")).items() > before.items()
    assert babyrobot(*order, "--count", "3", "--resume").out == "wrote 1 level to out; kept 2\n"


@pytest.mark.parametrize(
    ("count", "message"),
    [
        (0, "--count: must be at least 1, not `0`"),
        (1, "--count: `test` gets none of the 1 levels; use more levels, or a larger share"),
    ],
)
def test_a_count_that_the_suite_cannot_have_is_told_as_an_option(
    babyrobot: Babyrobot, count: int, message: str
) -> None:
    done = babyrobot("generate", "small-mazes", "--count", str(count), "-o", "out")
    assert (done.status, done.err) == (2, f"error: {message}\n")
    with pytest.raises(ValueError, match=message.removeprefix("--")):
        brl.generate("small-mazes", "out", count=count)


def test_other_peoples_files_stay(babyrobot: Babyrobot) -> None:
    Path("out").mkdir()
    Path("out", "level-00003.yaml").write_text("version: 1\n", "utf-8")
    Path("out", "mine.yaml").write_text("version: 1\n", "utf-8")
    done = babyrobot("generate", "--count", "5", "--resume", "-o", "out")
    assert done.status == 2
    assert "level-00003.yaml already exists and was not generated" in done.err
    assert len(contents(Path("out"))) == 2
    assert babyrobot("generate", "--count", "3", "-o", "out").status == 0
    assert Path("out", "mine.yaml").read_text("utf-8") == "version: 1\n"


def test_resuming_ends_with_the_same_files(babyrobot: Babyrobot) -> None:
    order = ["generate", "--count", "40", *ORDERS["conditions"]]
    babyrobot(*order, "-o", "whole")
    babyrobot(*order, "-o", "part")
    for number in (*range(3), 17, *range(30, 40)):
        Path("part", f"maze-{number:03}.yaml").unlink()
    done = babyrobot(*order, "-o", "part", "--resume")
    assert done.out == "wrote 14 levels to part; kept 26\n"
    assert contents(Path("part")) == contents(Path("whole"))


def test_resuming_knows_which_games_are_there(babyrobot: Babyrobot) -> None:
    # So few games that many tries are of one that is there.
    order = ["generate", "--count", "30", "--size", "3x4", "--exit", "random"]
    babyrobot(*order, "-o", "whole")
    babyrobot(*order, "-o", "part")
    for number in range(10, 30):
        Path("part", f"level-{number:05}.yaml").unlink()
    babyrobot(*order, "-o", "part", "--resume", "--jobs", "2")
    assert contents(Path("part")) == contents(Path("whole"))


def test_an_order_can_grow(babyrobot: Babyrobot) -> None:
    babyrobot("generate", "--count", "10", "-o", "grown")
    babyrobot("generate", "--count", "25", "-o", "grown", "--resume")
    babyrobot("generate", "--count", "25", "-o", "whole")
    assert contents(Path("grown")) == contents(Path("whole"))


def test_a_file_that_was_changed_is_not_taken_for_one_of_the_order(babyrobot: Babyrobot) -> None:
    babyrobot("generate", "--count", "5", "-o", "out")
    path = Path("out", "level-00002.yaml")
    path.write_text(path.read_text("utf-8") + "discount: 0.5\n", "utf-8")
    done = babyrobot("generate", "--count", "5", "-o", "out", "--resume")
    assert (done.status, "differs from the generated level" in done.err) == (2, True)
    assert path.read_text("utf-8").endswith("discount: 0.5\n")


@pytest.mark.slow
@pytest.mark.parametrize("jobs", ["1", "2"])
@pytest.mark.slow
def test_an_interrupted_call_leaves_whole_files_and_can_go_on(
    jobs: str, babyrobot: Babyrobot, tmp_path: Path
) -> None:
    order = ["generate", "--count", "400", "--size", "20x20", "--path-length", "60..", "-o"]
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
    assert 20 <= len(made) < 400
    assert err == (
        f"stopped: {len(made)} of 400 levels are in cut\n"
        "  help: continue with the same call and --resume\n"
    )
    assert babyrobot(*order, "whole").status == 0
    whole = contents(Path("whole"))
    assert made == {name: whole[name] for name in sorted(whole)[: len(made)]}
    assert babyrobot(*order, "cut", "--resume").status == 0
    assert contents(Path("cut")) == whole


@pytest.mark.skipif(os.name == "nt", reason="there are no permissions of this kind")
def test_a_folder_that_cannot_be_written_to_is_told_of(babyrobot: Babyrobot) -> None:
    Path("out").write_text("", "utf-8")
    done = babyrobot("generate", "--count", "5", "-o", "out")
    assert (done.status, done.err) == (2, "error: out is not a folder\n")
