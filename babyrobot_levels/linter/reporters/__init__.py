"""Findings in machine-readable formats. `text` is the format for people."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from babyrobot_levels.text.diagnostics import Diagnostic

MachineFormat = Literal["json", "github", "sarif", "junit"]
"""The machine-readable formats."""

JSON_VERSION = 1
"""The version of the JSON format; it changes with every incompatible change."""


def render(
    form: MachineFormat,
    diagnostics: Iterable[Diagnostic],
    files: Iterable[str],
    titles: Mapping[str, str],
    version: str,
) -> str:
    """Return findings in a machine-readable format.

    Args:
        form: the format.
        diagnostics: the findings.
        files: the files that were checked, named as in the findings.
        titles: a short description of each code; codes without one are allowed.
        version: the version of this package.
    """
    # Each format has imports of its own, and a command needs only one of them.
    if form == "json":
        return render_json(diagnostics)
    if form == "github":
        from babyrobot_levels.linter.reporters import github

        return github.render(diagnostics, titles)
    if form == "sarif":
        from babyrobot_levels.linter.reporters import sarif

        return sarif.render(diagnostics, titles, version)
    from babyrobot_levels.linter.reporters import junit

    return junit.render(diagnostics, files)


def render_json(diagnostics: Iterable[Diagnostic]) -> str:
    """Return `{"version": 1, "diagnostics": [...]}`, indented."""
    import json

    data = {"version": JSON_VERSION, "diagnostics": [d.to_dict() for d in diagnostics]}
    return json.dumps(data, indent=2) + "\n"
