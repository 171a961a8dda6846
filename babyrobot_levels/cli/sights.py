"""The optimum of a sight in commands: how it is found, and what is told of it."""

from __future__ import annotations

from typing import Any

import babyrobot_levels as brl
from babyrobot_levels.cli.console import fact_lines, fail
from babyrobot_levels.cli.parallel import working
from babyrobot_levels.language.plain_data import json_value

MOST_BELIEFS = 100_000
"""So many beliefs are explored at most unless another number is asked for."""


def sight_solution(level: brl.Level, **how: Any) -> Any:
    """Return the optimum of a sight; end the command if there is none."""
    most = how.get("beliefs", MOST_BELIEFS)
    with working("solving") as report:

        def progress(explored: int, lower: float, upper: float) -> None:
            report(explored, most)

        try:
            return brl.solve(level, progress=progress, **how)
        except (brl.UndefinedReturnError, brl.EpisodeTooLongError) as error:
            fail(str(error))
        except brl.BabyRobotError:
            raise
        except (ValueError, TypeError) as error:
            fail(str(error))


def sight_data(level: brl.Level, found: Any) -> dict[str, Any]:
    """Return for JSON what is known of the optimum of a sight."""
    return {
        "name": level.name,
        "digest": level.digest,
        "sight": found.sight,
        "within": found.within,
        **{name: json_value(getattr(found, name)) for name in ("lower", "upper", "full", "gap")},
        "cost": json_value(found.cost),
        "is_exact": found.is_exact,
        "beliefs": found.beliefs,
    }


def _told(found: Any, lower: float, upper: float) -> str:
    return f"{lower:.6g}" if found.is_exact else f"{lower:.6g} to {upper:.6g}"


def cost_text(found: Any) -> str:
    """Return what full sight is worth, exactly or at least and at most."""
    return _told(found, *found.cost)


def sight_summary(level: brl.Level, found: Any) -> str:
    """Return what is known of the optimum of a sight, line by line."""
    from babyrobot_levels.render.words.phrases import with_limit

    more = "exact" if found.is_exact else f"bounds, {100 * found.gap:.3g} % apart"
    best = f"{_told(found, found.lower, found.upper)} ({more})"
    facts = {
        "sight": found.sight,
        "expected return": with_limit(best, found.within, level.max_steps),
        "with full sight": f"{found.full:.6g}",
        "cost of the sight": cost_text(found),
        "beliefs": f"{found.beliefs:,} explored",
    }
    return fact_lines(facts)
