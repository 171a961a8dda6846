"""Good level files, broken at random: the same ones for the same seed."""

from __future__ import annotations

import random
import re
from collections.abc import Callable, Iterator

from support.places import GALLERY_FOLDER
from support.reports import BAD, GOOD

GALLERY = sorted(path for path in GALLERY_FOLDER.rglob("*.yaml") if path.parent.name != "suites")

WHOLE, BROKEN = (
    [path.read_bytes() for path in paths if path.stat().st_size < 2000]
    for paths in ((*GOOD, *GALLERY), BAD)
)
PARENTS = [*WHOLE, *BROKEN]
"""What mutants are made of. Bad files are among them: two faults together are another case."""

_PLAIN = r"""
null ~ true no .nan -.inf 1e999 -0.0 0x1F 0o17 1_000 99999999999999999999 -1 1024 1025 0.1.2
[] {} [0,0] [[0,0]] {at:[0,0]} {?} none start random north N small large open sides others
default themes/x red #fff rgb(1,2,3) version: size: map: walls: start: exit: legend: maze: areas:
warps: wind: theme: display: rewards: skid: &a *a <<: !!str !!int !!binary !x ? : - | > |- >+2
--- ... %YAML %TAG # ' " \ @ ` , [ ] { } +---+ S E o O ### - ::error:: ]]> \u0000 \x1b
"""
_ODD = "\ufeff 迷路 🤖 e\u0301 \u200b \u202e \x00 \x1b[31m"
WORDS = (
    *_PLAIN.split(),
    *_ODD.split(" "),
    *("\n", "\n\n", "  ", "\t", "\r", "\r\n", "\u2028", "\x85", "\xa0"),
    *(" #", ": ", "- ", "|\n  ", "\n  +---+\n  | S |\n"),
    *("9" * 50, "a" * 200, "[" * 80, "- " * 80, "{a: " * 80, "x, " * 300),
)
"""What is put into them."""

Mutation = Callable[[random.Random, bytes], bytes]


def _delete(rng: random.Random, data: bytes) -> bytes:
    first, last = _stretch(rng, data)
    return data[:first] + data[last:]


def _insert(rng: random.Random, data: bytes) -> bytes:
    place = rng.randint(0, len(data))
    return data[:place] + rng.choice(WORDS).encode() + data[place:]


def _repeat(rng: random.Random, data: bytes) -> bytes:
    first, last = _stretch(rng, data)
    return data[:first] + data[first:last] * rng.choice((2, 2, 3, 50)) + data[last:]


def _change_byte(rng: random.Random, data: bytes) -> bytes:
    place = rng.randrange(len(data))
    return data[:place] + bytes([rng.randrange(256)]) + data[place + 1 :]


def _change_word(rng: random.Random, data: bytes) -> bytes:
    """Put something else in the place of a number or a word, so that the YAML stays whole."""
    found = list(re.finditer(rb"-?[0-9.]+|[A-Za-z_-]+", data))
    if not found:
        return data
    first, last = rng.choice(found).span()
    return data[:first] + rng.choice(WORDS).encode() + data[last:]


def _move_line(rng: random.Random, data: bytes) -> bytes:
    lines = data.split(b"\n")
    line = lines.pop(rng.randrange(len(lines)))
    lines.insert(rng.randint(0, len(lines)), line)
    return b"\n".join(lines)


def _indent_line(rng: random.Random, data: bytes) -> bytes:
    lines = data.split(b"\n")
    number = rng.randrange(len(lines))
    lines[number] = rng.choice((b" ", b"  ", b"\t", b"- ")) + lines[number]
    return b"\n".join(lines)


def _cross(rng: random.Random, data: bytes) -> bytes:
    """Go on with a line of another file, as a merge that went wrong does."""
    lines, other = data.split(b"\n"), rng.choice(PARENTS).split(b"\n")
    return b"\n".join(lines[: rng.randint(0, len(lines))] + other[rng.randint(0, len(other)) :])


def _encode(rng: random.Random, data: bytes) -> bytes:
    encoding = rng.choice(("utf-16", "utf-16-le", "latin-1", "utf-8-sig", "utf-7"))
    return data.decode("utf-8", "replace").encode(encoding, "replace")


COMMON: tuple[Mutation, ...] = (
    *(_delete, _insert, _repeat, _change_byte, _change_word, _change_word, _change_word),
    *(_move_line, _indent_line, _cross),
)


def mutants(seed: int, count: int) -> Iterator[bytes]:
    """Yield `count` files that were good once, each with one to three mutations."""
    rng = random.Random(seed)
    for _ in range(count):
        data = rng.choice(WHOLE if rng.random() < 0.75 else BROKEN)
        for _ in range(rng.randint(1, 3)):
            mutation = _encode if rng.random() < 0.01 else rng.choice(COMMON)
            data = mutation(rng, data or b"\n")
        yield data


def _stretch(rng: random.Random, data: bytes) -> tuple[int, int]:
    first = rng.randint(0, len(data))
    return first, min(len(data), first + rng.choice((1, 1, 2, 5, 20)))
