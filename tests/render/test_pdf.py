"""PDF: valid, what the other painters paint, texts that stay texts, the same bytes each time."""

from __future__ import annotations

import re
import zlib

import numpy as np
import pypdfium2 as pdfium
import pytest
from numpy.typing import NDArray
from support.golden import pictures

import babyrobot_levels as brl
from babyrobot_levels.render.pdf import CODES, cut, to_pdf, width_of, wrapped
from babyrobot_levels.render.raster import to_rgb
from babyrobot_levels.render.scene.build import build_scene
from babyrobot_levels.render.scene.shapes import (
    Ellipse,
    Path,
    Rect,
    Scene,
    Shape,
    Text,
    circle,
    polyline,
)

POINT = 0.75


def scene_of(*shapes: Shape, width: float = 200, height: float = 100) -> Scene:
    return Scene(width, height, shapes, "A title", "What is seen.")


def opened(*scenes: Scene, scale: float = 1.0) -> pdfium.PdfDocument:
    return pdfium.PdfDocument(to_pdf(scenes, scale))


def painted(scene: Scene, pixels: float = 1.0) -> NDArray[np.uint8]:
    """Return the pixels that another program paints, so many for one of the scene."""
    page = opened(scene)[0]
    return np.asarray(page.render(scale=pixels / POINT).to_pil().convert("RGB"))


def content(data: bytes) -> str:
    """Return the operators of all pages."""
    streams = re.findall(rb"stream\n(.*?)\nendstream", data, re.DOTALL)
    return "\n".join(zlib.decompress(each).decode("ascii") for each in streams)


def words(scene: Scene) -> str:
    text: str = opened(scene)[0].get_textpage().get_text_bounded()
    return text


# -- the file --------------------------------------------------------------------------------


def test_each_scene_is_a_page_of_its_size() -> None:
    file = opened(scene_of(), scene_of(width=64, height=640))
    assert [file[page].get_size() for page in range(len(file))] == [(150, 75), (48, 480)]
    assert opened(scene_of(), scale=2)[0].get_size() == (300, 150)


def test_a_page_is_no_larger_than_viewers_accept() -> None:
    width, height = opened(scene_of(width=64 * 1024, height=64))[0].get_size()
    assert width == pytest.approx(14_400)
    assert height == pytest.approx(14_400 / 1024, abs=0.01)


def test_title_language_and_alternative_texts_are_told() -> None:
    data = to_pdf([scene_of()], title="Übung", language="de")
    assert pdfium.PdfDocument(data).get_metadata_dict()["Title"] == "Übung"
    assert b"/Lang <FEFF00640065>" in data
    assert (
        b"/Alt <FEFF" + "A title. What is seen.".encode("utf-16-be").hex().upper().encode() in data
    )
    assert pdfium.PdfDocument(to_pdf([scene_of()])).get_metadata_dict()["Title"] == "A title"


def test_the_table_of_objects_is_exact() -> None:
    data = to_pdf([scene_of(Text(9, 9, "Ω", 9, "red")), scene_of()])
    start = int(re.findall(rb"startxref\n(\d+)\n%%EOF\n\Z", data)[0])
    lines = data[start:].split(b"\n")
    assert lines[0] == b"xref"
    count = int(lines[1].split()[1])
    for number, line in enumerate(lines[3 : 2 + count], 1):
        assert data[int(line[:10]) :].startswith(b"%d 0 obj\n" % number)
    for length, packed in re.findall(rb"/Length (\d+) .*?stream\n(.*?)\nendstream", data, re.S):
        assert int(length) == len(packed)


# -- shapes ----------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["little-of-all", "things"])
def test_another_program_sees_what_the_raster_painter_paints(name: str) -> None:
    scene = pictures()[name]
    bare = Scene(
        scene.width,
        scene.height,
        tuple(shape for shape in scene.shapes if not isinstance(shape, Text)),
    )
    seen, expected = painted(bare), to_rgb(bare)
    height, width = (min(sides) for sides in zip(seen.shape[:2], expected.shape[:2], strict=True))
    differs = np.abs(seen[:height, :width].astype(int) - expected[:height, :width]).max(axis=2) > 48
    # Edges are smoothed differently.
    assert differs.mean() < 0.02


def test_colours_and_opacities_come_out() -> None:
    scene = scene_of(
        Rect(0, 0, 50, 50, "#ff0000"),
        Rect(50, 0, 50, 50, "#00000080"),
        Ellipse(125, 25, 20, 20, "blue", 0.5),
        Rect(150, 0, 50, 50, "transparent"),
        Path(polyline([(0, 75), (100, 75)]), stroke="#00f", width=20, opacity=0.5),
        Path(circle(150, 75, 10), fill="lime", stroke="black", width=4),
    )
    seen = painted(scene)
    points = {(25, 25): (255, 0, 0), (75, 25): (127, 127, 127), (125, 25): (127, 127, 255)}
    points |= {(175, 25): (255, 255, 255), (50, 75): (127, 127, 255), (150, 75): (0, 255, 0)}
    points |= {(150, 65): (0, 0, 0), (150, 60): (255, 255, 255)}
    for (x, y), color in points.items():
        assert np.abs(seen[y, x].astype(int) - color).max() <= 3, (x, y)


