"""Pages of a class: what all have, what does not count, and a page for each student."""

import math
import os
from pathlib import Path
from typing import Any

from babyrobot_levels.extensions.scoring.grades import Grades
from babyrobot_levels.language.names import numbered, slug
from babyrobot_levels.render.templates import html
from babyrobot_levels.text.files import write_text

MAX_MISTAKES = 5
"""The most mistakes of a function that the page of a class tells."""

_RULES = {
    "regret": "what its decisions cost, as a share of what the optimum is above random actions",
    "share": "how much of the way from random actions to the optimum its return covers",
    "success": "whether it reaches an exit",
    "tries": "the number of episodes until the first that reaches an exit",
}


def class_page(grades: Grades, links: dict[str, str] | None = None) -> str:
    """Return the grades of a class as a page that needs nothing else.

    Args:
        grades: the grades.
        links: the pages of students, by player.
    """
    worth = grades.worth
    return html(
        "extensions/scoring/static/class.html",
        title=grades.title,
        tasks=[*worth],
        possible=[*worth.values(), math.fsum(worth.values())],
        totals={player: [*points.values()] for player, points in grades.totals.items()},
        rule=_RULES[grades.rule] if len(grades) else None,
        remarks=_remarks(grades),
        links=links or {},
    )


def _remarks(grades: Grades) -> dict[str, tuple[list[str], list[list[Any]]]]:
    """Return the columns and the rows of what is told beside the points; lists are counted."""
    common = {task: [*told.items()][:MAX_MISTAKES] for task, told in grades.mistakes.items()}
    return {
        "Commonest mistakes": (
            ["Task", "Students", "Mistake"],
            [[task, players, told] for task, each in common.items() for told, players in each],
        ),
        "The same code or plays": (
            ["Task", "Students"],
            [[task, ", ".join(each)] for task, groups in grades.shared.items() for each in groups],
        ),
        "Read all the same": (
            ["Student", "Note"],
            [[player, note] for player, notes in grades.notes.items() for note in notes],
        ),
        "What does not count": (
            ["Player", "Place", "Reason"],
            [[each.player, each.place, each.reason] for each in grades.defects],
        ),
    }


def student_page(grades: Grades, player: str) -> str:
    """Return the grades of one student as a page: what is right, and what is not, and no answer."""
    submission = grades.submissions.get(player)
    return html(
        "extensions/scoring/static/student.html",
        title=grades.title,
        player=player,
        total=grades.totals[player]["total"],
        possible=math.fsum(grades.worth.values()),
        functions={} if submission is None else submission.by_function,
        notes=grades.notes.get(player, ()),
        plays=[each for each in grades if each.player == player],
        defects=[each for each in grades.defects if each.player == player],
    )


def write_pages(grades: Grades, folder: str | os.PathLike[str]) -> None:
    """Write `index.html`, the page of a class, and those of the students in `students`.

    Pages of students who are no longer there are removed.
    """
    links: dict[str, str] = {}
    for player in grades.totals:
        pages = (f"{name}.html" for name in numbered(f"students/{slug(player[:60]) or 'student'}"))
        links[player] = next(each for each in pages if each not in links.values())
    for player, link in links.items():
        write_text(Path(folder, link), student_page(grades, player), sync=False)
    for path in Path(folder, "students").glob("*.html"):
        if f"students/{path.name}" not in links.values():
            path.unlink()
    write_text(Path(folder, "index.html"), class_page(grades, links))
