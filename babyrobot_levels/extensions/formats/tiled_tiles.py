"""Tiles: layers of them, as lists or packed texts, and tilesets, which give each tile its class."""

import base64
import struct
import zlib
from bisect import bisect_right
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from babyrobot_levels.extensions.formats.conversion import (
    ConversionError,
    Lost,
    integer,
    mapping,
    read_data,
    sequence,
    shown,
)
from babyrobot_levels.extensions.formats.places import route_of
from babyrobot_levels.extensions.formats.tmx import data_of
from babyrobot_levels.language.base import MAX_SIZE
from babyrobot_levels.text.diagnostics import one_line
from babyrobot_levels.text.errors import LevelError
from babyrobot_levels.text.files import read_source
from babyrobot_levels.text.words import listed

MAX_TILES = 4 * MAX_SIZE**2
"""As many tiles as four layers of the largest map have."""

FAR = 1_000_000
"""The largest distance of a chunk of an infinite map from the origin."""

FLIPS = 0x0FFFFFFF
"""The bits of a tile's number without those for flipping."""

_BYTES = 4
_WINDOWS = {"zlib": zlib.MAX_WBITS, "gzip": zlib.MAX_WBITS | 16}
_HINT = "set the map's Tile Layer Format to CSV, and save it again"


CLASSES = ("start", "exit", "small-puddle", "large-puddle", "blocked")
"""The classes by which tiles say what they are, in the order of the tileset."""

MAX_FILES = 16
"""How many files a map may name: tilesets and templates."""

_EMBED = "`tiled --embed-tilesets --export-map MAP NEW.tmj` writes a map that holds it"


@dataclass(frozen=True, slots=True)
class TileLayer:
    """A layer of known size whose tiles have not been unpacked yet.

    Attributes:
        where: its name in messages.
        chunks: its rectangles (left, top, width, height), each with its tiles as in the file.
        compression: the compression of tiles that are texts; empty for none.
    """

    where: str
    chunks: tuple[tuple[int, int, int, int, Any], ...]
    compression: str

    @property
    def count(self) -> int:
        """The number of tiles, including empty ones."""
        return sum(width * height for _, _, width, height, _ in self.chunks)

    def placed(self) -> Iterator[tuple[int, int, int]]:
        """Yield x, y and the number of each tile that is not empty.

        Raises:
            ConversionError: their number is wrong, or they cannot be unpacked.
        """
        for left, top, width, height, data in self.chunks:
            for place, number in enumerate(self._numbers(data, width * height)):
                if number:
                    yield left + place % width, top + place // width, number & FLIPS

    def _numbers(self, data: Any, count: int) -> Sequence[int]:
        if isinstance(data, str):
            return self._unpacked(data, count)
        numbers = [integer(each, self.where) for each in sequence(data, self.where)]
        if len(numbers) != count:
            raise ConversionError(f"{self.where} has {len(numbers)} tiles, not {count}")
        return numbers

    def _unpacked(self, text: str, count: int) -> Sequence[int]:
        is_whole = True
        try:
            data = base64.b64decode(text, validate=True)
            if self.compression:
                packed = zlib.decompressobj(_WINDOWS[self.compression])
                # One byte more than expected, to notice that there is more.
                data = packed.decompress(data, count * _BYTES + 1)
                is_whole = packed.eof or len(data) > count * _BYTES
        except (ValueError, zlib.error):
            kind = self.compression or "base64"
            raise ConversionError(f"{self.where} is packed, but not with {kind}", _HINT) from None
        if not is_whole:
            raise ConversionError(f"{self.where} is cut off", _HINT)
        if len(data) != count * _BYTES:
            more = "more" if len(data) > count * _BYTES else "fewer"
            raise ConversionError(f"{self.where} has {more} than {count} tiles")
        # Least significant byte first, whatever this machine's order is.
        return struct.unpack(f"<{count}I", data)


def tile_layer(layer: dict[str, Any], where: str, size: tuple[int, int] | None) -> TileLayer:
    """Return a layer of tiles.

    Args:
        layer: as the map has it.
        where: what messages call it.
        size: of the map, None if it is infinite.

    Raises:
        ConversionError: its compression is unknown, or it is too large.
    """
    compression = layer.get("compression") or ""
    if compression not in ("", *_WINDOWS):
        known = "CSV, or packed with zlib or gzip"
        raise ConversionError(f"{where} is packed with {shown(compression)}, not {known}", _HINT)
    if size is not None:
        return TileLayer(where, ((0, 0, *size, layer.get("data")),), compression)
    chunks = []
    for index, entry in enumerate(sequence(layer.get("chunks"), f"{where}, chunks")):
        chunk, name = mapping(entry, f"{where}, chunk {index}"), f"{where}, chunk {index}"
        x, y, width, height = (
            integer(chunk.get(key), f"{name}, {key}") for key in ("x", "y", "width", "height")
        )
        if max(abs(x), abs(y)) > FAR:
            raise ConversionError(f"{name} is more than {FAR:,} cells away")
        if not (1 <= width <= MAX_SIZE and 1 <= height <= MAX_SIZE):
            raise ConversionError(f"{name} must be 1 to {MAX_SIZE} cells wide and high")
        chunks.append((x, y, width, height, chunk.get("data")))
    return TileLayer(where, tuple(chunks), compression)


