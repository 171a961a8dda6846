"""The formats of other programs: one entry each, and which one a text is in."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import PurePath
from typing import Any

from babyrobot_levels.convert import block_maps, frozen_lake, setups, tiled
from babyrobot_levels.convert.conversion import (
    Codec,
    Conversion,
    ConversionError,
    World,
    looks_like_data,
    read_data,
)
from babyrobot_levels.library.level import Level
from babyrobot_levels.text.source import SourceFile


@dataclass(frozen=True, slots=True)
class Format:
    """A format.

    Attributes:
        title: what one text is: "FrozenLake map".
        texts: what is read, for the help of the command line: "FrozenLake maps".
        codec: how it is read, written and recognised.
        suffixes: suffixes of files that are in this format, whatever they contain.
        written_suffixes: suffixes of files that levels are written to in this format.
        keywords: the keywords that reading takes: `slippery`, whether moves slip if the text does
            not say so, and `folder`, the folder of the file, of which others are read.
    """

    title: str
    texts: str
    codec: Codec
    suffixes: tuple[str, ...] = ()
    written_suffixes: tuple[str, ...] = ()
    keywords: tuple[str, ...] = ()

    @property
    def is_written(self) -> bool:
        """Whether levels are written in it."""
        return self.codec.write is not None

    def read(self, source: SourceFile, **given: Any) -> World:
        """Return the world of a text; of what is given, those that are not its keywords are left.

        Raises:
            ConversionError: the text is not in this format.
        """
        keywords = {name: each for name, each in given.items() if name in self.keywords}
        return self.codec.read(source, **keywords)

    def write(self, level: Level) -> Conversion:
        """Return a level in this format, without a check of what is lost; see `export`."""
        if self.codec.write is None:
            raise ValueError(f"levels are not written as a {self.title}")
        return self.codec.write(level)


FORMATS = {
    "babyrobot": Format(
        "keyword setup of PyPI babyrobot", "setups of PyPI babyrobot", setups.CODEC
    ),
    "frozen-lake": Format(
        "FrozenLake map", "FrozenLake maps", frozen_lake.CODEC, keywords=("slippery",)
    ),
    "maze-map": Format(
        "Gymnasium-Robotics maze_map", "Gymnasium-Robotics' maze maps", block_maps.MAZE_MAP
    ),
    "maze-dataset": Format("maze-dataset ASCII", "maze-dataset's ASCII", block_maps.MAZE_DATASET),
    "minigrid": Format("MiniGrid text", "MiniGrid's text", block_maps.MINIGRID),
    "sokoban": Format(
        "map of # and blanks",
        "Sokoban maps (# and blanks)",
        block_maps.SOKOBAN,
        suffixes=(".xsb", ".sok"),
    ),
    "tiled": Format(
        "Tiled map in JSON",
        "Tiled's JSON",
        tiled.CODEC,
        suffixes=(".tmj",),
        written_suffixes=(".tmj",),
        keywords=("folder",),
    ),
}
"""The formats by name. Of several that hold the same data, a later one is the more particular."""


def guess(source: SourceFile) -> list[str]:
    """Return the names of the formats that a text may be in, by its suffix or its content.

    Raises:
        ConversionError: it is blank, or looks like JSON or Python but is malformed.
    """
    suffix = PurePath(source.name).suffix.lower()
    by_suffix = [name for name, each in FORMATS.items() if suffix in each.suffixes]
    if by_suffix:
        return by_suffix
    letters = set(source.text) - set("\r\n")
    if not letters - {" "}:
        raise ConversionError("the text is blank")
    drawn = [name for name, each in FORMATS.items() if each.codec.draws(source, letters)]
    if drawn or not looks_like_data(source.text):
        return drawn
    data = read_data(source)
    return [name for name, each in FORMATS.items() if each.codec.holds(data)][-1:]
