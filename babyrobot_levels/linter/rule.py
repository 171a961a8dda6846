"""What a rule is, and the decorator that registers one."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cached_property
from inspect import cleandoc
from typing import TYPE_CHECKING, Any, TypeVar

from babyrobot_levels.linter.finding import Finding, Needs
from babyrobot_levels.text.diagnostics import Severity

if TYPE_CHECKING:
    from babyrobot_levels.linter.context import LintContext

Check = Callable[["LintContext"], Iterable[Finding]]
Function = TypeVar("Function", bound=Callable[[Any], Iterable[Finding]])


@dataclass(frozen=True, repr=False)
class Rule:
    """A rule, or the page of an error code.

    Attributes:
        code: the stable code: `BR5xx` for rules of play, `BR6xx` for rules of style.
        name: the name, in kebab case.
        summary: what the rule finds, one line.
        page: the page, Markdown.
        severity: the severity of its findings.
        needs: what the check needs.
        check: the check; None for errors, and for a rule that compares files.
        default: whether the rule runs unless it is ignored.
    """

    code: str
    name: str
    summary: str
    page: str
    severity: Severity
    needs: Needs = Needs.LEVEL
    check: Check | None = None
    default: bool = True

    __module__ = "babyrobot_levels"

    def __repr__(self) -> str:
        return f"<Rule {self.code} {self.name}: {self.summary}>"

    def _repr_markdown_(self) -> str:
        return f"## {self.name} ({self.code})\n\n{self.page}"

    @cached_property
    def names(self) -> frozenset[str]:
        """The code and the name, in lower case."""
        return frozenset((self.code.lower(), self.name))

    def is_called(self, word: str) -> bool:
        """Return whether a word is the rule's code or its name."""
        return word.lower() in self.names


REGISTERED: dict[str, Rule] = {}
"""The rules that have been defined so far, by code. Use `rules.all_rules` to get all of them."""


def rule(
    code: str,
    severity: Severity = Severity.WARNING,
    *,
    needs: Needs = Needs.TABLES,
    default: bool = True,
    compares_files: bool = False,
) -> Callable[[Function], Function]:
    """Register a function as a rule.

    The function's name gives the rule's name, the first line of its docstring the summary, and the
    rest of the docstring the page.

    Args:
        code: the code.
        severity: the severity of the findings.
        needs: what the check needs.
        default: whether the rule runs unless it is ignored.
        compares_files: whether the function is called for two files instead of for each file.
    """

    def register(function: Function) -> Function:
        summary, _, page = cleandoc(function.__doc__ or "").partition("\n")
        REGISTERED[code] = Rule(
            code,
            function.__name__.replace("_", "-"),
            summary,
            page.strip() + "\n",
            severity,
            needs,
            None if compares_files else function,
            default,
        )
        return function

    return register


def is_known(word: str) -> bool:
    """Return whether a word is the code or the name of a registered rule."""
    return any(each.is_called(word) for each in REGISTERED.values())
