"""The pages of the documentation, run as they are printed; CONTRIBUTING.md says how to write them.

    PYTHONPATH=tests python -m support.pages docs/linting.md …

runs the blocks of pages, each page in a folder of its own, and reports what differs. Without pages,
all are run. `--with sb3,fast` runs the blocks that need these extras too, and without pages only
those, with the files and commands before them. `--bin FOLDER` names the environment in which the
package is installed; without it, it is this one, with the package of this checkout.
"""

from __future__ import annotations

import argparse
import ast
import json
import math
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from textwrap import dedent, indent

from support.places import DOCS, ROOT
from support.sessions import environment

LONGEST = 400
"""Seconds after which a block hangs: one that trains takes two minutes on a busy machine."""

_FENCE = re.compile(r"^( *)```(?!`)(\S*)\n(.*?)^\1```$", re.M | re.S)
_MARK = re.compile(r"<!-- (.*?) -->")
_MARKS = re.compile(r"file: |in the clone$|needs: |not run: |no picture$|demo$|tests$")
_END = "\x1e"
"""Behind the output of each command stands this character, and the exit status."""
_CHANGING = re.compile(r"\b[\d.,]+ (?:bytes|KB|MB|s|ms)\b")
"""Sizes of files and times: other versions of libraries and other machines have others."""

# Runs a block in a process of its own. Statements keep the lines of the page, for tracebacks; the
# values of expressions that stand alone are written down, for comparison with their comments.
_PYTHON = """\
import ast, json, sys
_page, _line, _values = sys.argv[1:]
sys.argv = [""]
with open(_page, encoding="utf-8") as _file:
    _text = "".join(_file.readlines()[int(_line):])
def _seen(line, value, _kept={}, _path=_values, _dump=json.dump):
    _kept[line] = repr(value.item() if getattr(value, "shape", None) == () else value)
    with open(_path, "w", encoding="utf-8") as file:
        _dump(_kept, file)
_tree = ast.increment_lineno(ast.parse(sys.stdin.read()), int(_line))
for _each in _tree.body:
    if isinstance(_each, ast.Expr):
        _number = ast.Constant(_each.end_lineno)
        _each.value = ast.Call(ast.Name("_seen", ast.Load()), [_number, _each.value], [])
_code = compile(ast.fix_missing_locations(_tree), _page, "exec")
exec(_code)
"""


@dataclass(frozen=True)
class Block:
    """A fenced block of a page: the line of its fence, and the marks on the lines before it."""

    page: Path
    line: int
    language: str
    text: str
    marks: tuple[str, ...]

    def __str__(self) -> str:
        return f"{_name_of(self.page)}:{self.line}"

    def value_of(self, mark: str) -> str | None:
        """Return what stands behind `mark:`, or None if the block is not so marked."""
        found = [each for each in self.marks if each.startswith(f"{mark}: ")]
        return found[0].removeprefix(f"{mark}: ") if found else None

    @property
    def needs(self) -> set[str]:
        """The extras and packages that the block needs."""
        return set((self.value_of("needs") or "").replace(",", " ").split())

    @property
    def is_run(self) -> bool:
        """Whether the block does anything at all."""
        if self.value_of("not run"):
            return False
        return self.language in ("sh", "console", "python") or self.value_of("file") is not None


def blocks_of(page: Path) -> list[Block]:
    """Return the fenced blocks of a page."""
    text = page.read_text(encoding="utf-8")
    lines = text.splitlines()
    blocks = []
    for found in _FENCE.finditer(text):
        line = text.count("\n", 0, found.start()) + 1
        marks: list[str] = []
        above = line - 2
        while above >= 0 and re.fullmatch(r" *(<!-- .*? --> *)+", lines[above]):
            marks = _MARK.findall(lines[above]) + marks
            above -= 1
        blocks.append(Block(page, line, found[2], dedent(found[3]), tuple(marks)))
    return blocks


def blocks_with(page: Path, extras: set[str]) -> list[Block]:
    """Return the blocks of a page that need extras, and what stands before them.

    Code that needs none is left out: nothing but files and commands leaves something to others.
    """
    blocks = [each for each in blocks_of(page) if each.is_run and each.needs <= extras]
    last = max((number for number, each in enumerate(blocks, 1) if each.needs), default=0)
    return [
        each
        for each in blocks[:last]
        if each.needs or each.value_of("file") or each.language != "python"
    ]


def all_pages() -> list[Path]:
    """Return the pages whose blocks are run."""
    generated = {ROOT / "cli.md"}
    pages = {*ROOT.glob("*.md"), *DOCS.rglob("*.md"), ROOT / "benchmarks" / "README.md"}
    return sorted(pages - generated)


