"""Submissions: the functions that students write, run in each level of a course, and graded.

Their code runs in a process of its own, with limits of time and memory. Only arrays come back,
which are graded here. No code is kept from files and networks: that is what containers are for.
Of a class, those of several students run side by side; threads wait for them.
"""

import json
import math
import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from contextlib import closing, suppress
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from hashlib import sha256
from itertools import groupby
from pathlib import Path
from tempfile import TemporaryDirectory
from threading import Event
from time import monotonic
from typing import Any

from babyrobot_levels.extensions.packs.build import Course, read_course
from babyrobot_levels.extensions.scoring.answers import (
    GradedAnswer,
    grade_agent,
    grade_policy,
    grade_values,
)
from babyrobot_levels.extensions.scoring.hand_ins import HandIn, hand_ins
from babyrobot_levels.extensions.scoring.results import Table
from babyrobot_levels.extensions.scoring.sources import Source, find_sources, write_sources
from babyrobot_levels.extensions.scoring.student import NOT_WRITTEN, Answer, answers, checked_table
from babyrobot_levels.language.plain_data import json_mapping
from babyrobot_levels.language.play import program
from babyrobot_levels.language.suite_list import CourseLevel
from babyrobot_levels.library.catalogue import load
from babyrobot_levels.render.words.phrases import name_of
from babyrobot_levels.text import budget
from babyrobot_levels.text.files import make_folder, write_text
from babyrobot_levels.text.words import listed

MOST_ENTRIES = 900_000
"""How large tables of levels may be: the processes of students need memory as well."""

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
        points: its points; nan if it could not be graded.
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

    @property
    def is_graded(self) -> bool:
        """Whether it could be graded."""
        return not math.isnan(self.points)

    @property
    def earned(self) -> float:
        """Its points, as systems take them that know no tasks without: then 0."""
        return self.points if self.is_graded else 0.0


