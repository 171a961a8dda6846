"""The page of every code: of the rules, and of the errors that keep a level from loading."""

from __future__ import annotations

from functools import cache
from importlib.resources import files

from babyrobot_levels.lint.registry import all_rules
from babyrobot_levels.lint.rule import Needs, Rule
from babyrobot_levels.text.diagnostics import Severity


@cache
def all_pages() -> tuple[Rule, ...]:
    """Return everything that can be found, errors and rules, in the order of the codes."""
    return (*_faults(), *all_rules())


def page_of(word: str) -> Rule | None:
    """Return what a code or a name means, None where there is no such thing."""
    return next((rule for rule in all_pages() if rule.is_called(word)), None)


def titles() -> dict[str, str]:
    """Return for each code, in a sentence, what it means."""
    return {rule.code: rule.summary for rule in all_pages()}


def as_markdown(rule: Rule) -> str:
    """Return a page as it stands in the documentation."""
    kind = {
        Severity.ERROR: "An error: the level does not load.",
        Severity.WARNING: "A rule of play.",
        Severity.INFO: "A rule of style.",
    }[rule.severity]
    if rule.code.startswith("BR7"):
        kind = "An error: there is no pack."
    return f"# {rule.code}: {rule.name}\n\n{rule.page.rstrip()}\n\n---\n\n{kind}\n"


def index() -> str:
    """Return the page that lists all others, Markdown."""
    parts = [
        "# What can be found in a level\n\n"
        "`babyrobot validate` finds errors, `babyrobot lint` also finds what the rules describe. "
        "`babyrobot rule CODE` shows a page in the terminal.\n"
    ]
    for title, severity in (
        ("Errors", Severity.ERROR),
        ("Rules of play", Severity.WARNING),
        ("Rules of style", Severity.INFO),
    ):
        parts.append(f"\n## {title}\n\n| code | name | what it finds |\n|---|---|---|\n")
        parts += [
            f"| [{rule.code}]({rule.name}.md) | `{rule.name}` | {rule.summary} |\n"
            for rule in all_pages()
            if rule.severity is severity
        ]
    return "".join(parts)


def _faults() -> list[Rule]:
    found = []
    for file in files("babyrobot_levels.lint").joinpath("faults").iterdir():
        name, _, page = file.read_text("utf-8").partition("\n")
        page = page.strip()
        summary = page.partition("\n")[0]
        code = file.name.removesuffix(".md")
        found.append(Rule(code, name, summary, page, Severity.ERROR, Needs.LEVEL, None))
    return sorted(found, key=lambda rule: rule.code)
