"""Share codes: a level as a line of text that survives chats, links and papers.

A code is `brl1.`, the number of characters that follow the next `.`, that `.`, and base64url
without padding. Its bytes are the CRC-32 of the packed data, four bytes, big-endian, and the packed
data: a raw deflate stream with a dictionary to begin with. What is packed is the level as JSON in
UTF-8: the fields of a level file, read and checked as a file is.

In a link, what a page needs to play the level may follow behind a `~`; it is no part of the code.
"""

from __future__ import annotations

import base64
import binascii
import json
import re
import zlib
from collections.abc import Mapping
from typing import Any

from babyrobot_levels.language.fields import Role, fields_with
from babyrobot_levels.text.errors import LevelError
from babyrobot_levels.text.files import source_of
from babyrobot_levels.text.source import MAX_BYTES, SourceFile

# All of version 1 that is in the world is read with these very bytes. A change, however small,
# would break it: other bytes need another version.
# What is likeliest stands last: the packer says in fewer bits what lies nearer.
DICTIONARY_1 = (
    # English, and what one says of grid worlds.
    " without between other others always never only again around inside outside behind above"
    " below first second third last next under middle corner centre edge side sides garden island"
    " river bridge tower castle castles lake water ice snow rain fire lava wind glass door doors"
    " key room rooms hole holes cliff trap traps goal treasure shortcut detour corridor hallway"
    " dead end dead ends loop loops branch crossing maze mazes labyrinth grid Gridworld world"
    " level levels north south east west northern southern eastern western left right top bottom"
    " wall walls open closed short shorter shortest long longer longest near far small large"
    " one two three four five six seven eight nine ten many few some every each all both more most"
    " find finds found go goes going take takes lead leads led walk walks come comes cross keep"
    " stay move moves step steps cost costs reward rewards puddle puddles slip slips slippery skid"
    " skids look solve learn best better good hard easy simple quick slow safe dry wet deep"
    " There The This Which Who What A An In On To Of It Baby Robot Frozen Lake Cliff Walking Windy"
    " is are was has have can cannot may must will with from into onto over through after before"
    " across away out up down not no than then when where which who how what why as at by for of"
    " on or in and but so that this these those its it he his them to be the a way the path the"
    " exit the start the robot of the in the to the on the and the is a of a with a"
    # Values of fields.
    '"#000000""#ffffff""red""green""blue""gold""orange""grey""white""black""lightblue"'
    '"black_orange""blue_green""high_contrast""print"'
    '"textbook","drawn","gymnasium","starts","looks","baby-robot","puddles","walls","maze"'
    " Sutton and Barto, Reinforcement Learning: An Introduction (2nd edition, 2018), Example "
    "Gymnasium 1.Steve Roberts, the Baby Robot articles (PyPI babyrobot 1.0.40)"
    "CC-BY-4.0MITApache-2.0BSD-3-ClauseCC0-1.0"
    # Drawings.
    "\\n+   +---+   +---+---+---+---+---+---+---+---+---+\\n| S |   |           | E |\\n"
    "+   +   +   +   +   +   +---+---+\\n|       |   | o   O |###|\\n"
    # Fields, as they stand in a level.
    '{"colors":{"base":"#","lines":"#","start":"#","start_text":"#","exit":"#","exit_text":"#",'
    '"border":"#","walls":"#","arrows":"#","text_bg":"#","text_fg":"#","blocked":"#",'
    '"puddle":"#","robot":"#"},"widths":{"padding":2,"walls":4,"border":5}}'
    '"algorithm":"depth-first","wilson","aldous-broder","kruskal","prim","growing-tree",'
    '"hunt-and-kill","recursive-division","binary-tree","sidewinder","eller","loops":0.'
    '"puddle_types":{"small":{"reward":-2,"skid":0.4},"large":{"reward":-4,"skid":0.6}},'
    '"wind":{"north":[0,0,0,1,1,1,2,2,1,0],"east":[0,"south":[0,"west":[0,'
    '"warps":[{"at":[0,0],"to":"start","when":"leave","reward":-100},{"at":[1,1],"to":[0,0]},'
    '"legend":{"~":{"color":"","reward":-1,"skid":{"probability":0.6666666666666666,'
    '"to":"sides"},"ends":true,"label":""}},"to":"others"},"to":"open"},'
    '"areas":[{"at":[1,0],"size":[1,1],"color":"","reward":-1,"skid":0.3,"ends":true,'
    '"blocked":[{"at":[0,0],"size":[2,1]},{"at":[1,1]},{"at":[2,2]}],'
    '"rewards":{"step":0,"exit":1,"bump":-1,"bounce":-1,"stay":0,"closer":0,"farther":0},'
    '"discount":0.9,"max_steps":100,"theme":"default","display":{"compass":true,'
    '"start_text":false,"exit_text":false,"coordinates":true,"bottom_panel":{"width":200,'
    '"color":"","text_color":""},"robot":{"show":false,"speed":2}}}'
    '{"version":1,"name":"","title":"The ","description":"\\n","author":"","license":"","source":'
    '"","tags":["maze","puddles"],"size":[10,10],"map":"+---","start":[0,0],"exit":"none",'
    '"exit":[[0,0],[7,7]],"maze":{"seed":"random"},"maze":{"seed":1},'
    '"walls":[{"at":[1,0],"side":"N","length":2,"pass":0.5,"color":"","width":2,"fit":true},'
    '{"at":[1,2],"side":"W"},{"at":[3,3],"side":"S"},{"at":[2,1],"side":"E"}],'
    '"openings":[{"at":[2,0],"side":"E"},{"at":[2,2],"side":"E"}],'
    '"puddles":[{"at":[4,4],"size":"large"},{"at":[1,2]},{"at":[2,2],"size":"small"}],'
    '"display":{"compass":true,"side_panel":200}}'
).encode("ascii")

