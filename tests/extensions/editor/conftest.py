"""The editor in a real browser; sessions that are quick."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import ExitStack
from typing import TYPE_CHECKING, Any

import pytest

from babyrobot_levels.extensions.editor import answers, findings
from babyrobot_levels.extensions.editor.session import Session

if TYPE_CHECKING:
    from playwright.sync_api import Browser
    from support.editors import EditorPage, OpenEditor


@pytest.fixture(scope="module")
def put_off() -> Iterator[None]:
    """Puts off the optimum and the findings of all levels, as otherwise of large ones only.

    What a gesture does to the text and to the level does not depend on them.
    """
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(answers, "BUDGET", 0)
        patch.setattr(findings, "LONG", -1)
        yield


@pytest.fixture
def serve() -> Iterator[Callable[[Session], str]]:
    """Serves sessions: a function that returns the address of one."""
    from support.editors import served

    with ExitStack() as stack:
        yield lambda session: stack.enter_context(served(session))


@pytest.fixture
def editor_page(browser: Browser, serve: Callable[[Session], str]) -> Iterator[OpenEditor]:
    """Opens editors: a function of a session or a text, and of options of the browser.

    The options are those of `Browser.new_context`, such as `viewport`, `has_touch` and
    `color_scheme`. An error in the page fails the test.
    """
    from support.editors import EditorPage, is_shown

    errors: list[str] = []
    with ExitStack() as stack:

        def opened(level: Session | str, **options: Any) -> EditorPage:
            session = Session(level) if isinstance(level, str) else level
            size = {"width": 1280, "height": 800}
            settings: dict[str, Any] = {"viewport": size, "device_scale_factor": 1} | options
            context = browser.new_context(**settings)
            stack.callback(context.close)
            context.set_default_timeout(20_000)
            page = context.new_page()
            page.on("pageerror", lambda error: errors.append(str(error)))
            address = serve(session)
            page.goto(address)
            is_shown(page)
            return EditorPage(page, session, address)

        yield opened
    assert errors == []
