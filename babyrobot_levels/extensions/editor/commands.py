"""`babyrobot edit`: the editor in the browser."""

from __future__ import annotations

import sys
from pathlib import Path
from threading import Thread
from typing import TYPE_CHECKING, Annotated

import typer

from babyrobot_levels.cli.console import fail, flag, note, value_option, write
from babyrobot_levels.cli.inputs import RuntimeOption
from babyrobot_levels.cli.reporting import STANDARD_INPUT, read_path
from babyrobot_levels.text.errors import how_to_install
from babyrobot_levels.text.words import listed

if TYPE_CHECKING:
    from babyrobot_levels.extensions.editor.session import Session


def edit(
    level: Annotated[
        str | None,
        typer.Argument(
            metavar="LEVEL",
            help="A name, PACK/NAME, the path of a file, a share code, or `-` for standard input.  "
            "[default: an empty grid]",
            show_default=False,
        ),
    ] = None,
    port: Annotated[
        int | None,
        value_option("N", "Port of the server.  [default: a free one]", min=1024, max=65535),
    ] = None,
    no_browser: Annotated[
        bool, flag("--no-browser", "Only print the address; open no browser.")
    ] = False,
    site: Annotated[
        Path | None,
        value_option(
            "FOLDER",
            "Write the editor as static files, which run Python in the visitor's browser.",
            "--site",
        ),
    ] = None,
    runtime: RuntimeOption = None,
) -> None:
    """Edit a level in the browser, by drawing and as text.

    A file is saved in its place; a file that does not exist is made when it is saved. Levels of
    the gallery and of packs, share codes and standard input are opened as copies, which the
    browser downloads. Nothing but this file is written.

    The page is served to this machine only, until it is closed by its button, or by Ctrl-C here.
    The address holds a password: keep it to yourself.

    With `--site`, nothing is served. The folder can be put on any web server; there, Python runs
    in the browser, and visitors need to install nothing. They begin with LEVEL.

    Examples:

      babyrobot edit

      babyrobot edit levels/first.yaml

      babyrobot edit final-maze

      babyrobot resolve final-maze | babyrobot edit -

      babyrobot edit levels/first.yaml --site public/editor
    """
    from babyrobot_levels.extensions.editor.sources import session_of

    if site is not None:
        _write_site(site, _piped() if level == str(STANDARD_INPUT) else session_of(level), runtime)
        return
    try:
        from babyrobot_levels.extensions.editor.server import EditorServer
    except ModuleNotFoundError as error:
        if error.name not in ("starlette", "uvicorn"):
            raise
        fail(f"the package `{error.name}` is not installed", how_to_install("editor"))
    session = _piped() if level == str(STANDARD_INPUT) else session_of(level)
    server = EditorServer(session, port=port or 0, warn=_warn)
    note(f"editing {session.path or session.name}; press Ctrl-C to end")
    write(f"{server.address}\n")
    sys.stdout.flush()
    if not no_browser:
        # Some browsers return only when they are closed.
        Thread(target=_open, args=[server.address], daemon=True).start()
    server.run()


def _write_site(site: Path, session: Session, runtime: Path | None) -> None:
    from babyrobot_levels.extensions.editor.runtime import TARBALL, WHEELS, RuntimeFileError
    from babyrobot_levels.extensions.editor.site import SiteFolderError, write_site

    if session.file is not None and not session.file.exists:
        fail(f"{session.path} does not exist", "leave LEVEL out for an empty grid")
    try:
        size = write_site(site, session, runtime)
    except SiteFolderError as error:
        fail(str(error), "choose an empty folder")
    except RuntimeFileError as error:
        names = listed([file.name for file in (TARBALL, *WHEELS)])
        fail(str(error), f"get {names}, and give their folder with --runtime")
    note(f"wrote {site / 'index.html'}; a visitor loads {size / 1e6:.0f} MB at first")


def _open(address: str) -> None:
    """Open the page in the user's browser."""
    import webbrowser

    if not webbrowser.open(address):
        note("no browser was found: open the address in one")


def _piped() -> Session:
    """Return a session for the text on standard input, valid or not."""
    from babyrobot_levels.extensions.editor.session import Session
    from babyrobot_levels.extensions.editor.sources import NAME

    return Session(read_path(STANDARD_INPUT).text, name=NAME)


def _warn() -> None:
    note("there are unsaved changes: save them in the page, or press Ctrl-C again to lose them")
