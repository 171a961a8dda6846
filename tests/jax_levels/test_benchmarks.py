"""The benchmarks of JAX, with few environments: what they measure, and what they show."""

from __future__ import annotations

import sys

import numpy as np
import pytest
from support.places import ROOT


@pytest.fixture(autouse=True)
def _short(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(ROOT / "benchmarks")
    import jax_envs
    import jax_walks

    few = jax_envs.mazes()[:2]
    monkeypatch.setattr(jax_walks, "SECONDS", 1e-4)
    monkeypatch.setattr(jax_envs, "mazes", lambda: few)


@pytest.mark.sweep
def test_levels_are_measured_beside_others_and_missing_peers_are_named(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    import jax_envs
    import timing

    beside = {"frozen-lake": (jax_envs.LAKE, jax_envs.NAVIX), "400 mazes": (jax_envs.ENGINE_POOL,)}
    monkeypatch.setattr(jax_envs, "BESIDE", beside)
    absent = ("navix", "numba")
    monkeypatch.setattr(timing, "find_spec", lambda name: None if name in absent else name)
    lake, pool = jax_envs.compare(1, [4])
    assert len(lake.ours["frozen-lake"]) == 1
    assert len(lake.peers[jax_envs.LAKE]) == 1
    assert lake.missing == {jax_envs.NAVIX: "navix is not installed"}
    assert lake.aims["frozen-lake", jax_envs.LAKE] == jax_envs.AIM
    assert pool.unit == "steps per second, 4"
    assert pool.ours["400 mazes"][0] > 0
    assert pool.missing == {jax_envs.ENGINE_POOL: "numba is not installed (the extra `fast`)"}


@pytest.mark.sweep
def test_optima_and_regret_in_jax_are_those_of_solve_and_score() -> None:
    import jax_solve

    beside, optimum, regret = jax_solve.compare(1, 3)
    assert not beside.missing
    for found in (optimum, regret):
        assert not found.missing
        assert float(found.note.split()[3]) < 1e-3
    assert [*regret.peers] == ["brl.score"]


def test_jaxdp_finds_the_same_values() -> None:
    import jax_solve

    levels = jax_solve.mazes(3)
    own, theirs = (made(levels)() for made in (jax_solve.optima, jax_solve.iterated))
    assert np.allclose(own, theirs, rtol=1e-5)


@pytest.mark.sweep
def test_the_tables_name_the_device(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    import jax
    import jax_envs
    import jax_gpu

    lake = jax_envs.ours([])["frozen-lake"]
    monkeypatch.setattr(jax_envs, "ours", lambda pool: {"frozen-lake": lake})
    monkeypatch.setattr(jax_gpu, "OBSERVATIONS", ("index",))
    monkeypatch.setattr(sys, "argv", ["jax_gpu.py", "--quick", "--sizes", "4", "--levels", "2"])
    jax_gpu.main()
    device, _, steps, *tables = capsys.readouterr().out.splitlines()
    platform = jax.devices()[0].platform
    assert f"({platform}), jax " in device
    assert device.endswith("JAX has no GPU or TPU here") == (platform == "cpu")
    assert steps == "Steps per second:"
    shown = [line.split("|")[1].strip() for line in tables if line.startswith("|")]
    for row in ("frozen-lake", "gymnax FrozenLake", "2 mazes of 8x8", "optimum", "door-key"):
        assert row in shown
