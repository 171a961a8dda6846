"""The house has one direction: lower modules know nothing of higher ones. Read from the sources."""

from __future__ import annotations

import ast
import re
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from graphlib import TopologicalSorter
from pathlib import Path

import pytest
from support.subprocesses import python

import babyrobot_levels

ROOT = Path(babyrobot_levels.__file__).parent
PACKAGE = "babyrobot_levels"
MAX_LINES = 350

LAYERS = [
    # What runs when anything of the package is imported.
    ["_gymnasium_hook"],
    ["__init__"],
    # Values and words.
    ["actions", "errors", "folders", "source", "suggest"],
    ["diagnostics"],
    # Texts.
    ["drawing", "syntax"],
    ["files"],
    # What a level may say.
    ["spec"],
    ["messages", "plain"],
    ["loader"],
    # What it comes to.
    ["maze"],
    ["grid", "mdp"],
    ["compiler"],
    ["digest"],
    # The level as users hold it, and where it comes from.
    ["level"],
    ["themes"],
    ["reading", "share_dictionary"],
    ["resolve", "share"],
    ["packs"],
    ["places"],
    ["catalogue"],
    # How it looks.
    ["scene"],
    ["render"],
    # What it is worth.
    ["solver"],
    ["learning"],
    # Many robots at once.
    ["engine"],
    # How it is written.
    ["formatting"],
    # What could be better about it.
    ["lint"],
    # What it is like, in numbers.
    ["measures"],
    # Levels to order, and families of levels.
    ["generate"],
    ["suites"],
    ["packing"],
    # What is done with it.
    ["games"],
    ["difference"],
    ["notebook"],
    ["certificate", "envs", "report", "schema", "starter"],
    # Worlds of other programs, and their learners.
    ["convert", "sb3"],
    ["cli"],
    ["__main__"],
]
"""From the ground up. A package stands for all its modules."""

FACADES = {"_gymnasium_hook", "level"}
"""These hand on to higher modules, which they import only when asked to."""

OWNERS = {
    "yaml": {"syntax.reader"},
    "typer": {"cli"},
    "gymnasium": {"envs", "games", "level", "convert.registration"},
    "PIL": {"render"},
    "rich": {"cli"},
    "platformdirs": {"folders"},
    "ipycanvas": {"render.notebook.canvas"},
    "IPython": {"notebook"},
    "matplotlib": set(),
    "numba": {"engine.loops", "maze.compiled", "maze.kernel"},
    "scipy": {"solver"},
    "stable_baselines3": {"sb3"},
}
"""Who may import what is not ours: a module, or all of a package's."""

MAY_WRITE = {"render.terminal": {"sys.stdout"}}
"""The one module of the library that writes to a stream: `"human"` rendering is there for that."""

FOR_VALIDATE_TOO_HEAVY = {"numba", "numpy", "gymnasium", "ipycanvas", "PIL", "rich"}

MODULES = {
    ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__"): path
    for path in sorted(ROOT.rglob("*.py"))
}

each_module = pytest.mark.parametrize("module", MODULES)


@dataclass(frozen=True)
class Import:
    """A module that another one imports: at once, or `lazily` inside a function."""

    target: str
    lazily: bool
    line: int


@cache
def tree_of(module: str) -> ast.Module:
    return ast.parse(MODULES[module].read_text("utf-8"))


def is_for_types_only(node: ast.AST) -> bool:
    return isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test)


def nodes(node: ast.AST, in_function: bool = False) -> Iterator[tuple[ast.AST, bool]]:
    """Yield what runs: every node not meant for type checkers, and whether in a function."""
    for child in ast.iter_child_nodes(node):
        if is_for_types_only(child):
            continue
        yield child, in_function
        inside = isinstance(child, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda)
        yield from nodes(child, in_function or inside)


