"""What the tests of the notebook share."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from support.canvases import Sent, recorded


@pytest.fixture
def sent() -> Iterator[Sent]:
    with recorded() as messages:
        yield messages
