"""The pages of a sheet: a heading, levels side by side and below each other, the rules, a foot."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from babyrobot_levels.render.pdf import cut, width_of, wrapped
from babyrobot_levels.render.scene.layout import height_for
from babyrobot_levels.render.scene.panels import SampledRule, rule_shapes
from babyrobot_levels.render.scene.shapes import (
    Ellipse,
    Path,
    Rect,
    Scene,
    Shape,
    Text,
    polyline,
    rounded,
    scaled,
    shifted,
)
from babyrobot_levels.render.words import phrases

INK, FAINT, LINE = "#000000", "#555555", "#8c8c8c"
"""The colours of texts, of small texts, and of lines."""

_MARGIN = 54.0
_GAP = 22.0
_TITLE, _FIELD, _NAME, _SMALL = 20.0, 12.0, 13.0, 9.0
"""The font sizes of the title of a page, of texts, of the title of a level, and of small texts."""

_CAPTION_SIZE = 9.5

_TEXT_LINE, _TEXT_SHARE = 12.0, 0.15
"""The height of a line of a level's description, and the most that it takes of the level's room."""

_RULED = 28.0
"""The distance of lines to write on."""

_LEAST_PICTURE = 30.0
"""The room that texts leave to the picture."""

_HEADING, _FOOT = 44.0, 18.0
"""The heights of the heading below the title, and of the foot."""

_SLACK = 0.94
"""The share of the width that texts take: fonts of other painters may be a little wider."""

_LARGEST = 1.35
"""The largest scale of a picture."""

_RULES_SHARE = 0.32
"""The most of a page's height that rules take below levels."""

_MOST_WITH_RULES = 9
"""The most levels above the rules on a page."""

_RULES_HEAD = 20.0
_RULES_SCALES = (1.0, 0.9, 0.8)


@dataclass(frozen=True, slots=True)
class Entry:
    """A level on a sheet.

    Attributes:
        title: its title.
        mark: its name and the first digits of its digest.
        pictures: its picture, and the grids; each with its caption, which may be empty.
        answer: what is written below; empty for nothing.
        blank: whether there is room to write behind the answer.
        rules: its rules.
        text: what it says of itself, below its title.
        lines: the number of lines to write on below it.
    """

    title: str
    mark: str
    pictures: Sequence[tuple[Scene, str]]
    answer: str = ""
    blank: bool = False
    rules: Sequence[SampledRule] = field(default=())
    text: str = ""
    lines: int = 0


@dataclass(frozen=True, slots=True)
class PageStyle:
    """How the pages of a sheet look.

    Attributes:
        title: the title.
        width: the width of the paper, in pixels of 1/96 inch.
        height: its height.
        per_page: the number of levels on a page.
        key: whether it is the teacher's copy.
    """

    title: str
    width: float
    height: float
    per_page: int
    key: bool

    @property
    def room(self) -> float:
        """The width between the margins."""
        return self.width - 2 * _MARGIN


def pages_of(entries: Sequence[Entry], style: PageStyle) -> Iterator[Scene]:
    """Yield the pages of a sheet.

    Rules stand below the levels of a page; or on a page of their own behind it, if there are many
    levels on a page, or if the rules of any page take too much room.
    """
    size, parts = style.per_page, list[_Part]()
    shown = {
        first: entries[first - 1 : first - 1 + size] for first in range(1, len(entries) + 1, size)
    }
    told = {first: [*_told(shown[first], first)] for first in shown}
    boxes = {first: _box(told[first], style) for first in shown}
    tallest = max(box.height for box in boxes.values())
    if tallest <= _RULES_SHARE * style.height and size <= _MOST_WITH_RULES:
        parts = [_Part(shown[first], first, boxes[first]) for first in shown]
    else:
        for first in shown:
            parts.append(_Part(shown[first], first))
            parts += (_Part((), first, box) for box in _boxes(told[first], style))
    for number, part in enumerate(parts, 1):
        yield _page(part, number, len(parts), style)


class _Part(NamedTuple):
    """What is on a page: levels, rules, or both.

    Attributes:
        entries: the levels.
        first: the number of the first one, or of the first one that the rules are about.
        rules: the rules; None for none.
    """

    entries: Sequence[Entry]
    first: int
    rules: _Box | None = None


