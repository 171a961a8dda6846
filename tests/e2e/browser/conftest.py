"""A page of a level that is open in a browser."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Page
from support.playground import Playground


@pytest.fixture
def ground(page: Page, tmp_path: Path) -> Iterator[Playground]:
    playground = Playground(page, tmp_path)
    yield playground
    assert playground.faults == []
