"""The functions of students in what they hand in: files of any name, notebooks, and answers.

Nothing is run here. Of a notebook, only those statements are taken that a function needs.
"""

import ast
import json
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path, PurePosixPath
from symtable import symtable
from typing import Any

from babyrobot_levels.agents.agents import AgentError, read_tables
from babyrobot_levels.extensions.scoring.hand_ins import kind_of
from babyrobot_levels.text.files import write_bytes, write_text
from babyrobot_levels.text.words import listed, nearest

ANSWERS = (".json", ".npz", ".npy")
"""Files of answers: tables by the names of levels, or one table."""

MAX_PARSED = 256 << 10
"""The most characters of a file in which functions are looked for."""

_MAGIC = re.compile(r"^\s*[%!?].*$", re.MULTILINE)
"""Lines of a notebook that are no Python."""


@dataclass(frozen=True)
class Source:
    """Where a function is, or why it is not.

    Attributes:
        name: the name of the function.
        text: the Python text with the function; None without one.
        tables: the answers that are handed in in its place, by level, or one; None without any.
        file: the name of the file; empty if there is none.
        note: how it was found, if it is not as it should be; empty if it is.
        fault: why there is none; empty if there is.
        is_written: whether it does more than to say that it is not written.
    """

    name: str
    text: str | None = None
    tables: Any = None
    file: str = ""
    note: str = ""
    fault: str = ""
    is_written: bool = True

    @property
    def likeness(self) -> str | None:
        """What the same code has in common, whatever its comments; None for none to compare."""
        tree = _parsed(self.text or "")
        found = _function(tree, self.name) if tree is not None else None
        if found is None or not self.is_written:
            return None
        if ast.get_docstring(found) is not None:
            found.body = found.body[1:]
        try:
            return sha256(ast.dump(found).encode("utf-8", "replace")).hexdigest()
        except RecursionError:
            return None


def find_sources(files: Mapping[str, bytes], names: Sequence[str]) -> dict[str, Source]:
    """Return the sources of functions in the files of a student."""
    texts = {
        path: _text_of(path, data)
        for path, data in files.items()
        if kind_of(path) in (".py", ".ipynb")
    }
    trees = {path: _parsed(text) for path, text in texts.items()}
    return {name: _find(name, files, texts, trees) for name in names}


def write_sources(folder: Path, files: Mapping[str, bytes], sources: Mapping[str, Source]) -> None:
    """Write the files of a student into a folder in which their functions can be run.

    What is beside a function is beside it there, too, and each function is in a file of its name.
    """
    for name, source in sources.items():
        if source.text is not None:
            write_text(folder / f"{name}.py", source.text, sync=False)
    tops = {PurePosixPath(each.file).parent for each in sources.values() if each.text}
    inmost = sorted(tops, key=lambda each: -len(each.parts))
    for path, data in files.items():
        # The file of a function finds what is in its folder.
        inner = PurePosixPath(path)
        top = next((each for each in inmost if inner.is_relative_to(each)), ".")
        target = folder / inner.relative_to(top)
        if target.suffix.lower() == ".txt":
            target = target.with_suffix("")
        # What has no place here, such as a file in another file, is left out.
        with suppress(OSError, ValueError):
            if not target.exists():
                target.parent.mkdir(parents=True, exist_ok=True)
                write_bytes(target, data, sync=False)


def _find(
    name: str,
    files: Mapping[str, bytes],
    texts: Mapping[str, str],
    trees: Mapping[str, ast.Module | None],
) -> Source:
    """Return the source of a function."""
    own = f"{name}.py"
    having = [path for path, tree in trees.items() if tree and _function(tree, name)]
    exact = [path for path in texts if _stem(path) == name]
    # A file of the right name that is wrong in itself says what is wrong when it is imported.
    chosen = [each for each in exact if each in having or _may_have(trees[each], name)]
    # What has more than to say that it is not written comes first, then the place.
    candidates = sorted(
        chosen or having,
        key=lambda path: (not _is_written(trees[path], name), path.count("/"), len(path)),
    )
    if candidates:
        path = candidates[0]
        is_own = PurePosixPath(path).name.removesuffix(".txt") == own
        told = "" if is_own else f"{name} was read from {path}"
        if others := [each for each in candidates[1:] if texts[each] != texts[path]]:
            told = f"{name} is in several files: it was read from {path}, not {listed(others[:3])}"
        text, written = texts[path], _is_written(trees[path], name)
        if kind_of(path) == ".ipynb":
            with suppress(RecursionError, SyntaxError, ValueError):
                text = _needed(trees[path], name)
        return Source(name, text, file=path, note=told, is_written=written)
    if answers := [path for path in files if kind_of(path) in ANSWERS and _stem(path) == name]:
        path = answers[0]
        try:
            tables = read_tables(files[path], path.lower().removesuffix(".txt"))
        except AgentError:
            told = f'{path} has no tables by the names of levels, such as {{"NAME": [[0, 1]]}}'
            return Source(name, file=path, fault=told)
        return Source(name, tables=tables, file=path, note=f"answers of {name} are in {path}")
    return Source(name, fault=_missing(name, exact, files, trees))


