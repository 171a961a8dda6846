"""The page on estimates of regret: its tables and charts are those of the results."""

from __future__ import annotations

import json
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from typing import Any

import pytest
from support.places import DOCS, ROOT

FOLDER = ROOT / "benchmarks/design-estimators"
PAGE = (DOCS / "estimators.md").read_text("utf-8")


@pytest.fixture
def report() -> Any:
    spec = spec_from_file_location("design_estimators_report", FOLDER / "report.py")
    assert spec is not None
    assert spec.loader is not None
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.slow
def test_tables_and_charts_are_those_of_the_results(
    report: Any, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    arguments = ["report", str(FOLDER / "results"), "--images", str(tmp_path)]
    monkeypatch.setattr("sys.argv", arguments)
    report.main()
    tables = capsys.readouterr().out.strip().split("\n\n")
    assert len(tables) == 6
    assert [table for table in tables if table not in PAGE] == []
    charts = sorted(tmp_path.iterdir())
    assert len(charts) == 4
    for chart in charts:
        assert chart.read_text("utf-8") == (DOCS / "images" / chart.name).read_text("utf-8")
        assert f"(images/{chart.name})" in PAGE


def test_the_device_and_the_budgets_are_those_of_the_results() -> None:
    results = {path.stem: json.loads(path.read_text()) for path in FOLDER.glob("results/*.json")}
    assert results.keys() == {"curricula", "estimates", "times"}
    for result in results.values():
        for each in result.values():
            assert each["device"].startswith("NVIDIA H100")
            assert f"JAX {each['jax']}" in PAGE
            assert each.get("seeds", 10) == 10
    for each in results["curricula"].values():
        assert f"{each['stages'][-1]['steps']:,} steps" in PAGE
