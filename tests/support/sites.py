"""Sites of the editor: what they are made of, and a server of static files that can be stopped."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread

from babyrobot_levels.extensions.editor.runtime import TARBALL, WHEELS, runtime_file, runtime_folder
from support.places import ROOT

RUNTIME = ROOT / ".venv-runtime"
"""Python for browsers, which is fetched once."""


def runtime() -> Path:
    """Return the folder of the files that sites need, which is filled at the first call."""
    RUNTIME.mkdir(exist_ok=True)
    if not all((RUNTIME / file.name).is_file() for file in (TARBALL, *WHEELS)):
        with runtime_folder(None) as fetched:
            for file in (TARBALL, *WHEELS):
                part = RUNTIME / f"{file.name}.part"
                part.write_bytes(runtime_file(file, fetched))
                part.replace(RUNTIME / file.name)
    return RUNTIME


def stand_in(name: str) -> bytes:
    """Return a wheel that stands for a library for browsers; its arrays are lists."""
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w") as archive:
        archive.writestr(f"{name}/__init__.py", _STAND_IN)
        archive.writestr(f"{name}-1.dist-info/METADATA", f"Name: {name}\nVersion: 1\n")
        archive.writestr(f"{name}-1.dist-info/WHEEL", "Wheel-Version: 1.0\n")
        archive.writestr(f"{name}-1.dist-info/RECORD", "")
    return out.getvalue()


_STAND_IN = """\
from types import SimpleNamespace

__version__ = "a stand-in"


class array(list):
    flags = SimpleNamespace()

    def __getitem__(self, key):
        for each in key if isinstance(key, tuple) else (key,):
            self = list.__getitem__(self, each)
        return array(self) if isinstance(self, list) else self
"""


class _Files(SimpleHTTPRequestHandler):
    def log_message(self, *_: object) -> None:
        """Say nothing."""


class StaticServer:
    """A web server that knows nothing of the editor.

    Args:
        folder: what it serves.
    """

    def __init__(self, folder: Path) -> None:
        self._server = ThreadingHTTPServer(("127.0.0.1", 0), partial(_Files, directory=folder))
        self.address = f"http://127.0.0.1:{self._server.server_port}/"
        self._thread = Thread(target=self._server.serve_forever)
        self._thread.start()

    def stop(self) -> None:
        """Answer nobody any more."""
        self._server.shutdown()
        self._thread.join()
        self._server.server_close()


@contextmanager
def hosted(folder: Path) -> Iterator[StaticServer]:
    """Serve a folder."""
    server = StaticServer(folder)
    try:
        yield server
    finally:
        server.stop()
