"""The PDF painter: a page for each scene, in vectors, the same bytes for the same scenes.

Texts stay texts, which can be searched and copied. They are in Helvetica, which every viewer has
(ISO 32000-1, 9.6.2.2), as far as its encoding has their characters. Others are in the fonts that
viewers have for Chinese, Japanese and Korean, which contain the letters of further scripts.

Arial and Liberation Sans, with which pictures are shown elsewhere, have the widths of Helvetica.
"""

import json
import pathlib
import re
import unicodedata
import zlib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import lru_cache
from itertools import groupby

from babyrobot_levels.render.colors import rgba
from babyrobot_levels.render.scene.shapes import (
    Commands,
    Ellipse,
    Path,
    Rect,
    Scene,
    Text,
    circle,
    rounded,
)
from babyrobot_levels.render.svg import number

_TABLES = json.loads(pathlib.Path(__file__).with_name("helvetica.json").read_text("utf-8"))

EXTRA: dict[str, str] = _TABLES["glyphs"]
"""Characters that the font has beyond the encoding WinAnsi, with the names of their glyphs.

They take the codes from 1 on.
"""

CODES = {bytes([code]).decode("cp1252", "ignore"): code for code in range(32, 256) if code != 127}
"""The characters of the font with their codes."""

CODES.pop("")
CODES |= {character: code for code, character in enumerate(EXTRA, 1)}

ACCENTS: dict[str, str] = _TABLES["accents"]
"""Combining characters, and those of the font that look like them."""

_USUAL = 556
"""The width of all other characters of the encoding, digits among them."""


def _widths(table: Mapping[str, str]) -> dict[str, int]:
    return {character: int(width) for width, those in table.items() for character in those}


_WIDTHS = {False: _widths(_TABLES["regular"]), True: _widths(_TABLES["bold"])}
"""The widths of characters in thousandths of the font size, regular and bold."""


@lru_cache(maxsize=1024)
def composition(character: str) -> str:
    """Return a character as those of the font: a letter and its accents; empty if it has none."""
    if character in CODES:
        return character
    parts = unicodedata.normalize("NFD", character)
    if parts[0] in CODES and all(mark in ACCENTS for mark in parts[1:]):
        return parts[0] + "".join(map(ACCENTS.__getitem__, parts[1:]))
    return ""


@lru_cache(maxsize=4096)
def advance(character: str, *, bold: bool = False) -> int:
    """Return the width of a character in thousandths of the font size.

    One that the font does not have is as wide as in a usual font of its script.
    """
    if composed := composition(character):
        return _WIDTHS[bold].get(composed[0], _USUAL)
    if unicodedata.combining(character):
        return 0
    return 1000 if unicodedata.east_asian_width(character) in "WF" else 600


def width_of(text: str, size: float, *, bold: bool = False) -> float:
    """Return the width of a line of text, in the unit of the font size."""
    return _advances(text, bold) * size / 1000


def _advances(text: str, bold: bool) -> int:
    """Return the width of a line of text in thousandths of the font size."""
    return sum(advance(character, bold=bold) for character in text)


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
    lines, taken = [""], 0
    for word in _words(text):
        more = _advances(word.rstrip(), bold)
        if (taken + more) * size / 1000 > width and lines[-1]:
            lines.append("")
            taken = 0
        for character in word:
            # A word that is too long for a line is broken anywhere.
            more = advance(character, bold=bold)
            full = (taken + more) * size / 1000 > width
            if full and lines[-1] and not character.isspace():
                lines.append("")
                taken = 0
            lines[-1] += character
            taken += more
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


# -- scenes ----------------------------------------------------------------------------------------

_POINT = 0.75
"""A pixel in points: 96 pixels and 72 points are an inch."""

_MAX_SIDE = 14_400.0
"""The largest side of a page in points that viewers accept."""

_WESTERN = "HB"
"""The keys of the fonts for regular and for bold texts."""

_EASTERN = {
    "K": ("HYGoThic-Medium", "UniKS-UTF16-H", "Korea1", 1),
    "J": ("HeiseiKakuGo-W5", "UniJIS-UTF16-H", "Japan1", 4),
    "C": ("STSong-Light", "UniGB-UTF16-H", "GB1", 4),
}
"""Fonts that viewers have: name, encoding, and the collection of characters with its number."""

_HANGUL = re.compile("[\u1100-\u11ff\u3130-\u318f\uac00-\ud7af]")
_KANA = re.compile("[\u3040-\u30ff]")


