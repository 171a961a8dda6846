"""What a scalar without quotes means: YAML 1.2's core schema."""

import re
from typing import Any

_INT = re.compile(r"[-+]?[0-9]+|0o[0-7]+|0x[0-9a-fA-F]+")
_FLOAT = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?")
_SPECIAL_FLOAT = re.compile(r"([-+]?)\.(inf|Inf|INF)|\.(nan|NaN|NAN)")
_WORDS: dict[str, bool | None] = {
    **dict.fromkeys(("", "~", "null", "Null", "NULL"), None),
    **dict.fromkeys(("true", "True", "TRUE"), True),
    **dict.fromkeys(("false", "False", "FALSE"), False),
}


def is_plain_string(text: str) -> bool:
    """Tell whether YAML reads `text`, written without quotes, as a text."""
    return isinstance(resolve(text), str)


def is_integer(text: str) -> bool:
    """Tell whether YAML reads `text`, written without quotes, as an integer."""
    return _INT.fullmatch(text) is not None


def resolve(text: str) -> Any:
    """Return what a scalar without quotes means: None, a boolean, a number, or the text itself.

    Raises:
        ValueError: an integer has more digits than Python converts.
    """
    if text in _WORDS:
        return _WORDS[text]
    if text[0] not in "+-.0123456789":
        return text
    if text.isascii() and text.isdigit():
        return int(text)
    if is_integer(text):
        prefix = text[:2]
        return int(text, 8 if prefix == "0o" else 16 if prefix == "0x" else 10)
    if _FLOAT.fullmatch(text):
        return float(text)
    if special := _SPECIAL_FLOAT.fullmatch(text):
        return float("nan") if special[3] else float(special[1] + "inf")
    return text