PLAY_DICTIONARY_1 = (
    DICTIONARY_1
    # Directions and their values.
    + b"0.3333333333333333,0.6666666666666666,0.33333333333333337,0.33333333333333326,0.25,0.5,"
    b"0.19999999999999998,0.13333333333333333,0.09999999999999998,0.1,0.8,0.6,0.2,"
    b"],[0.2,-1,-1,0,4,10,0.2,1,-1,0,4,8,0.6,3,-1,0,1,4],[0.6,-1,-1,0,1,5,"
    b"1,0,1,5],[1,0,0,0,3,2],[1,1,0,1,1,3],[1,1,-1,1,1,3],[1,8,0,1,1,4],[1,0,-100,0,2,"
    b"[1,-1,-2,0,1,5],[1,1,-2,0,1,3],[1,1,-4,0,1,3],[1,-1,-4,0,1,5],"
    b'#1e1e1e","#707070","#007acc","#ff1d18","#cc5500","#cccccc","#282828d9",'
    b'#beb8eb","#1b3a5c","#5e5c6c","#5299d3","#ffffff","#0b5563","#4a5568","#38699d"],'
    # Pictures: puddles, blocked cells, labels, arrows.
    b'[3,3,320,590,"START",110,1,1]]],[1950,1950,[[3,3,320,590,"EXIT",110,1,1]]],'
    b',[2,5,"s604 320-34 121-122 65-128-16-110-10-134-41-24-119 79-91 78-71 111-40 123 24",22],'
    b'[4,6,943,320,320],[4,3,740,320,320,16],[2,-1,"m188 325c10-69 52-108 127-115",75,3,24,1],'
    b'[1,3,405,390,21,16,70]]],[670,30,[[1,6,114,377,34,29],[1,6,129,246,22,18],[2,5,"s466 320,22],'
    b'[4,6,943,320,320],[4,3,740,320,320,16],[2,-1,"m242 323c5-41 30-64 75-69",75,3,14,1],'
    b"[1,3,370,362,13,10,70]]],[0,6,0,0,1280,640],[0,7,0,0,640,640],[0,3,0,0,1280,30,22],"
    b"[0,5,0,610,1280,30,30]]],[0,4,0,0,640,640],[1,5,240,450,90,24,25],"
    b"m357 189c0 20-16 37-37 37c-21 0-37-17-37-37c0-21 16-37 37-37c21 0 37 16 37 37zm-37-37l0-38"
    b"m37 75l37 0m-74 37l0 37m-37-74l-37 0m759 56"
    b"c0 25-20 45-45 45c-25 0-45-20-45-45c0-25 20-45 45-45c25 0 45 20 45 45zm-45-45l0-45m685 90"
    b"m320 335l90 0m550 0l90 0m-90 0l0 90m-1370 550l0 90m640-90l0-90m730 90l-90 0m-550 0l-90 0m"
    b"m320 40l45 74l-90 0zm194 75l-75 44l0-89zm-74 194l-45-75l90 0zm-194-74l75-45l0 89zm"
    b'320 425l-54-90l108 0zm320 245l54 90l-108 0zm766-90l-90 54l0-108zm730 54l-90-54l90-54z",30,'
    b'",30,6,96,1],[2,-1,"m",30,5,64],[2,-1,"m",100,3,72,1],[2,-1,"m",100,3,40],[2,-1,"m320 245'
    b"l0 640m640-640l0 640m-640 0l640 0m0-640l640 0m-1280 640l1280 0m-1920 640l0 1280l640 0l0-640"
    # From the first field to the last.
    b'{"title":"","description":"","facts":[["Level","maze"],["Size","8 \xc3\x97 5"],["Author","'
    b'"],["Source","Sutton and Barto, Gymnasium 1.4, Steve Roberts, the Baby Robot articles (PyPI '
    b'babyrobot 1.0.40)"],["License","MIT"],["Time limit","100 steps"],["Digest","sha256:"]],'
    b'"width":8,"height":5,"margin":3,"speed":1,"starts":[0],"exits":[8],"max_steps":null,"rows":'
    b"[[1,0,-1,0,0,0],[1,0,-1,0,3,2],[1,1,-1,0,1,3],[1,3,-1,0,1,4],[1,0,-1,0,3,5],[1,0,-1,0,3,3],"
    b'[1,0,-1,0,3,4],[1,-1,-1,0,1,5],[1,-3,-1,0,1,2]],"table":[0,1,2,3,4,0,1,2,3,8,0,1,5,6,8,'
    b'0,9,2,6,8,-1,-1,-1,-1,-1],"possible":[13,21,23,29,25,15,11,7,27,19,5,17,9,31,27,15,7,23,1],'
    b'"robot":["#586370","#1f63b0"],"picture":{"width":198,"height":198,"layers":{"base":[[30,30,'
    b'[[0,0,0,0,1920,1920]]],[30,670,[[2,-1,"m20 0l1880 0m-1880 640l1880 0m-1260-1260l0 1880'
    b'm640-1880l0 1880",100,1,10,0,40,40]]],[30,30,[[0,2,0,0,640,640],[1,3,320,430,200,60,25],'
    b"[1,3,320,430,120,36,35]]],[1310,1310,[[0,4,0,0,640,640],[1,5,240,450,90,24,25],"
    b'[2,-1,"m240 100l0 350",100,3,30,1],[2,3,"m250 110c60-40 120 50 200 20l0 150'
    b'c-80 30-140-60-200-20z"]]]],"grid":[[30,30,[[3,3,320,590,"START",110,1,1]]],[1310,1310,'
    b'[[3,3,320,590,"EXIT",110,1,1]]],[670,30,[[2,-1,"m640 0l0 640m",100,5,40,1]]],'
    b'[30,30,[[2,-1,"m0 0l1920 0m-1920 1920l1920 0m-1920-1920l0 1920m1920-1920l0 1920",100,5,50,1]'
    b']]],"policy":[],"values":[[30,30,[[0,7,188,358,264,130,100,65],[3,3,320,458,"-2",104,1,1]]],'
    b'[670,30,[[0,7,158,470,324,130,100,65],[3,3,320,571,"0.82",104,1,1]]],[1310,670,'
    b'[[0,7,128,470,385,130,100,65],[3,3,320,571,"-3.25",104,1,1]]],[1950,30,'
    b'[[0,8,143,470,354,130,100,65],[3,3,320,571,"-12",104,1,1]]],[2590,1310,'
    b'[[0,8,188,470,264,130,100,65],[3,3,320,571,"-1",104,1,1]]],[30,1950,'
    b'[[0,8,188,470,264,130,100,65],[3,3,320,571,"0",104,1,1]]]]},"palette":["#ffa500","#777777",'
    b'"#ed1818","#ffffff","#008000","#000000","#1f63b0","#00008b","#3c3c3cb2"]},"seed":"0",'
    b'"walker":"best","shown":[],"policy":[2,3,4,1,3,3,2,2,1,4,-1],"best":"\xe2\x88\x92"}'
)


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
    version = int(code[3 : code.index(".")])
    if version != VERSION:
        raise LevelError(
            message=f"the share code is of version {version}, and this babyrobot-levels reads "
            f"version {VERSION}: a newer one may read it"
        )
    parts = _PARTS.fullmatch(code)
    if parts is None:
        is_cut = re.fullmatch("[0-9]*", code.partition(".")[2])
        raise _cut_off("hardly anything of it is there") if is_cut else _damaged("it has no length")
    length, body = int(parts[2]), parts[3]
    foreign = _FOREIGN.search(body)
    if foreign:
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
