#!/usr/bin/env bash
# A tool of an MCP server cannot answer with an infinite number, though its own schema says that it is a number.
#
# Packages: mcp 2.3.0
# Tried: 2026-11-28, Python 3.11
# Expected: a tool that is annotated `-> float` answers infinity in some form, or the server refuses it with an error of that tool.
# Seen: the server sends null in its place, and the client raises "Invalid structured content returned by tool: None is not of
#   type 'number'" where the call is made; the session goes on.
# Why it matters: returns, distances and shares of levels that cannot be won are -inf, inf and NaN. A tool that worked for every level of a
#   test takes an agent's program down at the first closed maze.
# Here: numbers that are not finite are sent as texts, such as "inf", and the schema says so
#   (`test_infinities_are_texts` in tests/extensions/assistants/test_tools.py).
set -euo pipefail
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
cd "$folder"
"${PYTHON:-python3}" -m venv venv
venv/bin/pip install --quiet --disable-pip-version-check --no-compile mcp==2.3.0
venv/bin/python - <<'EOF'
import asyncio
import logging
import math
from importlib.metadata import version

from mcp import Client
from mcp.server.mcpserver import MCPServer

logging.disable(logging.INFO)
print("mcp", version("mcp"))
server = MCPServer("levels")


@server.tool()
def best_return(closed: bool) -> float:
    return -math.inf if closed else -7.0


async def answer(client, closed):
    try:
        result = await client.call_tool("best_return", {"closed": closed})
    except RuntimeError as error:
        return " ".join(str(error).split("\n")[0].split())
    return "an error of the tool" if result.is_error else result.structured_content["result"]


async def ask():
    async with Client(server) as client:
        return [await answer(client, closed) for closed in (False, True, False)]


print("expected: -7.0, an error of the tool or a word for -inf, -7.0")
seen = asyncio.run(ask())
print("seen:", seen)
assert seen[0] == seen[2] == -7.0
assert "None is not of type 'number'" in seen[1]
EOF
