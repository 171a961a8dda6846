"""Text to data with positions: YAML 1.2's core schema, safely and within limits.

The only user of PyYAML. It walks the parser's events once and without recursion, so that neither
depth nor aliases can hurt, and it keeps a tree of nodes beside the data, so that every later
message can point at a line and a column.
"""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from babyrobot_levels.text.diagnostics import Issue
from babyrobot_levels.text.document import Document, Node, diagnostic_of
from babyrobot_levels.text.errors import LevelError
from babyrobot_levels.text.files import read_source
from babyrobot_levels.text.scalars import is_integer, resolve
from babyrobot_levels.text.source import START, Position, SourceFile, Span, other_form
from babyrobot_levels.text.words import did_you_mean, plain_words, shortened

MAX_DEPTH = 64
MAX_NODES = 100_000
MAX_DIGITS = 40
MAX_TAG_DIRECTIVES = 100

_TOO_DEEP = f"lists and mappings are nested more than {MAX_DEPTH} levels deep"

_Parser: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
_CORE = "tag:yaml.org,2002:"


def open_document(path: Path, name: str | None = None) -> Document:
    """Read a file as one YAML document. `name` is what messages call it, the path if left out.

    Raises:
        LevelError: the file cannot be read, is not YAML, or exceeds a limit.
    """
    return read(read_source(path, name))


def read(source: SourceFile) -> Document:
    """Read one YAML document.

    Raises:
        LevelError: the text is not YAML, or exceeds a limit.
    """
    return _Builder(source).build()


_NOTHING: dict[Any, Node] = {}
"""What a scalar holds. Shared by all of them, and never written to."""


@dataclass(slots=True)
class _Open:
    """A container whose end has not come yet."""

    node: Node
    anchor: str | None
    is_mapping: bool
    key: Node | None = None


