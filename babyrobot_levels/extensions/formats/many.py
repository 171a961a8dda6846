"""Many worlds of other programs as level files: those of folders, zip files and collections."""

import re
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import NamedTuple

from babyrobot_levels.extensions.formats.conversion import ConversionError, Lost, file_text
from babyrobot_levels.extensions.formats.reading import UnknownFormatError, worlds_of
from babyrobot_levels.extensions.formats.sources import Found
from babyrobot_levels.language.names import numbered
from babyrobot_levels.text.diagnostics import one_line
from babyrobot_levels.text.errors import LevelError


class Outcome(NamedTuple):
    """What became of a file.

    Attributes:
        name: what messages call it.
        texts: the texts of its levels, each with the path of its file, without a suffix.
        lost: what is not kept.
        refused: why worlds are refused, a line for each.
        is_unknown: whether it is in no known format.
    """

    name: str
    texts: tuple[tuple[Path, str], ...] = ()
    lost: tuple[Lost, ...] = ()
    refused: tuple[str, ...] = ()
    is_unknown: bool = False


def _outcome_of(chosen: str | None, slippery: bool | None, strict: bool, file: Found) -> Outcome:
    texts: list[tuple[Path, str]] = []
    lost: list[Lost] = []
    refused: list[str] = []
    try:
        for place, read in worlds_of(file, chosen, slippery):
            try:
                world = read()
                if strict and world.lost:
                    first = world.lost[0]
                    raise ConversionError(f"{first.place(file.name)}error: {first}")
                title = place.name.replace("-", " ").capitalize()
                texts.append((place, file_text(world, schema=None, name=None, title=title)))
                lost += world.lost
            except LevelError as error:
                refused.append(_reason(error))
    except UnknownFormatError as error:
        if not error.found:
            return Outcome(file.name, is_unknown=True)
        refused.append(_reason(error))
    except LevelError as error:
        is_binary = any(each.code == "BR102" for each in error.diagnostics)
        if is_binary and chosen is None:
            return Outcome(file.name, is_unknown=True)
        refused.append(_reason(error))
    return Outcome(file.name, tuple(texts), tuple(lost), tuple(refused))


def _reason(error: LevelError) -> str:
    """Return the message of an error in one line, without the text that it shows."""
    if error.diagnostics:
        return one_line(error.diagnostics[0].message)
    first, *others = str(error).split("\n")
    if first.endswith(":") and others:
        return one_line(f"{first} {others[0]}")
    helped = [line.removeprefix("  help: ") for line in others if line.startswith("  help: ")]
    return one_line(f"{first} ({helped[-1]})" if helped else first)


def losses(outcomes: Iterable[Outcome]) -> list[tuple[str, Lost]]:
    """Return what is not kept of many files: each kind once, with the first file it is lost in."""
    files: dict[tuple[str, str], list[str]] = {}
    first: dict[tuple[str, str], Lost] = {}
    for outcome in outcomes:
        for each in outcome.lost:
            # Numbers are of one level.
            kind = each.field, re.sub(r"\d+", "#", each.message)
            first.setdefault(kind, each)
            named = files.setdefault(kind, [])
            if outcome.name not in named[-1:]:
                named.append(outcome.name)
    return [
        (names[0], replace(first[kind], message=f"{first[kind].message}{_others(len(names))}"))
        for kind, names in files.items()
    ]


def _others(count: int) -> str:
    return f" (in {count} files)" if count > 1 else ""


def worker(
    chosen: str | None, slippery: bool | None, *, strict: bool
) -> Callable[[Found], Outcome]:
    """Return the function that converts a file; other processes can call it."""
    return partial(_outcome_of, chosen, slippery, strict)


def free_places(outcomes: Sequence[Outcome]) -> dict[Path, str]:
    """Return the texts of all levels by paths that differ, also where case does not count."""
    found: dict[Path, str] = {}
    taken: set[str] = set()
    for outcome in outcomes:
        for place, text in outcome.texts:
            places = map(place.with_name, numbered(place.name))
            free = next(each for each in places if str(each).casefold() not in taken)
            taken.add(str(free).casefold())
            found[free] = text
    return found
