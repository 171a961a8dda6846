"""Ray on this machine, or on a cluster that runs already."""

from __future__ import annotations

import argparse
import sys

from babyrobot_levels.parallel import on_ray
from babyrobot_levels.parallel.executor import ExecutorError


def add_address(parser: argparse.ArgumentParser) -> None:
    """Add the option `--address`."""
    parser.add_argument(
        "--address",
        default="local",
        help="of a Ray cluster: HOST:PORT, or auto for the one of this machine; by default, "
        "Ray is started here",
    )


def connect(address: str, cpus: int) -> None:
    """Connect to a cluster, or start Ray on this machine; exit if there is no such cluster.

    Args:
        address: as `--address` takes it.
        cpus: the number of CPUs, if Ray is started.
    """
    try:
        on_ray.connect(address, cpus if address == "local" else None)
    except ExecutorError as error:
        sys.exit(f"{error}: {error.help}")