# -- files beside the map --------------------------------------------------------------------

_SUFFIXES = {"tileset": (".tsx", ".tsj", ".json"), "template": (".tx", ".tj", ".json")}


class Beside:
    """The files that a map names, in its folder or below it: a few, each of which is read once."""

    def __init__(self, folder: Path | None):
        """Take the folder of the map, None to read no files."""
        self._folder = folder
        self._read: dict[str, dict[str, Any] | str] = {}

    def data(self, name: Any, kind: str) -> dict[str, Any] | str:
        """Return what a file holds, or why it is not read.

        Args:
            name: its name in the map.
            kind: what it is: `tileset` or `template`.

        Raises:
            ConversionError: it is malformed.
        """
        if self._folder is None or not isinstance(name, str):
            return "is a file of its own"
        if name not in self._read and len(self._read) == MAX_FILES:
            return f"is one of more than {MAX_FILES} files"
        if name not in self._read:
            self._read[name] = self._data(self._folder, name, kind)
        return self._read[name]

    def _data(self, folder: Path, name: str, kind: str) -> dict[str, Any] | str:
        try:
            home, path = folder.resolve(), (folder / name).resolve()
            if not path.is_relative_to(home):
                return "is outside the map's folder, and is not read"
            if path.suffix.lower() not in _SUFFIXES[kind]:
                return f"has none of the suffixes {listed(_SUFFIXES[kind])}"
            found = read_source(path, str(path.relative_to(home)))
        except LevelError as error:
            return f"cannot be read: {error.diagnostics[0].message}"
        except (OSError, ValueError):
            return "is not a valid file name"
        is_json = not path.suffix.lower().endswith("x")
        return mapping(read_data(found), one_line(name)) if is_json else data_of(found, kind)


# -- tilesets --------------------------------------------------------------------------------


class Tilesets:
    """The tilesets of a map.

    Attributes:
        lost: those that are not read.
    """

    def __init__(self, entries: Any, beside: Beside):
        """Read them.

        Args:
            entries: the map's `tilesets`.
            beside: the files beside the map.

        Raises:
            ConversionError: one of them is malformed.
        """
        self.lost: list[Lost] = []
        self._beside = beside
        found = sorted(self._read(entries), key=lambda entry: entry[0])
        self._firsts = [first for first, _ in found]
        self._classes = [classes for _, classes in found]

    def class_of(self, number: int) -> str | None:
        """Return the class of a tile by its number in the map, if it is one of ours."""
        index = bisect_right(self._firsts, number) - 1
        return self._classes[index].get(number - self._firsts[index]) if index >= 0 else None

    def _read(self, entries: Any) -> Iterator[tuple[int, dict[int, str]]]:
        for index, entry in enumerate(sequence(entries, "tilesets")):
            where = f"tilesets[{index}]"
            tileset = mapping(entry, where)
            first = integer(tileset.get("firstgid"), f"{where}.firstgid")
            if "source" in tileset:
                yield first, self._from_file(tileset["source"], where)
            else:
                yield first, _classes(tileset, where)

    def _from_file(self, name: Any, where: str) -> dict[int, str]:
        """Return the classes of a tileset in a file, none if it is not read."""
        found = self._beside.data(name, "tileset")
        if isinstance(found, str):
            self.lost.append(Lost(where, f"{shown(name)} {found}; {_EMBED}", route_of(where)))
            return {}
        return _classes(found, one_line(name))


def _classes(tileset: dict[str, Any], where: str) -> dict[int, str]:
    """Return the classes of the tiles of a tileset in JSON, by their numbers in it."""
    classes = {}
    for tile in sequence(tileset.get("tiles", []), f"{where}.tiles"):
        given = mapping(tile, f"{where}.tiles")
        if (name := given.get("class") or given.get("type")) in CLASSES:
            number = integer(given.get("id"), f"{where}: id")
            if number < 0:
                raise ConversionError(f"{where}: id must be a whole number from 0, not {number}")
            classes[number] = str(name)
    return classes
