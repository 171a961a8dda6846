"""Who looks at what is displayed: told from what Jupyter's programs say of themselves."""

from __future__ import annotations

import sys
from types import SimpleNamespace
from typing import Any

import IPython
import pytest

from babyrobot_levels.render.notebook.html import Frontend, frontend, in_notebook


def kernel(*, allow_stdin: bool | None) -> SimpleNamespace:
    """Return a kernel that runs a cell, or with None handles another message."""
    content = {} if allow_stdin is None else {"allow_stdin": allow_stdin}
    return SimpleNamespace(get_parent=lambda: {"content": content})


@pytest.fixture
def run_by(monkeypatch: pytest.MonkeyPatch) -> Any:
    """Have IPython say that it is another's shell."""
    monkeypatch.delenv("SERVER_SOFTWARE", raising=False)
    return lambda **shell: monkeypatch.setattr(
        IPython, "get_ipython", lambda: SimpleNamespace(**shell)
    )


def test_plain_python_is_no_notebook() -> None:
    assert IPython.get_ipython() is None
    assert not in_notebook()
    assert frontend() is Frontend.NONE


def test_python_without_ipython_is_no_notebook(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delitem(sys.modules, "IPython")
    assert not in_notebook()


def test_ipython_in_a_terminal_is_no_notebook(run_by: Any) -> None:
    run_by(ask_exit=lambda: None)
    assert not in_notebook()
    assert frontend() is Frontend.NONE


@pytest.mark.parametrize(
    ("allow_stdin", "expected"),
    [(True, Frontend.CANVAS), (None, Frontend.CANVAS), (False, Frontend.PROGRAM)],
)
def test_who_can_answer_is_a_person(
    allow_stdin: bool | None, expected: Frontend, run_by: Any
) -> None:
    run_by(kernel=kernel(allow_stdin=allow_stdin))
    assert in_notebook()
    assert frontend() is expected


def test_a_kernel_that_does_not_tell_has_a_person_before_it(run_by: Any) -> None:
    run_by(kernel=SimpleNamespace())
    assert frontend() is Frontend.CANVAS


def test_voila_runs_cells_as_programs_do_but_for_people(
    run_by: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    run_by(kernel=kernel(allow_stdin=False))
    monkeypatch.setenv("SERVER_SOFTWARE", "voila/0.5.8")
    assert frontend() is Frontend.CANVAS


@pytest.mark.parametrize(
    ("address", "expected"),
    [(None, Frontend.PICTURES), ("https://example.org/manager.js", Frontend.CANVAS)],
)
def test_colab_shows_a_canvas_once_it_has_been_allowed(
    address: str | None, expected: Frontend, run_by: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    run_by(kernel=kernel(allow_stdin=True))
    for name in ("google.colab", "google.colab.output"):
        monkeypatch.setitem(sys.modules, name, SimpleNamespace())
    widgets = SimpleNamespace(_installed_url=address)
    monkeypatch.setitem(sys.modules, "google.colab.output._widgets", widgets)
    assert in_notebook()
    assert frontend() is expected
