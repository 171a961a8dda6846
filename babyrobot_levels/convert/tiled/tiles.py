"""Layers of tiles: lists of numbers or packed texts, whole or in chunks."""

from __future__ import annotations

import base64
import struct
import zlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from babyrobot_levels.convert.checked import integer, mapping, sequence
from babyrobot_levels.convert.conversion import ConversionError, shown
from babyrobot_levels.language.base import MAX_SIZE

MAX_TILES = 4 * MAX_SIZE**2
"""As many tiles as four layers of the largest map have."""

FAR = 1_000_000
"""No chunk of an infinite map lies farther from its origin."""

FLIPS = 0x0FFFFFFF
"""The bits of a tile's number that are left when those for flipping are gone."""

_BYTES = 4
_WINDOWS = {"zlib": zlib.MAX_WBITS, "gzip": zlib.MAX_WBITS | 16}
_HINT = "set the map's Tile Layer Format to CSV, and save it again"


@dataclass(frozen=True, slots=True)
class TileLayer:
    """A layer whose size is known, and whose tiles have not been looked at.

    Attributes:
        where: what messages call it.
        chunks: the rectangles that it is made of, each with its tiles as they are written.
        compression: how they are packed, if they are texts.
    """

    where: str
    chunks: tuple[tuple[int, int, int, int, Any], ...]
    compression: str

    @property
    def count(self) -> int:
        """How many tiles there are, empty ones as well."""
        return sum(width * height for _, _, width, height, _ in self.chunks)

    def placed(self) -> Iterator[tuple[int, int, int]]:
        """Yield x, y and the number of each tile that is not empty.

        Raises:
            ConversionError: they are not as many as they should be, or cannot be unpacked.
        """
        for left, top, width, height, data in self.chunks:
            numbers = self._numbers(data, width * height)
            for place, number in enumerate(numbers):
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
                # One byte more than there should be tells that there is more.
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
        ConversionError: it is packed in a way that is not known, or too large.
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
