"""Networks of the benchmark of generalisation learn in JAX, and are the same without it."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from support.places import ROOT

import babyrobot_levels as brl


@pytest.fixture(autouse=True)
def _scripts(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(ROOT / "benchmarks")


@pytest.fixture
def quickly_compiled() -> Iterator[None]:
    jax.config.update("jax_disable_most_optimizations", True)
    yield
    jax.config.update("jax_disable_most_optimizations", False)


@pytest.mark.usefixtures("quickly_compiled")
def test_networks_learn_and_have_the_same_shares(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    import generalisation
    import generalisation_jax

    few = brl.load_suite(brl.load_suite("bench-easy").to_dict() | {"count": 40, "size": [4, 4]})
    monkeypatch.setattr(brl, "load_suite", lambda _: few)
    for module in (generalisation, generalisation_jax):
        monkeypatch.setattr(module, "TRAINED", tmp_path)
    for name, small in {"ENVS": 16, "LENGTH": 4, "STAGES": 2, "REFRESHED": 1}.items():
        monkeypatch.setattr(generalisation_jax, name, small)
    generalisation_jax.learn("bench-easy", "feedforward", tmp_path, 1, 256)
    for method in generalisation.PROGRAMS["feedforward"]:
        kept = generalisation.networks("bench-easy", method)
        assert (kept["steps"], kept["curve"].shape) == (256, (3, 2, 4))
        scores = generalisation.trained(method, "bench-easy", 0, 0)(few.split("test"))
        (run,) = np.flatnonzero(kept["methods"] == method)
        assert [score.share for score in scores] == pytest.approx(kept["curve"][run, -1], abs=1e-3)


def test_networks_with_memory_act_alike() -> None:
    from generalisation import Network
    from generalisation_jax import MEMORY, network, new_weights

    weights = new_weights(jax.random.key(0), 12, 4, has_memory=True)
    # The heads of new networks hardly tell actions apart.
    weights["heads"] = 100 * weights["heads"]
    without = Network({name: np.asarray(each) for name, each in weights.items()}, np.arange(12), 0)
    without.reset()
    memory = jnp.zeros((1, MEMORY))
    for view in np.random.default_rng(0).integers(2, size=(6, 12)):
        memory, log_chances, _ = network(weights, memory, jnp.asarray(view[None]))
        assert without.act(view, None) in range(4)
        assert without.memory == pytest.approx(np.asarray(memory), abs=1e-5)
        chances = without.chances(without.memory)
        assert chances == pytest.approx(np.exp(log_chances), abs=1e-4)
