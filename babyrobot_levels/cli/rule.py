"""`babyrobot rule`: what can be found in a level, and why it matters."""

from __future__ import annotations

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
            help="A code or a name; all are listed if it is left out.",
            show_default=False,
        ),
    ] = None,
    report_format: FormatOption = ReportFormat.TEXT,
) -> None:
    """List what can be found in a level, or explain one of it: what, why, an example, the fix.

    Examples:

      babyrobot rule

      babyrobot rule BR503

      babyrobot rule trap
    """
    from babyrobot_levels.lint.pages import all_pages, page_of
    from babyrobot_levels.text.words import did_you_mean

    if code is None:
        rules = all_pages()
    else:
        found = page_of(code)
        if found is None:
            words = [word for each in all_pages() for word in (each.code, each.name)]
            fail(
                f"there is no rule {code!r}{did_you_mean(code, words)}",
                "`babyrobot rule` lists all rules",
            )
        rules = (found,)
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
        write(f"{_bold(f'{rules[0].code} {rules[0].name}')}\n\n{_shown(rules[0].page)}\n")


def _shown(page: str) -> str:
    """Return a page for the terminal: headings in bold, examples indented."""
    lines, inside = [], False
    for line in page.rstrip().split("\n"):
        if line.startswith("```"):
            inside = not inside
        elif inside:
            lines.append(f"    {line}".rstrip())
        else:
            lines.append(_bold(line.removeprefix("## ")) if line.startswith("## ") else line)
    return "\n".join(lines)


def _bold(text: str) -> str:
    return f"\x1b[1m{text}\x1b[0m" if wants_color(sys.stdout) else text
