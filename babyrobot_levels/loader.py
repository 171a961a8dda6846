"""Text to `LevelFields`, or to diagnostics that point at each fault in it."""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterable, Sequence
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError

from babyrobot_levels.diagnostics import Diagnostic, Severity
from babyrobot_levels.messages import complaint
from babyrobot_levels.source import Position, SourceFile, Span
from babyrobot_levels.spec.base import FORM_PREFIX
from babyrobot_levels.spec.problem import Problem, SpecProblems
from babyrobot_levels.syntax.document import Document, YamlFault, YamlProblem
from babyrobot_levels.syntax.reader import read

ModelT = TypeVar("ModelT", bound=BaseModel)

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
        return None, [_from_yaml(fault.problem, source)]
    found = [_from_yaml(problem, source) for problem in document.problems]
    if not isinstance(document.data, dict):
        what = "is empty" if document.data is None else "does not hold a mapping of fields"
        problem = Problem("BR110", (), f"the file {what}", "a level begins with `version: 1`")
        return None, [*found, _diagnostic(problem, document)]
    value, problems = validate(document.data, model)
    if value is not None:
        problems = [problem for check in checks for problem in check(value)]
    found += [_diagnostic(problem, document) for problem in problems]
    found.sort(key=lambda diagnostic: (diagnostic.line, diagnostic.column))
    return (None if found else value), found


def validate(data: dict[str, Any], model: type[ModelT]) -> tuple[ModelT | None, list[Problem]]:
    """Validate plain data: the model, or None and every fault, those of single fields first."""
    try:
        return model.model_validate(data), []
    except ValidationError as error:
        details: Sequence[Any] = error.errors(include_url=False)
    problems = _problems(details, data, model)
    if not any(_spec_problems(detail) for detail in details):
        # Single fields are faulty, so the whole was not checked yet: check what is left of it.
        rest = _without(data, [problem.route for problem in problems])
        if rest is not None:
            try:
                model.model_validate(rest)
            except ValidationError as error:
                details = [d for d in error.errors(include_url=False) if _spec_problems(d)]
                problems += [_shifted(p, data, rest) for p in _problems(details, rest, model)]
    return None, problems


def _problems(details: Sequence[Any], data: Any, model: type[BaseModel]) -> list[Problem]:
    problems: list[Problem] = []
    for detail in details:
        whole = _spec_problems(detail)
        if whole:
            problems += whole
            continue
        route = _route(detail["loc"], data)
        code, message, help_text = complaint(detail, _fields_around(detail["loc"], model))
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


def _spec_problems(detail: Any) -> tuple[Problem, ...]:
    error = detail.get("ctx", {}).get("error")
    return error.problems if isinstance(error, SpecProblems) else ()


def _subject(route: tuple[str | int, ...]) -> str:
    """Return the words that a message begins with: which field it speaks of."""
    names = [segment for segment in route if isinstance(segment, str)]
    return f"`{names[-1]}` " if names else ""


def _route(location: Sequence[str | int], data: Any) -> tuple[str | int, ...]:
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


def _without(data: dict[str, Any], routes: list[tuple[str | int, ...]]) -> dict[str, Any] | None:
    """Return the data without its faulty parts, or None where too little is left to check."""
    if any(not route or route[0] in _GEOMETRY_NEEDS for route in routes):
        missing_version = all(not route for route in routes) and "version" not in data
        if not missing_version:
            return None
    rest: dict[str, Any] = copy.deepcopy(data)
    rest["version"] = 1
    for route in sorted(routes, key=str, reverse=True):
        if not route:
            continue
        field, entry = route[0], route[1] if len(route) > 1 else None
        if isinstance(entry, int) and isinstance(rest.get(str(field)), list):
            # A hole keeps the other entries' numbers; it is closed below.
            rest[str(field)][entry] = _HOLE
        else:
            rest.pop(str(field), None)
    for field, value in rest.items():
        if isinstance(value, list):
            rest[field] = [entry for entry in value if entry is not _HOLE]
    return rest


_HOLE: Any = object()


def _shifted(problem: Problem, data: dict[str, Any], rest: dict[str, Any]) -> Problem:
    """Return the problem with the number that its list entry has in the whole data."""
    if len(problem.route) < 2 or not isinstance(problem.route[1], int):
        return problem
    field, index = str(problem.route[0]), problem.route[1]
    whole = data.get(field)
    if not isinstance(whole, list) or not isinstance(rest.get(field), list):
        return problem
    wanted, position = rest[field], -1
    for count in range(index + 1):
        position = next(
            (p for p in range(position + 1, len(whole)) if whole[p] == wanted[count]), position
        )
    route = (field, position, *problem.route[2:])
    return Problem(
        problem.code, route, problem.message, problem.help, key=problem.key, mark=problem.mark
    )


def _from_yaml(problem: YamlProblem, source: SourceFile) -> Diagnostic:
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


def _diagnostic(problem: Problem, document: Document) -> Diagnostic:
    span = document.span(problem.route, key=problem.key)
    if problem.mark is not None:
        span = _drawing_span(document, problem) or span
    elif not problem.route:
        span = Span(Position(1, 1), Position(1, len(document.source.line(1)) + 1))
    return Diagnostic(
        problem.code,
        Severity.ERROR,
        problem.message,
        document.source.name,
        span.start.line,
        span.start.column,
        span.end,
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
    line = node.span.start.line + 1 + row
    shown = node.data.split("\n")
    text = shown[row] if row < len(shown) else ""
    whole = document.source.line(line)
    indent = len(whole) - len(text) if whole.endswith(text) and text else _indent(document, node)
    start = Position(line, indent + column + 1)
    return Span(start, Position(line, start.column + length))


def _indent(document: Document, node: Any) -> int:
    first = document.source.line(node.span.start.line + 1)
    return len(first) - len(first.lstrip(" "))
