"""XML of other programs: no entities, no documents beside it, and bounded depth."""

from xml.etree.ElementTree import Element, TreeBuilder
from xml.parsers import expat

from babyrobot_levels.extensions.formats.conversion import MAX_DEPTH, ConversionError
from babyrobot_levels.text.source import Position, SourceFile


def read_xml(source: SourceFile, places: dict[Element, Position] | None = None) -> Element:
    """Return the root of a text in XML.

    Args:
        source: the text.
        places: filled with the place of each element.

    Raises:
        ConversionError: it is not well-formed, declares entities, or is nested too deep.
    """
    builder, parser, depth = TreeBuilder(), expat.ParserCreate(), 0

    def here() -> Position:
        return Position(parser.CurrentLineNumber, parser.CurrentColumnNumber + 1)

    def refuse(message: str) -> None:
        raise ConversionError.at(source, here(), message)

    def start(name: str, attributes: dict[str, str]) -> None:
        nonlocal depth
        depth += 1
        if depth > MAX_DEPTH:
            refuse(f"nested deeper than {MAX_DEPTH} levels")
        element = builder.start(name, attributes)
        if places is not None:
            places[element] = here()

    def end(name: str) -> None:
        nonlocal depth
        depth -= 1
        builder.end(name)

    parser.StartElementHandler, parser.EndElementHandler = start, end
    parser.CharacterDataHandler = builder.data
    # All of an attack's entities are declared there, and those of no map.
    parser.EntityDeclHandler = lambda *_: refuse("XML that declares entities is not read")
    parser.buffer_text = True
    try:
        # The text is decoded already, whatever it says of its encoding.
        parser.Parse(source.text.encode("utf-8"), True)
        return builder.close()
    except expat.ExpatError as error:
        place = Position(error.lineno, error.offset + 1)
        message = f"invalid XML ({expat.ErrorString(error.code)})"
        raise ConversionError.at(source, place, message) from None
