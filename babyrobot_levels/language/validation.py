"""Text to `LevelFields`, or to diagnostics that point at each fault in it."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Callable, Iterable, Sequence
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError

from babyrobot_levels.language.base import FORM_PREFIX
from babyrobot_levels.language.messages import complaint
from babyrobot_levels.language.problem import Problem, SpecProblems
from babyrobot_levels.language.rules import MAX_PROBLEMS
from babyrobot_levels.text.diagnostics import Diagnostic, Fix, Severity
from babyrobot_levels.text.document import Document, Node, YamlFault, YamlProblem
from babyrobot_levels.text.reader import read
from babyrobot_levels.text.source import Position, SourceFile, Span
from babyrobot_levels.text.words import shortened

ModelT = TypeVar("ModelT", bound=BaseModel)

Route = tuple[str | int, ...]

_GEOMETRY_NEEDS = {"size", "map", "legend", "start", "exit"}
"""Where one of these is faulty, a check of the geometry would only report what follows from it."""


def parse(
    source: SourceFile,
    model: type[ModelT],
    checks: Iterable[Callable[[ModelT], Iterable[Problem]]] = (),
) -> tuple[ModelT | None, list[Diagnostic]]:
    """Read a text as a model: the model, or None and every fault that was found.

    `checks` look at a model that is valid by itself and may find more.
    """
    try:
        document = read(source)
    except YamlFault as fault:
        return None, [from_yaml(fault.problem, source)]
    return parse_document(document, model, checks)


def parse_document(
    document: Document,
    model: type[ModelT],
    checks: Iterable[Callable[[ModelT], Iterable[Problem]]] = (),
) -> tuple[ModelT | None, list[Diagnostic]]:
    """Read a document as a model; see `parse`."""
    source = document.source
    found = [from_yaml(problem, source) for problem in document.problems[:MAX_PROBLEMS]]
    if not isinstance(document.data, dict):
        what = "is empty" if document.data is None else "does not hold a mapping of fields"
        help_text = _beginning(model)
        if isinstance(document.data, str) and re.match(r"[a-z_]+:\S", document.data):
            help_text = "put a blank behind the `:`"
        problem = Problem("BR110", (), f"the file {what}", help_text)
        return None, [*found, diagnostic(problem, document)]
    value, problems = validate(document.data, model)
    if value is not None:
        problems = [problem for check in checks for problem in check(value)]
    # A value that could not be read is told once, and not again for what stands in its place.
    unread = {problem.span for problem in document.problems}
    told = (diagnostic(problem, document) for problem in problems)
    found += [each for each in told if each.span not in unread]
    found.sort(key=lambda each: (each.line, each.column))
    return (None if found else value), found


def validate(data: dict[str, Any], model: type[ModelT]) -> tuple[ModelT | None, list[Problem]]:
    """Validate plain data: the model, or None and every fault, those of single fields first."""
    try:
        return model.model_validate(data), []
    except ValidationError as error:
        details: Sequence[Any] = [d for d in error.errors(include_url=False) if _is_fault(d)]
    problems = _problems(details[:MAX_PROBLEMS], model)
    if len(details) > MAX_PROBLEMS:
        return None, problems
    if not any(_spec_problems(detail) for detail in details):
        # Single fields are faulty, so the whole was not checked yet: check what is left of it.
        rest = _Rest(data, [problem.route for problem in problems])
        if rest.is_enough:
            try:
                model.model_validate(rest.data)
            except ValidationError as error:
                whole = [d for d in error.errors(include_url=False) if _spec_problems(d)]
                problems += map(rest.in_whole, _problems(whole, model))
    return None, problems[:MAX_PROBLEMS]


def _problems(details: Sequence[Any], model: type[BaseModel]) -> list[Problem]:
    problems: list[Problem] = []
    for detail in details:
        whole = _spec_problems(detail)
        if whole:
            problems += whole
            continue
        route = _route(detail["loc"])
        fields = _fields_around(detail["loc"], model)
        code, message, help_text = complaint(detail, fields, _beginning(model))
        kind = detail["type"]
        if kind == "missing":
            route = route[:-1]
        subject = _subject(route) if message.startswith("must ") else ""
        problems.append(
            Problem(
                code,
                route,
                f"{subject}{message}",
                help_text,
                key=kind == "extra_forbidden" or "[key]" in detail["loc"],
            )
        )
    return problems


def _beginning(model: type[BaseModel]) -> str | None:
    return getattr(model, "BEGINNING", None)


def _is_fault(detail: Any) -> bool:
    # Pydantic counts the entries that are left: a list of faulty ones is too short for it.
    return not (detail["type"] == "too_short" and detail["input"])


def _spec_problems(detail: Any) -> tuple[Problem, ...]:
    error = detail.get("ctx", {}).get("error")
    return error.problems if isinstance(error, SpecProblems) else ()


def _subject(route: Route) -> str:
    """Return the words that a message begins with: which field it speaks of."""
    text = ""
    for segment in route:
        text = f"{text}[{segment}]" if isinstance(segment, int) else shortened(segment)
    return f"`{text}` " if text else ""


def _route(location: Sequence[str | int]) -> Route:
    """Return pydantic's location without the segments that are not in the file."""
    route: list[str | int] = []
    for segment in location:
        if isinstance(segment, str) and segment.startswith(FORM_PREFIX):
            continue
        if segment == "[key]":
            break
        route.append(segment)
    return tuple(route)


