"""Firefox, driven by WebDriver BiDi, the protocol that it speaks without anything in between.

Playwright's Firefox is one of its own making. This is the one that people have.
"""

from __future__ import annotations

import base64
import json
import os
import re
import shutil
import subprocess
import time
from collections import deque
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Literal

from websockets.sync.client import ClientConnection, connect

PREFERENCES = {
    # Nothing but this machine answers.
    "network.proxy.type": 1,
    "network.proxy.socks": "127.0.0.1",
    "network.proxy.socks_port": 9,
    "network.proxy.socks_remote_dns": True,
    "ui.prefersReducedMotion": 1,
    # A mouse, which is fine and can hover: without a window there would be none.
    "ui.allPointerCapabilities": 6,
    "ui.primaryPointerCapabilities": 6,
}
SCHEME = "layout.css.prefers-color-scheme.content-override"
EVENTS = ["log.entryAdded", "network.beforeRequestSent", "network.fetchError"]
PATIENCE = 20.0
"""Seconds within which what is waited for comes."""

KEYS = {
    "ArrowUp": "\ue013",
    "ArrowDown": "\ue015",
    "ArrowLeft": "\ue012",
    "ArrowRight": "\ue014",
    "Control": "\ue009",
    "Enter": "\ue007",
    "Escape": "\ue00c",
}
"""Keys without a character, as WebDriver writes them."""

ALL = """const all = (css, root = document) => [
    ...root.querySelectorAll(css),
    ...[...root.querySelectorAll('*')].flatMap((e) => e.shadowRoot ? all(css, e.shadowRoot) : []),
];
const seen = (css) => all(css).filter((each) => each.checkVisibility());
"""
"""What functions can call: elements of a page, also in shadow trees, and those that are seen."""

PLACE = """(css, text) => {
    const found = seen(css).find((each) => each.textContent.trim().startsWith(text));
    if (!found) return null;
    found.scrollIntoView({block: 'center', behavior: 'instant'});
    const box = found.getBoundingClientRect();
    return [box.x + box.width / 2, box.y + box.height / 2];
}"""


class FirefoxError(Exception):
    """What was asked of Firefox cannot be done."""


@contextmanager
def firefox(folder: Path, scheme: Literal["light", "dark"] = "light") -> Iterator[Firefox]:
    """Start the Firefox of the system without a window; end it after the block.

    Args:
        folder: an empty folder for what it writes down.
        scheme: the colours that the user prefers.
    """
    program = shutil.which("firefox-esr") or shutil.which("firefox")
    if program is None:
        raise FirefoxError("no Firefox; `bash scripts/browser.sh` installs one")
    preferences = PREFERENCES | {SCHEME: ("dark", "light").index(scheme)}
    lines = [f'user_pref("{name}", {json.dumps(value)});' for name, value in preferences.items()]
    (folder / "user.js").write_text("\n".join(lines), encoding="utf-8")
    call = [program, "--headless", "--no-remote", "--profile", str(folder)]
    log, environment = folder / "log.txt", {**os.environ, "HOME": str(folder)}
    with log.open("w") as output:
        process = subprocess.Popen(
            [*call, "--remote-debugging-port=0"], env=environment, stdout=output, stderr=output
        )
        try:
            address = f"{_address(process, log)}/session"
            with connect(address, max_size=None, ping_interval=None, proxy=None) as connection:
                yield Firefox(connection)
        finally:
            process.terminate()
            try:
                process.wait(30)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()


def _address(process: subprocess.Popen[bytes], log: Path) -> str:
    end = time.monotonic() + 60
    while time.monotonic() < end and process.poll() is None:
        if told := re.search(r"listening on (ws://\S+)", log.read_text("utf-8", "replace")):
            return told[1]
        time.sleep(0.05)
    raise FirefoxError(f"Firefox does not start:\n{log.read_text('utf-8', 'replace')}")


