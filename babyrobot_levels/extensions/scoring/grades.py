"""Grades: all that a class hands in, plays and the functions of a course."""

from __future__ import annotations

import math
import os
import re
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from contextlib import suppress
from copy import copy
from dataclasses import asdict
from pathlib import Path
from typing import Any

from babyrobot_levels.extensions.packs.archive import PackError
from babyrobot_levels.extensions.packs.build import Course, read_course
from babyrobot_levels.extensions.scoring.hand_ins import hand_ins
from babyrobot_levels.extensions.scoring.play_grades import RULES, Asked, Defect, Grade, Players
from babyrobot_levels.extensions.scoring.results import Table, csv_of
from babyrobot_levels.extensions.scoring.submissions import (
    GradedFunction,
    Grader,
    Limits,
    Submission,
)
from babyrobot_levels.language.plain_data import json_mapping
from babyrobot_levels.library.catalogue import folder_named, load
from babyrobot_levels.suites.suite import Levels, named_levels
from babyrobot_levels.text import budget
from babyrobot_levels.text.words import check_choice


class Grades(Table[Grade], public=True):
    """What several players handed in: one grade of plays for each player and level.

    Attributes:
        rule: by what points are given for plays; see `grade`.
        defects: all files and plays that do not count.
        submissions: the functions of a course, by player.
        ids: the numbers and addresses by which the school's system knows a player, as far as it
            tells them.
        notes: what is odd about files of a player that were read all the same.
        title: the title of the course, or the name of the only level.
    """

    ROW = Grade

    def __init__(
        self,
        grades: Sequence[Grade],
        rule: str,
        defects: Sequence[Defect],
        submissions: Mapping[str, Submission] | None = None,
        alike: Collection[tuple[str, frozenset[str]]] = (),
        *,
        ids: Mapping[str, Collection[str]] | None = None,
        notes: Mapping[str, Sequence[str]] | None = None,
        title: str = "",
    ) -> None:
        super().__init__(grades)
        self.rule, self.defects, self.submissions = rule, tuple(defects), submissions or {}
        self._alike, self.ids, self.notes, self.title = alike, ids or {}, notes or {}, title

    def _part(self, rows: slice) -> Grades:
        found = copy(self)
        found._rows = self._rows[rows]
        return found

    @property
    def are_valid(self) -> bool:
        """Whether nothing is wrong with any file, and all could be graded."""
        ungraded = any(each.ungraded for each in self.submissions.values())
        return not (self.defects or ungraded) and all(grade.fault is None for grade in self)

    @property
    def levels(self) -> list[str]:
        """The levels of plays, in their order."""
        return list(dict.fromkeys(grade.level for grade in self))

    @property
    def worth(self) -> dict[str, float]:
        """The most points of each task: functions as `NAME.py`, and levels to play."""
        worth = {each.level: each.worth for each in self}
        for each in (*self.submissions.values(),)[:1]:
            parts = {f"{name}.py": rows for name, rows in each.by_function.items()}
            worth = {name: rows.out_of for name, rows in parts.items()} | worth
        return worth

    @property
    def totals(self) -> dict[str, dict[str, float]]:
        """The points of each player: for each task of `worth`, and their sum as `"total"`.

        What could not be graded is nan, and left out of the sum; where nothing could, so is that.
        """
        players = [*self.submissions, *(each.player for each in self)]
        found = {name: dict.fromkeys(self.worth, 0.0) for name in players}
        for name, submission in self.submissions.items():
            for function, rows in submission.by_function.items():
                none = rows.ungraded == len(rows)
                found[name][f"{function}.py"] = math.nan if none else rows.points
        for each in self:
            row = found[each.player]
            row[each.level] = max(row[each.level], each.points)
        for row in found.values():
            known = [each for each in row.values() if not math.isnan(each)]
            row["total"] = math.fsum(known) if known or not row else math.nan
        return found

    @property
    def shared(self) -> dict[str, list[list[str]]]:
        """The players who have the same code, or the same plays, by task."""
        alike: dict[tuple[str, str], list[str]] = {}
        for player, submission in self.submissions.items():
            for name, likeness in submission.likeness.items():
                alike.setdefault((f"{name}.py", likeness), []).append(player)
        found: dict[str, list[list[str]]] = {}
        for (task, _), players in alike.items():
            if len(players) > 1:
                found.setdefault(task, []).append(players)
        for level, several in sorted((level, sorted(several)) for level, several in self._alike):
            if len(several) > 1:
                found.setdefault(level, []).append(several)
        return found

    @property
    def mistakes(self) -> dict[str, dict[str, list[str]]]:
        """Whoever made the same mistake, by function and mistake; the commonest come first."""
        found: dict[str, dict[str, list[str]]] = {}
        for player, submission in self.submissions.items():
            for name, rows in submission.by_function.items():
                wrong = [each for each in rows if each.is_graded and not each.passed]
                for told in dict.fromkeys(map(_mistake, wrong)):
                    found.setdefault(f"{name}.py", {}).setdefault(told, []).append(player)
        return {
            task: dict(sorted(told.items(), key=lambda each: -len(each[1])))
            for task, told in found.items()
        }

    def totals_to_csv(self) -> str:
        """Return a table of the points, with a line for each player, as CSV."""
        rows = [
            [name, *("" if each != each else each for each in row.values())]
            for name, row in self.totals.items()
        ]
        return csv_of([["player", *self.worth, "total"], *rows])

    def to_dict(self) -> dict[str, Any]:
        """Return everything as a mapping that JSON can hold; null for nan."""
        told = {
            "grades": [json_mapping(asdict(grade)) for grade in self],
            "totals": {name: json_mapping(points) for name, points in self.totals.items()},
            "defects": [asdict(defect) for defect in self.defects],
        }
        if notes := {name: [*each] for name, each in self.notes.items() if each}:
            told["notes"] = notes
        if self.submissions:
            told["submissions"] = {name: each.to_dict() for name, each in self.submissions.items()}
        return told

    def __repr__(self) -> str:
        return f"<Grades of {len(self.totals)} players>"


