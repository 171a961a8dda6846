"""The page on the benchmark of generalisation: its splits and its table."""

from __future__ import annotations

import json
import re
import shutil
from hashlib import sha256
from pathlib import Path
from typing import Any

import pytest
from support.places import DOCS, ROOT

import babyrobot_levels as brl

PAGE = (DOCS / "benchmark.md").read_text("utf-8")


@pytest.fixture(autouse=True)
def _scripts(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(ROOT / "benchmarks")


# -- the splits ------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "column"),
    # Each candidate with a door is solved several times.
    [
        pytest.param("bench-easy", 1, marks=pytest.mark.sweep),
        pytest.param("bench-hard", 2, marks=pytest.mark.sweep),
        pytest.param("bench-keys", 3, marks=pytest.mark.sweep),
    ],
)
def test_the_splits_are_fixed_and_disjoint(name: str, column: int) -> None:
    rows = re.findall(r"^\| `(\w+)`" + r" \| `(\w{16})`" * 3 + r" \|$", PAGE, re.MULTILINE)
    told = {row[0]: row[column] for row in rows}
    suite = brl.load_suite(name)
    digests = {split: [level.digest for level in suite.split(split)] for split in suite.splits}
    assert told == {
        split: sha256("\n".join(each).encode()).hexdigest()[:16] for split, each in digests.items()
    }
    assert len({digest for each in digests.values() for digest in each}) == len(suite)
    sizes = ", ".join(str(len(each)) for each in digests.values())
    assert re.search(rf"^\| `{name}` \| .* \| {suite.max_steps} \| {sizes} \|$", PAGE, re.MULTILINE)


def test_the_hard_test_split_is_fixed_in_its_first_levels() -> None:
    # The whole suite is compared in the sweep.
    test = brl.load_suite("bench-hard").split("test")
    digests = "\n".join(level.digest for level in test[:4])
    assert sha256(digests.encode()).hexdigest()[:16] == "70f701340fc3fa27"


# -- the page --------------------------------------------------------------------------------


@pytest.mark.sweep
def test_the_tables_are_those_of_the_results() -> None:
    import generalisation

    tables = generalisation.table().split("\n\n")
    assert len(tables) == 5
    for table in tables:
        assert table.strip() in PAGE
    assert f"{generalisation.STEPS:,} steps" in PAGE


@pytest.mark.slow
def test_each_result_is_that_of_its_levels() -> None:
    import generalisation

    optima = {}
    paths = sorted(generalisation.RESULTS.glob("*.json"))
    assert paths
    for path in paths:
        result = json.loads(path.read_text("utf-8"))
        shares = result["test_shares"]
        assert len(shares) == len(brl.load_suite(result["suite"]).split("test"))
        assert result["test"]["mean"] == pytest.approx(sum(shares) / len(shares), abs=1e-4)
        assert path.stem == f"{result['suite']}-{result['method']}-{result['seed']}"
        if result["method"] == "best":
            optima[result["suite"]] = result["test"]["mean"]
    assert optima == pytest.approx(dict.fromkeys(generalisation.SUITES, 1.0), abs=1e-3)


# -- the script ------------------------------------------------------------------------------


@pytest.fixture
def few(monkeypatch: pytest.MonkeyPatch) -> Any:
    """The script with few levels."""
    import generalisation

    suite = brl.load_suite("bench-easy")
    found = {split: list(suite.split(split)[:6]) for split in suite.splits}
    monkeypatch.setattr(generalisation, "levels_of", lambda _, split: found[split])
    monkeypatch.setattr(generalisation, "TEST_MAZES", ("small-corridor",))
    monkeypatch.setattr(generalisation, "EPISODES", 20)
    return generalisation


@pytest.mark.slow
def test_runs_that_have_a_result_are_left_out(
    few: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    chosen = few.runs(["random", "best", "q-learning"], ["bench-easy"], [0, 1])
    assert [run[0] for run in chosen] == ["random", "best", "q-learning", "q-learning"]
    few.train(chosen, tmp_path, 0)
    assert len(capsys.readouterr().out.splitlines()) == 4
    before = few.table(tmp_path)
    (tmp_path / "bench-easy-best-0.json").unlink()
    few.train(chosen, tmp_path, 0)
    assert capsys.readouterr().out.startswith("bench-easy-best-0.json: mean share 1.000 in test")
    assert few.table(tmp_path) == before
    rows = [[cell.strip() for cell in line.split("|")] for line in before.splitlines()]
    named = {row[2]: row[3:] for row in rows if len(row) > 2}
    assert named["random policy"][:4] == ["1", "0.00", "0.00", "0.00"]
    assert named["optimal policy"][:4] == ["1", "1.00", "1.00", "1.00"]
    assert named["Q-learning in each level"][0] == "2"
    assert re.fullmatch(r"-?\d\.\d\d \(-?\d\.\d\d to -?\d\.\d\d\)",
                        named["Q-learning in each level"][2])  # fmt: skip


@pytest.mark.libraries
@pytest.mark.parametrize(
    "method", ["maskable-ppo", pytest.param("recurrent-ppo", marks=pytest.mark.sweep)]
)
def test_networks_are_trained_and_scored(method: str, few: Any, tmp_path: Path) -> None:
    few.train([(method, "bench-easy", 0)], tmp_path, 4096)
    path = tmp_path / f"bench-easy-{method}-0.json"
    result = json.loads(path.read_text("utf-8"))
    assert result["is_exact"] is (method != "recurrent-ppo")
    assert len(result["test_shares"]) == 6
    again = tmp_path / "again"
    few.train([(method, "bench-easy", 0)], again, 4096)
    repeated = json.loads((again / path.name).read_text("utf-8"))
    assert repeated["test"] == result["test"]
    shutil.rmtree(again)


# -- the example of choosing levels ----------------------------------------------------------


@pytest.mark.libraries
def test_levels_are_replayed_by_their_regret(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.syspath_prepend(ROOT / "examples")
    import numpy as np
    import prioritised_level_replay as example

    ties = example.rank_correlation(np.array([1.0, 2, 2, 3]), np.array([2.0, 5, 5, 9]))
    assert ties == pytest.approx(1)
    assert example.rank_correlation(np.array([1.0, 2, 3]), np.array([3.0, 2, 1])) == -1
    picture = tmp_path / "correlations.svg"
    arguments = ["example", "--seeds", "1", "--steps", "8192", "-o", str(picture)]
    monkeypatch.setattr("sys.argv", arguments)
    monkeypatch.setattr(example, "MAZES", {**example.MAZES, "count": 40})
    example.main()
    out = capsys.readouterr().out
    for title in example.METHODS.values():
        assert re.search(rf"^{title} +-?\d\.\d\d\d ", out, re.MULTILINE)
    assert "exact regret" in picture.read_text("utf-8")
    # The sampler was told the exact regrets of the levels that were played.
    levels = list(brl.load_suite(example.MAZES).split("train"))
    replay, _ = example.learn("regret", levels, levels[:1], 4096, 0)
    assert replay.sampler is not None
    known = replay.sampler.scores[np.isfinite(replay.sampler.scores)]
    assert known.size
    assert (known >= -1e-9).all()
