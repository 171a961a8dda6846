"""Fixtures of the tests of libraries that learn."""

from __future__ import annotations

import pytest


@pytest.fixture
def on_one_thread() -> None:
    """Networks as small as these learn slower on several threads."""
    import torch

    torch.set_num_threads(1)
