"""The formats of other programs: one entry each, and which one a text is in.

The entries are names and titles: what a format reads and writes is imported when it is used.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import PurePath
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from babyrobot_levels.convert.conversion import Codec, Conversion, World
    from babyrobot_levels.library.level import Level
    from babyrobot_levels.text.source import SourceFile


@dataclass(frozen=True, slots=True)
class Format:
    """A format.

    Attributes:
        title: what one text is: "FrozenLake map".
        texts: what is read, for the help of the command line: "FrozenLake maps".
        codec: returns how it is read, written and recognised.
        is_written: whether levels are written in it.
        suffixes: suffixes of files that are in this format, whatever they contain.
        written_suffixes: suffixes of files that levels are written to in this format.
        keywords: the keywords that reading takes: `slippery`, whether moves slip if the text does
            not say so, and `folder`, the folder of the file, of which others are read.
    """

    title: str
    texts: str
    codec: Callable[[], Codec]
    is_written: bool = True
    suffixes: tuple[str, ...] = ()
    written_suffixes: tuple[str, ...] = ()
    keywords: tuple[str, ...] = ()

    def read(self, source: SourceFile, **given: Any) -> World:
        """Return the world of a text; of what is given, those that are not its keywords are left.

        Raises:
            ConversionError: the text is not in this format.
        """
        keywords = {name: each for name, each in given.items() if name in self.keywords}
        return self.codec().read(source, **keywords)

    def write(self, level: Level) -> Conversion:
        """Return a level in this format, without a check of what is lost; see `export`."""
        write = self.codec().write
        if write is None:
            raise ValueError(f"levels are not written as a {self.title}")
        return write(level)


def _setups() -> Codec:
    from babyrobot_levels.convert.setups import CODEC

    return CODEC


def _frozen_lake() -> Codec:
    from babyrobot_levels.convert.frozen_lake import CODEC

    return CODEC


def _maze_map() -> Codec:
    from babyrobot_levels.convert.block_maps import MAZE_MAP

    return MAZE_MAP


def _maze_dataset() -> Codec:
    from babyrobot_levels.convert.block_maps import MAZE_DATASET

    return MAZE_DATASET


def _minigrid() -> Codec:
    from babyrobot_levels.convert.block_maps import MINIGRID

    return MINIGRID


def _sokoban() -> Codec:
    from babyrobot_levels.convert.block_maps import SOKOBAN

    return SOKOBAN


def _tiled() -> Codec:
    from babyrobot_levels.convert.tiled import CODEC

    return CODEC


FORMATS = {
    "babyrobot": Format(
        "keyword setup of PyPI babyrobot", "setups of PyPI babyrobot", _setups, is_written=False
    ),
    "frozen-lake": Format(
        "FrozenLake map", "FrozenLake maps", _frozen_lake, keywords=("slippery",)
    ),
    "maze-map": Format("Gymnasium-Robotics maze_map", "Gymnasium-Robotics' maze maps", _maze_map),
    "maze-dataset": Format("maze-dataset ASCII", "maze-dataset's ASCII", _maze_dataset),
    "minigrid": Format("MiniGrid text", "MiniGrid's text", _minigrid),
    "sokoban": Format(
        "map of # and blanks",
        "Sokoban maps (# and blanks)",
        _sokoban,
        suffixes=(".xsb", ".sok"),
    ),
    "tiled": Format(
        "Tiled map in JSON",
        "Tiled's JSON",
        _tiled,
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
    from babyrobot_levels.convert.conversion import ConversionError
    from babyrobot_levels.convert.data import looks_like_data, read_data

    suffix = PurePath(source.name).suffix.lower()
    by_suffix = [name for name, each in FORMATS.items() if suffix in each.suffixes]
    if by_suffix:
        return by_suffix
    letters = set(source.text) - set("\r\n")
    if not letters - {" "}:
        raise ConversionError("the text is blank")
    codecs = {name: each.codec() for name, each in FORMATS.items()}
    drawn = [name for name, codec in codecs.items() if codec.draws(source, letters)]
    if drawn or not looks_like_data(source.text):
        return drawn
    data = read_data(source)
    return [name for name, codec in codecs.items() if codec.holds(data)][-1:]
