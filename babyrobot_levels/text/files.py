"""Files: read within limits, and written atomically."""

from __future__ import annotations

import codecs
import errno
import os
import signal
import stat
import sys
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from glob import escape
from pathlib import Path
from typing import IO, TYPE_CHECKING, BinaryIO

from babyrobot_levels.text.diagnostics import Diagnostic, Severity
from babyrobot_levels.text.errors import LevelError
from babyrobot_levels.text.source import MAX_BYTES, START, Position, SourceFile, other_form
from babyrobot_levels.text.words import nearest, no_file

if TYPE_CHECKING:
    from zipfile import ZipFile

SUFFIXES = (".yaml", ".yml")
PACK_FILE = "pack.yaml"
"""The file that makes a folder a pack."""
GALLERY_FILES = ("gallery.json", "index.html")
"""The files that make a folder a gallery of web pages: its list, and its first page."""
MAX_DEPTH = 6
"""So many folders deep are levels looked for."""
RESERVED = {
    *("con", "prn", "aux", "nul"),
    *(f"{device}{number}" for device in ("com", "lpt") for number in range(10)),
}
"""Names that no file can have on Windows, whatever stands behind a dot."""

ENDINGS = [
    getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)
]
"""The signals that end a process, and can be delayed."""

_MAX_PREFIX = 40
"""So many characters of a file's name does its temporary name begin with."""


_SCHEMA = Path("schemas", "level.schema.json")


class NotRegularError(OSError):
    """A device, a pipe or a socket where a file is needed."""


def read_source(path: Path, name: str | None = None, limit: int = MAX_BYTES) -> SourceFile:
    """Read the text of a file that has at most `limit` bytes.

    Messages call it by its `name`, the path as given if left out.

    Raises:
        LevelError: there is no such file, it is not a regular one, too large, or not UTF-8.
    """
    shown = name or str(path)
    return source_of(read_data(path, shown, limit), shown, limit=limit)


def read_data(path: Path, shown: str, limit: int = MAX_BYTES) -> bytes:
    """Return what is in a file that messages call by a name, as `read_bytes` within a limit.

    Raises:
        LevelError: there is no such file, or it is not a regular one.
    """
    try:
        return read_bytes(path, limit)
    except IsADirectoryError:
        raise unreadable("BR101", shown, "this is a directory, not a file") from None
    except NotRegularError:
        raise unreadable("BR101", shown, "this is not a regular file") from None
    except FileNotFoundError:
        told = no_file(str(path), [f"`{each}`" for each in nearest_files(path)[:1]])
        raise unreadable("BR101", shown, f"no such file{told}") from None
    except PermissionError:
        raise unreadable("BR101", shown, "permission denied") from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise unreadable("BR101", shown, f"the file cannot be read ({reason})") from None


def nearest_files(path: Path) -> list[str]:
    """Return the level files with similar names in the folder of one that there is not."""
    try:
        stems = {other.stem: other for other in path.parent.iterdir() if other.suffix in SUFFIXES}
    except OSError:
        return []
    return [str(stems[stem]) for stem in nearest(path.stem, stems)]


def read_bytes(path: Path, limit: int) -> bytes:
    """Return what is in a file; if that is more than `limit` bytes, one more than that.

    Raises:
        OSError: it cannot be read; a `NotRegularError` where it is a device, a pipe or a socket.
    """
    with open_regular(path) as file:
        return file.read(limit + 1)


@contextmanager
def open_regular(path: Path) -> Iterator[BinaryIO]:
    """Open a file for reading.

    Raises:
        OSError: it cannot be read; a `NotRegularError` where it is a device, a pipe or a socket.
    """
    # Not blocking, so that a pipe without a writer cannot hold us up.
    flags = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)
    try:
        descriptor = os.open(path, flags)
    except PermissionError:
        # Windows raises this for folders.
        if is_folder(path):
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path)) from None
        raise
    try:
        mode = os.fstat(descriptor).st_mode
        if stat.S_ISDIR(mode):
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
        if not stat.S_ISREG(mode):
            raise NotRegularError(errno.EINVAL, "this is not a regular file", str(path))
        with open(descriptor, "rb", closefd=False) as file:
            yield file
    finally:
        os.close(descriptor)


MAX_DIRECTORY = 8 << 20
"""The most bytes of the list of files in a zip file: room for some 100,000."""


def open_zip(file: IO[bytes]) -> ZipFile:
    """Open a zip file. To read a list of a million files takes a quarter of a minute, and 0.6 GB.

    Raises:
        BadZipFile: it is none, or has a list of files that is too long.
    """
    import zipfile

    # What the class does first, too: it looks for the record of the list, at the end of the file.
    end = zipfile._EndRecData(file)  # type: ignore[attr-defined]
    if end is not None and end[5] > MAX_DIRECTORY:
        raise zipfile.BadZipFile("it has too many files")
    return zipfile.ZipFile(file)


