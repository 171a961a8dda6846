"""Diagnostics as output: one format a file."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from babyrobot_levels.text.diagnostics import Diagnostic

MachineFormat = Literal["json", "github", "sarif", "junit"]
"""The formats for programs. The one for people is in `text`: it knows colour, and a summary."""


def render(
    form: MachineFormat,
    diagnostics: Iterable[Diagnostic],
    files: Iterable[str],
    titles: Mapping[str, str],
) -> str:
    """Return the findings in a format for programs.

    Args:
        form: which one.
        diagnostics: the findings.
        files: the files that were checked, as the findings name them.
        titles: what each code means, in a few words; codes that are not there go without.
    """
    # Each brings imports of its own, and a command needs one of them.
    if form == "json":
        from babyrobot_levels.lint.reporters import json

        return json.render(diagnostics)
    if form == "github":
        from babyrobot_levels.lint.reporters import github

        return github.render(diagnostics, titles)
    if form == "sarif":
        from babyrobot_levels.lint.reporters import sarif

        return sarif.render(diagnostics, titles)
    from babyrobot_levels.lint.reporters import junit

    return junit.render(diagnostics, files)
