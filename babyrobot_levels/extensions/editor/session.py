"""One level being edited: its text, what gestures make of it, the steps to undo, and its file."""

from __future__ import annotations

import os
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from babyrobot_levels.extensions.editor.answers import Answers
from babyrobot_levels.extensions.editor.changes.dispatch import change, is_regrown
from babyrobot_levels.extensions.editor.changes.draft import Draft, RefusedError
from babyrobot_levels.extensions.editor.changes.fields import fixed
from babyrobot_levels.extensions.editor.changes.region import Region, lifted, stamp
from babyrobot_levels.extensions.editor.differences import LastShown
from babyrobot_levels.extensions.editor.findings import Linter, Linting
from babyrobot_levels.extensions.editor.gestures import Fix, Gesture, Resolve, Stamp
from babyrobot_levels.language.geometry import Cell
from babyrobot_levels.library.level import Level
from babyrobot_levels.linter.runner import Report, lint_document, lint_source
from babyrobot_levels.text.document import Document, comments
from babyrobot_levels.text.emitter import emit
from babyrobot_levels.text.errors import LevelError
from babyrobot_levels.text.files import read_source, write_text
from babyrobot_levels.text.reader import read
from babyrobot_levels.text.source import BOM, MAX_BYTES, SourceFile
from babyrobot_levels.text.splice import common_ends, spliced


class Session:
    """A level text that is edited by gestures and by typing.

    Args:
        text: the text.
        name: what it is called where there is no file.
        file: the file that it is saved to.

    Attributes:
        file: the file that it is saved to; None where there is none.
        name: what it is called where there is no file.
        revision: a number that grows with each change of the text.
        level: the level of the text, or of the last text that was valid; None if none was.
        document: the text that `level` is from, as it was read.
        linting: the findings in the text.
        answers: the optimum of the level.
        shown: the state that was shown last.
        lost: how many of which kinds the last gesture removed that it did not point at.
        left: how many of which kinds the last gesture, a stamp, left out.
        region: what is stamped, see `lift`; None at first.
    """

    def __init__(
        self, text: str, *, name: str | None = None, file: EditedFile | None = None
    ) -> None:
        self.file = file
        self.name = name
        self.revision = 0
        self.level: Level | None = None
        self.document: Document | None = None
        self.answers = Answers()
        self.shown = LastShown()
        self.linting: Linting
        self._linter = Linter()
        self.lost: Counter[str] = Counter()
        self.left: Counter[str] = Counter()
        self.region: Region | None = None
        self._regrown_by: Gesture | None = None
        self._history = History(text)
        self._saved = text
        self._read()

    @property
    def text(self) -> str:
        """The text at hand."""
        return self._history.text

    @property
    def path(self) -> Path | None:
        """The path of the file, None where there is none."""
        return None if self.file is None else self.file.path

    @property
    def source(self) -> SourceFile:
        """The text, with the name under which messages speak of it."""
        return SourceFile(str(self.path or self.name or "level.yaml"), self.text)

    @property
    def report(self) -> Report:
        """What is found in the text so far; see `catch_up`."""
        return self.linting.report

    @property
    def is_valid(self) -> bool:
        """Whether the text is a valid level, which `level` then is."""
        return self.report.level is not None

    @property
    def is_saved(self) -> bool:
        """Whether the text is as it was opened or saved last."""
        return self.text == self._saved

    @property
    def can_undo(self) -> bool:
        """Whether there is a change to undo."""
        return self._history.can_undo

    @property
    def can_redo(self) -> bool:
        """Whether there is a change to do again."""
        return self._history.can_redo

    @property
    def is_maze_regrown(self) -> bool:
        """Whether the last change was a gesture that made the maze grow anew."""
        return self._regrown_by is not None

    def keep_maze(self) -> None:
        """Carry the last gesture out again with the maze written out as walls, as one step.

        Raises:
            RefusedError: the maze did not grow anew by that, or it cannot be carried out.
        """
        gesture = self._regrown_by
        if gesture is None:
            raise RefusedError("the last change did not make the maze grow anew")
        self.undo()
        self.apply(Resolve(do="resolve"))
        self.apply(gesture, joined=True)

    def apply(self, gesture: Gesture, *, joined: bool = False) -> None:
        """Carry out a gesture, as one step; `joined` makes it one with the change before.

        Raises:
            RefusedError: it cannot be carried out, or the level would not be valid; nothing has
                changed.
        """
        if isinstance(gesture, Fix):
            self._fix(gesture)
            return
        document = self.report.document
        if self.report.level is None or document is None:
            raise RefusedError("the text has errors; correct them before you go on drawing")
        before = self.report.level
        draft = Draft(document, before)
        self._change_draft(draft, gesture)
        data = draft.result()
        after = spliced(document, data, [*Level.model_fields])
        if after is document:
            if draft.left.total():
                raise RefusedError("nothing of what is copied can stand there")
            return
        if after is None:
            after = _written_anew(document, data)
        if len(after.source.text.encode()) > MAX_BYTES:
            raise RefusedError("the text would be larger than the file of a level may be")
        report = lint_document(after, (), self.path)
        if report.level is None:
            raise RefusedError(report.diagnostics[0].message)
        self._history.change(after.source.text, gesture.do, joined=joined)
        self._take(report)
        self.lost, self.left = draft.lost, draft.left
        if is_regrown(before, report.level, gesture):
            self._regrown_by = gesture

    def _change_draft(self, draft: Draft, gesture: Gesture) -> None:
        if not isinstance(gesture, Stamp):
            change(draft, gesture)
        elif self.region is None:
            raise RefusedError("nothing is copied yet: drag over some cells first")
        else:
            stamp(draft, self.region, gesture)

    def lift(self, one: Cell, other: Cell) -> Region:
        """Copy the region between two cells, which `stamp` then puts elsewhere.

        Raises:
            RefusedError: the text has errors, or the cells are off the grid or too many.
        """
        if self.report.level is None or self.report.document is None:
            raise RefusedError("the text has errors; correct them before you copy")
        self.region = lifted(self.report.level, self.report.document, one, other)
        return self.region

    def _fix(self, fix: Fix) -> None:
        text = fixed(self.report, fix)
        report = self._checked(SourceFile(self.source.name, text))
        if self.is_valid and not report.is_valid:
            raise RefusedError(f"after this fix, {report.diagnostics[0].message}")
        self._history.change(text, fix.do)
        self._take(report)

    def type(self, text: str, *, joined: bool = False) -> None:
        """Replace the text by what was typed; `joined` makes it one step with the change before."""
        self._change(text, "text", joined=joined)

    def undo(self) -> str | None:
        """Undo the last step, and return its name; None if there is none."""
        step = self._history.undo()
        self._read()
        return step

    def redo(self) -> str | None:
        """Do the step again that was undone last, and return its name; None if there is none."""
        step = self._history.redo()
        self._read()
        return step

    def open(self, text: str, name: str) -> None:
        """Replace the level by another one, which can be undone. The file stays the same."""
        self._change(text, "open")
        if self.file is None:
            self.name, self._saved = name, text

    def save(self, *, force: bool = False) -> None:
        """Write the text to the file; see `EditedFile.write`.

        Raises:
            ConflictError: another program has changed the file; `force` overwrites it.
            RefusedError: there is no file, or it cannot be written.
        """
        if self.file is None:
            raise RefusedError("this level has no file; download it instead")
        self.file.write(self.text, force=force)
        self._saved = self.text

    def note_download(self) -> None:
        """Note that the user has the text at hand in a file that only the browser knows."""
        self._saved = self.text

    def reload(self) -> None:
        """Take the text that the file has now, which can be undone.

        Raises:
            RefusedError: there is no file, or it cannot be read.
        """
        if self.file is None:
            raise RefusedError("this level has no file")
        self.file.reread()
        self._change(self.file.text, "reload")
        self._saved = self.text

    def read_again(self) -> None:
        """Check the text again, once more can be told of it than before."""
        self._read()

    def _change(self, text: str, step: str, *, joined: bool = False) -> None:
        self._history.change(text, step, joined=joined)
        self._read()

    def _read(self) -> None:
        self._take(self._checked(self.source))

    def _checked(self, source: SourceFile) -> Report:
        return lint_source(source, (), self.path)

    def _take(self, report: Report) -> None:
        """Take the text at hand, of which a report has the errors."""
        self.revision += 1
        self._regrown_by = None
        self.lost, self.left = Counter(), Counter()
        if report.level is not None:
            self.level, self.document = report.level, report.document
            self.answers.follow(report.level)
        self.linting = self._linter.follow(report, self.path, self.answers)

    def catch_up(self) -> None:
        """Compute what takes long: the optimum, and the findings that need it or more."""
        self.answers.catch_up()
        self._linter.catch_up(self.answers)


