"""Changed values written into an existing text, so that comments and layout stay as they are.

Mappings and lists whose entries stand on lines of their own are changed entry by entry, at any
depth; every other value that changes is written anew in its place. Comments always stay; those
behind an entry that goes, or that needs other lines, stand on lines of their own then.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from difflib import SequenceMatcher
from itertools import takewhile
from typing import Any

from babyrobot_levels.text.document import Document, Node, comments
from babyrobot_levels.text.emitter import emit_entry, emit_field, flow
from babyrobot_levels.text.errors import LevelError
from babyrobot_levels.text.reader import read
from babyrobot_levels.text.source import SourceFile


def splice(text: str, data: dict[str, Any], order: Sequence[str]) -> str | None:
    """Return `text` with its fields changed to `data`, or None where that is not safe.

    What is equal is not touched. New fields are put where `order` wants them.
    """
    document = _read(SourceFile("", text))
    after = None if document is None else spliced(document, data, order)
    if after is None:
        return None
    return text if after is document else after.source.text


def spliced(document: Document, data: dict[str, Any], order: Sequence[str]) -> Document | None:
    """Return a document with its fields changed to `data`; see `splice`.

    A document that has these fields already is returned itself.
    """
    if document.data == data:
        return document
    if document.source.line(document.root.span.start.line)[:1] == "{":
        return None
    for is_deep in (True, False):
        splicer = _Splicer(document, is_deep)
        splicer.change_mapping(document.root, data, order, 0)
        after = _read(SourceFile(document.source.name, splicer.result()))
        if after is not None and after.data == data:
            return after
    return None


def common_ends(old: str, new: str) -> tuple[int, int]:
    """Return with how many characters both texts begin, and with how many further ones they end."""
    first = _common(old, new)
    return first, _common(old[first:][::-1], new[first:][::-1])


def _common(left: str, right: str) -> int:
    """Return with how many characters both texts begin."""
    least, most = 0, min(len(left), len(right))
    while least < most:
        middle = (least + most + 1) // 2
        if left[least:middle] == right[least:middle]:
            least = middle
        else:
            most = middle - 1
    return least


def _read(source: SourceFile) -> Document | None:
    try:
        document = read(source)
    except LevelError:
        return None
    return document if isinstance(document.data, dict) and not document.issues else None


Lines = tuple[int, int]
"""The first line of an entry, from 0, and the line behind its last one."""


@dataclass(slots=True)
class _Splicer:
    """Collects changes of whole lines.

    Args:
        document: the text.
        is_deep: whether entries are changed one by one, instead of whole top-level fields. That
            is not safe where an entry is an alias of another.
    """

    document: Document
    is_deep: bool
    _changes: list[tuple[int, int, list[str]]] = field(default_factory=list)

    def result(self) -> str:
        """Return the text with all changes."""
        source = self.document.source
        lines = list(source.lines)
        # From the bottom up, so that no change moves the lines of another.
        self._changes.sort(key=lambda change: change[:2])
        for first, last, new in reversed(self._changes):
            lines[first:last] = new
        return ("\r\n" if "\r\n" in source.text else "\n").join(lines)

    def change_mapping(
        self, node: Node, data: dict[str, Any], order: Sequence[str], indent: int
    ) -> None:
        """Change the entries of a mapping that stand on lines of their own."""
        for name in node.keys:
            place = self._lines_of(node.keys[name], node.children[name])
            if name not in data:
                self._changes.append((*place, self._kept(place, indent)))
            elif node.children[name].data != data[name]:
                self._change_value(name, node.children[name], data[name], place, indent)
        for name in [name for name in order if name in data and name not in node.keys]:
            row = self._place_for(node, name, order)
            self._changes.append((row, row, self._new(name, data[name], indent)))

    def _change_list(self, node: Node, values: list[Any], indent: int) -> None:
        """Change the entries of a list that stand on lines of their own."""
        for i, j, k, m in _differences(node.data, values):
            pairs = _pairs(node.data, values, (i, j, k, m))
            for old in range(i, j):
                place = self._lines_of(node.children[old], node.children[old])
                if old in pairs:
                    value = values[pairs[old]]
                    self._change_value(None, node.children[old], value, place, indent)
                else:
                    self._changes.append((*place, self._kept(place, indent)))
            above = node.children[max(j - 1, 0)]
            row = self._lines_of(above, above)[1 if j else 0]
            added = values[k + len(pairs) : m]
            if lines := [line for value in added for line in emit_entry(value, indent)]:
                self._changes.append((row, row, lines))

    def _change_value(
        self, name: str | None, node: Node, value: Any, place: Lines, indent: int
    ) -> None:
        """Change the value of an entry: a field with its name, or an entry of a list."""
        if not _is_list_of_mappings(value) and self._is_canonical(name, node, place, indent):
            # What is now short enough for one line is put on one.
            self._changes.append((*place, self._new(name, value, indent)))
            return
        inner = self._indent_of_block(node, place, name is None) if self.is_deep else None
        if inner is not None and type(value) is type(node.data):
            # What hangs on a dash keeps its first field, which shares the line.
            if isinstance(value, dict) and (name is not None or next(iter(node.keys)) in value):
                self.change_mapping(node, value, list(value), inner)
                return
            if isinstance(value, list) and value:
                self._change_list(node, value, inner)
                return
        self._changes.append((*place, self._written(name, node, value, place, indent)))

    def _written(
        self, name: str | None, node: Node, value: Any, place: Lines, indent: int
    ) -> list[str]:
        """Return the lines of an entry that is written anew, with the comments that it had."""
        new = self._new(name, value, indent)
        span, (first, last) = node.span, place
        fits = len(new) == 1 and last - first == 1
        if fits and span.start.line == span.end.line == first + 1:
            old = self.document.source.lines[first]
            lead = " " * indent + ("- " if name is None else f"{name}: ")
            shown = new[0][len(lead) :] if new[0].startswith(lead) else flow(value)
            return [old[: span.start.column - 1] + shown + old[span.end.column - 1 :]]
        return [*self._kept(place, indent), *new]

    def _is_canonical(self, name: str | None, node: Node, place: Lines, indent: int) -> bool:
        """Tell whether an entry is laid out in the canonical way, without any comment."""
        lines = self.document.source.lines[slice(*place)]
        return [*lines] == self._new(name, node.data, indent)

    @staticmethod
    def _new(name: str | None, value: Any, indent: int) -> list[str]:
        """Return the lines of an entry of a list or, with a name, of a field."""
        if name is None:
            return emit_entry(value, indent)
        return [
            (" " * indent + line) if line else "" for line in emit_field(name, value).splitlines()
        ]

    def _kept(self, place: Lines, indent: int) -> list[str]:
        """Return the comments on an entry's lines, as indented lines of their own."""
        return [
            " " * indent + comment.text
            for comment in comments(self.document)
            if place[0] < comment.span.start.line <= place[1]
        ]

    def _lines_of(self, start: Node, value: Node) -> Lines:
        """Return the lines from a node to the end of a value."""
        first, end = start.span.start.line - 1, value.span.end
        last = end.line if end.column > 1 else end.line - 1
        lines = self.document.source.lines
        while last > first + 1 and not lines[last - 1].strip():
            last -= 1
        return first, max(last, first + 1)

    def _indent_of_block(self, node: Node, place: Lines, hangs: bool) -> int | None:
        """Return the indentation of a container's entries; None if they share lines.

        Args:
            node: the container.
            place: the lines of the entry that it is the value of.
            hangs: whether that is an entry of a list, behind whose dash it may begin.
        """
        source = self.document.source
        if not node.children or source.text[node.first : node.first + 1] in ("[", "{"):
            return None
        starts = list(node.keys.values()) if isinstance(node.data, dict) else []
        starts = starts or [node.children[index] for index in range(len(node.data))]
        begins = [source.position(start.first) for start in starts]
        rows = [begin.line for begin in begins]
        if len(set(rows)) < len(rows) or rows[0] - 1 < place[0] or rows[-1] > place[1]:
            return None
        if isinstance(node.data, dict):
            return begins[0].column - 1 if hangs or rows[0] - 1 > place[0] else None
        leads = [source.line(begin.line)[: begin.column - 1] for begin in begins]
        # A dash on another line than its entry, or a dash behind another one.
        if any(lead.strip() != "-" for lead in leads) or rows[0] - 1 == place[0]:
            return None
        return leads[0].index("-")

    def _place_for(self, node: Node, name: str, order: Sequence[str]) -> int:
        """Return the line before which a new field belongs."""
        before = [other for other in order[: order.index(name)] if other in node.keys]
        if lines := [self._lines_of(node.keys[other], node.children[other]) for other in before]:
            return max(last for _, last in lines)
        return min(key.span.start.line - 1 for key in node.keys.values())


