"""The level as users hold it: the validated fields, what can be done with them, and reading it."""

from __future__ import annotations

from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pydantic import ValidationError

from babyrobot_levels.language.documents import check_level
from babyrobot_levels.language.share_code import decode, encode
from babyrobot_levels.mdp.gridworld import GridWorld, playable
from babyrobot_levels.registry.entries import Entries
from babyrobot_levels.registry.later import later
from babyrobot_levels.text.document import Document
from babyrobot_levels.text.reader import open_document, read
from babyrobot_levels.text.source import SourceFile

if TYPE_CHECKING:
    from babyrobot_levels.analysis import environments, previews
    from babyrobot_levels.analysis.pictures import Pictured
    from babyrobot_levels.analysis.solver import optimum

    class Offered(Pictured):
        """As below, for type checkers."""

        solve = optimum.solve
        show = previews.show
        preview = previews.preview
        play = previews.play
        make = environments.make

else:

    class Offered:
        """What a level can do that stands in later modules: each is imported when it is used."""

        to_svg = later("babyrobot_levels.analysis.pictures:to_svg")
        to_pdf = later("babyrobot_levels.analysis.pictures:to_pdf")
        to_png = later("babyrobot_levels.analysis.pictures:to_png")
        to_gif = later("babyrobot_levels.analysis.pictures:to_gif")
        to_html = later("babyrobot_levels.analysis.pictures:to_html")
        solve = later("babyrobot_levels:solve")
        show = later("babyrobot_levels:show")
        preview = later("babyrobot_levels:preview")
        play = later("babyrobot_levels:play")
        make = later("babyrobot_levels.analysis.environments:make")
        _repr_mimebundle_ = later("babyrobot_levels.render.notebook.html:level_mimebundle")


class Level(Offered, GridWorld):
    """A level: the contents of a level file, validated and frozen.

    Its attributes are the fields of the language, with what a drawing gives filled in. Levels are
    made by `brl.load`, `brl.loads`, or from the fields themselves: `Level(version=1, size=(4, 4))`.
    """

    __module__ = "babyrobot_levels"

    if not TYPE_CHECKING:

        def __init__(self, **fields: Any) -> None:
            with suppress(ValidationError):
                super().__init__(**fields)
                return
            # Tells what is wrong as of a file; NumPy's numbers and other levels' parts are right.
            super().__init__(**type(self).from_fields(fields).to_dict())

        # pydantic would call it for the levels that it makes, too.
        __init__.__pydantic_base_init__ = True

        def _added(self, name: str) -> Any:
            return partial(_METHODS[name], self) if name in _METHODS.others else None

    def __hash__(self) -> int:
        # Some fields are mappings, which have none; equal levels are alike in these.
        return hash((self.name, self.title, self.size, self.start))

    def __repr__(self) -> str:
        """Return the level in short; `to_yaml` and `draw` show all of it."""
        name = "" if self.name is None else f" {self.name!r}"
        width, height = self.size
        return f"<Level{name}: {width}x{height}>"

    __str__ = __repr__

    @property
    def width(self) -> int:
        """The number of columns."""
        return self.size[0]

    @property
    def height(self) -> int:
        """The number of rows."""
        return self.size[1]

    def share_code(self) -> str:
        """Return the level as a share code: one line, `brl1.…`, that `brl.load` takes.

        It holds all fields but `expect`, the name and a theme of the level's own included, but no
        comments.
        It has a checksum, and only characters that may stand in an address.

        Raises:
            LevelError: the level is larger than a level file may be.
        """
        return encode(self.to_dict(whole=True))

    def save(self, path: str | Path) -> None:
        """Write the level to a file, atomically.

        A level that was loaded from a text keeps its comments and its layout; only the lines
        of changed fields are new.

        Raises:
            ValueError: the name of the file is that of a picture.
        """
        from babyrobot_levels.analysis.picture_formats import maker_of
        from babyrobot_levels.text.files import write_text

        if maker_of(path):
            raise ValueError(f"this saves the level as YAML, not {path}: use {maker_of(path)}")
        write_text(Path(path), self.to_yaml(comments=True))


def load_document(document: Document, path: Path | None = None) -> Level:
    """Return the level of a document, which `path` is the file of: it gives name and themes.

    Raises:
        LevelError: it is not a valid level; its `diagnostics` say where and why.
    """
    return playable(check_level(document, Level, path), document).valid()


def loads(text: str, *, name: str = "<text>") -> Level:
    """Return the level that a YAML text says.

    Args:
        text: the text of a level file.
        name: what messages call the text.

    Raises:
        LevelError: the text is not a valid level; its `diagnostics` say where and why.
    """
    return load_source(SourceFile(name, text))


def load_source(source: SourceFile, path: Path | None = None) -> Level:
    """Return the level of a text; see `load_document`."""
    return load_document(read(source), path)


def load_file(path: Path) -> Level:
    """Return the level of a file. A theme that it names may stand in `themes/` beside it.

    Raises:
        LevelError: the file cannot be read, or is not a valid level.
    """
    return load_document(open_document(path), path)


def load_code(text: str) -> Level:
    """Return the level of a share code, or of a link that ends in one. Blanks do not count.

    Raises:
        LevelError: the code is damaged, cut off, of an unknown version, or what it holds is not
            a valid level.
    """
    level = load_source(decode(text))
    # The JSON is no text that saving should keep.
    level.remember_origin(None, None, None)
    return level


_METHODS: Entries[Any] = Entries("methods", dict.fromkeys([*dir(Level), *Level.model_fields]))
"""The names of what levels have, and what extensions add to them."""
