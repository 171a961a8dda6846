"""Worlds as level files: commented, in the canonical form, and with nothing for the linter."""

from __future__ import annotations

from babyrobot_levels.convert.conversion import ConversionError, World
from babyrobot_levels.language.formatting.formatter import format_source
from babyrobot_levels.library.reading import read_level
from babyrobot_levels.lint.fixer import fix
from babyrobot_levels.lint.registry import select
from babyrobot_levels.text.emitter import emit_field
from babyrobot_levels.text.files import ReadFault, decode
from babyrobot_levels.text.source import SourceFile


def file_text(world: World, *, schema: str | None, name: str | None, title: str) -> str:
    """Return the text of a level file.

    Args:
        world: what it says.
        schema: where editors find the JSON schema, as the file's first line names it;
            None for no such line.
        name: the level's name, None to leave it to the file's.
        title: the level's title, if the world has none.

    Raises:
        ConversionError: the world is too large for a file.
        LevelError: it is no valid level.
    """
    fields = {"version": 1, **({"name": name} if name else {}), "title": title, **world.fields}
    if name:
        fields["name"] = name
    lines = [f"# yaml-language-server: $schema={schema}\n"] if schema else []
    lines.append(f"# {world.origin}\n")
    for field, value in fields.items():
        if field in world.comments:
            lines.append(f"# {world.comments[field]}\n")
        lines.append(emit_field(field, value))
    return _tidy("".join(lines))


def _tidy(text: str) -> str:
    """Return a level's text as `babyrobot lint --fix` and `babyrobot format` leave it."""
    try:
        source = decode(text.encode("utf-8"), "<imported>")
    except ReadFault as fault:
        raise ConversionError(
            f"the level would be too much for one file: {fault}",
            "a drawing takes eight characters a cell, so it has room for some 360 by 360 cells",
        ) from None
    level, diagnostics = read_level(source)
    if level is None:
        raise ConversionError(
            "this is no valid level:\n" + "\n".join(map(str, diagnostics[:5])),
        )
    fixed = fix(source, select(None)).text
    return format_source(SourceFile(source.name, fixed)).text
