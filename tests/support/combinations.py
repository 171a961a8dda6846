"""Combinations of parameters: few of them in the fast set of tests, all of them in the sweep."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from itertools import combinations, product
from typing import Any

import pytest


def swept(first: Iterable[Any], everything: Iterable[Any]) -> list[Any]:
    """Return values for `parametrize`: some with every cause, then the rest as a sweep."""
    some = list(first)
    return some + [
        pytest.param(each, marks=pytest.mark.sweep) for each in everything if each not in some
    ]


def combined(strength: int, **parameters: Collection[Any]) -> pytest.MarkDecorator:
    """Parametrise a test by the product of parameters, all but a covering part marked as a sweep.

    Args:
        strength: every choice of values for so many parameters comes up in the fast part: with 1,
            every value of each parameter; with 2, every pair of values of two parameters.
        parameters: the values of each parameter.
    """
    return selected(covering([*map(list, parameters.values())], strength), **parameters)


def selected(
    some: Collection[tuple[Any, ...]], **parameters: Collection[Any]
) -> pytest.MarkDecorator:
    """Parametrise a test by the product of parameters, all but some combinations as a sweep."""
    cases = [
        pytest.param(*case, marks=[] if case in some else pytest.mark.sweep)
        for case in product(*parameters.values())
    ]
    return pytest.mark.parametrize(tuple(parameters), cases)


def covering(parameters: Sequence[Sequence[Any]], strength: int) -> list[tuple[Any, ...]]:
    """Return a few combinations in which every choice of values for `strength` parameters occurs.

    Each next one is the combination with the most choices that did not occur before.
    """

    def choices(indices: tuple[int, ...]) -> set[tuple[tuple[int, int], ...]]:
        return set(combinations(enumerate(indices), strength))

    rest = list(product(*(range(len(values)) for values in parameters)))
    missing = set().union(*map(choices, rest))
    found = []
    while missing:
        best = max(rest, key=lambda indices: len(choices(indices) & missing))
        missing -= choices(best)
        found.append(best)
    return [
        tuple(values[index] for values, index in zip(parameters, indices, strict=True))
        for indices in found
    ]
