"""The package itself as a wheel, as it is installed here: for students, and for autograders."""

import base64
from collections.abc import Iterator, Mapping
from hashlib import sha256
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path

from babyrobot_levels.library.search_path import data_folder
from babyrobot_levels.text.errors import DISTRIBUTION

DATA = ("course", "levels", "schemas")
"""The folders of data, which are beside the package in a checkout."""

_TAGS = (
    "Wheel-Version: 1.0\nGenerator: babyrobot-levels\nRoot-Is-Purelib: true\nTag: py3-none-any\n"
)


def wheel() -> tuple[str, Mapping[str, bytes]]:
    """Return the name of a wheel of this package, and its files.

    They are empty where the package is not installed, but run from a folder.
    """
    try:
        own = distribution(DISTRIBUTION)
    except PackageNotFoundError:
        return "", {}
    stem = f"{DISTRIBUTION.replace('-', '_')}-{own.version}"
    about = {
        name: text.encode()
        for name in ("METADATA", "entry_points.txt", "licenses/LICENSE")
        if (text := own.read_text(name)) is not None
    }
    files = dict(sorted(_files()))
    files |= {f"{stem}.dist-info/{name}": data for name, data in about.items()}
    files[f"{stem}.dist-info/WHEEL"] = _TAGS.encode()
    lines = [f"{name},sha256={_digest(data)},{len(data)}" for name, data in files.items()]
    record = f"{stem}.dist-info/RECORD"
    files[record] = "\n".join([*lines, f"{record},,", ""]).encode()
    return f"{stem}-py3-none-any.whl", files


def _files() -> Iterator[tuple[str, bytes]]:
    """Yield the files of the package and of its data, by their paths in a wheel."""
    package = Path(__file__).parents[2]
    places = {package: package.name}
    places |= {data_folder(name): f"{package.name}/data/{name}" for name in DATA}
    for folder, inner in places.items():
        for path in folder.rglob("*"):
            if "__pycache__" not in path.parts and path.is_file():
                yield f"{inner}/{path.relative_to(folder).as_posix()}", path.read_bytes()


def _digest(data: bytes) -> str:
    return base64.urlsafe_b64encode(sha256(data).digest()).rstrip(b"=").decode()
