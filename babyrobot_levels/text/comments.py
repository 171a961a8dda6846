"""The comments of a YAML text: no parser keeps them, but they stand where nothing else does."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache

from babyrobot_levels.text.document import Document
from babyrobot_levels.text.source import Position, Span


@dataclass(frozen=True, slots=True)
class Comment:
    """A comment, from its `#` to the end of the line."""

    text: str
    span: Span
    is_alone: bool
    """True where nothing but blanks stands before it on its line."""


@lru_cache(maxsize=4)
def comments(document: Document) -> Sequence[Comment]:
    """Return the comments of a document, in the order of the text."""
    source = document.source
    text, found, index = source.text, [], -1
    texts: list[tuple[int, int]] | None = None
    while (index := text.find("#", index + 1)) >= 0:
        if index and text[index - 1] not in " \t\r\n\ufeff":
            continue
        if texts is None:
            texts = sorted(_texts(document))
        place = bisect_right(texts, (index, len(text))) - 1
        if place >= 0 and index < texts[place][1]:
            # Within a text it is a character like others; there may be a comment behind the text.
            index = texts[place][1] - 1
            continue
        start = source.position(index)
        line = source.line(start.line)
        end = Position(start.line, len(line) + 1)
        column = start.column - 1
        found.append(Comment(line[column:], Span(start, end), not line[:column].strip()))
        index += len(line) - column
    return found


def _texts(document: Document) -> Iterator[tuple[int, int]]:
    """Yield where texts and other scalars begin and end, in characters from 0."""
    waiting, seen = [document.root], set()
    text = document.source.text
    while waiting:
        node = waiting.pop()
        if isinstance(node.data, dict | list):
            # Aliases lead to the same nodes again.
            if id(node.children) not in seen:
                seen.add(id(node.children))
                waiting += [*node.keys.values(), *node.children.values()]
        elif text[node.first : node.first + 1] in ("|", ">"):
            # Behind the sign of a block there is room for a comment.
            yield _line_end(text, node.first), node.last
        else:
            yield node.first, node.last


def _line_end(text: str, index: int) -> int:
    ends = (text.find(end, index) for end in "\r\n")
    return min((end for end in ends if end >= 0), default=len(text))
