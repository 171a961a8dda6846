"""The place in a notebook where a view is shown, and the picture that stays there when it ends.

A notebook stores what a cell put out in every form that it came in, and whoever opens it later
shows the form that it likes best. JupyterLab, Notebook and VS Code like widgets best, also where
the kernel is gone: an error is then all that is seen. So a picture is put out beside the widget,
not as another form of it, and a style sheet shows whichever of the two there is something to see
of.
"""

from __future__ import annotations

from collections.abc import Callable

from IPython.core.getipython import get_ipython
from IPython.display import DisplayHandle, display

from babyrobot_levels.render.notebook.bundle import HTML, TEXT, Bundle

_STYLE = """\
<style class="{name}">
.jp-OutputArea:has(canvas.{name}) .jp-OutputArea-child:has(style.{name}) + .jp-OutputArea-child,
body:has(canvas.{name}) svg.{name},
.jp-OutputArea-child:has(style.{name}) + * + .jp-OutputArea-child:has(> .lm-Panel:last-child)\
:not(:has(> .lm-Panel > *)),
.jp-OutputArea-child:has(style.{name}) {{ display: none }}
</style>"""
"""Hides the picture where the widget's canvas is: in JupyterLab and Notebook its whole output,
elsewhere its SVG. Hides a widget's output that has nothing in it but words, and itself."""


def put_out(bundle: Bundle) -> DisplayHandle:
    """Show something in the running cell; return what can replace it."""
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
        self._handle = put_out(still())

    def refresh(self) -> None:
        """Take note that the picture has changed."""
        self._handle.update(self._still(), raw=True)  # type: ignore[no-untyped-call]

    def close(self) -> None:
        """Leave the picture as it is now."""


class CellOutput(Output):
    """A picture that is renewed when a cell is done, whatever happens in between."""

    def __init__(self, still: Callable[[], Bundle]) -> None:
        super().__init__(still)
        self._is_stale = False
        shell = get_ipython()
        assert shell is not None
        self._events = shell.events
        self._events.register("post_run_cell", self._renew)

    def refresh(self) -> None:
        """Take note that the picture has changed; it is renewed when the cell is done."""
        self._is_stale = True

    def _renew(self, _: object = None) -> None:
        if self._is_stale:
            super().refresh()
        self._is_stale = False

    def close(self) -> None:
        """Leave the picture as it is now."""
        self._renew()
        self._events.unregister("post_run_cell", self._renew)


class HiddenOutput(CellOutput):
    """A picture that is seen only where the widget that is put out after it is not.

    Args:
        still: returns the picture as it is now.
        name: the CSS class of the widget's canvas, and of the picture.
    """

    def __init__(self, still: Callable[[], Bundle], name: str) -> None:
        put_out({HTML: _STYLE.format(name=name), TEXT: ""})
        super().__init__(still)
