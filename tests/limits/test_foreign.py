"""Hostile files of other programs: each is answered soon, in 500 MiB, in a few lines."""

from __future__ import annotations

import io
import json
import zlib
from base64 import b64encode
from collections.abc import Callable
from pathlib import Path
from zipfile import ZIP_DEFLATED, ZipFile

import pytest
from limits.test_limits import MEMORY, TIMES, Babyrobot, babyrobot, pytestmark
from support.combinations import swept
from support.hostile import MIB

__all__ = ["babyrobot", "pytestmark"]

MAZE = "o---o---o\n| S   G |\no---o---o\n"
LAUGHS = '<!DOCTYPE m [<!ENTITY a "ha">' + "".join(
    f'<!ENTITY {chr(98 + n)} "{f"&{chr(97 + n)};" * 10}">' for n in range(9)
)
OUTSIDE = '<!DOCTYPE m [<!ENTITY a SYSTEM "file:///etc/passwd">'
MAP = 'orientation="orthogonal" tilewidth="8" tileheight="8"'


def tmj(layers: list[object], width: int = 2, height: int = 2) -> str:
    """Return a map of Tiled."""
    tile = {"tilewidth": 8, "tileheight": 8, "tilesets": []}
    return json.dumps({"width": width, "height": height, **tile, "layers": layers})


def bomb() -> str:
    """Return a map whose layer unpacks to a gigabyte."""
    packer = zlib.compressobj(9)
    data = b"".join(packer.compress(bytes(MIB)) for _ in range(512)) + packer.flush()
    layer = {"type": "tilelayer", "encoding": "base64", "compression": "zlib"}
    return tmj([layer | {"data": b64encode(data).decode()}])


def zipped(name: str, data: bytes, times: int = 1) -> bytes:
    """Return a zip file with some files of the same content."""
    file = io.BytesIO()
    with ZipFile(file, "w", ZIP_DEFLATED) as archive:
        for number in range(times):
            archive.writestr(f"{number}{name}", data)
    return file.getvalue()


def scenarios(count: int) -> str:
    """Return a file of scenarios whose map is not there."""
    return "version 1\n" + "0 none.map 9 9 0 0 1 1 1\n" * count


def array(shape: str, kind: str = "<i8") -> bytes:
    """Return an array of NumPy without its data."""
    head = f"{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}, }}\n".encode()
    return b"\x93NUMPY\x01\x00" + len(head).to_bytes(2, "little") + head


