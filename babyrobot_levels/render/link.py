"""Links that play: what a page needs of a level, as a text that stands behind its share code.

The play part is `~1.`, the number of characters that follow the next `.`, that `.`, and base64url
without padding. Its bytes are a CRC-32 of the share code and of the packed data, four bytes,
big-endian, and the packed data: a raw deflate stream with a dictionary to begin with. What is
packed is the data of a page as JSON in UTF-8.
"""

from __future__ import annotations

import base64
import json
import zlib
from typing import TYPE_CHECKING

from babyrobot_levels.language.share_code import PLAY_MARK, encode
from babyrobot_levels.language.share_dictionary import PLAY_DICTIONARY_1
from babyrobot_levels.render.pagedata import Guide, TooLargeError, page_data

if TYPE_CHECKING:
    from babyrobot_levels.mdp.gridworld import GridWorld

PLAY_VERSION = 1
"""The version of play parts: a page reads those of its own."""

MAX_LINK = 30_000
"""The most characters of a link behind its `#`: what browsers and chats take without harm."""

MAX_UNPACKED = 4 << 20
"""The most bytes that a page unpacks."""


def link_fragment(level: GridWorld, game: GridWorld, guide: Guide | None = None) -> str:
    """Return what stands behind the `#` of a link: a share code, and what a page plays.

    Args:
        level: the level that the code is of.
        game: the same level with its maze grown, if that is random.
        guide: the best that can be done, if it is known.

    Raises:
        LevelError: the level is larger than a level file may be.
        TooLargeError: the level is too large for a link.
    """
    code = encode(level.to_dict(whole=True))
    told = json.dumps(
        page_data(game, guide=guide), ensure_ascii=False, separators=(",", ":"), allow_nan=False
    )
    data = told.encode("utf-8")
    if len(data) > MAX_UNPACKED:
        raise TooLargeError(
            f"the level is too large for a link: a page would unpack {len(data):,} bytes, "
            f"and takes at most {MAX_UNPACKED:,}"
        )
    packer = zlib.compressobj(9, zlib.DEFLATED, -zlib.MAX_WBITS, 9, zdict=PLAY_DICTIONARY_1)
    packed = packer.compress(data) + packer.flush()
    checksum = zlib.crc32(packed, zlib.crc32(code.encode("ascii")))
    body = base64.urlsafe_b64encode(checksum.to_bytes(4, "big") + packed).decode().rstrip("=")
    fragment = f"{code}{PLAY_MARK}{PLAY_VERSION}.{len(body)}.{body}"
    if len(fragment) > MAX_LINK:
        raise TooLargeError(
            f"the level is too large for a link: {len(fragment):,} characters, "
            f"of at most {MAX_LINK:,}"
        )
    return fragment
