"""Ray on this machine, or on a cluster that runs already."""

from __future__ import annotations

import argparse
import logging
import os
from typing import Any

os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")  # is read when Ray is imported

import ray


def add_address(parser: argparse.ArgumentParser) -> None:
    """Add the option `--address`."""
    parser.add_argument(
        "--address",
        default="local",
        help="of a Ray cluster: HOST:PORT, or auto for the one of this machine; "
        "by default, Ray is started here",
    )


def connect(address: str, cpus: int) -> None:
    """Connect to a cluster, or start Ray on this machine.

    Args:
        address: as `--address` takes it.
        cpus: the number of CPUs, if Ray is started.
    """
    new: dict[str, Any] = {"num_cpus": cpus, "include_dashboard": False}
    ray.init(
        address,
        log_to_driver=False,  # what workers print is in Ray's own files
        logging_level=logging.ERROR,
        **(new if address == "local" else {}),
    )
