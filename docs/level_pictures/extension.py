"""The Sphinx extension: it puts pictures beside the YAML of the pages."""

from __future__ import annotations

import re
from dataclasses import replace
from hashlib import sha256
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import quote

from docutils import nodes
from sphinx.util.docutils import SphinxDirective
from sphinx.util.logging import getLogger
from sphinx.util.osutil import relative_uri

from babyrobot_levels.library.catalogue import load
from babyrobot_levels.linter.rules import find
from babyrobot_levels.render.scene.build import build_scene
from babyrobot_levels.render.scene.shapes import Scene
from babyrobot_levels.render.svg import to_svg
from level_pictures.examples import Example, example_of, level_text

if TYPE_CHECKING:
    from sphinx.application import Sphinx
    from sphinx.writers.html5 import HTML5Translator

_LOGGER = getLogger(__name__)

_FOLDER = "_images/levels"
_SCALE = 0.75
_WIDE = 480
"""Wider pictures, in pixels, are shown below the code."""

_COMMENT = re.compile(r"<!-- (.*?) -->")


class LevelPicture(nodes.General, nodes.Element):
    """A picture, as a file of its own: `svg`, `alt`, `width` and `height` in pixels."""


def picture(scene: Scene, scale: float = _SCALE) -> LevelPicture:
    """Return the node of a picture."""
    return LevelPicture(
        svg=to_svg(scene),
        alt=scene.description,
        width=round(scale * scene.width),
        height=round(scale * scene.height),
    )


def add_pictures(app: Sphinx, page: nodes.document) -> None:
    """Put the picture of each level beside it; Sphinx calls this for each page."""
    name = app.env.docname
    rule = find(Path(name).name) if name.startswith("docs/rules/") else None
    blocks = [each for each in page.findall(nodes.literal_block) if each.get("language") == "yaml"]
    for number, block in enumerate(blocks):
        marks = _marks(block, -1)
        if "no picture" in marks:
            continue
        # The first example of a rule's page is what the rule finds.
        code = rule.code if rule is not None and number == 0 else ""
        example = example_of(block.astext() + "\n", marks, code)
        if example.is_broken:
            _LOGGER.warning("the example is no level, and no mark says so", location=block)
        # The page itself shows what is reported: below, or where it runs a command.
        is_told = "report" in _marks(block, 1) or any(mark.startswith("file: ") for mark in marks)
        _show(block, example, with_messages=not is_told)
        if block.parent is not page and "level" in block.parent.get("classes", ()):
            _offer(block.parent, level_text(f"{block.astext().rstrip()}\n", marks), name)


def _marks(block: nodes.Element, step: int) -> frozenset[str]:
    """Return what the comments next to a block say: those before it (-1) or after it (1)."""
    place = block.parent.index(block) + step
    found: set[str] = set()
    while 0 <= place < len(block.parent) and isinstance(block.parent[place], nodes.raw):
        found.update(_COMMENT.findall(block.parent[place].astext()))
        place += step
    return frozenset(found)


def _show(block: nodes.literal_block, example: Example, *, with_messages: bool) -> None:
    """Replace a block by one with its picture and its messages."""
    if example.scene is None and not example.messages:
        return
    if example.lines:
        block["highlight_args"] = {"hl_lines": [*example.lines]}
    whole = nodes.container(classes=["level"])
    block.replace_self(whole)
    whole += block
    if example.scene is not None:
        if _SCALE * example.scene.width > _WIDE:
            whole["classes"].append("wide")
        whole += picture(example.scene)
    if example.messages and with_messages:
        messages = nodes.literal_block(example.messages, example.messages, language="text")
        whole += nodes.container("", messages, classes=["messages"])


def _offer(whole: nodes.Element, text: str, page: str) -> None:
    """Offer to change a level in its place, and in the editor, which `scripts/site.sh` makes.

    Both need a web server: `site.js` shows them where there is one.
    """
    address = f"{relative_uri(page, 'editor/')}#{quote(text)}"
    whole += _html(
        f'<p class="tries" data-text="{escape(text)}" hidden><button type="button">Change</button> '
        f'<a href="{address}">Open in the editor</a></p>'
    )


class GalleryDirective(SphinxDirective):
    """A wide link to the gallery, with pictures of the levels that are named, a line each.

    The gallery is no page of Sphinx: `scripts/site.sh` makes it.
    """

    required_arguments = 1
    final_argument_whitespace = True
    has_content = True

    def run(self) -> list[nodes.Node]:
        """Return the link."""
        address = relative_uri(self.env.docname, "gallery/index.html")
        words = f'<a class="gallery" href="{address}"><span>{escape(self.arguments[0])}</span>'
        tiles = []
        for name in self.content:
            scene = build_scene(load(name), cells_only=True)
            # All tiles are one link, whose name is to be short.
            tiles.append(picture(replace(scene, description=scene.title)))
        return [*_html(words), *tiles, *_html("</a>")]


def _html(text: str) -> list[nodes.Node]:
    return [nodes.raw("", text, format="html")]


class GameDirective(SphinxDirective):
    """A level of the gallery to be played: its page, in a frame."""

    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        """Write the page, and return the frame."""
        level = load(self.arguments[0])
        name = f"{_FOLDER}/{level.name}.html"
        file = Path(self.env.app.outdir, *name.split("/"))
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(level.to_html(), encoding="utf-8")
        address = relative_uri(self.env.docname, name)
        title = escape(f"{level.title}, to be played")
        return _html(f'<iframe class="game" src="{address}" title="{title}"></iframe>')


def visit_picture(writer: HTML5Translator, node: LevelPicture) -> None:
    """Write the file of a picture, once, and the element that shows it."""
    name = sha256(node["svg"].encode()).hexdigest()[:12] + ".svg"
    file = Path(writer.builder.outdir, *_FOLDER.split("/"), name)
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(node["svg"], encoding="utf-8")
    page = writer.builder.get_target_uri(writer.builder.current_docname)
    attributes = {
        "class": " ".join(["level-picture", *node["classes"]]),
        "src": relative_uri(page, f"{_FOLDER}/{name}"),
        **{key: node[key] for key in ("alt", "width", "height")},
        "loading": "lazy",
    }
    written = " ".join(f'{key}="{escape(str(value))}"' for key, value in attributes.items())
    writer.body.append(f"<img {written}>")
    raise nodes.SkipNode


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the above; Sphinx calls this."""
    app.add_node(LevelPicture, html=(visit_picture, None))
    app.add_directive("game", GameDirective)
    app.add_directive("gallery", GalleryDirective)
    app.connect("doctree-read", add_pictures)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
