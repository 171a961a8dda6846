# mypy: disable-error-code="import-not-found,import-untyped"
"""mdpsolver, asked by `checker.py`. Runs in an environment of its own; see `peers.py`."""

import json
import sys
import time

import mdpsolver
import numpy as np

TOLERANCE = 1e-6
"""Values that change by less are final."""


def main() -> None:
    """Answer questions until there are none."""
    for line in sys.stdin:
        question = json.loads(line)
        tables = np.load(question["tables"])
        probability, following = tables["probability"], tables["next_state"]
        end = probability.shape[0]
        # The end is a state, which goes on for nothing. An impossible outcome leads there.
        rewards = [*tables["reward"].tolist(), [0.0] * probability.shape[1]]
        columns = [*following.tolist(), [[end]] * probability.shape[1]]
        chances = [*probability.tolist(), [[1.0]] * probability.shape[1]]
        model = mdpsolver.model()
        model.mdp(
            discount=question["discount"],
            rewards=rewards,
            tranMatProbs=chances,
            tranMatColumns=columns,
        )
        begin = time.perf_counter()
        model.solve(algorithm="mpi", tolerance=TOLERANCE)
        seconds = time.perf_counter() - begin
        print(json.dumps({"seconds": seconds, "values": [model.getValue(0)]}), flush=True)


if __name__ == "__main__":
    main()
