"""Scripts and style sheets that are put together from modules."""

from __future__ import annotations

import re
from importlib.resources import files
from posixpath import dirname, join, normpath

import pytest

from babyrobot_levels.extensions.editor.state import served_script, widget_script
from babyrobot_levels.extensions.publish.wall import ASSETS
from babyrobot_levels.render.templates import put_together, static

ENTRIES = [
    ("extensions/editor", "editor.css"),
    ("extensions/editor", "playground.js"),
    ("extensions/editor", "served.js"),
    ("extensions/editor", "service.js"),
    ("extensions/editor", "site.js"),
    ("extensions/editor", "widget.js"),
    ("extensions/editor", "worker.js"),
    ("extensions/publish", "desk.js"),
    ("extensions/publish", "desk_worker.js"),
    ("extensions/publish", "level.css"),
    ("extensions/publish", "played_level.js"),
    ("extensions/publish", "scorm.js"),
    ("extensions/publish", "site.css"),
    ("extensions/publish", "wall.css"),
    ("extensions/publish", "wall.js"),
    ("render", "page.css"),
    ("render", "page.js"),
    # In place of others in pages that do without them.
    ("render", "clear.js"),
    ("render", "one.js"),
    ("render", "optimum.js"),
    ("render", "single.js"),
]
"""What pages name."""

FILES = sorted(
    f"{room}/static/{file.name}"
    for room in ("render", "extensions/editor", "extensions/publish")
    for file in files("babyrobot_levels").joinpath(room, "static").iterdir()
)


def together(**modules: str) -> str:
    given = {f"{name}.js": text for name, text in modules.items()}
    return put_together("page.js", given)


def test_modules_come_once_and_after_those_that_they_import() -> None:
    page = (
        'import { left } from "./left.js";\nimport { right } from "./right.js";\n\nleft(right);\n'
    )
    left = 'import { shared } from "./shared.js";\n\nexport function left() {}\nshared.push(1);\n'
    right = 'import {\n  shared,\n} from "./shared.js";\n\nexport const right = shared;\n'
    shared = "export const shared = [];\n"
    expected = [
        "const shared=[];",
        "function left(){}shared.push(1);",
        "const right=shared;",
        "left(right);",
    ]
    found = together(page=page, left=left, right=right, shared=shared)
    assert found == "\n".join(expected)


def test_what_is_only_for_readers_goes() -> None:
    page = """// What it is.

/**
 * Do something.
 */
function act(one) {
  const field = /** @type {HTMLInputElement} */ (one);
  // Why.
  return field.value; // https://example.org, as `act` has it
}
"""
    expected = "function act(one){const field=(one);return field.value}"
    assert together(page=page) == expected


def test_texts_keep_their_spaces() -> None:
    page = """const told = { name: "a = b; // c", more: `c = ${d + 1}` };
const [both] = [one ? "x , y" : two - -three];
const found = text.match(/ = /);
"""
    sheet = '.a > b:has(c d) { content: "a: b 0.5"; opacity: 0.5; }\n'
    assert together(page=page) == (
        'const told={name:"a = b; // c",more:`c = ${d + 1}`},'
        '[both]=[one?"x , y":two - -three],'
        "found = text.match(/ = /);"
    )
    tight = '.a > b:has(c d){content:"a: b 0.5";opacity:.5}'
    assert put_together("page.css", {"page.css": sheet}) == tight


def test_the_last_of_several_lines_needs_no_comma_and_no_break() -> None:
    page = "act(\n  1,\n  [\n    2, // two,\n  ],\n);\n"
    assert together(page=page) == "act(1,[2]);"


def test_style_sheets_import_others() -> None:
    sheets = {"a/page.css": '/* Page. */\n@import "../b/part.css";\n\np { color: red }\n'}
    sheets["b/part.css"] = "b { color: blue }\n"
    assert put_together("a/page.css", sheets) == "b{color:blue}\np{color:red}"


@pytest.mark.parametrize(
    ("modules", "message"),
    [
        (
            {
                "page": 'import { a } from "./a.js";',
                "a": 'import { b } from "./b.js";\nexport const a = b;',
                "b": 'import { a } from "./a.js";\nexport const b = a;',
            },
            "in a circle: a.js -> b.js -> a.js",
        ),
        (
            {"page": 'import { a, c } from "./a.js";', "a": "export const a = 1;\nconst c = 2;"},
            "page.js: a.js does not export c",
        ),
        (
            {
                "page": 'import { a } from "./a.js";\nasync function both() {}',
                "a": "export const a = 1;\nconst [one, both] = [1, 2];",
            },
            "a.js and page.js both have the name both",
        ),
        (
            {"page": 'import * as all from "./a.js";', "a": ""},
            "page.js: this form is not understood",
        ),
        ({"page": 'export { a } from "./a.js";', "a": ""}, "page.js: this form is not understood"),
        ({"page": "const a = 1;\nexport { a };"}, "page.js: this form is not understood: export"),
    ],
)
def test_what_cannot_be_put_together_is_told(modules: dict[str, str], message: str) -> None:
    with pytest.raises(ValueError, match=re.escape(message)):
        together(**modules)


@pytest.mark.slow
def test_no_script_has_what_belongs_to_modules() -> None:
    scripts = {"widget": widget_script(), "editor": served_script()}
    scripts |= {name: make() for name, make in ASSETS.items() if name.endswith(".js")}
    for name, script in scripts.items():
        lines = re.findall(r"(?:^|[;}])((?:import|export)\b [^;]*;)", script, re.M)
        assert lines == (["export default{render};"] if name == "widget" else [])


def test_every_module_and_sheet_is_in_a_page() -> None:
    used = {f"{room}/static/{entry}" for room, entry in ENTRIES}
    new = list(used)
    while new:
        path = new.pop()
        for name in re.findall(r'^(?:import\b|@import\b|\}).*"(.*)";$', static(path), re.M):
            other = normpath(join(dirname(path), name))
            # The editor's site has Python for browsers there.
            if other not in used and not name.startswith("./python/"):
                used.add(other)
                new.append(other)
    # Python puts this sheet before that of the icons.
    used.add("extensions/publish/static/icons.css")
    assert sorted(used) == [path for path in FILES if path.endswith((".js", ".css"))]


@pytest.mark.parametrize("path", [path for path in FILES if path.endswith(".js")])
def test_shortening_changes_no_text_of_several_lines(path: str) -> None:
    """Blank lines of texts would be lost, and indents, and what looks like a comment."""
    is_in_text = False
    for line in static(path).splitlines():
        assert not is_in_text or (line and line == line.strip() and not line.startswith("//"))
        is_in_text ^= line.replace('"`"', "").count("`") % 2 == 1
