"""Rules about the notation of a level file and the contrast of its colours."""

from collections.abc import Iterator
from itertools import product

from babyrobot_levels.language.cells import Opening, Rectangle
from babyrobot_levels.language.kinds import LISTED, THINGS, Kind
from babyrobot_levels.language.looks import BUILTIN_THEMES
from babyrobot_levels.language.plain_data import plain
from babyrobot_levels.linter.context import LintContext
from babyrobot_levels.linter.finding import Finding, Needs
from babyrobot_levels.linter.fixes import merge, remove, replace
from babyrobot_levels.linter.rule import rule
from babyrobot_levels.text.diagnostics import Fix, Key, Route, Severity
from babyrobot_levels.text.emitter import WIDTH
from babyrobot_levels.text.source import Position, Span

MIN_CONTRAST = 3.0
"""The minimum contrast of graphical objects in the Web Content Accessibility Guidelines."""

_SIDES = [kind for kind in LISTED if kind.where == "side" and kind not in THINGS]
_RECTANGLES = [kind for kind in LISTED if kind.where == "rectangle"]

Box = tuple[int, int, int, int]
"""Left, top, right, bottom; the last two exclusive."""


@rule("BR603", Severity.INFO, needs=Needs.LEVEL)
def long_line(context: LintContext) -> Iterator[Finding]:
    """Line with more than 88 characters.

    ## What it does

    Checks for long lines that contain a list or a mapping in brackets, which can be split over
    several lines. A comment at the end of the line does not count.

    ## Why is this bad?

    Editors and code reviews cut off or wrap such lines, and a change of one value shows up as a
    change of the whole line.

    ## Example

    ```yaml
    version: 1
    puddles: [{at: [1, 0], size: small}, {at: [2, 0], size: large}, {at: [0, 1]}, {at: [1, 1]}]
    ```

    Use instead:

    ```yaml
    version: 1
    puddles:
      - {at: [1, 0], size: small}
      - {at: [2, 0], size: large}
      - {at: [0, 1]}
      - {at: [1, 1]}
    ```

    ## How to fix it

    `babyrobot format` splits such lines.
    """
    for number, line in enumerate(context.source.lines, 1):
        if len(line) <= WIDTH or not ("{" in line or "[" in line):
            continue
        comments = (each for each in context.comments if each.span.start.line == number)
        ends = (comment.span.start.column - 1 for comment in comments)
        if (width := len(line[: next(ends, len(line))].rstrip())) > WIDTH:
            yield Finding(
                Span(Position(number, WIDTH + 1), Position(number, width + 1)),
                f"line too long ({width} > {WIDTH} characters)",
                "`babyrobot format` splits it over several lines",
            )


@rule("BR604", Severity.INFO, needs=Needs.LEVEL)
def field_order(context: LintContext) -> Iterator[Finding]:
    """Fields that are not in the usual order.

    ## What it does

    Checks for fields that are not in the order of the reference: first the level's name and its
    author, then its size or drawing, start and exit, then walls, cells, dynamics and rewards, and
    finally its appearance.

    ## Why is this bad?

    Readers of many levels look for a field in its usual place, and two files are easier to compare
    if both follow the same order.

    ## Example

    ```yaml
    exit: [2, 0]
    size: [3, 1]
    version: 1
    ```

    Use instead:

    ```yaml
    version: 1
    size: [3, 1]
    exit: [2, 0]
    ```

    ## How to fix it

    `babyrobot format` sorts fields and moves their comments with them.
    """
    order = [*type(context.level).model_fields]
    last = next(iter(context.data))
    for name in context.data:
        if order.index(name) < order.index(last):
            yield Finding(
                Key((name,)),
                f"`{name}` should come before `{last}`",
                "`babyrobot format` sorts fields",
            )
            return
        last = name


@rule("BR605", Severity.INFO, needs=Needs.LEVEL)
def mergeable_walls(context: LintContext) -> Iterator[Finding]:
    """Adjacent walls or openings that could be one entry with a `length`.

    ## What it does

    Checks for consecutive entries of `walls` or `openings` that continue each other and differ only
    in their position.

    ## Why is this bad?

    Several entries hide that they are one wall. With a `length`, the wall can be moved, coloured or
    removed in one place.

    ## Example

    ```yaml
    version: 1
    walls:
      - {at: [0, 0], side: S}
      - {at: [1, 0], side: S}
    ```

    Use instead:

    ```yaml
    version: 1
    walls:
      - {at: [0, 0], side: S, length: 2}
    ```

    ## Fix safety

    The fix sets the length of the first entry and removes the others. It is safe: the walls stay
    the same.
    """
    for field in (kind.field for kind in _SIDES):
        if field not in context.data:
            continue
        entries: list[Opening] = [entry for _, entry in context.level.written(field)]
        first = 0
        while first < len(entries):
            last = first
            while last + 1 < len(entries) and _continues(entries[last], entries[last + 1]):
                last += 1
            if last > first:
                count, what = last - first + 1, field.removesuffix("s")
                length = sum(entry.length for entry in entries[first : last + 1])
                merged = {**context.data[field][first], "length": length}
                yield Finding(
                    (field, first),
                    f"these {count} {field} can be merged into one {what} of length {length}",
                    f"write one {what} with `length: {length}`",
                    fix=merge(context.document, field, first, count, merged),
                )
            first = last + 1


