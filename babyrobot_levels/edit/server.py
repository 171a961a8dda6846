"""The editor in the browser: a server for one level, for the same machine alone."""

from __future__ import annotations

from typing import TYPE_CHECKING

from babyrobot_levels.edit.front_end import module, static, style
from babyrobot_levels.edit.protocol import answer
from babyrobot_levels.edit.session import Session

if TYPE_CHECKING:
    from starlette.applications import Starlette
    from starlette.requests import Request
    from starlette.responses import Response


def application(session: Session, token: str) -> Starlette:
    """Return the application that serves the editor under `/TOKEN/`."""
    from starlette.applications import Starlette
    from starlette.concurrency import run_in_threadpool
    from starlette.responses import HTMLResponse, JSONResponse, PlainTextResponse
    from starlette.routing import Route

    async def page(request: Request) -> Response:
        return HTMLResponse(static("editor.html"))

    async def script(request: Request) -> Response:
        return PlainTextResponse(module(), media_type="text/javascript")

    async def styles(request: Request) -> Response:
        return PlainTextResponse(style(), media_type="text/css")

    async def message(request: Request) -> Response:
        return JSONResponse(await run_in_threadpool(answer, session, await request.json()))

    return Starlette(
        routes=[
            Route(f"/{token}/", page),
            Route(f"/{token}/editor.js", script),
            Route(f"/{token}/editor.css", styles),
            Route(f"/{token}/message", message, methods=["POST"]),
        ]
    )
