"""The output of a view in a notebook cell, and the picture that stays there.

A notebook stores every MIME type of a cell's output, and a program that opens it later shows the
one it prefers. JupyterLab, Notebook and VS Code prefer widgets, even without a kernel, and then
show only an error. So the picture is displayed as an output of its own beside the widget, and a
style sheet shows the one of the two that has something to show.
"""

from __future__ import annotations

from collections.abc import Callable

from IPython.core.getipython import get_ipython
from IPython.display import DisplayHandle, display

from babyrobot_levels.render.notebook.html import HTML, TEXT, Bundle

_STYLE = """\
<style class="{name}">
.jp-OutputArea:has(:is(canvas, div).{name}) .jp-OutputArea-child:has(style.{name})\
 + .jp-OutputArea-child,
body:has(:is(canvas, div).{name}) svg.{name},
.jp-OutputArea-child:has(style.{name}) + * + .jp-OutputArea-child:has(> .lm-Panel:last-child)\
:not(:has(> .lm-Panel > *)),
.jp-OutputArea-child:has(style.{name}) {{ display: none }}
</style>"""
"""Hides the picture if the widget's canvas or element is shown: in JupyterLab and Notebook its
whole output, elsewhere its SVG. Hides a widget's output that contains only an error, and itself."""


def display_bundle(bundle: Bundle) -> DisplayHandle:
    """Display a bundle in the running cell; return a handle to replace it."""
    handle: DisplayHandle = display(  # type: ignore[no-untyped-call]
        bundle, raw=True, display_id=True
    )
    return handle


class Output:
    """A picture in the running cell.

    Args:
        still: returns the picture as it is now.
    """

    def __init__(self, still: Callable[[], Bundle]) -> None:
        self._still = still
        self._handle = display_bundle(still())

    def refresh(self) -> None:
        """Show the changed picture."""
        self._handle.update(self._still(), raw=True)  # type: ignore[no-untyped-call]

    def close(self) -> None:
        """Stop updating the picture."""


class CellOutput(Output):
    """A picture that is updated once, when a cell has finished."""

    def __init__(self, still: Callable[[], Bundle]) -> None:
        super().__init__(still)
        self._is_stale = False
        shell = get_ipython()
        assert shell is not None
        self._events = shell.events
        self._events.register("post_run_cell", self._update)

    def refresh(self) -> None:
        """Note that the picture has changed; it is updated when the cell has finished."""
        self._is_stale = True

    def _update(self, _: object = None) -> None:
        if self._is_stale:
            super().refresh()
        self._is_stale = False

    def close(self) -> None:
        """Stop updating the picture."""
        self._update()
        self._events.unregister("post_run_cell", self._update)


class HiddenOutput(CellOutput):
    """A picture that is shown only if the widget that is displayed after it is not.

    Args:
        still: returns the picture as it is now.
        name: the CSS class of the widget's canvas, and of the picture.
    """

    def __init__(self, still: Callable[[], Bundle], name: str) -> None:
        _hide_beside(name)
        super().__init__(still)


class StandIn(Output):
    """A picture that is shown only if the widget that is displayed after it is not.

    It is updated at once, also between cells.

    Args:
        still: returns the picture as it is now.
        name: the CSS class of the widget's view, and of the picture.
    """

    def __init__(self, still: Callable[[], Bundle], name: str) -> None:
        _hide_beside(name)
        super().__init__(still)


def _hide_beside(name: str) -> None:
    display_bundle({HTML: _STYLE.format(name=name), TEXT: ""})
