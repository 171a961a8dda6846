"""Data and documents checked against a model, with an issue for each error."""

import dataclasses
import re
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import Any, Generic, NamedTuple, TypeVar

from pydantic import BaseModel, ValidationError

from babyrobot_levels.language.base import FORM_PREFIX
from babyrobot_levels.language.checks import MAX_PROBLEMS
from babyrobot_levels.language.drawing import is_block_map
from babyrobot_levels.language.kinds import NAMED
from babyrobot_levels.text.diagnostics import Diagnostic, Issue, Key, Mark, Route
from babyrobot_levels.text.document import Document, comments
from babyrobot_levels.text.errors import InvalidDocument, LevelError
from babyrobot_levels.text.reader import read
from babyrobot_levels.text.source import Position, SourceFile, Span, other_form
from babyrobot_levels.text.words import nearest, shortened, words_beside

ModelT = TypeVar("ModelT", bound=BaseModel)
Check = Callable[[ModelT], Iterable[Issue]]
"""Looks at a model that is valid by itself and may find more."""

_COLOUR_IN_COMMENT = re.compile(r"\b(color|text_color):[ \t]+(#[0-9A-Fa-f]{3,8})[ \t]*$", re.M)

_NEEDED = {"size", "map", "legend", "start", "exit", "exit_one_of", "functions"}
"""Where one of these is invalid, checks of the whole would only report its consequences."""


class Checked(NamedTuple, Generic[ModelT]):
    """The outcome of a check: a value without diagnostics, or None and every error."""

    value: ModelT | None
    diagnostics: list[Diagnostic]

    def valid(self) -> ModelT:
        """Return the value.

        Raises:
            LevelError: there is none; it carries the diagnostics.
        """
        if self.value is None:
            raise LevelError(self.diagnostics)
        return self.value


def parse(
    source: SourceFile, model: type[ModelT], checks: Iterable[Check[ModelT]] = ()
) -> Checked[ModelT]:
    """Read a text as YAML and check it; see `check`."""
    try:
        document = read(source)
    except LevelError as error:
        return Checked(None, [*error.diagnostics])
    return check(document, model, checks)


def check(
    document: Document, model: type[ModelT], checks: Iterable[Check[ModelT]] = ()
) -> Checked[ModelT]:
    """Check a document against a model, and if it is valid, by further checks."""
    issues = [*document.issues[:MAX_PROBLEMS]]
    form, is_mapping = other_form(document.source.name), isinstance(document.data, dict)
    if not is_mapping or (form and "version" not in document.data):
        what = "is no level" if is_mapping else "does not contain a mapping of fields"
        what = "is empty" if document.data is None else what
        from babyrobot_levels.language.messages import beginning

        help_text = form or beginning(model)
        if document.data is None and is_block_map(document.source.lines):
            # To YAML, lines that begin with `#` are comments.
            help_text = "convert a map of blocks with `babyrobot import`"
        if isinstance(document.data, str) and re.match(r"[a-z_]+:\S", document.data):
            help_text = "add a space after `:`"
        issues.append(Issue("BR110", (), f"the file {what}", help_text))
        return Checked(None, [document.diagnostic(issue) for issue in issues])
    issues += _colours_in_comments(document)
    value, found = validate(document.data, model)
    if value is not None:
        found = [issue for each in checks for issue in each(value)]
    # A value that could not be read is reported once, and not again for what replaces it.
    unread = {issue.location for issue in document.issues}
    diagnostics = [document.diagnostic(issue) for issue in found]
    diagnostics = [
        *map(document.diagnostic, issues),
        *(each for each in diagnostics if each.span not in unread),
    ]
    diagnostics.sort(key=lambda each: (each.line, each.column))
    return Checked(None if diagnostics else value, diagnostics)


def _colours_in_comments(document: Document) -> Iterator[Issue]:
    """Yield the colours without quotes: to YAML they are comments, and the field is empty."""
    if not _COLOUR_IN_COMMENT.search(document.source.text):
        return
    # Behind a comment, the value may stand on a line below.
    empty = {
        node.keys[field].span.end
        for node in document.nodes()
        for field in ("color", "text_color")
        if field in node.keys and node.children[field].data is None
    }
    for comment in comments(document):
        start = comment.span.start
        found = _COLOUR_IN_COMMENT.search(document.source.line(start.line))
        if not found or found.start(2) != start.column - 1:
            continue
        field, colour = found.groups()
        if Position(start.line, found.end(1) + 1) in empty:
            message = f"`{field}` is empty: `{colour}` without quotes is a comment"
            yield Issue("BR203", comment.span, message, f'write `{field}: "{colour}"`')


def validate(data: dict[str, Any], model: type[ModelT]) -> tuple[ModelT | None, list[Issue]]:
    """Validate plain data: the model, or None and every issue, those of single fields first."""
    try:
        return model.model_validate(data), []
    except ValidationError as error:
        details: Sequence[Any] = [d for d in error.errors(include_url=False) if _is_fault(d)]
    issues = _issues([*_joined(details, data)][:MAX_PROBLEMS], model)
    if len(details) > MAX_PROBLEMS:
        return None, issues
    if not any(_issues_of(detail) for detail in details):
        # Single fields are invalid, so the whole was not checked yet: check the rest of it.
        rest = _Rest(data, [route_of(issue) for issue in issues])
        if rest.is_enough:
            try:
                model.model_validate(rest.data)
            except ValidationError as error:
                whole = [d for d in error.errors(include_url=False) if _issues_of(d)]
                found = (issue for issue in _issues(whole, model) if not rest.causes(issue))
                issues += map(rest.in_whole, found)
    return None, issues[:MAX_PROBLEMS]


