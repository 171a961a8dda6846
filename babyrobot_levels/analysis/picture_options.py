"""What pictures, films and pages show: their options, which each function takes by name."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable
from functools import wraps
from typing import Any, ParamSpec, TypedDict, TypeVar

P = ParamSpec("P")
T = TypeVar("T")


class TextOptions(TypedDict, total=False):
    """What a text shows; `babyrobot preview` makes it for the terminal."""

    values: bool
    policy: Any
    held: str | Iterable[str] | None
    lost: bool
    rules: bool


class StillOptions(TypedDict, total=False):
    """What a still picture shows, and how; see `Level.to_svg`."""

    values: Any
    policy: Any
    action_values: Any
    visits: Any
    coordinates: bool | None
    theme: Any
    held: str | Iterable[str] | None
    lost: bool
    rules: bool
    scale: float | None


class FilmOptions(TypedDict, total=False):
    """What a film shows, and how; see `Level.to_gif`."""

    policy: Any
    seed: int
    values: Any
    coordinates: bool | None
    theme: Any
    rules: bool
    scale: float | None


class PageOptions(TypedDict, total=False):
    """What a page to play on shows, and how; see `Level.to_html`."""

    values: bool
    policy: Any
    seed: int
    coordinates: bool | None
    theme: Any
    answers: bool
    previous_page: str | None
    next_page: str | None
    learn: bool | None
    sight: Any
    view_radius: int | None


def takes(options: Any, **defaults: Any) -> Callable[[Callable[P, T]], Callable[P, T]]:
    """Let a function take the options of a typed dictionary by name, and no others.

    Help and completion show the options, and one that is misspelt is told the nearest name.

    Args:
        options: the typed dictionary.
        defaults: what options are by default, where that is not None.
    """

    def decorated(function: Callable[P, T]) -> Callable[P, T]:
        signature = _signature(function, options, defaults)

        from babyrobot_levels.text.words import telling

        told = telling(function, signature)

        @wraps(function)
        def checked(*args: P.args, **given: P.kwargs) -> T:
            return told(*args, **{**defaults, **given})

        checked.__signature__ = signature  # type: ignore[attr-defined]
        return checked

    return decorated


def _signature(
    function: Callable[..., Any], options: Any, defaults: dict[str, Any]
) -> inspect.Signature:
    """Return the signature of a function with each option in place of all of them."""
    signature = inspect.signature(function)
    *own, _ = signature.parameters.values()
    each = [
        inspect.Parameter(
            name,
            inspect.Parameter.KEYWORD_ONLY,
            default=defaults.get(name),
            annotation=kind.__forward_arg__,
        )
        for name, kind in options.__annotations__.items()
    ]
    by_name = [one for one in own if one.kind is inspect.Parameter.KEYWORD_ONLY]
    return signature.replace(parameters=[*own[: len(own) - len(by_name)], *each, *by_name])
