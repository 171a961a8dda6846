"""What results show of themselves in notebooks."""

from __future__ import annotations

import base64
import re
import xml.etree.ElementTree as ET
from typing import Any

from IPython.core.formatters import DisplayFormatter


def shown(result: Any) -> tuple[str, str]:
    """Return what IPython makes of a result: HTML, and text."""
    bundle, _ = DisplayFormatter().format(result)  # type: ignore[no-untyped-call]
    assert set(bundle) == {"text/html", "text/plain"}
    return bundle["text/html"], bundle["text/plain"]


def svgs(html: str) -> list[str]:
    """Return the SVG pictures in HTML."""
    found = re.findall(r'src="data:image/svg\+xml;base64,([^"]+)"', html)
    return [base64.b64decode(each).decode() for each in found]


def texts(html: str) -> str:
    """Return the text of HTML, in which there must be no script."""
    root = ET.fromstring(f"<body>{re.sub('<img [^>]*>', '', html)}</body>")
    assert not [element for element in root.iter() if element.tag == "script"]
    return " ".join(" ".join(root.itertext()).split())


def last(items: Any) -> Any:
    *_, item = items
    return item


def assert_fits(result: Any) -> None:
    """Check that a result has pictures that fit the width of a cell, and is short as text."""
    html, text = shown(result)
    assert svgs(html)
    for picture in svgs(html):
        ET.fromstring(picture)
    images = re.findall("<img [^>]*>", html)
    assert all("max-width: 100%" in image and re.search(' alt="[^"]+"', image) for image in images)
    assert len(text) < 400
    assert "array(" not in text


def assert_shows_numbers_only(result: Any) -> None:
    """Check that a result whose level is not known shows its numbers."""
    html, _ = shown(result)
    assert svgs(html) == []
    assert len(texts(html)) > 40