def _issues(details: Sequence[Any], model: type[BaseModel]) -> list[Issue]:
    from babyrobot_levels.language.messages import complaint

    issues: list[Issue] = []
    misnamed = _misnamed(details, model)
    # `color: rgb(255,0,0)` without quotes: behind the first comma, YAML reads further fields.
    opened = {d["loc"][:-1] for d in details if d["type"] == "color" and "(" in str(d["input"])}
    for detail in details:
        is_empty = detail["type"] == "extra_forbidden" and detail["input"] is None
        if is_empty and detail["loc"][:-1] in opened:
            continue
        if detail["type"] == "missing" and _is_misnamed(detail["loc"], misnamed):
            # It is there, by a name that is reported.
            continue
        if whole := _issues_of(detail):
            issues += whole
            continue
        route = _route(detail["loc"])
        code, message, help_text = complaint(detail, model)
        kind = detail["type"]
        if kind == "missing":
            route = route[:-1]
        subject = _subject(route) if message.startswith("must ") else ""
        is_key = kind == "extra_forbidden" or "[key]" in detail["loc"]
        location = Key(route) if is_key else route
        issues.append(Issue(code, location, f"{subject}{message}", help_text))
    return issues


def _joined(details: Sequence[Any], data: Any) -> Iterator[Any]:
    """Yield the details; of a list of plain values, where it has entries of its own, a single one.

    `blocked: [1, 1]` is one cell, and not two entries that are wrong.
    """
    from babyrobot_levels.language import messages

    plain: dict[Route, bool] = {}
    entries = words_beside(messages.__file__)["entries"]
    faulty = Counter(_route(detail["loc"][:-1]) for detail in details)
    for detail in details:
        around, is_first = _route(detail["loc"][:-1]), False
        is_text = isinstance(detail["input"], str) or not detail["type"].endswith("t_type")
        if is_text and detail["type"] in entries and isinstance(detail["loc"][-1], int):
            whole = data
            for segment in around:
                whole = whole[segment]
            is_first = around not in plain
            if is_first:
                is_plain = not any(isinstance(each, list | dict) for each in whole)
                plain[around] = is_plain and faulty[around] == len(whole)
            if is_first and plain[around]:
                told = {"type": "pair", "ctx": {"what": entries[detail["type"]]}}
                yield {**detail, **told, "loc": around, "input": whole}
        if not plain.get(around):
            yield detail


def _misnamed(details: Sequence[Any], model: type[BaseModel]) -> dict[Any, set[str | None]]:
    """Return what the unknown fields of each mapping may be meant to be, None for anything."""
    from babyrobot_levels.language.messages import fields_around

    found: dict[Any, set[str | None]] = {}
    for detail in details:
        if detail["type"] == "extra_forbidden":
            *around, name = detail["loc"]
            meant = nearest(str(name), fields_around(detail["loc"], model), 1)
            found.setdefault(tuple(around), set()).add(meant[0] if meant else None)
    return found


def _is_misnamed(location: Sequence[str | int], misnamed: dict[Any, set[str | None]]) -> bool:
    """Tell whether a missing field is probably given by another name."""
    *around, name = location
    meant = misnamed.get(tuple(around), set()) if around else set()
    return None in meant or name in meant


def _is_fault(detail: Any) -> bool:
    # Pydantic counts valid entries only, so a list of invalid ones is too short for it.
    least: int = detail["ctx"]["min_length"] if detail["type"] == "too_short" else 0
    return not least or len(detail["input"]) < least


def _issues_of(detail: Any) -> tuple[Issue, ...]:
    error = detail.get("ctx", {}).get("error")
    return error.issues if isinstance(error, InvalidDocument) else ()


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


def route_of(issue: Issue) -> Route:
    """Return the route to the value or the key that an issue points to."""
    location = issue.location
    if isinstance(location, Key):
        return location.route
    return ("map",) if isinstance(location, Span | Mark) else location


class _Rest:
    """Data without its invalid parts: invalid fields, and invalid entries of lists."""

    def __init__(self, data: dict[str, Any], routes: list[Route]):
        faulty = {route[:2] if _is_entry(route, data) else route[:1] for route in routes if route}
        self.is_enough = not any(route[0] in _NEEDED for route in faulty)
        self.without = {route[0] for route in faulty}
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

    def causes(self, issue: Issue) -> bool:
        """Tell whether an issue may only be there because invalid entries were left out."""
        if issue.code in ("BR328", "BR329") and len(route_of(issue)) == 1:
            return route_of(issue)[0] in self.without
        if issue.code in ("BR321", "BR326"):
            return not self.without.isdisjoint(kind.field for kind in NAMED)
        # A drawn door without an entry.
        is_drawn = issue.code == "BR314" and isinstance(issue.location, Mark)
        return is_drawn and "doors" in self.without

    def in_whole(self, issue: Issue) -> Issue:
        """Return the issue with the number that its list entry has in the whole data."""
        if isinstance(issue.location, Span | Mark):
            return issue
        route = route_of(issue)
        field, index = (*route, None, None)[:2]
        if not isinstance(index, int) or str(field) not in self.kept:
            return issue
        route = (str(field), self.kept[str(field)][index], *route[2:])
        location = Key(route) if isinstance(issue.location, Key) else route
        return dataclasses.replace(issue, location=location)


def _is_entry(route: Route, data: dict[str, Any]) -> bool:
    return (
        len(route) > 1 and isinstance(route[1], int) and isinstance(data.get(str(route[0])), list)
    )