def grade(
    files: str | os.PathLike[str] | Iterable[str | os.PathLike[str]],
    level: Levels | None = None,
    *,
    points: str = "regret",
    functions: Sequence[str] | None = None,
    seconds: float = 60.0,
    memory: float = 4.0,
    jobs: int | None = None,
    progress: Callable[[int, int], None] | None = None,
    kept: str | os.PathLike[str] | None = None,
) -> Grades:
    """Grade all that players hand in: plays, and functions of a course.

    Plays are verified, and their returns compared with the exact optimum. Of a course with
    functions, these are run as `grade_functions` does, those of several students side by side. Call
    this below `if __name__ == "__main__":` then. Code counts if anybody has any, and so do plays.

    Args:
        files: a file, or a folder or a zip file of them, with a folder for each player; or several.
        level: the level that was to be played, or the levels: several, a folder, a pack or a
            course, whose levels have points, without those that are hidden. They are to be played
            under their time limit, their discount and from their starts; plays of other levels are
            left out, and those under other conditions or of other versions are faults. By default,
            each level has a grade of its own, under the conditions of its plays.
        points: by what a level's points are given, for the best play in which the player watched
            no policy: `"regret"`, 1 less the cost of its decisions as a share of what the optimum
            is above random actions; `"share"`, the share of the way that its return covers;
            `"success"`, whether it reaches an exit; `"tries"`, 1 divided by the number of episodes
            until the first that does.
        functions: those of the course that are graded; all by default, `[]` for none.
        seconds: how long a function may take in a level.
        memory: how many GiB a function may take.
        jobs: how many students' code is run at the same time; by default as many as there are
            processors.
        progress: told how many of how many submissions are graded.
        kept: a folder in which results of functions are kept: the same files are not run again.

    Raises:
        FileNotFoundError: there is no such file or folder.
        LevelNotFoundError: there is no such level.
        LevelError: a level is not valid, or its maze has no seed yet.
        RuntimeError: processes for code do not start.
        ValueError: there is no such rule or function, two levels are the same, a limit is not above
            0, or there is nothing to grade.
    """
    check_choice("points", points, RULES)
    limits = Limits(seconds, memory)
    course = _course(level)
    wanted = None if level is None else _wanted(level, course)
    has_code = course is not None and bool(course.fields.functions) and functions != []
    if functions and not has_code:
        raise ValueError(f"there are no functions to grade, and so not {functions!r}")
    handed = hand_ins([files] if isinstance(files, str | os.PathLike) else files, code=has_code)
    class_ = Players(wanted, points, handed)
    submissions: dict[str, Submission] = {}
    if course is not None and any(each.files for each in handed):
        submissions = Grader(course, functions, limits).grade_all(
            handed, jobs=jobs, progress=progress, kept=None if kept is None else Path(kept)
        )
    grades: list[Grade] = []
    if not submissions or any(each.entries for each in handed):
        grades = [each for hand_in in handed for each in class_.grades_of(hand_in)]
    else:
        class_.defects = [Defect(each.player, *told) for each in handed for told in each.faults]
    return Grades(
        grades,
        points,
        class_.defects,
        submissions,
        class_.alike,
        ids={each.player: each.ids for each in handed},
        notes={
            each.player: submissions[each.player].notes if submissions else each.told
            for each in handed
        },
        title=_title(course, grades),
    )


def _title(course: Course | None, grades: Sequence[Grade]) -> str:
    if course is not None:
        return course.fields.title or course.fields.name
    names = {each.level for each in grades}
    return names.pop() if len(names) == 1 else ""


def _course(levels: Levels | None) -> Course | None:
    """Return the course that is named, if it is one."""
    folder = folder_named(levels) if isinstance(levels, str | os.PathLike) else None
    with suppress(PackError):
        return None if folder is None else read_course(folder)
    return None


def _wanted(levels: Levels, course: Course | None) -> dict[str, Asked]:
    """Return the levels that were to be played with what they are worth, by their digests."""
    found: list[Asked] = []
    if course is not None:
        played = [each for each in course.fields.levels if not each.hidden]
        found = [Asked(load(course.files[each.level]), each.points) for each in played]
    found = found or [Asked(load(each), 1.0) for each in named_levels(levels)]
    by_digest: dict[str, Asked] = {}
    for asked in found:
        budget.begin()
        by_digest[asked.level.digest] = asked
    names = {asked.level.name or asked.level.digest for asked in found}
    if min(len(by_digest), len(names)) < len(found):
        raise ValueError("two of the levels are the same, or have the same name")
    return by_digest


def _mistake(graded: GradedFunction) -> str:
    """Return what is wrong, as it is alike in several levels: without how much is right."""
    told = re.sub(r"^.*? are right: |^the policy is right in .*?: ", "", graded.message)
    told = re.sub(rf"\b{re.escape(graded.level)}\b", "a level", told.partition(", but ")[0])
    return re.sub(r"\[\d.*?\]", "[…]", re.sub(r"-?\b\d+(\.\d+)?(?= %)", "…", told))
