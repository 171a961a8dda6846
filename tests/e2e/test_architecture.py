"""What the contracts in pyproject.toml and ruff's rules cannot say of how the package is built.

They hold the order of the rooms, the places of libraries, and that only the command prints.
"""

from __future__ import annotations

import ast
import pickle
import re
from dataclasses import replace
from pathlib import Path

import pytest
from structure import Structure, picture, rooms_to_draw
from support.subprocesses import python

import babyrobot_levels
import babyrobot_levels as brl

PACKAGE = Path(babyrobot_levels.__file__).parent
CHECKOUT = PACKAGE.parent
STRUCTURE = Structure(CHECKOUT)
PICTURE = CHECKOUT / "docs/images/structure.svg"

MAX_LINES = 600
HEAVY = {"numba", "numpy", "scipy", "gymnasium", "ipycanvas", "IPython", "PIL", "rich"}


@pytest.mark.slow
def test_nothing_is_imported_in_a_circle() -> None:
    # import-linter compares siblings: it does not see a module that imports its own folder.
    assert STRUCTURE.circles == []


def test_the_reader_of_imports_sees_them_all(tmp_path: Path) -> None:
    # The test above would be content with a reader that finds nothing.
    texts = {
        "__init__": "from babyrobot_levels.walls import thick",
        "walls.__init__": "",
        "walls.thick": "import numpy\nfrom babyrobot_levels import walls",
        "walls.thin": "def build():\n    from babyrobot_levels.walls.thick import a, b",
        "doors": "if TYPE_CHECKING:\n    import babyrobot_levels.walls.thin\n"
        "from babyrobot_levels.roof import a",
        "roof": "from babyrobot_levels.doors import b",
    }
    for name, text in texts.items():
        path = tmp_path / "babyrobot_levels" / f"{name.replace('.', '/')}.py"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, "utf-8")
    (tmp_path / "pyproject.toml").write_text("[tool]", "utf-8")
    made = Structure(tmp_path)
    assert made.imports == {
        "__init__": {"walls.thick"},
        "walls": set(),
        "walls.thick": {"walls"},
        "walls.thin": {"walls.thick"},
        "doors": {"walls.thin", "roof"},
        "roof": {"doors"},
    }
    assert made.circles == [["doors", "roof"]]
    assert made.reach("doors") == {"doors", "roof"}
    assert made.reach("walls.thin") == {"walls.thin", "walls.thick", "walls"}
    assert made.arrows == {"walls": set(), "doors": {"walls", "roof"}, "roof": {"doors"}}
    assert made.order == [["walls"], ["doors", "roof"]]


def test_loading_a_level_never_calls_into_a_room_above() -> None:
    # Imports do not show what is handed down to be called.
    stops = STRUCTURE.stops()
    assert ("library.catalogue", "library.level") in stops
    assert STRUCTURE.climbs(stops) == []


def test_at_the_top_stand_only_the_rooms() -> None:
    rooms = {room for layer in STRUCTURE.order for room in layer}
    files = {"__init__.py", "__init__.pyi", "__main__.py", "py.typed"}
    data, caches = {"data"}, {"__pycache__"}
    assert {path.name for path in PACKAGE.iterdir()} - data - caches == rooms | files


def test_every_folder_of_modules_is_a_package() -> None:
    # import-linter passes over what lies in any other folder.
    folders = {path.parent for path in STRUCTURE.modules.values()}
    assert [str(folder) for folder in folders if not (folder / "__init__.py").exists()] == []


def test_no_module_is_too_long() -> None:
    assert {name: n for name, n in STRUCTURE.lines.items() if n > MAX_LINES} == {}


def test_only_the_command_exits() -> None:
    # The rest of this is ruff's; it has no rule for these.
    texts = {name: path.read_text("utf-8") for name, path in STRUCTURE.modules.items()}
    wrong = [
        f"{name}:{used.lineno} {used.id}"
        for name, text in texts.items()
        if not re.search(r"^cli\.|^extensions\.\w+\.commands$", name)
        if re.search(r"\b(SystemExit|input)\b", text)
        for used in map(_raised_or_called, ast.walk(ast.parse(text)))
        if isinstance(used, ast.Name) and used.id in ("SystemExit", "input")
    ]
    assert wrong == []


def _raised_or_called(node: ast.AST) -> ast.AST | None:
    # What others raise may be caught.
    return node.exc if isinstance(node, ast.Raise) else getattr(node, "func", None)


def imported_by(*call: str | Path, status: int, folder: Path) -> set[str]:
    done = python("-X", "importtime", "-m", "babyrobot_levels", *call, cwd=folder)
    assert done.returncode == status, done.stderr[-2000:]
    return set(re.findall(r"^import time:.*\| +(\w+)", done.stderr, re.MULTILINE))


@pytest.mark.parametrize(
    ("text", "status", "form"),
    [("version: 1\nmaze: {seed: 1}\nmap: ''\n", 1, "text"), ("version: 1\n", 0, "json")],
)
def test_validating_imports_nothing_heavy(
    text: str, status: int, form: str, tmp_path: Path
) -> None:
    path = tmp_path / "mine.yaml"
    path.write_text(text, "utf-8")
    imported = imported_by("validate", "--format", form, path, status=status, folder=tmp_path)
    assert "pydantic" in imported
    assert imported & HEAVY == set()


def test_a_command_imports_what_it_needs_when_it_runs(tmp_path: Path) -> None:
    imported = imported_by("--help", status=0, folder=tmp_path)
    assert "typer" in imported
    assert imported & {"pydantic", "yaml", *HEAVY} == set()


@pytest.mark.slow
def test_the_picture_shows_the_rooms_as_they_are() -> None:
    drawn = PICTURE.read_text("utf-8")
    sizes = [int(size.replace(",", "")) for size in re.findall(r">([\d,]+)</text>", drawn)]
    layers = rooms_to_draw(STRUCTURE)
    of_today = [room.lines for layer in reversed(layers) for room in layer]
    # Sizes may age a little; rooms, texts and imports may not.
    assert sizes == pytest.approx(of_today, rel=0.15, abs=200), RENEW
    ages = iter(sizes)
    aged = [[replace(room, lines=next(ages)) for room in layer] for layer in reversed(layers)]
    assert picture(aged[::-1]) == drawn, RENEW


RENEW = f"python scripts/renew.py {PICTURE.relative_to(CHECKOUT)}"


def test_public_classes_name_the_package_as_their_module() -> None:
    """Tracebacks and pickles then do not depend on the file in which a class is."""
    marked = {
        name
        for path in PACKAGE.rglob("*.py")
        for name in re.findall(r"^class (\w+)\(.*\bpublic=True\):", path.read_text("utf-8"), re.M)
    }
    assert marked <= {*brl.__all__}
    for name in brl.__all__:
        value = getattr(brl, name)
        if isinstance(value, type):
            assert value.__module__ == "babyrobot_levels", name
            assert pickle.loads(pickle.dumps(value)) is value
