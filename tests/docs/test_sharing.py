"""The page on sharing: codes can be read as it says."""

from __future__ import annotations

import base64
import zlib

import babyrobot_levels as brl
from babyrobot_levels.language.share_code import DICTIONARY_1
from babyrobot_levels.library.level import load_code


def test_a_reader_without_dictionaries_can_use_a_stored_block() -> None:
    code = brl.load("final-maze").share_code()
    body = code.split(".")[2]
    stream = base64.urlsafe_b64decode(body + "=" * (-len(body) % 4))[4:]
    size = len(DICTIONARY_1)
    head = b"\0" + size.to_bytes(2, "little") + (size ^ 0xFFFF).to_bytes(2, "little")
    data = zlib.decompress(head + DICTIONARY_1 + stream, -15)[size:]
    assert brl.loads(data.decode()).digest == load_code(code).digest
