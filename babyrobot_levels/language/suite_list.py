"""What gathers levels: suites that list names, files, folders, packs and suites; `pack.yaml`."""

from collections.abc import Iterable, Iterator, Mapping
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import Field, StrictStr, StringConstraints, model_validator

from babyrobot_levels.language.base import Flag, Integer, Model, Number, Slug, Text, form, forms
from babyrobot_levels.language.names import FUNCTION, VERSION
from babyrobot_levels.language.suite import MAX_COUNT, Share, SuiteFields, SuiteTexts, wrong_shares
from babyrobot_levels.text.diagnostics import Issue, Key
from babyrobot_levels.text.errors import InvalidDocument
from babyrobot_levels.text.files import RESERVED
from babyrobot_levels.text.words import did_you_mean

MAX_ENTRIES = 10_000
"""The most entries of a suite, and the most levels and suites that it lists, at any depth."""

MAX_COURSE = 500
"""The most levels of a course."""

KINDS = ("level", "folder", "pack", "suite")
"""What an entry can be; each is the name of a field."""

_NamedOrInline = Annotated[
    Annotated[Text, form("name")] | Annotated[dict[Text, Any], form("mapping")],
    forms(
        "a name, a file, or a mapping of its fields",
        lambda value: "mapping" if isinstance(value, dict) else "name",
    ),
]


class SuiteEntry(Model):
    """Levels of a suite: one, those of a folder or of a pack, or those of another suite."""

    level: _NamedOrInline | None = None
    """A level: a name, a file in the suite's folder, or a mapping of the fields of a level."""
    folder: Text | None = None
    """A folder in the suite's folder: all levels in it, sorted by path."""
    pack: Slug | None = None
    """A pack: all levels in it, sorted by path. `gallery` is the gallery."""
    suite: _NamedOrInline | None = None
    """Another suite: a name, a file in the suite's folder, or a mapping of the fields."""
    split: Slug | None = None
    """A split of the other suite, in place of all its levels."""
    count: Annotated[Integer, Field(ge=1, le=MAX_COUNT)] | None = None
    """How many levels of the other suite, the first ones; all by default."""
    weight: Annotated[Number, Field(gt=0)] | None = None
    """How often its levels are drawn, all together; by default, the number of its levels."""


Entry = Annotated[
    Annotated[Text, form("name")] | Annotated[SuiteEntry, form("mapping")],
    forms(
        "the name of a level, or a mapping",
        lambda value: "mapping" if isinstance(value, dict | Model) else "name",
    ),
]
"""An entry; a text is short for `{level: text}`."""


class SuiteListFields(SuiteTexts):
    """A suite that lists levels, version 1."""

    levels: Annotated[tuple[Entry, ...], Field(min_length=1, max_length=MAX_ENTRIES)]
    """The levels: names, files, and entries that stand for several levels."""
    splits: dict[Slug, Share] = Field(default_factory=dict)
    """The parts of the suite and their shares, which add up to 1. Digests assign levels to them."""
    max_steps: Annotated[Integer, Field(ge=1, le=2**53)] | None = None
    """Episodes are truncated after this many steps. By default, the largest of the levels'."""

    @model_validator(mode="before")
    @classmethod
    def _not_grown(cls, data: Any) -> Any:
        names = {*SuiteFields.model_fields} - {*cls.model_fields}
        issues = [
            Issue(
                "BR206",
                Key((name,)),
                f"`{name}` is for suites that grow mazes; this one lists `levels`",
                f"remove `{name}`, or `levels`",
            )
            for name in (data if isinstance(data, dict) else ())
            if name in names
        ]
        if issues:
            raise InvalidDocument(issues)
        return data

    @model_validator(mode="after")
    def _complete(self) -> Self:
        if issues := [*_wrong_entries(self.levels), *wrong_shares(self.splits)]:
            raise InvalidDocument(issues)
        return self

    def entries(self) -> Iterator[SuiteEntry]:
        """Yield the entries, texts as what they are short for."""
        for entry in self.levels:
            yield SuiteEntry(level=entry) if isinstance(entry, str) else entry


