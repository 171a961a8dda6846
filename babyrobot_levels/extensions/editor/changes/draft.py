"""A level that a gesture is changing: its fields, its drawing, its names, and what is erased."""

from collections import Counter
from collections.abc import Callable, Collection, Mapping, Sequence
from typing import Any

from babyrobot_levels.extensions.editor.changes.shapes import Box, Entry, Run, cut_boxes
from babyrobot_levels.language import drawing as d
from babyrobot_levels.language.formatting import NOTHING, Fields, fields_of
from babyrobot_levels.language.geometry import Cell
from babyrobot_levels.language.kinds import KIND, LISTED, NAMED, NEEDED
from babyrobot_levels.language.names import numbered
from babyrobot_levels.language.things import DRAWN_NAMES, as_names
from babyrobot_levels.library.level import Level
from babyrobot_levels.text.document import Document
from babyrobot_levels.text.errors import BabyRobotError


class RefusedError(BabyRobotError):
    """A gesture that cannot be carried out; the text stays as it is."""


class Draft:
    """The fields of a level while they change.

    Attributes:
        data: the fields as the text gives them, which gestures change in place.
        level: the level before the gesture.
        document: the text before the gesture.
        canvas: the drawing of `map`, which gestures change in place; None if there is none.
        lost: how many of which kinds are gone that the gesture did not point at.
        left: how many of which kinds a stamp left out.
    """

    def __init__(self, document: Document, level: Level) -> None:
        self.document, self.level = document, level
        self.data: dict[str, Any] = _copied(document.data)
        self.canvas = None if level.drawing is None else Canvas(level.drawing)
        self.lost: Counter[str] = Counter()
        self.left: Counter[str] = Counter()

    def entries(self, field: str) -> list[Any]:
        """Return the entries of a list, to be changed in place; a new list if there is none."""
        entries: list[Any] = self.data.setdefault(field, [])
        return entries

    def result(self) -> dict[str, Any]:
        """Return the fields as they are now, in order, without those that became empty."""
        drawing = None if self.canvas is None else self.canvas.drawing()
        if drawing is not None and drawing != self.level.drawing:
            self.data["map"] = d.compose(drawing)
        before = self.document.data
        return {
            name: value
            for name, value in _in_order(self.data, fields_of(Level)).items()
            if value not in ([], {}) or before.get(name) == value
        }


def _copied(value: Any) -> Any:
    """Return a copy of plain data, in which nothing is an alias of anything else."""
    if isinstance(value, dict):
        return {key: _copied(inner) for key, inner in value.items()}
    return [*map(_copied, value)] if isinstance(value, list) else value


def _in_order(value: Any, fields: Fields) -> Any:
    """Return plain data with its fields in the order in which they are written."""
    if isinstance(value, dict):
        return {key: _in_order(value[key], fields.of(key)) for key in fields.order(value)}
    if isinstance(value, list) and fields is not NOTHING:
        return [_in_order(each, fields) for each in value]
    return value


# -- the drawing -------------------------------------------------------------------------


PUDDLES = {given["size"]: mark for mark, given in KIND["puddle"].marks.items()}
"""The marks of puddles, by their sizes."""


class Canvas:
    """A drawing whose cells and sides can be changed; see `language.drawing.Drawing`.

    Attributes:
        cells: the characters of the cells, `cells[y][x]`.
    """

    def __init__(self, drawing: d.Drawing) -> None:
        self.cells: list[list[str]] = [[*row] for row in drawing.cells]
        self._east = [[*row] for row in drawing.east]
        self._south = [[*row] for row in drawing.south]

    def drawing(self) -> d.Drawing:
        """Return the drawing as it is now."""
        rows = (self.cells, self._east, self._south)
        cells, east, south = (tuple("".join(row) for row in part) for part in rows)
        return d.Drawing(cells, east, south)

    def at(self, cell: Cell) -> str:
        """Return the character of a cell."""
        return self.cells[cell[1]][cell[0]]

    def put(self, cell: Cell, character: str) -> None:
        """Give a cell another character."""
        self.cells[cell[1]][cell[0]] = character

    def find(self, character: str) -> list[Cell]:
        """Return the cells that show a character, in reading order."""
        return d.cells_with(self.cells, character)

    def _sides(self, run: Run) -> list[list[str]]:
        return self._east if run.axis == "E" else self._south

    def mark(self, run: Run, mark: str) -> None:
        """Give the sides of a run another mark. None of them may be of the outer wall."""
        for x, y in run.cells:
            self._sides(run)[y][x] = mark

    def marked(self, run: Run) -> list[str]:
        """Return the marks of the sides of a run. None of them may be of the outer wall."""
        return [self._sides(run)[y][x] for x, y in run.cells]

    def unmark(self, run: Run, mark: str) -> None:
        """Remove a mark from the sides of a run."""
        rows = self._sides(run)
        for x, y in run.cells:
            if y < len(rows) and x < len(rows[y]) and rows[y][x] == mark:
                rows[y][x] = d.OPEN

    def resize(self, width: int, height: int, right: int, down: int) -> None:
        """Move everything to the right and down within another size; what is new is plain."""

        def moved(rows: list[list[str]], blank: str, columns: int, count: int) -> list[list[str]]:
            return [
                [
                    rows[y - down][x - right]
                    if 0 <= y - down < len(rows) and 0 <= x - right < len(rows[y - down])
                    else blank
                    for x in range(columns)
                ]
                for y in range(count)
            ]

        self.cells = moved(self.cells, d.PLAIN, width, height)
        self._east = moved(self._east, d.OPEN, width - 1, height)
        self._south = moved(self._south, d.OPEN, width, height - 1)


