"""Commands for assistants that write levels: `babyrobot skill`."""

from __future__ import annotations

from babyrobot_levels.cli.console import ForceOption, OutputOption, put


def skill(output: OutputOption = None, force: ForceOption = False) -> None:
    """Print a page for assistants that write levels: the language, the loop of commands, traps.

    It is a SKILL.md, for the folder in which an assistant looks for skills.

    Examples:

      babyrobot skill

      babyrobot skill -o SKILL.md
    """
    from babyrobot_levels.assistants.skill import skill as page

    put(page(), output, force=force)
