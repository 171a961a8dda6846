"""The widths of Helvetica's characters: how wide a text is, and where its lines end.

Arial and Liberation Sans, with which pictures are shown elsewhere, have the same widths.
"""

from __future__ import annotations

import unicodedata
from collections.abc import Iterator, Mapping
from functools import lru_cache

EXTRA = {
    "\N{MINUS SIGN}": "minus",
    "ˇ": "caron",
    "˘": "breve",
    "˙": "dotaccent",
    "˚": "ring",
    "˝": "hungarumlaut",
    "˛": "ogonek",
    "ı": "dotlessi",
    "Ł": "Lslash",
    "ł": "lslash",
}
"""Characters that the font has beyond the encoding WinAnsi, with the names of their glyphs.

They take the codes from 1 on.
"""

CODES = {bytes([code]).decode("cp1252", "ignore"): code for code in range(32, 256) if code != 127}
"""The characters of the font with their codes."""

CODES.pop("")
CODES |= {character: code for code, character in enumerate(EXTRA, 1)}

ACCENTS = dict(
    zip(
        "\u0300\u0301\u0302\u0303\u0304\u0306\u0307\u0308\u030a\u030b\u030c\u0327\u0328",
        "`´ˆ˜¯˘˙¨˚˝ˇ¸˛",
        strict=True,
    )
)
"""Combining characters, and those of the font that look like them."""

_REGULAR = {
    191: "'",
    222: "ijlł‘’‚",
    260: "|¦",
    278: " !,./:;I[\\]ft\xa0·ÌÍÎÏìíîïı",
    333: "()-`r¡¨\xad¯²³´¸¹ˆ˜“”„‹›ˇ˘˙˚˝˛",
    334: "{}",
    350: "•",
    355: '"',
    365: "º",
    370: "ª",
    389: "*",
    400: "°",
    469: "^",
    500: "Jcksvxyzçýÿšž",
    537: "¶",
    584: "+<=>~¬±×÷−",
    611: "FTZ¿ßøŽ",
    667: "&ABEKPSVXYÀÁÂÃÄÅÈÉÊËÝÞŠŸ",
    722: "CDHNRUwÇÐÑÙÚÛÜ",
    737: "©®",
    778: "GOQÒÓÔÕÖØ",
    833: "Mm",
    834: "¼½¾",
    889: "%æ",
    944: "Wœ",
    1000: "ÆŒ—…‰™",
    1015: "@",
}
_BOLD = {
    238: "'",
    278: " ,./I\\ijlł\xa0·ÌÍÎÏìíîïı‘’‚",
    280: "|¦",
    333: "!()-:;[]`ft¡¨\xad¯²³´¸¹ˆ˜‹›ˇ˘˙˚˝˛",
    350: "•",
    365: "º",
    370: "ª",
    389: "*r{}",
    400: "°",
    474: '"',
    500: "zž“”„",
    584: "+<=>^~¬±×÷−",
    611: "?FLŁTZbdghnopquµ¿ßðñòóôõöøùúûüþŽ",
    667: "EPSVXYÈÉÊËÝÞŠŸ",
    722: "&ABCDHKNRUÀÁÂÃÄÅÇÐÑÙÚÛÜ",
    737: "©®",
    778: "GOQwÒÓÔÕÖØ",
    833: "M",
    834: "¼½¾",
    889: "%mæ",
    944: "Wœ",
    975: "@",
    1000: "ÆŒ—…‰™",
}
_USUAL = 556
"""The width of all other characters of the encoding, digits among them."""


def _widths(table: Mapping[int, str]) -> dict[str, int]:
    return {character: width for width, those in table.items() for character in those}


_WIDTHS = {False: _widths(_REGULAR), True: _widths(_BOLD)}


@lru_cache(maxsize=1024)
def composition(character: str) -> str:
    """Return a character as those of the font: a letter and its accents; empty if it has none."""
    if character in CODES:
        return character
    parts = unicodedata.normalize("NFD", character)
    if parts[0] in CODES and all(mark in ACCENTS for mark in parts[1:]):
        return parts[0] + "".join(map(ACCENTS.__getitem__, parts[1:]))
    return ""


def advance(character: str, *, bold: bool = False) -> int:
    """Return the width of a character in thousandths of the font size.

    One that the font does not have is as wide as in a usual font of its script.
    """
    composed = composition(character)
    if composed:
        return _WIDTHS[bold].get(composed[0], _USUAL)
    if unicodedata.combining(character):
        return 0
    return 1000 if unicodedata.east_asian_width(character) in "WF" else 600


def width_of(text: str, size: float, *, bold: bool = False) -> float:
    """Return the width of a line of text, in the unit of the font size."""
    return sum(advance(character, bold=bold) for character in text) * size / 1000


def cut(text: str, width: float, size: float, *, bold: bool = False) -> str:
    """Return a text as far as it is at most so wide; `…` at its end says that there was more."""
    if width_of(text, size, bold=bold) <= width:
        return text
    while text and width_of(text + "…", size, bold=bold) > width:
        text = text[:-1]
    return text.rstrip() + "…"


def wrapped(text: str, width: float, size: float, *, bold: bool = False) -> list[str]:
    """Return a text as lines that are at most so wide, broken between words where that is possible.

    Args:
        text: the text.
        width: the width of a line.
        size: the font size.
        bold: whether it is in bold.
    """
    lines = [""]
    for word in _words(text):
        if width_of(lines[-1] + word.rstrip(), size, bold=bold) > width and lines[-1]:
            lines.append("")
        for character in word:
            # A word that is too long for a line is broken anywhere.
            full = width_of(lines[-1] + character, size, bold=bold) > width
            if full and lines[-1] and not character.isspace():
                lines.append("")
            lines[-1] += character
    return [line.strip() for line in lines]


def _words(text: str) -> Iterator[str]:
    """Yield the parts between which lines may end: words with a space, and wide characters."""
    word = ""
    for character in text:
        is_wide = unicodedata.east_asian_width(character) in "WF"
        if word and (word[-1].isspace() or is_wide) and not character.isspace():
            yield word
            word = ""
        word += character
    if word:
        yield word