def is_file(path: Path) -> bool:
    """Tell whether a path is a file; one that cannot be asked is none."""
    # `Path.is_file` raises where a folder on the way may not be entered, and for long names.
    return os.path.isfile(path)  # noqa: PTH113


def is_folder(path: Path) -> bool:
    """Tell whether a path is a folder; one that cannot be asked is none."""
    return os.path.isdir(path)  # noqa: PTH112


def is_within(path: Path, folder: Path) -> bool:
    """Tell whether a path lies in a folder, or is it, when all links are followed."""
    try:
        return Path(os.path.realpath(path)).is_relative_to(os.path.realpath(folder))
    except ValueError:
        # A path with a zero byte.
        return False


def is_environment(path: Path) -> bool:
    """Tell whether a folder is a virtual environment of Python."""
    return is_file(path / "pyvenv.cfg")


def is_aside(path: Path) -> bool:
    """Tell whether a folder in another one is none of it: a gallery of pages, an environment."""
    return is_environment(path) or all(is_file(path / name) for name in GALLERY_FILES)


def user_folder() -> Path:
    """Return the user's own folder for levels and packs, which need not be there."""
    from platformdirs import user_data_path

    return user_data_path("babyrobot-levels", appauthor=False)


def schema_for(path: Path) -> str | None:
    """Return how a level file refers to its schema, None where the project has none.

    Args:
        path: the file, which need not exist.

    Returns:
        The relative path of `schemas/level.schema.json` in the nearest folder around the file
        that has one. A path of this machine would be wrong on every other one.
    """
    folder = Path(os.path.abspath(path)).parent  # noqa: PTH100  (a circle of links has no end)
    for parent in (folder, *folder.parents):
        if is_file(parent / _SCHEMA):
            return Path(os.path.relpath(parent / _SCHEMA, folder)).as_posix()
    return None


def source_of(
    data: bytes, name: str, *, is_made: bool = False, limit: int = MAX_BYTES
) -> SourceFile:
    """Return bytes as a text, that of a file or one that is made of something else.

    Raises:
        LevelError: they are more than `limit`, or not UTF-8.
    """
    if len(data) > limit:
        raise unreadable("BR103", name, f"the file is larger than {limit // (1 << 20)} MiB")
    try:
        return SourceFile(name, data.decode("utf-8"), is_made=is_made)
    except UnicodeDecodeError as error:
        before = SourceFile(name, data[: error.start].decode("utf-8"))
        message = f"invalid UTF-8: byte {error.start + 1} (0x{data[error.start]:02x})"
        if data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
            message = "the file is encoded as UTF-16"
        place = before.position(len(before.text))
        help_text = other_form(name) or "save the file in UTF-8"
        raise unreadable("BR102", name, message, help_text, place) from None


def unreadable(
    code: str, name: str, message: str, help_text: str | None = None, place: Position = START
) -> LevelError:
    """Return the error of a file that cannot be read; its message shows nothing of the file."""
    return LevelError(
        [
            Diagnostic(
                code, Severity.ERROR, message, name, place.line, place.column, place, help=help_text
            )
        ]
    )


def make_folder(path: Path) -> None:
    """Make a folder, and those above it, unless it is there.

    Raises:
        NotADirectoryError: there is a file.
        OSError: the folder cannot be made.
    """
    try:
        path.mkdir(parents=True, exist_ok=True)
    except FileExistsError:
        raise NotADirectoryError(errno.ENOTDIR, os.strerror(errno.ENOTDIR), str(path)) from None


def write_text(path: Path, text: str, *, sync: bool = True) -> None:
    """Write a file atomically: under a temporary name beside it, which is then renamed.

    The folder is created if it is missing. An existing file's permissions are kept.

    Args:
        path: the file.
        text: its new contents.
        sync: whether to wait until the disk has it. Without that, a crash of the machine may leave
            the file empty; the end of this process, in whatever way, may not.
    """
    write_bytes(path, text.encode("utf-8"), sync=sync)


def write_bytes(path: Path, data: bytes, *, sync: bool = True) -> None:
    """Write bytes as `write_text` does."""
    path = path.resolve()
    make_folder(path.parent)
    with _naming(path):
        _replace(path, data, sync=sync)


def write_new(path: Path, data: str | bytes, *, force: bool = False) -> None:
    """Write a file as `write_text` does, in place of an existing one only with `force`.

    Raises:
        FileExistsError: there is a file, or something else.
    """
    if path.exists() and not (force and is_file(path)):
        raise FileExistsError(errno.EEXIST, "it already exists (force=True replaces it)", str(path))
    write_bytes(path, data.encode("utf-8") if isinstance(data, str) else data)


