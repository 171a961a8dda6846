"""The home of the documentation in Firefox: nothing is refused or wider than the window."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

import pytest
from support.firefox import firefox
from support.web import SITE


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_the_home_is_whole_in_firefox(scheme: Literal["light", "dark"], tmp_path: Path) -> None:
    with firefox(tmp_path, scheme) as browser:
        for width in (360, 1280):
            page = browser.page(width, 800)
            page.open((SITE / "docs" / "index.html").as_uri())
            assert page.text("h1").startswith("babyrobot-levels")
            assert page.run("() => document.documentElement.scrollWidth - innerWidth") <= 0
            assert page.run("() => seen('.hero').length") == 1
        assert browser.faults() == []
