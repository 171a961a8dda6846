"""How a level is cited: one line for a text, and an entry for BibTeX."""

import re
from pathlib import Path

from babyrobot_levels.language.play import program
from babyrobot_levels.library.level import Level
from babyrobot_levels.text.diagnostics import one_line

_PACK_NAME = re.compile(r"[a-z0-9-]+/[a-z0-9-]+")

_LATEX = {
    **{character: f"\\{character}" for character in "&%$#_{}"},
    "\\": r"\textbackslash{}",
    "~": r"\textasciitilde{}",
    "^": r"\textasciicircum{}",
}


def citation(level: Level, argument: str = "") -> str:
    """Return the line that identifies a level: its name, the versions, and its digest.

    Args:
        level: the level; a maze needs a seed.
        argument: the argument that names it, which is `pack/name` for a level of a pack.
    """
    return f"{cited_name(level, argument)} ({_made_with(level, argument)}), {level.digest}"


def bibtex(level: Level, argument: str = "") -> str:
    """Return an entry for BibTeX that says the same as `citation`, and who made the level.

    Args and errors are those of `citation`.
    """
    name = cited_name(level, argument)
    label = re.sub(r"[^a-z0-9]+", "-", name.lower()).strip("-") or "level"
    fields = {
        "title": f"{{{_latex(level.title or name)}}}",
        "author": f"{{{_latex(level.author)}}}" if level.author else None,
        "howpublished": _latex(_made_with(level, argument)),
        "note": _latex(f"Level {name}, {level.digest}"),
    }
    lines = [f"  {key} = {{{text}}}," for key, text in fields.items() if text]
    return "\n".join([f"@misc{{{label},", *lines, "}"])


def cited_name(level: Level, argument: str) -> str:
    """Return the name under which a level is cited, with its pack if it is one of a pack."""
    if (pack := pack_in(argument)) is not None and level.name is not None:
        return f"{pack[0]}/{level.name}"
    return level.name or one_line(level.title or "a level without a name")


def _made_with(level: Level, argument: str) -> str:
    pack = pack_in(argument)
    made_with = f"{program()}, level language {level.version}"
    return made_with if pack is None else f"pack {' '.join(filter(None, pack))}, {made_with}"


def _latex(text: str) -> str:
    return "".join(_LATEX.get(character, character) for character in one_line(text))


def pack_in(argument: str) -> tuple[str, str | None] | None:
    """Return name and version of the pack in an argument; a pack may have no version."""
    from babyrobot_levels.library.packs import fields
    from babyrobot_levels.library.search_path import pack_places

    # A file of that name takes precedence.
    if not _PACK_NAME.fullmatch(argument) or Path(argument).is_file():
        return None
    pack = argument.partition("/")[0]
    folder = next((place.folder for place in pack_places() if place.pack == pack), None)
    if folder is None:
        return None
    found = fields(folder)
    return pack, None if found is None else found.version
