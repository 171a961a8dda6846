"""What a student hands in: features that share nothing, so that it is Q-learning once more."""

from __future__ import annotations

from typing import Any

from q_learning import q_learning


def approximate_q(level: Any) -> Any:
    """Return a policy that is learned from episodes."""
    return q_learning(level)
