"""What others may try: programs of this machine, pages of the browser, and files of strangers."""

from __future__ import annotations

import http.client
import json
import socket
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Event, Thread
from typing import Any
from urllib.parse import urlsplit

import pytest
from playwright.sync_api import Browser, Page, expect
from support.editors import OpenEditor, is_shown, served
from support.jupyter import until

from babyrobot_levels.extensions.editor import answers
from babyrobot_levels.extensions.editor.protocol import answer, prepare
from babyrobot_levels.extensions.editor.server import MAX_BODY
from babyrobot_levels.extensions.editor.session import EditedFile, Session
from babyrobot_levels.library.level import Level

TEXT = "version: 1\nsize: [3, 2]\nstart: [0, 0]\nexit: [2, 1]\n"
JSON = {"Content-Type": "application/json"}
TYPED = json.dumps({"id": 1, "do": "text", "text": "gone", "revision": 1}).encode()

Serve = Callable[[Session], str]


class Client:
    """Sends requests to a server as no browser would."""

    def __init__(self, address: str) -> None:
        parts = urlsplit(address)
        assert parts.hostname
        assert parts.port
        self.host, self.port, self.path = parts.hostname, parts.port, parts.path

    def ask(
        self, method: str, path: str, body: Any = None, **headers: str
    ) -> http.client.HTTPResponse:
        """Send a request; `path` is as it is sent. The response has been read."""
        connection = http.client.HTTPConnection(self.host, self.port, timeout=20)
        named = {name.replace("_", "-"): value for name, value in headers.items()}
        try:
            connection.putrequest(method, path, skip_host="Host" in named)
            if isinstance(body, bytes):
                named.setdefault("Content-Length", str(len(body)))
            for name, value in named.items():
                connection.putheader(name, value)
            connection.endheaders(body, encode_chunked=not isinstance(body, bytes | None))
            response = connection.getresponse()
            self.content = response.read()
            return response
        finally:
            connection.close()

    def post(self, body: bytes, **headers: str) -> http.client.HTTPResponse:
        """Send a message."""
        named = {"Content_Type": "application/json", **headers}
        return self.ask("POST", f"{self.path}message", body, **named)


@pytest.fixture
def session() -> Session:
    return Session(TEXT)


@pytest.fixture(scope="module")
def served_client() -> Iterator[Client]:
    with served(Session(TEXT)) as address:
        yield Client(address)


@pytest.fixture
def client(served_client: Client) -> Iterator[Client]:
    """A client of a server, which after each test still answers, with the text as it was."""
    yield served_client
    assert served_client.post(b'{"id": 1, "do": "state"}').status == 200
    assert json.loads(served_client.content)["state"]["text"] == TEXT


