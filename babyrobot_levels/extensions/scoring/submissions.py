"""Submissions: the functions that students write, run in each level of a course, and graded.

Their code runs in a process of its own, with limits of time and memory. Only arrays come back,
which are graded here. No code is kept from files and networks: that is what containers are for.
"""

import math
import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from itertools import groupby
from pathlib import Path
from typing import Any

from babyrobot_levels.extensions.packs.build import Course, read_course
from babyrobot_levels.extensions.scoring.answers import (
    GradedAnswer,
    grade_agent,
    grade_policy,
    grade_values,
)
from babyrobot_levels.extensions.scoring.results import Table
from babyrobot_levels.extensions.scoring.student import Answer, answers
from babyrobot_levels.language.plain_data import json_mapping
from babyrobot_levels.render.words.phrases import name_of
from babyrobot_levels.text.files import is_file
from babyrobot_levels.text.words import listed

GRADERS: Mapping[str, Callable[..., GradedAnswer]] = {
    "values": grade_values,
    "policy": grade_policy,
    "agent": grade_agent,
}
"""What grades a function, by what it returns."""

MAX_MESSAGE = 500
"""The most characters of a sentence for a student, which may repeat a text of the student's."""


@dataclass(frozen=True, slots=True)
class GradedFunction:
    """What a function of a student is worth in a level.

    Attributes:
        function: its name.
        level: the name of the level.
        hidden: whether students have not seen the level.
        passed: whether its answer is right.
        points: its points.
        out_of: the points of a right answer.
        message: a sentence for the student, without the solution.
    """

    __module__ = "babyrobot_levels"

    function: str
    level: str
    hidden: bool
    passed: bool
    points: float
    out_of: float
    message: str


class Submission(Table[GradedFunction], public=True):
    """The functions of a student, each in the levels of a course; its text is a report."""

    ROW = GradedFunction

    @property
    def points(self) -> float:
        """The points of all."""
        return math.fsum(each.points for each in self)

    @property
    def out_of(self) -> float:
        """The points of right answers."""
        return math.fsum(each.out_of for each in self)

    def to_dict(self) -> dict[str, Any]:
        """Return everything as a mapping that JSON can hold."""
        rows = [json_mapping(asdict(each)) for each in self]
        return {"points": self.points, "out_of": self.out_of, "functions": rows}

    def to_gradescope(self) -> dict[str, Any]:
        """Return what Gradescope's autograder reads from `results.json`."""
        tests = [
            {
                "name": _name(each),
                "status": "passed" if each.passed else "failed",
                "score": round(each.points, 4),
                "max_score": round(each.out_of, 4),
                "output": each.message,
                "visibility": "after_published" if each.hidden else "visible",
            }
            for each in self
        ]
        board = [{"name": "Points", "value": round(self.points, 2)}]
        return {"score": round(self.points, 4), "tests": tests, "leaderboard": board}

    def to_prairielearn(self) -> dict[str, Any]:
        """Return what PrairieLearn's external grader reads from `results.json`."""
        tests = [
            {
                "name": _name(each),
                "points": round(each.points, 4),
                "max_points": round(each.out_of, 4),
                "output": "" if each.hidden else each.message,
            }
            for each in self
        ]
        return {"gradable": True, "score": self.points / (self.out_of or 1), "tests": tests}

    def to_github_classroom(self) -> dict[str, Any]:
        """Return what the reporter of GitHub Classroom reads, as JSON in base64."""
        tests = [
            {
                "name": _name(each),
                "status": "pass" if each.passed else "fail",
                "message": "" if each.hidden else each.message,
                "score": round(each.points, 4),
                "line_no": 0,
            }
            for each in self
        ]
        status = "pass" if all(each.passed for each in self) else "fail"
        return {"version": 1, "status": status, "max_score": self.out_of, "tests": tests}

    def to_classroom50(self, told: Mapping[str, str] = os.environ) -> dict[str, Any]:
        """Return what Classroom 50 reads from `result.json`.

        Scores are whole numbers there: they are hundredths of points.

        Args:
            told: what its runner tells, by the names of environment variables.

        Raises:
            KeyError: something is not told.
        """
        tests = [
            {
                "test-name": _name(each),
                "passed": each.passed,
                "score": round(100 * each.points),
                "max-score": round(100 * each.out_of),
                "message": "" if each.hidden else each.message,
            }
            for each in self
        ]
        whose = ("classroom", "assignment", "assignment_type", "owner")
        return {
            "schema": "classroom50/result/v1",
            **{each: told[each.upper()] for each in whose},
            "submission": told["SUBMISSION_TAG"],
            **{each: told[f"{each.upper()}_URL"] for each in ("commit", "release", "review")},
            "datetime": datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%SZ"),
            "score": sum(each["score"] for each in tests),
            "max-score": sum(each["max-score"] for each in tests),
            "tests": tests,
        }

    def __str__(self) -> str:
        lines: list[str] = []
        width = max((len(each.level) for each in self), default=0)
        for name, rows in groupby(self, lambda each: each.function):
            lines += [name]
            # What is wrong in each level alike is said once.
            for _, same in groupby(rows, lambda each: each.level if each.passed else each.message):
                found = Submission([*same])
                levels = found[0].level if len(found) == 1 else f"{len(found)} levels"
                mark = "right" if found[0].passed else "wrong"
                total = f"{found.points:.4g}/{found.out_of:.4g}"
                lines += [f"  {mark}  {levels:{width}}  {total:>9}  {found[0].message}"]
        return "\n".join([*lines, f"{self.points:.4g} of {self.out_of:.4g} points"])


