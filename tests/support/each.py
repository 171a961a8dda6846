"""One case for a law of many values: `parametrize` would make a case of each."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable
from typing import Any

import pytest


def for_each(
    name: str, values: Iterable[Any], *, ids: Callable[[Any], object] = repr
) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Call a test with each of `values` as its argument `name`, all in one case.

    The first failure ends the case and is noted to be that of its value. Fixtures are set up once
    for all values: use `parametrize` for tests that change them.
    """
    every = list(values)
    assert every, "a law of nothing holds always"

    def decorate(test: Callable[..., None]) -> Callable[..., None]:
        def law(**others: Any) -> None:
            for value in every:
                try:
                    test(**{name: value}, **others)
                except pytest.skip.Exception:
                    continue
                except (Exception, pytest.fail.Exception) as error:
                    error.add_note(f"with {name} = {ids(value)}")
                    raise

        signature = inspect.signature(test)
        kept = [each for each in signature.parameters.values() if each.name != name]
        assert len(kept) < len(signature.parameters), f"{test.__name__} has no argument {name}"
        law.__name__, law.__qualname__, law.__doc__ = test.__name__, test.__qualname__, test.__doc__
        law.__module__ = test.__module__
        law.__signature__ = signature.replace(parameters=kept)  # type: ignore[attr-defined]
        # Marks given below this one.
        law.pytestmark = getattr(test, "pytestmark", [])  # type: ignore[attr-defined]
        return law

    return decorate
