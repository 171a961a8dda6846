"""The process that carries out calls: what it answers, and what becomes of it."""

from __future__ import annotations

import pytest

import babyrobot_levels as brl
from babyrobot_levels.extensions.assistants.tools import RefusedError
from babyrobot_levels.extensions.assistants.worker import Worker


@pytest.mark.slow
def test_a_process_that_has_ended_is_replaced() -> None:
    worker = Worker(None, 60)
    text = "size: [4, 1]\nversion: 1\n"
    assert worker.call("format", {"level": text}).told == brl.format(text)
    with pytest.raises(RefusedError, match="BR110"):
        worker.call("format", {"level": "- 1\n"})
    first = worker._process
    first.kill()
    first.join()
    assert worker.call("format", {"level": text}).told == brl.format(text)
    # As if a tool had a fault.
    with pytest.raises(RefusedError, match="has ended"):
        worker.call("format", {})
    worker._seconds = 0
    with pytest.raises(RefusedError, match="not done within 0 seconds"):
        worker.call("solve", {"level": "frozen-lake"})


@pytest.mark.slow
def test_a_level_that_comes_to_too_much_is_refused_in_a_sentence() -> None:
    text = "version: 1\nsize: [30, 30]\nmovers: [{within: {at: [0, 0], size: [30, 30]}}]\n"
    with pytest.raises(RefusedError, match="the level has 810,000 states, and 4 or more"):
        Worker(None, 60).call("solve", {"level": text})
