"""Texts to their canonical form: the same data and the same comments, in one form.

Single values lose needless quotes; a document becomes a tree, whose fields stand in their order and
take their comments with them.
"""

from __future__ import annotations

import json
import re
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path
from typing import Any, get_args, get_origin

from pydantic import BaseModel

from babyrobot_levels.language.documents import check_document, is_suite
from babyrobot_levels.language.expectations import Facts
from babyrobot_levels.language.level import LevelSpec
from babyrobot_levels.language.looks import Theme
from babyrobot_levels.language.suite_list import AnySuite, suite_model
from babyrobot_levels.language.validation import check
from babyrobot_levels.text.document import Comment, Document, Node, comments
from babyrobot_levels.text.emitter import Container, Entry, Scalar, Value, lines_of, scalar
from babyrobot_levels.text.errors import LevelError
from babyrobot_levels.text.reader import read
from babyrobot_levels.text.source import SourceFile

BRACKETS = ",[]{}"
"""What a text without quotes cannot hold inside brackets."""

_NUMBER = re.compile(r"([-+]?)0*([0-9]*)(?:\.([0-9]*))?(?:[eE]([-+]?[0-9]+))?")
_LINE_END = re.compile(r"\r\n|\r|\n")
# Other readers take these for booleans, dates, times or numbers of their own.
_BETTER_QUOTED = re.compile(r"[0-9].*|yes|no|on|off", re.IGNORECASE | re.DOTALL)


class KeptAsIs(Exception):
    """A text is written in a way that the formatter leaves alone; the message says which."""


def canonical(node: Node, *, keeps_zeros: bool = False) -> Scalar:
    """Return a value as it is to be written.

    Args:
        node: the value.
        keeps_zeros: whether zeros at the end of a number say how exact it is.

    Raises:
        KeptAsIs: it is written in a way that is left alone.
    """
    raw, data = node.source.text[node.first : node.last], node.data
    sign = raw[:1]
    if sign and sign in "&!*":
        # An anchor, a tag or an alias: the author's own text.
        if _LINE_END.search(raw):
            raise KeptAsIs("a value with an anchor or a tag goes over several lines")
        return Scalar(raw, None if any(mark in raw for mark in BRACKETS) else raw)
    if sign and sign in "|>":
        return _block(raw, str(data))
    lines = _LINE_END.split(raw)
    if len(lines) > 1:
        return _folded(lines)
    if not isinstance(data, str):
        is_number = isinstance(data, int | float) and not isinstance(data, bool)
        text = _number(raw, data, keeps_zeros) if is_number else scalar(data)
        return Scalar(text, text, is_number=is_number)
    return Scalar(_text(raw, data), _text(raw, data, in_flow=True))


def canonical_key(node: Node) -> str:
    """Return a field's name as it is to be written.

    Raises:
        KeptAsIs: it is not written as a name usually is.
    """
    raw = node.source.text[node.first : node.last]
    if not raw or raw[0] in "&!*|>" or _LINE_END.search(raw):
        raise KeptAsIs("a field's name is written in an unusual way")
    if node.data == "on":
        # Levels write this field without quotes: YAML 1.2 reads it as a text.
        return "on"
    return _text(raw, str(node.data), in_flow=True) if raw[0] in "'\"" else raw


def _text(raw: str, data: str, *, in_flow: bool = False) -> str:
    if raw[0] not in "'\"":
        has_brackets = in_flow and any(mark in raw for mark in BRACKETS)
        return scalar(data, in_flow=True) if has_brackets else raw
    if raw[0] == "'" or raw[1:-1] == data:
        plain = scalar(data, in_flow=in_flow)
        if plain[0] != '"' and not _BETTER_QUOTED.fullmatch(data):
            return plain
    if raw[0] == "'" and '"' not in data and "\\" not in data:
        return f'"{data}"'
    return raw


def _number(raw: str, data: float, keeps_zeros: bool) -> str:
    match = _NUMBER.fullmatch(raw)
    if match is None:
        return raw
    if isinstance(data, int):
        return str(data)
    sign, whole, fraction, exponent = match.groups()
    fraction = (fraction or "") if keeps_zeros else (fraction or "").rstrip("0")
    text = ("-" if sign == "-" else "") + (whole or "0")
    if fraction or exponent is None:
        text += f".{fraction or '0'}"
    return text if exponent is None else f"{text}e{int(exponent)}"


