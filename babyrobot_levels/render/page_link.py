"""The play part of a link, with which a page plays the level of the link.

It follows the share code of the level. It is `~1.` (`~2.` for a level with things
or a heading), the number of characters after the next `.`, that `.`, and base64url without
padding. Its bytes are a CRC-32 of the share code and of the packed data (four bytes, big-endian)
and the packed data: the page's data as JSON in UTF-8, as a raw deflate stream with a preset
dictionary.
"""

from __future__ import annotations

import base64
import json
import zlib
from typing import Any

from babyrobot_levels.language.share_code import PLAY_DICTIONARY_1, PLAY_MARK
from babyrobot_levels.render.page_format import TooLargeError

PLAY_VERSIONS = (1, 2)
"""The versions of play parts that a page reads: 2 is for levels with things or a heading."""

MAX_UNPACKED = 4 << 20
"""The most bytes that a page decompresses."""


def play_fragment(code: str, content: dict[str, Any]) -> str:
    """Return the part of a link after its `#`, however long.

    Args:
        code: the level's share code.
        content: the page's data of the level.

    Raises:
        TooLargeError: a page would not decompress so much data.
    """
    version = PLAY_VERSIONS["things" in content or "turns" in content]
    text = json.dumps(content, ensure_ascii=False, separators=(",", ":"), allow_nan=False)
    data = text.encode("utf-8")
    if len(data) > MAX_UNPACKED:
        raise TooLargeError(
            f"the level is too large for a link: its data has {len(data):,} bytes, "
            f"and the limit is {MAX_UNPACKED:,}"
        )
    packed = _deflated(data, PLAY_DICTIONARY_1)
    checksum = zlib.crc32(packed, zlib.crc32(code.encode("ascii")))
    body = _base64url(checksum.to_bytes(4, "big") + packed)
    return f"{code}{PLAY_MARK}{version}.{len(body)}.{body}"


def _deflated(data: bytes, dictionary: bytes = b"") -> bytes:
    packer = zlib.compressobj(9, zlib.DEFLATED, -zlib.MAX_WBITS, 9, zdict=dictionary)
    return packer.compress(data) + packer.flush()


def _base64url(data: bytes) -> str:
    return base64.urlsafe_b64encode(data).decode().rstrip("=")


DICTIONARY = _base64url(_deflated(PLAY_DICTIONARY_1))
"""The preset dictionary of deflated data, as pages have it."""