def _continues(entry: Opening, following: Opening) -> bool:
    x, y = entry.at
    end = (x + entry.length, y) if entry.side in ("N", "S") else (x, y + entry.length)
    return following.at == end and _other_fields(entry) == _other_fields(following)


def _other_fields(entry: Opening | Rectangle) -> dict[str, object]:
    return entry.model_dump(exclude={"at", "length", "size"})


@rule("BR606", Severity.INFO, needs=Needs.LEVEL)
def mergeable_cells(context: LintContext) -> Iterator[Finding]:
    """Adjacent cells that could be one entry with a `size`.

    ## What it does

    Checks for consecutive entries of `blocked` or `areas` that fill a rectangle and differ only in
    their position.

    ## Why is this bad?

    A list of cells hides their shape, which `size` makes explicit.

    ## Example

    ```yaml
    version: 1
    size: [4, 4]
    blocked:
      - {at: [1, 1]}
      - {at: [2, 1]}
    ```

    Use instead:

    ```yaml
    version: 1
    size: [4, 4]
    blocked:
      - {at: [1, 1], size: [2, 1]}
    ```

    ## Fix safety

    The fix sets the size of the first entry and removes the others. It is safe: the cells stay the
    same. Areas with a label are not fixed, because each of them shows its label.
    """
    for field in (kind.field for kind in _RECTANGLES):
        if field not in context.data:
            continue
        entries: list[Rectangle] = [entry for _, entry in context.level.written(field)]
        first = 0
        while first < len(entries):
            last, box = _longest_run(entries, first)
            if last > first:
                width, height = box[2] - box[0], box[3] - box[1]
                merged = {
                    **context.data[field][first],
                    "at": [box[0], box[1]],
                    "size": [width, height],
                }
                yield Finding(
                    (field, first),
                    f"these {last - first + 1} entries can be merged into one rectangle of "
                    f"{width}x{height} cells",
                    f"write one entry with `size: [{width}, {height}]`",
                    fix=None
                    if "label" in merged
                    else merge(context.document, field, first, last - first + 1, merged),
                )
            first = last + 1


def _longest_run(entries: list[Rectangle], first: int) -> tuple[int, Box]:
    """Return the last of the most entries from `first` on that fill a rectangle, and its box."""
    last, whole = first, _box(entries[first])
    box, covered = whole, _area(whole)
    rest = _other_fields(entries[first])
    for number in range(first + 1, len(entries)):
        other = _box(entries[number])
        if _other_fields(entries[number]) != rest:
            break
        box = (*map(min, box[:2], other[:2]), *map(max, box[2:], other[2:]))  # type: ignore[assignment]
        covered += _area(other)
        if covered > _area(box):
            break
        if covered == _area(box) and _are_disjoint(entries[first : number + 1]):
            last, whole = number, box
    return last, whole


def _box(entry: Rectangle) -> Box:
    (x, y), (width, height) = entry.at, entry.size
    return x, y, x + width, y + height


def _area(box: Box) -> int:
    return (box[2] - box[0]) * (box[3] - box[1])


def _are_disjoint(entries: list[Rectangle]) -> bool:
    """Return whether no two entries share a cell, so that equal areas mean equal cells."""
    seen: set[tuple[int, int]] = set()
    for left, top, right, bottom in map(_box, entries):
        for cell in product(range(left, right), range(top, bottom)):
            if cell in seen:
                return False
            seen.add(cell)
    return True


@rule("BR607", Severity.INFO, needs=Needs.LEVEL)
def low_contrast(context: LintContext) -> Iterator[Finding]:
    """Colour with too little contrast to the ground.

    ## What it does

    Checks for colours of start, exit, robot, walls and puddles whose contrast to the ground is less
    than 3 to 1, the minimum for graphical objects in the Web Content Accessibility Guidelines (WCAG
    2.2, 1.4.11). Only colours that the level's own theme sets are checked, not the built-in themes.

    ## Why is this bad?

    On a projector, in print, or for people with low vision or a colour vision deficiency, the
    object is hard to see. Pictures outline such walls and puddles in black or white instead; a
    start, an exit and the robot stay as they are.

    ## Example

    ```yaml
    version: 1
    theme:
      colors: {base: "#ffffff", walls: "#dddddd", start: "#b00000", exit: "#006000",
               puddle: "#0000c0", robot: "#555555"}
    ```

    Use instead:

    ```yaml
    version: 1
    theme:
      colors: {base: "#ffffff", walls: "#333333", start: "#b00000", exit: "#006000",
               puddle: "#0000c0", robot: "#555555"}
    ```
    """
    if isinstance(context.level.theme, str) and context.level.theme in BUILTIN_THEMES:
        return
    from babyrobot_levels.render.colors import contrast

    colors = context.level.resolved_theme.colors
    given = colors.model_fields_set
    for name in ("start", "exit", "robot", "walls", "puddle"):
        if not given & {name, "base"}:
            continue
        if (ratio := contrast(getattr(colors, name), colors.base)) < MIN_CONTRAST:
            yield Finding(
                ("theme", "colors", name if name in given else "base"),
                f"contrast of `{name}` ({getattr(colors, name)}) to `base` ({colors.base}) is "
                f"{ratio:.1f} to 1, less than {MIN_CONTRAST:g} to 1",
                "use a lighter or darker colour",
            )


