"""Findings as text: each with its position, the source line, a caret and help."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from babyrobot_levels.text.diagnostics import Diagnostic, Severity, one_line

_RESET = "\x1b[0m"
_BOLD = "\x1b[1m"
_COLORS = {
    Severity.ERROR: "\x1b[1;31m",
    Severity.WARNING: "\x1b[1;33m",
    Severity.INFO: "\x1b[1;36m",
}
_CYAN = "\x1b[36m"


def render(
    diagnostics: Iterable[Diagnostic], *, color: bool = False, width: int | None = None
) -> str:
    """Return the findings as text, separated by blank lines; empty if there are none.

    Args:
        diagnostics: the findings.
        color: whether to use ANSI escapes.
        width: the columns of a terminal, to which source lines are cut.
    """
    shown = [_colored(d, width) if color else d.shown(width) for d in diagnostics]
    return "\n\n".join(shown) + "\n" if shown else ""


def summary(diagnostics: Sequence[Diagnostic], files: int, clean: str = "valid") -> str:
    """Return the last line of a report: the number of findings and files.

    `clean` is the word for files without findings.
    """
    if not diagnostics:
        return f"{files} files checked, all {clean}" if files != 1 else f"1 file checked, {clean}"
    counts = [
        (sum(d.severity is severity for d in diagnostics), str(severity)) for severity in Severity
    ]
    listed = ", ".join(f"{n} {what}{'s' if n > 1 else ''}" for n, what in counts if n)
    affected = len({d.file for d in diagnostics})
    return f"{listed} in 1 file" if files == 1 else f"{listed} in {affected} of {files} files"


def _colored(diagnostic: Diagnostic, width: int | None) -> str:
    color = _COLORS[diagnostic.severity]
    head = (
        f"{_BOLD}{one_line(diagnostic.location)}{_RESET}: "
        f"{color}{diagnostic.severity} {diagnostic.code}{_RESET}: "
        f"{_BOLD}{one_line(diagnostic.message)}{_RESET}"
    )
    _, *rest = diagnostic.shown(width).split("\n")
    lines = [head]
    for line in rest:
        mark = line.lstrip()
        word, colon, content = mark.partition(": ")
        if colon and word in ("help", "fix"):
            lines.append(f"  {_CYAN}{word}{_RESET}: {content}")
        else:
            gutter, bar, text = line.partition("|")
            is_caret = text.strip() and not text.strip("^ ")
            shown = f"{color}{text}{_RESET}" if is_caret else text
            lines.append(f"{_CYAN}{gutter}{bar}{_RESET}{shown}")
    return "\n".join(lines)
