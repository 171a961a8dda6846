"""The server for assistants: the tools by the Model Context Protocol, over standard streams."""

from __future__ import annotations

import functools
import inspect
import io
import os
import re
import sys
from collections.abc import Callable
from pathlib import Path
from typing import IO, TYPE_CHECKING, Annotated, Any

from babyrobot_levels.text.errors import how_to_install

if TYPE_CHECKING:
    from mcp.server import MCPServer

    from babyrobot_levels.extensions.assistants.worker import Worker

_ESCAPE = re.compile(rb"\\(?:u[dD][89abAB]..\\u[dD][c-fC-F]..|(u[dD][89a-fA-F]..)|.)")
"""An escape in JSON; a half of a surrogate pair without the other one is a group."""

_ID = re.compile(rb'"id"\s*:\s*("(?:[^"\\]|\\.)*"|-?\d+)\s*[,}]')

_FRESH = 3_600_000
"""So many milliseconds may a client keep the list of tools."""

INSTRUCTIONS = """\
Grid worlds as YAML files, whose claims are decided exactly. To write a level: read \
language_reference once; write the text with the facts of the brief in `expect`; check it, and \
mend what is found, until it is clean; look at solve and preview."""


def mcp(folder: str | os.PathLike[str] | None = None, *, seconds: float = 60.0) -> MCPServer:
    """Return a server of tools for assistants that write levels, as `babyrobot mcp` runs it.

    `mcp().run()` serves standard input and output, and `mcp().run("streamable-http", port=8000)`
    serves by HTTP. The tools take levels as texts. Clients need no session: what a call leaves
    behind, a play, is named by what it returns.

    Args:
        folder: the folder in which levels may be read and written; by default, none are.
        seconds: how long a call may take.

    Raises:
        ImportError: the package `mcp` 2 is not installed.
        NotADirectoryError: there is no such folder.
    """
    try:
        from mcp.server import MCPServer
        from mcp.server.caching import CacheHint
    except ImportError:
        message = f"the server needs the package `mcp`, 2.0 or later: {how_to_install('mcp')}"
        raise ImportError(message, name="mcp") from None
    from babyrobot_levels.extensions.assistants.tools import Tools
    from babyrobot_levels.extensions.assistants.worker import Worker

    if folder is not None and not Path(folder).is_dir():
        raise NotADirectoryError(f"there is no folder {folder}")

    class Server(MCPServer):  # type: ignore[misc]
        def run(self, *arguments: Any, **options: Any) -> None:
            requests = _Requests(sys.stdin.buffer)  # noqa: TID251
            sys.stdin = io.TextIOWrapper(requests)  # noqa: TID251
            super().run(*arguments, **options)

    # What the server offers stays as it is while it runs, and is the same for everybody.
    fixed = CacheHint(ttl_ms=_FRESH, scope="public")
    server = Server(
        "babyrobot",
        instructions=INSTRUCTIONS,
        log_level="CRITICAL",
        cache_hints={"server/discover": fixed, "tools/list": fixed},
    )
    worker = Worker(None if folder is None else Path(folder).absolute(), seconds)
    for name, method in vars(Tools).items():
        if not name.startswith("_"):
            server.add_tool(_tool(name, method, worker), description=inspect.getdoc(method))
    return server


class _Requests(io.BufferedIOBase):
    """Lines with requests, without what would keep them from an answer."""

    def __init__(self, lines: IO[bytes]) -> None:
        self._lines = lines

    def readable(self) -> bool:
        return True

    def read1(self, _: int = -1) -> bytes:
        """Return the next line. One that is no request becomes one that is answered by an error."""
        from mcp.types import jsonrpc_message_adapter

        line = self._lines.readline().decode("utf-8", "replace").encode()
        line = _ESCAPE.sub(lambda found: rb"\ufffd" if found[1] else found[0], line)
        try:
            jsonrpc_message_adapter.validate_json(line)
        except ValueError:
            if found := _ID.search(line):
                line = b'{"jsonrpc": "2.0", "id": %b, "method": "none that is read"}\n' % found[1]
        return line


def _tool(name: str, method: Callable[..., Any], worker: Worker) -> Callable[..., Any]:
    """Return a function with the arguments of a tool, as the server asks for it."""
    from mcp.server.mcpserver import Image
    from mcp.server.mcpserver.exceptions import ToolError
    from mcp.types import CallToolResult, TextContent

    from babyrobot_levels.extensions.assistants.tools import RefusedError

    @functools.wraps(method)
    def call(**arguments: Any) -> CallToolResult:
        try:
            result = worker.call(name, arguments)
        except RefusedError as error:
            raise ToolError(str(error)) from None
        content: list[Any] = [TextContent(type="text", text=result.told)]
        if result.picture:
            content.append(Image(data=result.picture, format="png").to_image_content())
        return CallToolResult(content=content, structured_content=result.model_dump(mode="json"))

    signature = inspect.signature(method, eval_str=True)
    _, *parameters = signature.parameters.values()
    returned = Annotated[CallToolResult, signature.return_annotation]
    call.__signature__ = signature.replace(parameters=parameters, return_annotation=returned)  # type: ignore[attr-defined]
    call.__annotations__ = {each.name: each.annotation for each in parameters}
    return call