# -- starts and exits --------------------------------------------------------------------


def put_starts(draft: Draft, cells: Sequence[Cell]) -> None:
    """Make some cells the starts. There has to be one."""
    if draft.canvas is not None:
        _draw(draft, d.START, cells)
    elif [*cells] != [*draft.level.starts]:
        draft.data["start"] = one_or_several(cells)
    _put_weights(draft, "start_weights", draft.level.starts, cells)


def put_exits(draft: Draft, cells: Sequence[Cell], *, is_drawn_by_lot: bool = False) -> None:
    """Make some cells the exits; without any, there is none.

    Args:
        draft: the level.
        cells: the cells.
        is_drawn_by_lot: whether one of several is drawn at each reset (`exit_one_of`).
    """
    is_drawn_by_lot = is_drawn_by_lot and len(cells) > 1
    before = draft.level.common_exits
    if draft.canvas is not None and "exit_one_of" not in draft.data:
        before = tuple(draft.canvas.find(d.EXIT))
    if [*cells] == [*before] and is_drawn_by_lot == ("exit_one_of" in draft.data):
        return
    _put_weights(draft, "exit_weights", before, cells if is_drawn_by_lot else ())
    draft.data.pop("exit_one_of", None)
    if is_drawn_by_lot:
        draft.data.pop("exit", None)
        draft.data["exit_one_of"] = [[*cell] for cell in cells]
    if draft.canvas is not None:
        _draw(draft, d.EXIT, () if is_drawn_by_lot else cells)
    elif not is_drawn_by_lot:
        draft.data["exit"] = one_or_several(cells) if cells else "none"


def _put_weights(draft: Draft, field: str, before: Sequence[Cell], cells: Sequence[Cell]) -> None:
    """Keep the weights of the cells that stay; those that are new have the weight 1."""
    weights = draft.data.get(field)
    if weights and len(cells) < 2:
        del draft.data[field]
    elif weights and len(weights) != len(cells):
        known = dict(zip(before, weights, strict=True))
        ordered = sorted(cells, key=lambda cell: cell[::-1]) if draft.canvas else cells
        draft.data[field] = [known.get(cell, 1) for cell in ordered]


def _draw(draft: Draft, character: str, cells: Sequence[Cell]) -> None:
    """Show a character in some cells and nowhere else."""
    assert draft.canvas is not None
    for cell in draft.canvas.find(character):
        if cell not in cells:
            draft.canvas.put(cell, d.PLAIN)
    for cell in cells:
        draft.canvas.put(cell, character)


def one_or_several(cells: Sequence[Cell]) -> list[Any]:
    """Return a cell, or a list of several, as files give starts and exits."""
    return [*cells[0]] if len(cells) == 1 else [[*cell] for cell in cells]


# -- names by which doors and exits need things ------------------------------------------


def replace_names(draft: Draft, names: Mapping[str, str | None]) -> None:
    """Replace names in what doors and exits need and who takes items, or remove those of None.

    A door that is left without any name would always be open: it is removed, too.
    """
    replace_in(draft.data, "exit_needs", names)
    for item in draft.data.get("items", ()):
        replace_in(item, "robot", names)
    for door in [*draft.data.get("doors", ())]:
        # Each of them, so no short cut.
        replaced = [replace_in(door, field, names) for field in ("needs", "unless")]
        if any(replaced) and "needs" not in door and "unless" not in door:
            draft.data["doors"].remove(door)
            draft.lost["door"] += 1
            if draft.canvas is not None:
                draft.canvas.mark(Run.of_entry(door), d.OPEN)


def names_of(level: Level) -> list[str]:
    """Return the names of what doors and exits can need, kind by kind."""
    return [thing.name for kind in NEEDED for thing in kind.of(level)]


def unused_name(draft: Draft, base: str) -> str:
    """Return a name that nothing has yet: `key`, `key-2` and so on."""
    lists = [draft.data.get(kind.field, ()) for kind in NAMED]
    lists.append(draft.data.get("legend", {}).values())
    entries = [entry for entries in lists for entry in entries]
    used = {entry.get(field) for entry in entries for field in ("name", *DRAWN_NAMES)}
    return next(name for name in numbered(base) if name not in used)