@pytest.mark.slow
def test_saving_does_not_wait_for_the_optimum(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(answers, "BUDGET", 0.0)
    begun, go_on = Event(), Event()
    usual = answers.solved

    def slow(level: Level) -> answers.Optimum:
        begun.set()
        assert go_on.wait(20)
        return usual(level)

    monkeypatch.setattr(answers, "solved", slow)
    file = EditedFile(tmp_path / "level.yaml")
    with served(Session(TEXT, file=file)) as address, ThreadPoolExecutor(3) as threads:

        def send(**message: Any) -> dict[str, Any]:
            own = Client(address)
            own.post(json.dumps({"id": 1, **message}).encode())
            reply: dict[str, Any] = json.loads(own.content)
            return reply

        questions: dict[str, dict[str, Any]] = {
            "answers": {},
            "policy": {"actions": [0] * 6},
            "copy": {"form": "link"},
        }
        waiting = [
            threads.submit(send, do=do, revision=1, **more) for do, more in questions.items()
        ]
        assert begun.wait(20)
        try:
            reply = send(do="text", text=TEXT + "max_steps: 90000000\n", revision=1)
            assert reply["state"]["answers"]["status"] == "pending"
            assert send(do="save", revision=2)["state"]["is_saved"]
            assert (tmp_path / "level.yaml").read_text("utf-8").endswith("90000000\n")
            assert send(do="undo", revision=2)["step"] == "text"
            # Those that begin after the text has changed are answered at once.
            assert not all(each.done() for each in waiting[:2])
        finally:
            go_on.set()


@pytest.mark.slow
def test_what_there_is_is_told_while_a_change_is_made(monkeypatch: pytest.MonkeyPatch) -> None:
    begun, go_on = Event(), Event()

    def slow(*_: Any, **__: Any) -> None:
        begun.set()
        assert go_on.wait(20)

    opened = Session(TEXT)
    monkeypatch.setattr(opened, "type", slow)
    before = answer(opened, {"do": "state"})
    with served(opened) as address, ThreadPoolExecutor(1) as threads:
        message = json.dumps({"id": 1, "do": "text", "text": "a", "revision": 1}).encode()
        waiting = threads.submit(Client(address).post, message)
        assert begun.wait(20)
        try:
            filled = {"do": "filled", "cell": [1, 1], "as": "blocked"}
            for question in ({"do": "levels"}, filled, {"do": "state"}):
                client = Client(address)
                assert client.post(json.dumps({"id": 2, **question}).encode()).status == 200
                assert json.loads(client.content)["id"] == 2
            assert json.loads(client.content)["state"]["number"] == before["state"]["number"]
            assert not waiting.done()
        finally:
            go_on.set()


@pytest.mark.slow
def test_a_change_is_taken_however_much_the_level_comes_to() -> None:
    session = Session(TEXT)
    text = "version: 1\nsize: [30, 30]\nmovers: [{within: {at: [0, 0], size: [30, 30]}}]\n"
    reply = answer(session, {"id": 1, "do": "text", "text": text, "revision": session.revision})
    assert reply["state"]["is_valid"]
    message = {"id": 2, "do": "answers", "revision": session.revision}
    assert prepare(session, message) is None
    reply = answer(session, message)
    for told in (reply["state"]["too_large"], reply["state"]["answers"]["reason"]):
        assert told.startswith("the level has 810,000 states, and 4 or more outcomes of an action")


# -- programs of this machine ----------------------------------------------------------------


def test_it_listens_on_one_address_of_this_machine_only(client: Client) -> None:
    with socket.socket() as other, pytest.raises(OSError, match="refused"):
        other.connect(("127.0.0.2", client.port))


@pytest.mark.parametrize("path", ["/", "/message", "/wrong/message", "/%00/"])
def test_nothing_is_found_without_the_token(client: Client, path: str) -> None:
    for method in ("GET", "POST"):
        assert client.ask(method, path, TYPED, Content_Type="application/json").status == 404
        assert client.path.strip("/").encode() not in client.content


@pytest.mark.parametrize(
    "path",
    ["../../../etc/passwd", "..%2f..%2fetc%2fpasswd", "stage.js", "editor.css/../../server.py"],
)
def test_no_other_file_is_served(client: Client, path: str) -> None:
    assert client.ask("GET", client.path + path).status == 404


def test_the_files_of_the_page_are_served_with_a_strict_policy(client: Client) -> None:
    for name, kind in (
        ("", "text/html"),
        ("editor.js", "text/javascript"),
        ("editor.css", "text/css"),
    ):
        response = client.ask("GET", client.path + name)
        assert response.status == 200
        assert response.headers.get_content_type() == kind
        assert_is_closed(response)


def assert_is_closed(response: http.client.HTTPResponse) -> None:
    """The headers that every response has."""
    policy = response.headers["Content-Security-Policy"]
    assert "default-src 'none'" in policy
    assert "unsafe" not in policy
    assert "frame-ancestors 'none'" in policy
    assert response.headers["X-Content-Type-Options"] == "nosniff"
    assert response.headers["Referrer-Policy"] == "no-referrer"
    assert response.headers["Cache-Control"] == "no-store"
    assert not [name for name in response.headers if name.lower().startswith("access-control")]


# -- pages of the browser, as the server sees them -------------------------------------------


@pytest.mark.parametrize("host", ["evil.example:{port}", "localhost", "[::1]:{port}", ""])
def test_a_foreign_host_gets_nothing(client: Client, host: str) -> None:
    named = host.format(port=client.port)
    for name in ("", "editor.js"):
        response = client.ask("GET", client.path + name, Host=named)
        assert response.status in (400, 421)
        assert b"<div" not in client.content
    assert client.post(TYPED, Host=named).status in (400, 421)


@pytest.mark.parametrize(
    "headers",
    [
        {"Origin": "http://evil.example"},
        {"Origin": "http://localhost:{port}"},
        {"Sec_Fetch_Site": "cross-site"},
        {"Sec_Fetch_Site": "none"},
    ],
)
def test_a_message_of_another_page_is_refused(client: Client, headers: dict[str, str]) -> None:
    named = {name: value.format(port=client.port) for name, value in headers.items()}
    response = client.post(TYPED, **named)
    assert response.status == 403
    assert_is_closed(response)


@pytest.mark.parametrize("kind", ["text/plain", ""])
def test_what_a_form_can_send_is_refused(client: Client, kind: str) -> None:
    assert client.post(TYPED, Content_Type=kind).status == 415


def test_other_origins_are_told_that_they_may_not_ask(client: Client) -> None:
    response = client.ask(
        "OPTIONS",
        f"{client.path}message",
        Origin="http://evil.example",
        Access_Control_Request_Method="POST",
    )
    assert response.status == 403
    assert_is_closed(response)
    assert client.ask("GET", f"{client.path}message").status == 405


# -- messages ---------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "body",
    [
        b"{",
        b"[]",
        b'{"id": NaN, "do": "state"}',
        b'{"id": \xff}',
        b"[" * 500_000,
        b'{"id": 1' + b"0" * 100_000 + b"}",
    ],
    ids=lambda body: repr(body[:20]),
)
def test_a_malformed_message_is_refused(client: Client, body: bytes) -> None:
    assert client.post(body).status == 400


