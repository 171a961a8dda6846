"""`cli.md`, and what shells complete, made from the commands themselves.

It reads the commands' own signatures, so that the version of typer does not show.
"""

from __future__ import annotations

import inspect
import json
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from enum import Enum
from typing import Any, Literal, get_args, get_origin, get_type_hints

from typer.models import ArgumentInfo, OptionInfo

from babyrobot_levels.cli.commands import COMMANDS, function_of

_HEAD = """\
# The command line

<!-- Generated from the commands: python scripts/renew.py cli.md -->

`babyrobot COMMAND --help` shows the same in the terminal.

Exit status: 0 for success, 1 for findings in a level, 2 for a wrong call, 130 after Ctrl-C. Output
to a pipe or a file has no colour, and `NO_COLOR` is respected.

A LEVEL is a name (see `babyrobot list`), `PACK/NAME`, the path of a file, a share code, or `-` for
standard input.
"""


@dataclass(frozen=True, slots=True)
class _Parameter:
    """An argument or an option of a command."""

    name: str
    info: Any
    kind: Any
    default: Any
    is_list: bool

    @property
    def is_argument(self) -> bool:
        return isinstance(self.info, ArgumentInfo)

    @property
    def label(self) -> str:
        """How it is typed: `LEVEL`, `--format text|json`, `--force`."""
        if self.is_argument:
            name = str(self.info.metavar or self.name.upper())
            return name if self.default is inspect.Parameter.empty else f"[{name}]"
        value = "" if self.kind is bool else f" {self._value}"
        return ", ".join(self.names) + value

    @property
    def names(self) -> list[str]:
        """How the option is called, the shortest first."""
        # typer keeps the first of an annotated option's names where defaults used to be.
        names = [self.info.default, *(self.info.param_decls or ())]
        flags = [name for name in names if isinstance(name, str) and name.startswith("-")]
        return sorted(flags or ["--" + self.name.replace("_", "-")], key=len)

    @property
    def _value(self) -> str:
        if self.info.metavar:
            return str(self.info.metavar).strip("<>" if self.info.parser else "")
        if isinstance(self.kind, type) and issubclass(self.kind, Enum):
            return "|".join(str(choice.value) for choice in self.kind)
        if get_origin(self.kind) is Literal:
            return "|".join(get_args(self.kind))
        return str(self.kind.__name__.upper())

    @property
    def help(self) -> str:
        """What it is for, with its default, and its bounds if it has both."""
        text = " ".join((self.info.help or "").split())
        default = getattr(self.default, "value", self.default)
        known = []
        if default not in (None, inspect.Parameter.empty) and self.kind is not bool:
            known.append(f"default: {default}")
        if self.info.max is not None:
            known.append(f"{self.info.min} to {self.info.max}")
        return f"{text} [{'; '.join(known)}]" if known else text


def reference() -> str:
    """Return the reference of all commands, as Markdown."""
    commands = {name: function_of(name) for name in COMMANDS}
    tables = []
    for group in dict.fromkeys(line.group for line in COMMANDS.values()):
        rows = [f"| {group} | |", "|---|---|"]
        rows += [
            f"| [`{name}`](#{name}) | {_summary(commands[name])} |"
            for name, line in COMMANDS.items()
            if line.group == group
        ]
        tables.append("\n".join(rows) + "\n")
    parts = [_HEAD, *tables]
    return "\n".join(parts + [_command(name, call) for name, call in commands.items()])


KINDS = {
    **{"LEVEL": "level", "A B": "level", "OTHER": "level", "AGENT LEVELS or PLAYS": "levels"},
    **{"SUITE": "suite", "THEME": "theme", "RULE": "rule", "CODE": "rule", "TAG": "tag"},
    **{"A": "algorithm", "FORMAT": "format"},
}
"""What values are, by the words for them in the help."""


