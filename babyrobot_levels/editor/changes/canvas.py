"""The drawing of a level while it changes."""

from __future__ import annotations

from babyrobot_levels.editor.changes.sides import Run
from babyrobot_levels.language import drawing as d
from babyrobot_levels.language.geometry import Cell


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

    def text(self) -> str:
        """Return the drawing as the text of `map`."""
        return d.compose(self.drawing())

    def at(self, cell: Cell) -> str:
        """Return the character of a cell."""
        return self.cells[cell[1]][cell[0]]

    def put(self, cell: Cell, character: str) -> None:
        """Give a cell another character."""
        self.cells[cell[1]][cell[0]] = character

    def find(self, character: str) -> list[Cell]:
        """Return the cells that show a character, in reading order."""
        return [
            (x, y)
            for y, row in enumerate(self.cells)
            for x, shown in enumerate(row)
            if shown == character
        ]

    def mark(self, run: Run, mark: str) -> None:
        """Give the sides of a run another mark. None of them may be of the outer wall."""
        rows = self._east if run.axis == "E" else self._south
        for x, y in run.cells:
            rows[y][x] = mark

    def marked(self, run: Run) -> list[str]:
        """Return the marks of the sides of a run. None of them may be of the outer wall."""
        rows = self._east if run.axis == "E" else self._south
        return [rows[y][x] for x, y in run.cells]

    def unmark(self, run: Run, mark: str) -> None:
        """Remove a mark from the sides of a run."""
        rows = self._east if run.axis == "E" else self._south
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
