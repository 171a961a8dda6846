"""The file that a level is edited in: written whole or not at all, and never by surprise."""

from __future__ import annotations

import os
from pathlib import Path

from babyrobot_levels.editor.changes.draft import RefusedError
from babyrobot_levels.text.errors import LevelError
from babyrobot_levels.text.files import read_source, write_text
from babyrobot_levels.text.source import BOM


class ConflictError(RefusedError):
    """The file was changed by another program since it was read or written last.

    Attributes:
        found: what it holds now; None if it was deleted, or holds no text.
    """

    def __init__(self, message: str, found: str | None) -> None:
        super().__init__(message)
        self.found = found


class EditedFile:
    """A file, and what it held when it was read or written last.

    Texts have LF at the end of lines, as browsers do, and no byte order mark; a file with CRLF,
    or with such a mark, keeps it.

    Args:
        path: the file, which need not exist. A link to a file stands for that file.

    Attributes:
        path: the file itself.

    Raises:
        LevelError: the file cannot be read.
    """

    def __init__(self, path: Path) -> None:
        self.path = Path(os.path.realpath(path))
        self._held = self._on_disk()

    @property
    def text(self) -> str:
        """What it held when it was read or written last; nothing if it did not exist."""
        return (self._held or "").removeprefix(BOM).replace("\r\n", "\n").replace("\r", "\n")

    def reread(self) -> None:
        """Read it again.

        Raises:
            RefusedError: it does not exist, or cannot be read.
        """
        try:
            held = self._on_disk()
        except LevelError as error:
            raise RefusedError(f"{self._name}: {error.diagnostics[0].message}") from None
        if held is None:
            raise RefusedError(f"{self._name} does not exist any more")
        self._held = held

    def write(self, text: str, *, force: bool = False) -> None:
        """Write it, whole or not at all.

        Args:
            text: its new contents.
            force: whether to overwrite what another program has written meanwhile.

        Raises:
            ConflictError: another program has changed, made or removed it; nothing is written.
            RefusedError: it cannot be written.
        """
        self._check(force=force)
        held = self._held or ""
        if "\r\n" in held:
            text = text.replace("\n", "\r\n")
        if held.startswith(BOM):
            text = BOM + text
        try:
            write_text(self.path, text)
        except OSError as error:
            raise RefusedError(
                f"{self._name} cannot be written ({error.strerror or error})"
            ) from None
        self._held = text

    @property
    def _name(self) -> str:
        return self.path.name

    def _check(self, *, force: bool) -> None:
        # Where the path leads now is written, so it may not lead elsewhere than before.
        if Path(os.path.realpath(self.path)) != self.path:
            raise RefusedError(
                f"{self._name} has become a link to another file, which is not written"
            )
        if self.path.exists() and not os.access(self.path, os.W_OK):
            raise RefusedError(f"{self._name} is read-only; change its permissions first")
        try:
            found = self._on_disk()
        except LevelError as error:
            message = error.diagnostics[0].message
            if not self.path.is_file():
                raise RefusedError(f"{self._name} cannot be written: {message}") from None
            # Another program has made something of it that is no text of a level.
            found = None if self._held is not None else ""
        if found == self._held or force:
            return
        if found is None:
            raise ConflictError(f"{self._name} was deleted by another program", None)
        done = "changed" if self._held is not None else "made"
        raise ConflictError(
            f"{self._name} was {done} by another program meanwhile", found.removeprefix(BOM)
        )

    def _on_disk(self) -> str | None:
        """Return what it holds now, None if it does not exist."""
        try:
            source = read_source(self.path)
            return source.mark + source.text
        except LevelError:
            if not os.path.lexists(self.path):
                return None
            raise
