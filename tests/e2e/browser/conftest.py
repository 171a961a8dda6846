"""A real browser for the tests of what people see in one: pages of ours, and JupyterLab."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, Error, Page, sync_playwright

NO_NETWORK = "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1"
"""Whatever a page asks for, nothing but this machine answers."""


@pytest.fixture(scope="session")
def browser() -> Iterator[Browser]:
    """A headless Chromium: the system's where there is one, else Playwright's own download."""
    system = shutil.which("chromium") or shutil.which("chromium-browser")
    options = [NO_NETWORK]
    if hasattr(os, "geteuid") and os.geteuid() == 0:
        # Chromium's sandbox refuses to work for root.
        options.append("--no-sandbox")
    with sync_playwright() as playwright:
        try:
            chromium = playwright.chromium.launch(executable_path=system, args=options)
        except Error as error:
            pytest.fail(f"no browser; `bash scripts/browser.sh` installs one\n{error}", False)
        yield chromium
        chromium.close()


@pytest.fixture
def page(browser: Browser) -> Iterator[Page]:
    """A fresh page, 1280 by 1024 pixels, that has neither history nor storage."""
    context = browser.new_context(viewport={"width": 1280, "height": 1024}, device_scale_factor=1)
    context.set_default_timeout(20_000)
    yield context.new_page()
    context.close()
