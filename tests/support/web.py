"""The pages of the documentation site as files: what a parser and their links say of them."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urlsplit

from justhtml import JustHTML

from support.places import ROOT

SITE = ROOT / "build" / "site"
"""Where `bash scripts/site.sh` builds it."""

EDITOR = SITE / "editor"
"""The editor in it."""

_SOURCES = ("src", "srcset", "poster", "data")
_REFERENCES = ("aria-controls", "aria-describedby", "aria-labelledby", "aria-owns", "for", "list")
_INTERACTIVE = "a[href], button, input, select, textarea, summary"
_CSS_URL = re.compile(r"""(?:url\(\s*|@import\s+)["']?([^"')\s;]+)""")


def pages() -> list[Path]:
    """Return all pages."""
    return sorted(SITE.rglob("*.html"))


@dataclass(frozen=True)
class WebPage:
    """A page of the site."""

    path: Path

    @cached_property
    def document(self) -> Any:
        """The elements, with what a parser finds wrong."""
        text = self.path.read_text(encoding="utf-8")
        return JustHTML(text, collect_errors=True, sanitize=False, track_node_locations=True)

    def all(self, selector: str) -> list[Any]:
        """Return the elements of a selector."""
        found: list[Any] = self.document.query(selector)
        return found

    @cached_property
    def elements(self) -> list[Any]:
        """All elements."""
        return self.all("*")

    def having(self, attribute: str) -> list[Any]:
        """Return the elements with an attribute; as a selector, each would be asked anew."""
        return [element for element in self.elements if attribute in element.attrs]

    # -- what is wrong ---------------------------------------------------------------------

    def faults(self) -> Iterator[str]:
        """Yield what is wrong with the page."""
        for error in self.document.errors:
            yield f"line {error.line}: {error.message}"
        # A page that only leads to another one.
        if not self.all('meta[http-equiv="refresh"]'):
            yield from self._head()
        yield from self._content()
        yield from self._names()
        for element, name, link in self._links():
            yield from self._link(element, name, link)
        styles = [element.attrs["style"] or "" for element in self.having("style")]
        styles += [element.to_text() for element in self.all("style")]
        for style in styles:
            yield from foreign_in_style(style, self.path)

    def _head(self) -> Iterator[str]:
        if not (self.all("html")[0].attrs.get("lang") or ""):
            yield "the page does not name its language"
        if len(self.all("h1")) != 1:
            yield f"the page has {len(self.all('h1'))} elements `h1`"
        if not any(title.to_text().strip() for title in self.all("head > title")):
            yield "the page has no title"

    def _content(self) -> Iterator[str]:
        for image in self.all("img, area, input[type=image]"):
            # One beside the words of a link need not say them again.
            words = _words_of_link(image) if "alt" in image.attrs else ""
            if not (image.attrs.get("alt") or words).strip():
                yield f"{_told(image)} has no alternative text"
        for outer in self.all("a[href], button, label, summary"):
            inside = outer.query(_INTERACTIVE)
            if inside and (outer.name != "label" or len(inside) > 1):
                yield f"{_told(inside[0])} is inside of {_told(outer)}"
        for heading in self.having("role"):
            if heading.attrs["role"] == "heading" and "aria-level" not in heading.attrs:
                yield f"{_told(heading)} has no level"
        for items, names in (("ul, ol", {"li"}), ("dl", {"dt", "dd", "div"})):
            for element in self.all(items):
                children = [each.name for each in element.children if each.name[0] not in "#!"]
                others = set(children) - names - {"script", "template"}
                if others or (element.name == "dl" and set(children) in ({"dt"}, {"dd"})):
                    yield f"{_told(element)} has the children {', '.join(sorted(set(children)))}"

    def _names(self) -> Iterator[str]:
        ids = Counter(element.attrs["id"] for element in self.having("id"))
        for name, count in ids.items():
            if count > 1 or not name:
                yield f"{count} elements have the id {name!r}"
        for attribute in _REFERENCES:
            for element in self.having(attribute):
                if element.attrs.get("role") == "application":
                    # A script draws what is in it.
                    continue
                for name in (element.attrs[attribute] or "").split():
                    if name not in ids:
                        yield f"{_told(element)}: no element has the id {name!r}"

    def _links(self) -> Iterator[tuple[Any, str, str]]:
        for element in self.having("href"):
            yield element, "href", element.attrs["href"] or ""
        for name in _SOURCES:
            for element in self.having(name):
                if name != "data" or element.name == "object":
                    text = element.attrs[name] or ""
                    parts = text.split(",") if name == "srcset" else [text]
                    for part in parts:
                        yield element, name, part.split()[0] if name == "srcset" else part

    def _link(self, element: Any, name: str, link: str) -> Iterator[str]:
        parts = urlsplit(link)
        if parts.scheme == "data" and element.name != "a":
            return
        if parts.scheme or parts.netloc:
            if name != "href" or element.name != "a":
                yield f"{_told(element)} asks another host: {link}"
            elif parts.scheme not in ("https", "mailto"):
                yield f"{_told(element)} leads to {link}"
            return
        path = self.path
        if parts.path:
            path = (self.path.parent / unquote(parts.path)).resolve()
        if path == EDITOR:
            # It opens the level after the `#`.
            path, parts = path / "index.html", parts._replace(fragment="")
        if not path.is_file():
            yield f"{_told(element)} leads to {link}, which is not there"
        elif parts.fragment and path.suffix == ".html" and element.namespace != "svg":
            fragment = unquote(parts.fragment)
            if fragment != "top" and fragment not in ids_of(path):
                yield f"{_told(element)} leads to {link}, which that page does not have"


def foreign_in_style(style: str, path: Path) -> Iterator[str]:
    """Yield what a style asks of other hosts, and what it asks for and is not there."""
    for link in _CSS_URL.findall(style):
        parts = urlsplit(link)
        if parts.scheme == "data" or link.startswith("#"):
            continue
        if parts.scheme or parts.netloc:
            yield f"a style asks another host: {link}"
        elif not (path.parent / unquote(parts.path)).is_file():
            yield f"a style asks for {link}, which is not there"


@cache
def ids_of(path: Path) -> frozenset[str]:
    """Return the ids of a page, fast."""
    text = path.read_text(encoding="utf-8")
    return frozenset(re.findall(r"""<[^>]*?\sid=["']([^"']+)["']""", text))


def _words_of_link(node: Any) -> str:
    """Return the words of the link that something is in; none if it is in no link."""
    while node is not None and node.name != "a":
        node = node.parent
    return "" if node is None else str(node.to_text())


def _told(element: Any) -> str:
    attributes = "".join(
        f' {name}="{value}"' for name, value in element.attrs.items() if len(value or "") < 80
    )
    return f"line {element.origin_line}: <{element.name}{attributes}>"