def completion() -> str:
    """Return the table of what shells complete, as JSON."""
    import babyrobot_levels as brl
    from babyrobot_levels.extensions.formats.commands import TARGETS
    from babyrobot_levels.extensions.formats.formats import FORMATS
    from babyrobot_levels.language.json_schema import SCHEMAS
    from babyrobot_levels.language.looks import BUILTIN_THEMES
    from babyrobot_levels.library.search_path import gallery_folder
    from babyrobot_levels.linter.rules import all_pages
    from babyrobot_levels.mdp.mazes import ALGORITHMS

    gallery = [brl.load(path) for path in sorted(gallery_folder().glob("**/*.yaml"))
               if "kind: suite" not in path.read_text("utf-8")]  # fmt: skip
    table = {
        "commands": {name: dict(_completed(name, function_of(name))) for name in COMMANDS},
        "options": ["--help", "--version", "--install-completion", "--show-completion"],
        "words": {
            "algorithm": [*ALGORITHMS],
            "format": [*FORMATS.own],
            "target": TARGETS,
            "rule": [word for each in all_pages() for word in (each.code, each.name)],
            "schema": [*SCHEMAS],
            "tag": sorted({tag for level in gallery for tag in level.tags}),
            "theme": [*BUILTIN_THEMES],
        },
    }  # fmt: skip
    return json.dumps(table, indent=1) + "\n"


def _completed(command: str, function: Callable[..., Any]) -> Iterator[tuple[str, Any]]:
    """Yield the arguments and options of a command, each with what it takes."""
    for parameter in _parameters(function):
        takes: Any = KINDS.get(str(parameter.info.metavar or "").strip("[]"), "")
        if isinstance(parameter.kind, type) and issubclass(parameter.kind, Enum):
            takes = [str(choice.value) for choice in parameter.kind]
        elif parameter.info.parser and "|" in (parameter.info.metavar or ""):
            takes = str(parameter.info.metavar)[1:-1].split("|")
        elif takes == "format" and command == "export":
            takes = "target"
        if not takes and get_origin(parameter.kind) is Literal:
            takes = [*get_args(parameter.kind)]
        if parameter.is_argument:
            own = {"uninstall": "pack", "schema": "schema"}.get(command, takes)
            has_several = parameter.is_list and parameter.info.metavar == "LEVEL"
            yield "", "levels" if own == "level" and has_several else own
        else:
            for name in parameter.names:
                yield name, None if parameter.kind is bool else takes


def _summary(command: Callable[..., Any]) -> str:
    return " ".join((inspect.getdoc(command) or "").split("\n\n")[0].split())


def _command(name: str, command: Callable[..., Any]) -> str:
    parameters = sorted(_parameters(command), key=lambda parameter: not parameter.is_argument)
    arguments = [parameter.label for parameter in parameters if parameter.is_argument]
    text, _, examples = (inspect.getdoc(command) or "").partition("Examples:")
    lines = [f"## {name}", "", "```", " ".join(["babyrobot", name, "[OPTIONS]", *arguments]), "```"]
    for paragraph in text.strip().split("\n\n"):
        # What is indented, a piece of a file, stays so.
        lines += ["", "    " * paragraph.startswith("  ") + " ".join(paragraph.split())]
    lines += ["", "| | |", "|---|---|"]
    lines += [f"| `{_cell(p.label)}` | {_cell(p.help)} |" for p in parameters]
    shown = [line.strip() for line in examples.splitlines() if line.strip()]
    lines += ["", "```sh", *shown, "```", ""]
    return "\n".join(lines)


def _parameters(command: Callable[..., Any]) -> Iterator[_Parameter]:
    hints = get_type_hints(command, include_extras=True)
    for name, parameter in inspect.signature(command).parameters.items():
        kind, info = get_args(hints[name])[:2]
        if isinstance(info, OptionInfo | ArgumentInfo) and not info.hidden:
            inner = () if get_origin(kind) is Literal else get_args(kind)
            kinds = [each for each in inner if each is not type(None)] or [kind]
            is_optional = get_origin(kinds[0]) is list
            innermost = get_args(kinds[0])[0] if is_optional else kinds[0]
            is_list = is_optional or get_origin(kind) is list
            yield _Parameter(name, info, innermost, parameter.default, is_list)


def _cell(text: str) -> str:
    return text.replace("|", "\\|")
