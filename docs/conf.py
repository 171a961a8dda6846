"""Settings of Sphinx for the documentation site; `bash scripts/site.sh` builds it.

The source folder is the root of the repository, so that links between files are the same here and
in the repository.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import babyrobot_levels

if TYPE_CHECKING:
    from sphinx.application import Sphinx

project = "babyrobot-levels"
author = "the babyrobot-levels authors"
version = release = babyrobot_levels.__version__
extensions = [
    "myst_nb",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx_copybutton",
]

root_doc = "docs/index"
include_patterns = ["*.md", "benchmarks/*.md", "docs/**.md", "notebooks/*.ipynb"]

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

html_theme = "furo"
html_title = "babyrobot-levels"
html_static_path = ["style"]
html_css_files = ["site.css"]
html_copy_source = False
html_show_copyright = False
html_show_sourcelink = False

pygments_style = "friendly"
pygments_dark_style = "github-dark"
# The prompt and the output of a console are not copied.
copybutton_exclude = ".linenos, .gp, .go"


def list_rules(_app: Sphinx, name: str, source: list[str]) -> None:
    """Add the pages of the rules to the table of contents, which their list does not need."""
    if name == "docs/rules/README":
        source[0] += "\n```{toctree}\n:hidden:\n:glob:\n\n*\n```\n"


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
    app.connect("source-read", list_rules)
    # Before Napoleon, which takes colons in code for its own.
    app.connect("autodoc-process-docstring", as_restructured_text, priority=400)
