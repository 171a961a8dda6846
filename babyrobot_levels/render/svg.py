"""The SVG painter: a self-contained document, the same for the same scene."""

import re
from collections.abc import Iterator
from xml.sax.saxutils import escape
from zlib import crc32

from babyrobot_levels.render.colors import rgba
from babyrobot_levels.render.scene.shapes import Commands, Ellipse, Path, Rect, Scene, Shape, Text

FONT = "Helvetica, Arial, 'Liberation Sans', sans-serif"
NOT_XML = re.compile("[^\t\n\r\u0020-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""Characters that XML documents cannot contain, not even escaped."""

_LONG = 1000
"""The number of commands from which on a path is written as steps."""


def to_svg(scene: Scene, scale: float | None = 1.0) -> str:
    """Return the scene as an SVG document; numbers have at most two decimals.

    Args:
        scene: the scene.
        scale: the size at which it is shown; 1 is the scene's own size. None for a picture that is
            as wide as the place where it is shown.
    """
    shown = f'viewBox="0 0 {number(scene.width)} {number(scene.height)}"'
    if scale is not None:
        width, height = number(scale * scene.width), number(scale * scene.height)
        shown = f'width="{width}" height="{height}" {shown}'
    return element(scene, f'xmlns="http://www.w3.org/2000/svg" {shown}') + "\n"


def element(scene: Scene, attributes: str) -> str:
    """Return the scene as an `<svg>` with these attributes, labelled by title and description."""
    # A document may contain several pictures: only those with the same texts have the same ids.
    number = crc32(f"{scene.title}\n{scene.description}".encode("utf-8", "replace"))
    texts = {"title": scene.title, "desc": scene.description}
    labels = {f"{kind}-{number:08x}": (kind, text) for kind, text in texts.items() if text}
    role = 'role="img"' + (f' aria-labelledby="{" ".join(labels)}"' if labels else "")
    lines = [
        f'<svg {attributes} {role} font-family="{FONT}" stroke-linejoin="round">',
        *(f'<{kind} id="{id_}">{escaped(text)}</{kind}>' for id_, (kind, text) in labels.items()),
        *map(_element, scene.shapes),
        "</svg>",
    ]
    return "\n".join(lines)


def number(value: float) -> str:
    """Return a number with at most two decimals, and no more characters than it needs."""
    text = f"{value:.2f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def path_data(commands: Commands) -> str:
    """Return a path in SVG notation; one of many straight lines is written as steps."""
    if len(commands) > _LONG and not any(letter == "C" for letter, _ in commands):
        return "".join(_steps(commands))
    return "".join(letter + " ".join(map(number, numbers)) for letter, numbers in commands)


def _steps(commands: Commands) -> Iterator[str]:
    """Yield straight lines, each point from the one before, which takes fewer characters."""
    # Sums of what is written, so that nothing adds up.
    x = y = first_x = first_y = 0
    for letter, numbers in commands:
        if letter == "Z":
            x, y = first_x, first_y
            yield "z"
            continue
        at_x, at_y = (round(100 * place) for place in numbers)
        step = f"{number((at_x - x) / 100)} {number((at_y - y) / 100)}"
        yield letter.lower() + step.replace(" -", "-")
        x, y = at_x, at_y
        if letter == "M":
            first_x, first_y = x, y


def _element(shape: Shape) -> str:
    name, content = type(shape).__name__.lower(), ""
    if isinstance(shape, Text):
        content = escaped(shape.text)
    attributes = " ".join(f'{key}="{value}"' for key, value in _attributes(shape))
    return f"<{name} {attributes}>{content}</{name}>" if content else f"<{name} {attributes}/>"


def _attributes(shape: Shape) -> Iterator[tuple[str, str]]:
    """Yield names and values: numbers, letters and colours, of which none needs to be escaped."""
    match shape:
        case Rect():
            yield "x", number(shape.x)
            yield "y", number(shape.y)
            yield "width", number(shape.width)
            yield "height", number(shape.height)
            if shape.radius:
                yield "rx", number(shape.radius)
        case Ellipse():
            yield "cx", number(shape.x)
            yield "cy", number(shape.y)
            yield "rx", number(shape.rx)
            yield "ry", number(shape.ry)
        case Path():
            yield "d", path_data(shape.commands)
        case Text():
            yield "x", number(shape.x)
            yield "y", number(shape.y)
            yield "font-size", number(shape.size)
            if shape.bold:
                yield "font-weight", "bold"
            if shape.anchor != "start":
                yield "text-anchor", shape.anchor
    yield from _paint("fill", shape.fill)
    if isinstance(shape, Path) and shape.stroke is not None:
        yield from _paint("stroke", shape.stroke)
        yield "stroke-width", number(shape.width)
        if shape.cap != "butt":
            yield "stroke-linecap", shape.cap
        if shape.dash is not None:
            yield "stroke-dasharray", " ".join(map(number, shape.dash))
    if shape.opacity != 1:
        yield "opacity", number(shape.opacity)


def _paint(what: str, color: str | None) -> Iterator[tuple[str, str]]:
    """Yield a colour; one with alpha as two attributes, which every viewer supports."""
    if color is None:
        yield what, "none"
    elif color.isalpha() and color != "transparent":
        yield what, color
    else:
        red, green, blue, alpha = rgba(color)
        yield what, f"#{red:02x}{green:02x}{blue:02x}"
        if alpha < 1:
            yield f"{what}-opacity", number(alpha)


def escaped(text: str) -> str:
    """Return a text escaped for XML; characters that XML cannot contain are replaced."""
    return escape(NOT_XML.sub("\ufffd", text))


def quoted(text: str) -> str:
    """Return a text escaped for an attribute in double quotes."""
    return escaped(text).replace('"', "&quot;")