@cache
def imports(module: str) -> tuple[Import, ...]:
    """Return what a module imports, ours under their names inside the package."""
    found = []
    for node, lazily in nodes(tree_of(module)):
        if isinstance(node, ast.Import):
            found += [Import(_own(alias.name), lazily, node.lineno) for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{module}:{node.lineno} imports relatively"
            base = _own(node.module or "")
            for alias in node.names:
                inner = alias.name if base == "__init__" else f"{base}.{alias.name}"
                target = inner if inner in MODULES else base
                found.append(Import(target, lazily, node.lineno))
    return tuple(found)


def _own(name: str) -> str:
    return "__init__" if name == PACKAGE else name.removeprefix(f"{PACKAGE}.")


def home(module: str) -> str:
    """Return a module's name in `LAYERS` and `OWNERS`: that of its package, if it has one."""
    return module.split(".", maxsplit=1)[0]


@cache
def floor(module: str) -> int:
    return next(number for number, layer in enumerate(LAYERS) if home(module) in layer)


# -- one direction ---------------------------------------------------------------------------


def test_every_module_has_its_layer_and_every_layer_its_modules() -> None:
    placed = [name for layer in LAYERS for name in layer]
    assert len(placed) == len(set(placed))
    assert set(placed) == {home(module) for module in MODULES}


@each_module
def test_imports_go_down(module: str) -> None:
    wrong = [
        f"{module}:{found.line} imports {found.target}, which lies higher"
        for found in imports(module)
        if found.target in MODULES
        and floor(found.target) > floor(module)
        and not (found.lazily and module in FACADES)
    ]
    assert wrong == []


def test_nothing_is_imported_in_a_circle() -> None:
    graph = {
        module: {
            found.target
            for found in imports(module)
            if not found.lazily and found.target in MODULES and found.target != module
        }
        for module in MODULES
    }
    assert len(list(TopologicalSorter(graph).static_order())) == len(MODULES)


def test_the_reader_of_imports_sees_them_all() -> None:
    # The tests above would be content with a reader that finds nothing.
    found = {(each.target, each.lazily) for each in imports("level")}
    assert {("grid", False), ("compiler", True), ("gymnasium", True)} <= found
    assert ("mdp", False) not in found
    assert ("drawing", False) in {(each.target, each.lazily) for each in imports("render.text")}


# -- each library has its place --------------------------------------------------------------


@each_module
def test_libraries_are_imported_only_in_their_places(module: str) -> None:
    wrong = []
    for found in imports(module):
        library = found.target.split(".")[0]
        if library in MODULES or library in sys.stdlib_module_names:
            continue
        if library in OWNERS and not {module, home(module)} & OWNERS[library]:
            wrong.append(f"{module}:{found.line} imports {library}")
        if library == "gymnasium" and home(module) != "envs" and not found.lazily:
            wrong.append(f"{module}:{found.line} imports gymnasium at once")
    assert wrong == []


@pytest.mark.parametrize(
    ("text", "status"),
    [("version: 1\nmaze: {seed: 1}\nmap: ''\n", 1), ("version: 1\n", 0)],
    ids=["faulty", "valid"],
)
@pytest.mark.parametrize("form", ["text", "json"])
def test_validating_imports_nothing_heavy(
    text: str, status: int, form: str, tmp_path: Path
) -> None:
    path = tmp_path / "mine.yaml"
    path.write_text(text, "utf-8")
    call = ("-X", "importtime", "-m", PACKAGE, "validate", "--format", form, path)
    done = python(*call, cwd=tmp_path)
    assert done.returncode == status, done.stderr[-2000:]
    imported = set(re.findall(r"^import time:.*\| +(\w+)", done.stderr, re.MULTILINE))
    assert "pydantic" in imported
    assert imported & FOR_VALIDATE_TOO_HEAVY == set()


def test_a_command_imports_what_it_needs_when_it_runs(tmp_path: Path) -> None:
    done = python("-X", "importtime", "-m", PACKAGE, "--help", cwd=tmp_path)
    assert done.returncode == 0, done.stderr[-2000:]
    imported = set(re.findall(r"^import time:.*\| +(\w+)", done.stderr, re.MULTILINE))
    assert "typer" in imported
    assert imported & {"pydantic", "yaml", *FOR_VALIDATE_TOO_HEAVY} == set()


# -- habits ----------------------------------------------------------------------------------


@each_module
def test_the_library_neither_prints_nor_exits(module: str) -> None:
    if home(module) in ("cli", "__main__"):
        return
    streams = {"SystemExit", "sys.exit", "os._exit", "sys.stdout", "sys.stderr", "sys.stdin"}
    streams -= MAY_WRITE.get(module, set())
    calls = {"print", "input", "exit", "quit", "breakpoint"}
    wrong = []
    for node, _ in nodes(tree_of(module)):
        if isinstance(node, ast.Call) and ast.unparse(node.func) in calls:
            wrong.append(f"{module}:{node.lineno} calls {ast.unparse(node.func)}")
        if isinstance(node, ast.Name | ast.Attribute) and ast.unparse(node) in streams:
            wrong.append(f"{module}:{node.lineno} uses {ast.unparse(node)}")
    assert wrong == []


@each_module
def test_chance_comes_from_generators_of_ones_own(module: str) -> None:
    own = {"random.Random", "np.random.Generator", "np.random.default_rng"}
    wrong = []
    for node, _ in nodes(tree_of(module)):
        if isinstance(node, ast.Attribute):
            text = ast.unparse(node)
            if re.fullmatch(r"random\.\w+|(np|numpy)\.random\.\w+", text) and text not in own:
                wrong.append(f"{module}:{node.lineno} uses {text}")
        if isinstance(node, ast.ImportFrom) and node.module in ("random", "numpy.random"):
            wrong.append(f"{module}:{node.lineno} imports from {node.module}")
    assert wrong == []


@each_module
def test_every_module_says_what_it_is(module: str) -> None:
    text = ast.get_docstring(tree_of(module))
    assert text
    assert text.splitlines()[0].rstrip().endswith((".", "?", "!"))


@each_module
def test_no_module_is_too_long(module: str) -> None:
    assert len(MODULES[module].read_text("utf-8").splitlines()) <= MAX_LINES
