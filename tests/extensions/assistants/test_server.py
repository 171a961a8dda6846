"""The server for assistants, over real pipes: the SDK's own client, and strangers."""

from __future__ import annotations

import asyncio
import json
import os
import signal
import subprocess
import sys
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

import pytest
from support.places import ROOT

import babyrobot_levels as brl
from babyrobot_levels.extensions.assistants.tools import Tools
from babyrobot_levels.render.templates import static

EXAMPLE = static("extensions/assistants/example.yaml")
COMMAND = ["-m", "babyrobot_levels", "mcp"]
ENVIRONMENT = {"PYTHONPATH": str(ROOT)}


@asynccontextmanager
async def client(*options: str) -> AsyncIterator[Any]:
    from mcp import Client, StdioServerParameters, stdio_client

    server = StdioServerParameters(
        command=sys.executable, args=[*COMMAND, *options], env=ENVIRONMENT
    )
    async with Client(stdio_client(server)) as connected:
        yield connected


def text_of(result: Any) -> str:
    assert result.content[0].type == "text"
    return str(result.content[0].text)


def test_an_assistant_goes_from_a_brief_to_a_clean_level() -> None:
    async def talk() -> None:
        async with client() as server:
            answer = await server.list_tools()
            assert (answer.ttl_ms, answer.cache_scope) == (3_600_000, "public")
            listed = answer.tools
            names = {name for name in vars(Tools) if not name.startswith("_")}
            assert {tool.name for tool in listed} == names
            for tool in listed:
                assert tool.description
                assert tool.output_schema
            call = server.call_tool
            assert "## Traps" in text_of(await call("language_reference", {}))
            draft = EXAMPLE.replace("best_steps: 12..16", "best_steps: 20")
            found = await call("check", {"level": draft})
            assert not found.structured_content["is_clean"]
            assert "BR540" in text_of(found)
            assert "is 14" in found.structured_content["findings"][0]["message"]
            assert "Example" in text_of(await call("explain_rule", {"code": "BR540"}))
            assert (await call("check", {"level": EXAMPLE})).structured_content["is_clean"]
            solved = await call("solve", {"level": EXAMPLE})
            assert solved.structured_content["expected_return"] == pytest.approx(-7)
            picture = (await call("preview", {"level": EXAMPLE})).content[1]
            assert (picture.type, picture.mime_type) == ("image", "image/png")
            measured = await call("metrics", {"level": EXAMPLE})
            assert measured.structured_content["metrics"]["needs"] == ["key"]
            made = await call("generate", {"keys": 1, "coins": "1..2", "seed": 3})
            assert brl.loads(made.structured_content["levels"][0]).items
            page = await call("format", {"level": made.structured_content["levels"][0]})
            assert brl.loads(text_of(page)).items
            begun = await call("play_start", {"level": EXAMPLE, "seed": 1})
            play = begun.structured_content["play"]
            moved = await call("play_move", {"play": play, "move": "north"})
            assert moved.structured_content["total"] == -1
            sight = {"level": EXAMPLE, "seed": 1, "sight": "picture"}
            text, seen = (await call("play_start", sight)).content
            assert text.text.endswith("The picture shows what is where.\nheld: nothing")
            assert (seen.type, seen.mime_type) == ("image", "image/png")

    asyncio.run(talk())


def test_a_play_goes_on_in_another_connection() -> None:
    """No session is needed, by the protocol's present version and by the one before."""

    async def talk() -> None:
        from mcp import Client

        server = brl.mcp()
        async with Client(server) as first:
            assert first.protocol_version == "2026-07-28"
            begun = await first.call_tool("play_start", {"level": "first-key", "seed": 1})
            tools = [tool.name for tool in (await first.list_tools()).tools]
        async with Client(server, mode="legacy") as second:
            assert second.protocol_version == "2025-11-25"
            assert [tool.name for tool in (await second.list_tools()).tools] == tools
            play = begun.structured_content["play"]
            moved = await second.call_tool("play_move", {"play": play, "move": "north"})
            assert moved.structured_content["total"] == -1

    asyncio.run(talk())


def test_what_is_wrong_is_answered_and_the_server_goes_on(tmp_path: Path) -> None:
    async def talk() -> None:
        async with client("--folder", str(tmp_path)) as server:
            wrong: list[tuple[str, dict[str, Any]]] = [
                ("check", {"level": "/etc/hosts"}),
                ("check", {"level": "../outside.yaml"}),
                ("check", {"level": 3}),
                ("check", {}),
                ("check", {"level": "x" * (1 << 21)}),
                ("format", {"level": "version: 2\n"}),
                ("format", {"level": EXAMPLE, "save": "../outside.yaml"}),
                ("generate", {"count": 1000}),
                ("play_move", {"play": "none", "move": "north"}),
                ("solve", {"level": "version: 1\nsize: [4, 4]\n", "discount": 7}),
                ("play_start", {"level": EXAMPLE, "within": 10**9}),
                ("_source", {"given": EXAMPLE}),
            ]
            for tool, arguments in wrong:
                result = await server.call_tool(tool, arguments)
                assert result.is_error, (tool, arguments)
                assert "Traceback" not in text_of(result)
                assert text_of(result) != f"Error executing tool {tool}"
            assert not (await server.call_tool("check", {"level": EXAMPLE})).is_error
        assert [*tmp_path.iterdir()] == []

    asyncio.run(talk())


