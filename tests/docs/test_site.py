"""The documentation site has all pages and all public names; `bash scripts/site.sh` builds it."""

from __future__ import annotations

import ast
import os
import re
from pathlib import Path

import pytest
from support.places import DOCS, ROOT

import babyrobot_levels as brl

# The pages of the rules are added by docs/conf.py, those of the interface by its first page.
FOUND = {*DOCS.glob("*.md"), *ROOT.glob("*.md"), *(ROOT / "notebooks").glob("*.ipynb")}
PAGES = sorted(FOUND - {DOCS / "index.md"})


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_the_contents_list_every_page(page: Path) -> None:
    name = Path(os.path.relpath(page, DOCS)).with_suffix("").as_posix()
    contents = (DOCS / "index.md").read_text("utf-8")
    assert re.search(rf"^(.* <)?{re.escape(name)}>?$", contents, re.MULTILINE)


def public_names_of_jax() -> list[str]:
    """Return them without an import, which needs JAX."""
    module = ast.parse(Path(brl.__file__).with_name("jax").joinpath("__init__.py").read_text())
    values = [
        each.value
        for each in module.body
        if isinstance(each, ast.Assign) and ast.unparse(each.targets[0]) == "__all__"
    ]
    return [*ast.literal_eval(values[0])]


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
        "babyrobot_levels.jax": sorted(public_names_of_jax()),
    }
