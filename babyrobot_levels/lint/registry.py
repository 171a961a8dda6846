"""The rules there are: one module of `rules/` each."""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Sequence
from functools import cache, lru_cache
from inspect import cleandoc
from types import ModuleType

from babyrobot_levels.lint import rules as rules_package
from babyrobot_levels.lint.rule import Rule
from babyrobot_levels.text.words import did_you_mean


class UnknownRuleError(ValueError):
    """Somebody asks for a rule that there is not."""


@cache
def all_rules() -> tuple[Rule, ...]:
    """Return all rules, in the order of their codes."""
    modules = (
        importlib.import_module(f"{rules_package.__name__}.{module.name}")
        for module in pkgutil.iter_modules(rules_package.__path__)
    )
    return tuple(sorted(map(rule_of, modules), key=lambda rule: rule.code))


def select(select: Sequence[str] | None, ignore: Sequence[str] = ()) -> tuple[Rule, ...]:
    """Return the rules that are selected and not ignored.

    Args:
        select: codes, beginnings of codes (`BR5`), names, or `ALL`; None selects those that are
            on by themselves.
        ignore: the same for rules that are not wanted. A longer beginning wins over a shorter
            one, so that `BR503` can be selected where `BR5` is ignored.

    Raises:
        UnknownRuleError: no rule is meant by one of them.
    """
    return _selected(None if select is None else tuple(select), tuple(ignore))


@lru_cache(maxsize=64)
def _selected(select: tuple[str, ...] | None, ignore: tuple[str, ...]) -> tuple[Rule, ...]:
    for word in [*(select or ()), *ignore]:
        if not any(_meant(word, rule) for rule in all_rules()):
            known = [each for rule in all_rules() for each in (rule.code, rule.name)]
            raise UnknownRuleError(f"there is no rule `{word}`{did_you_mean(word, known)}")
    return tuple(
        rule
        for rule in all_rules()
        if _wanted(rule, select) > max((_meant(word, rule) for word in ignore), default=0)
    )


def find(word: str) -> Rule | None:
    """Return the rule of a code or a name, None where there is no such rule."""
    for rule in all_rules():
        if rule.is_called(word):
            return rule
    return None


def _wanted(rule: Rule, select: Sequence[str] | None) -> int:
    """Return how exactly a rule is selected, 0 if it is not."""
    if select is None:
        return int(rule.default)
    return max((_meant(word, rule) for word in select), default=0)


def _meant(word: str, rule: Rule) -> int:
    """Return how exactly a word means a rule, 0 if it does not."""
    if word.upper() == "ALL":
        return 1
    if word.lower() == rule.name:
        return len(rule.code) + 1
    is_beginning = len(word) >= 2 and rule.code.startswith(word.upper())
    return len(word) if is_beginning else 0


def rule_of(module: ModuleType) -> Rule:
    """Return the rule of a module: its docstring is the page, its name the rule's."""
    page = cleandoc(module.__doc__ or "")
    return Rule(
        module.CODE,
        module.__name__.rpartition(".")[2].replace("_", "-"),
        page.partition("\n")[0],
        page,
        module.SEVERITY,
        module.NEEDS,
        getattr(module, "check", None),
        getattr(module, "DEFAULT", True),
    )
