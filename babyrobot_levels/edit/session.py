"""One level being edited: its text, and what gestures make of it."""

from __future__ import annotations

from pathlib import Path

from babyrobot_levels.edit.answers import Answers
from babyrobot_levels.edit.changes import change
from babyrobot_levels.edit.draft import Draft, RefusedError
from babyrobot_levels.edit.edited_file import EditedFile
from babyrobot_levels.edit.gestures import Gesture
from babyrobot_levels.edit.history import History
from babyrobot_levels.library.level import Level
from babyrobot_levels.library.reading import load_source
from babyrobot_levels.lint.registry import select
from babyrobot_levels.lint.runner import Report, lint_source
from babyrobot_levels.text.document import Document
from babyrobot_levels.text.emitter import emit
from babyrobot_levels.text.errors import LevelError
from babyrobot_levels.text.reader import read
from babyrobot_levels.text.source import SourceFile
from babyrobot_levels.text.splice import splice


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
        report: the findings in the text.
        answers: the optimum of the level.
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

    def apply(self, gesture: Gesture) -> None:
        """Carry out a gesture, as one step.

        Raises:
            RefusedError: it cannot be carried out, or the level would not be valid; nothing has
                changed.
        """
        if self.report.level is None:
            raise RefusedError("the text has errors; correct them before you go on drawing")
        document = read(self.source)
        draft = Draft(document, self.report.level)
        change(draft, gesture)
        data = draft.result()
        text = splice(self.text, data, list(Level.model_fields))
        if text is None:
            text = emit(data)
        try:
            load_source(SourceFile(self.source.name, text), self.path)
        except LevelError as error:
            raise RefusedError(error.diagnostics[0].message) from None
        self._change(text)

    def type(self, text: str, *, joined: bool = False) -> None:
        """Replace the text by what was typed; `joined` makes it one step with the change before."""
        self._change(text, joined=joined)

    def undo(self) -> None:
        """Undo the last step."""
        self._history.undo()
        self._read()

    def redo(self) -> None:
        """Do the step again that was undone last."""
        self._history.redo()
        self._read()

    def open(self, text: str, name: str) -> None:
        """Replace the level by another one, which can be undone. The file stays the same."""
        self._change(text)
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

    def reload(self) -> None:
        """Take the text that the file has now, which can be undone.

        Raises:
            RefusedError: there is no file, or it cannot be read.
        """
        if self.file is None:
            raise RefusedError("this level has no file")
        self.file.reread()
        self._change(self.file.text)
        self._saved = self.text

    def _change(self, text: str, *, joined: bool = False) -> None:
        self._history.change(text, joined=joined)
        self._read()

    def _read(self) -> None:
        self.revision += 1
        self.report: Report = lint_source(self.source, select(None), self.path)
        if self.report.level is not None:
            self.level, self.document = self.report.level, self.report.document
            self.answers.follow(self.level)