@dataclass
class Reader:
    """Somebody who does what a page says: in an empty folder, with what is installed in `bin`.

    Args:
        folder: the empty folder; a copy of the repository is made beside it.
        bin: the folder of the environment's commands.
        extras: what the environment has besides the package.
        path: the variable PYTHONPATH.
    """

    folder: Path
    bin: Path
    extras: set[str]
    path: str = ""

    @cached_property
    def clone(self) -> Path:
        """A copy of the repository."""
        clone = self.folder.with_name("clone")
        left_out = shutil.ignore_patterns(".git", ".venv*", ".*_cache", "__pycache__", "build")
        shutil.copytree(ROOT, clone, ignore=left_out)
        # Scripts that make an environment find one.
        (clone / ".venv").symlink_to(self.bin.parent)
        return clone

    @cached_property
    def variables(self) -> dict[str, str]:
        """The variables of the environment."""
        path = os.pathsep.join([str(self.bin), os.environ["PATH"]])
        # What lines of installation install is there; whether it is, they tell without an index.
        pip = {"PIP_DRY_RUN": "1", "PIP_NO_INDEX": "1", "PIP_NO_BUILD_ISOLATION": "0",
               "PIP_DISABLE_PIP_VERSION_CHECK": "1"}  # fmt: skip
        home = self.folder.with_name("home")
        home.mkdir(exist_ok=True)
        more = {"HOME": str(home), "XDG_DATA_HOME": str(home / "data"), "BROWSER": "true",
                "PYTHONUNBUFFERED": "1", "PATH": path, "PYTHONPATH": self.path}  # fmt: skip
        # Ray would work in whatever instance it finds on the machine, such as that of another page.
        return {**environment(self.folder), **more, **pip, "RAY_ADDRESS": "local"}

    def faults(self, block: Block) -> Iterator[str]:
        """Do what a block says, and yield what is not as it says."""
        unknown = [mark for mark in block.marks if not _MARKS.match(mark)]
        if unknown and block.language in ("sh", "console", "python"):
            yield f"the mark `{unknown[0]}` is not known"
        if not block.is_run or block.needs - self.extras:
            return
        place = self.clone if "in the clone" in block.marks else self.folder
        name = block.value_of("file")
        if name is not None:
            path = place / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(block.text, encoding="utf-8")
        elif block.language == "python":
            yield from self._python(block, place)
        elif block.language == "console":
            yield from self._console(block, place)
        else:
            trap = "trap 'echo \"$BASH_COMMAND\" failed' ERR\n"
            done = self._run(["bash", "-euEo", "pipefail", "-c", trap + block.text], place)
            if done.returncode:
                yield f"the commands fail with the exit status {done.returncode}:\n{done.stdout}"

    def _run(
        self, command: Sequence[str | Path], place: Path, given: str = ""
    ) -> subprocess.CompletedProcess[str]:
        with subprocess.Popen(
            command,
            cwd=place,
            env=self.variables,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            encoding="utf-8",
            start_new_session=True,
        ) as process:
            try:
                told, _ = process.communicate(given, timeout=LONGEST)
            except subprocess.TimeoutExpired:
                # What it started ends with it.
                os.killpg(process.pid, signal.SIGKILL)
                told = f"{process.communicate()[0]}(it does not end within {LONGEST} s)\n"
        return subprocess.CompletedProcess(command, process.returncode, told)

    def _console(self, block: Block, place: Path) -> Iterator[str]:
        parts = re.split(r"^\$ (.*(?:(?<=\\)\n> .*)*)\n", block.text, flags=re.M)
        if parts[0]:
            yield "a block `console` begins with `$ ` and a command"
        commands = [each.replace("\\\n> ", "\\\n") for each in parts[1::2]]
        script = "".join(f"{command}\nprintf '{_END}%s{_END}' $?\n" for command in commands)
        told = self._run(["bash", "-c", script], place).stdout.split(_END)
        if len(told) != 2 * len(commands) + 1:
            yield f"the block ends early:\n{told[-1]}"
        for command, shown, came, status in zip(
            commands, parts[2::2], told[::2], told[1::2], strict=False
        ):
            # A failure is meant if the page shows what it prints.
            if status != "0" and not shown.strip("…\n "):
                yield f"`{command}` fails with the exit status {status}:\n{came}"
            elif not _matches(shown, came):
                yield (f"`{command}` does not print what is shown\nexpected:\n"
                       f"{indent(shown, '  ')}came:\n{indent(came, '  ')}")  # fmt: skip

    def _python(self, block: Block, place: Path) -> Iterator[str]:
        values = self.folder.with_name("values.json")
        values.unlink(missing_ok=True)
        # Our own pages use nothing that is deprecated.
        warnings = [] if block.needs else ["-W", "error"]
        command: list[str | Path] = [self.bin / "python", *warnings, "-c", _PYTHON]
        done = self._run(
            [*command, block.page.resolve(), str(block.line), values], place, block.text
        )
        if done.returncode:
            yield f"the code fails:\n{done.stdout}"
            return
        shown = re.search(r"\n((?:^#.*\n)+)\Z", block.text, re.M)
        if shown and done.stdout:
            expected = re.sub(r"^# ?", "", shown[1], flags=re.M)
            if not _matches(expected, done.stdout):
                yield (f"the code does not print what its last comment shows\nexpected:\n"
                       f"{indent(expected, '  ')}came:\n{indent(done.stdout, '  ')}")  # fmt: skip
        known = json.loads(values.read_text("utf-8")) if values.exists() else {}
        lines = block.text.splitlines()
        for number, value in known.items():
            line = lines[int(number) - block.line - 1]
            comment = line.rpartition("  # ")[2] if "  # " in line else ""
            if "print(" not in line and not _is_shown(value, comment):
                yield f"line {number}: the comment says {comment!r}, but the value is {value}"


