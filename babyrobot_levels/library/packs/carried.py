"""Packs that installed Python packages carry: found by entry points, without running any code."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from importlib.metadata import Distribution, EntryPoint, distributions
from importlib.util import find_spec
from pathlib import Path

from babyrobot_levels.language.base import SLUG

PACK_GROUP = "babyrobot_levels.packs"
"""The entry-point group of packs: an entry's name is the pack's, its value an import path."""

_NAME = re.compile(SLUG)


@dataclass(frozen=True, slots=True)
class CarriedPack:
    """A pack that an entry point announces.

    Attributes:
        name: the entry's name, which is the pack's.
        value: the entry's value, an import path.
        folder: where its levels are; None if the value leads to no folder, or the name is none.
        distribution: the installed package.
    """

    name: str
    value: str
    folder: Path | None
    distribution: Distribution

    @property
    def has_valid_name(self) -> bool:
        """Whether the name is one that a pack can have."""
        return is_name(self.name)

    @property
    def package(self) -> str:
        """The name and version of the package that carries it, as `pip list` has them."""
        told = (self._metadata(field) for field in ("Name", "Version"))
        return " ".join(filter(None, told)) or "without a name"

    @property
    def package_name(self) -> str | None:
        """The name alone of the package that carries it; None where its files do not tell."""
        return self._metadata("Name")

    def _metadata(self, field: str) -> str | None:
        # As in `_entries`: its files may be damaged.
        with suppress(Exception):
            metadata = self.distribution.metadata
            if field in metadata:
                return metadata[field]
        return None


def carried_packs() -> Iterator[CarriedPack]:
    """Yield the packs of installed packages, in the order in which Python finds the packages."""
    for distribution in distributions():
        for entry in _entries(distribution):
            module = entry.value.partition(":")[0].strip()
            folder = package_folder(module) if is_name(entry.name) else None
            yield CarriedPack(entry.name, entry.value, folder, distribution)


def is_name(text: str) -> bool:
    """Tell whether a pack can be called so."""
    return _NAME.fullmatch(text) is not None


def _entries(distribution: Distribution) -> Sequence[EntryPoint]:
    """Return a package's entry points for packs; none of one that is damaged."""
    try:
        # A look at the text first: most packages have none, and need not be parsed.
        if PACK_GROUP not in (distribution.read_text("entry_points.txt") or ""):
            return ()
        return [entry for entry in distribution.entry_points if entry.group == PACK_GROUP]
    except Exception:
        # Files of other people's packages: whatever is wrong there must stop nobody here.
        return ()


def package_folder(module: str) -> Path | None:
    """Return the folder of an import path without running its packages, or None if it has none.

    A folder inside a package need not be a package itself. What is installed in an archive has no
    folder.
    """
    parts = module.split(".")
    if not all(part.isidentifier() for part in parts):
        return None
    for depth in range(1, len(parts) + 1):
        for location in _locations(".".join(parts[:depth])):
            folder = Path(location, *parts[depth:])
            try:
                if folder.is_dir():
                    return folder
            except OSError:
                # We may not look there, or the name is longer than any can be.
                continue
    return None


def _locations(package: str) -> Sequence[str]:
    """Return the folders of a package; of one inside others, only if a finder knows it by name."""
    try:
        if "." not in package:
            spec = find_spec(package)
            return [*(spec.submodule_search_locations or ())] if spec else ()
        # `find_spec` would run the packages around it. The finders of editable installs need no
        # path to look in.
        for finder in sys.meta_path:
            spec = finder.find_spec(package, [])
            if spec is not None:
                return [*(spec.submodule_search_locations or ())]
    except Exception:
        # Finders are other people's too.
        return ()
    return ()
