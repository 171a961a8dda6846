"""The editor in the browser: a server for one level, for this machine alone.

What keeps others out: it listens on the loopback address only; every address below it begins with
a random token; a request must name that very host, which one that a foreign name leads here does
not (DNS rebinding); and what other pages of the browser send is recognised by its `Origin` and
`Sec-Fetch-Site`. It serves the editor and its messages, and no files.
"""

from __future__ import annotations

import json
import secrets
import signal
import socket
from collections.abc import Callable
from http import HTTPStatus
from threading import Lock
from types import FrameType
from typing import Any

import uvicorn
from starlette.applications import Starlette
from starlette.background import BackgroundTask
from starlette.concurrency import run_in_threadpool
from starlette.middleware import Middleware
from starlette.middleware.base import BaseHTTPMiddleware, RequestResponseEndpoint
from starlette.requests import ClientDisconnect, Request
from starlette.responses import HTMLResponse, JSONResponse, PlainTextResponse, Response
from starlette.routing import Mount, Route

from babyrobot_levels.extensions.editor.protocol import answer, meanwhile, prepare
from babyrobot_levels.extensions.editor.session import Session
from babyrobot_levels.extensions.editor.state import STATIC, served_script, style
from babyrobot_levels.render.templates import static
from babyrobot_levels.text.errors import BabyRobotError

LOOPBACK = "127.0.0.1"

MAX_BODY = 2 << 20
"""The most bytes of a message: a level file, with its characters escaped."""

HEADERS = {
    "Content-Security-Policy": "default-src 'none'; script-src 'self'; style-src 'self'; "
    "connect-src 'self'; img-src data: blob:; frame-ancestors 'none'; base-uri 'none'; "
    "form-action 'none'",
    "Cache-Control": "no-store",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
}
"""Of every response."""


class PortError(BabyRobotError):
    """A port on which the editor cannot be served."""


class RequestError(Exception):
    """A request that is refused with a status."""

    def __init__(self, status: HTTPStatus, message: str) -> None:
        super().__init__(message)
        self.status = status


class EditorServer:
    """A server for a session, which ends when its page or Ctrl-C asks for it.

    Args:
        session: the session.
        port: the port; 0 for a free one.
        warn: called when Ctrl-C is pressed while there are unsaved changes. The server goes on
            then, and ends when it is pressed again.

    Attributes:
        address: the address of the page, which nobody can guess.

    Raises:
        PortError: the port is in use, or may not be used.
    """

    def __init__(
        self, session: Session, *, port: int = 0, warn: Callable[[], None] = lambda: None
    ) -> None:
        self._socket = _listening(port)
        token = secrets.token_urlsafe(24)
        self.address = f"http://{LOOPBACK}:{self._socket.getsockname()[1]}/{token}/"
        config = uvicorn.Config(
            application(session, token, self.stop),
            access_log=False,
            log_config=None,
            lifespan="off",
            server_header=False,
            timeout_graceful_shutdown=2,
            ws="none",
        )
        self._server = _Server(config, session, warn)

    def run(self) -> None:
        """Serve until asked to end.

        Raises:
            KeyboardInterrupt: Ctrl-C has ended it.
        """
        try:
            self._server.run([self._socket])
        finally:
            self.close()

    def close(self) -> None:
        """Free the port of a server that does not run."""
        self._socket.close()

    def stop(self) -> None:
        """Ask the server to end; from any thread."""
        self._server.should_exit = True


class _Server(uvicorn.Server):
    """A server that Ctrl-C does not end at once while there are unsaved changes."""

    def __init__(self, config: uvicorn.Config, session: Session, warn: Callable[[], None]) -> None:
        super().__init__(config)
        self._session, self._warn = session, warn
        self._warned_of: int | None = None

    def handle_exit(self, sig: int, frame: FrameType | None) -> None:
        """End on a signal; on Ctrl-C, only if nothing is lost or the user was warned."""
        revision = self._session.revision
        is_warned = self._warned_of == revision
        if sig == signal.SIGINT and not self._session.is_saved and not is_warned:
            self._warned_of = revision
            self._warn()
            return
        super().handle_exit(sig, frame)


