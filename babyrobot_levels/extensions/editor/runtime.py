"""What a browser needs to run Python: Pyodide, and pydantic for it, as their projects publish them.

Each file is named with its size and its hash, so that nothing else is taken. A site of the editor
holds them, and asks nobody for them.
"""

import hashlib
import io
import json
import shutil
import subprocess
import sys
import tarfile
import tempfile
import zipfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

from babyrobot_levels.mdp.numeric import LIBRARIES
from babyrobot_levels.text.errors import BabyRobotError

PYODIDE = "314.0.7"
PYDANTIC = "2.14.4"
PYDANTIC_CORE = "2.50.5"
PLATFORM = "pyemscripten_2026_0_wasm32"
"""Pyodide's, in the names of wheels."""

CDN = f"https://cdn.jsdelivr.net/pyodide/v{PYODIDE}/full/"
"""Where Pyodide's project publishes NumPy and SciPy for it, which are about 20 MB."""

LOCK = "pyodide-lock.json"

MEMBERS = (LOCK, "pyodide.asm.mjs", "pyodide.asm.wasm", "pyodide.mjs", "python_stdlib.zip")
"""The files of Pyodide that a page loads."""

TIMEOUT = 300
"""How long fetching may take, in seconds."""


class RuntimeFileError(BabyRobotError, public=True):
    """A file of the runtime that cannot be had, or is another one."""


class RuntimeFile(NamedTuple):
    """A file as it is published: its name, its size in bytes, and its SHA-256."""

    name: str
    size: int
    sha256: str


TARBALL = RuntimeFile(
    f"pyodide-{PYODIDE}.tgz",
    6_488_647,
    "66b7949e5a0cba2250b586d7e368bf12fb482800748d182c4618254b685ffaa0",
)
WHEELS = (
    RuntimeFile(
        f"pydantic-{PYDANTIC}-py3-none-any.whl",
        494_865,
        "653a2ad9f6d8858529c77c72717d0ea991d6c6837fe683246b2f4b2bbfc3fadc",
    ),
    RuntimeFile(
        f"pydantic_core-{PYDANTIC_CORE}-cp314-cp314-{PLATFORM}.whl",
        1_496_394,
        "b2910ec0fa5aeb9bef70156f2b79f4783978fdcfaa7b2f1b5d1814458d2e79a1",
    ),
)

_NPM = ("pack", "--silent", f"pyodide@{PYODIDE}")
DOWNLOAD = (
    *("-P", "-m", "pip", "download", "--quiet", "--no-deps", "--only-binary=:all:"),
    *("--python-version", "3.14", "--implementation", "cp", "--abi", "cp314"),
    *("--platform", PLATFORM),
)
"""What has Python download wheels for Pyodide; their names follow."""

_PIP = (*DOWNLOAD, f"pydantic=={PYDANTIC}", f"pydantic-core=={PYDANTIC_CORE}")


@contextmanager
def runtime_folder(folder: Path | None) -> Iterator[Path]:
    """Yield a folder that has the files: the one that is given, or one for which they are fetched.

    npm and pip fetch them, from where they are set up to take packages.

    Raises:
        RuntimeFileError: they cannot be fetched.
    """
    if folder is not None:
        yield folder
        return
    npm = shutil.which("npm")
    if npm is None:
        raise RuntimeFileError("there is no npm, which fetches Pyodide")
    with tempfile.TemporaryDirectory() as fetched:
        for command in ((npm, *_NPM), (sys.executable, *_PIP)):
            try:
                done = subprocess.run(
                    command,
                    cwd=fetched,
                    capture_output=True,
                    text=True,
                    timeout=TIMEOUT,
                    check=False,
                )
            except subprocess.TimeoutExpired:
                raise RuntimeFileError(f"{command[-1]} cannot be fetched (timed out)") from None
            if done.returncode:
                reason = (done.stderr.strip().splitlines() or ["no reason given"])[-1]
                raise RuntimeFileError(f"{command[-1]} cannot be fetched ({reason})")
        yield Path(fetched)


def runtime_file(file: RuntimeFile, folder: Path) -> bytes:
    """Return a file of the runtime from a folder.

    Raises:
        RuntimeFileError: it is not there, or is not the file that is published.
    """
    try:
        with (folder / file.name).open("rb") as stream:
            data = stream.read(file.size + 1)
    except OSError as error:
        reason = error.strerror or error
        raise RuntimeFileError(f"{folder / file.name} cannot be read ({reason})") from None
    if hashlib.sha256(data).hexdigest() != file.sha256:
        raise RuntimeFileError(
            f"{folder / file.name} is not the file that its project has published"
        )
    return data


def numeric_wheels(folder: Path, libraries: Sequence[str] = LIBRARIES) -> dict[str, bytes]:
    """Return the wheels of libraries that a folder has, by their names; none if one lacks.

    They may be of any version, and are not compared with what is published.
    """
    found = [[*folder.glob(f"{name}-*-{PLATFORM}.whl")] for name in libraries]
    return {max(each).name: max(each).read_bytes() for each in found} if all(found) else {}


def lock_with(lock: bytes, wheels: dict[str, bytes]) -> bytes:
    """Return Pyodide's list of packages, which names files and hashes, with other wheels in it."""
    data = json.loads(lock)
    for file, wheel in wheels.items():
        data["packages"][file.partition("-")[0]] |= {
            "file_name": file,
            "version": file.split("-")[1],
            "sha256": hashlib.sha256(wheel).hexdigest(),
        }
    return json.dumps(data).encode()


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
