"""verifiers plays levels with a model behind a server, and records their exact rewards."""

from __future__ import annotations

import json
import os
import sysconfig
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread
from typing import Any

import pytest
from support.places import EXAMPLES
from support.subprocesses import python

import babyrobot_levels as brl
from babyrobot_levels.extensions.scoring.conversations import content_of

REPLIES = ("south", "to the left", "East")


class Model(BaseHTTPRequestHandler):
    """A model that gives these replies, one after the other, in a stream."""

    asked: list[list[dict[str, Any]]]

    def do_POST(self) -> None:
        body = json.loads(self.rfile.read(int(self.headers["Content-Length"])))
        assert (self.path, body["stream"]) == ("/v1/chat/completions", True)
        messages = body["messages"]
        self.asked.append(messages)
        turn = sum(each["role"] == "assistant" for each in messages)
        said = {"role": "assistant", "content": REPLIES[turn]}
        choices: list[dict[str, Any]] = [
            {"index": 0, "delta": said, "finish_reason": None},
            {"index": 0, "delta": {}, "finish_reason": "stop"},
        ]
        self.send_response(200)
        self.send_header("Content-Type", "text/event-stream")
        self.end_headers()
        for choice in choices:
            part = {"id": "1", "object": "chat.completion.chunk", "created": 0, "model": "tiny"}
            self.wfile.write(f"data: {json.dumps({**part, 'choices': [choice]})}\n\n".encode())
        self.wfile.write(b"data: [DONE]\n\n")

    def log_message(self, *_: Any) -> None:
        """Say nothing."""


@pytest.fixture
def server() -> Iterator[ThreadingHTTPServer]:
    Model.asked = []
    with ThreadingHTTPServer(("127.0.0.1", 0), Model) as found:
        Thread(target=found.serve_forever, daemon=True).start()
        yield found
        found.shutdown()


def test_a_model_that_sees_plays_a_level(
    server: ThreadingHTTPServer, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # verifiers starts the program that asks the model by uv.
    monkeypatch.setenv("PATH", os.pathsep.join([sysconfig.get_path("scripts"), os.environ["PATH"]]))
    done = python(
        EXAMPLES / "play_verifiers.py",
        *("--model", "tiny", "--client.base-url", f"http://127.0.0.1:{server.server_port}/v1"),
        *("-n", "1", "--env.taskset.sight", "picture", "--env.player.max-turns", str(len(REPLIES))),
        *("--no-push", "--no-rich", "--output-dir", str(tmp_path / "runs")),
        cwd=tmp_path,
        timeout=300,
        warnings="default",
    )
    assert done.returncode == 0, done.stderr[-3000:]
    (file,) = tmp_path.glob("runs/*/traces.jsonl")
    (trace,) = json.loads(file.read_text("utf-8"))["traces"]
    level = brl.load_suite("text-easy").split("validation")[0]
    world = brl.TextWorld(level, sight="picture", reward="advantage")
    told = [content_of(world.reset(seed=0), world.data_url)]
    told += [content_of(world.move(reply), world.data_url) for reply in REPLIES]
    assert [each["content"] for each in Model.asked[-1] if each["role"] == "user"] == told[:-1]
    while not world.done:
        world.wait()
    assert world.reward < 0
    assert trace["rewards"]["advantage"]["score"] == pytest.approx(world.reward)
    assert trace["metrics"] == {"success": 0, "invalid": 1}
