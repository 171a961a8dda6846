"""All rules and error codes: selection, lookup, and their pages."""

import importlib
import pkgutil
import re
from collections.abc import Callable, Sequence
from functools import cache, lru_cache, partial
from importlib import resources
from typing import overload

from babyrobot_levels.linter.rule import REGISTERED, Rule
from babyrobot_levels.registry.entries import OWN_CODES, Entries
from babyrobot_levels.text.diagnostics import Severity
from babyrobot_levels.text.errors import BabyRobotError
from babyrobot_levels.text.words import did_you_mean

_NAME = re.compile(r"[a-z0-9-]+")

_CODE = re.compile(r"(BR\d)(\d\d?|[xX*]{1,2})", re.IGNORECASE)
"""What is written as a code: the beginning of a series, and its rest or what stands for any."""

_ADDED: Entries[Callable[..., object]] = Entries("rules", {})
"""The functions of the rules of extensions, by code."""


class UnknownRuleError(BabyRobotError, ValueError):
    """A rule that does not exist was selected or ignored."""

    __module__ = "babyrobot_levels"


@cache
def all_rules() -> tuple[Rule, ...]:
    """Return all rules, sorted by code."""
    for module in pkgutil.iter_modules(__path__):
        importlib.import_module(f"{__name__}.{module.name}")
    own = (rule for rule in REGISTERED.values() if rule.code.startswith(OWN_CODES))
    return tuple(sorted(own, key=lambda rule: rule.code))


def added_rules() -> tuple[Rule, ...]:
    """Return the rules of extensions, sorted by code."""
    return tuple(REGISTERED[code] for code in sorted(dict(_ADDED.added())) if code in REGISTERED)


@cache
def all_pages() -> tuple[Rule, ...]:
    """Return all errors and rules, sorted by code."""
    return (*_errors(), *all_rules())


def find(word: str) -> Rule | None:
    """Return the rule or error with a code or a name; None if there is none."""
    for rules in (all_pages, added_rules):
        if found := next((rule for rule in rules() if rule.is_called(word)), None):
            return found
    return None


@overload
def rule(code: str) -> Rule: ...
@overload
def rule(code: None = None) -> tuple[Rule, ...]: ...
def rule(code: str | None = None) -> Rule | tuple[Rule, ...]:
    """Return a rule or an error code with its page, or all of them, as `babyrobot rule` does.

    Args:
        code: a code (`"BR503"`) or a name (`"inescapable-state"`); None for all.

    Raises:
        UnknownRuleError: there is none.
    """
    if code is None:
        return all_pages()
    found = find(code)
    if found is None:
        raise UnknownRuleError(f"unknown rule {code!r}{_meant(code, all_pages())}")
    return found


def select(select: Sequence[str] | None, ignore: Sequence[str] = ()) -> tuple[Rule, ...]:
    """Return the rules that are selected and not ignored.

    Args:
        select: codes, prefixes of codes (`BR5`), names, or `ALL`; None selects the default rules.
        ignore: the same for rules to leave out. The longer prefix takes precedence, so that
            `BR503` can be selected while `BR5` is ignored.

    Raises:
        UnknownRuleError: one of them matches no rule.
    """
    return _selected(None if select is None else tuple(select), tuple(ignore))


@lru_cache(maxsize=64)
def _selected(select: tuple[str, ...] | None, ignore: tuple[str, ...]) -> tuple[Rule, ...]:
    words, rules = [*(select or ()), *ignore], all_rules()
    if "ALL" in map(str.upper, words) or not all(map(partial(_is_known, rules=rules), words)):
        rules += added_rules()
    for word in words:
        if not _is_known(word, rules):
            raise UnknownRuleError(f"unknown rule `{word}`{_meant(word, rules, prefixes=True)}")
    return tuple(
        rule
        for rule in rules
        if _selection(rule, select) > max((_match(word, rule) for word in ignore), default=0)
    )


