"""What a browser needs to run Python: Pyodide, and pydantic for it, as their projects publish them.

Each file is named with its size and its hash, so that nothing else is taken. A site of the editor
holds them, and asks nobody for them.
"""

from __future__ import annotations

import hashlib
import io
import tarfile
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple
from urllib.request import urlopen

from babyrobot_levels.text.errors import BabyRobotError

PYODIDE = "314.0.7"

CDN = f"https://cdn.jsdelivr.net/pyodide/v{PYODIDE}/full/"
"""Where Pyodide's project publishes NumPy and SciPy for it."""

MEMBERS = (
    "pyodide-lock.json",
    "pyodide.asm.mjs",
    "pyodide.asm.wasm",
    "pyodide.mjs",
    "python_stdlib.zip",
)
"""The files of Pyodide that a page loads."""

TIMEOUT = 60
"""How long a server may be silent, in seconds."""

_PYPI = "https://files.pythonhosted.org/packages/"


class RuntimeFileError(BabyRobotError):
    """A file of the runtime that cannot be had, or is another one."""


class RuntimeFile(NamedTuple):
    """A file as it is published: its address, its size in bytes, and its SHA-256."""

    address: str
    size: int
    sha256: str

    @property
    def name(self) -> str:
        """Its name."""
        return self.address.rpartition("/")[2]


TARBALL = RuntimeFile(
    f"https://registry.npmjs.org/pyodide/-/pyodide-{PYODIDE}.tgz",
    6_488_647,
    "66b7949e5a0cba2250b586d7e368bf12fb482800748d182c4618254b685ffaa0",
)
WHEELS = (
    RuntimeFile(
        f"{_PYPI}8a/8c/824a686c4ba815ddb0722f9e66272088bccd4e1ae1d2f7015375e4a4fc7f/"
        "pydantic-2.14.4-py3-none-any.whl",
        494_865,
        "653a2ad9f6d8858529c77c72717d0ea991d6c6837fe683246b2f4b2bbfc3fadc",
    ),
    RuntimeFile(
        f"{_PYPI}83/47/375ab34f3907a0f40cebe2c3cea3e2c25dcf58e0f591991b85604b7258fc/"
        "pydantic_core-2.50.5-cp314-cp314-pyemscripten_2026_0_wasm32.whl",
        1_496_394,
        "b2910ec0fa5aeb9bef70156f2b79f4783978fdcfaa7b2f1b5d1814458d2e79a1",
    ),
)


def runtime_file(file: RuntimeFile, folder: Path | None) -> bytes:
    """Return a file of the runtime.

    Args:
        file: the file.
        folder: a folder that has it; None to download it.

    Raises:
        RuntimeFileError: it is not there, or is not the file that is published.
    """
    source = file.address if folder is None else str(folder / file.name)
    try:
        if folder is not None:
            with (folder / file.name).open("rb") as stream:
                data = stream.read(file.size + 1)
        else:
            with urlopen(file.address, timeout=TIMEOUT) as response:
                data = response.read(file.size + 1)
    except OSError as error:
        raise RuntimeFileError(f"{source} cannot be read ({error.strerror or error})") from None
    if hashlib.sha256(data).hexdigest() != file.sha256:
        raise RuntimeFileError(f"{source} is not the file that its project has published")
    return data


def pyodide_files(tarball: bytes) -> dict[str, bytes]:
    """Return the files of Pyodide that a page loads, by their names."""
    found = {}
    with tarfile.open(fileobj=io.BytesIO(tarball)) as archive:
        for name in MEMBERS:
            member = archive.extractfile(f"package/{name}")
            assert member is not None
            found[name] = member.read()
    return found


def wheel_files(wheel: bytes) -> Iterator[tuple[str, bytes]]:
    """Yield the files of a wheel, with their paths."""
    with zipfile.ZipFile(io.BytesIO(wheel)) as archive:
        for name in archive.namelist():
            if not name.endswith("/"):
                yield name, archive.read(name)