def to_pdf(
    scenes: Iterable[Scene], scale: float = 1.0, *, title: str = "", language: str = "en"
) -> bytes:
    """Return scenes as the pages of a PDF file.

    Args:
        scenes: the scenes, at least one. Title and description of each are the alternative text of
            its page.
        scale: the size; 1 is 96 pixels per inch. Larger pages than viewers accept are made smaller.
        title: the title of the document; by default, that of the first scene.
        language: the language of the texts, as a BCP 47 tag.
    """
    pages = list(scenes)
    file = _File()
    catalog, tree, root, document, parents = (file.reserved() for _ in range(5))
    fonts = file.reserved()
    leaves, figures, used = [], [], set[str]()
    for index, scene in enumerate(pages):
        points = _POINT * scale
        points = min(points, _MAX_SIDE / max(scene.width, scene.height))
        page = _Page(scene, points)
        used |= page.fonts
        content = file.stream(page.content())
        leaf, figure = file.reserved(), file.reserved()
        box = f"{number(points * scene.width)} {number(points * scene.height)}"
        states = " ".join(
            f"/{name} << /ca {fill} /CA {stroke} >>" for (fill, stroke), name in page.states.items()
        )
        file.fill(
            leaf,
            f"<< /Type /Page /Parent {tree} 0 R /MediaBox [0 0 {box}] /Contents {content} 0 R "
            f"/Resources << /Font {fonts} 0 R /ExtGState << {states} >> >> "
            f"/StructParents {index} >>",
        )
        alternative = _string(". ".join(text for text in (scene.title, scene.description) if text))
        file.fill(
            figure,
            f"<< /Type /StructElem /S /Figure /P {document} 0 R /Pg {leaf} 0 R /K 0 "
            f"/Alt {alternative} /A << /O /Layout /Placement /Block /BBox [0 0 {box}] >> >>",
        )
        leaves.append(leaf)
        figures.append(figure)
    file.fill(fonts, f"<< {' '.join(_fonts(file, used))} >>")
    file.fill(tree, f"<< /Type /Pages /Kids [{_references(leaves)}] /Count {len(leaves)} >>")
    numbers = " ".join(f"{index} [{figure} 0 R]" for index, figure in enumerate(figures))
    file.fill(parents, f"<< /Nums [{numbers}] >>")
    file.fill(
        document, f"<< /Type /StructElem /S /Document /P {root} 0 R /K [{_references(figures)}] >>"
    )
    file.fill(
        root,
        f"<< /Type /StructTreeRoot /K {document} 0 R /ParentTree {parents} 0 R "
        f"/ParentTreeNextKey {len(leaves)} >>",
    )
    file.fill(
        catalog,
        f"<< /Type /Catalog /Pages {tree} 0 R /Lang {_string(language)} "
        f"/MarkInfo << /Marked true >> /StructTreeRoot {root} 0 R "
        "/ViewerPreferences << /DisplayDocTitle true >> >>",
    )
    return file.written(catalog, file.added(f"<< /Title {_string(title or pages[0].title)} >>"))


# -- the file --------------------------------------------------------------------------------


class _File:
    """The objects of a file, numbered from 1."""

    def __init__(self) -> None:
        self._objects: list[bytes] = []

    def reserved(self) -> int:
        """Return the number of a new object, which is to be filled."""
        self._objects.append(b"")
        return len(self._objects)

    def fill(self, number: int, text: str) -> None:
        """Give an object its content."""
        self._objects[number - 1] = text.encode("ascii")

    def added(self, text: str) -> int:
        """Return the number of a new object with this content."""
        number = self.reserved()
        self.fill(number, text)
        return number

    def stream(self, data: bytes) -> int:
        """Return the number of a new stream."""
        packed = zlib.compress(data, 9)
        head = f"<< /Length {len(packed)} /Filter /FlateDecode >>\nstream\n".encode("ascii")
        self._objects.append(head + packed + b"\nendstream")
        return len(self._objects)

    def written(self, catalog: int, info: int) -> bytes:
        """Return the whole file."""
        # Bytes above 127 tell programs that the file is not text.
        data = bytearray(b"%PDF-1.5\n%\xe2\xe3\xcf\xd3\n")
        places = []
        for count, content in enumerate(self._objects, 1):
            places.append(len(data))
            data += b"%d 0 obj\n%b\nendobj\n" % (count, content)
        start, size = len(data), len(places) + 1
        data += b"xref\n0 %d\n0000000000 65535 f \n" % size
        data += b"".join(b"%010d 00000 n \n" % place for place in places)
        data += b"trailer\n<< /Size %d /Root %d 0 R /Info %d 0 R >>\n" % (size, catalog, info)
        return bytes(data + b"startxref\n%d\n%%%%EOF\n" % start)