def _folded(lines: list[str]) -> Scalar:
    """Return a text that goes over several lines, with quotes or without."""
    # A backslash at the end of a line would escape what follows it.
    first, *rest = (line if line.rstrip().endswith("\\") else line.rstrip() for line in lines[:-1])
    rest = [line.lstrip() for line in (*rest, lines[-1])]
    return Scalar(first, None, tuple(rest))


def _block(raw: str, data: str) -> Scalar:
    """Return a literal (`|`) or folded (`>`) block."""
    if not data.strip("\n"):
        return Scalar(scalar(data), scalar(data))
    body = data.removesuffix("\n")
    chomp = "-" if body == data else "+" if body.endswith("\n") else ""
    if raw[0] == "|":
        lines = body.split("\n")
        begin = next(line for line in lines if line)
        # Where the first line is indented itself, YAML needs the indentation stated.
        step = "2" if begin[0] in " \t" else ""
        return Scalar(f"|{step}{chomp}", None, tuple(lines))
    header, *lines = _LINE_END.split(raw)
    if re.match(r">[-+]?[0-9]", header):
        raise KeptAsIs("a folded text states its indentation")
    if chomp == "+":
        # The last line end is that of the last line.
        lines = lines[:-1] if not lines[-1] else lines
    else:
        while not lines[-1].strip(" "):
            lines.pop()
    begin = next(line for line in lines if line.strip(" "))
    depth = len(begin) - len(begin.lstrip(" "))
    return Scalar(f">{chomp}", None, tuple(line[depth:] for line in lines))


@dataclass(frozen=True, slots=True)
class Fields:
    """What is known of a mapping, or of each mapping in a list.

    Attributes:
        inner: the fields in their order, each with what is known of its value.
        others: what is known of the values of all other keys.
        keeps_zeros: whether zeros at the end of a number say how exact it is.
    """

    inner: dict[str, Fields] = field(default_factory=dict)
    others: Fields | None = None
    keeps_zeros: bool = False

    def of(self, key: str) -> Fields:
        """Return what is known of a key's value."""
        return self.inner.get(key) or self.others or NOTHING

    def order(self, keys: Iterable[str]) -> list[str]:
        """Return keys in the order of the fields, those that are not known behind the others."""
        given = list(keys)
        known = [key for key in self.inner if key in given]
        return [*known, *(key for key in given if key not in self.inner)]


NOTHING = Fields()


@cache
def fields_of(model: type[BaseModel]) -> Fields:
    """Return the fields of a model, with those of the models in them."""
    inner = {
        info.alias or name: _fields_in(info.annotation) for name, info in model.model_fields.items()
    }
    if issubclass(model, Facts):
        inner = {name: replace(fields, keeps_zeros=True) for name, fields in inner.items()}
    return Fields(inner)


