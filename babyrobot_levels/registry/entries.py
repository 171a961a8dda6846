"""The tables of what the package has, by name, with what the extensions that are installed add.

Distributions are asked for extensions by the entry points of `GROUP`, and only for a name that the
package itself does not have, or for a list of all: reading their metadata takes a while. No level,
pack, play or link leads to this: names come from what users type, and from their programs.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, fields
from functools import cache
from importlib import import_module
from pkgutil import iter_modules
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from babyrobot_levels.registry.manifest import Command, Extension
from babyrobot_levels.text.diagnostics import one_line
from babyrobot_levels.text.errors import DISTRIBUTION, BabyRobotError

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

GROUP = "babyrobot_levels.extensions"

_FOLDER = "babyrobot_levels.extensions"

OWN_CODES = "BR"
"""What the codes of the package's own rules begin with, and no other."""

KINDS = tuple(each.name for each in fields(Extension) if each.name not in ("summary", "needs"))
"""The kinds of things that extensions add."""

Entry = TypeVar("Entry")


class ExtensionError(BabyRobotError):
    """An extension of another distribution, or what it adds, cannot be used."""

    __module__ = "babyrobot_levels"


@dataclass(frozen=True, slots=True)
class Installed:
    """An extension that is installed.

    Attributes:
        name: its name.
        distribution: the distribution that has it, and its version.
        extension: its manifest; None if it cannot be loaded.
        fault: why it cannot.
    """

    name: str
    distribution: str
    extension: Extension | None
    fault: str | None = None

    def added(self, kind: str) -> Mapping[str, Any]:
        """Return what it adds of a kind, by name."""
        found: Mapping[str, Any] = getattr(self.extension, kind, {})
        return found

    @property
    def summary(self) -> str:
        """What it is for, in one line."""
        return one_line(self.extension.summary) if self.extension else ""

    def words(self) -> list[str]:
        """Return what it adds in words: `formats crawl`."""
        return [
            f"{kind if len(names) > 1 else kind[:-1]} {', '.join(map(one_line, names))}"
            for kind in KINDS
            if (names := self.added(kind))
        ]

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain data."""
        adds = {kind: [*self.added(kind)] for kind in KINDS if self.added(kind)}
        about = {"name": self.name, "from": self.distribution, "summary": self.summary}
        return {**about, "adds": adds, "fault": self.fault}

    def faults(self) -> list[str]:
        """Return why it cannot be used, or what of it: names that are taken already."""
        if self.fault:
            return [f"{self.name} ({self.distribution}): {self.fault}"]
        return [
            f"{self.name} ({self.distribution}): {one_line(name)}, one of its {kind}, is taken"
            for kind in KINDS
            for name in self.added(kind)
            if kind in TABLES and TABLES[kind].others.get(name) is not self
        ]


@cache
def built_in(name: str) -> Extension:
    """Return the manifest of an extension of the package, by the name of its folder."""
    found: Extension = resolve(f"{_FOLDER}.{name}.extension:EXTENSION")
    return found


def all_built_in(version: str) -> list[Installed]:
    """Return the extensions of the package, which has a version."""
    names = sorted(each.name for each in iter_modules(import_module(_FOLDER).__path__))
    return [Installed(name, f"{DISTRIBUTION} {version}", built_in(name)) for name in names]


@cache
def installed() -> tuple[Installed, ...]:
    """Return the extensions that are installed, by name; those that are broken say why."""
    from importlib.metadata import entry_points

    return tuple(map(_loaded, sorted(entry_points(group=GROUP), key=_order)))


def _order(entry: EntryPoint) -> tuple[str, str]:
    return entry.name, _distribution_of(entry)


def _distribution_of(entry: EntryPoint) -> str:
    return one_line(f"{entry.dist.name} {entry.dist.version}") if entry.dist else "unknown"


def _loaded(entry: EntryPoint) -> Installed:
    name, distribution = one_line(entry.name), _distribution_of(entry)
    try:
        extension = entry.load()
        _check(extension)
    except (Exception, SystemExit) as error:
        # Whatever is wrong with an extension of somebody else breaks nothing but this.
        return Installed(name, distribution, None, _reason(error))
    return Installed(name, distribution, extension)


def _check(extension: Any) -> None:
    """Refuse what is no manifest, or says something else than names and places."""
    if not isinstance(extension, Extension):
        raise TypeError(f"the entry point is no Extension, but of type {type(extension).__name__}")
    for kind in KINDS:
        if not isinstance(getattr(extension, kind), Mapping):
            raise TypeError(f"{kind} must be a mapping of names, not {getattr(extension, kind)!r}")
        wanted = Command if kind == "commands" else str
        for name, value in getattr(extension, kind).items():
            if not isinstance(name, str) or not isinstance(value, wanted):
                raise TypeError(f"{kind} has {name!r}: {value!r}, which is no {wanted.__name__}")
            if kind == "rules" and name.startswith(OWN_CODES):
                raise ValueError(f"rules has {name}: the package itself has {OWN_CODES}…")


def _reason(error: BaseException) -> str:
    return one_line(f"{type(error).__name__}: {error}".removesuffix(": "))[:300]


class Entries(Mapping[str, Entry], Generic[Entry]):
    """What the package has of a kind by name, and what extensions add to it.

    What the package has comes first, and cannot be replaced.
    """

    def __init__(
        self, kind: str, own: Mapping[str, Entry], is_entry: Callable[[Any], bool] = callable
    ):
        """Make a table of one of `KINDS`.

        Args:
            kind: the kind.
            own: what the package has of it.
            is_entry: whether something that an extension names is of this kind.
        """
        self.kind, self.own, self._is_entry = kind, own, is_entry
        self._found: dict[str, Entry] = {}
        TABLES[kind] = self

    def __getitem__(self, name: str) -> Entry:
        if name in self.own:
            return self.own[name]
        if name not in self._found:
            added = self.others[name].added(self.kind)
            self._found[name] = self._load(name, added[name])
        return self._found[name]

    def __contains__(self, name: object) -> bool:
        return name in self.own or name in self.others

    def __iter__(self) -> Iterator[str]:
        yield from self.own
        yield from self.others

    def __len__(self) -> int:
        return len(self.own) + len(self.others)

    def added(self) -> Iterator[tuple[str, Entry]]:
        """Yield what extensions add by name, but for what is broken."""
        for name in self.others:
            with suppress(ExtensionError):
                yield name, self[name]

    @property
    def others(self) -> Mapping[str, Installed]:
        """The names that extensions add, each with the first one that does."""
        found: dict[str, Installed] = {}
        for each in installed():
            for name in each.added(self.kind):
                if name not in self.own:
                    found.setdefault(name, each)
        return found

    def imported(self, name: str, place: str) -> Any:
        """Import what an extension says to be at a place.

        Raises:
            ExtensionError: it cannot be imported.
        """
        try:
            return resolve(place)
        except (Exception, SystemExit) as error:
            raise self._unusable(name, _reason(error)) from error

    def _load(self, name: str, value: Any) -> Entry:
        found: Any = value if isinstance(value, Command) else self.imported(name, value)
        if not self._is_entry(found):
            raise self._unusable(name, f"what is there is of type {type(found).__name__}")
        entry: Entry = found
        return entry

    def _unusable(self, name: str, reason: str) -> ExtensionError:
        by = self.others[name]
        return ExtensionError(
            f"{one_line(name)}, one of the {self.kind} of the extension {by.name} "
            f"({by.distribution}), cannot be used: {reason}"
        )


TABLES: dict[str, Entries[Any]] = {}
"""The tables that have been made so far, by kind."""


def resolve(place: str) -> Any:
    """Import what is at a place, as `package.module:name`."""
    module, _, name = place.partition(":")
    return getattr(import_module(module), name)