def _written_anew(document: Document, data: dict[str, Any]) -> Document:
    """Return fields as a text of its own, below the comments of the document."""
    above = "".join(f"{comment.text}\n" for comment in comments(document))
    return read(SourceFile(document.source.name, above + emit(data)))


# -- steps ---------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Step:
    """One change, with its name: from a place on, `old` became `new`."""

    name: str
    first: int
    old: str
    new: str


@dataclass(slots=True)
class History:
    """A text with the changes that led to it, and those that were undone."""

    text: str
    _done: list[Step] = field(default_factory=list)
    _undone: list[Step] = field(default_factory=list)

    @property
    def can_undo(self) -> bool:
        """Whether there is a change to undo."""
        return bool(self._done)

    @property
    def can_redo(self) -> bool:
        """Whether there is a change to do again."""
        return bool(self._undone)

    def change(self, text: str, name: str, *, joined: bool = False) -> None:
        """Make another text of it.

        Args:
            text: the text.
            name: what the step is called.
            joined: whether this and the change before are one step.
        """
        if text == self.text:
            return
        before = self.text
        if joined and self._done:
            before = _replaced(before, self._done.pop(), undo=True)
        first, same = common_ends(before, text)
        old, new = before[first : len(before) - same], text[first : len(text) - same]
        self._done.append(Step(name, first, old, new))
        self._undone.clear()
        self.text = text

    def undo(self) -> str | None:
        """Undo the last change, and return its name; None if there is none."""
        if not self._done:
            return None
        self._undone.append(self._done.pop())
        self.text = _replaced(self.text, self._undone[-1], undo=True)
        return self._undone[-1].name

    def redo(self) -> str | None:
        """Do again what was undone last, and return its name; None if there is nothing."""
        if not self._undone:
            return None
        self._done.append(self._undone.pop())
        self.text = _replaced(self.text, self._done[-1], undo=False)
        return self._done[-1].name


def _replaced(text: str, step: Step, *, undo: bool) -> str:
    old, new = (step.new, step.old) if undo else (step.old, step.new)
    return text[: step.first] + new + text[step.first + len(old) :]


# -- the file ----------------------------------------------------------------------------


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
    def exists(self) -> bool:
        """Whether there was such a file when it was read or written last."""
        return self._held is not None

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