def application(session: Session, token: str, stop: Callable[[], None] = lambda: None) -> Starlette:
    """Return the application that serves the editor under `/TOKEN/`.

    Args:
        session: what is edited.
        token: the beginning of all addresses.
        stop: called when the page asks the server to end.
    """
    lock = Lock()

    def answered(message: dict[str, Any]) -> dict[str, Any]:
        reply = prepare(session, message)
        if reply is None and lock.locked():
            reply = meanwhile(session, message)
        if reply is not None:
            return reply
        with lock:
            return answer(session, message)

    async def page(request: Request) -> Response:
        return HTMLResponse(static(f"{STATIC}/editor.html"))

    async def script(request: Request) -> Response:
        return PlainTextResponse(served_script(), media_type="text/javascript")

    async def styles(request: Request) -> Response:
        return PlainTextResponse(style(), media_type="text/css")

    async def message(request: Request) -> Response:
        reply = await run_in_threadpool(answered, await _message(request))
        return JSONResponse(reply, background=BackgroundTask(stop) if "ended" in reply else None)

    async def guard(request: Request, respond: RequestResponseEndpoint) -> Response:
        try:
            _check(request, token)
            response = await respond(request)
        except RequestError as error:
            response = PlainTextResponse(f"{error}\n", error.status)
        response.headers.update(HEADERS)
        return response

    routes = [
        Route("/", page),
        Route("/editor.js", script),
        Route("/editor.css", styles),
        Route("/message", message, methods=["POST"]),
    ]
    return Starlette(
        routes=[Mount(f"/{token}", routes=routes)],
        middleware=[Middleware(BaseHTTPMiddleware, dispatch=guard)],
    )


def _check(request: Request, token: str) -> None:
    """Refuse a request that does not come from the editor's own page, or asks for it."""
    port = request.scope["server"][1]
    origins = [f"http://{name}:{port}" for name in (LOOPBACK, "localhost")]
    host = f"http://{request.headers.get('host')}"
    if host not in origins:
        raise RequestError(
            HTTPStatus.MISDIRECTED_REQUEST, f"this is the editor of {LOOPBACK}:{port} only"
        )
    first, _, rest = request.scope["path"].removeprefix("/").partition("/")
    if not secrets.compare_digest(first.encode(), token.encode()):
        raise RequestError(HTTPStatus.NOT_FOUND, "there is nothing at this address")
    is_foreign = request.headers.get("origin", host) != host
    # One may come to the page from anywhere, such as by a link in a terminal.
    site = request.headers.get("sec-fetch-site", "same-origin")
    if is_foreign or (rest and site != "same-origin"):
        raise RequestError(HTTPStatus.FORBIDDEN, "other pages may not use the editor")


async def _message(request: Request) -> dict[str, Any]:
    """Return the message in the body of a request."""
    kind = request.headers.get("content-type", "").partition(";")[0].strip().lower()
    if kind != "application/json":
        raise RequestError(HTTPStatus.UNSUPPORTED_MEDIA_TYPE, "a message is application/json")
    body = bytearray()
    try:
        async for chunk in request.stream():
            body += chunk
            if len(body) > MAX_BODY:
                raise RequestError(
                    HTTPStatus.REQUEST_ENTITY_TOO_LARGE, f"a message has at most {MAX_BODY:,} bytes"
                )
    except ClientDisconnect:
        # Nobody hears this.
        raise RequestError(HTTPStatus.BAD_REQUEST, "the message has no end") from None
    try:
        message = json.loads(body, parse_constant=_refuse)
    except (ValueError, RecursionError):
        raise RequestError(HTTPStatus.BAD_REQUEST, "the message is not valid JSON") from None
    if not isinstance(message, dict):
        raise RequestError(HTTPStatus.BAD_REQUEST, "a message is an object")
    return message


def _refuse(constant: str) -> None:
    raise ValueError(f"{constant} is not JSON")


def _listening(port: int) -> socket.socket:
    """Return a socket that listens on a port of the loopback address."""
    listener = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
    try:
        listener.bind((LOOPBACK, port))
        listener.listen()
    except OSError as error:
        listener.close()
        raise PortError(f"port {port} cannot be used ({error.strerror or error})") from None
    return listener
