"""Worlds as level files: commented, in the canonical form, and with nothing for the linter."""

from __future__ import annotations

from babyrobot_levels.convert.conversion import ConversionError, World
from babyrobot_levels.language.formatting.formatter import format_source
from babyrobot_levels.library.reading import errors_of
from babyrobot_levels.lint.fixer import fix
from babyrobot_levels.lint.registry import select
from babyrobot_levels.text.emitter import emit_field
from babyrobot_levels.text.errors import LevelError
from babyrobot_levels.text.files import source_of
from babyrobot_levels.text.source import SourceFile


def file_text(world: World, *, schema: str, name: str | None, title: str) -> str:
    """Return the text of a level file.

    Args:
        world: what it says.
        schema: where editors find the JSON schema, as the file's first line names it.
        name: the level's name, None to leave it to the file's.
        title: the level's title, if the world has none.

    Raises:
        ConversionError: the world is too large for a file.
        LevelError: it is no valid level.
    """
    fields = {"version": 1, **({"name": name} if name else {}), "title": title, **world.fields}
    if name:
        fields["name"] = name
    lines = [f"# yaml-language-server: $schema={schema}\n", f"# {world.origin}\n"]
    for field, value in fields.items():
        if field in world.comments:
            lines.append(f"# {world.comments[field]}\n")
        lines.append(emit_field(field, value))
    return _tidy("".join(lines))


def _tidy(text: str) -> str:
    """Return a level's text as `babyrobot lint --fix` and `babyrobot format` leave it."""
    try:
        source = source_of(text.encode("utf-8"), "<imported>")
    except LevelError as fault:
        raise ConversionError(
            f"the level would be too much for one file: {fault.diagnostics[0].message}",
            "a drawing takes eight characters a cell, so it has room for some 360 by 360 cells",
        ) from None
    errors = errors_of(source)
    if errors:
        raise ConversionError("this is no valid level:\n" + "\n".join(map(str, errors[:5])))
    fixed = fix(source, select(None)).text
    return format_source(SourceFile(source.name, fixed)).text