class _Builder:
    def __init__(self, source: SourceFile):
        self.source = source
        self.issues: list[Issue] = []
        self.anchors: dict[str, Node | None] = {}
        self.stack: list[_Open] = []
        self.root: Node | None = None
        self.documents = 0
        self.nodes = 0
        self.has_aliases = False

    def build(self) -> Document:
        if self.source.text.startswith("\ufeff"):
            # The first byte order mark was none of the text; the parser would not count a second.
            raise self._character_error(0)
        self._check_directives()
        try:
            parser = _Parser(self.source.text)
        except yaml.YAMLError as error:
            raise self._syntax_error(error) from None
        except UnicodeEncodeError as error:
            raise self._character_error(error.start) from None
        try:
            self._take_all(parser.get_event)
        except yaml.YAMLError as error:
            raise self._syntax_error(error) from None
        finally:
            parser.dispose()
        root = self.root or Node(None, self.source, 0, 0, _NOTHING, _NOTHING)
        return Document(self.source, root, tuple(self.issues))

    def _take_all(self, next_event: Callable[[], Any]) -> None:
        # Most of the time that checking a file takes is spent here.
        takers: dict[type, Callable[[Any], None]] = {
            yaml.ScalarEvent: self._take_scalar,
            yaml.MappingStartEvent: self._open,
            yaml.SequenceStartEvent: self._open,
            yaml.MappingEndEvent: self._close,
            yaml.SequenceEndEvent: self._close,
            yaml.AliasEvent: self._take_alias,
            yaml.DocumentStartEvent: self._begin_document,
        }
        kind: type | None = None
        while kind is not yaml.StreamEndEvent:
            event = next_event()
            kind = type(event)
            if kind in takers:
                takers[kind](event)

    def _begin_document(self, event: Any) -> None:
        self.documents += 1
        if self.documents > 1:
            message = "a second document begins here; a file contains one"
            help_text = "remove the `---`, or move the second document to its own file"
            raise self._error("BR106", self._span(event), message, help_text)

    def _open(self, event: Any) -> None:
        is_mapping = type(event) is yaml.MappingStartEvent
        if event.tag is not None:
            self._check_tag(event, ["map" if is_mapping else "seq"])
        if len(self.stack) >= MAX_DEPTH:
            raise self._error("BR109", self._span(event), _TOO_DEEP)
        first, last = event.start_mark.index, event.end_mark.index
        node = Node({} if is_mapping else [], self.source, first, last, {}, {})
        if event.anchor:
            self.anchors[event.anchor] = None
        self.stack.append(_Open(node, event.anchor, is_mapping))

    def _close(self, event: Any) -> None:
        opened = self.stack.pop()
        node, end = opened.node, event.end_mark.index
        # Only flow style has a closing bracket; a block ends where its last value does.
        if end > event.start_mark.index:
            node.last = end
        elif node.children:
            node.last = next(reversed(node.children.values())).last
        self._add(node, opened.anchor)

    def _add(self, node: Node, anchor: str | None) -> None:
        """Put a finished node into the container that is open, or at the top."""
        self.nodes += 1
        if self.nodes > MAX_NODES:
            message = f"the file has more than {MAX_NODES:,} values"
            raise self._error("BR108", node.span, message)
        if anchor:
            self.anchors[anchor] = node
        if not self.stack:
            self.root = node
            return
        parent = self.stack[-1]
        container = parent.node
        container.size += node.size
        if container.size > MAX_NODES:
            what = "aliases expand to" if self.has_aliases else "the file has"
            message = f"{what} more than {MAX_NODES:,} values"
            raise self._error("BR108", node.span, message)
        if not parent.is_mapping:
            container.children[len(container.data)] = node
            container.data.append(node.data)
        elif parent.key is None:
            parent.key = node
        else:
            self._add_pair(container, parent.key, node)
            parent.key = None

    def _add_pair(self, mapping: Node, key: Node, value: Node) -> None:
        name = key.data
        if isinstance(name, dict | list):
            message = "a field name must be text, not a list or a mapping"
            self.issues.append(Issue("BR203", key.span, message, "give a cell as `at: [x, y]`"))
            return
        if not isinstance(name, str):
            # `1: …` in a legend and `no: …` mean the characters that stand there.
            name = self.source.text[key.first : key.last] or str(name)
        if name in mapping.keys:
            first = mapping.keys[name].span.start
            message = f"duplicate field `{shortened(name)}`"
            message += f", first given on line {first.line}"
            self.issues.append(Issue("BR105", key.span, message, "remove one of them"))
            return
        mapping.keys[name] = key
        mapping.children[name] = value
        mapping.data[name] = value.data

    def _take_alias(self, event: Any) -> None:
        name = event.anchor
        if name not in self.anchors:
            message = f"undefined alias `*{shortened(name)}`"
            message += did_you_mean(name, self.anchors)
            raise self._error("BR108", self._span(event), message)
        target = self.anchors[name]
        if target is None:
            message = f"the alias `*{shortened(name)}` contains itself"
            raise self._error("BR108", self._span(event), message)
        self.has_aliases = True
        first, last = event.start_mark.index, event.end_mark.index
        node = Node(
            target.data, self.source, first, last, target.keys, target.children, size=target.size
        )
        self._add(node, None)

    def _take_scalar(self, event: Any) -> None:
        value, style = event.value, event.style
        if event.tag is not None:
            value = self._tagged(event)
        elif not style:
            value = resolve(value) if len(value) <= MAX_DIGITS else self._resolved(event)
        first, last = event.start_mark.index, event.end_mark.index
        node = Node(value, self.source, first, last, _NOTHING, _NOTHING, style == "|")
        self._add(node, event.anchor)

    def _tagged(self, event: Any) -> Any:
        types = {"str": str, "int": int, "float": (int, float), "bool": bool, "null": type(None)}
        self._check_tag(event, [*types])
        kind = event.tag.removeprefix(_CORE)
        if kind in ("!", "str"):
            return event.value
        value = self._resolved(event)
        if not isinstance(value, types[kind]):  # type: ignore[arg-type]
            message = f"`{shortened(event.value)}` is not a valid `!!{kind}`"
            self.issues.append(Issue("BR107", self._span(event), message))
        return value

    def _resolved(self, event: Any) -> Any:
        text = event.value
        if len(text) > MAX_DIGITS and is_integer(text):
            message = f"the number has too many digits ({len(text)} characters)"
            self.issues.append(Issue("BR111", self._span(event), message))
            return 0
        return resolve(text)

    def _check_directives(self) -> None:
        # The parser compares each of them with all those before it.
        text = self.source.text
        if text.count("%TAG") > MAX_TAG_DIRECTIVES:
            last = self.source.position(text.rindex("%TAG"))
            message = f"more than {MAX_TAG_DIRECTIVES} `%TAG` directives"
            span = Span(last, Position(last.line, last.column + len("%TAG")))
            raise self._error("BR107", span, message, "remove them")

    def _check_tag(self, event: Any, allowed: list[str]) -> None:
        tag = event.tag
        if tag != "!" and tag not in [_CORE + name for name in allowed]:
            shown = tag.replace(_CORE, "!!")
            message = f"the tag `{shortened(shown)}` is not allowed"
            raise self._error("BR107", self._span(event), message, "remove the tag")

    def _error(
        self, code: str, span: Span, message: str, help_text: str | None = None
    ) -> LevelError:
        return LevelError([diagnostic_of(Issue(code, span, message, help_text), span, self.source)])

    def _span(self, event: Any) -> Span:
        # By index, because the parser ends lines also where editors do not.
        position = self.source.position
        return Span(position(event.start_mark.index), position(event.end_mark.index))

    def _syntax_error(self, error: yaml.YAMLError) -> LevelError:
        if isinstance(error, yaml.reader.ReaderError):
            # libyaml counts bytes here.
            before = self.source.text.encode("utf-8")[: error.position]
            return self._character_error(len(before.decode("utf-8", "ignore")))
        mark, begin = getattr(error, "problem_mark", None), getattr(error, "context_mark", None)
        position = self.source.position(mark.index) if mark else START
        problem = getattr(error, "problem", None) or "the parser gives up"
        if "nesting depth" in problem:
            # libyaml 0.2.6 reads ahead, and gives up before the container that is too deep here.
            return self._error("BR109", self._span_at(position), _TOO_DEEP)
        words = plain_words(
            problem, getattr(error, "context", None) or "", self.source.lines, *position
        )
        if words.place is not None:
            position = Position(*words.place)
        elif words.at_beginning and begin is not None:
            position = self.source.position(begin.index)
        help_text = other_form(self.source.name) or words.help
        return self._error("BR104", self._span_at(position), words.message, help_text)

    def _character_error(self, index: int) -> LevelError:
        span = self._span_at(self.source.position(index))
        code = ord(self.source.text[index])
        return self._error("BR104", span, f"the character U+{code:04X} is not allowed in YAML")

    def _span_at(self, position: Position) -> Span:
        """Return the span of one character, or of none at the end of a line."""
        last = len(self.source.line(position.line)) + 1
        return Span(position, Position(position.line, min(position.column + 1, last)))