def _page(part: _Part, number: int, count: int, style: PageStyle) -> Scene:
    top = _MARGIN + _title_height(style) + _HEADING
    foot = style.height - _MARGIN
    box = part.rules
    bottom = foot - _FOOT - (box.height if box is not None and part.entries else 0)
    shapes = [*_heading(style, has_fields=bool(part.entries))]
    if part.entries:
        shapes += _body(part, style, _Area(_MARGIN, top, style.room, bottom - top))
    if box is not None:
        shapes += shifted(box.shapes(), _MARGIN, bottom if part.entries else top - 2 * _GAP)
    shapes += _foot(style, number, count, foot)
    told = [
        f"{number}. {entry.title}. {entry.pictures[0][0].description}"
        for number, entry in enumerate(part.entries, part.first)
    ]
    if box is not None:
        told += [f"{rule.text}." for rule in box.rules]
    title = f"{style.title}, page {number} of {count}"
    return Scene(style.width, style.height, tuple(shapes), title, " ".join(told))


# -- the heading and the foot ----------------------------------------------------------------

_KEY = 58.0
"""The width of the sign of a key."""


def _title_lines(style: PageStyle) -> list[str]:
    room = style.room - (_KEY + _GAP if style.key else 0)
    return _two_lines(style.title, room, _TITLE)


def _two_lines(title: str, room: float, size: float) -> list[str]:
    """Return a title in bold as one or two lines; of a longer one, the end is left out."""
    room *= _SLACK
    lines = wrapped(title, room, size, bold=True)
    if len(lines) > 2:
        lines = [lines[0], cut(" ".join(lines[1:]), room, size, bold=True)]
    return lines


def _title_height(style: PageStyle) -> float:
    return 1.2 * _TITLE * len(_title_lines(style))


def _heading(style: PageStyle, *, has_fields: bool) -> Iterator[Shape]:
    for number, line in enumerate(_title_lines(style)):
        y = _MARGIN + _TITLE * (0.75 + 1.2 * number)
        yield Text(_MARGIN, y, line, _TITLE, INK, "start", bold=True)
    right, y = style.width - _MARGIN, _MARGIN + _title_height(style) + 16
    if style.key:
        yield Rect(right - _KEY, _MARGIN - 3, _KEY, 24, INK, radius=4)
        yield Text(right - _KEY / 2, _MARGIN + 14, "KEY", 14, "#ffffff", bold=True)
        has_fields = False
    if not has_fields:
        return
    middle = _MARGIN + 0.66 * style.room
    for left, end, word in ((_MARGIN, middle - _GAP, "Name"), (middle, right, "Date")):
        yield Text(left, y, word, _FIELD, INK, "start")
        yield _line(left + width_of(word, _FIELD) + 6, y + 2, end)


def _line(left: float, y: float, right: float) -> Path:
    return Path(polyline([(left, y), (right, y)]), stroke=LINE, width=0.8)


def _foot(style: PageStyle, page: int, count: int, y: float) -> Iterator[Shape]:
    number = f"Page {page} of {count}"
    room = style.room - width_of(number, _SMALL) - _GAP
    yield Text(_MARGIN, y, cut(style.title, room, _SMALL), _SMALL, FAINT, "start")
    yield Text(style.width - _MARGIN, y, number, _SMALL, FAINT, "end")


# -- the levels ------------------------------------------------------------------------------


class _Area(NamedTuple):
    """A rectangle of a page."""

    left: float
    top: float
    width: float
    height: float


def _body(part: _Part, style: PageStyle, room: _Area) -> Iterator[Shape]:
    """Yield the levels of a page, in as many columns as make their pictures largest."""
    best = 0.0
    # A single page with fewer levels has no room for others.
    size = len(part.entries) if part.first == 1 else style.per_page
    for columns in range(1, size + 1):
        rows = math.ceil(size / columns)
        width = (room.width - (columns - 1) * _GAP) / columns
        height = (room.height - (rows - 1) * _GAP) / rows
        blocks = [
            _Block(entry, number, width, height)
            for number, entry in enumerate(part.entries, part.first)
        ]
        for first in range(0, len(blocks), columns):
            beside = blocks[first : first + columns]
            head = max(block.head for block in beside)
            for block in beside:
                block.align(head)
        # Levels with equally many pictures have them in equally many columns.
        inner = {size: _inner_columns(blocks, size) for size in {block.size for block in blocks}}
        goodness = round(sum(block.scale(inner[block.size]) for block in blocks), 2)
        if goodness > best:
            best, found = goodness, (columns, inner, blocks)
    columns, inner, blocks = found
    for index, block in enumerate(blocks):
        row, column = divmod(index, columns)
        left = room.left + column * (block.width + _GAP)
        top = room.top + row * (block.height + _GAP)
        yield from shifted(block.shapes(inner[block.size]), left, top)


