"""A page in which students write functions of a course, and see what is right, without installing.

Python runs in the browser (Pyodide). Right answers are there as hashes, all values of a level in
one, from which no value can be told; see `hashed.py`.
"""

from collections.abc import Callable, Iterator
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import numpy as np

from babyrobot_levels.analysis.solver.evaluation import evaluate
from babyrobot_levels.analysis.solver.optimum import solve
from babyrobot_levels.analysis.solver.policies import space_of
from babyrobot_levels.analysis.solver.results import EpisodeTooLongError, UndefinedReturnError
from babyrobot_levels.extensions.editor.runtime import (
    CDN,
    LOCK,
    TARBALL,
    lock_with,
    numeric_wheels,
    pyodide_files,
    runtime_file,
    runtime_folder,
)
from babyrobot_levels.extensions.packs.build import Course
from babyrobot_levels.extensions.publish.hashed import (
    ACTIONS,
    AnswerError,
    digest,
    graded,
    shifts_of,
)
from babyrobot_levels.library.catalogue import load
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.tables import Floats
from babyrobot_levels.render.templates import embedded_json, html, put_together, static
from babyrobot_levels.text.files import write_bytes

AT_LEAST = 0.95
"""The share of the way from the random policy to the optimum that an agent has to cover."""

MAX_STATES = 2_000
"""The most states of a level whose tables are in the page."""

DISCOUNTS = (0.9, 0.95, 0.99, 1.0)
"""The discounts with which values are named as a mistake."""

_TABLES = ("probability", "next_state", "reward", "terminal", "is_terminal", "action_mask", "start")
_STATIC = "extensions/publish/static"


def write_desk(course: Course, title: str, folder: Path, runtime: Path | None) -> None:
    """Write the page into a folder.

    Args:
        course: the course.
        title: its title.
        folder: where to.
        runtime: a folder with the files of Pyodide, as `editor --runtime` takes it; None to fetch
            them. NumPy is in the page if the folder has it, else loaded where Pyodide's project
            publishes it, by those who import it.

    Raises:
        RuntimeFileError: a file of Pyodide cannot be had.
    """
    with runtime_folder(runtime) as given:
        python = pyodide_files(runtime_file(TARBALL, given))
        numeric = numeric_wheels(given, ["numpy"])
    address, host = CDN, urlsplit(CDN).netloc
    if numeric:
        python[LOCK], address, host = lock_with(python[LOCK], numeric), "./python/", ""
    told = embedded_json(_told(course, title))
    files = {
        "index.html": html(f"{_STATIC}/desk.html", title=title, course=told, host=host).encode(),
        "desk.js": put_together(f"{_STATIC}/desk.js").encode(),
        "worker.js": static(f"{_STATIC}/desk_worker.js").replace("NUMPY_ADDRESS", address).encode(),
        "hashed.py": static("extensions/publish/hashed.py").encode(),
        **{f"python/{name}": data for name, data in (python | numeric).items()},
    }
    for name, data in files.items():
        write_bytes(folder / name, data, sync=False)


def _told(course: Course, title: str) -> dict[str, Any]:
    """Return what the page knows of a course: no hidden levels, and of answers only hashes."""
    fields = course.fields
    levels = []
    for entry in fields.levels:
        wanted = fields.graded_in(entry)
        known = level_data(load(course.files[entry.level])) if wanted and not entry.hidden else None
        if known is not None:
            levels.append({**known, "functions": [*wanted]})
    functions = [
        {"name": name, "kind": kind, "text": (course.folder / f"{name}.py").read_text("utf-8")}
        for name, kind in fields.functions.items()
    ]
    return {"title": title, "functions": functions, "levels": levels}


def level_data(level: Level) -> dict[str, Any] | None:
    """Return a level as the page has it; None if it is too large.

    Or if its episodes are too long, or it has other actions than five.
    """
    space = space_of(level, "all")
    mdp = space.mdp
    if mdp.num_states > MAX_STATES or mdp.num_actions != len(ACTIONS):
        return None
    counted = np.flatnonzero(~space.without_value)
    try:
        best = solve(level)
    except (UndefinedReturnError, EpisodeTooLongError):
        return None
    right = np.ravel(best.values)[counted]
    if not np.isfinite(right).all():
        return None
    answers = {"": right, **dict(_mistakes(level, right, counted))}
    name = level.name or ""
    found = {
        "name": name,
        "title": level.title or name,
        "discount": level.discount,
        "max_steps": level.max_steps,
        "needed": _needed(level),
        "shape": [*mdp.shape],
        "tables": {each: getattr(mdp, each).tolist() for each in _TABLES},
        "places": [space.text(state) for state in range(mdp.num_states)],
        "graded": counted.tolist(),
        "known": [_hashed(values, mistake, name) for mistake, values in answers.items()],
    }
    # Where that takes too many sweeps, students would read of a right policy that it is wrong.
    with suppress(AnswerError):
        graded(best.policy, "policy", found)
        return found
    return None


def _needed(level: Level) -> float:
    """Return the least expected return of an agent that passes."""
    limit = level.max_steps
    random = evaluate(level, "random", within=limit).expected_return
    return random + AT_LEAST * (solve(level, within=limit).expected_return - random)


def _mistakes(level: Level, right: Floats, counted: Any) -> Iterator[tuple[str, Floats]]:
    """Yield the values that common mistakes give, each with its sentence."""
    yield "their signs are exchanged: costs are negative rewards", -right
    own = level.discount
    asked: dict[str, Callable[[], Any]] = {
        f"these are the values for the discount {each:g}, not {own:g}": partial(solve, level, each)
        for each in DISCOUNTS
        if each != own
    }
    told = "these are the values of the random policy: a state takes the largest of its action "
    asked[f"{told}values, not their mean"] = partial(evaluate, level, "random")
    for told, ask in asked.items():
        with suppress(UndefinedReturnError, EpisodeTooLongError):
            if np.isfinite(values := np.ravel(ask().values)[counted]).all():
                yield told, values


def _hashed(values: Floats, mistake: str, salt: str) -> dict[str, str]:
    numbers = values.tolist()
    shifts = shifts_of(numbers)
    return {"shifts": shifts, "digest": digest(numbers, shifts, salt), "mistake": mistake}
