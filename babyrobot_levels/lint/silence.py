"""Comments that silence findings: `# babyrobot: ignore[BR503] why`."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass, field

from babyrobot_levels.lint.rule import Rule
from babyrobot_levels.text.comments import Comment
from babyrobot_levels.text.document import Document
from babyrobot_levels.text.source import Span

MARK = "babyrobot:"
"""What every silencing comment has in it."""

_COMMENT = re.compile(r"#\s*babyrobot:\s*ignore(?:\[(?P<words>[^\]]*)\])?(?P<why>.*)")


@dataclass(slots=True)
class Silence:
    """One comment that silences rules.

    Attributes:
        comment: the comment.
        words: the codes and names of the rules.
        lines: the lines (from 1) for which it speaks, None for the whole file.
        used: the words that silenced something.
    """

    comment: Comment
    words: tuple[str, ...]
    lines: range | None
    used: set[str] = field(default_factory=set)

    def covers(self, rule: Rule, span: Span) -> bool:
        """Tell whether what a rule found at a place is silenced, and note it."""
        if self.lines is not None and span.start.line not in self.lines:
            return False
        hits = [word for word in self.words if rule.is_called(word)]
        self.used.update(hits)
        return bool(hits)


def silences(document: Document, comments: Iterable[Comment]) -> list[Silence]:
    """Return the silencing comments of a file.

    One that stands above the first field speaks for the whole file; behind something, for what
    begins on its line, with all that lies in it; on a line of its own, for what begins below it.
    """
    found = []
    for comment in comments:
        match = _COMMENT.match(comment.text)
        if match is not None:
            words = tuple(filter(None, re.split(r"[,\s]+", match["words"] or "")))
            found.append(Silence(comment, words, _lines(document, comment)))
    return found


def _lines(document: Document, comment: Comment) -> range | None:
    line = comment.span.start.line
    if comment.is_alone:
        if line < document.root.span.start.line:
            return None
        lines = document.source.lines
        while line < len(lines) and lines[line].lstrip()[:1] in ("", "#"):
            line += 1
        line += 1
    return range(line, _last_line(document, line) + 1)


def _last_line(document: Document, line: int) -> int:
    """Return the last line of what begins on a line: a field, an entry, or a value."""
    waiting, last = [document.root], line
    while waiting:
        node = waiting.pop()
        for key, child in node.children.items():
            begin = node.keys.get(key, child).span.start.line
            end = child.span.end.line - (child.span.end.column == 1)
            if begin == line:
                last = max(last, end)
            elif begin < line <= end:
                waiting.append(child)
    return last