def _fields_around(location: Sequence[str | int], model: type[BaseModel]) -> list[str]:
    """Return the field names of the mapping in which the location's last segment stands."""
    current: Any = model
    for segment in location[:-1]:
        current = _inner(current, segment)
    fields = getattr(current, "model_fields", {})
    return [info.alias or name for name, info in fields.items()]


def _inner(current: Any, segment: str | int) -> Any:
    """Return the model that lies one segment deeper, or what leads to it."""
    if isinstance(segment, int) or str(segment).startswith(FORM_PREFIX):
        return current
    fields = getattr(current, "model_fields", {})
    if segment not in fields:
        return current
    return next(iter(_models_in(fields[segment].annotation)), None)


def _models_in(annotation: Any) -> list[type[BaseModel]]:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    inner = [*getattr(annotation, "__args__", ())]
    return [model for argument in inner for model in _models_in(argument)]


class _Rest:
    """Data without its faulty parts: faulty fields, and faulty entries of lists."""

    def __init__(self, data: dict[str, Any], routes: list[Route]):
        faulty = {route[:2] if _is_entry(route, data) else route[:1] for route in routes if route}
        self.is_enough = not any(route[0] in _GEOMETRY_NEEDS for route in faulty)
        self.data: dict[str, Any] = {"version": 1}
        self.kept: dict[str, list[int]] = {}
        for field, value in data.items():
            if (field,) in faulty:
                continue
            if isinstance(value, list):
                kept = [index for index in range(len(value)) if (field, index) not in faulty]
                self.kept[field] = kept
                value = [value[index] for index in kept]
            self.data[field] = value

    def in_whole(self, problem: Problem) -> Problem:
        """Return the problem with the number that its list entry has in the whole data."""
        field, index = (*problem.route, None, None)[:2]
        if not isinstance(index, int) or str(field) not in self.kept:
            return problem
        route = (str(field), self.kept[str(field)][index], *problem.route[2:])
        return dataclasses.replace(problem, route=route)


def _is_entry(route: Route, data: dict[str, Any]) -> bool:
    return (
        len(route) > 1 and isinstance(route[1], int) and isinstance(data.get(str(route[0])), list)
    )


def from_yaml(problem: YamlProblem, source: SourceFile) -> Diagnostic:
    """Return what is to be said of a fault of the text itself."""
    start, end = problem.span
    return Diagnostic(
        problem.code,
        Severity.ERROR,
        problem.message,
        source.name,
        start.line,
        start.column,
        end,
        help=problem.help,
        source=source,
    )


def diagnostic(
    problem: Problem,
    document: Document,
    severity: Severity = Severity.ERROR,
    fix: Fix | None = None,
) -> Diagnostic:
    """Return what is to be said of a problem, with the place in the text to which it points."""
    span = document.span(problem.route, key=problem.key)
    if problem.mark is not None:
        span = _drawing_span(document, problem) or span
    elif not problem.route:
        span = Span(Position(1, 1), Position(1, len(document.source.line(1)) + 1))
    return Diagnostic(
        problem.code,
        severity,
        problem.message,
        document.source.name,
        span.start.line,
        span.start.column,
        span.end,
        fix,
        help=problem.help,
        source=document.source,
    )


def _drawing_span(document: Document, problem: Problem) -> Span | None:
    """Return where a character of a drawing stands in the file; None if it is not a block."""
    node, depth = document.node(problem.route)
    if not node.block or depth < len(problem.route) or problem.mark is None:
        return None
    row, column, length = problem.mark
    # The text of a block scalar begins on the line below its `|`, less a common indentation.
    first = node.span.start.line + 1
    if not document.source.line(first + row).strip():
        return None
    start = Position(first + row, _indent(document, node, first) + column + 1)
    # What is missing at the end of a line is shown there, but takes no room.
    end = min(start.column + length, len(document.source.line(start.line)) + 1)
    return Span(start, Position(start.line, end))


def _indent(document: Document, node: Node, first: int) -> int:
    """Return how many blanks stand before the text of a block scalar that begins on a line."""
    begin = 0
    for line in range(first, len(document.source.lines) + 1):
        whole = document.source.line(line)
        end = node.data.find("\n", begin)
        text = node.data[begin : end if end >= 0 else None]
        if text:
            return len(whole) - len(text)
        begin = end + 1
    return 0