def _fields_in(annotation: Any) -> Fields:
    """Return the fields of the model that an annotation holds: in a list, a union, a dict."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return fields_of(annotation)
    found = (_fields_in(argument) for argument in get_args(annotation))
    first = next((fields for fields in found if fields is not NOTHING), NOTHING)
    return Fields(others=first) if get_origin(annotation) is dict else first


_PROPERTIES = re.compile(r"(?:[&!][^\s,\[\]{}]*\s*)*")
# Possessive, so that no bracket and no dash inside a comment is found.
_BLANK = r"(?:\s|#[^\r\n]*+)*+"
_OPENS_FLOW = re.compile(_BLANK + r"[\[{]")
_DASH = re.compile(_BLANK + "-")
_PUNCTUATION = re.compile(r"(?:[\s,\[\]{}:?\-]|(?<![^\r\n])\.\.\.)*")
_OF_THE_FILE = re.compile(r"# *(?:yaml-language-server|babyrobot):")


def tree_of(document: Document, fields: Fields) -> Container:
    """Return a document's root, which must be a mapping that is not empty.

    `fields` says in which order its fields are to be written.

    Raises:
        KeptAsIs: the text is written in a way that is left alone.
    """
    return _Builder(document).build(fields)


def tidy(comment: str) -> str:
    """Return a comment with a blank behind its `#`, and none at its end."""
    text = comment.rstrip()
    return f"# {text[1:]}" if len(text) > 1 and text[1] not in " \t#!:'" else text


class _Builder:
    """Goes through a document once, and takes the comments on the way."""

    def __init__(self, document: Document):
        self.root = document.root
        self.source = document.source
        self.text = document.source.text
        self.comments = comments(document)
        self.taken = 0
        self.line = 0
        """The line on which what was read last ends."""
        self.places = [self._place(comment) for comment in self.comments]
        self.seen = [*self.places]
        """Where comments, scalars, anchors and tags stand: all that is not punctuation."""
        self.sorts = not _has_aliases(self.root, self.text)
        """Whether fields change places: an anchor has to stay above its aliases."""

    def build(self, fields: Fields) -> Container:
        if any(mark in self.text for mark in "\x85\u2028\u2029"):
            raise KeptAsIs("YAML ends lines in it where editors do not")
        holder = Entry(Container(True, []))
        root = self._container(self.root, fields, holder, -1, len(self.text))
        while self._next(len(self.text)):
            self._put(root.below)
        self._check_rest()
        if not root.entries or root.properties:
            raise KeptAsIs("the file as a whole is written in an unusual way")
        first = root.entries[0]
        first.above[:0] = [*holder.above, *filter(None, [holder.behind])]
        head = _head(first.above)
        first.above = first.above[len(head) :]
        self._sort(root, self.root, fields)
        root.entries[0].above[:0] = head
        return root

    def _container(
        self, node: Node, fields: Fields, holder: Entry, column: int, limit: int
    ) -> Container:
        """Return a container. `holder` is its entry, whose name or dash stands at `column`.

        Comments that are not its own begin at `limit`.
        """
        match = _PROPERTIES.match(self.text, node.first)
        start = match.end() if match else node.first
        self.seen.append((node.first, start))
        opening = _OPENS_FLOW.match(self.text, start)
        if opening:
            limit = node.last
            self._take_before(opening.end() - 1, holder)
            self.line = self._line(opening.end())
        begins = self._begins(node, start, is_flow=opening is not None)
        if self._is_behind(min(begins[0], limit)) and not holder.behind:
            holder.behind = self._take()
        result = Container(isinstance(node.data, dict), [])
        result.properties = self.text[node.first : start].rstrip()
        for number, (key, child) in enumerate(node.children.items()):
            begin = begins[number]
            entry = Entry(result, above=self._above(begin))
            end = begin
            if result.is_mapping:
                entry.key = canonical_key(node.keys[key])
                end = node.keys[key].last
                self.seen.append((begin, end))
            self.line = self._line(end)
            inner = fields.of(key) if result.is_mapping else fields
            stop = min(begins[number + 1], limit)
            entry.value = self._value(
                child, inner, entry, self.source.position(begin).column - 1, stop
            )
            if self._is_behind(stop) and not entry.behind:
                entry.behind = self._take()
            result.entries.append(entry)
        while (comment := self._next(limit)) and (
            opening or (comment.is_alone and comment.span.start.column - 1 > column)
        ):
            self._put(result.below if result.entries else holder.above)
        if opening:
            self.line = self._line(node.last)
        return result

    def _begins(self, node: Node, start: int, *, is_flow: bool) -> list[int]:
        """Return where each entry begins, with its name or its dash, and the end of the text."""
        if isinstance(node.data, dict):
            begins = [key.first for key in node.keys.values()]
        elif is_flow:
            begins = [child.first for child in node.children.values()]
        else:
            begins = []
            for child in node.children.values():
                dash = _DASH.match(self.text, start)
                begins.append(dash.end() - 1 if dash else child.first)
                start = child.last
        return [*begins, len(self.text)]

    def _value(self, node: Node, fields: Fields, entry: Entry, column: int, limit: int) -> Value:
        is_alias = self.text[node.first : node.first + 1] == "*"
        if isinstance(node.data, dict | list) and not is_alias:
            container = self._container(node, fields, entry, column, limit)
            self._sort(container, node, fields)
            if entry.key is None and container.entries:
                # Its first entry stands on the line of the dash.
                first = container.entries[0]
                entry.above += first.above
                first.above = []
            return container
        self._take_before(node.first, entry)
        if self.text[node.first : node.first + 1] in ("|", ">") and self._next(node.last):
            entry.behind = entry.behind or self._take()
        self.seen.append((node.first, node.last))
        self.line = self._line(node.first + len(self.text[node.first : node.last].rstrip()))
        return canonical(node, keeps_zeros=fields.keeps_zeros)

    def _sort(self, container: Container, node: Node, fields: Fields) -> None:
        if container.is_mapping and self.sorts:
            entries = dict(zip(node.children, container.entries, strict=True))
            container.entries = [entries[key] for key in fields.order(entries)]

    # -- comments --------------------------------------------------------------------------

    def _next(self, limit: int) -> Comment | None:
        """Return the next comment if it begins before `limit`."""
        if self.taken == len(self.comments) or self.places[self.taken][0] >= limit:
            return None
        return self.comments[self.taken]

    def _take(self) -> str:
        comment = self.comments[self.taken]
        self.taken += 1
        self.line = comment.span.start.line
        return tidy(comment.text)

    def _put(self, lines: list[str]) -> None:
        """Take the next comment for a line of its own, and the blank line above it."""
        if self._has_gap(self.comments[self.taken].span.start.line):
            lines.append("")
        lines.append(self._take())

    def _above(self, index: int) -> list[str]:
        """Take what stands above the entry that begins at `index`."""
        lines: list[str] = []
        while self._next(index):
            self._put(lines)
        if self._has_gap(self._line(index)):
            lines.append("")
        return lines

    def _take_before(self, index: int, entry: Entry) -> None:
        """Take the comments between an entry's beginning and its value."""
        while comment := self._next(index):
            if comment.is_alone or entry.behind:
                self._put(entry.above)
            else:
                entry.behind = self._take()

    def _is_behind(self, limit: int) -> bool:
        """Tell whether the next comment stands behind what was read last."""
        comment = self._next(limit)
        return comment is not None and not comment.is_alone and comment.span.start.line == self.line

    # -- places ----------------------------------------------------------------------------

    def _has_gap(self, line: int) -> bool:
        """Tell whether a blank line stands between what was read last and a line."""
        return any(not self.source.line(n).strip() for n in range(self.line + 1, line))

    def _line(self, index: int) -> int:
        return self.source.position(index).line

    def _place(self, comment: Comment) -> tuple[int, int]:
        first = self.source.index(comment.span.start)
        return first, first + len(comment.text)

    def _check_rest(self) -> None:
        """Make sure that nothing was overlooked that is more than punctuation."""
        end = 0
        for first, last in [*sorted(self.seen), (len(self.text), 0)]:
            if first > end and not _PUNCTUATION.fullmatch(self.text, end, first):
                raise KeptAsIs(f"line {self._line(end)} is written in an unusual way")
            end = max(end, last)