def _matches(shown: str, printed: str) -> bool:
    """Return whether a text is as shown, where … stands for anything."""
    lines = [line.rstrip() for line in shown.strip("\n").splitlines()]
    pattern = ""
    for line in lines:
        if line.strip() == "…":
            pattern += r"(?:.*\n)*?"
        else:
            parts = _CHANGING.sub("0", line).split("…")
            pattern += ".*".join(map(re.escape, parts)) + r"\n"
    came = "".join(f"{line.rstrip()}\n" for line in printed.strip("\n").splitlines())
    return re.fullmatch(pattern, _CHANGING.sub("0", came)) is not None


def _is_shown(value: str, comment: str) -> bool:
    """Return whether `value` is the one with which a comment begins; any is if none does."""
    text, is_cut, _ = comment.partition("…")
    shown = text if is_cut else re.split(r": |:$|, the |; ", comment)[0]
    try:
        expected = ast.literal_eval(shown + '"' if is_cut and shown.startswith('"') else shown)
    except (SyntaxError, ValueError):
        return True
    try:
        found = ast.literal_eval(value)
    except (SyntaxError, ValueError):
        return value == shown
    if isinstance(expected, str):
        return isinstance(found, str) and (
            found.startswith(expected) if is_cut else found == expected
        )
    if isinstance(expected, int | float) and not isinstance(expected, bool):
        if is_cut:
            # Digits that are not shown are cut off.
            return bool(abs(found - expected) < 10.0 ** -len(shown.partition(".")[2]))
        return math.isclose(found, expected, rel_tol=1e-9, abs_tol=1e-12)
    return bool(found == expected)


def run_page(
    blocks: Sequence[Block], bin_folder: Path, extras: set[str], path: str = ""
) -> list[str]:
    """Return what a reader of a page finds wrong, block by block."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name).resolve() / "project"
        folder.mkdir()
        reader = Reader(folder, bin_folder, extras, path)
        return [f"{block}: {fault}" for block in blocks for fault in reader.faults(block)]


def _name_of(page: Path) -> str:
    page = page.resolve()
    return (page.relative_to(ROOT) if page.is_relative_to(ROOT) else page).as_posix()


def main() -> int:
    """Run pages and report; return the exit status."""
    parser = argparse.ArgumentParser()
    parser.add_argument("pages", nargs="*", type=Path)
    parser.add_argument("--with", dest="extras", default="", metavar="EXTRA,…")
    parser.add_argument("--bin", type=Path, metavar="FOLDER")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    given = parser.parse_args()
    extras = {each for each in given.extras.split(",") if each}
    if given.pages or not extras:
        pages = {page: blocks_of(page) for page in given.pages or all_pages()}
    else:
        pages = {page: blocks_with(page, extras) for page in all_pages()}
    pages = {page: blocks for page, blocks in pages.items() if any(b.is_run for b in blocks)}
    bin_folder = (given.bin or Path(sys.executable).parent).absolute()
    path = "" if given.bin else str(ROOT)
    with ThreadPoolExecutor(given.jobs) as pool:
        faults = pool.map(lambda blocks: run_page(blocks, bin_folder, extras, path), pages.values())
        number = 0
        for (page, blocks), found in zip(pages.items(), faults, strict=True):
            run = [b for b in blocks if b.is_run and not b.needs - extras]
            print(f"{_name_of(page)}: {len(run)} blocks, {len(found)} faults", flush=True)
            print("".join(f"\n{fault}\n" for fault in found), end="", flush=True)
            number += len(found)
    return min(number, 1)


if __name__ == "__main__":
    sys.exit(main())
