"""Comments that suppress findings: `# babyrobot: ignore[BR503] reason`."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable
from dataclasses import dataclass, field

from babyrobot_levels.text.document import Comment, Document
from babyrobot_levels.text.source import Span

MARK = "babyrobot:"
"""A text that every suppression comment contains."""

_COMMENT = re.compile(r"#\s*babyrobot:\s*ignore(?:\[(?P<words>[^\]]*)\])?(?P<reason>.*)")


@dataclass(slots=True)
class Suppression:
    """One comment that suppresses rules.

    Attributes:
        comment: the comment.
        words: the codes and names of rules in it, as written.
        lines: the lines (from 1) that it covers, None for the whole file.
        used: the words that suppressed a finding.
    """

    comment: Comment
    words: tuple[str, ...]
    lines: range | None
    used: set[str] = field(default_factory=set)

    def covers(self, names: Collection[str], span: Span) -> bool:
        """Return whether a finding at a position is suppressed, and record the words that did it.

        Args:
            names: the rule's code and names, in lower case.
            span: the position.
        """
        if self.lines is not None and span.start.line not in self.lines:
            return False
        hits = [word for word in self.words if word.lower() in names]
        self.used.update(hits)
        return bool(hits)


def suppressions(document: Document, comments: Iterable[Comment]) -> list[Suppression]:
    """Return the suppression comments of a file.

    A comment above the first field covers the whole file. At the end of a line, it covers what
    begins on that line, including everything nested in it. On a line of its own, it covers what
    begins below it.
    """
    found = []
    for comment in comments:
        match = _COMMENT.match(comment.text)
        if match is not None:
            words = tuple(filter(None, re.split(r"[,\s]+", match["words"] or "")))
            found.append(Suppression(comment, words, _lines(document, comment)))
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
    """Return the last line of the fields, entries and values that begin on a line."""
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
