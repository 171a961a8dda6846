"""What all tests share: which are slow or flaky, how much hypothesis tries, folders, a browser."""

from __future__ import annotations

import os
import shutil
import signal
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from hypothesis import settings

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

TESTS = Path(__file__).parent

# For matrices and networks as small as those of tests, threads that wait for each other take longer
# than one that works, most of all where tests run side by side. NumPy and PyTorch read these when
# they are loaded.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("OMP_NUM_THREADS", "1")

# jsonschema would compile 38 grammars with it, for formats that no schema here has: seconds.
sys.modules["rfc3987_syntax"] = None  # type: ignore[assignment]

SLOW = {
    "cli/test_edit.py",
    "extensions/play/test_play.py",
    "cli/test_terminals.py",
    "docs/test_notebooks.py",
    "extensions/editor/test_forms.py",
    "extensions/editor/test_laws.py",
    "extensions/editor/test_site.py",
    "extensions/packs/test_built.py",
    "e2e/browser",
    "e2e/test_benchmarks.py",
    "e2e/test_examples.py",
    "e2e/test_packaging.py",
    "e2e/test_pre_commit.py",
    "envs/test_wrappers.py",
    "envs/test_notebook.py",
    "envs/test_terminal.py",
    "limits",
    "render/notebook/test_output.py",
    "render/test_outside_renderer.py",
}
"""Files and folders in which every test is slow. Elsewhere the test itself is marked."""

LIBRARIES = {
    "extensions/assistants/test_server.py",
    "extensions/sight/test_readers.py",
    "in_otter",
    "jax_levels",
    "language_agents",
    "on_ray",
    "extensions/publish/test_dataset.py",
    "site",
    "storm",
}
"""Likewise, those in which every test needs libraries that few environments have."""

FLAKY = {
    "cli/test_edit.py",
    "cli/test_terminals.py",
    "envs/test_rllib.py",
    "envs/test_terminal.py",
    "on_ray",
}
"""Those that wait for a terminal, a server or a cluster; with them, every test in a browser."""

NO_NETWORK = "--host-resolver-rules=MAP rebound.test 127.0.0.1, MAP * ~NOTFOUND, EXCLUDE 127.0.0.1"
"""Whatever a page asks for, nothing but this machine answers; it has a second name."""

UNUSED_FEATURES = """
    WebUIOmniboxPopup WebUIOmniboxAimPopup SpareRendererForSitePerProcess
    AimEnabled AvoidCorsURLLoaderRestartOnRedirect AvoidUnnecessaryBeforeUnloadCheckSync
    DestroyProfileOnBrowserClose HttpsFirstBalancedModeAutoEnable HttpsUpgrades LensOverlay
    MediaRouter NetworkTimeServiceQuerying OptimizationHints PaintHolding PreconnectToSearch
    ThirdPartyStoragePartitioning
"""
"""What Chromium has switched off.

Those of the first line: for each context it would make a page of its own for what is typed into the
bar of addresses, which nobody sees, and a process on supply: two thirds of the time that an empty
page takes. The others are Playwright's own, whose switch the last one replaces.
"""

# `--hypothesis-profile thorough` chooses the second. A loaded machine is no reason to fail, and
# examples stay the same, but for constants of the modules that happen to be loaded, which are
# tried too; `exploring` tries others each time: a law has to hold for more than has been tried.
settings.register_profile("fast", max_examples=12, deadline=None, derandomize=True)
settings.register_profile("thorough", max_examples=100, deadline=None, derandomize=True)
settings.register_profile("exploring", max_examples=200, deadline=None)
settings.load_profile("fast")


def pytest_configure() -> None:
    """Let Ctrl-C interrupt what tests start, also where it is ignored, as under nohup."""
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    """Import nothing of which no test is asked for: libraries may be missing, and it takes time."""
    asked = config.getoption("markexpr")
    left_out = {*(LIBRARIES if "not libraries" in asked else ()),
                *(SLOW if "not slow" in asked else ())}  # fmt: skip
    return collection_path.relative_to(TESTS).as_posix() in left_out or None


def places_of(path: Path) -> set[str]:
    """Return a file and the folders in which it is."""
    return {each.as_posix() for each in (path, *path.parents)}


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark what is slow, what needs libraries, and what may fail once, by its place."""
    paths = {item.path for item in items}
    within = {path: places_of(path.relative_to(TESTS)) for path in paths}
    for item in items:
        places = within[item.path]
        if SLOW & places or item.get_closest_marker("sweep"):
            item.add_marker(pytest.mark.slow)
        if LIBRARIES & places:
            item.add_marker(pytest.mark.libraries)
        if FLAKY & places or "browser" in getattr(item, "fixturenames", ()):
            item.add_marker(pytest.mark.flaky(reruns=1))


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Make the current folder and the user's ones empty, and return the current one."""
    folder = tmp_path / "here"
    folder.mkdir()
    monkeypatch.chdir(folder)
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    monkeypatch.delenv("BABYROBOT_LEVELS", raising=False)
    return folder


@pytest.fixture(scope="session")
def browser() -> Iterator[Browser]:
    """A headless Chromium: the system's where there is one, else Playwright's own download."""
    from playwright.sync_api import Error, sync_playwright

    system = shutil.which("chromium") or shutil.which("chromium-browser")
    # There is no GPU: what is drawn as if on one takes longer than what is painted at once.
    options = [
        NO_NETWORK,
        "--disable-gpu",
        f"--disable-features={','.join(UNUSED_FEATURES.split())}",
    ]
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