def _missing(
    name: str, exact: Sequence[str], files: Mapping[str, bytes], trees: Mapping[str, Any]
) -> str:
    """Return what is expected, and what is there."""
    if exact:
        there = [each.name for each in trees[exact[0]].body if isinstance(each, ast.FunctionDef)]
        meant = nearest(name, there, 1)
        told = f", but {listed([*meant, *(each for each in there if each not in meant)][:5])}"
        help_text = f"call it {name}" if meant else f"write `def {name}(level):` at the left margin"
        return f"{exact[0]} has no function {name}{told * bool(there)}: {help_text}"
    others = sorted(PurePosixPath(each).name for each in trees or files)[:5]
    told = f", but {listed(others)}" * bool(others)
    return f"there is no {name}.py{told}, and none of the files has a function {name}"


def _stem(path: str) -> str:
    """Return which function a file is named after: copies and other cases are the same."""
    name = PurePosixPath(path).name
    while kind_of(name) and PurePosixPath(name).suffix:
        name = PurePosixPath(name).stem
    name = re.sub(r"[ _-]*(\(\d+\)|copy|-\d+)$", "", name.lower(), flags=re.IGNORECASE)
    return re.sub(r"[ -]+", "_", name)


def _text_of(path: str, data: bytes) -> str:
    """Return the Python text of a file or of the cells of a notebook."""
    text = data.decode("utf-8", "replace")
    if kind_of(path) != ".ipynb":
        return text
    return "\n\n".join(_cells(text))


def _cells(text: str) -> Iterator[str]:
    """Yield the cells of a notebook that are Python."""
    try:
        for cell in json.loads(text)["cells"]:
            if cell["cell_type"] == "code":
                source = cell["source"]
                code = _MAGIC.sub("", source if isinstance(source, str) else "".join(source))
                if _parsed(code) is not None:
                    yield code
    except (ValueError, LookupError, TypeError, RecursionError):
        return


def _parsed(text: str) -> ast.Module | None:
    """Return the syntax tree of a text; None if it is no Python."""
    if len(text) > MAX_PARSED:
        return None
    try:
        return ast.parse(text)
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return None


def _function(tree: ast.Module, name: str) -> ast.FunctionDef | None:
    """Return the last definition of a function."""
    found = [each for each in tree.body if isinstance(each, ast.FunctionDef) and each.name == name]
    return found[-1] if found else None


def _may_have(tree: ast.Module | None, name: str) -> bool:
    """Return whether a file may have a function that it does not define as usual."""
    return tree is None or any({name, "*"} & _bound(each) for each in ast.walk(tree))


def _is_written(tree: ast.Module | None, name: str) -> bool:
    """Return whether a function may do more than to raise `NotImplementedError`."""
    function = _function(tree, name) if tree is not None else None
    for each in function.body if function is not None else ():
        if any(isinstance(inner, ast.Return | ast.Yield) for inner in ast.walk(each)):
            return True
        if isinstance(each, ast.Raise) and each.exc is not None:
            named = each.exc.func if isinstance(each.exc, ast.Call) else each.exc
            return not (isinstance(named, ast.Name) and named.id == "NotImplementedError")
    return True


def _needed(tree: ast.Module | None, name: str) -> str:
    """Return those statements of a notebook that a function needs, in their order."""
    statements = tree.body if tree is not None else []
    binding = [_bound(each) for each in statements]
    wanted, kept, before = {name}, set[int](), -1
    while before < len(kept):
        before = len(kept)
        for number, (statement, bound) in enumerate(zip(statements, binding, strict=True)):
            if number not in kept and bound & (wanted | {"*"}):
                kept.add(number)
                wanted |= _used(statement)
    return "\n\n".join(ast.unparse(statements[number]) for number in sorted(kept))


def _used(statement: ast.stmt) -> set[str]:
    """Return the names that a statement uses which others give a value."""
    tables, found = [symtable(ast.unparse(statement), "", "exec")], set[str]()
    for table in tables:
        tables += table.get_children()
        is_outside = table.get_type() == "module"
        found |= {
            each.get_name()
            for each in table.get_symbols()
            if each.is_global() or (is_outside and each.is_referenced())
        }
    return found


def _bound(statement: ast.AST) -> set[str]:
    """Return the names that a statement gives a value; `*` where it does not tell them."""
    if isinstance(statement, ast.Import | ast.ImportFrom):
        return {each.asname or each.name.partition(".")[0] for each in statement.names}
    if isinstance(statement, ast.FunctionDef | ast.ClassDef):
        return {statement.name}
    if isinstance(statement, ast.Assign | ast.AnnAssign | ast.AugAssign):
        targets = statement.targets if isinstance(statement, ast.Assign) else [statement.target]
        return {
            inner.id for each in targets for inner in ast.walk(each) if isinstance(inner, ast.Name)
        }
    return set()
