"""`cli.md`, made from the commands themselves.

It reads the commands' own signatures, so that the version of typer does not show.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from enum import Enum
from typing import Any, Literal, get_args, get_origin, get_type_hints

from typer.models import ArgumentInfo, OptionInfo

from babyrobot_levels.cli.commands import COMMANDS

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

    @property
    def is_argument(self) -> bool:
        return isinstance(self.info, ArgumentInfo)

    @property
    def label(self) -> str:
        """How it is typed: `LEVEL`, `--format text|json`, `--force`."""
        if self.is_argument:
            name = str(self.info.metavar or self.name.upper())
            return name if self.default is inspect.Parameter.empty else f"[{name}]"
        # typer keeps the first of an annotated option's names where defaults used to be.
        names = [self.info.default, *(self.info.param_decls or ())]
        flags = [name for name in names if isinstance(name, str) and name.startswith("-")]
        flags = sorted(flags or ["--" + self.name.replace("_", "-")], key=len)
        value = "" if self.kind is bool else f" {self._value}"
        return ", ".join(flags) + value

    @property
    def _value(self) -> str:
        if self.info.metavar:
            return str(self.info.metavar)
        if isinstance(self.kind, type) and issubclass(self.kind, Enum):
            return "|".join(str(choice.value) for choice in self.kind)
        if get_origin(self.kind) is Literal:
            return "|".join(get_args(self.kind))
        return str(self.kind.__name__.upper())

    @property
    def help(self) -> str:
        """What it is for, with its default."""
        text = " ".join((self.info.help or "").split())
        default = getattr(self.default, "value", self.default)
        if default in (None, inspect.Parameter.empty) or self.kind is bool:
            return text
        return f"{text} [default: {default}]"


def reference() -> str:
    """Return the reference of all commands, as Markdown."""
    commands = {name: line.function() for name, line in COMMANDS.items()}
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
            kinds = [inner for inner in get_args(kind) if inner is not type(None)] or [kind]
            is_list = get_origin(kinds[0]) is list
            innermost = get_args(kinds[0])[0] if is_list else kinds[0]
            yield _Parameter(name, info, innermost, parameter.default)


def _cell(text: str) -> str:
    return text.replace("|", "\\|")
