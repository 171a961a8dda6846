"""What pages consist of: HTML from templates, and a script and a style sheet from modules.

In templates, every text is escaped that is not marked as HTML.

In `static` folders, scripts are ES modules, and style sheets name others by `@import`. Tools for
JavaScript read them as they are. A page gets one script and one style sheet, made here: each
module once, after those that it imports, without lines of `import` and the word `export`. So all
modules of a script share one scope, and their top-level names must differ.

Only these forms are understood, each at the beginning of a line:

- `import { a, b } from "./module.js";` and `@import "sheet.css";`, by a relative path,
- `export` before `const`, `let`, `function`, `async function` and `class`,
- `export default`, which stays, in the module that nobody imports.
"""

from __future__ import annotations

import json
import posixpath
import re
from collections.abc import Mapping
from functools import cache
from importlib.resources import files
from typing import TYPE_CHECKING, Any, NamedTuple

from babyrobot_levels.render.svg import NOT_XML

if TYPE_CHECKING:
    from jinja2 import Environment
    from markupsafe import Markup

_IMPORT = re.compile(r'^import \{([^}]*)\} from "([^"]+)";$|^@import "([^"]+)";$', re.M)
_EXPORT = re.compile(r"^export (?=(?:const|let|class|function|async function) (\w+))", re.M)
_NAMES = re.compile(r"^(?:const|let|class|(?:async )?function) (?:(\w+)|[\[{]([^=]*)[\]}] =)", re.M)
_LEFT = re.compile(r"^(?:import\b|export (?!default )|@import\b).*", re.M)
_NEEDLESS = re.compile(r"^((?:(?!//).)*)[,;]\n(?=[)\]}])", re.M)
"""A comma or a semicolon, and a break, after the last of several lines or statements."""
_BREAKS = re.compile(r"^((?:(?!//).)*)(?:(?<=[{}()\[;,=>?:&|+])\n|\n(?=\}))", re.M)
"""Breaks after signs with which a statement ends or goes on, and before the end of a block."""
_DECLARED = re.compile(r"^(const\b[^\n]*);\nconst\b ?(?=[^\n]*;$)", re.M)
"""A declaration on one line that another one follows."""
_COMMENTS = re.compile(
    r"^ *(?://[^\n]*|/\*(?:(?!\*/).)*\*/ *)$"
    r"|(?<=[;,{([]) (?:// (?:[^\n\"`]|`\w*`)*|/\* [^\n*]*\*/)$"
    r"|/\*\* @type (?:(?!\*/).)*\*/ ?",
    re.M | re.S,
)
"""Comments that have lines of their own, or end one, and types of expressions."""


_TEXT = r"""("(?:[^"\\]|\\.)*"|'(?:[^'\\]|\\.)*'|`(?:[^`\\]|\\.)*`)"""
_NESTED, _SLASH = re.compile(r"\$\{[^}]*`"), re.compile(r"/\S")
"""What lines have with texts that are no strings: nested templates; regular expressions."""
_ZERO = r"(?<![\w.])0(?=\.\d)"
_SPACES = {
    ".js": re.compile(
        rf'{_TEXT}|{_ZERO}| ?(=>|[][=<>?:,;{{}}()&|!*%]+) ?| ([+-]) (?![+-])| (?=["`])'
    ),
    ".css": re.compile(rf"{_TEXT}|{_ZERO}|; ?(?=\}})|([:;{{,]) | (?=[{{}}])"),
}
"""Texts, which stay as they are, and what is needless in scripts and style sheets."""


class _Module(NamedTuple):
    """A script or style sheet: what it imports, by path, and its text without that."""

    imports: dict[str, frozenset[str]]
    exports: frozenset[str]
    names: frozenset[str]
    """What it declares at the top level."""
    code: str


def static(path: str) -> str:
    """Return the text of a file, by its path from the package's folder."""
    return files("babyrobot_levels").joinpath(*path.split("/")).read_text("utf-8")


def put_together(path: str, given: Mapping[str, str] | None = None) -> str:
    """Return a script or style sheet with all that it imports, without what is only for readers.

    Args:
        path: the module that imports the others, from the package's folder.
        given: texts that take the place of modules, by their paths.

    Raises:
        ValueError: modules import each other in a circle, or what is not exported; two of them
            have the same name at the top level; or a line is of a form that is not understood.
    """
    modules: dict[str, _Module] = {}
    _collect(path, given or {}, modules, ())
    _check_names(modules)
    return "\n".join(module.code for module in modules.values() if module.code)


def _collect(
    path: str, given: Mapping[str, str], modules: dict[str, _Module], waiting: tuple[str, ...]
) -> None:
    """Add a module, after those that it imports; `waiting` are those that import it."""
    if path in waiting:
        circle = " -> ".join([*waiting[waiting.index(path) :], path])
        raise ValueError(f"modules import each other in a circle: {circle}")
    if path in modules:
        return
    module = _read(path, given[path] if path in given else static(path))
    for other, names in module.imports.items():
        _collect(other, given, modules, (*waiting, path))
        if missing := names - modules[other].exports:
            raise ValueError(f"{path}: {other} does not export {', '.join(sorted(missing))}")
    modules[path] = module


def _read(path: str, text: str) -> _Module:
    folder = posixpath.dirname(path)
    imports = {
        posixpath.normpath(posixpath.join(folder, script or sheet)): _words(names or "")
        for names, script, sheet in _IMPORT.findall(text)
    }
    exports = frozenset(_EXPORT.findall(text))
    code = _EXPORT.sub("", _IMPORT.sub("", _COMMENTS.sub("", text)))
    if left := _LEFT.search(code):
        raise ValueError(f"{path}: this form is not understood: {left[0]}")
    names = frozenset[str]().union(*map(_words, map(" ".join, _NAMES.findall(code))))
    kind = posixpath.splitext(path)[1]
    spaces = _SPACES[kind]
    lines = [
        line
        if kind == ".js" and _is_kept(line)
        else spaces.sub(lambda found: "".join(filter(None, found.groups())), line)
        for line in filter(None, map(str.strip, code.splitlines()))
    ]
    code = _NEEDLESS.sub(r"\1", "\n".join(lines))
    while (joined := _DECLARED.sub(r"\1,", code)) != code:
        code = joined
    return _Module(imports, exports, names, _BREAKS.sub(r"\1", code))


def _is_kept(line: str) -> bool:
    """Tell whether a line of a script has texts that are no strings, which may have spaces."""
    return bool(_NESTED.search(line) or _SLASH.search(re.sub(_TEXT, "", line)))


def _check_names(modules: Mapping[str, _Module]) -> None:
    owners: dict[str, str] = {}
    for path, module in modules.items():
        for name in module.names:
            if (owner := owners.setdefault(name, path)) != path:
                raise ValueError(f"{owner} and {path} both have the name {name}")


def _words(text: str) -> frozenset[str]:
    return frozenset(re.findall(r"\w+", text))


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