def test_greys_are_printed_in_black_ink_alone() -> None:
    level = brl.load("final-maze").replace(theme="print")
    operators = content(to_pdf([build_scene(level)]))
    assert re.search(r"^[\d.]+ g$", operators, re.M)
    assert not re.search(r"\b(rg|RG)$", operators, re.M)


def test_dashes_and_caps_come_out() -> None:
    line = polyline([(0, 50), (200, 50)])
    dashed = Path(line, stroke="black", width=10, dash=(20, 30))
    dark = painted(scene_of(dashed))[50, :, 0] < 128
    assert [bool(dark[x]) for x in (10, 35, 60, 85)] == [True, False, True, False]
    ends = {}
    for cap in ("butt", "round"):
        stroke = Path(polyline([(50, 50), (100, 50)]), stroke="black", width=20, cap=cap)
        ends[cap] = int(painted(scene_of(stroke))[50, 105, 0])
    assert ends == {"butt": 255, "round": 0}


# -- texts -----------------------------------------------------------------------------------


def test_texts_can_be_copied() -> None:
    told = ["Übung “1” – 10 € −2.5", "Zażółć gęślą jaźń, ŁÓDŹ", "Příliš žluťoučký kůň ŐŰ İı"]
    texts = [Text(5, 20 + 25 * row, line, 12, "black", "start") for row, line in enumerate(told)]
    assert words(scene_of(*texts)).splitlines() == told


def test_other_scripts_are_in_fonts_of_the_viewers() -> None:
    data = to_pdf(
        [scene_of(Text(5, 20, "迷宫 (A)", 12, "black"), Text(5, 60, "かな 이름", 12, "black"))]
    )
    operators = content(data)
    for character, font in {"迷": "C", "宫": "C", "か": "J", "이": "K"}.items():
        code = character.encode("utf-16-be").hex().upper()
        assert re.search(rf"/{font} 12 Tf \S+ \S+ \S+ \S+ \S+ \S+ Tm <{code}> Tj", operators)
    for name in (b"STSong-Light", b"HeiseiKakuGo-W5", b"HYGoThic-Medium"):
        assert name in data
    assert len(pdfium.PdfDocument(data)) == 1


@pytest.mark.parametrize("told", ["(a) \\ ) <<>>", "\x00\n\x1b\ud800", "😀", "مرحبا", ""])
def test_no_text_breaks_the_file(told: str) -> None:
    scene = Scene(99, 99, (Text(5, 20, told, 12, "black"), Rect(0, 50, 99, 49, "red")), told, told)
    assert painted(scene)[75, 50].tolist() == [255, 0, 0]


@pytest.mark.parametrize("bold", [False, True])
def test_every_character_is_as_wide_as_the_font_of_viewers(bold: bool) -> None:
    characters = [each for each in CODES if each not in " \xa0\xad" and each.isprintable()]
    size = 50.0
    texts = [
        Text(0, 60 * row, f"H{each}H", size, "black", "start", bold=bold)
        for row, each in enumerate(characters, 1)
    ]
    page = opened(scene_of(*texts, height=60 * len(texts) + 60))[0]
    found = page.get_textpage()
    letters = [
        index for index in range(found.count_chars()) if found.get_text_range(index, 1) == "H"
    ]
    lefts = [found.get_charbox(index, loose=True)[0] / POINT for index in letters]
    firsts = [index for index, left in enumerate(lefts) if left < 1]
    different = set()
    for row, each in enumerate(characters):
        second = max(lefts[firsts[row] : [*firsts, len(lefts)][row + 1]])
        if abs(second - lefts[firsts[row]] - width_of(f"H{each}", size, bold=bold)) > 0.15:
            different.add(each)
    # In these its font is not that of the standard.
    assert different <= {*"€@«»‹›"}


def test_texts_stand_where_their_anchors_say() -> None:
    half = width_of("HH", 20) / 2
    for anchor, middle in (("start", 100 + half), ("middle", 100), ("end", 100 - half)):
        text = Text(100, 50, "HH", 20, "black", anchor)  # type: ignore[arg-type]
        columns = np.flatnonzero(painted(scene_of(text), 4)[..., 0].min(axis=0) < 128) / 4
        assert (columns.min() + columns.max()) / 2 == pytest.approx(middle, abs=0.7)


# -- lines -----------------------------------------------------------------------------------


def test_lines_end_between_words_or_wide_characters() -> None:
    text = "the quick brown fox jumps over the lazy dog"
    lines = wrapped(text, 80, 10)
    assert " ".join(lines) == text
    assert all(width_of(line, 10) <= 80 for line in lines)
    assert wrapped("机器人在冰上行走", 40, 10) == ["机器人在", "冰上行走"]
    assert all(width_of(line, 10) <= 30 for line in wrapped("x" * 99, 30, 10))
    assert wrapped("", 10, 10) == [""]


def test_a_cut_text_says_so() -> None:
    assert cut("short", 100, 10) == "short"
    shown = cut("a rather long text", 50, 10)
    assert shown.endswith("…")
    assert width_of(shown, 10) <= 50
