"""Tilesets: what each tile is by its class, also in a file beside the map."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from xml.parsers import expat

from babyrobot_levels.convert.checked import integer, mapping, sequence
from babyrobot_levels.convert.conversion import ConversionError, Lost, shown
from babyrobot_levels.convert.data import MAX_DEPTH, read_data
from babyrobot_levels.text.diagnostics import one_line
from babyrobot_levels.text.errors import LevelError
from babyrobot_levels.text.files import read_source
from babyrobot_levels.text.source import SourceFile

CLASSES = ("start", "exit", "small-puddle", "large-puddle", "blocked")
"""The classes by which tiles say what they are, in the order of the tileset."""

MAX_FILES = 16
"""How many tilesets of a map may be files of their own."""

_EMBED = "`tiled --embed-tilesets --export-map MAP NEW.tmj` writes a map that holds it"


class Tilesets:
    """The tilesets of a map.

    Attributes:
        lost: those that could not be had.
    """

    def __init__(self, entries: Any, folder: Path | None):
        """Read them.

        Args:
            entries: the map's `tilesets`.
            folder: where the map lies: files of tilesets in it, or below it, are read. None to
                read no files.

        Raises:
            ConversionError: one of them is malformed.
        """
        self.lost: list[Lost] = []
        self._folder = folder
        self._files = 0
        found = sorted(self._read(entries), key=lambda entry: entry[0])
        self._firsts = [first for first, _ in found]
        self._classes = [classes for _, classes in found]

    def class_of(self, number: int) -> str | None:
        """Return the class of a tile by its number in the map, if it is one of ours."""
        index = bisect_right(self._firsts, number) - 1
        return self._classes[index].get(number - self._firsts[index]) if index >= 0 else None

    def _read(self, entries: Any) -> Iterator[tuple[int, dict[int, str]]]:
        for index, entry in enumerate(sequence(entries, "tilesets")):
            where = f"tilesets[{index}]"
            tileset = mapping(entry, where)
            first = integer(tileset.get("firstgid"), f"{where}.firstgid")
            if "source" in tileset:
                yield first, self._from_file(tileset["source"], where)
            else:
                yield first, _classes(tileset, where)

    def _from_file(self, name: Any, where: str) -> dict[int, str]:
        """Return the classes of a tileset in a file, none if it cannot be had."""
        found = self._file(name)
        if isinstance(found, str):
            self.lost.append(Lost(where, f"{shown(name)} {found}; {_EMBED}"))
            return {}
        if found.name.lower().endswith((".tsj", ".json")):
            return _classes(mapping(read_data(found), one_line(found.name)), one_line(found.name))
        return _xml_classes(found)

    def _file(self, name: Any) -> SourceFile | str:
        """Return the file of a tileset, or why it is not read."""
        if self._folder is None or not isinstance(name, str):
            return "is a file of its own"
        self._files += 1
        if self._files > MAX_FILES:
            return f"is one of more than {MAX_FILES} files"
        try:
            home, path = self._folder.resolve(), (self._folder / name).resolve()
            if not path.is_relative_to(home):
                return "lies outside the map's folder, and is not read"
            if path.suffix.lower() not in (".tsj", ".json", ".tsx"):
                return "is no tileset by its name (.tsx, .tsj or .json)"
            return read_source(path, str(path.relative_to(home)))
        except LevelError as fault:
            return f"is not read: {fault.diagnostics[0].message}"
        except (OSError, ValueError):
            return "is no name of a file"


def _classes(tileset: dict[str, Any], where: str) -> dict[int, str]:
    """Return the classes of the tiles of a tileset in JSON, by their numbers in it."""
    classes = {}
    for tile in sequence(tileset.get("tiles", []), f"{where}.tiles"):
        given = mapping(tile, f"{where}.tiles")
        name = given.get("class") or given.get("type")
        if name in CLASSES:
            classes[integer(given.get("id"), f"{where}.tiles.id")] = str(name)
    return classes


def _xml_classes(source: SourceFile) -> dict[int, str]:
    """Return the classes of the tiles of a tileset in XML.

    Raises:
        ConversionError: it is no such file, or declares something: entities may grow without end.
    """
    where = one_line(source.name)
    classes: dict[int, str] = {}
    path: list[str] = []

    def start(element: str, attributes: dict[str, str]) -> None:
        path.append(element)
        if path[0] != "tileset" or len(path) > MAX_DEPTH:
            raise ConversionError(f"{where} is no tileset of Tiled")
        name = attributes.get("class") or attributes.get("type")
        if path[1:] == ["tile"] and name in CLASSES:
            number = attributes.get("id", "")
            if not (number.isascii() and number.isdigit() and len(number) <= 9):
                raise ConversionError(f"{where}: id must be a whole number, not {shown(number)}")
            classes[int(number)] = name

    def end(_: str) -> None:
        path.pop()

    def declared(*_: object) -> None:
        raise ConversionError(f"{where} has a DOCTYPE, which no tileset of Tiled has")

    parser = expat.ParserCreate("utf-8")
    parser.StartElementHandler, parser.EndElementHandler = start, end
    parser.StartDoctypeDeclHandler = declared
    try:
        parser.Parse(source.text.encode("utf-8"), True)
    except expat.ExpatError as error:
        told = expat.ErrorString(error.code)
        raise ConversionError(f"{where}:{error.lineno}: this is no XML ({told})") from None
    return classes