def _is_list_of_mappings(value: Any) -> bool:
    return isinstance(value, list) and any(isinstance(each, dict) for each in value)


def _differences(before: list[Any], after: list[Any]) -> Iterator[tuple[int, int, int, int]]:
    """Yield where entries become others: `before[i:j]` becomes `after[k:m]`."""
    # Most changes are in one place of a list that may be long.
    same = sum(1 for _ in takewhile(_is_pair, zip(before, after, strict=False)))
    rest = zip(reversed(before[same:]), reversed(after[same:]), strict=False)
    last = sum(1 for _ in takewhile(_is_pair, rest))
    old, new = ([*map(flow, all_[same : len(all_) - last])] for all_ in (before, after))
    for kind, *numbers in SequenceMatcher(None, old, new, autojunk=False).get_opcodes():
        if kind != "equal":
            i, j, k, m = (same + number for number in numbers)
            yield i, j, k, m


MAX_COMPARED = 20
"""Of more entries than this that one may have come from, the first ones are looked at."""


def _pairs(
    before: list[Any], after: list[Any], difference: tuple[int, int, int, int]
) -> dict[int, int]:
    """Return which entries become which others, in order: each that of the most equal fields."""
    i, j, k, m = difference
    pairs: dict[int, int] = {}
    spare = max(0, (j - i) - (m - k))
    first = i
    for new in range(k, min(m, k + j - i)):
        others = range(first, min(first + spare, first + MAX_COMPARED) + 1)
        old = max(others, key=lambda other: _likeness(before[other], after[new]))
        pairs[old] = new
        spare -= old - first
        first = old + 1
    return pairs


def _likeness(one: Any, other: Any) -> int:
    if isinstance(one, dict) and isinstance(other, dict):
        return sum(1 for name in one if name in other and one[name] == other[name])
    return 0


def _is_pair(values: tuple[Any, Any]) -> bool:
    return bool(values[0] == values[1])
