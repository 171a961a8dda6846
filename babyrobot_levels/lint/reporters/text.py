"""Diagnostics for people: each with its place, the source line, a caret and help."""

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


def render(diagnostics: Iterable[Diagnostic], *, color: bool = False) -> str:
    """Return the findings as text, with a blank line between two, or an empty text."""
    shown = [_colored(d) if color else str(d) for d in diagnostics]
    return "\n\n".join(shown) + "\n" if shown else ""


def summary(diagnostics: Sequence[Diagnostic], files: int, praise: str = "valid") -> str:
    """Return the line at the end of a report: how much was wrong, and in how many files.

    `praise` is what is said of files in which nothing was found.
    """
    if not diagnostics:
        return f"{files} files checked, all {praise}" if files != 1 else f"1 file checked, {praise}"
    counts = [
        (sum(d.severity is severity for d in diagnostics), str(severity)) for severity in Severity
    ]
    told = ", ".join(f"{n} {what}{'s' if n > 1 else ''}" for n, what in counts if n)
    faulty = len({d.file for d in diagnostics})
    return f"{told} in 1 file" if files == 1 else f"{told} in {faulty} of {files} files"


def _colored(diagnostic: Diagnostic) -> str:
    color = _COLORS[diagnostic.severity]
    head = (
        f"{_BOLD}{one_line(diagnostic.location)}{_RESET}: "
        f"{color}{diagnostic.severity} {diagnostic.code}{_RESET}: "
        f"{_BOLD}{one_line(diagnostic.message)}{_RESET}"
    )
    _, *rest = str(diagnostic).split("\n")
    lines = [head]
    for line in rest:
        mark = line.lstrip()
        word, colon, told = mark.partition(": ")
        if colon and word in ("help", "fix"):
            lines.append(f"  {_CYAN}{word}{_RESET}: {told}")
        else:
            gutter, bar, text = line.partition("|")
            is_caret = text.strip() and not text.strip("^ ")
            shown = f"{color}{text}{_RESET}" if is_caret else text
            lines.append(f"{_CYAN}{gutter}{bar}{_RESET}{shown}")
    return "\n".join(lines)
