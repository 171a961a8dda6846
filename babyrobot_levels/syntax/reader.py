"""Text to data with positions: YAML 1.2's core schema, safely and within limits.

The only user of PyYAML. It walks the parser's events once and without recursion, so that neither
depth nor aliases can hurt, and it keeps a tree of nodes beside the data, so that every later
message can point at a line and a column.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import yaml

from babyrobot_levels.source import START, Position, SourceFile, Span
from babyrobot_levels.suggest import did_you_mean
from babyrobot_levels.syntax.document import Document, Node, YamlFault, YamlProblem
from babyrobot_levels.syntax.scalars import is_integer, resolve
from babyrobot_levels.syntax.words import plain_words

MAX_BYTES = 1 << 20
MAX_DEPTH = 64
MAX_NODES = 100_000
MAX_DIGITS = 40

_Parser: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
_CORE = "tag:yaml.org,2002:"


def read(source: SourceFile) -> Document:
    """Read one YAML document.

    Raises:
        YamlFault: the text is not YAML, or breaks a limit.
    """
    return _Builder(source).build()


@dataclass(slots=True)
class _Open:
    """A container whose end has not come yet."""

    node: Node
    is_mapping: bool
    key: Node | None = None


class _Builder:
    def __init__(self, source: SourceFile):
        self.source = source
        self.problems: list[YamlProblem] = []
        self.anchors: dict[str, Node | None] = {}
        self.stack: list[tuple[_Open, str | None]] = []
        self.root: Node | None = None
        self.nodes = 0

    def build(self) -> Document:
        try:
            parser = _Parser(self.source.text)
        except yaml.YAMLError as error:
            raise YamlFault(self._syntax_problem(error)) from None
        except UnicodeEncodeError as error:
            raise YamlFault(self._character_problem(error.start)) from None
        try:
            documents = 0
            while True:
                event = parser.get_event()
                if isinstance(event, yaml.StreamEndEvent):
                    break
                if isinstance(event, yaml.DocumentStartEvent):
                    documents += 1
                    if documents > 1:
                        raise YamlFault(
                            YamlProblem(
                                "BR106",
                                self._span(event),
                                "a level file holds one document, and here a second one begins",
                                "remove the `---`, or put the second level into a file of its own",
                            )
                        )
                else:
                    self._take(event)
        except yaml.YAMLError as error:
            raise YamlFault(self._syntax_problem(error)) from None
        finally:
            parser.dispose()
        root = self.root or Node(None, Span(START, START))
        return Document(self.source, root, tuple(self.problems))

    def _take(self, event: Any) -> None:
        if isinstance(event, yaml.ScalarEvent):
            span = self._span(event)
            value = self._scalar(event, span)
            self._add(Node(value, span, block=event.style == "|"), event.anchor)
        elif isinstance(event, yaml.AliasEvent):
            self._add_alias(event)
        elif isinstance(event, yaml.CollectionStartEvent):
            is_mapping = isinstance(event, yaml.MappingStartEvent)
            self._check_tag(event, "map" if is_mapping else "seq")
            if len(self.stack) >= MAX_DEPTH:
                raise YamlFault(
                    YamlProblem(
                        "BR109",
                        self._span(event),
                        f"lists and mappings are nested more than {MAX_DEPTH} deep",
                    )
                )
            node = Node({} if is_mapping else [], self._span(event))
            if event.anchor:
                self.anchors[event.anchor] = None
            self.stack.append((_Open(node, is_mapping), event.anchor))
        elif isinstance(event, yaml.CollectionEndEvent):
            opened, anchor = self.stack.pop()
            start, end_of_event = self._span(event)
            # Only flow style has a closing bracket; a block ends where its last value does.
            end = end_of_event if end_of_event > start else None
            last = next(reversed(opened.node.children.values()), None)
            stop = end or (last.span.end if last else opened.node.span.end)
            opened.node.span = Span(opened.node.span.start, stop)
            self._add(opened.node, anchor)

    def _add(self, node: Node, anchor: str | None) -> None:
        """Put a finished node into the container that is open, or at the top."""
        self.nodes += 1
        if self.nodes > MAX_NODES:
            raise YamlFault(
                YamlProblem("BR108", node.span, f"the file holds more than {MAX_NODES:,} values")
            )
        if anchor:
            self.anchors[anchor] = node
        if not self.stack:
            self.root = node
            return
        parent = self.stack[-1][0]
        parent.node.size += node.size
        if parent.node.size > MAX_NODES:
            raise YamlFault(
                YamlProblem("BR108", node.span, f"aliases expand to more than {MAX_NODES:,} values")
            )
        if not parent.is_mapping:
            parent.node.children[len(parent.node.data)] = node
            parent.node.data.append(node.data)
        elif parent.key is None:
            parent.key = node
        else:
            self._add_pair(parent.node, parent.key, node)
            parent.key = None

    def _add_pair(self, mapping: Node, key: Node, value: Node) -> None:
        name = key.data
        if isinstance(name, dict | list):
            self.problems.append(
                YamlProblem("BR203", key.span, "a field's name is a text, not a list or a mapping")
            )
            return
        if not isinstance(name, str):
            # `1: …` in a legend and `no: …` mean the characters that stand there.
            first, last = key.span
            name = self.source.line(first.line)[first.column - 1 : last.column - 1] or str(name)
        if name in mapping.keys:
            first = mapping.keys[name].span.start
            self.problems.append(
                YamlProblem(
                    "BR105",
                    key.span,
                    f"`{name}` stands here a second time; line {first.line} has it already",
                    "keep one of the two",
                )
            )
            return
        mapping.keys[name] = key
        mapping.children[name] = value
        mapping.data[name] = value.data

    def _add_alias(self, event: Any) -> None:
        span = self._span(event)
        if event.anchor not in self.anchors:
            raise YamlFault(
                YamlProblem(
                    "BR108",
                    span,
                    f"the alias `*{event.anchor}` refers to an anchor that is not above it"
                    + did_you_mean(event.anchor, self.anchors),
                )
            )
        target = self.anchors[event.anchor]
        if target is None:
            raise YamlFault(
                YamlProblem("BR108", span, f"the alias `*{event.anchor}` would contain itself")
            )
        node = Node(target.data, span, False, target.keys, target.children, target.size)
        self._add(node, None)

    def _scalar(self, event: Any, span: Span) -> Any:
        self._check_tag(event, None)
        if event.tag is None or event.tag == "!":
            quoted = event.style or event.tag == "!"
            return event.value if quoted else self._resolve(event.value, span)
        kind = event.tag.removeprefix(_CORE)
        value = event.value if kind == "str" else self._resolve(event.value, span)
        types = {"str": str, "int": int, "float": (int, float), "bool": bool, "null": type(None)}
        if not isinstance(value, types[kind]):  # type: ignore[arg-type]
            self.problems.append(
                YamlProblem("BR107", span, f"`{event.value}` cannot be read as a `!!{kind}`")
            )
        return value

    def _resolve(self, text: str, span: Span) -> Any:
        if len(text) > MAX_DIGITS and is_integer(text):
            message = f"a number of {len(text)} characters is too long"
            self.problems.append(YamlProblem("BR111", span, message))
            return 0
        return resolve(text)

    def _check_tag(self, event: Any, kind: str | None) -> None:
        tag = event.tag
        if tag is None or tag == "!":
            return
        allowed = [kind] if kind else ["str", "int", "float", "bool", "null"]
        if tag not in [_CORE + name for name in allowed]:
            shown = tag.replace(_CORE, "!!")
            raise YamlFault(
                YamlProblem(
                    "BR107",
                    self._span(event),
                    f"the tag `{shown}` is not allowed: a level is plain data",
                    "remove the tag",
                )
            )

    def _span(self, event: Any) -> Span:
        # By index, because the parser ends lines also where editors do not.
        position = self.source.position
        return Span(position(event.start_mark.index), position(event.end_mark.index))

    def _syntax_problem(self, error: yaml.YAMLError) -> YamlProblem:
        if isinstance(error, yaml.reader.ReaderError):
            # libyaml counts bytes here.
            before = self.source.text.encode("utf-8")[: error.position]
            return self._character_problem(len(before.decode("utf-8", "ignore")))
        mark, begin = getattr(error, "problem_mark", None), getattr(error, "context_mark", None)
        position = self.source.position(mark.index) if mark else START
        words = plain_words(
            getattr(error, "problem", None) or "the parser gives up",
            getattr(error, "context", None) or "",
            self.source.line(position.line),
            position.column,
        )
        if words.at_beginning and begin is not None:
            position = self.source.position(begin.index)
        end = Position(position.line, position.column + 1)
        return YamlProblem("BR104", Span(position, end), words.message, words.help)

    def _character_problem(self, index: int) -> YamlProblem:
        position = self.source.position(index)
        span = Span(position, Position(position.line, position.column + 1))
        code = ord(self.source.text[index])
        return YamlProblem("BR104", span, f"the character U+{code:04X} cannot stand in a YAML file")
