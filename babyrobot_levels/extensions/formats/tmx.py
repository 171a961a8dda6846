"""Maps of Tiled in its own XML (`.tmx`, `.tsx`), as the data that its JSON holds."""

import re
from collections.abc import Callable, Sequence
from functools import cache
from itertools import pairwise
from typing import Any
from xml.etree.ElementTree import Element

from babyrobot_levels.extensions.formats.conversion import ConversionError, shown
from babyrobot_levels.extensions.formats.places import Route
from babyrobot_levels.extensions.formats.xml import read_xml
from babyrobot_levels.text.source import Position, SourceFile

_NUMBER = re.compile(r"-?[0-9]{1,15}(\.[0-9]{1,15})?")
_LAYERS = {
    "layer": "tilelayer",
    "objectgroup": "objectgroup",
    "imagelayer": "imagelayer",
    "group": "group",
}
_LISTS = {"objects": "object", "tilesets": "tileset", "properties": "properties/property"}
_TEXTS = ("name", "class", "type", "source", "orientation", "encoding", "compression", "template")


def data_of(source: SourceFile, root: str) -> dict[str, Any]:
    """Return a map, a tileset or a template in XML as Tiled writes it in JSON.

    Args:
        source: the text.
        root: its outermost element: `map`, `tileset` or `template`.

    Raises:
        ConversionError: it is malformed, or another element.
    """
    element = read_xml(source)
    if element.tag != root:
        raise ConversionError(f"{shown(source.name)} is not a {root} of Tiled")
    return {"map": _map, "tileset": _tileset, "template": _template}[root](element)


def places_of(source: SourceFile) -> Callable[[Route], Position]:
    """Return what finds the element of a value of the data of a map."""
    places: dict[Element, Position] = {}
    root, children = read_xml(source, places), cache(_children)

    def place(route: Route) -> Position:
        element = root
        for key, index in pairwise(route):
            if isinstance(index, int):
                element = children(element, key)[index]
        return places[element]

    return place


def _children(element: Element, key: str | int) -> Sequence[Element]:
    """Return the elements that become the entries of a list."""
    if key == "layers":
        return [each for each in element if each.tag in _LAYERS]
    return element.findall(_LISTS[str(key)])


def _map(element: Element) -> dict[str, Any]:
    found = _attributes(element)
    return found | {
        "infinite": found.get("infinite") == 1,
        "layers": _layers(element),
        "tilesets": [_tileset(each) for each in _children(element, "tilesets")],
    }


def _attributes(element: Element) -> dict[str, Any]:
    """Return the attributes, numbers as such, and the properties of an element."""
    found: dict[str, Any] = {
        name: text if name in _TEXTS else _value(text) for name, text in element.attrib.items()
    }
    if "visible" in found:
        found["visible"] = found["visible"] != 0
    if properties := _children(element, "properties"):
        found["properties"] = [_property(each) for each in properties]
    return found


def _value(text: str) -> Any:
    """Return a number where a text is one with few digits, else the text."""
    if _NUMBER.fullmatch(text) is None:
        return text
    return float(text) if "." in text else int(text)


def _property(element: Element) -> dict[str, Any]:
    text, kind = element.get("value", element.text or ""), element.get("type", "string")
    value = text == "true" if kind == "bool" else text
    return {
        "name": element.get("name"),
        "value": _value(text) if kind in ("int", "float") else value,
    }


def _tileset(element: Element) -> dict[str, Any]:
    return _attributes(element) | {
        "tiles": [_attributes(each) for each in element.iterfind("tile")]
    }


def _template(element: Element) -> dict[str, Any]:
    found = element.find("object")
    return {} if found is None else {"object": _object(found)}


def _layers(element: Element) -> list[dict[str, Any]]:
    return [_layer(each) for each in _children(element, "layers")]


def _layer(element: Element) -> dict[str, Any]:
    found = _attributes(element) | {"type": _LAYERS[element.tag]}
    data = element.find("data")
    if element.tag == "group":
        found["layers"] = _layers(element)
    elif element.tag == "objectgroup":
        found["objects"] = [_object(each) for each in _children(element, "objects")]
    elif data is not None:
        encoding = data.get("encoding")
        found["compression"] = data.get("compression", "")
        found["chunks"] = [
            _attributes(each) | {"data": _numbers(each, encoding)} for each in data.findall("chunk")
        ]
        found["data"] = _numbers(data, encoding)
    return found


def _numbers(element: Element, encoding: str | None) -> Any:
    """Return the tiles of a layer: packed as a text, or numbers."""
    text = (element.text or "").strip()
    if encoding == "base64":
        return text
    if encoding == "csv":
        return [_value(each.strip()) for each in text.split(",")] if text else []
    return [_value(each.get("gid", "0")) for each in element.iterfind("tile")]


def _object(element: Element) -> dict[str, Any]:
    found = _attributes(element)
    if (line := element.find("polyline")) is not None:
        points = (each.partition(",") for each in line.get("points", "").split())
        found["polyline"] = [{"x": _value(x), "y": _value(y)} for x, _, y in points]
    return found
