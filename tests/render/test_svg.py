"""SVG: valid, self-contained, the same for the same scene."""

from __future__ import annotations

import math
import re
import subprocess
import sys
import xml.etree.ElementTree as ET

import pytest
from support.golden import FOLDER, gallery, pictures, svg
from support.worlds import level

from babyrobot_levels.render.scene.build import build_scene
from babyrobot_levels.render.scene.shapes import Command, Rect, Scene, Text, polyline
from babyrobot_levels.render.svg import number, path_data, to_svg

SVG = "{http://www.w3.org/2000/svg}"


def parsed(scene: Scene) -> ET.Element:
    return ET.fromstring(to_svg(scene))


@pytest.mark.parametrize("name", pictures())
def test_the_picture_is_the_one_that_was_looked_at(name: str) -> None:
    expected = (FOLDER / f"{name}.svg").read_text(encoding="utf-8")
    assert svg(name) == expected, "if that is meant: python scripts/renew.py tests/render"


@pytest.mark.slow
def test_pictures_of_the_gallery_stay_as_they_are() -> None:
    expected = (FOLDER / "gallery.txt").read_text(encoding="utf-8")
    differ = {*expected.splitlines()} ^ {*gallery().splitlines()}
    assert differ == set(), "if that is meant: python scripts/renew.py tests/render"


@pytest.mark.parametrize("told", ["<b> & \"quotes\" 'n' ]]>", "</title><script>", "é 雪 😀"])
def test_texts_come_out_as_they_were_told(told: str) -> None:
    areas = [{"at": [0, 1], "size": [20, 1], "label": told}]
    root = parsed(build_scene(level(title=told, size=[20, 2], areas=areas)))
    assert root.findtext(f"{SVG}title") == told
    assert told in [text.text for text in root.iter(f"{SVG}text")]


@pytest.mark.parametrize("broken", ["\x00", "\x1b", "\ud800", "\ufffe", "\x0b"])
def test_characters_that_xml_forbids_are_replaced(broken: str) -> None:
    scene = Scene(9, 9, (Text(1, 1, f"a{broken}b", 9, "red"),), title=broken)
    root = parsed(scene)
    assert root.findtext(f"{SVG}text") == "a\ufffdb"
    assert root.findtext(f"{SVG}title") == "\ufffd"


@pytest.mark.parametrize(
    ("color", "fill", "opacity"),
    [
        ("orange", "orange", None),
        ("#abc", "#aabbcc", None),
        ("#12345680", "#123456", "0.5"),
        ("rgba(60,60,60,0.7)", "#3c3c3c", "0.7"),
        ("hsl(120, 100%, 25%)", "#008000", None),
        ("transparent", "#000000", "0"),
    ],
)
def test_colours_are_written_so_that_every_viewer_knows_them(
    color: str, fill: str, opacity: str | None
) -> None:
    (rect,) = parsed(Scene(2, 2, (Rect(0, 0, 2, 2, color),))).iter(f"{SVG}rect")
    assert (rect.get("fill"), rect.get("fill-opacity")) == (fill, opacity)


@pytest.mark.parametrize(
    ("value", "text"),
    [(1.0, "1"), (-0.001, "0"), (0.125, "0.12"), (10.0, "10"), (-2.5, "-2.5"), (100, "100")],
)
def test_numbers_are_short(value: float, text: str) -> None:
    assert number(value) == text


def test_a_path_of_many_lines_is_written_as_steps_to_the_same_places() -> None:
    corners = [(math.sin(place) * 500, math.cos(place) * 500) for place in range(2000)]
    commands: list[Command] = []
    for line in zip(corners[::3], corners[1::3], corners[2::3], strict=False):
        commands += [*polyline(line), ("Z", ())]
    x = y = 0.0
    start, places = (x, y), []
    for letter, rest in re.findall("([mlz])([^mlz]*)", path_data(tuple(commands))):
        if letter == "z":
            x, y = start
            continue
        dx, dy = map(float, re.findall(r"-?[\d.]+", rest))
        x, y = x + dx, y + dy
        start = (x, y) if letter == "m" else start
        places.append((x, y))
    assert places == [pytest.approx(at, abs=0.006) for _, at in commands if at]


@pytest.mark.slow
def test_painting_svg_loads_neither_numpy_nor_pillow() -> None:
    code = (
        "import sys\n"
        "from babyrobot_levels.library.level import Level\n"
        "from babyrobot_levels.render.svg import to_svg\n"
        "from babyrobot_levels.render.scene.build import build_scene\n"
        "to_svg(build_scene(Level.from_fields({'version': 1, 'maze': {'seed': 1}})))\n"
        "print(sorted({'numpy', 'PIL', 'gymnasium', 'ipycanvas'} & sys.modules.keys()))\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
