"""Files that commands write: what a line says of them, and the mark of those of `preview`."""

from __future__ import annotations

import re
import struct
import zlib
from collections.abc import Callable

_PNG, _GIF = b"\x89PNG\r\n\x1a\n", b"GIF89a"
_SVG_SIZE = re.compile(rb'<svg [^>]*?width="([\d.]+)" height="([\d.]+)"')


def facts_of(data: bytes) -> str:
    """Return the size of a file: the pixels of a picture, and the bytes."""
    size = _pixels(data)
    shown = _in_bytes(len(data))
    return f"{size[0]:g} × {size[1]:g}, {shown}" if size else shown


def _pixels(data: bytes) -> tuple[float, float] | None:
    """Return width and height of a picture; None for other files."""
    if data.startswith(_PNG):
        width, height = struct.unpack(">II", data[16:24])
        return width, height
    if data.startswith(_GIF):
        width, height = struct.unpack("<HH", data[6:10])
        return width, height
    found = _SVG_SIZE.match(data)
    return (round(float(found[1])), round(float(found[2]))) if found else None


def _in_bytes(count: int) -> str:
    if count < 1000:
        return "1 byte" if count == 1 else f"{count} bytes"
    kilobytes = count / 1000
    if kilobytes < 999.5:
        return f"{kilobytes:.1f} KB" if kilobytes < 9.95 else f"{kilobytes:.0f} KB"
    return f"{kilobytes / 1000:.1f} MB"


def marked(data: bytes) -> bytes:
    """Return a picture or page with a comment that says what has made it, and a checksum.

    The same data give the same file. Drawings in text have no comments, and stay as they are.
    """
    body, end, comment = _parts(data)
    return data if comment is None else body + comment(_mark_of(body)) + end


def is_own(data: bytes) -> bool:
    """Return whether `marked` has made a file, and nobody has changed it since."""
    body, end, comment = _parts(data)
    if comment is None:
        return False
    body = body[: -len(comment(_mark_of(b"")))]
    return data == body + comment(_mark_of(body)) + end


def _parts(data: bytes) -> tuple[bytes, bytes, Callable[[bytes], bytes] | None]:
    """Return a file as body and end, between which a comment stands, and how it is written."""
    for pattern, comment in _COMMENTS:
        if found := pattern.search(data, max(0, len(data) - _LONGEST_END)):
            return data[: found.start()], found[0], comment
    return data, b"", None


def _mark_of(body: bytes) -> bytes:
    return b"babyrobot preview %08x" % zlib.crc32(body)


def _in_xml(text: bytes) -> bytes:
    return b"<!-- " + text + b" -->\n"


def _in_png(text: bytes) -> bytes:
    chunk = b"tEXtSoftware\0" + text
    return struct.pack(">I", len(chunk) - 4) + chunk + struct.pack(">I", zlib.crc32(chunk))


def _in_gif(text: bytes) -> bytes:
    return b"\x21\xfe" + bytes([len(text)]) + text + b"\0"


def _in_pdf(text: bytes) -> bytes:
    return b"% " + text + b"\n"


_LONGEST_END = 64
_COMMENTS: tuple[tuple[re.Pattern[bytes], Callable[[bytes], bytes]], ...] = (
    (re.compile(rb"</(svg|html)>\n\Z"), _in_xml),
    (re.compile(rb"\x00{4}IEND\xaeB`\x82\Z"), _in_png),
    (re.compile(rb"startxref\n\d+\n%%EOF\n\Z"), _in_pdf),
    (re.compile(rb"\x3b\Z"), _in_gif),
)
"""The ends of files by format, and how a comment is written before them."""
