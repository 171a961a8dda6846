"""The list of students that a school's system exports as CSV, filled with points to import."""

import csv
import io
import re
from collections.abc import Mapping, Sequence
from pathlib import Path

from babyrobot_levels.extensions.scoring.grades import Grades
from babyrobot_levels.extensions.scoring.hand_ins import words_of
from babyrobot_levels.extensions.scoring.results import csv_of
from babyrobot_levels.text.files import read_bytes
from babyrobot_levels.text.source import MAX_BYTES

GRADE = "Grade"
"""The column of points in Moodle."""

LAST = "End-of-Line Indicator"
"""The last column in Brightspace."""

_NAMES = re.compile(r"student|(full|first|last|given|family|sur)? ?name", re.IGNORECASE)
_IDS = re.compile(
    r"(sis )?(user|login)? ?id|identifier|id number|orgdefinedid|sid|e-?mail( address)?"
    r"|username|github_username|sis (user|login) id",
    re.IGNORECASE,
)


def filled(path: Path, grades: Grades, column: str | None = None) -> tuple[str, dict[str, str]]:
    """Return a list of students with points, and who is not in it, with the reason.

    Students are known by the numbers and addresses that the names of their files tell, or by their
    names. Whoever is not graded in full has no points there.

    Args:
        path: the list as the system exports it, with a heading.
        grades: the grades of the class.
        column: the column of points, which is added if there is none; by default `Grade`.

    Raises:
        OSError: it cannot be read.
        ValueError: it is no such list.
    """
    data = read_bytes(path, MAX_BYTES)
    encoding = "utf-16" if data.startswith((b"\xff\xfe", b"\xfe\xff")) else "utf-8-sig"
    text = data.decode(encoding, "replace")
    delimiter = max(",;\t", key=text.partition("\n")[0].count)
    heading, *rows = [*csv.reader(io.StringIO(text), delimiter=delimiter)] or [[]]
    names = [each for each in range(len(heading)) if _NAMES.fullmatch(heading[each].strip())]
    ids = [each for each in range(len(heading)) if _IDS.fullmatch(heading[each].strip())]
    if not names and not ids:
        raise ValueError("it has no column of names or of numbers of students in its first line")
    column = column or GRADE
    if column not in heading:
        at = heading.index(LAST) if LAST in heading else len(heading)
        heading.insert(at, column)
        names, ids = ([each + (each >= at) for each in found] for found in (names, ids))
        for row in rows:
            row.insert(at, "")
    place, missing = heading.index(column), dict[str, str]()
    for player, totals in grades.totals.items():
        found = _rows_of(player, {*grades.ids.get(player, ())}, rows, names, ids)
        if len(found) != 1:
            missing[player] = f"{len(found) or 'no'} rows are alike" if found else "no row is alike"
        elif any(points != points for points in totals.values()):
            missing[player] = "something could not be graded"
        else:
            row = rows[found[0]]
            row += [""] * (place + 1 - len(row))
            row[place] = f"{totals['total']:.2f}".rstrip("0").rstrip(".")
    return csv_of([heading, *rows]), missing


def _rows_of(
    player: str,
    known: set[str],
    rows: Sequence[Sequence[str]],
    names: Sequence[int],
    ids: Sequence[int],
) -> list[int]:
    """Return the numbers of the rows of a student: by numbers if they tell, else by names."""
    known = {each.casefold() for each in known}

    def cells(row: Sequence[str], columns: Sequence[int]) -> list[str]:
        return [row[each].strip().casefold() for each in columns if each < len(row)]

    def is_known(cell: str) -> bool:
        # Moodle writes `Participant 12`, and GitHub Classroom names folders `ASSIGNMENT-USER`.
        number = cell.removeprefix("participant ")
        own = player.casefold()
        return bool(cell) and (number in known or own == cell or own.endswith(f"-{cell}"))

    if found := [number for number, row in enumerate(rows) if any(map(is_known, cells(row, ids)))]:
        return found
    words = words_of(player)
    told: Mapping[int, list[str]] = {number: cells(row, names) for number, row in enumerate(rows)}
    return [
        number
        for number, each in told.items()
        if words and (words in map(words_of, each) or words == words_of(" ".join(each)))
    ]