def _inner_columns(blocks: Sequence[_Block], size: int) -> int:
    """Return in how many columns the pictures of levels with so many are largest."""
    alike = [block for block in blocks if block.size == size]
    return max(
        range(1, size + 1),
        key=lambda columns: round(sum(block.scale(columns) for block in alike), 2),
    )


class _Block:
    """A level on a page: number and title, its picture and grids, the answer, and its mark.

    Attributes:
        width: its width.
        height: its height.
        size: how many pictures it has.
        head: the height of its title, and of the highest one beside it.
    """

    _DISC = 20.0
    _LEADING = 1.25
    _CAPTION = 14.0
    _BETWEEN = 12.0

    def __init__(self, entry: Entry, number: int, width: float, height: float) -> None:
        self._entry, self._number, self.width, self.height = entry, number, width, height
        self.size = len(entry.pictures)
        self._title = _two_lines(entry.title, width - self._DISC - 6, _NAME)
        self._top = max(self._DISC, self._LEADING * _NAME * len(self._title)) + 6
        line, left = self._LEADING * _FIELD, height - self._top - 20 - _LEAST_PICTURE
        self._answers = _lines_of(entry.answer, _SLACK * width, max(1, int(left / line)), _FIELD)
        self._below = 4 + line * len(self._answers) + 16
        left = height - self._top - self._below - _LEAST_PICTURE
        self._lines = min(entry.lines, max(0, int(left / _RULED)))
        self._below += _RULED * self._lines
        # Where answers are long and many levels are on a page, there is no room for it.
        left = height - self._top - self._below - _LEAST_PICTURE
        most = int(min(round(_TEXT_SHARE * height / _TEXT_LINE), max(0.0, left / _TEXT_LINE)))
        self._text = _lines_of(entry.text, _SLACK * width, most, _CAPTION_SIZE)
        self.head = self._top + _TEXT_LINE * len(self._text) + 4 * bool(self._text)
        pictures = [picture for picture, _ in entry.pictures]
        self._widest = max(picture.width for picture in pictures)
        self._highest = max(picture.height for picture in pictures)
        self._caption = self._CAPTION if len(pictures) > 1 else 0.0

    def align(self, head: float) -> None:
        """Begin its pictures where those beside it begin, if that leaves room for them."""
        self.head = max(self.head, min(head, self.height - self._below - _LEAST_PICTURE))

    def scale(self, columns: int) -> float:
        """Return how large its pictures are in a number of columns."""
        rows = math.ceil(len(self._entry.pictures) / columns)
        width = (self.width - (columns - 1) * self._BETWEEN) / columns
        room = self.height - self.head - self._below
        height = (room - (rows - 1) * self._BETWEEN) / rows - self._caption
        return max(0.01, min(_LARGEST, width / self._widest, height / self._highest))

    def shapes(self, columns: int) -> Iterator[Shape]:
        """Yield its shapes, with so many columns of pictures; its upper left corner is (0, 0)."""
        half, number = self._DISC / 2, str(self._number)
        yield Ellipse(half, half, half, half, INK)
        size = 11.0 if len(number) < 3 else 8.5
        yield Text(half, half + 0.36 * size, number, size, "#ffffff", bold=True)
        for count, line in enumerate(self._title):
            y = half + _NAME * (0.36 + self._LEADING * count)
            yield Text(self._DISC + 6, y, line, _NAME, INK, "start", bold=True)
        for count, line in enumerate(self._text):
            y = self._top + _TEXT_LINE * (count + 0.6)
            yield Text(0, y, line, _CAPTION_SIZE, INK, "start")
        scale = self.scale(columns)
        width, height = scale * self._widest, scale * self._highest + self._caption
        for index, (picture, caption) in enumerate(self._entry.pictures):
            row, column = divmod(index, columns)
            left = column * (width + self._BETWEEN)
            top = self.head + row * (height + self._BETWEEN)
            shown = cut(caption, width, _CAPTION_SIZE)
            yield Text(left, top + 9, shown, _CAPTION_SIZE, INK, "start")
            yield from shifted(scaled(picture.shapes, scale), left, top + self._caption)
        rows = math.ceil(len(self._entry.pictures) / columns)
        y = self.head + rows * (height + self._BETWEEN) - self._BETWEEN + 4
        for line in self._answers:
            y += self._LEADING * _FIELD
            yield Text(0, y, line, _FIELD, INK, "start")
        if self._answers and self._entry.blank:
            left = width_of(self._answers[-1], _FIELD) + 6
            yield _line(left, y + 2, min(self.width, left + 150))
        for _ in range(self._lines):
            y += _RULED
            yield _line(0, y, self.width)
        yield Text(0, y + 14, cut(self._entry.mark, self.width, _SMALL), _SMALL, FAINT, "start")


