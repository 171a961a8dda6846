"""A page of a class: the points of all players in all levels, and what does not count."""

import math

from babyrobot_levels.extensions.scoring.grades import Grades
from babyrobot_levels.render.templates import html

_RULES = {
    "regret": "what its decisions cost, as a share of what the optimum is above random actions",
    "share": "how much of the way from random actions to the optimum its return covers",
    "success": "whether it reaches an exit",
    "tries": "the number of episodes until the first that reaches an exit",
}


def class_page(grades: Grades) -> str:
    """Return the grades of a class as a page that needs nothing else."""
    worth = {each.level: each.worth for each in grades}
    return html(
        "extensions/scoring/static/class.html",
        levels=grades.levels,
        possible=[*worth.values(), math.fsum(worth.values())],
        totals={player: [*points.values()] for player, points in grades.totals.items()},
        rule=_RULES[grades.rule],
        defects=grades.defects,
    )
