"""Jupyter for the tests: a server of its own, and a notebook that is open in a browser."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Literal, TypeVar

import nbformat
from nbformat.v4 import new_code_cell, new_notebook
from playwright.sync_api import Locator, Page, Response

from support.subprocesses import HOME

Found = TypeVar("Found")

FrontEnd = Literal["jupyterlab", "notebook"]
"""JupyterLab, and Jupyter Notebook 7, which is made of its parts."""

PLACES = {"jupyterlab": "doc/tree", "notebook": "notebooks"}
"""Where a front end has the page of a notebook."""

IDLE_NOTEBOOK = (
    "body:has(.jp-NotebookKernelStatus-fade) .jp-Notebook-ExecutionIndicator[data-status=idle]"
)
"""What Notebook 7 has once a kernel waits; JupyterLab tells it in a bar."""

QUIET = {
    "@jupyterlab/apputils-extension:notification": {
        "checkForUpdates": False,
        "doNotDisturbMode": True,
        "fetchNews": "false",
    },
    "@jupyterlab/notebook-extension:tracker": {"windowingMode": "none"},
}
"""JupyterLab's settings: no questions, and every cell is in the page, also out of sight."""


def until(condition: Callable[[], Found | None], what: str, seconds: float = 20) -> Found:
    """Return what `condition` gives as soon as it is true; fail after `seconds`."""
    end = time.monotonic() + seconds
    while not (found := condition()):
        assert time.monotonic() < end, f"{what}: not within {seconds:g} seconds"
        time.sleep(0.05)
    return found


class Served:
    """A folder that Jupyter serves."""

    def __init__(self, root: Path, address: str) -> None:
        self.root, self._address = root, address

    def write(self, name: str, *cells: str) -> None:
        """Write a notebook of some cells of code."""
        made = [new_code_cell(code) for code in cells]  # type: ignore[no-untyped-call]
        metadata = {"kernelspec": {"name": "python3", "display_name": "Python 3"}}
        notebook = new_notebook(cells=made, metadata=metadata)  # type: ignore[no-untyped-call]
        nbformat.write(notebook, self.root / name)  # type: ignore[no-untyped-call]

    def open(self, page: Page, name: str) -> OpenNotebook:
        """Open a notebook."""
        return OpenNotebook(page, self._address, name)


@contextmanager
def jupyter(root: Path, home: Path, front_end: FrontEnd = "jupyterlab") -> Iterator[Served]:
    """Serve a folder in Jupyter, kernels being the running interpreter.

    Args:
        root: the folder.
        home: an empty folder for everything that Jupyter writes down.
        front_end: what is served.
    """
    settings = home / "config" / "labconfig" / "default_setting_overrides.json"
    settings.parent.mkdir(parents=True)
    settings.write_text(json.dumps(QUIET), "utf-8")
    places = {"HOME": "", "IPYTHONDIR": "ipython"} | {
        f"JUPYTER_{name.upper()}_DIR": name for name in ("config", "data", "runtime")
    }
    environment = {
        **os.environ,
        **{name: str(home / folder) for name, folder in places.items()},
        "PYTHONPATH": str(HOME),
    }
    call = [
        *(sys.executable, "-m", front_end, "--no-browser", "--allow-root"),
        *("--ServerApp.ip=127.0.0.1", "--ServerApp.port=0", "--IdentityProvider.token="),
        *(f"--ServerApp.root_dir={root}", "--LabApp.extension_manager=readonly"),
    ]
    log = home / "log.txt"
    with log.open("w") as output:
        server = subprocess.Popen(call, env=environment, stdout=output, stderr=output)
        try:
            found = until(lambda: _address(server, home / "runtime", log), "Jupyter starts", 60)
            yield Served(root, f"{found}{PLACES[front_end]}/")
        finally:
            server.terminate()
            try:
                server.wait(30)
            except subprocess.TimeoutExpired:  # It waits for its kernels.
                server.kill()
                server.wait()


def _address(server: subprocess.Popen[bytes], runtime: Path, log: Path) -> str | None:
    assert server.poll() is None, log.read_text("utf-8")
    for path in runtime.glob("jpserver-*.json"):
        # It may not be written to the end yet.
        if text := path.read_text("utf-8"):
            return str(json.loads(text)["url"])
    return None


def _is_saved(response: Response) -> bool:
    return "/api/contents/" in response.url and response.request.method == "PUT"


class OpenNotebook:
    """A notebook that is open in a browser, with a kernel.

    Args:
        page: the page to open it in.
        address: where notebooks are served.
        name: the notebook's path below the served folder.
    """

    def __init__(self, page: Page, address: str, name: str) -> None:
        self._page = page
        page.goto(f"{address}{name}")
        self._wait()

    def _wait(self) -> None:
        # Before there is a kernel, what is to run is forgotten without a word.
        bar = self._page.locator("#jp-main-statusbar", has_text=re.compile(r"\| Idle"))
        self._page.locator(IDLE_NOTEBOOK).or_(bar).wait_for(state="attached")
        self._page.locator(".jp-Cell").first.wait_for()

    def reload(self) -> None:
        """Load the page again; the kernel goes on."""
        self._page.reload()
        self._wait()

    def start(self, number: int) -> None:
        """Have a cell run; do not wait."""
        prompt = self._cell(number).locator(".jp-InputPrompt")
        prompt.click()
        self._page.keyboard.press("Control+Enter")

    def done(self, number: int) -> bool:
        """Tell whether a cell that was started has come to its end."""
        text = self._cell(number).locator(".jp-InputPrompt").inner_text()
        return re.fullmatch(r"\[\d+\]:?", text.strip()) is not None

    def run(self, *numbers: int) -> None:
        """Run cells, one after the other, to their ends."""
        for number in numbers:
            self.start(number)
            until(partial(self.done, number), f"cell {number} comes to its end", 60)

    def save(self) -> None:
        """Save the notebook as a user does, and wait until that is done."""
        with self._page.expect_response(_is_saved):
            self._page.keyboard.press("Control+s")
        self._page.locator(".jp-mod-dirty").wait_for(state="detached")

    def output(self, number: int) -> Locator:
        """Return the area of a cell's output."""
        return self._cell(number).locator(".jp-Cell-outputArea")

    def still(self, number: int = 0) -> Locator:
        """Return the picture in a cell's output that needs no kernel."""
        return self.output(number).locator("img:visible")

    def _cell(self, number: int) -> Locator:
        return self._page.locator(".jp-CodeCell").nth(number)
