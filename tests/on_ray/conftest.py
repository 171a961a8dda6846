"""A Ray cluster of two nodes on this machine, for all tests of this folder."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from unittest import mock

import pytest
from support.places import ROOT

VARIABLES = {
    "RAY_USAGE_STATS_ENABLED": "0",
    # Nodes import the package, and what tests run, from here.
    "PYTHONPATH": os.pathsep.join([str(ROOT), str(ROOT / "tests")]),
}


@pytest.fixture(scope="session")
def cluster() -> Iterator[Any]:
    """The cluster: a head that the tests are connected to, and a node beside it, a CPU each."""
    with mock.patch.dict(os.environ, VARIABLES):
        import ray
        from ray.cluster_utils import Cluster

        cluster = Cluster(initialize_head=True, head_node_args={"num_cpus": 1})
        cluster.add_node(num_cpus=1)
        ray.init(cluster.address, log_to_driver=False, logging_level="ERROR")
        yield cluster
        ray.shutdown()
        cluster.shutdown()


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Make the current folder an empty one."""
    monkeypatch.chdir(tmp_path)
    return tmp_path
