"""`babyrobot rule`: list the rules and error codes, or explain one."""

from __future__ import annotations

import re
import sys
from typing import Annotated

import typer

from babyrobot_levels.cli.console import (
    FormatOption,
    ReportFormat,
    fail,
    wants_color,
    write,
    write_json,
)


def rule(
    code: Annotated[
        str | None,
        typer.Argument(
            metavar="[CODE]",
            help="A code or a name. Without it, all are listed.",
            show_default=False,
        ),
    ] = None,
    report_format: FormatOption = ReportFormat.TEXT,
) -> None:
    """List all rules and error codes, or explain one: what it checks, why, and an example.

    Examples:

      babyrobot rule

      babyrobot rule BR503

      babyrobot rule inescapable-state
    """
    from babyrobot_levels.linter.rules import UnknownRuleError
    from babyrobot_levels.linter.rules import rule as rule_of

    try:
        rules = rule_of() if code is None else (rule_of(code),)
    except UnknownRuleError as error:
        fail(str(error), "`babyrobot rule` lists all rules")
    if report_format is ReportFormat.JSON:
        write_json(
            [
                {
                    "code": each.code,
                    "name": each.name,
                    "severity": str(each.severity),
                    "summary": each.summary,
                    "page": each.page,
                }
                for each in rules
            ]
        )
    elif code is None:
        width = max(len(each.name) for each in rules)
        for each in rules:
            write(f"{_bold(each.code)}  {each.name.ljust(width)}  {each.summary}\n")
    else:
        (only,) = rules
        write(f"{_bold(f'{only.code} {only.name}')}\n\n{_shown(only.page)}\n")


def _shown(page: str) -> str:
    """Return a page for the terminal, with bold headings, indented examples and no links."""
    lines, inside = [], False
    for line in page.rstrip().split("\n"):
        if line.startswith("```"):
            inside = not inside
        elif inside:
            lines.append(f"    {line}".rstrip())
        else:
            text = re.sub(r"\[([^\]]*)\]\([^)]*\.md\)", r"\1", line)
            lines.append(_bold(text.removeprefix("## ")) if line.startswith("## ") else text)
    return "\n".join(lines)


def _bold(text: str) -> str:
    return f"\x1b[1m{text}\x1b[0m" if wants_color(sys.stdout) else text