def test_a_call_that_takes_too_long_is_ended() -> None:
    large = "version: 1\nsize: [1024, 300]\nskid: 0.3\ndiscount: 0.999\n"

    async def talk() -> None:
        async with client("--seconds", "1") as server:
            result = await server.call_tool("solve", {"level": large})
            assert result.is_error
            assert "not done within 1 seconds" in text_of(result)
            page = await server.call_tool("format", {"level": "version: 1\n"})
            assert not page.is_error

    asyncio.run(talk())


def test_each_request_is_answered() -> None:
    """Also those with halves of surrogate pairs, which no answer can hold, and unreadable ones."""
    texts = ["\ud800", "\udfff: \ud83e\udd16", "\\ud800", "a\x00", "\U0001f916"]
    calls: list[dict[str, Any]] = [
        *({"name": "check", "arguments": {"level": text}} for text in texts),
        *({"name": "check", "arguments": {text: "version: 1"}} for text in texts),
        *({"name": text, "arguments": {}} for text in texts),
        *({"name": "explain_rule", "arguments": {"code": text}} for text in texts),
        *({"name": "play_move", "arguments": {"play": "x", "move": text}} for text in texts),
        {"name": "format", "arguments": {"level": "version: 1\ntitle: \ud800\U0001f916\n"}},
        {"name": "solve", "arguments": {"level": "version: 1", "discount": float("nan")}},
    ]
    lines = [
        json.dumps({"jsonrpc": "2.0", "id": number, "method": "tools/call", "params": call})
        for number, call in enumerate(calls)
    ]
    parameters = ['{"level": ' + 3000 * "[" + 3000 * "]" + "}", '{"within": 1' + 5000 * "0" + "}"]
    lines += [
        f'{{"jsonrpc": "2.0", "id": "{number}", "method": "tools/call", "params": {text}}}'
        for number, text in enumerate(parameters)
    ]
    hello = {
        "protocolVersion": "2025-06-18",
        "capabilities": {},
        "clientInfo": {"name": "x", "version": "1"},
    }
    first = {"jsonrpc": "2.0", "id": "hello", "method": "initialize", "params": hello}
    process = subprocess.Popen(
        [sys.executable, *COMMAND],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        env={**os.environ, **ENVIRONMENT},
        encoding="utf-8",
    )
    with process:
        assert process.stdin is not None
        assert process.stdout is not None
        answers = {}
        for line in [json.dumps(first), *lines]:
            process.stdin.write(line + "\n")
            process.stdin.flush()
            answer = json.loads(process.stdout.readline())
            answers[answer["id"]] = answer
        process.stdin.close()
    assert answers.keys() == {"hello", *range(len(calls)), "0", "1"}
    assert answers[len(calls) - 2]["result"]["structuredContent"]["text"].count("\ufffd") == 1
    assert "\U0001f916" in answers[len(calls) - 2]["result"]["structuredContent"]["text"]
    assert "error" in answers["0"]


def test_strangers_on_the_pipe_change_nothing() -> None:
    lines = [
        "",
        "garbage",
        "[" * 5000,
        "{}",
        json.dumps({"jsonrpc": "2.0", "id": 1, "method": "x"}),
    ]
    done = subprocess.run(
        [sys.executable, *COMMAND],
        input="\n".join([*lines, "x" * 3_000_000, ""]).encode() + b"\xff\xfe\n",
        env={**os.environ, **ENVIRONMENT},
        capture_output=True,
        timeout=60,
        check=False,
    )
    assert done.returncode == 0
    assert b"Traceback" not in done.stderr
    for line in done.stdout.splitlines():
        assert "error" in json.loads(line)


@pytest.mark.skipif(sys.platform == "win32", reason="has no such signals")
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_the_server(number: signal.Signals) -> None:
    with subprocess.Popen(
        [sys.executable, *COMMAND],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        env={**os.environ, **ENVIRONMENT},
    ) as process:
        assert process.stdin
        assert process.stdout
        process.stdin.write(b'{"jsonrpc": "2.0", "id": 1, "method": "ping"}\n')
        process.stdin.flush()
        assert process.stdout.readline()
        process.send_signal(number)
        assert process.wait(timeout=20) == 128 + number
        assert process.stderr
        assert b"Traceback" not in process.stderr.read()


def test_a_folder_that_is_not_there_is_refused(tmp_path: Path) -> None:
    with pytest.raises(NotADirectoryError, match="no folder"):
        brl.mcp(tmp_path / "nowhere")
