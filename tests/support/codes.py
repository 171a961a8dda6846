"""Codes and links made by hand: with whatever data, and with the right checksum for them."""

from __future__ import annotations

import base64
import json
import zlib
from typing import Any

from babyrobot_levels.language.share_code import DICTIONARY_1, PLAY_DICTIONARY_1


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


CODE = "brl1.24.R4BZv8Oakkoy8yqVkLIv0EYA"
"""Some code."""


def played(data: Any, code: str = CODE) -> str:
    """Return the fragment of a link whose page is to play these data."""
    told = json.dumps(data, ensure_ascii=False, separators=(",", ":")).encode()
    packer = zlib.compressobj(9, zlib.DEFLATED, -15, 9, zdict=PLAY_DICTIONARY_1)
    return play_sealed(packer.compress(told) + packer.flush(), code)


def play_sealed(stream: bytes, code: str = CODE) -> str:
    """Return the fragment of a link whose play part has a stream of bytes, whatever they are."""
    checksum = zlib.crc32(stream, zlib.crc32(code.encode()))
    body = base64.urlsafe_b64encode(checksum.to_bytes(4, "big") + stream).decode().rstrip("=")
    return f"{code}~1.{len(body)}.{body}"


def play_stream(link: str) -> bytes:
    """Return the play part's stream, its checksum tested."""
    code, part = link.partition("#")[2].split("~")
    version, length, body = part.split(".")
    assert version in ("1", "2")
    assert int(length) == len(body)
    data = base64.urlsafe_b64decode(body + "=" * (-len(body) % 4))
    assert int.from_bytes(data[:4], "big") == zlib.crc32(code.encode() + data[4:])
    return data[4:]


def play_data(link: str) -> Any:
    """Return what the page of a link plays."""
    return json.loads(
        zlib.decompressobj(-15, zdict=PLAY_DICTIONARY_1).decompress(play_stream(link))
    )
