"""The kinds of what can stand in a level, one record each.

Lists of kinds are derived from `KINDS`, and written nowhere else: what the editor erases, what the
linter looks through, what differs between two levels, how messages and rules call a kind.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from dataclasses import field as dataclass_field
from functools import cached_property
from typing import Any, Literal

from babyrobot_levels.language import drawing as d
from babyrobot_levels.language.base import Model
from babyrobot_levels.language.cells import (
    GLASS_PASS,
    Area,
    Opening,
    Puddle,
    Rectangle,
    Traits,
    Wall,
    Warp,
    Wind,
)
from babyrobot_levels.language.things import (
    DRAWN_NAMES,
    Box,
    Door,
    Item,
    LegendEntry,
    Mover,
    Switch,
    Target,
    TeamRobot,
)

LOOKS = frozenset({"color", "fit", "label", "shape", "width"})
"""The fields of entries that only pictures show."""


Where = Literal["cell", "rectangle", "side", "path", "line"]
"""What a kind stands on; a line is a column or a row."""


@dataclass(frozen=True, slots=True)
class Need:
    """The words for a kind that doors and exits can need.

    Attributes:
        get: what to do, as in "fetch the key".
        getting: the same as a noun, as in "by taking it".
        met: what it is when that is done: "held".
        unmet: what it is before: "not held".
    """

    get: str = ""
    getting: str = ""
    met: str = ""
    unmet: str = ""


@dataclass(frozen=True)
class Kind:
    """A kind of what can stand in a level.

    Attributes:
        name: its name, by which code and the legend of drawings know it.
        field: the field of a level that gives it.
        where: what it stands on.
        model: the model of an entry of its field; None for one that holds bare cells.
        noun: what it is called; its name by default.
        marks: the characters of drawings that show it, each with the fields of the entry.
        by_lot: the field of a level that gives several, of which one is drawn at each reset.
        state: what of it changes during an episode, in words; empty if nothing does.
        need: its words, if doors and exits can need it; else they are empty.
        label: what an entry is called; by its name, or as the kind, by default.
        other_names: what other programs call it, to find what an unknown field is meant to be.
    """

    name: str
    field: str
    where: Where
    model: type[Model] | None = None
    noun: str = ""
    marks: Mapping[str, Mapping[str, Any]] = dataclass_field(default_factory=dict)
    by_lot: str = ""
    state: str = ""
    need: Need = Need()
    label: Callable[[Any], str] | None = None
    other_names: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "noun", self.noun or self.name)

    @property
    def plural(self) -> str:
        """What several of it are called."""
        return f"{self.noun}{'es' if self.noun.endswith(('ch', 'x')) else 's'}"

    @property
    def one(self) -> str:
        """Its noun with the indefinite article."""
        return f"{'an' if self.noun[0] in 'aeiou' else 'a'} {self.noun}"

    @property
    def fields(self) -> tuple[str, ...]:
        """The fields of a level that give it."""
        return (self.field, self.by_lot) if self.by_lot else (self.field,)

    @cached_property
    def properties(self) -> tuple[str, ...]:
        """The names of the fields of an entry, as files have them."""
        fields = {} if self.model is None else self.model.model_fields
        return tuple(info.alias or name for name, info in fields.items())

    @property
    def has_name(self) -> bool:
        """Whether its entries have names, unique among all of the level."""
        return "name" in self.properties

    @property
    def is_listed(self) -> bool:
        """Whether its field is a list of entries."""
        return self.model is not None and self.where != "line"

    @cached_property
    def legend(self) -> tuple[str, ...]:
        """The fields of an entry of the legend that stands for it; none if no such entry can."""
        if self.name not in DRAWN_NAMES:
            return (*Traits.model_fields,) if self.model is Area else ()
        known = [name for name in self.properties if name in LegendEntry.model_fields]
        return (self.name, *sorted(known, key=lambda name: name in Traits.model_fields))

    def entry(self, data: Mapping[str, Any]) -> Model:
        """Return an entry of its field."""
        assert self.model is not None
        return self.model.model_validate(data)

    def mark_of(self, entry: Any) -> str:
        """Return the character of drawings that shows an entry."""
        return next(
            mark
            for mark, given in self.marks.items()
            if all(getattr(entry, name) == value for name, value in given.items())
        )

    def called(self, entry: Any) -> str:
        """Return what an entry is called."""
        if self.label is not None:
            return self.label(entry)
        return str(entry.name) if self.has_name else self.name

    def of(self, level: Any) -> tuple[Any, ...]:
        """Return the entries of a level."""
        entries: tuple[Any, ...] = getattr(level, self.field)
        return entries


def _door_label(door: Door) -> str:
    needs = [f"needs {', '.join(door.keys)}"] if door.keys else []
    unless = [f"unless {', '.join(door.locks)}"] if door.locks else []
    return ", ".join(["door", *needs, *unless])


KINDS = (
    Kind(
        "item",
        "items",
        "cell",
        Item,
        state="the items that are held",
        need=Need("fetch", "taking", "held", "not held"),
        other_names=("key", "coin", "treasure"),
    ),
    Kind(
        "door",
        "doors",
        "side",
        Door,
        marks={d.DOOR: {}},
        state="the doors that are open",
        label=_door_label,
        other_names=("gate",),
    ),
    Kind(
        "switch",
        "switches",
        "cell",
        Switch,
        state="the switches that are on",
        need=Need("switch on", "flipping", "on", "off"),
        other_names=("button", "lever"),
    ),
    Kind(
        "box",
        "boxes",
        "cell",
        Box,
        marks={d.BOX: {}, d.COVERED: {}},
        state="the places of boxes",
        other_names=("crate",),
    ),
    Kind(
        "target",
        "targets",
        "cell",
        Target,
        marks={d.TARGET: {}, d.COVERED: {}},
        state="the targets that are covered",
        need=Need("cover", "covering", "covered", "not covered"),
        label=lambda target: target.name or "target",
        other_names=("pad", "storage"),
    ),
    Kind(
        "robot",
        "robots",
        "path",
        TeamRobot,
        state="the places of robots",
        other_names=("agents", "players"),
    ),
    Kind(
        "mover",
        "movers",
        "path",
        Mover,
        state="the places of movers",
        label=lambda mover: mover.name or mover.picture,
        other_names=("guard", "enemy", "enemie", "monster"),
    ),
    Kind("start", "start", "cell", marks={d.START: {}}, other_names=("agent",)),
    Kind(
        "exit",
        "exit",
        "cell",
        marks={d.EXIT: {}},
        by_lot="exit_one_of",
        other_names=("goal", "end"),
    ),
    Kind(
        "warp",
        "warps",
        "cell",
        Warp,
        label=lambda warp: f"warp to {warp.to if warp.to == 'start' else [*warp.to]}",
        other_names=("portal", "teleport", "teleporter"),
    ),
    Kind(
        "puddle",
        "puddles",
        "cell",
        Puddle,
        marks={d.SMALL: {"size": "small"}, d.LARGE: {"size": "large"}},
        label=lambda puddle: f"{puddle.size} puddle",
    ),
    Kind(
        "blocked",
        "blocked",
        "rectangle",
        Rectangle,
        noun="blocked cell",
        marks={d.BLOCKED: {}},
        other_names=("obstacle",),
    ),
    Kind("area", "areas", "rectangle", Area, label=lambda area: area.label or "area"),
    Kind(
        "wall",
        "walls",
        "side",
        Wall,
        marks={d.SOLID: {}, d.GLASS: {"pass": GLASS_PASS}},
        label=lambda wall: f"glass {wall.pass_:g}" if wall.pass_ else "wall",
    ),
    Kind("opening", "openings", "side", Opening),
    Kind("wind", "wind", "line", Wind),
)
"""All kinds: of those in cells and of those at sides, what lies on top comes first."""

KIND: Mapping[str, Kind] = {kind.name: kind for kind in KINDS}
"""The kinds by their names."""

LEGEND = tuple(kind for kind in KINDS if kind.legend)
"""The kinds for which a character of the legend can stand."""

LISTED = tuple(kind for kind in KINDS if kind.is_listed)
"""The kinds whose fields are lists of entries."""

THINGS = tuple(kind for kind in KINDS if kind.state)
"""The kinds whose state changes during an episode."""

NAMED = tuple(kind for kind in KINDS if kind.has_name)
"""The kinds whose entries have names."""

MARKED = tuple(kind for kind in KINDS if kind.marks and kind.is_listed and kind.where == "cell")
"""The kinds in cells whose entries drawings show by marks of their own."""

NEEDED = tuple(kind for kind in KINDS if kind.need.met)
"""The kinds that doors and exits can need, by the names of their entries."""

FIXED_STATES = tuple(
    f"{kind.name}-{state}"
    for kind in NEEDED
    if kind.need.met == "on"
    for state in (kind.need.unmet, kind.need.met)
)
"""What shows the kinds that stay in their cells, off or on: the names of their states."""
