"""Share codes: a level as a line of text that survives chats, links and papers.

A code is `brl1.`, the number of characters that follow the next `.`, that `.`, and base64url
without padding. Its bytes are the CRC-32 of the packed data, four bytes, big-endian, and the packed
data: a raw deflate stream with a dictionary to begin with. What is packed is the level as JSON in
UTF-8: the fields of a level file, read and checked as a file is.

In a link, what a page needs to play the level may follow behind a `~`; it is no part of the code.
"""

import base64
import binascii
import json
import re
import zlib
from collections.abc import Mapping
from itertools import chain
from pathlib import Path
from typing import Any

from babyrobot_levels.language.fields import Role, fields_with
from babyrobot_levels.text.errors import LevelError
from babyrobot_levels.text.files import source_of
from babyrobot_levels.text.source import MAX_BYTES, SourceFile

# All of version 1 that is in the world is read with these very bytes. A change, however small,
# would break it: other bytes need another version.
# What is likeliest stands last: the packer says in fewer bits what lies nearer.
_TEXTS = json.loads(Path(__file__).with_suffix(".json").read_text("utf-8"))
DICTIONARY_1, _OF_PLAY = (
    "".join(chain(*_TEXTS[part].values())).encode("utf-8") for part in ("level", "play")
)
PLAY_DICTIONARY_1 = DICTIONARY_1 + _OF_PLAY

VERSION = 1
PREFIX = f"brl{VERSION}."
MAX_CHARACTERS = 2 * MAX_BYTES
"""The most characters of a code: those of the largest level are fewer."""

PLAY_MARK = "~"
"""What stands between a code and the play part of a link."""

_CODE = re.compile(r"\s*(?:[^\s#]+#)?(brl[0-9]{1,9}\..*)", re.DOTALL | re.IGNORECASE)
_IS_FILE = re.compile(r"\.ya?ml\s*\Z")
_PARTS = re.compile(r"brl([0-9]+)\.([0-9]{1,9})\.(.*)", re.IGNORECASE)
_FOREIGN = re.compile(r"[^A-Za-z0-9_-]")
_PLAY_PART = re.compile(rf"(?:{PLAY_MARK}|%7E).*", re.IGNORECASE)
_CHECKSUM_BYTES = 4
_NOT_IN_YAML = re.compile("[\x7f-\xa0\u2028\u2029\ufeff\ufffe\uffff]")
"""Characters that JSON takes as they are, but YAML does not."""


def is_code(text: str) -> bool:
    """Tell whether a text is meant as a share code, or as a link that ends in one."""
    return _CODE.fullmatch(text) is not None and _IS_FILE.search(text) is None


def encode(fields: Mapping[str, Any]) -> str:
    """Return the code of a level's fields: one line of letters, digits, `.`, `_` and `-`.

    What the level states of itself in `expect` is no part of it.

    Raises:
        LevelError: the level is larger than a level file may be.
    """
    unstated = fields_with(Role.EXPECTATION)
    data = _json({k: v for k, v in fields.items() if k not in unstated}).encode("utf-8")
    if len(data) > MAX_BYTES:
        raise LevelError(
            message=f"the level is too large for a share code: {len(data):,} bytes, "
            f"of at most {MAX_BYTES:,}"
        )
    packer = zlib.compressobj(9, zlib.DEFLATED, -zlib.MAX_WBITS, 9, zdict=DICTIONARY_1)
    packed = packer.compress(data) + packer.flush()
    body = _base64(_checksum(packed) + packed)
    return f"{PREFIX}{len(body)}.{body}"


def decode(text: str) -> SourceFile:
    """Return the level file, as JSON, of a code or of a link that ends in one.

    Whitespace does not count.

    Raises:
        LevelError: the code is damaged, cut off, or of an unknown version, or has too much.
    """
    match = _CODE.fullmatch(text)
    if match is None:
        raise LevelError(message=f"this is no share code; one begins with `{PREFIX}`")
    if len(text) > MAX_CHARACTERS:
        raise LevelError(message="the share code is longer than that of any level")
    data = _unpacked(_packed(_PLAY_PART.sub("", "".join(match[1].split()))))
    return source_of(data, "share code", is_made=True)


# -- the data ------------------------------------------------------------------------------


def _json(data: Mapping[str, Any]) -> str:
    """Return data as JSON that is YAML as well, each value in one form."""
    text = json.dumps(_short(data), ensure_ascii=False, separators=(",", ":"), allow_nan=False)
    return _NOT_IN_YAML.sub(lambda match: f"\\u{ord(match[0]):04x}", text)


def _short(value: Any) -> Any:
    """Return data with whole numbers written as such: 2 for 2.0."""
    if isinstance(value, Mapping):
        return {key: _short(inner) for key, inner in value.items()}
    if isinstance(value, list):
        return [_short(inner) for inner in value]
    if isinstance(value, float) and value.is_integer() and abs(value) < 1e15:
        return int(value)
    return value


# -- the bytes -----------------------------------------------------------------------------


def _packed(code: str) -> bytes:
    """Return the packed data of a code without blanks, checked."""
    if (version := int(code[3 : code.index(".")])) != VERSION:
        raise LevelError(
            message=f"the share code is of version {version}, and this babyrobot-levels reads "
            f"version {VERSION}: a newer one may read it"
        )
    parts = _PARTS.fullmatch(code)
    if parts is None:
        is_cut = re.fullmatch("[0-9]*", code.partition(".")[2])
        raise _cut_off("hardly anything of it is there") if is_cut else _damaged("it has no length")
    length, body = int(parts[2]), parts[3]
    if foreign := _FOREIGN.search(body):
        place = parts.start(3) + foreign.start() + 1
        raise _damaged(f"{foreign[0]!r}, its character {place}, cannot stand in one")
    if len(body) < length:
        missing = length - len(body)
        raise _cut_off(
            f"the last {missing:,} of its {len(code) + missing:,} characters are missing"
        )
    if len(body) > length:
        raise _damaged(f"there are {len(body) - length:,} characters too many")
    try:
        data = base64.urlsafe_b64decode(body + "=" * (-len(body) % 4))
    except binascii.Error:
        raise _damaged("its length is wrong") from None
    packed = data[_CHECKSUM_BYTES:]
    # Base64 can write the same bytes in several ways, of which one is right.
    if _checksum(packed) != data[:_CHECKSUM_BYTES] or _base64(data) != body:
        raise _damaged("its checksum is wrong (capital and small letters differ)")
    return packed


def _unpacked(packed: bytes) -> bytes:
    """Return the data that was packed: at most one byte more than a level may have."""
    unpacker = zlib.decompressobj(-zlib.MAX_WBITS, zdict=DICTIONARY_1)
    try:
        data = unpacker.decompress(packed, MAX_BYTES + 1)
    except zlib.error:
        raise _damaged("its data cannot be unpacked") from None
    if len(data) <= MAX_BYTES and (not unpacker.eof or unpacker.unused_data):
        raise _damaged("its data do not end where they should")
    return data


def _base64(data: bytes) -> str:
    return base64.urlsafe_b64encode(data).decode("ascii").rstrip("=")


def _checksum(data: bytes) -> bytes:
    return zlib.crc32(data).to_bytes(_CHECKSUM_BYTES, "big")


def _cut_off(why: str) -> LevelError:
    return LevelError(message=f"the share code is cut off: {why}")


def _damaged(why: str) -> LevelError:
    return LevelError(message=f"the share code is damaged: {why}")