class Submission(Table[GradedFunction], public=True):
    """The functions of a student, each in the levels of a course; its text is a report.

    Attributes:
        notes: what is odd about the files, in which functions were found all the same.
        likeness: what the same code has in common, by the functions that are written.
    """

    ROW = GradedFunction

    def __init__(
        self,
        rows: Sequence[GradedFunction],
        notes: Sequence[str] = (),
        likeness: Mapping[str, str] | None = None,
    ) -> None:
        super().__init__(rows)
        self.notes, self.likeness = (*notes,), likeness or {}

    def _part(self, rows: slice) -> "Submission":
        return Submission(self._rows[rows], self.notes, self.likeness)

    @property
    def points(self) -> float:
        """The points of all that could be graded."""
        return math.fsum(each.points for each in self if each.is_graded)

    @property
    def by_function(self) -> dict[str, "Submission"]:
        """The parts of it by the names of functions."""
        parts = groupby(self, lambda each: each.function)
        return {name: Submission([*rows]) for name, rows in parts}

    @property
    def ungraded(self) -> int:
        """How many functions could not be graded, each in each level."""
        return sum(not each.is_graded for each in self)

    @property
    def out_of(self) -> float:
        """The points of right answers."""
        return math.fsum(each.out_of for each in self)

    def to_dict(self) -> dict[str, Any]:
        """Return everything as a mapping that JSON can hold."""
        return {
            "points": self.points,
            "out_of": self.out_of,
            "ungraded": self.ungraded,
            "notes": [*self.notes],
            "functions": [json_mapping(asdict(each)) for each in self],
        }

    def to_gradescope(self) -> dict[str, Any]:
        """Return what Gradescope's autograder reads from `results.json`."""
        tests = [
            {
                "name": _name(each),
                "status": "passed" if each.passed else "failed",
                "score": round(each.earned, 4),
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
                "points": round(each.earned, 4),
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
                "score": round(each.earned, 4),
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
                "score": round(100 * each.earned),
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
                mark = "right" if found[0].passed else "wrong" if not found.ungraded else "-"
                total = f"{found.points:.4g}/{found.out_of:.4g}"
                lines += [f"  {mark}  {levels:{width}}  {total:>9}  {found[0].message}"]
        lines += [f"note: {each}" for each in self.notes]
        more = f", {self.ungraded} not graded" if self.ungraded else ""
        return "\n".join([*lines, f"{self.points:.4g} of {self.out_of:.4g} points{more}"])


def _name(graded: GradedFunction) -> str:
    return f"{graded.function} in {graded.level}"


@dataclass(frozen=True)
class Limits:
    """What the code of each student may take.

    Attributes:
        seconds: the time of a function in a level.
        memory: the GiB of a function, with all processes that it starts.
        total: the seconds of all functions in all levels; None for no limit.

    Raises:
        ValueError: one is not above 0.
    """

    seconds: float = 60.0
    memory: float = 4.0
    total: float | None = None

    def __post_init__(self) -> None:
        for name, limit in asdict(self).items():
            if limit is not None and not limit > 0:
                raise ValueError(f"{name} must be above 0, not {limit!r}")


def grade_functions(
    course: str | os.PathLike[str],
    code: str | os.PathLike[str] | None = None,
    *,
    functions: Sequence[str] | None = None,
    seconds: float = 60.0,
    memory: float = 4.0,
    total: float | None = None,
    progress: Callable[[Submission], None] | None = None,
) -> Submission:
    """Run the functions of a student in the levels of a course, and grade what they return.

    Of each function NAME in the `pack.yaml`, the file NAME.py has to have a function of that name;
    files of other names, and notebooks, are searched for it. It gets a `Level`, and returns values,
    or a policy, as an array. In place of code, NAME.json or NAME.npz may have these by the names
    of levels. Call this below `if __name__ == "__main__":`, as processes are started.

    Args:
        course: the folder of the course.
        code: the folder or the zip file of the student's files, or a folder around that; by
            default that of the course.
        functions: those that are run; all by default.
        seconds: how long each may take in a level. After one that takes longer, the function
            is not run in the other levels.
        memory: how many GiB each may take, with all processes that it starts. Only Linux limits
            them.
        total: how many seconds all may take together; what is left then is not graded.
        progress: told what is graded so far.

    Raises:
        FileNotFoundError: there is nothing at a path.
        PackError: there is no course in the folder.
        LevelError: a file of the course has errors.
        RuntimeError: the process for the code does not start.
        ValueError: there are no files of a student, or those of several; a function is none of
            the course; or a limit is not above 0.
    """
    limits = Limits(seconds, memory, total)
    found = read_course(course)
    grader = Grader(found, functions, limits)
    path = Path(found.folder if code is None else code)
    if not any(found.fields.graded_in(each) for each in found.fields.levels):
        return Submission([])
    handed = hand_ins([path], code=True)
    if len(handed) != 1 or not handed[0].files:
        files = listed([f"{name}.py" for name in grader.names], "or")
        raise ValueError(f"{path} has no {files}: name the folder of one student")
    return grader.submission(handed[0], shown=True, progress=progress)


@dataclass(frozen=True)
class Ungraded:
    """Why an answer could not be graded, which is no fault of the student's."""

    reason: str


class Grader:
    """Runs the functions of students in the levels of a course, and grades what they return."""

    def __init__(self, course: Course, functions: Sequence[str] | None, limits: Limits) -> None:
        self.course, self.limits = course, limits
        known = course.fields.functions
        self.names = [functions] if isinstance(functions, str) else [*(functions or known)]
        for name in self.names:
            if name not in known:
                raise ValueError(f"{name!r} is no function of the course: {', '.join(known)}")
        entries = course.fields.levels
        # What is computed of a level once is kept with it.
        self.levels = {each.level: load(course.files[each.level]) for each in entries}
        self.given = {name: path.read_bytes() for name, path in course.given.items()}
        self.stop = Event()

    def grade_all(
        self,
        handed: Sequence[HandIn],
        *,
        jobs: int | None = None,
        progress: Callable[[int, int], None] | None = None,
        kept: Path | None = None,
    ) -> dict[str, Submission]:
        """Return the submission of each student of a class; see `brl.grade`."""
        if kept is not None:
            make_folder(kept)

        def one(hand_in: HandIn) -> tuple[str, Submission]:
            return hand_in.player, self._kept(hand_in, kept)

        found: dict[str, Submission] = {}
        with ThreadPoolExecutor(jobs or os.cpu_count()) as pool:
            try:
                work = budget.limited(one, entries=MOST_ENTRIES)
                waiting = [pool.submit(work, each) for each in handed]
                for number, done in enumerate(as_completed(waiting), 1):
                    player, submission = done.result()
                    found[player] = submission
                    if progress is not None:
                        progress(number, len(handed))
            except BaseException:
                self.stop.set()
                pool.shutdown(wait=False, cancel_futures=True)
                raise
        return {each.player: found[each.player] for each in handed}

    def _kept(self, hand_in: HandIn, kept: Path | None) -> Submission:
        """Return a submission, that which is kept of the same files if there is one."""
        if kept is None:
            return self.submission(hand_in)
        path = kept / f"{self._digest(hand_in)}.json"
        with suppress(OSError, ValueError, LookupError, TypeError):
            told = json.loads(path.read_text("utf-8"))
            rows = [GradedFunction(**each) for each in told["functions"]]
            return Submission(rows, told["notes"], told["likeness"])
        found = self.submission(hand_in)
        if not found.ungraded:
            told = {**found.to_dict(), "likeness": dict(found.likeness)}
            write_text(path, json.dumps(told))
        return found

    def _digest(self, hand_in: HandIn) -> str:
        """Return what a submission is known by: files, course, limits, and this version."""
        course = self.course
        told = [program(), repr(self.limits), *self.names, course.fields.model_dump_json()]
        parts = [text.encode() for text in told]
        parts += [course.files[name].read_bytes() for name in self.levels]
        for name, data in sorted(hand_in.files.items()):
            parts += [name.encode("utf-8", "replace"), data]
        found = sha256()
        for part in parts:
            found.update(sha256(part).digest())
        return found.hexdigest()

    def submission(
        self,
        hand_in: HandIn,
        *,
        shown: bool = False,
        progress: Callable[[Submission], None] | None = None,
    ) -> Submission:
        """Return what the functions of a student are worth.

        Args:
            hand_in: what the student handed in.
            shown: whether the beginning of what functions print is written to standard error.
            progress: told what is graded so far.
        """
        sources = find_sources(hand_in.files, self.names)
        told = hand_in.told + [each.note for each in sources.values() if each.note]
        notes = [name_of(each, MAX_MESSAGE) for each in told]
        alike = {name: each.likeness for name, each in sources.items()}
        likeness = {name: each for name, each in alike.items() if each is not None}
        rows: list[GradedFunction] = []
        limit = self.limits.total
        until = math.inf if limit is None else monotonic() + limit
        with TemporaryDirectory(prefix="babyrobot-", ignore_cleanup_errors=True) as temporary:
            folder = Path(temporary).resolve()
            write_sources(folder, {**self.given, **hand_in.files}, sources)
            for name, source in sources.items():
                for row in self._rows(hand_in, folder, name, source, shown, until):
                    rows.append(row)
                    if progress is not None:
                        progress(Submission(rows, notes, likeness))
        return Submission(rows, notes, likeness)

    def _rows(
        self, hand_in: HandIn, folder: Path, name: str, source: Source, shown: bool, until: float
    ) -> Iterator[GradedFunction]:
        """Yield what a function is worth in each level."""
        fields = self.course.fields
        entries = [each for each in fields.levels if name in fields.graded_in(each)]
        told: Iterable[Answer | Ungraded]
        if not hand_in.files and not hand_in.entries:
            why = next((fault for _, fault in hand_in.faults), "nothing was handed in")
            told = [Ungraded(why)] * len(entries)
        elif source.fault or not source.is_written:
            told = [source.fault or NOT_WRITTEN] * len(entries)
        elif source.text is None:
            told = [self._table(source, each) for each in entries]
        else:
            paths = [self.course.files[each.level].resolve() for each in entries]
            told = self._answers(folder, name, paths, shown, until)
        for entry, answer in zip(entries, told, strict=True):
            out_of = entry.points / len(fields.graded_in(entry))
            graded = self._graded(name, entry.level, answer, out_of)
            message = name_of(graded.message, MAX_MESSAGE)
            points = math.nan if isinstance(answer, Ungraded) else graded.points
            yield GradedFunction(
                name, entry.level, entry.hidden, graded.passed, points, out_of, message
            )

    def _answers(
        self, folder: Path, name: str, paths: Sequence[Path], shown: bool, until: float
    ) -> Iterator[Answer | Ungraded]:
        """Yield the answers of a function, as long as there is time for all of them."""
        left, limits = len(paths), self.limits
        if monotonic() < until:
            seconds = limits.seconds
            given = answers(folder, name, paths, seconds, limits.memory, self.stop, shown=shown)
            with closing(given):
                for answer in given:
                    left -= 1
                    yield answer
                    if monotonic() > until:
                        break
        yield from [Ungraded("there was no time left")] * left

    def _table(self, source: Source, entry: CourseLevel) -> Answer | Ungraded:
        """Return the answer in a level of a student who handed in tables."""
        tables = source.tables
        if not isinstance(tables, dict):
            return f"{source.file} has one table: give one for each level, by its name"
        if (found := tables.get(entry.level)) is not None:
            return checked_table(found)
        if entry.hidden:
            return Ungraded("students do not have this level, and handed in no code")
        known = ", ".join(name_of(each) for each in [*tables][:5])
        return f"{source.file} has no table of {entry.level}" + f", but of {known}" * bool(known)

    def _graded(
        self, name: str, level: str, answer: Answer | Ungraded, out_of: float
    ) -> GradedAnswer:
        """Return what an answer is worth."""
        if isinstance(answer, Ungraded):
            return GradedAnswer(False, 0.0, out_of, f"not graded: {answer.reason}")
        if isinstance(answer, str):
            return GradedAnswer(False, 0.0, out_of, answer)
        budget.begin()
        grader = GRADERS[self.course.fields.functions[name]]
        return grader(self.levels[level], answer, points=out_of)
