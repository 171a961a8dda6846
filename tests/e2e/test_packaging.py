"""The package as users get it: built from a clean copy, installed, and used far from the source."""

from __future__ import annotations

import ast
import email
import os
import subprocess
import sys
import tarfile
import venv
import zipfile
from collections.abc import Sequence
from importlib.metadata import packages_distributions
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from support.places import ROOT

from babyrobot_levels import __version__


def run(command: Sequence[str | Path], cwd: Path) -> str:
    """Run a command far from the checkout and return what it prints; it must succeed."""
    variables = {
        name: value
        for name, value in os.environ.items()
        if not name.startswith(("PYTHON", "BABYROBOT", "COVERAGE"))
    }
    done = subprocess.run(
        [str(word) for word in command],
        cwd=cwd,
        env={**variables, "XDG_DATA_HOME": str(cwd / "nobody"), "PYTHONUTF8": "1"},
        capture_output=True,
        text=True,
        encoding="utf-8",
        timeout=120,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def tracked_files() -> list[str]:
    """Return the files that belong to the project: those under version control."""
    if not (ROOT / ".git").exists():
        return [
            path.relative_to(ROOT).as_posix()
            for path in ROOT.rglob("*")
            if path.is_file() and "__pycache__" not in path.parts
        ]
    listed = run(["git", "ls-files", "-z"], ROOT).split("\0")
    return [name for name in listed if name and (ROOT / name).is_file()]


def build(kind: str, source: Path, target: Path) -> Path:
    """Build a `wheel` or an `sdist` without a network: with the installed hatchling."""
    run([sys.executable, "-m", "build", f"--{kind}", "--no-isolation", "-o", target, source],
        source)  # fmt: skip
    (built,) = target.iterdir()
    return built


@pytest.fixture(scope="module")
def source(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("source")
    for name in tracked_files():
        target = folder / name
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes((ROOT / name).read_bytes())
    return folder


@pytest.fixture(scope="module")
def sdist(source: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return build("sdist", source, tmp_path_factory.mktemp("sdist"))


@pytest.fixture(scope="module")
def wheel(source: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return build("wheel", source, tmp_path_factory.mktemp("wheel"))


def contents(wheel: Path) -> dict[str, bytes]:
    with zipfile.ZipFile(wheel) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def info(wheel: Path, name: str) -> str:
    """Return a file of the wheel's metadata."""
    (found,) = [
        data
        for path, data in contents(wheel).items()
        if path.endswith(f".dist-info/{name}") and path.startswith("babyrobot_levels-")
    ]
    return found.decode()


def test_the_wheel_holds_the_package_and_its_data(wheel: Path) -> None:
    held = contents(wheel)
    inside = {name for name in held if not name.startswith("babyrobot_levels-")}
    wanted = {name for name in tracked_files() if name.startswith("babyrobot_levels/")}
    data = {
        f"babyrobot_levels/data/{name}"
        for name in tracked_files()
        if name.startswith(("course/", "levels/", "schemas/"))
    }
    assert "babyrobot_levels/py.typed" in inside
    assert "babyrobot_levels/data/course/grade.py" in data
    assert "babyrobot_levels/data/levels/final-maze.yaml" in data
    assert "babyrobot_levels/data/levels/order.txt" in data
    assert "babyrobot_levels/data/schemas/level.schema.json" in data
    assert inside == wanted | data
    for name in data:
        assert held[name] == (ROOT / name.removeprefix("babyrobot_levels/data/")).read_bytes()


def test_the_metadata(wheel: Path) -> None:
    metadata = email.message_from_string(info(wheel, "METADATA"))
    assert (metadata["Name"], metadata["Version"]) == ("babyrobot-levels", __version__)
    assert metadata["License-Expression"] == "BSD-3-Clause"
    assert metadata["License-File"] == "LICENSE"
    assert info(wheel, "licenses/LICENSE") == (ROOT / "LICENSE").read_text(encoding="utf-8")
    assert metadata["Requires-Python"] == ">=3.11"
    assert metadata["Description-Content-Type"] == "text/markdown"
    assert metadata.get_payload() == (ROOT / "README.md").read_text(encoding="utf-8")
    assert "babyrobot = babyrobot_levels.cli.app:main" in info(wheel, "entry_points.txt")


def imported_packages() -> set[str]:
    """Return the foreign packages that the code imports, at the top or when it needs them."""
    found = set()
    for path in (ROOT / "babyrobot_levels").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Import):
                found |= {alias.name.partition(".")[0] for alias in node.names}
            elif isinstance(node, ast.ImportFrom) and node.module:
                found.add(node.module.partition(".")[0])
    return found - set(sys.stdlib_module_names) - {"babyrobot_levels"}


def test_the_dependencies_are_what_the_code_imports(wheel: Path) -> None:
    lines = email.message_from_string(info(wheel, "METADATA")).get_all("Requires-Dist") or []
    extras = (
        *("arc", "editor", "exact", "fast", "jax", "mcp", "minari", "parquet", "pettingzoo", "ray"),
        *("sb3", "umb"),
    )
    declared = {
        each.name.lower()
        for each in map(Requirement, lines)
        if each.marker is None
        or any(
            # Some are for newer versions of Python only.
            each.marker.evaluate({"extra": name, "python_version": "3.14"})
            for name in extras
        )
    }
    owners = packages_distributions()
    # What is not installed is called as the package is.
    used = {
        owners.get(name, [name])[0].lower().replace("_", "-")
        # Whoever gives a model of PyTorch has it.
        for name in imported_packages() - {"pydantic_core", "torch"}
    }
    assert used <= declared


def test_the_sdist_builds_the_same_wheel(
    sdist: Path, wheel: Path, tmp_path_factory: pytest.TempPathFactory
) -> None:
    folder = tmp_path_factory.mktemp("unpacked")
    with tarfile.open(sdist) as archive:
        # The first releases of Python 3.11 cannot tell it which files are to be refused.
        archive.extraction_filter = getattr(tarfile, "data_filter", None)
        archive.extractall(folder)
    (unpacked,) = folder.iterdir()
    again = build("wheel", unpacked, tmp_path_factory.mktemp("wheel-of-sdist"))
    assert contents(again) == contents(wheel)


def test_the_sdist_holds_the_tests_and_the_papers(sdist: Path) -> None:
    with tarfile.open(sdist) as archive:
        names = {name.partition("/")[2] for name in archive.getnames()}
    for name in tracked_files():
        if name.startswith(("babyrobot_levels/", "levels/", "schemas/", "tests/", "docs/")):
            assert name in names
    assert {"LICENSE", "README.md", "CHANGELOG.md", "cli.md", "pyproject.toml"} <= names
    assert not [name for name in names if "__pycache__" in name or ".hypothesis" in name]


@pytest.fixture(scope="module")
def installed(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the programs' folder of an environment with the wheel and the dependencies."""
    folder = tmp_path_factory.mktemp("environment")
    venv.create(folder, with_pip=False)
    programs = folder / ("Scripts" if sys.platform == "win32" else "bin")
    run([sys.executable, "-m", "pip", "--python", programs / "python", "install", "--no-index",
         "--no-deps", "--quiet", wheel], folder)  # fmt: skip
    site = run([programs / "python", "-c", "import site; print(site.getsitepackages()[0])"], folder)
    # The dependencies are those of this environment, behind the installed package; its own
    # .pth files, such as that of an editable install, are not read from there.
    import numpy

    others = Path(numpy.__file__).parents[1]
    Path(site.strip(), "dependencies.pth").write_text(f"{others}\n", encoding="utf-8")
    return programs


def test_the_installed_package_is_complete(installed: Path, tmp_path: Path) -> None:
    place = run([installed / "python", "-c", "import babyrobot_levels as b; print(b.__file__)"],
                tmp_path)  # fmt: skip
    assert Path(place.strip()).is_relative_to(installed.parent)
    assert run([installed / "babyrobot", "--version"], tmp_path).strip().endswith(__version__)


def test_the_installed_gallery(installed: Path, tmp_path: Path) -> None:
    lines = run([installed / "babyrobot", "list"], tmp_path).splitlines()
    files = [name.split("/") for name in tracked_files()]
    gallery = [parts for parts in files
               if parts[0] == "levels" and parts[-1].endswith(".yaml")
               and not {"themes", "suites"} & {*parts}]  # fmt: skip
    assert len(lines) == 1 + len(gallery)
    assert str(ROOT) not in run([installed / "babyrobot", "list", "--format", "json"], tmp_path)
    assert "+---+" in run([installed / "babyrobot", "show", "final-maze"], tmp_path)
