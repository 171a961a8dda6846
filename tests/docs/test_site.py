"""The site has all pages, public names and commands; `bash scripts/site.sh` builds it."""

from __future__ import annotations

import ast
import builtins
import inspect
import os
import re
from pathlib import Path

from support.places import DOCS, ROOT

import babyrobot_levels as brl
from babyrobot_levels.cli.commands import COMMANDS
from babyrobot_levels.extensions import sight

# The pages of the rules are added by docs/conf.py, those of the interface by its first page.
FOUND = {*DOCS.glob("*.md"), *ROOT.glob("*.md"), *(ROOT / "notebooks").glob("*.ipynb")}
PAGES = sorted(FOUND - {DOCS / "index.md"})


def test_the_contents_list_every_page() -> None:
    contents = (DOCS / "index.md").read_text("utf-8")
    for page in PAGES:
        name = Path(os.path.relpath(page, DOCS)).with_suffix("").as_posix()
        assert re.search(rf"^(.* <)?{re.escape(name)}>?$", contents, re.MULTILINE), name


def public_names_of_jax() -> list[str]:
    """Return them without an import, which needs JAX."""
    stub = Path(brl.__file__).with_name("jax").joinpath("__init__.pyi").read_text()
    return [
        name.name
        for each in ast.parse(stub).body
        if isinstance(each, ast.ImportFrom)
        for name in each.names
    ]


def test_the_reference_has_every_public_name_once() -> None:
    named: dict[str, list[str]] = {}
    for page in (DOCS / "api").glob("*.md"):
        for module, names in re.findall(
            r"^\.\. currentmodule:: (\S+)\n\n(.*?)^```$", page.read_text("utf-8"), re.M | re.S
        ):
            named.setdefault(module, []).extend(re.findall(r"^\.\. auto\w+:: (\w+)$", names, re.M))
    public = [name for name in brl.__all__ if name != "__version__"]
    assert {module: sorted(names) for module, names in named.items()} == {
        "babyrobot_levels": public,
        "babyrobot_levels.extensions.sight": sorted(sight.__all__),
        "babyrobot_levels.jax": sorted(public_names_of_jax()),
    }


# -- the page on the Python interface ---------------------------------------------------------

ROWS = re.findall(
    r"^\| `babyrobot ([\w-]+)` \| `brl\.(\w+)` \| (.*) \|$",
    (DOCS / "api" / "index.md").read_text("utf-8"),
    re.MULTILINE,
)

UNLIKE = {"list": "levels", "import": "import_"}
"""The functions that cannot have the name of their command."""


def test_each_command_is_a_function_of_its_name() -> None:
    assert [command for command, _, _ in ROWS] == list(COMMANDS)
    for command, name, returned in ROWS:
        assert name == UNLIKE.get(command, command.replace("-", "_"))
        assert name in brl.__all__
        annotation = inspect.signature(getattr(brl, name)).return_annotation
        written = re.sub(r"(?:\w+\.)+(?=\w)|'", "", inspect.formatannotation(annotation))
        assert returned.replace("`", "").replace(" or ", " | ") == written


def test_what_a_function_raises_can_be_caught_by_a_public_name() -> None:
    for name in brl.__all__:
        named = re.findall(
            r"^ *(\w+Error):", inspect.getdoc(getattr(brl, name)) or "", re.MULTILINE
        )
        assert {each for each in named if not hasattr(builtins, each)} <= {*brl.__all__}, name
