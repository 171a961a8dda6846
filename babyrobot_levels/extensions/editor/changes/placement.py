"""Where everything comes to lie that a rectangle of cells has, in another one."""

from collections.abc import Iterable
from dataclasses import dataclass

from babyrobot_levels.extensions.editor.changes.draft import KIND_OF_FIELD, as_cell, lying_in
from babyrobot_levels.extensions.editor.changes.shapes import Box, Entry, Run, placed
from babyrobot_levels.language.geometry import Cell


@dataclass(frozen=True, slots=True)
class Placement:
    """Cells that are mirrored and moved, from a rectangle into another one.

    Attributes:
        old: the size of the first rectangle.
        new: the size of the second one: what lies outside is left out.
        shift: how far everything moves to the east and south.
        mirror: the axes along which it is mirrored before: `x`, `y`, both or none.
        is_frame: whether both are levels, whose outer walls move with the rim.
    """

    old: tuple[int, int]
    new: tuple[int, int]
    shift: tuple[int, int]
    mirror: str = ""
    is_frame: bool = False

    def cells(self, cells: Iterable[Cell]) -> list[Cell]:
        """Return where cells come to lie, without those outside."""
        return [moved for cell in cells if (moved := self.cell(cell)) is not None]

    def weights(self, cells: Iterable[Cell], weights: Iterable[float]) -> list[float]:
        """Return the weights of the cells that are not outside."""
        known = zip(cells, weights, strict=True)
        return [weight for cell, weight in known if self.cell(cell) is not None]

    def cell(self, cell: Cell) -> Cell | None:
        """Return where a cell comes to lie, None outside."""
        box = self.box(Box(*cell, 1, 1))
        return None if box is None else (box.x, box.y)

    def box(self, box: Box) -> Box | None:
        """Return what comes to lie inside of a rectangle."""
        x = self._first(0, box.x, box.columns)
        y = self._first(1, box.y, box.rows)
        return Box(x, y, box.columns, box.rows).within(Box(0, 0, *self.new))

    def _first(self, axis: int, first: int, count: int) -> int:
        """Return where so many places in a row, from one on, begin."""
        if "xy"[axis] in self.mirror:
            first = self.old[axis] - count - first
        return first + self.shift[axis]

    def run(self, run: Run) -> Run | None:
        """Return what comes to lie inside of a run of sides, or at the rim."""
        across, along = (0, 1) if run.axis == "E" else (1, 0)
        line = self._line(across, run.line)
        if line is None:
            return None
        count = run.stop - run.first
        first = self._first(along, run.first, count)
        moved = Run(run.axis, line, first, first + count).part(0, self.new[along])
        return moved if moved.first < moved.stop else None

    def _line(self, axis: int, line: int) -> int | None:
        """Return where a line of sides comes to lie, None outside."""
        last = self.new[axis] - 1
        if self.is_frame and line in (-1, self.old[axis] - 1):
            return -1 if line < 0 else last
        moved = self._first(axis, line + 1, 0) - 1
        return moved if -1 + self.is_frame <= moved <= last - self.is_frame else None

    def entry(self, field: str, entry: Entry) -> Entry | None:
        """Return an entry with its new place, None if that is outside."""
        if KIND_OF_FIELD[field].where == "side":
            run = self.run(Run.of_entry(entry))
            return None if run is None else placed(entry, run)
        if KIND_OF_FIELD[field].where == "rectangle":
            box = self.box(Box.of(entry))
            return None if box is None else box.put(entry)
        return self._thing(entry)

    def _thing(self, entry: Entry) -> Entry | None:
        """Return an entry that stands in cells with its new place."""
        moved = {**entry}
        if isinstance(entry.get("to"), list) and isinstance(entry["to"][0], list):
            leads = [*map(as_cell, entry["to"])]
            moved["to"] = [[*cell] for cell in self.cells(leads)]
            if not moved["to"]:
                return None
            if entry.get("weights"):
                moved["weights"] = self.weights(leads, entry["weights"])
        for name in ("at", "to"):
            if isinstance(moved.get(name), list) and not isinstance(moved[name][0], list):
                cell = self.cell(as_cell(entry[name]))
                if cell is None:
                    return None
                moved[name] = [*cell]
        if entry.get("path"):
            path = self.cells(map(as_cell, entry["path"]))
            if len(path) < len(entry["path"]):
                return None
            moved["path"] = [[*cell] for cell in path]
        if entry.get("within"):
            box = self.box(Box.of(entry["within"]))
            if box is None:
                return None
            moved["within"] = box.put(entry["within"])
        if entry.get("start"):
            begin = self.cells([as_cell(entry["start"])])
            moved |= {"start": [*begin[0]]} if begin else {}
            if not begin:
                del moved["start"]
        if entry.get("one_of"):
            return lying_in(moved, self.cells(map(as_cell, entry["one_of"])))
        return moved