def _has_aliases(root: Node, text: str) -> bool:
    waiting = [root] if "*" in text else []
    while waiting:
        node = waiting.pop()
        if text[node.first : node.first + 1] == "*":
            return True
        waiting += node.children.values()
    return False


def _head(above: list[str]) -> list[str]:
    """Return what stands above the first field, but speaks of the file as a whole."""
    ends = [number for number, line in enumerate(above, 1) if not line or _OF_THE_FILE.match(line)]
    return above[: max(ends, default=0)]


@dataclass(frozen=True, slots=True)
class Formatted:
    """What became of a text.

    Attributes:
        text: its canonical form.
        kept: why the text is left as it is, None where it is not.
    """

    text: str
    kept: str | None = None


def format_source(source: SourceFile, path: Path | None = None) -> Formatted:
    """Return the canonical form of a level, of a suite, or of a theme.

    Args:
        source: the text.
        path: the file that it is from: one in a folder `themes` is a theme, and a theme that a
            level names has to be there.

    Raises:
        LevelError: the text is not valid.
    """
    document = read(source)
    is_theme = path is not None and path.absolute().parent.name == "themes"
    model: type[LevelSpec | AnySuite | Theme] = LevelSpec
    if is_theme or is_suite(document):
        model = Theme if is_theme else suite_model(document.data)
    if is_theme or path is None:
        # Whether a theme that the level names is there, only a file's folder tells.
        check(document, model).valid()
    else:
        check_document(document, LevelSpec, path).valid()
    try:
        lines = lines_of(tree_of(document, fields_of(model)))
    except KeptAsIs as reason:
        return Formatted(source.text, str(reason))
    text = "".join(f"{line}\n" for line in lines)
    is_dos = source.text.find("\r\n") == source.text.find("\n") - 1 >= 0
    text = text.replace("\n", "\r\n") if is_dos else text
    if text != source.text and not _says_the_same(text, document):
        return Formatted(source.text, "any other form would change its meaning")
    return Formatted(text)


def _says_the_same(text: str, before: Document) -> bool:
    """Tell whether a text has the data and the comments of a document."""
    try:
        after = read(SourceFile("", text))
    except LevelError:
        return False
    return not after.issues and _content(after) == _content(before)


def _content(document: Document) -> tuple[str, Counter[str]]:
    # As JSON, where 1, 1.0 and true are three things, and the order of fields is none.
    data = json.dumps(document.data, sort_keys=True)
    return data, Counter(tidy(comment.text) for comment in comments(document))
