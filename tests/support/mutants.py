"""Good files, broken at random: the same ones for the same seed."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from random import Random

from support.places import GALLERY_FOLDER
from support.reports import BAD, GOOD

GALLERY = sorted(path for path in GALLERY_FOLDER.rglob("*.yaml") if path.parent.name != "suites")

WHOLE, BROKEN = (
    [path.read_bytes() for path in paths if path.stat().st_size < 2000]
    for paths in ((*GOOD, *GALLERY), BAD)
)
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
    *(" #", ": ", "- ", "\n\t", "\n- ", "|\n  ", "\n  +---+\n  | S |\n"),
    *("9" * 50, "a" * 200, "[" * 80, "- " * 80, "{a: " * 80, "x, " * 300),
)
"""What is put into levels."""

CHANGES = ("byte", "cross", "delete", "insert", "move", "repeat", "word", "word", "word")


def mutated(rng: Random, data: bytes, words: Sequence[bytes], others: Sequence[bytes]) -> bytes:
    """Return bytes with one to three changes.

    Args:
        rng: decides.
        data: the bytes.
        words: what is put in.
        others: files with whose lines it may go on, as after a merge that went wrong.
    """
    for _ in range(rng.randint(1, 3)):
        first = rng.randint(0, len(data))
        last = min(len(data), first + rng.choice((1, 1, 2, 5, 20)))
        before, piece, behind = data[:first], data[first:last], data[last:]
        match rng.choice(CHANGES):
            case "byte":
                data = before + bytes([rng.randrange(256)]) + data[first + 1 :]
            case "cross":
                data = before + data[first:].partition(b"\n")[0] + b"\n" + _end(rng, others)
            case "delete":
                data = before + behind
            case "insert":
                data = before + rng.choice(words) + piece + behind
            case "move":
                data = before + behind
                goal = rng.randint(0, len(data))
                data = data[:goal] + piece + data[goal:]
            case "repeat":
                data = before + piece * rng.choice((2, 2, 3, 50)) + behind
            case _:
                # A number or a word becomes something else, so that the YAML stays whole.
                places = [each.span() for each in re.finditer(rb"-?[0-9.]+|[A-Za-z_-]+", data)]
                first, last = rng.choice(places or [(0, 0)])
                data = data[:first] + rng.choice(words) + data[last:]
    return data


def _end(rng: Random, others: Sequence[bytes]) -> bytes:
    lines = rng.choice(others).split(b"\n")
    return b"\n".join(lines[rng.randint(0, len(lines)) :])


def mutants(seed: int, count: int) -> Iterator[bytes]:
    """Yield mutants of levels. Bad files are among them: two faults together are another case."""
    rng, words = Random(seed), [word.encode() for word in WORDS]
    for _ in range(count):
        data = rng.choice(WHOLE if rng.random() < 0.75 else BROKEN)
        yield mutated(rng, data, words, [*WHOLE, *BROKEN])