@pytest.mark.parametrize("number", [b"1e999", b'"\\ud800"'])
def test_what_no_reply_can_repeat_is_refused_in_a_sentence(client: Client, number: bytes) -> None:
    assert client.post(b'{"do": "levels", "id": ' + number + b"}").status == 200
    assert json.loads(client.content)["error"]


def test_a_client_that_goes_away_amid_a_message_leaves_no_traceback(
    client: Client, caplog: pytest.LogCaptureFixture
) -> None:
    head = f"POST {client.path}message HTTP/1.1\r\nHost: {client.host}:{client.port}\r\n"
    with socket.create_connection((client.host, client.port)) as connection:
        connection.sendall(f"{head}Content-Type: application/json\r\n".encode())
        connection.sendall(b'Content-Length: 99\r\n\r\n{"id"')
    assert client.post(b'{"id": 1, "do": "state"}').status == 200
    assert caplog.records == []


def test_a_message_that_is_too_large_is_not_read_to_its_end(client: Client) -> None:
    assert client.post(b" " * (MAX_BODY + 1)).status == 413

    def endless() -> Iterator[bytes]:
        for _ in range(2 * MAX_BODY // 65536):
            yield b" " * 65536

    headers = {"Content_Type": "application/json", "Transfer_Encoding": "chunked"}
    assert client.ask("POST", f"{client.path}message", endless(), **headers).status == 413


@pytest.mark.slow
@pytest.mark.parametrize(
    "fields",
    [
        {},
        {"do": ["state"]},
        {"do": "eval", "text": "1"},
        {"do": "text", "text": 7},
        {"do": "text", "text": "\ud800"},
        {"do": "text", "text": "a" * ((1 << 20) + 1)},
        {"do": "open", "source": "brl1." + "9" * 5000},
        {"do": "open", "source": "SFFG", "format": ["frozen-lake"]},
        {"do": "save", "path": "/tmp/elsewhere.yaml"},
        {"do": "copy", "form": ["yaml"]},
        {"do": "copy", "form": "__init__"},
        {"do": "policy", "actions": {"a": [{}]}},
        {"do": "paint", "brush": "small", "cells": [[-1, 0]]},
        {"do": "paint", "brush": "item", "cells": [[0, 0]], "fields": {"name": "\ud800"}},
        {"do": "set", "route": ["__class__"], "value": "x"},
        {"do": "set", "route": ["title", 10**30], "value": "x"},
        {"do": "set", "route": ["size"], "value": [10**400, 1]},
        {"do": "move", "route": ["start", 99], "from": [0, 0], "to": [1, 1]},
        {"do": "resize", "size": [1024, 1024], "shift": [10**9, -(10**9)]},
        {"do": "fix", "code": "BR101", "line": -1, "column": 10**30},
    ],
    ids=lambda fields: str(fields)[:60],
)
def test_a_message_that_makes_no_sense_is_refused_in_a_sentence(
    session: Session, fields: dict[str, Any]
) -> None:
    reply = answer(session, {"id": 1, "revision": session.revision, **fields})
    assert 0 < len(reply["error"]) < 500
    assert "\n" not in reply["error"]
    assert session.text == TEXT
    json.dumps(reply, ensure_ascii=False, allow_nan=False).encode()


@pytest.mark.parametrize("revision", [0, None, "1"])
def test_a_message_about_another_text_is_refused(session: Session, revision: object) -> None:
    reply = answer(session, {"id": 1, "do": "text", "text": "gone", "revision": revision})
    assert "elsewhere" in reply["error"]
    assert reply["state"]["text"] == TEXT


@pytest.mark.slow
def test_a_level_that_is_too_large_for_a_picture_is_edited_as_text() -> None:
    text = "version: 1\nsize: [1024, 1024]\nstart: [0, 0]\nexit: [1023, 1023]\n"
    began = time.monotonic()
    session = Session(text)
    state = answer(session, {"id": 1, "do": "state"})["state"]
    assert state["level"] is None
    assert "too large" in state["too_large"]
    assert "link" not in answer(session, {"id": 1, "do": "copy", "form": "link"})
    titled = f"{text}title: Large\n"
    assert answer(session, {"id": 1, "do": "text", "text": titled, "revision": 1})["state"][
        "is_valid"
    ]
    smaller = text.replace("1024", "24").replace("1023", "23")
    reply = answer(session, {"id": 2, "do": "text", "text": smaller, "revision": 2})
    # The proofs of the linter would take longer.
    assert time.monotonic() - began < 8
    assert reply["state"]["level"]["width"] == 24


# -- pages of the browser --------------------------------------------------------------------

ATTACK = """<!doctype html><title>attack</title>
<form id="form" method="post" enctype="text/plain" target="framed" action="TARGETmessage">
<input name='{"id": 1, "do": "text", "revision": 1, "text": "gone", "a": "' value='"}'></form>
<iframe name="framed" src="TARGET"></iframe>
<script type="module">
const found = {};
const attempt = async (name, action) => {
  try { found[name] = String(await action()); } catch (error) { found[name] = "failed"; }
};
const body = JSON.stringify({ id: 1, do: "text", revision: 1, text: "gone" });
const post = async (options) =>
  (await fetch("TARGETmessage", { method: "POST", body, ...options })).text();
await attempt("read", async () => (await fetch("TARGET")).text());
await attempt("json", () => post({ headers: { "Content-Type": "application/json" } }));
await attempt("plain", () => post({ mode: "no-cors" }));
await attempt("beacon", () => navigator.sendBeacon("TARGETmessage", body));
await attempt("script", () => import("TARGETeditor.js"));
await attempt("image", () => new Promise((resolve, reject) => {
  const image = new Image();
  image.onload = () => resolve("loaded");
  image.onerror = reject;
  image.src = "TARGETeditor.css";
}));
document.querySelector("#form").submit();
setTimeout(() => {
  const frame = document.querySelector("iframe");
  found.frame = frame.contentDocument === null ? "failed" : frame.contentDocument.title;
  document.title = JSON.stringify(found);
}, 1000);
</script>
"""  # fmt: skip


@contextmanager
def attacking(target: str) -> Iterator[str]:
    """Serve a page that tries to read and to write an editor; yield its port."""

    class Handler(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            self.send_response(200)
            self.send_header("Content-Type", "text/html; charset=utf-8")
            self.end_headers()
            self.wfile.write(ATTACK.replace("TARGET", target).encode())

        def log_message(self, format: str, *args: object) -> None:  # noqa: A002
            pass

    server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    thread = Thread(target=server.serve_forever)
    thread.start()
    try:
        yield str(server.server_port)
    finally:
        server.shutdown()
        server.server_close()
        thread.join(20)


@pytest.mark.slow
@pytest.mark.parametrize("host", ["127.0.0.1", "rebound.test"])
def test_another_page_can_neither_read_nor_write(
    host: str, page: Page, session: Session, serve: Serve
) -> None:
    # It even knows the address.
    with attacking(serve(session)) as port:
        page.goto(f"http://{host}:{port}/")
        found = json.loads(until(lambda: page.title() if "{" in page.title() else None, "it ends"))
    # That something was sent is all that a page is told.
    found.pop("beacon")
    assert set(found.values()) == {"failed"}
    assert session.text == TEXT


HOSTILE = (
    "]]></script><img src=x onerror=document.title='attacked'>"
    "<script>document.title='attacked'</script>"
)


@pytest.mark.slow
def test_texts_of_levels_are_shown_and_not_run(editor_page: OpenEditor) -> None:
    quoted = json.dumps(HOSTILE)
    text = TEXT + f"title: {quoted}\ndescription: {quoted}\nitems:\n  - {{name: key, at: [1, 1]}}\n"
    editor = editor_page(text)
    assert HOSTILE in editor.page.title()
    assert editor.page.locator(".bar").get_by_text(HOSTILE).count() == 1
    for bad in (f"{quoted}: 1\n", f"heading: {quoted}\n"):
        editor.page.get_by_role("textbox", name="Level file").fill(TEXT + bad)
        until(lambda bad=bad: editor.session.text == TEXT + bad, "it is typed")  # type: ignore[misc]
        editor.page.get_by_role("tab", name="Findings").click()
        editor.page.locator(".findings").get_by_text("<img src=x").first.wait_for()
    assert editor.page.locator("img[src='x']").count() == 0
    assert "attacked" not in editor.page.title().replace(HOSTILE, "")


@pytest.mark.slow
def test_two_tabs_do_not_overwrite_each_other(browser: Browser, editor_page: OpenEditor) -> None:
    editor = editor_page(TEXT)
    other = editor.page.context.new_page()
    other.goto(editor.address)
    is_shown(other)
    name = "Level file"
    editor.page.get_by_role("textbox", name=name).fill(TEXT + "max_steps: 7\n")
    until(lambda: "max_steps: 7" in editor.session.text, "the first tab has changed it")
    area = other.get_by_role("textbox", name=name)
    area.fill(TEXT + "max_steps: 8\n")
    until(lambda: "elsewhere" in other.locator(".said").inner_text(), "the second one is told")
    assert editor.session.text == TEXT + "max_steps: 7\n"
    other.locator(".stage").focus()
    until(lambda: "max_steps: 7" in area.input_value(), "and shows what there is now")


@pytest.mark.slow
def test_without_its_server_the_page_says_so_and_keeps_the_text(editor_page: OpenEditor) -> None:
    editor = editor_page(TEXT)
    page = editor.page
    page.context.set_offline(True)
    area = page.get_by_role("textbox", name="Level file")
    area.fill(TEXT + "max_steps: 7\n")
    expect(page.locator(".said")).to_contain_text("cannot be reached")
    assert area.input_value() == TEXT + "max_steps: 7\n"
