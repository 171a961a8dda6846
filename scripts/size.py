"""Print how large the package is: python scripts/size.py [CHECKOUT].

Code is what is left without docstrings, comments and blank lines.
"""

from __future__ import annotations

import ast
import io
import re
import statistics
import subprocess
import sys
import tokenize
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

PACKAGE = "babyrobot_levels"
NOT_CODE = {
    *(tokenize.COMMENT, tokenize.NL, tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT),
    *(tokenize.ENDMARKER, tokenize.ENCODING),
}


def docstring_lines(tree: ast.AST) -> set[int]:
    """Return the lines of docstrings, and of texts below constants."""
    found: set[int] = set()
    for node in ast.walk(tree):
        body = getattr(node, "body", None)
        for each in body if isinstance(body, list) else ():
            if isinstance(each, ast.Expr) and isinstance(each.value, ast.Constant):
                found |= {*range(each.lineno, (each.end_lineno or each.lineno) + 1)}
    return found


def tokens_of(text: str) -> list[tokenize.TokenInfo]:
    """Return the tokens of a module that are code."""
    found = tokenize.generate_tokens(io.StringIO(text).readline)
    return [token for token in found if token.type not in NOT_CODE]


def functions(tree: ast.AST) -> Iterator[ast.FunctionDef | ast.AsyncFunctionDef]:
    """Yield all functions and methods."""
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            yield node


def figures(checkout: Path) -> dict[str, str]:
    """Return the figures by name."""
    package = checkout / PACKAGE
    code = imports = private = once = 0
    lengths: list[int] = []
    paths = sorted(package.rglob("*.py"))
    for path in paths:
        text = path.read_text("utf-8")
        tree, tokens = ast.parse(text), tokens_of(text)
        lines = {n for token in tokens for n in range(token.start[0], token.end[0] + 1)}
        lines -= docstring_lines(tree)
        code += len(lines)
        imports += sum(
            (node.end_lineno or node.lineno) - node.lineno + 1
            for node in ast.walk(tree)
            if isinstance(node, ast.Import | ast.ImportFrom)
        )
        words = Counter(token.string for token in tokens if token.type == tokenize.NAME)
        for function in functions(tree):
            own = range(function.lineno, (function.end_lineno or function.lineno) + 1)
            lengths.append(len(lines.intersection(own)))
            if re.match(r"_[^_]", function.name):
                private += 1
                once += words[function.name] <= 2
    tests = sum(
        len(path.read_text("utf-8").splitlines()) for path in checkout.glob("tests/**/*.py")
    )
    cuts = statistics.quantiles(lengths, n=100)
    return {
        "lines of code": f"{code:,}",
        "modules": f"{len(paths):,}",
        "lines of tests": f"{tests:,}",
        "imports, as a share of code": f"{100 * imports / code:.1f} %",
        "private functions used once": f"{once:,} of {private:,} ({100 * once / private:.0f} %)",
        "files that name a switch": f"{naming(package, 'py')} Python, "
        f"{naming(package, 'js')} JavaScript",
        "lines of code of a function": f"median {cuts[49]:.0f}, 90 % {cuts[89]:.0f}, "
        f"99 % {cuts[98]:.0f}, most {max(lengths)}",
        "modules that `validate` loads": str(loaded(checkout)),
    }


def naming(package: Path, suffix: str) -> int:
    """Return how many files name a switch, the thing by which the cost of a kind is told."""
    # In JavaScript, `switch` is a statement.
    word = re.compile(r"\bswitch(es)?\b" if suffix == "py" else r"\bswitches\b", re.IGNORECASE)
    return sum(bool(word.search(path.read_text("utf-8"))) for path in package.rglob(f"*.{suffix}"))


def loaded(checkout: Path) -> int:
    """Return how many modules of the package `babyrobot validate` of a level loads."""
    call = ["-X", "importtime", "-m", PACKAGE, "validate", "levels/final-maze.yaml"]
    done = subprocess.run(
        [sys.executable, *call], cwd=checkout, capture_output=True, encoding="utf-8", check=True
    )
    return len(set(re.findall(rf"\| +({PACKAGE}[\w.]*)$", done.stderr, re.M)))


if __name__ == "__main__":
    for name, figure in figures(Path(sys.argv[1] if len(sys.argv) > 1 else ".")).items():
        print(f"{name:31} {figure}")
