"""Exceptions as users meet them."""

from __future__ import annotations

import importlib.metadata
import re
import shlex
import tomllib
from pathlib import Path

import pytest
from support.places import ROOT
from support.subprocesses import run

from babyrobot_levels.text.errors import how_to_install

CODE = """\
from IPython.core.interactiveshell import InteractiveShell

cells = (
    "import gymnasium, babyrobot_levels as brl\\nlevel = brl.loads('sise: 3')",
    "brl.make('final-mase')",
    "gymnasium.make('babyrobot/Level-v0', level='final-mase')",
)
for cell in cells:
    InteractiveShell.instance().run_cell(cell)
"""


@pytest.mark.slow
def test_in_a_notebook_an_error_shows_the_call_and_the_diagnostics(tmp_path: Path) -> None:
    shown = re.sub("\x1b\\[[0-9;]*m", "", run(CODE, tmp_path))
    assert "level = brl.loads('sise: 3')" in shown
    assert "<text>:1:1: error BR201: unknown field `sise`; did you mean `size`?" in shown
    assert "brl.make('final-mase')" in shown
    assert "level='final-mase')" in shown
    assert shown.count("there is no level called 'final-mase'; did you mean") == 2
    assert "babyrobot_levels/" not in shown.replace("\\", "/")
    assert "site-packages" not in shown


EXTRAS = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"][
    "optional-dependencies"
]


@pytest.mark.parametrize("quote", ["'", '"'])
@pytest.mark.parametrize("extra", ["editor", "fast", "jax", "minari", "ray", "rllib", "sb3"])
def test_the_packages_of_an_extra_are_named(
    extra: str, quote: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    # As the tools that build write them; what is installed may be older than the file.
    known = [
        f"{package}; python_version >= '3.11' and extra == {quote}{name}{quote}"
        for name, packages in EXTRAS.items()
        for package in packages
    ]
    monkeypatch.setattr(importlib.metadata, "requires", lambda _: ["numpy>=1.26", *known])
    told, _, command = how_to_install(extra).partition(": ")
    assert told == f"install the extra `{extra}`"
    pip, install, *packages = shlex.split(command)
    assert (pip, install) == ("pip", "install")
    assert sorted(packages) == sorted(EXTRAS[extra])


def test_where_nothing_is_known_of_the_distribution_it_is_a_clone(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def missing(name: str) -> None:
        raise importlib.metadata.PackageNotFoundError(name)

    monkeypatch.setattr(importlib.metadata, "requires", missing)
    assert how_to_install("ray") == 'install the extra `ray`: pip install ".[ray]"'


def test_no_message_asks_an_index_for_this_distribution() -> None:
    """Before a release, no index has it."""
    sources = [*(ROOT / "babyrobot_levels").rglob("*.py"), *(ROOT / "examples").glob("*.py")]
    for path in map(Path, sources):
        text = path.read_text("utf-8")
        assert not re.search(r"""pip install ['"\\]*babyrobot""", text), path
        assert "babyrobot-levels with the extra" not in text, path
