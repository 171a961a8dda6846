"""A Python package with a pack, as its page says how to write one: built, installed, and used."""

from __future__ import annotations

import json
import re
import tomllib
from pathlib import Path

import pytest
from support.carriers import write
from support.places import DOCS
from support.subprocesses import python, run

PAGE = DOCS / "packs.md"
SECTION = PAGE.read_text(encoding="utf-8").partition("## A pack in a Python package\n")[2]

FILES = {
    "__init__.py": "raise SystemExit('a pack is found without running anything')\n",
    "pack.yaml": "name: zoo\nversion: 1.2.0\ndescription: Where animals get lost\n"
    "author: A. Keeper\nlicense: CC0-1.0\n",
    "lion.yaml": "version: 1\ntitle: The lion\nsize: [4, 3]\nmaze: {seed: 3}\nmax_steps: 40\n",
    "apes/gorilla.yaml": "version: 1\nsize: [3, 2]\ntheme: jungle\ntags: [apes]\n",
    "suites/monkeys.yaml": "version: 1\nkind: suite\nseed: 1\ncount: 5\nsize: [4, 4]\nmaze: {}\n"
    "theme: jungle\n",
    "themes/jungle.yaml": "colors: {base: '#123456'}\n",
}


def block(language: str) -> str:
    """Return the section's one block in a language."""
    (found,) = re.findall(rf"^```{language}\n(.*?)^```", SECTION, re.MULTILINE | re.DOTALL)
    return str(found)


def shown_files() -> set[str]:
    """Return the files that the section's tree shows, without the folder around them."""
    return {line.strip() for line in block("text").splitlines() if not line.endswith("/")}


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    project = tmp_path_factory.mktemp("zoo-mazes")
    write(project / "pyproject.toml", block("toml"))
    for name, text in FILES.items():
        write(project / "zoo_mazes" / name, text)
    target = tmp_path_factory.mktemp("built")
    call = ("-m", "build", "--wheel", "--no-isolation", "--outdir", target, project)
    done = python("-W", "ignore", *call, cwd=project, timeout=120)
    assert done.returncode == 0, done.stdout + done.stderr
    (built,) = target.iterdir()
    return built


@pytest.fixture(scope="module")
def site(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder into which the package was installed."""
    folder = tmp_path_factory.mktemp("site")
    call = ("-m", "pip", "install", "--quiet", "--no-deps", "--no-index", "--target", folder, wheel)
    done = python("-W", "ignore", *call, cwd=folder, timeout=120)
    assert done.returncode == 0, done.stdout + done.stderr
    return folder


@pytest.fixture(autouse=True)
def nobodys(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    monkeypatch.delenv("BABYROBOT_LEVELS", raising=False)


def babyrobot(site: Path, cwd: Path, *arguments: str) -> str:
    """Return what a command prints, which must succeed and not complain."""
    done = python("-m", "babyrobot_levels", *arguments, cwd=cwd, path=site)
    complaints = [line for line in done.stderr.splitlines() if not line.startswith("wrote ")]
    assert (done.returncode, complaints) == (0, [])
    return done.stdout


def test_the_page_shows_what_was_built() -> None:
    assert shown_files() == {*FILES, "pyproject.toml"}
    assert len(block("toml").splitlines()) <= 10
    (name,) = tomllib.loads(block("toml"))["project"]["entry-points"].values()
    assert name == {"zoo": "zoo_mazes"}


def test_what_the_page_says_works(site: Path, tmp_path: Path) -> None:
    code = block("python") + "\nimport sys\nprint('zoo_mazes' in sys.modules)\n"
    assert run(code, tmp_path, site) == "False\n"


def test_the_command_line(site: Path, tmp_path: Path) -> None:
    assert babyrobot(site, tmp_path, "list", "--tag", "apes") == (
        "NAME         SIZE  TITLE  TAGS  FROM\nzoo/gorilla  3x2          apes  pack zoo\n"
    )
    assert babyrobot(site, tmp_path, "list", "--packs") == (
        "NAME  VERSION  LEVELS  SUITES  FROM                     DESCRIPTION\n"
        "zoo   1.2.0    2       1       package zoo-mazes 1.0.0  Where animals get lost\n"
    )
    (told,) = json.loads(babyrobot(site, tmp_path, "list", "--packs", "--format", "json"))
    assert told == {
        "name": "zoo",
        "version": "1.2.0",
        "description": "Where animals get lost",
        "author": "A. Keeper",
        "license": "CC0-1.0",
        "source": None,
        "levels": 2,
        "suites": 1,
        "from": "package zoo-mazes 1.0.0",
        "folder": str(site / "zoo_mazes"),
        "hides": [],
    }
    assert "expected return: -2\n" in babyrobot(site, tmp_path, "solve", "zoo/gorilla")
    babyrobot(site, tmp_path, "preview", "zoo/gorilla", "-o", "gorilla.svg")
    assert "#123456" in (tmp_path / "gorilla.svg").read_text(encoding="utf-8")
    files = [str(site / "zoo_mazes" / name) for name in FILES if name.startswith(("lion", "apes"))]
    assert babyrobot(site, tmp_path, "validate", *files) == "2 files checked, all valid\n"


def test_a_pack_of_the_users_hides_it(site: Path, tmp_path: Path) -> None:
    mine = tmp_path / "data" / "babyrobot-levels" / "packs" / "zoo"
    write(mine / "lion.yaml", "version: 1\ntitle: My lion\n")
    done = python("-m", "babyrobot_levels", "list", "--packs", cwd=tmp_path, path=site)
    assert done.stdout == (
        "NAME  VERSION  LEVELS  SUITES  FROM    DESCRIPTION\n"
        "zoo   -        1       0       folder\n"
    )
    assert done.stderr == "zoo (package zoo-mazes 1.0.0) is hidden by zoo (folder)\n"
    call = ("list", "--packs", "--format", "json")
    done = python("-m", "babyrobot_levels", *call, cwd=tmp_path, path=site)
    (told,) = json.loads(done.stdout)
    assert told["hides"] == [{"from": "package zoo-mazes 1.0.0", "folder": str(site / "zoo_mazes")}]
    code = "import babyrobot_levels as b; print(b.load('zoo/lion').title)"
    assert run(code, tmp_path, site) == "My lion\n"