def _replace(path: Path, data: bytes, *, sync: bool) -> None:
    import tempfile

    try:
        mode = stat.S_IMODE(path.stat().st_mode)
    except FileNotFoundError:
        mode = 0o666 & ~_umask()
    with uninterrupted(ENDINGS):
        # A name may be as long as names can be; the temporary one is longer.
        descriptor, name = tempfile.mkstemp(prefix=f".{path.name[:_MAX_PREFIX]}.", dir=path.parent)
        temporary = Path(name)
        try:
            with open(descriptor, "wb") as file:  # noqa: PTH123  (a descriptor, not a path)
                file.write(data)
                file.flush()
                if sync:
                    os.fsync(file.fileno())
            if sys.platform != "win32":
                # There, the only permission is to write, and a file without it stays as it is.
                temporary.chmod(mode)
            temporary.replace(path)
        except BaseException:
            temporary.unlink(missing_ok=True)
            raise


def append_line(path: Path, line: bytes) -> bool:
    """Append a line to a file, which is created if it is missing; or leave it as it is.

    Args:
        path: the file.
        line: the line, without its end; an empty one adds nothing.

    Returns:
        Whether the last line of the file was whole. If it was not, nothing is appended.

    Raises:
        OSError: the file cannot be written. It is then as it was before.
    """
    make_folder(path.parent)
    with _naming(path), uninterrupted(ENDINGS), path.open("ab+", buffering=0) as file:
        size = file.seek(0, os.SEEK_END)
        if size:
            file.seek(size - 1)
            if file.read(1) != b"\n":
                return False
        rest = line + b"\n" if line else b""
        try:
            while rest:
                rest = rest[file.write(rest) :]
        except OSError:
            file.truncate(size)
            raise
    return True


@contextmanager
def written_folder(path: Path) -> Iterator[Path]:
    """Yield a new folder beside a path, which takes its place there at the end of the block.

    What was there before is replaced. If the block raises an error, it stays as it was. What an
    earlier process left beside it that was killed is removed; what it was about to replace returns.

    Raises:
        OSError: the folder cannot be written; the error names a file as it would be called.
    """
    import shutil
    import tempfile

    given, path = path, path.resolve()
    make_folder(path.parent)
    prefix = f".{path.name[:_MAX_PREFIX]}."
    for left in path.parent.glob(f"{escape(prefix)}????????.*"):
        # Of a longer name it may be another folder's.
        if len(path.name) <= _MAX_PREFIX and _has_ended(left.suffix[1:]):
            _restore(left, path)
            shutil.rmtree(left, ignore_errors=True)
    temporary = Path(tempfile.mkdtemp(f".{os.getpid()}", prefix, path.parent))
    folder = temporary / "new"
    try:
        folder.mkdir()
        yield folder
        with uninterrupted(ENDINGS):
            if is_folder(path):
                path.rename(temporary / "old")
            try:
                folder.rename(path)
            except OSError:
                _restore(temporary, path)
                raise
    except OSError as error:
        # A full disk names no file.
        error.filename = str(error.filename or given).replace(str(folder), str(given))
        raise
    finally:
        shutil.rmtree(temporary, ignore_errors=True)


def _restore(temporary: Path, path: Path) -> None:
    """Bring back a folder that was to be replaced, unless there is another one."""
    if is_folder(temporary / "old") and not os.path.lexists(path):
        (temporary / "old").rename(path)


def _has_ended(process: str) -> bool:
    """Return whether a text is the number of a process of this machine that runs no more."""
    if not process.isdecimal() or os.name != "posix":
        return False
    try:
        os.kill(int(process), 0)
    except ProcessLookupError:
        return True
    except (OSError, OverflowError):
        pass
    return False


@contextmanager
def _naming(path: Path) -> Iterator[None]:
    """Have errors of the system name the file: a full disk, for one, names none."""
    try:
        yield
    except OSError as error:
        raise OSError(error.errno, error.strerror or str(error), str(path)) from error


@contextmanager
def uninterrupted(numbers: Sequence[int] = (signal.SIGINT,)) -> Iterator[None]:
    """Delay signals, Ctrl-C by default, until the block is done, so that it leaves nothing half."""
    if threading.current_thread() is not threading.main_thread():
        # Others are not interrupted.
        yield
        return
    come: list[int] = []
    before = {
        number: signal.signal(number, lambda number, _: come.append(number)) for number in numbers
    }
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler or signal.SIG_DFL)
        for number in come[:1]:
            signal.raise_signal(number)


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