def _wrong_entries(entries: Iterable[str | SuiteEntry]) -> Iterator[Issue]:
    """Yield an error for each entry that is not exactly one of the kinds."""
    for number, entry in enumerate(entries):
        route = ("levels", number)
        if isinstance(entry, str):
            continue
        given = [name for name in KINDS if getattr(entry, name) is not None]
        if not given:
            message = "the entry does not say which levels it adds"
            known = ", ".join(f"`{name}`" for name in KINDS[:-1])
            yield Issue("BR206", route, message, f"add {known} or `{KINDS[-1]}`")
        elif len(given) > 1:
            message = f"`{given[0]}` and `{given[1]}` exclude each other"
            yield Issue("BR206", Key((*route, given[1])), message, "make two entries of them")
        for name in ("split", "count"):
            if getattr(entry, name) is not None and entry.suite is None:
                yield Issue("BR206", Key((*route, name)), f"`{name}` needs a `suite`")


AnySuite = SuiteFields | SuiteListFields
"""The fields of a suite, of either kind."""


def suite_model(data: Any) -> type[SuiteFields] | type[SuiteListFields]:
    """Return the model of a suite: one with `levels` lists them, others grow mazes."""
    return SuiteListFields if isinstance(data, Mapping) and "levels" in data else SuiteFields


Version = Annotated[StrictStr, StringConstraints(pattern=VERSION)]


Function = Annotated[StrictStr, StringConstraints(pattern=FUNCTION, max_length=100)]


class CourseLevel(Model):
    """A level of a course."""

    level: Slug
    """Its name in the pack."""
    points: Annotated[Number, Field(gt=0)] = 1.0
    """What it is worth; the functions that are graded in it share its points evenly."""
    functions: tuple[Function, ...] | None = None
    """The functions that are graded in it; all by default."""
    hidden: Flag = False
    """Whether it is only graded: no page, sheet or pack of the students has it."""


class PackFields(Model):
    """A pack: a folder of levels, suites and themes that is shared as a unit.

    A pack with `levels` is a course: it tells their order and their points.
    """

    BEGINNING: ClassVar[str] = (
        "a pack.yaml has a `name`, a `version` such as `1.0.0`, and a `description`"
    )

    name: Slug
    """What its levels are found under: `name/level`."""
    version: Version
    """The version of the pack, three numbers such as `1.0.0`; a later one takes its place."""
    description: Text
    """What the pack is, for people."""
    author: Text | None = None
    """Who made it."""
    license: Text | None = None
    """Under which licence it may be used."""
    source: Text | None = None
    """Where the worlds are from: a citation."""
    title: Text | None = None
    """The title of the course; by default, the name."""
    functions: dict[Function, Literal["values", "policy", "agent"]] = Field(default_factory=dict)
    """What students write: NAME.py with a function NAME, and as what its result is graded."""
    given: tuple[Text, ...] = ()
    """Further files that students get, such as `tools.py`."""
    levels: Annotated[tuple[CourseLevel, ...], Field(max_length=MAX_COURSE)] = ()
    """The levels of the course, in their order."""

    def graded_in(self, level: CourseLevel) -> tuple[str, ...]:
        """Return the functions that are graded in a level."""
        return (*self.functions,) if level.functions is None else level.functions

    @model_validator(mode="after")
    def _known(self) -> Self:
        issues, seen = [], set[str]()
        for number, each in enumerate(self.levels):
            if each.level in seen:
                message = f"`{each.level}` is listed twice"
                issues.append(Issue("BR207", ("levels", number, "level"), message, "remove one"))
            seen.add(each.level)
            for index, name in enumerate(each.functions or ()):
                if name not in self.functions:
                    message = f"unknown function `{name}`{did_you_mean(name, self.functions)}"
                    route = ("levels", number, "functions", index)
                    issues.append(Issue("BR207", route, message, "add it to `functions`"))
        if issues:
            raise InvalidDocument(issues)
        return self

    @model_validator(mode="after")
    def _portable(self) -> Self:
        if self.name in RESERVED:
            message = f"no folder can be called `{self.name}` on Windows"
            raise InvalidDocument([Issue("BR207", ("name",), message, "choose another name")])
        return self


def version_order(version: str) -> tuple[int, ...]:
    """Return a version's numbers, by which versions are compared."""
    return tuple(int(number) for number in version.split("."))
