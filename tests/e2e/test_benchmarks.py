"""The one command of all benchmarks: what it shows of measurements, and of what goes wrong."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from support.places import ROOT

if TYPE_CHECKING:
    from timing import Comparison

FOLDER = ROOT / "benchmarks"


@pytest.fixture(autouse=True)
def _scripts(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(FOLDER)


def walks() -> Comparison:
    """Return made-up measurements: two of ours, a peer that is there, and one that is not."""
    from timing import Comparison

    return Comparison(
        "steps per second",
        {"ours, plain": [20.0, 30.0, 60.0], "ours, fast": [4000.0, 8000.0, 6000.0]},
        {"lake": [10.0, 10.0, 20.0], "pool": []},
        {"pool": "pool cannot be installed (no network)"},
        {("ours, plain", "lake"): 3, ("ours, fast", "lake"): 301, ("ours, fast", "pool"): 2},
        {"lakes": "1.2", "babyrobot-levels": "0.1.0"},
    )


def rate() -> Comparison:
    from timing import Comparison

    return Comparison(
        "levels per second", {"all": [2e6, 1e6]}, aims={("all", None): 1e6}, note="all: 3 s"
    )


def measuring(name: str, count: int) -> Iterator[Comparison]:
    assert count == 2
    yield walks()
    if name == "lint":
        raise ValueError("no such file")
    if name == "vector":
        raise KeyboardInterrupt
    yield rate()


def test_the_table_shows_ratios_round_by_round_and_aims() -> None:
    from page import Result, result_table

    assert result_table([Result("step", (walks(), rate()))]) == (
        """\
| benchmark | what              | ours        |      rate | peer | its rate | ratio |                 spread |         aim | reached |
| --------- | ----------------- | ----------- | --------: | ---- | -------: | ----: | ---------------------: | ----------: | ------- |
| step      | steps per second  | ours, plain |        30 | lake |       10 |     3 |                 2 to 3 |         ≥ 3 | yes     |
| step      | steps per second  | ours, plain |        30 | pool |  missing |     – |                      – |           – | –       |
| step      | steps per second  | ours, fast  |     6,000 | lake |       10 |   400 |             300 to 800 |       ≥ 301 | yes     |
| step      | steps per second  | ours, fast  |     6,000 | pool |  missing |     – |                      – |         ≥ 2 | missing |
| step      | levels per second | all         | 1,500,000 | –    |        – |     – | 1,000,000 to 2,000,000 | ≥ 1,000,000 | yes     |"""  # noqa: E501
    )


def test_what_needs_numba_is_missing_without_it(monkeypatch: pytest.MonkeyPatch) -> None:
    import timing

    made: list[str] = []

    def make() -> timing.Measure:
        made.append("compiled")
        return lambda: 2.0

    measures = {"ours": timing.needing("numba", make)}
    assert timing.compare_in_turns("steps", measures, {}, 3).ours == {"ours": [2.0] * 3}
    assert made == ["compiled"]
    monkeypatch.setattr(timing, "find_spec", lambda _: None)
    found = timing.compare_in_turns("steps", measures, {}, 3)
    assert found.ours == {"ours": []}
    assert "the extra `fast`" in found.missing["ours"]


def test_the_page_keeps_it_all(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    import run

    file = tmp_path / "RESULTS.md"
    assert run.main(["--only", "step", "--quick", "-o", str(file)], measuring) == 0
    text, shown = file.read_text("utf-8"), capsys.readouterr().out
    assert "- babyrobot-levels 0.1.0, lakes 1.2\n" in text
    assert "quick run" in text
    assert text.count("pool cannot be installed (no network)") == 1
    assert "- all: 3 s\n" in text
    for line in shown.splitlines():
        assert line in text
    assert [path.name for path in tmp_path.iterdir()] == ["RESULTS.md"]


def test_a_failure_is_named_and_the_rest_goes_on(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    import run

    file = tmp_path / "RESULTS.md"
    asked = ["--only", "lint", "--only", "mazes", "--quick", "-o", str(file)]
    assert run.main(asked, measuring) == 1
    text = file.read_text("utf-8")
    assert "- failed: lint: no such file\n" in text
    assert text.count("| mazes ") == 5
    # What it had measured before is kept.
    assert text.count("| lint ") == 4
    assert "failed: lint" in capsys.readouterr().out


def test_a_run_that_is_killed_leaves_what_it_had(tmp_path: Path) -> None:
    import run

    file = tmp_path / "RESULTS.md"
    left: list[str] = []

    def looking(name: str, count: int) -> Iterator[Comparison]:
        left.append(file.read_text("utf-8") if file.exists() else "")
        yield rate()

    assert run.main(["--only", "mazes", "--only", "step", "--quick", "-o", str(file)], looking) == 0
    assert left[0] == ""
    assert "| step " in left[1]
    assert "- not run: mazes" in left[1]


def test_an_interrupted_run_keeps_what_is_done(tmp_path: Path) -> None:
    import run

    file = tmp_path / "RESULTS.md"
    assert run.main(["--quick", "-o", str(file)], measuring) == 1
    text = file.read_text("utf-8")
    assert "- failed: vector: interrupted\n" in text
    assert [line for line in text.splitlines() if line.startswith("- not run")] == [
        f"- not run: {name}" for name in run.BENCHMARKS[2:]
    ]


SCRIPTS = {
    "well": "yield Comparison('u', {'a': [1.0] * count})",
    "faulty": "yield Comparison('u', {'a': [1.0]})\n    raise OSError('no disk')",
    "dying": "yield Comparison('u', {'a': [1.0]})\n    os._exit(9)",
}


@pytest.mark.parametrize(
    ("name", "failure"), [("well", None), ("faulty", "OSError: no disk"), ("dying", "ended (9)")]
)
def test_a_script_runs_in_a_process_of_its_own(
    name: str, failure: str | None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import run

    script = f"import os\nfrom timing import Comparison\ndef compare(count):\n    {SCRIPTS[name]}\n"
    (tmp_path / f"bench_{name}.py").write_text(script, "utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    (result,) = run.run([f"bench_{name}"], 3, run.in_a_process)
    assert len(result.comparisons) == 1
    assert result.comparisons[0].ours["a"] == [1.0] * (3 if name == "well" else 1)
    assert (failure or "") in (result.failure or "")
    assert (result.failure is None) == (failure is None)


def test_the_history_follows_ratios_from_run_to_run() -> None:
    from history import history, runs_of
    from page import Result, page
    from timing import Comparison

    def told(ratio: float, peer: str = "lake") -> str:
        rates = Comparison("steps", {"ours": [10.0 * ratio]}, {peer: [10.0]})
        return page([Result("step", (rates,))], ["step"], 7).replace("- date: 20", "- date: 19")

    # The second differs from the first by a name alone.
    runs = runs_of([told(2, "pond"), told(2), told(4), told(3)])
    assert [list(run.ratios.values()) for run in runs] == [[2], [4], [3]]
    assert all(run.date.startswith("19") for run in runs)
    assert """\
| benchmark | what  | ours | peer | runs  | first | last |
| --------- | ----- | ---- | ---- | ----- | ----- | ---- |
| step      | steps | ours | lake | `▅█▆` | 2     | 3    |
""" in history(runs)