def _lines_of(text: str, room: float, most: int, size: float) -> list[str]:
    """Return the lines of a text; the end of a long one is left out, and seen to be."""
    lines = wrapped(text, room, size) if text and most else []
    if len(lines) > most:
        # Two lines are more than what has room.
        lines = [*lines[: most - 1], cut(" ".join(lines[most - 1 : most + 1]), room, size)]
    return lines


# -- the rules -------------------------------------------------------------------------------


class _Box(NamedTuple):
    """A box with rules.

    Attributes:
        rules: the rules, each once.
        width: the width of the box.
        height: its height with the space above it, 0 without rules.
        scale: the scale of its texts.
    """

    rules: Sequence[SampledRule]
    width: float
    height: float
    scale: float

    def shapes(self) -> Iterator[Shape]:
        """Yield its shapes; the upper left corner of the space above it is (0, 0)."""
        if not self.rules:
            return
        height = self.height - _GAP
        yield Path(rounded(0.0, _GAP, self.width, height, 6), stroke=LINE, width=1)
        yield Text(10, _GAP + 18, "Rules", _FIELD, INK, "start", bold=True)
        width, height = self.width / self.scale, (height - _RULES_HEAD + 0.5) / self.scale
        rows = rule_shapes(self.rules, width, height, INK)
        yield from shifted(scaled(rows, self.scale), 0.0, _GAP + _RULES_HEAD)


def _box(rules: Sequence[SampledRule], style: PageStyle) -> _Box:
    """Return the box with the rules of a page, in small letters if they are many."""
    height, scale = 0.0, 1.0
    for scale in _RULES_SCALES if rules else ():
        texts = [rule.text for rule in rules]
        height = _GAP + _RULES_HEAD + scale * height_for(texts, style.room / scale)
        if height <= _RULES_SHARE * style.height:
            break
    return _Box(rules, style.room, height, scale)


def _boxes(rules: Sequence[SampledRule], style: PageStyle) -> Iterator[_Box]:
    """Yield boxes as large as pages, in which all the rules have room."""
    room = style.height - 2 * _MARGIN - _FOOT - _title_height(style) - _HEADING
    texts = [rule.text for rule in rules]
    while rules:
        fits = range(len(rules), 0, -1)
        count = next((n for n in fits if height_for(texts[:n], style.room) <= room), 1)
        height = height_for(texts[:count], style.room)
        yield _Box(rules[:count], style.room, _GAP + _RULES_HEAD + height, 1.0)
        rules, texts = rules[count:], texts[count:]


def _told(entries: Sequence[Entry], first: int) -> Iterator[SampledRule]:
    """Yield the rules of some levels, each once: those of all of them first, by what they tell."""
    found: dict[str, list[int]] = {}
    samples: dict[str, SampledRule] = {}
    for number, entry in enumerate(entries, first):
        for rule in entry.rules:
            samples.setdefault(rule.text, rule)
            numbers = found.setdefault(rule.text, [])
            if number not in numbers:
                numbers.append(number)
    subjects = list(dict.fromkeys(map(_subject, found)))
    for text in sorted(
        found, key=lambda text: (len(found[text]) < len(entries), subjects.index(_subject(text)))
    ):
        where = ""
        if len(found[text]) < len(entries):
            which = "level" if len(found[text]) == 1 else "levels"
            where = f" ({which}\N{NO-BREAK SPACE}{phrases.ranges(found[text])})"
        yield samples[text]._replace(text=text + where)


def _subject(text: str) -> str:
    return text.partition(":")[0]