MAKE: dict[str, Callable[[], str | bytes]] = {
    "deep.tmj": lambda: '{"layers":' + "[" * 900_000,
    "deep.tmx": lambda: f"<map {MAP}>" + "<group>" * 100_000,
    "deep.ldtk": lambda: '{"a":' * 100_000,
    "deep.map": lambda: "map_data: " + "{a: " * 100_000,
    "deep.py": lambda: "(" * 500_000,
    "minus.py": lambda: "x = " + "-" * 500_000 + "1",
    "digits.json": lambda: f'{{"desc": ["SG"], "success_rate": {"9" * 900_000}}}',
    "laughs.tmx": lambda: LAUGHS + f"]><map {MAP}><properties>&j;</properties></map>",
    "laughs.slc": lambda: LAUGHS + "]><SokobanLevels>&j;</SokobanLevels>",
    "outside.tmx": lambda: OUTSIDE + f"]><map {MAP}>&a;</map>",
    "alias.map": lambda: (
        "a: &a [x]\n"
        + "".join(f"b{n}: &b{n} [*a, *a, *a]\n" for n in range(30_000))
        + "map_data: x"
    ),
    "huge.tmx": lambda: f'<map {MAP} width="999999999" height="999999999"/>',
    "huge.map": lambda: "type octile\nheight 999999\nwidth 999999\nmap\n.\n",
    "huge.w": lambda: "Dimension: (999999, 999999)\nKarel: (1, 1); east\n",
    "huge.ldtk": lambda: json.dumps(
        {
            "jsonVersion": "1",
            "defs": {"layers": []},
            "levels": [{"layerInstances": [{"intGridCsv": [0], "__cWid": 10**9, "__cHei": 10**9}]}],
        }
    ),
    "huge.npy": lambda: array("(1000000000, 1000000000)"),
    "objects.npy": lambda: array("(2, 2)", "|O") + b"cos\nsystem\n(S'touch mark'\ntR.",
    "cut.npy": lambda: b"\x93NUMPY\x01\x00\xff\xff",
    "cut.maz": lambda: bytes(255),
    "huge.py": lambda: "setup = {'width': 10**9, 'walls': [((0, 0, 10**9), 'E')]}",
    "bomb.tmj": bomb,
    "far.tmj": lambda: json.dumps(
        json.loads(tmj([]))
        | {
            "infinite": True,
            "layers": [
                {
                    "type": "tilelayer",
                    "chunks": [
                        {"x": x, "y": x, "width": 1, "height": 1, "data": [1]}
                        for x in (-900_000, 900_000)
                    ],
                }
            ],
        }
    ),
    "runs.xsb": lambda: "1000000000#|#@.#|4#\n",
    "more-runs.xsb": lambda: "999999#\n" * 50_000,
    "zeros.xsb": lambda: "0" * 900_000 + "#@\n",
    "walls.xsb": lambda: "#" * 900_000,
    "maps.xsb": lambda: "####\n#@.#\n####\n\n" * 30_000,
    "posts.txt": lambda: "o---" * 100_000 + "o\n" + "o---" * 100_000 + "o\n",
    "tall.txt": lambda: "o---o\n| S |\n" * 80_000 + "o---o\n",
    "dungeon.txt": lambda: "WFD-" * 250_000,
    "lines.des": lambda: "MAZE: \"a\",' '\nMAP\n" + "...\n" * 200_000 + "ENDMAP\n",
    "places.des": lambda: (
        "MAZE: \"a\",' '\nMAP\n....\nENDMAP\n" + "BRANCH:(0,0,3,0),(0,0,0,0)\n" * 30_000
    ),
    "lines.scen": lambda: scenarios(30_000),
    "grids.json": lambda: json.dumps({"train": [{"input": [[0]]}] * 40_000, "test": []}),
    "objects.tmj": lambda: tmj([{"type": "objectgroup", "name": "o", "objects": [{}] * 100_000}]),
    "properties.tmj": lambda: json.dumps(
        json.loads(tmj([])) | {"properties": [{"name": "x"}] * 60_000}
    ),
    "keywords.json": lambda: json.dumps({"width": 2} | {f"x{n}": 0 for n in range(60_000)}),
    "zips.zip": lambda: zipped("a.zip", zipped("a.txt", MAZE.encode())),
    "bomb.zip": lambda: zipped("a.txt", bytes(300 * MIB)),
    "names.zip": lambda: zipped("a.txt", b"no maze", 30_000),
    "cut.zip": lambda: zipped("a.txt", MAZE.encode())[:-30],
}
"""Files by their names, which tell the format: deep, huge, cut off, packed, or with too much."""

FEW = ["deep.tmx", "laughs.tmx", "huge.map", "runs.xsb", "bomb.zip", "keywords.json", "objects.tmj"]


@pytest.mark.parametrize("name", swept(FEW, MAKE))
def test_hostile_files_are_bounded(name: str, tmp_path: Path, babyrobot: Babyrobot) -> None:
    made = MAKE[name]()
    path, folder = tmp_path / name, tmp_path / "levels"
    path.write_bytes(made.encode() if isinstance(made, str) else made)
    answer = babyrobot("import", str(path), "-o", str(folder))
    assert answer.status in (0, 1, 2), answer.err
    assert answer.cost < 2 * TIMES
    assert answer.memory < MEMORY
    assert "Traceback" not in answer.err
    assert len(answer.err.splitlines()) <= 45
    assert all(len(line) < 2_000 for line in answer.err.splitlines())
    assert {*tmp_path.iterdir()} <= {path, folder}