def _meant(word: str, rules: Sequence[Rule], *, prefixes: bool = False) -> str:
    """Return what an unknown code or name may stand for.

    Codes are told by their neighbours, and not by how they look.

    Args:
        word: the code or the name.
        rules: the rules that there are.
        prefixes: whether the beginning of codes stands for all of them.
    """
    if not (code := _CODE.fullmatch(word)):
        return did_you_mean(word, [each for rule in rules for each in (rule.code, rule.name)])
    series = code[1].upper()
    known = [rule.code for rule in rules if rule.code.startswith(series)]
    if not known:
        return f"; codes are {rules[0].code} to {rules[-1].code}"
    told = f"; there are {known[0]} to {known[-1]}"
    return f"{told}, all of them by `{series}`" if prefixes else told


def _is_known(word: str, rules: Sequence[Rule]) -> bool:
    return any(_match(word, rule) for rule in rules)


def _selection(rule: Rule, select: Sequence[str] | None) -> int:
    """Return how specifically a rule is selected, 0 if it is not."""
    if select is None:
        return int(rule.default)
    return max((_match(word, rule) for word in select), default=0)


def _match(word: str, rule: Rule) -> int:
    """Return how specifically a word matches a rule, 0 if it does not."""
    if word.upper() == "ALL":
        return 1
    if word.lower() == rule.name:
        return len(rule.code) + 1
    is_prefix = len(word) >= 2 and rule.code.startswith(word.upper())
    return len(word) if is_prefix else 0


def titles() -> dict[str, str]:
    """Return the summary of each code."""
    return {rule.code: rule.summary for rule in all_pages()}


def documents() -> dict[str, str]:
    """Return the pages of all codes, by the names of their files in `docs/rules`."""
    return {"README.md": index(), **{f"{rule.name}.md": as_markdown(rule) for rule in all_pages()}}


def as_markdown(rule: Rule) -> str:
    """Return a page of the documentation."""
    kind = {"BR5": "Rule of play", "BR6": "Rule of style"}.get(rule.code[:3])
    if kind is not None:
        kind += f", severity `{rule.severity.value}`."
    else:
        is_of_pack = rule.code.startswith("BR7")
        kind = f"Error: {'no pack is written' if is_of_pack else 'the level does not load'}."
    if not rule.default:
        kind += " Off by default."
    return f"# {rule.name} ({rule.code})\n\n{kind}\n\n{rule.page.rstrip()}\n"


def index() -> str:
    """Return the page that lists all others, Markdown."""
    parts = [
        "# Errors and rules\n\n"
        "`babyrobot validate` reports errors; `babyrobot lint` also reports what the rules find. "
        "`babyrobot rule CODE` shows a page in the terminal. See also [linting](../linting.md).\n"
    ]
    for title, codes in (
        ("Errors", ("BR1", "BR2", "BR3", "BR4", "BR7")),
        ("Rules of play", "BR5"),
        ("Rules of style", "BR6"),
    ):
        parts.append(f"\n## {title}\n\n| Code | Name | Description |\n|---|---|---|\n")
        parts += [
            f"| [{rule.code}]({rule.name}.md) | `{rule.name}` | {rule.summary} |\n"
            for rule in all_pages()
            if rule.code.startswith(codes)
        ]
    return "".join(parts)


def _errors() -> list[Rule]:
    """Read the pages of the errors: a line with the name, the summary, and the page."""
    found = []
    for file in resources.files("babyrobot_levels.linter").joinpath("errors").iterdir():
        first, _, rest = file.read_text("utf-8").partition("\n")
        summary, _, page = rest.strip().partition("\n")
        if not _NAME.fullmatch(first):
            raise ValueError(f"{file.name}: the first line must be a name")
        code = file.name.removesuffix(".md")
        found.append(Rule(code, first, summary, page.strip() + "\n", Severity.ERROR))
    return sorted(found, key=lambda rule: rule.code)
