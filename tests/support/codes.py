"""Share codes made by hand: with whatever data, and with the right checksum for them."""

from __future__ import annotations

import base64
import zlib

from babyrobot_levels.share_dictionary import DICTIONARY_1


def packed(data: bytes) -> bytes:
    """Return data as a code's deflate stream."""
    packer = zlib.compressobj(9, zlib.DEFLATED, -15, 9, zdict=DICTIONARY_1)
    return packer.compress(data) + packer.flush()


def sealed(stream: bytes) -> str:
    """Return the code around a stream of bytes, whatever they are."""
    data = zlib.crc32(stream).to_bytes(4, "big") + stream
    body = base64.urlsafe_b64encode(data).decode().rstrip("=")
    return f"brl1.{len(body)}.{body}"


def code_of(data: bytes) -> str:
    """Return the code whose packed data are these bytes."""
    return sealed(packed(data))
