"""Settings of Sphinx for the documentation site; `bash scripts/site.sh` builds it.

The source folder is the root of the repository, so that links between files are the same here and
in the repository.
"""

from __future__ import annotations

import re
import sys
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from docutils.nodes import bullet_list
from sphinx.addnodes import desc_parameter
from sphinx.ext.autodoc.mock import mock
from sphinx.writers.html5 import HTML5Translator

import babyrobot_levels

if TYPE_CHECKING:
    from docutils.nodes import Element
    from sphinx.application import Sphinx

sys.path.insert(0, str(Path(__file__).parent))

project = "babyrobot-levels"
author = "the babyrobot-levels authors"
version = release = babyrobot_levels.__version__
extensions = [
    "myst_nb",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx_copybutton",
    "level_pictures.extension",
]

root_doc = "docs/index"
include_patterns = [
    "*.md",
    "benchmarks/*.md",
    "benchmarks/design/*.md",
    "benchmarks/design-estimators/*.md",
    "docs/**.md",
    "notebooks/*.ipynb",
]

myst_enable_extensions = ["html_image"]
# Headings get the anchors that they have on GitHub.
myst_heading_anchors = 4
# The notebooks are stored with their outputs.
nb_execution_mode = "off"

add_module_names = False
autodoc_default_options = {"members": True, "member-order": "bysource"}
autodoc_typehints_format = "short"
python_maximum_signature_line_length = 80
toc_object_entries_show_parents = "hide"
napoleon_use_ivar = True
# Signatures have the types.
napoleon_attr_annotations = False

templates_path = ["templates"]
html_theme = "furo"
html_title = "babyrobot-levels"
html_static_path = ["style"]
html_css_files = ["site.css"]
html_js_files = ["site.js"]
html_logo = html_favicon = "style/robot.svg"
html_copy_source = False
# For assistants, at the top of the site.
html_extra_path = ["llms.txt", "SKILL.md"]
html_show_copyright = False
html_show_sourcelink = False

pygments_style = "github-light-high-contrast"
pygments_dark_style = "github-dark-high-contrast"
# The prompt and the output of a console are not copied.
copybutton_exclude = ".linenos, .gp, .go"


# `babyrobot_levels.jax` is documented where its libraries are not installed.
with mock(["gymnax", "jax"]):
    vars(import_module("jax"))["jit"] = lambda function, **_options: function
    vars(import_module("jax.tree_util"))["register_dataclass"] = lambda kind: kind
    levels_in_jax = import_module("babyrobot_levels.jax")
    for public_name in levels_in_jax.__all__:
        getattr(levels_in_jax, public_name)


def link_rule(_app: Sphinx, name: str, source: list[str]) -> None:
    """Let the page of a rule lead back to the list of all, which the contents have instead."""
    if name.startswith("docs/rules/") and name != "docs/rules/README":
        source[0] = f"---\norphan: true\n---\n\n[Errors and rules](README.md)\n\n{source[0]}"


class Translator(HTML5Translator):
    """Writes HTML that is valid and can be used by the keyboard where that of Sphinx is not."""

    def starttag(self, *arguments: Any, **attributes: Any) -> str:
        """Begin an element."""
        if attributes.get("ROLE") == "heading":
            attributes["aria-level"] = "2"
        text: str = super().starttag(*arguments, **attributes)
        return text

    def visit_paragraph(self, node: Element) -> None:
        """Begin a paragraph, or what Sphinx makes of an argument that is described by a list."""
        if any(isinstance(child, bullet_list) for child in node.children):
            self.body.append("<div>")
        else:
            super().visit_paragraph(node)

    def depart_paragraph(self, node: Element) -> None:
        """End it."""
        if any(isinstance(child, bullet_list) for child in node.children):
            self.body.append("</div>\n")
        else:
            super().depart_paragraph(node)

    def visit_literal_block(self, node: Element) -> None:
        """Write a block of code, which the keyboard can scroll."""
        begin = len(self.body)
        try:
            super().visit_literal_block(node)
        finally:
            parts = [part.replace("<pre>", '<pre tabindex="0">') for part in self.body[begin:]]
            self.body[begin:] = parts

    def visit_desc_parameterlist(self, node: Element) -> None:
        """Begin the parameters of a function."""
        self.context.append(len(self.body))
        self._visit_sig_parameter_list(node, desc_parameter, "(", ")")

    def depart_desc_parameterlist(self, node: Element) -> None:
        """End them; those on lines of their own are no list of definitions without terms."""
        self._depart_sig_parameter_list(node)
        begin = self.context.pop()
        text = "".join(self.body[begin:])
        for tag, name in (("dl", "parameters"), ("dd", "parameter")):
            text = re.sub(rf"<{tag}\b", f'<div class="{name}"', text).replace(f"</{tag}>", "</div>")
        self.body[begin:] = [text]


def as_restructured_text(
    _app: Sphinx, kind: str, _name: str, _object: object, _options: object, lines: list[str]
) -> None:
    """Turn the inline code of a docstring, `as here`, into code or a link to a public name."""

    def converted(code: re.Match[str]) -> str:
        name = code[1].removeprefix("brl.")
        public = name in babyrobot_levels.__all__
        # Names in lower case without the prefix may be arguments.
        linked = public and (name != code[1] or name[0].isupper())
        written = f":py:obj:`{code[1]} <babyrobot_levels.{name}>`" if linked else f"``{code[1]}``"
        return written + ("\\ " + code[2] if code[2] else "")

    text = "\n".join(lines)
    lines[:] = re.sub(r"(?<!`)`([^`]+)`(?!`)(\w*)", converted, text).split("\n")
    if kind in {"attribute", "property"}:
        # Napoleon takes what precedes a colon in the first line for the type: put a comment there.
        lines[:0] = ["..", ""]


def setup(app: Sphinx) -> None:
    """Register the functions above; Sphinx calls this."""
    app.set_translator("html", Translator)
    app.connect("source-read", link_rule)
    # Before Napoleon, which takes colons in code for its own.
    app.connect("autodoc-process-docstring", as_restructured_text, priority=400)
