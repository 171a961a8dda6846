"""The editor as a folder of static files, in which the session runs in the visitor's browser.

The page is the one that the server shows. Its messages go to a worker, in which Pyodide runs this
package (`editor/browser.py`). A service worker keeps all files, so that the page works offline.
Other pages of the same host can show levels to be changed by `playground.js`, its module `show`.
"""

import hashlib
import io
import json
import zipfile
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path
from urllib.parse import urlsplit

from babyrobot_levels.extensions.editor.runtime import (
    CDN,
    LOCK,
    TARBALL,
    WHEELS,
    lock_with,
    numeric_wheels,
    pyodide_files,
    runtime_file,
    runtime_folder,
    wheel_files,
)
from babyrobot_levels.extensions.editor.session import Session
from babyrobot_levels.extensions.editor.state import STATIC, playground_script, site_script, style
from babyrobot_levels.library.search_path import gallery_folder
from babyrobot_levels.render.page import bare
from babyrobot_levels.render.scene.build import build_scene
from babyrobot_levels.render.svg import to_svg
from babyrobot_levels.render.templates import embedded_json, html, static
from babyrobot_levels.text.errors import BabyRobotError
from babyrobot_levels.text.files import write_bytes

PACKAGES = ("babyrobot_levels", "annotated_types", "lazy_loader", "platformdirs")
MORE = ("typing_extensions", "typing_inspection", "yaml")
"""What the session imports beside what `WHEELS` has; all of it is there as plain Python."""

MARK = "service.js"
"""The file that is written last: a folder that has it may be written again."""

_LEFT_OUT = {".pyd", ".so"}
_OLDEST = (1980, 1, 1, 0, 0, 0)


class SiteFolderError(BabyRobotError):
    """A folder in which no site is written, as it has files of another kind."""


def write_site(folder: Path, session: Session, runtime: Path | None = None) -> int:
    """Write the editor as static files.

    Args:
        folder: where to; it is made if it is missing.
        session: with whose text visitors begin.
        runtime: a folder that has the files of `editor/runtime.py`; None to fetch them. If it has
            wheels of NumPy and SciPy as well, the site has them, and nobody else is asked for them.

    Returns:
        How many bytes a visitor loads at first.

    Raises:
        SiteFolderError: the folder has files, and no site.
        RuntimeFileError: a file of the runtime cannot be had.
        OSError: a file cannot be written.
    """
    if folder.is_dir() and any(folder.iterdir()) and not (folder / MARK).is_file():
        raise SiteFolderError(f"{folder} has files already, and they are no site of the editor")
    with runtime_folder(runtime) as given:
        wheels = [runtime_file(wheel, given) for wheel in WHEELS]
        python = pyodide_files(runtime_file(TARBALL, given))
        numeric = numeric_wheels(given)
    more, address = f"about 20 MB from {urlsplit(CDN).netloc}", CDN
    if numeric:
        more, address = f"{sum(map(len, numeric.values())) / 1e6:.0f} MB", "./python/"
        python[LOCK] = lock_with(python[LOCK], numeric)
    files = {
        "editor.css": style().encode(),
        "worker.js": static(f"{STATIC}/worker.js").replace("MORE_ADDRESS", address).encode(),
        **{f"python/{name}": data for name, data in python.items()},
        "python/packages.zip": _archive(_packages(wheels)),
    }
    size = sum(map(len, files.values()))
    for name, script in (("editor.js", site_script()), ("playground.js", playground_script())):
        size += len(script)
        told = script.replace("SITE_MEGABYTES", f"{size / 1e6:.0f}").replace("SITE_MORE", more)
        files[name] = told.encode()
    begin = {
        "text": session.text,
        "name": session.path.stem if session.path else session.name,
        # It is shown until Python has one.
        "picture": "" if session.level is None else to_svg(build_scene(bare(session.level))),
    }
    files["index.html"] = html(f"{STATIC}/site.html", begin=embedded_json(begin)).encode()
    for name, data in files.items():
        write_bytes(folder / name, data, sync=False)
    version = hashlib.sha256()
    for name, data in files.items():
        version.update(name.encode() + hashlib.sha256(data).digest())
    known = json.dumps({"version": version.hexdigest()[:16], "files": ["./", *files]})
    for name, data in numeric.items():
        write_bytes(folder / "python" / name, data, sync=False)
    service = static(f"{STATIC}/service.js").replace('"SITE_FILES"', json.dumps(known))
    write_bytes(folder / MARK, service.encode(), sync=False)
    return size


def _packages(wheels: list[bytes]) -> Iterator[tuple[str, bytes]]:
    """Yield the files of all packages, with their paths among the installed ones."""
    for wheel in wheels:
        yield from wheel_files(wheel)
    for name in (*PACKAGES, *MORE):
        spec = find_spec(name)
        assert spec is not None
        assert spec.origin is not None
        origin = Path(spec.origin)
        if spec.submodule_search_locations is None:
            yield origin.name, origin.read_bytes()
            continue
        for path in sorted(origin.parent.rglob("*")):
            is_compiled = path.suffix in _LEFT_OUT or path.parent.name == "__pycache__"
            if path.is_file() and not is_compiled:
                yield path.relative_to(origin.parents[1]).as_posix(), path.read_bytes()
    # Of a checkout, the gallery lies beside the package.
    gallery = gallery_folder()
    for path in sorted(gallery.rglob("*")):
        if path.is_file():
            inside = path.relative_to(gallery).as_posix()
            yield f"babyrobot_levels/data/levels/{inside}", path.read_bytes()


def _archive(files: Iterator[tuple[str, bytes]]) -> bytes:
    """Return files as a zip archive, the same bytes each time."""
    archive = io.BytesIO()
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as made:
        for name, data in dict(files).items():
            made.writestr(zipfile.ZipInfo(name, _OLDEST), data, zipfile.ZIP_DEFLATED)
    return archive.getvalue()
