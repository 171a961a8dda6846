"""The page for assistants that write levels, made from the models, the metrics and the rules."""

import inspect
import json
import os
import re
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from babyrobot_levels.analysis.metrics import Metrics
from babyrobot_levels.language.drawing import BLOCKED, HORIZONTAL
from babyrobot_levels.language.fields import DRAWN, Role, fields_with
from babyrobot_levels.language.json_schema import level_schema
from babyrobot_levels.language.kinds import KINDS, LOOKS
from babyrobot_levels.language.metric_names import STATED
from babyrobot_levels.linter.rules import all_rules
from babyrobot_levels.render.templates import static
from babyrobot_levels.text.files import write_new

_REFERENCE = "## Drawings"
"""The heading at which the language begins, behind the loop of commands."""

_PLAIN = {"string": "text", "boolean": "boolean"}
_NULL = {"type": "null"}


def skill(path: str | os.PathLike[str] | None = None, *, force: bool = False) -> str:
    """Return a page for assistants that write levels, as `babyrobot skill` prints it.

    It is a `SKILL.md`: the loop of commands, the language, the facts for `expect`, and traps.

    Args:
        path: a file to write it to.
        force: whether to replace an existing file.

    Raises:
        FileExistsError: there is a file.
    """
    schema = level_schema()
    made = {
        "example": static("extensions/assistants/example.yaml").rstrip(),
        "marks": _lines(_marks()),
        "drawn": _listed(fields_with(DRAWN)),
        "fields": _lines(_rows(schema["properties"])),
        "looks": _listed(sorted(LOOKS)),
        "shown": _listed(fields_with(Role.LOOK)),
        "entries": _lines(_entries(schema["properties"], schema["$defs"])),
        "skids": _listed(schema["$defs"]["Skid"]["properties"]["to"]["enum"]),
        "metrics": _lines(f"| `{name}` | {_meaning(name)} |" for name in STATED),
        "rules": _lines(
            f"- {rule.code} `{rule.name}`: {rule.summary}"
            for rule in all_rules()
            if rule.code.startswith("BR5") and not rule.name.endswith("-without-effect")
        ),
    }
    template = static("extensions/assistants/skill.md")
    text = re.sub(r"\{\{(\w+)\}\}", lambda found: made[found[1]], template)
    if path is not None:
        write_new(Path(path), text, force=force)
    return text


def language_page() -> str:
    """Return the part of the page that tells the language, from drawings to traps."""
    text = skill()
    return text[text.index(_REFERENCE) :]


def _lines(lines: Iterator[str]) -> str:
    return "\n".join(lines)


def _listed(names: Iterable[str]) -> str:
    *others, last = (f"`{name}`" for name in names)
    return f"{', '.join(others)} and {last}"


def _meaning(metric: str) -> str:
    text = inspect.getdoc(getattr(Metrics, metric)) or ""
    # Behind the semicolon stands when it has no value.
    first, _, _ = " ".join(text.split("\n\n")[0].split()).partition(";")
    return first.rstrip(".")


def _marks() -> Iterator[str]:
    across = {mark: text for text, mark in HORIZONTAL.items()}
    for kind in KINDS:
        for mark, given in kind.marks.items():
            shown = f"`{mark * 3 if mark == BLOCKED else mark}`"
            if kind.where == "side":
                shown = f"`{across[mark]}` and `{mark}`".replace("|", "\\|")
            more = "".join(f", `{name}: {value}`" for name, value in given.items())
            yield f"| {shown} | {kind.one}{more} |"


def _rows(fields: dict[str, Any]) -> Iterator[str]:
    for name, schema in fields.items():
        if name not in fields_with(Role.LOOK):
            row = f"| `{name}` | {_type(schema)} | {_default(schema)} | {schema['description']} |"
            yield row.replace("|  |", "| |")


def _entries(fields: dict[str, Any], definitions: dict[str, Any]) -> Iterator[str]:
    """Yield a line for each field that holds mappings: what these may have, if that is new."""
    told: dict[str, str] = {}
    for name, schema in fields.items():
        model = next(iter(re.findall(r"#/\$defs/(\w+)", str(schema))), "")
        if not model or name in (*fields_with(Role.LOOK, Role.EXPECTATION), "skid"):
            continue
        required = definitions[model].get("required", [])
        parts = []
        for key, each in definitions[model]["properties"].items():
            if key not in LOOKS:
                kind = ", ".join(filter(None, (_type(each), _default(each))))
                mark = "" if key in required else "?"
                text = f"`{key}`{mark} ({kind}): {each['description'].rstrip('.')}"
                parts.append(f"`{key}`{mark}" if told.get(key) == text else text)
                told[key] = text
        yield f"- **{name}**: {'; '.join(parts)}."


def _default(schema: dict[str, Any]) -> str:
    default = schema.get("default", [])
    return "" if default == [] else f"`{json.dumps(default)}`".replace('"', "")


def _type(schema: dict[str, Any]) -> str:
    """Return what a value is, in a few words."""
    for choice in ("anyOf", "oneOf"):
        if choice in schema:
            return " or ".join(_type(each) for each in schema[choice] if each != _NULL)
    if "const" in schema:
        return f"`{schema['const']}`"
    if "enum" in schema:
        return "side" if "N" in schema["enum"] else " or ".join(f"`{x}`" for x in schema["enum"])
    kind = schema.get("type")
    if kind == "array":
        inner = schema["items"]
        if schema.get("maxItems") == 2:
            return "`[x, y]`" if "exclusiveMaximum" in inner else "`[width, height]`"
        return f"list of {_type(inner)}"
    if kind in ("number", "integer"):
        is_share = (schema.get("minimum"), schema.get("maximum")) == (0, 1)
        return "probability" if is_share else str(kind)
    if "pattern" in schema:
        return "name"
    model = schema.get("$ref", "").rpartition("/")[2]
    return {"Skid": "skid", "Rectangle": "`{at, size}`"}.get(model) or _PLAIN.get(
        str(kind), "mapping"
    )
