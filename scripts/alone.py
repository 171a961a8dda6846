"""Run the tests of one extension without the others: only what its manifest needs is there.

Usage: python scripts/alone.py [NAME ...] [-- PYTEST ...]

Without names, it does so for each extension in turn. Other extensions cannot be imported, and their
lines are gone from the table of commands, as if their folders were deleted. Tests marked `beside`
another extension that is gone are left out. What follows `--` are arguments of pytest, by default
those of the fast tests, or of all but the sweep where none is fast. The status is 1 if anything
fails.

It is a plugin of pytest, too: `-p alone`, with the extension in `ALONE`.
"""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterable, Sequence
from importlib import import_module
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
EXTENSIONS = "babyrobot_levels.extensions"
FAST, ALL = (["-q", "-m", f"not {kind} and not libraries"] for kind in ("slow", "sweep"))

NO_TESTS = 5
"""The status of pytest where it collects nothing."""


def names() -> list[str]:
    """Return the names of all extensions."""
    folder = ROOT / "babyrobot_levels" / "extensions"
    return sorted(path.parent.name for path in folder.glob("*/extension.py"))


def needed(name: str) -> set[str]:
    """Return an extension with all that it needs, directly or by others."""
    found: set[str] = set()
    waiting = [name]
    while waiting:
        each = waiting.pop()
        if each not in found:
            found.add(each)
            waiting += import_module(f"{EXTENSIONS}.{each}.extension").EXTENSION.needs
    return found


class Gone:
    """Finds none of the extensions that are gone."""

    def __init__(self, gone: Iterable[str]):
        self._gone = {f"{EXTENSIONS}.{each}" for each in gone}

    def find_spec(self, name: str, path: Any = None, target: Any = None) -> None:
        """Refuse to import what is gone.

        Raises:
            ModuleNotFoundError: it is gone.
        """
        if ".".join(name.split(".")[:3]) in self._gone:
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)


def delete_others(name: str) -> None:
    """Take away all extensions but one and those that it needs."""
    gone = {*names()} - needed(name)
    for module in [*sys.modules]:
        if ".".join(module.split(".")[:3]) in {f"{EXTENSIONS}.{each}" for each in gone}:
            del sys.modules[module]
    sys.meta_path.insert(0, Gone(gone))
    commands: Any = import_module("babyrobot_levels.cli.commands")
    for command, place in [*commands._OWN.items()]:
        if place in gone:
            del commands._OWN[command]


def pytest_configure() -> None:
    """Take away the others before pytest collects anything."""
    if name := os.environ.get("ALONE"):
        delete_others(name)


def pytest_collection_modifyitems(config: Any, items: list[Any]) -> None:
    """Leave out the tests that also ask an extension that is gone."""
    name = os.environ.get("ALONE")
    if name is not None:
        there = needed(name)
        out = [
            item
            for item in items
            if not there.issuperset(
                each for mark in item.iter_markers("beside") for each in mark.args
            )
        ]
        config.hook.pytest_deselected(items=out)
        items[:] = [item for item in items if item not in out]


def test(name: str, options: Sequence[str]) -> int:
    """Run the tests of an extension in a process of their own; return the status."""
    call = [sys.executable, "-m", "pytest", "-p", "alone", *options, f"tests/extensions/{name}"]
    there = {"ALONE": name, "PYTHONPATH": str(Path(__file__).parent)}
    return subprocess.run(call, cwd=ROOT, env={**os.environ, **there}, check=False).returncode


def main(arguments: Sequence[str]) -> int:
    """Run the tests of extensions; return the status."""
    cut = arguments.index("--") if "--" in arguments else len(arguments)
    failed = []
    for name in arguments[:cut] or names():
        print(f"{name}, with {', '.join(sorted(needed(name) - {name})) or 'no other'}", flush=True)
        status = test(name, arguments[cut + 1 :] or FAST)
        if status == NO_TESTS and cut == len(arguments):
            status = test(name, ALL)
        failed += [name] * (status != 0)
    print(f"failed: {', '.join(failed)}" if failed else "each of them stands alone")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.path.insert(0, str(ROOT))
    sys.exit(main(sys.argv[1:]))