class Firefox:
    """A Firefox that runs.

    Args:
        connection: the one to its WebDriver BiDi.
    """

    def __init__(self, connection: ClientConnection) -> None:
        self._connection = connection
        self._asked = 0
        self._events: deque[dict[str, Any]] = deque()
        session = self.ask("session.new", capabilities={})
        self.version = str(session["capabilities"]["browserVersion"])
        self.ask("session.subscribe", events=EVENTS)

    def ask(self, method: str, **parameters: Any) -> dict[str, Any]:
        """Send a command, and return its result; what happens meanwhile is kept."""
        self._asked += 1
        command = {"id": self._asked, "method": method, "params": parameters}
        self._connection.send(json.dumps(command))
        while (answer := self._next()).get("id") != self._asked:
            self._events.append(answer)
        if answer["type"] == "error":
            raise FirefoxError(f"{method}: {answer['error']}: {answer['message']}")
        result: dict[str, Any] = answer["result"]
        return result

    def _next(self) -> dict[str, Any]:
        answer: dict[str, Any] = json.loads(self._connection.recv(60))
        return answer

    def page(self, width: int = 1280, height: int = 900) -> FirefoxPage:
        """Open an empty page that has neither history nor storage."""
        user = self.ask("browser.createUserContext")["userContext"]
        name = self.ask("browsingContext.create", type="tab", userContext=user)["context"]
        size = {"width": width, "height": height}
        self.ask("browsingContext.setViewport", context=name, viewport=size, devicePixelRatio=1)
        return FirefoxPage(self, name)

    def faults(self) -> list[str]:
        """Return what pages complained of and asked of others, since this was called last."""
        self.ask("session.status")
        events, self._events = self._events, deque()
        return [fault for event in events if (fault := _fault(event))]


def _fault(event: dict[str, Any]) -> str | None:
    told = event["params"]
    match event["method"]:
        case "log.entryAdded" if told["level"] in ("warn", "error"):
            return f"{told['level']}: {told['text']}"
        # A page that is left need not wait for answers.
        case "network.fetchError" if told["errorText"] != "NS_BINDING_ABORTED":
            return f"{told['request']['url']}: {told['errorText']}"
        case "network.beforeRequestSent":
            address = str(told["request"]["url"])
            own = ("file:", "data:", "blob:", "about:", "http://127.0.0.1:")
            return None if address.startswith(own) else f"asks for {address}"
    return None


class FirefoxPage:
    """A page in Firefox.

    Args:
        firefox: where it is open.
        name: its name there.
    """

    def __init__(self, firefox: Firefox, name: str) -> None:
        self._firefox, self._name = firefox, name

    def _ask(self, method: str, **parameters: Any) -> dict[str, Any]:
        return self._firefox.ask(method, context=self._name, **parameters)

    def open(self, address: str) -> None:
        """Go to an address, and wait until all is loaded."""
        self._ask("browsingContext.navigate", url=address, wait="complete")

    def run(self, function: str, *arguments: Any) -> Any:
        """Return what a function of JavaScript returns, as JSON can say it."""
        # Not subject to the page's content security policy, and unlike `eval` nothing it can see.
        told = self._firefox.ask(
            "script.callFunction",
            functionDeclaration="async (given) => {"
            f"{ALL} return JSON.stringify(await ({function})(...JSON.parse(given))) ?? 'null' }}",
            arguments=[{"type": "string", "value": json.dumps(arguments)}],
            target={"context": self._name},
            awaitPromise=True,
        )
        if told["type"] == "exception":
            raise FirefoxError(told["exceptionDetails"]["text"])
        return json.loads(told["result"]["value"])

    def until(self, condition: str, *arguments: Any) -> Any:
        """Wait until a function of JavaScript returns something true; return that."""
        end = time.monotonic() + PATIENCE
        while not (found := self.run(condition, *arguments)):
            if time.monotonic() > end:
                raise FirefoxError(f"not within {PATIENCE:g} seconds: {condition} {arguments}")
            time.sleep(0.03)
        return found

    def text(self, css: str) -> str:
        """Return the text of the first element of a selector that is seen."""
        return str(self.run("(css) => seen(css)[0]?.innerText ?? ''", css))

    def press(self, *keys: str) -> None:
        """Press keys, each by itself, or with `Control` as in "Control+z"."""
        for key in keys:
            held = [KEYS.get(each, each) for each in key.split("+")]
            down = [{"type": "keyDown", "value": each} for each in held]
            up = [{"type": "keyUp", "value": each} for each in reversed(held)]
            self._act({"type": "key", "id": "keys", "actions": down + up})

    def click(self, css: str, text: str = "") -> None:
        """Click the middle of the first element that is seen, of those whose text begins so."""
        self.drag(self.until(PLACE, css, text))

    def drag(self, *points: list[float]) -> None:
        """Press the mouse at the first point, and release it at the last; points of the window."""
        first, *others = ({"type": "pointerMove", "x": round(x), "y": round(y)} for x, y in points)
        way = [
            first,
            {"type": "pointerDown", "button": 0},
            *others,
            {"type": "pointerUp", "button": 0},
        ]
        self._act({"type": "pointer", "id": "mouse", "actions": way})

    def _act(self, source: dict[str, Any]) -> None:
        self._ask("input.performActions", actions=[source])

    def photograph(self) -> bytes:
        """Return what is seen as the bytes of a PNG file."""
        return base64.b64decode(self._ask("browsingContext.captureScreenshot")["data"])