def _references(numbers: Sequence[int]) -> str:
    return " ".join(f"{each} 0 R" for each in numbers)


def _string(text: str) -> str:
    return f"<FEFF{_utf16(text)}>"


def _utf16(text: str) -> str:
    return text.encode("utf-16-be", "replace").hex().upper()


def _fonts(file: _File, used: set[str]) -> Iterator[str]:
    """Yield the entries of fonts in the resources of a page."""
    names = " ".join(f"/{name}" for name in EXTRA.values())
    encoding = f"<< /BaseEncoding /WinAnsiEncoding /Differences [1 {names}] >>"
    for key, name in zip(_WESTERN, ("Helvetica", "Helvetica-Bold"), strict=True):
        if key in used:
            yield f"/{key} << /Type /Font /Subtype /Type1 /BaseFont /{name} /Encoding {encoding} >>"
    for key, (name, cmap, collection, supplement) in _EASTERN.items():
        if key in used:
            descriptor = file.added(
                f"<< /Type /FontDescriptor /FontName /{name} /Flags 4 /StemV 90 /ItalicAngle 0 "
                "/FontBBox [-100 -250 1100 950] /Ascent 860 /Descent -140 /CapHeight 730 >>"
            )
            system = f"<< /Registry (Adobe) /Ordering ({collection}) /Supplement {supplement} >>"
            characters = file.added(
                f"<< /Type /Font /Subtype /CIDFontType0 /BaseFont /{name} /CIDSystemInfo {system} "
                f"/FontDescriptor {descriptor} 0 R /DW 1000 >>"
            )
            yield (
                f"/{key} << /Type /Font /Subtype /Type0 /BaseFont /{name}-{cmap} "
                f"/Encoding /{cmap} /DescendantFonts [{characters} 0 R] >>"
            )


# -- a page ----------------------------------------------------------------------------------