def _name(graded: GradedFunction) -> str:
    return f"{graded.function} in {graded.level}"


def grade_functions(
    course: str | os.PathLike[str],
    code: str | os.PathLike[str] | None = None,
    *,
    functions: Sequence[str] | None = None,
    seconds: float = 60.0,
    memory: float = 4.0,
) -> Submission:
    """Run the functions of a student in the levels of a course, and grade what they return.

    Of each function NAME in the `pack.yaml`, the file NAME.py has to have a function of that name.
    It gets a `Level`, and returns values, or a policy, as an array. Call this below
    `if __name__ == "__main__":`, as processes are started.

    Args:
        course: the folder of the course.
        code: the folder of the student's files, or one around it; by default that of the course.
        functions: those that are run; all by default.
        seconds: how long each may take in a level. After one that takes longer, the function
            is not run in the other levels.
        memory: how many GiB each may take, with all processes that it starts. Only Linux limits
            them.

    Raises:
        NotADirectoryError: there is no folder of a student.
        PackError: there is no course in the folder.
        LevelError: a file of the course has errors.
        RuntimeError: the process for the code does not start.
        ValueError: a function is none of the course, or a limit is not above 0.
    """
    for name, limit in (("seconds", seconds), ("memory", memory)):
        if not limit > 0:
            raise ValueError(f"{name} must be above 0, not {limit!r}")
    found = read_course(course)
    known = found.fields.functions
    for name in functions or ():
        if name not in known:
            raise ValueError(f"{name!r} is no function of the course: {', '.join(known)}")
    folder = _folder_of(Path(found.folder if code is None else code), functions or [*known])
    folder = folder.resolve()
    limits = seconds, memory
    return Submission(
        [each for name in functions or known for each in _graded(found, folder, name, limits)]
    )


def _folder_of(code: Path, names: Sequence[str]) -> Path:
    """Return the folder with the files of functions: a folder around a single one has none.

    Raises:
        NotADirectoryError: there is no such folder, or none of a student.
    """
    if not code.is_dir():
        told = (
            f"{code} is no folder: unpack it first"
            if code.exists()
            else f"there is no folder {code}"
        )
        raise NotADirectoryError(told)
    inside = [each for each in code.iterdir() if not each.name.startswith((".", "__"))]
    if any(map(is_file, inside)):
        return code
    if len(inside) == 1:
        return _folder_of(inside[0], names)
    files = listed([f"{name}.py" for name in names], "or")
    raise NotADirectoryError(f"{code} has no {files}: name the folder of one student")


def _graded(
    course: Course, code: Path, name: str, limits: tuple[float, float]
) -> Iterator[GradedFunction]:
    fields = course.fields
    entries = [each for each in fields.levels if name in fields.graded_in(each)]
    paths = [course.files[each.level].resolve() for each in entries]
    found: Iterable[Answer]
    if is_file(code / f"{name}.py"):
        found = answers(code, name, paths, *limits)
    else:
        others = sorted(name_of(each.name) for each in code.glob("*.py"))[:5]
        told = f"there is no {name}.py" + f", but {listed(others)}" * bool(others)
        found = [told] * len(entries)
    for entry, answer in zip(entries, found, strict=True):
        out_of = entry.points / len(fields.graded_in(entry))
        if isinstance(answer, str):
            graded = GradedAnswer(False, 0.0, out_of, answer)
        else:
            grader = GRADERS[fields.functions[name]]
            graded = grader(course.files[entry.level], answer, points=out_of)
        message = name_of(graded.message, MAX_MESSAGE)
        yield GradedFunction(
            name, entry.level, entry.hidden, graded.passed, graded.points, out_of, message
        )