@rule("BR608", Severity.INFO, needs=Needs.LEVEL)
def side_spelling(context: LintContext) -> Iterator[Finding]:
    """Side that is not written as `N`, `E`, `S` or `W`.

    ## What it does

    Checks for sides of walls and openings with a long name or in lower case.

    ## Why is this bad?

    A search for `side: N` does not find `side: north`.

    ## Example

    ```yaml
    version: 1
    walls:
      - {at: [1, 1], side: north}
    ```

    Use instead:

    ```yaml
    version: 1
    walls:
      - {at: [1, 1], side: N}
    ```

    ## Fix safety

    The fix writes the letter. It is safe: the wall stays the same.
    """
    for field in (kind.field for kind in _SIDES):
        for number, entry in enumerate(context.data.get(field) or []):
            side = entry["side"]
            if side != (letter := side[:1].upper()):
                route = (field, number, "side")
                yield Finding(
                    route,
                    f"side `{side}` should be written as `{letter}`",
                    fix=Fix(f"write `{letter}`", (replace(context.document, route, letter),)),
                )


@rule("BR609", Severity.INFO, needs=Needs.LEVEL)
def empty_field(context: LintContext) -> Iterator[Finding]:
    """Field whose value is empty.

    ## What it does

    Checks for fields of the level that are an empty list, an empty mapping, or `null`.

    ## Why is this bad?

    The field has no effect. Often it is left over from something that was removed, or that was
    never added.

    ## Example

    ```yaml
    version: 1
    walls: []
    ```

    Use instead:

    ```yaml
    version: 1
    ```

    ## Fix safety

    The fix removes the field. It is safe: the level stays the same.
    """
    for name, value in context.data.items():
        if value is None or value == [] or value == {}:
            shown = {"[]": "an empty list", "{}": "an empty mapping"}.get(str(value), "null")
            yield Finding(
                Key((name,)),
                f"`{name}` is {shown} and has no effect",
                fix=Fix(f"remove `{name}`", (remove(context.document, (name,)),)),
            )


def _defaults(kind: Kind) -> dict[str, object]:
    """Return the fields of an entry that have a default, with it."""
    assert kind.model is not None
    return {
        info.alias or name: plain(info.default)
        for name, info in kind.model.model_fields.items()
        if not info.is_required() and info.default is not None
    }


_DEFAULTS: dict[str, dict[str, object]] = {
    "maze": {"loops": 0},
    **{kind.field: _defaults(kind) for kind in (*_SIDES, *_RECTANGLES)},
}


@rule("BR610", Severity.INFO, needs=Needs.LEVEL)
def redundant_default(context: LintContext) -> Iterator[Finding]:
    """Property of an entry that is set to its default.

    ## What it does

    Checks for `length: 1`, `pass: 0` and `fit: false` of walls and openings, `size: [1, 1]` of
    areas and blocked cells, and `loops: 0` of a maze.

    ## Why is this bad?

    Redundant properties hide the entries that differ from the others.

    ## Example

    ```yaml
    version: 1
    walls:
      - {at: [1, 1], side: N, length: 1}
    ```

    Use instead:

    ```yaml
    version: 1
    walls:
      - {at: [1, 1], side: N}
    ```

    ## Fix safety

    The fix removes the property. It is safe: the level stays the same.
    """
    for route, entry in _entries(context):
        for name, default in _DEFAULTS[str(route[0])].items():
            if name in entry and entry[name] == default:
                place = (*route, name)
                yield Finding(
                    place,
                    f"`{name}: {str(entry[name]).lower()}` is the default",
                    fix=Fix(f"remove `{name}`", (remove(context.document, place),)),
                )


def _entries(context: LintContext) -> Iterator[tuple[Route, dict[str, object]]]:
    for field in _DEFAULTS:
        value = context.data.get(field)
        if isinstance(value, dict):
            yield (field,), value
        for number, entry in enumerate(value if isinstance(value, list) else []):
            yield (field, number), entry