class _Page:
    """The operators that paint a scene.

    Attributes:
        states: the names of graphics states by the opacities of fills and strokes.
        fonts: the keys of the fonts that are used.
    """

    def __init__(self, scene: Scene, points: float) -> None:
        self.states: dict[tuple[str, str], str] = {}
        self.fonts: set[str] = set()
        self._now: dict[str, str] = {}
        height = number(points * scene.height)
        self._lines = [
            "/Figure << /MCID 0 >> BDC",
            f"{points:.6g} 0 0 -{points:.6g} 0 {height} cm",
            "1 j",
        ]
        for shape in scene.shapes:
            if isinstance(shape, Path):
                self._path(shape)
            elif self._filled(shape.fill, shape.opacity):
                self._lines.append(self._operators(shape))
        self._lines.append("EMC")

    def content(self) -> bytes:
        """Return the operators."""
        return "\n".join(self._lines).encode("ascii")

    def _operators(self, shape: Rect | Ellipse | Text) -> str:
        match shape:
            case Text():
                return f"BT {' '.join(self._text(shape))} ET"
            case Ellipse():
                return f"{_path(circle(shape.x, shape.y, shape.rx, shape.ry))} f"
            case Rect(x, y, width, height, radius=0):
                return f"{' '.join(map(number, (x, y, width, height)))} re f"
            case Rect(x, y, width, height, radius=radius):
                return f"{_path(rounded(x, y, width, height, radius))} f"

    def _set(self, what: str, operator: str) -> None:
        """Write an operator that sets something, unless it is set so already."""
        if self._now.get(what) != operator:
            self._now[what] = operator
            self._lines.append(operator)

    def _filled(self, fill: str | None, opacity: float, stroke: str | None = None) -> bool:
        """Set colours and opacities; return whether anything is seen."""
        operators, alphas = _colored(fill, stroke, opacity)
        for what, operator in operators:
            self._set(what, operator)
        if operators:
            self._set("state", f"/{self.states.setdefault(alphas, f'S{len(self.states)}')} gs")
        return bool(operators)

    def _path(self, path: Path) -> None:
        if not path.commands or not self._filled(path.fill, path.opacity, path.stroke):
            return
        if path.stroke is not None:
            self._set("width", f"{number(path.width)} w")
            self._set("cap", f"{1 if path.cap == 'round' else 0} J")
            dash = "" if path.dash is None else " ".join(map(number, path.dash))
            self._set("dash", f"[{dash}] 0 d")
        has_fill = path.fill is not None
        painting = "B" if has_fill and path.stroke is not None else "f" if has_fill else "S"
        self._lines.append(f"{_path(path.commands)} {painting}")

    def _text(self, text: Text) -> Iterator[str]:
        """Yield the operators of a text: runs of characters in one font each."""
        left = text.x
        if text.anchor != "start":
            width = width_of(text.text, text.size, bold=text.bold)
            left -= width / 2 if text.anchor == "middle" else width
        western, before = _WESTERN[text.bold], ""
        for run in _runs(text.text):
            left, before = left + width_of(before, text.size, bold=text.bold), run
            at = f"{number(text.size)} Tf 1 0 0 -1 {number(left)} {number(text.y)} Tm"
            if run in CODES or len(run) > 1:
                yield f"/{self._font(western)} {at} <{_encoded(run)}> Tj"
            elif composition(run):
                yield from self._composed(run, text, left)
            else:
                yield f"/{self._font(_eastern(run, text.text))} {at} <{_utf16(run)}> Tj"

    def _composed(self, character: str, text: Text, left: float) -> Iterator[str]:
        """Yield the operators of a letter and its accents, which are found and copied as one."""
        font, letter = self._font(_WESTERN[text.bold]), composition(character)[0]
        yield f"/Span << /ActualText {_string(character)} >> BDC /{font} {number(text.size)} Tf"
        middle = left + width_of(letter, text.size, bold=text.bold) / 2
        for part in composition(character):
            width = width_of(part, text.size, bold=text.bold)
            # Accents of the font are as high as small letters ask for; some hang below.
            is_raised = part not in (letter, "¸", "˛") and (letter.isupper() or letter in "dlt")
            y = text.y - (0.19 * text.size if is_raised else 0.0)
            yield f"1 0 0 -1 {number(middle - width / 2)} {number(y)} Tm <{_encoded(part)}> Tj"
        yield "EMC"

    def _font(self, key: str) -> str:
        self.fonts.add(key)
        return key


@lru_cache(maxsize=1024)
def _colored(
    fill: str | None, stroke: str | None, opacity: float
) -> tuple[list[tuple[str, str]], tuple[str, str]]:
    """Return what sets the colours that are seen, and the opacities of fill and stroke."""
    alphas, operators = [], []
    for what, color, gray, full in (("fill", fill, "g", "rg"), ("stroke", stroke, "G", "RG")):
        *channels, alpha = rgba(color) if color is not None else (0, 0, 0, 0.0)
        alphas.append(alpha * opacity)
        if alphas[-1]:
            # Greys in one number are printed in black ink alone.
            parts = channels[:1] if len({*channels}) == 1 else channels
            shares = " ".join(f"{part / 255:.3g}" for part in parts)
            operators.append((what, f"{shares} {gray if len(parts) == 1 else full}"))
    return operators, (f"{alphas[0]:.3g}", f"{alphas[stroke is not None]:.3g}")


def _runs(text: str) -> Iterator[str]:
    """Yield the parts of a text: characters of Helvetica together, others one by one."""
    if text.isascii() and text.isprintable() and text:
        # As nearly all are, of which there may be one in each cell.
        yield text
        return
    for is_western, run in groupby(text, CODES.__contains__):
        if is_western:
            yield "".join(run)
        else:
            # Viewers do not agree on the widths of characters that a font lacks.
            yield from run


def _encoded(characters: str) -> str:
    is_ascii = characters.isascii() and characters.isprintable()
    codes = characters.encode() if is_ascii else bytes(map(CODES.__getitem__, characters))
    return codes.hex().upper()


def _eastern(character: str, text: str) -> str:
    """Return the key of the font for a character of a text that Helvetica does not have."""
    if _HANGUL.match(character):
        return "K"
    return "J" if _KANA.search(text) else "C"


def _path(commands: Commands) -> str:
    return " ".join(
        "h" if letter == "Z" else f"{' '.join(map(number, numbers))} {letter.lower()}"
        for letter, numbers in commands
    )
