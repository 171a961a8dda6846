#!/usr/bin/env bash
# A tool of an MCP server that takes a text or a mapping gets a mapping where the client sent a text.
#
# Packages: mcp 2.3.0
# Tried: 2026-11-28, Python 3.11
# Expected: a parameter of type `str | dict` holds the text that was sent: it is valid as it is.
# Seen: a text that can be read as JSON, such as '{"size": 8}', arrives as a mapping; one of YAML, "size: 8", as a text. A parameter of
#   type `str` alone gets both as texts. The text "null" is refused, though it is one.
# Why it matters: tools for levels take files as texts, and JSON is YAML: places in error messages, comments and the
#   order of keys are gone before the tool sees the file, but only for authors who write JSON.
# Here: tools take a level as a text alone
#   (`test_an_assistant_goes_from_a_brief_to_a_clean_level` in tests/extensions/assistants/test_server.py).
set -euo pipefail
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
cd "$folder"
"${PYTHON:-python3}" -m venv venv
venv/bin/pip install --quiet --disable-pip-version-check --no-compile mcp==2.3.0
venv/bin/python - <<'EOF'
import asyncio
import logging
from importlib.metadata import version

from mcp import Client
from mcp.server.mcpserver import MCPServer

logging.disable(logging.INFO)
print("mcp", version("mcp"))
server = MCPServer("levels")


@server.tool()
def text(level: str) -> str:
    return type(level).__name__


@server.tool()
def either(level: str | dict[str, int]) -> str:
    return type(level).__name__


async def kinds(tool):
    async with Client(server) as client:
        answers = [await client.call_tool(tool, {"level": level}) for level in ("size: 8", '{"size": 8}', "null")]
    return ["an error" if each.is_error else each.structured_content["result"] for each in answers]


print("a parameter `str`:", asyncio.run(kinds("text")))
print("expected of a parameter `str | dict`: ['str', 'str', 'str']")
seen = asyncio.run(kinds("either"))
print("seen:", seen)
assert asyncio.run(kinds("text")) == ["str"] * 3
assert seen == ["str", "dict", "an error"]
EOF