def replace_in(entry: dict[str, Any], field: str, names: Mapping[str, str | None]) -> bool:
    """Replace names in a field, and tell whether there were any."""
    before = as_names(entry.get(field, ()))
    replaced = (names.get(name, name) for name in before)
    after = [name for name in replaced if name is not None]
    if [*before] == after:
        return False
    if after:
        entry[field] = after[0] if len(after) == 1 else after
    else:
        del entry[field]
    return True


# -- what stands in cells, taken out of them -----------------------------------------------


STANDING = frozenset(kind.field for kind in LISTED if kind.where in ("cell", "path"))
"""What cannot stand in a blocked cell."""

GROUND = frozenset(kind.field for kind in LISTED if kind.where == "rectangle")
"""What covers rectangles, of which a part can be taken away."""

KIND_OF_FIELD = {kind.field: kind for kind in LISTED}
"""The kinds of lists of entries, by their fields."""

_DRAWN = {mark: kind.field for kind in LISTED for mark in kind.marks}
"""The field whose entry would say what a mark of drawings says."""


def erase(
    draft: Draft,
    cells: Collection[Cell],
    fields: Collection[str],
    where: Callable[[Entry], bool] = lambda entry: True,
) -> None:
    """Take entries of some fields out of cells, and what is drawn there instead of them.

    A warp stands in its cell and in its target; a mover in all cells to which it comes.

    Args:
        draft: the level.
        cells: the cells.
        fields: of `STANDING` and `GROUND`.
        where: which of the entries are taken.
    """
    gone = {*cells}
    for field in fields:
        entries: list[Entry] = draft.data.get(field, [])
        if field in GROUND:
            cut_boxes(entries, gone, where)
        else:
            kept = [_without(each, gone) if where(each) else each for each in entries]
            pairs = zip(entries, kept, strict=True)
            # A part of what it stands on was erased.
            parts = [each for each, left in pairs if left is None and {*cells_of(each)} - gone]
            draft.lost[KIND_OF_FIELD[field].name] += len(parts)
            entries[:] = [each for each in kept if each is not None]
    if draft.canvas is not None:
        for cell in gone:
            if drawn_field(draft, cell) in fields:
                draft.canvas.put(cell, d.PLAIN)
    forget_missing(draft)


def _without(entry: Entry, cells: set[Cell]) -> Entry | None:
    """Return an entry without some cells; None if nothing is left of it."""
    if entry.get("one_of"):
        return lying_in(entry, [c for c in map(as_cell, entry["one_of"]) if c not in cells])
    return entry if cells.isdisjoint(cells_of(entry)) else None


def lying_in(item: Entry, cells: list[Cell]) -> Entry | None:
    """Return an item with other cells of which it lies in one; None without any."""
    places = [[*cell] for cell in cells]
    if len(places) != 1:
        return {**item, "one_of": places} if places else None
    # At its place in the entry.
    names = {"one_of": "at"}
    return {names.get(name, name): value for name, value in item.items()} | {"at": places[0]}


def cells_of(entry: Entry) -> list[Cell]:
    """Return the cells in which an entry stands."""
    if entry.get("within") is not None:
        return [*Box.of(entry["within"]).cells]
    ends = [entry["at"]] if "at" in entry else []
    if isinstance(to := entry.get("to"), list):
        ends += to if isinstance(to[0], list) else [to]
    return [*map(as_cell, (*ends, *(entry.get("path") or ())))]


def as_cell(value: Any) -> Cell:
    """Return a cell of the text as a tuple."""
    x, y = value
    return int(x), int(y)


def drawn_field(draft: Draft, cell: Cell) -> str | None:
    """Return the field whose entry would say what the drawing shows in a cell."""
    assert draft.canvas is not None
    character = draft.canvas.at(cell)
    if character in draft.level.legend:
        return KIND[draft.level.legend[character].kind].field
    return _DRAWN.get(character)


# -- names ---------------------------------------------------------------------------------


def forget_missing(draft: Draft) -> None:
    """Take out of the text what it says about things that are gone.

    These are characters of the legend that are no longer drawn, and names in `needs`, `unless`
    and `exit_needs`.
    """
    if draft.canvas is not None and draft.level.drawing is not None:
        shown = {character for row in draft.canvas.cells for character in row}
        for character in {*"".join(draft.level.drawing.cells)} - shown:
            draft.data.get("legend", {}).pop(character, None)
    if gone := {*names_of(draft.level)} - {*known_names(draft)}:
        replace_names(draft, dict.fromkeys(gone))


def known_names(draft: Draft) -> list[str]:
    """Return the names of what doors and exits can need now."""
    things = [thing for kind in NEEDED for thing in draft.data.get(kind.field, ())]
    drawn = [
        entry[kind]
        for entry in draft.data.get("legend", {}).values()
        for kind in DRAWN_NAMES
        if entry.get(kind) is not None
    ]
    # One whose name was removed has none; the level tells that it needs one.
    return [*(thing["name"] for thing in things if "name" in thing), *drawn]
