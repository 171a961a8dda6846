"""HTML from templates, in which every text is escaped that is not marked as HTML."""

from __future__ import annotations

import json
from functools import cache
from typing import TYPE_CHECKING, Any

from babyrobot_levels.render.scripts import static
from babyrobot_levels.render.svg import NOT_XML

if TYPE_CHECKING:
    from jinja2 import Environment
    from markupsafe import Markup


def html(path: str, **values: Any) -> str:
    """Return a template that is filled in.

    Args:
        path: its file, from the package's folder.
        values: what its names stand for. Texts are escaped, `Markup` is HTML already.

    Raises:
        jinja2.UndefinedError: a name of the template is not given.
    """
    return _environment().get_template(path).render(values)


def as_html(text: str) -> Markup:
    """Mark a text as HTML, which templates take as it is: never one of a level."""
    # It belongs to Jinja2, which most commands do without.
    from markupsafe import Markup

    return Markup(text)


def embedded_json(data: Any) -> Markup:
    """Return data as JSON for a script element, which nothing in it can close."""
    text = json.dumps(data, separators=(",", ":"), allow_nan=False)
    for character in "<>&":
        text = text.replace(character, f"\\u{ord(character):04x}")
    return as_html(text)


@cache
def _environment() -> Environment:
    from jinja2 import Environment, FunctionLoader, StrictUndefined

    return Environment(
        loader=FunctionLoader(static),
        autoescape=True,
        undefined=StrictUndefined,
        finalize=_printable,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        auto_reload=False,
    )


def _printable(value: Any) -> Any:
    """Replace characters that no document can contain, not even escaped, in texts of levels."""
    return NOT_XML.sub("\ufffd", value) if type(value) is str else value
