"""The editor in a real browser, served as the command serves it."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from threading import Thread

from playwright.sync_api import Page, expect

from babyrobot_levels.extensions.editor.server import EditorServer
from babyrobot_levels.extensions.editor.session import Session


@dataclass(frozen=True, slots=True)
class EditorPage:
    """An editor that is open in a browser.

    Attributes:
        page: its page.
        session: what it edits.
        address: where it is served.
    """

    page: Page
    session: Session
    address: str


OpenEditor = Callable[..., EditorPage]
"""The fixture `editor_page`: takes a session or a text, and options of the browser's context."""


@contextmanager
def served(session: Session) -> Iterator[str]:
    """Serve a session in a thread; yield the address."""
    server = EditorServer(session)
    thread = Thread(target=server.run)
    thread.start()
    try:
        yield server.address
    finally:
        server.stop()
        thread.join(20)
        assert not thread.is_alive()


def is_shown(page: Page) -> None:
    """Wait until a page has shown the state of its editor for the first time."""
    expect(page).to_have_title(re.compile(" – editor$"), timeout=20_000)
