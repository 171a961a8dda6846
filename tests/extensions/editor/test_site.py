"""The editor as static files: Python runs in a real browser, with the network cut off."""

from __future__ import annotations

import hashlib
import json
import re
import shlex
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Browser, Locator, Page, expect
from support.firefox import firefox
from support.numberless import MESSAGES, NUMERIC, asked, replies, settled
from support.sites import StaticServer, hosted, runtime, stand_in

import babyrobot_levels as brl
from babyrobot_levels.extensions.editor.runtime import (
    CDN,
    DOWNLOAD,
    PLATFORM,
    TARBALL,
    RuntimeFileError,
    runtime_file,
    runtime_folder,
)
from babyrobot_levels.extensions.editor.site import SiteFolderError, write_site
from babyrobot_levels.extensions.editor.sources import session_of
from babyrobot_levels.language.looks import BUILTIN_THEMES
from babyrobot_levels.mdp.numeric import LIBRARIES

SIZE = {"width": 390, "height": 844}
PHONE: dict[str, Any] = {"viewport": SIZE, "has_touch": True, "is_mobile": True}
START = 60_000
"""How long Python may take to start on a busy machine, in milliseconds."""

TEXT = "version: 1\ntitle: Mine\nsize: [4, 3]\nstart: [0, 0]\nexit: [3, 2]\n"
WALLS = "walls:\n  - {at: [1, 0], side: E, length: 2}\n"
TWO_WALLS = "walls:\n  - {at: [1, 0], side: E}\n  - {at: [1, 1], side: E}\n"
ITEMS = ", ".join(f"{{name: i{n}, at: [{n % 128}, {1 + n // 128}]}}" for n in range(8_000))
SLOW = f"version: 1\nsize: [128, 128]\nitems: [{ITEMS}]\n"
"""A valid level that takes long to read."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    site = tmp_path_factory.mktemp("site") / "editor"
    write_site(site, session_of(None), runtime())
    return site


@pytest.fixture
def server(folder: Path) -> Iterator[StaticServer]:
    with hosted(folder) as started:
        yield started


Visit = Callable[..., Page]


@pytest.fixture
def visit(browser: Browser, server: StaticServer) -> Iterator[Visit]:
    """Opens the site: a function of what follows its address, and of options of the browser."""
    errors: list[str] = []
    with ExitStack() as stack:

        def opened(rest: str = "", **options: Any) -> Page:
            size = {"width": 1280, "height": 800}
            settings: dict[str, Any] = {"viewport": size, "accept_downloads": True} | options
            context = browser.new_context(**settings)
            stack.callback(context.close)
            context.set_default_timeout(20_000)
            page = context.new_page()
            page.on("pageerror", lambda error: errors.append(str(error)))
            page.goto(f"{server.address}{rest}")
            starts(page)
            return page

        yield opened
    assert errors == []


def starts(page: Page) -> None:
    """Wait until the level is seen."""
    expect(page).to_have_title(re.compile(" – editor$"), timeout=START)
    expect(page.locator(".stage > svg")).to_be_visible()


def cut_off(page: Page, server: StaticServer) -> None:
    """Wait until all is kept, and end the server."""
    page.evaluate("() => navigator.serviceWorker.ready.then(() => null)")
    server.stop()
    page.context.set_offline(True)


def text_of(page: Page) -> Locator:
    return page.locator("textarea.text")


def shared(page: Page, form: str) -> str:
    """Return a copy of the level, as the dialog shows it."""
    page.get_by_role("button", name="Copy or download").click()
    dialog = page.get_by_role("dialog", name="Copy the level")
    dialog.locator(f"[data-form={form}]").click()
    expect(dialog.locator(".copied")).not_to_have_value("")
    pattern = re.compile(r"#\S+$") if form == "link" else re.compile(r"^\S+$")
    expect(dialog.locator(".copied")).to_have_value(pattern)
    value = dialog.locator(".copied").input_value()
    dialog.get_by_label("Close").click()
    return value


def test_a_level_is_drawn_mended_saved_and_shared_offline(
    visit: Visit, server: StaticServer, tmp_path: Path
) -> None:
    page = visit()
    stage, text = page.locator(".stage"), text_of(page)
    for key in ("4", "ArrowRight", "ArrowRight", "Space"):
        stage.press(key)
    expect(text).to_have_value(re.compile(r"^blocked:", re.M))
    expect(page.locator(".file-state")).to_have_text("in this browser, not saved")
    # What is kept here is there again, its picture before Python is.
    cut_off(page, server)
    page.reload()
    picture = page.locator(".stage > img")
    expect(picture).to_be_visible()
    expect(page.locator(".notice")).to_contain_text("Starting Python")
    blocked = BUILTIN_THEMES["default"].colors.blocked.removeprefix("#")
    assert blocked in (picture.get_attribute("src") or "")
    starts(page)
    expect(picture).to_have_count(0)
    expect(page.locator(".notice")).to_be_empty()
    expect(text).to_have_value(re.compile(r"^blocked:", re.M))
    for key in ("2", "ArrowDown", "Space"):
        stage.press(key)
    expect(text).to_have_value(re.compile(r"^puddles:", re.M))
    text.fill(TEXT.replace("size", "sise"))
    expect(page.locator(".problem")).to_contain_text("did you mean size?")
    text.fill(TEXT + TWO_WALLS)
    expect(page.locator(".problem")).to_be_hidden()
    page.get_by_role("tab", name="Findings").click()
    page.locator(".fix").first.click()
    expect(text).to_have_value(TEXT + WALLS)
    with page.expect_download() as saved:
        page.get_by_role("button", name="Save").click()
    file = tmp_path / saved.value.suggested_filename
    saved.value.save_as(file)
    level = brl.load(file)
    assert (level.title, level.size) == ("Mine", (4, 3))
    code = shared(page, "code")
    assert brl.load(code).digest == level.digest
    link = shared(page, "link")
    assert link == f"{server.address}#{code}"
    # A file, a level by its name, and one by its code.
    page.get_by_role("button", name="Open another level").click()
    page.get_by_role("dialog", name="Open a level").get_by_label("File").set_input_files(file)
    expect(page.locator(".title")).to_contain_text("Mine")
    page.evaluate("() => { location.hash = 'first-key' }")
    expect(page.locator(".title")).to_contain_text("The first key")
    page.goto(link)
    expect(page.locator(".title")).to_contain_text("Mine")


@pytest.mark.sweep
def test_what_needs_numpy_is_offered_and_nobody_asked_before(visit: Visit) -> None:
    asked: list[str] = []
    page = visit()
    page.context.on("request", lambda request: asked.append(request.url))
    load = page.locator(".load")
    expect(load).to_contain_text("20 MB from cdn.jsdelivr.net")
    page.locator(".stage").press("p")
    expect(page.locator(".said")).to_contain_text("NumPy and SciPy")
    assert [address for address in asked if address.startswith("https:")] == []
    # No other machine answers in these tests.
    load.click()
    expect(page.locator(".said")).to_have_text(
        "NumPy and SciPy could not be loaded: is there a network?"
    )
    foreign = {address for address in asked if address.startswith("https:")}
    assert all(address.startswith(CDN) for address in foreign)
    page.locator(".stage").press("2")
    page.locator(".stage").press("Space")
    expect(text_of(page)).to_have_value(re.compile(r"^puddles:", re.M))


@pytest.mark.sweep
def test_what_takes_too_long_is_stopped_and_nothing_is_lost(visit: Visit) -> None:
    page = visit()
    stage, text = page.locator(".stage"), text_of(page)
    for key in ("2", "ArrowRight", "Space"):
        stage.press(key)
    expect(text).to_have_value(re.compile(r"^puddles:", re.M))
    before = text.input_value()
    page.clock.install()
    text.fill(SLOW)
    pass_time(page)
    expect(page.locator(".said")).to_contain_text("was stopped", timeout=START)
    # What was typed stays, and what was drawn is as it was.
    expect(text).to_have_value(SLOW)
    text.fill(before)
    for key in ("ArrowRight", "Space"):
        stage.press(key)
    expect(text).to_have_value(re.compile(r"^puddles:.*\n.*\n.*at", re.M), timeout=START)
    # So does what was drawn if the address asks for too much.
    kept = text.input_value()
    page.evaluate("(text) => { location.hash = encodeURIComponent(text) }", SLOW)
    pass_time(page)
    expect(page.locator(".said")).to_contain_text("was stopped", timeout=START)
    expect(text).to_have_value(kept)
    stage.press("ArrowRight")
    stage.press("Space")
    expect(text).not_to_have_value(kept, timeout=START)


@pytest.mark.sweep
def test_what_was_drawn_before_a_link_was_opened_is_there_again(visit: Visit) -> None:
    page = visit()
    for key in ("2", "ArrowRight", "Space"):
        page.locator(".stage").press(key)
    expect(text_of(page)).to_have_value(re.compile(r"^puddles:", re.M))
    drawn = text_of(page).input_value()
    # What is only looked at is not kept.
    for name in ("first-key", "final-maze"):
        page.reload()
        starts(page)
        page.evaluate("(name) => { location.hash = name }", name)
        expect(text_of(page)).to_have_value(re.compile("The (first key|final maze)"))
    page.reload()
    starts(page)
    page.get_by_role("button", name="Open another level").click()
    levels = page.get_by_role("dialog", name="Open a level").locator(".level")
    expect(levels.first).to_have_text("Untitled")
    expect(levels.first).to_have_attribute("data-about", "kept in this browser")
    expect(levels.nth(1)).not_to_have_attribute("data-about", "kept in this browser")
    levels.first.click()
    expect(text_of(page)).to_have_value(drawn)


def pass_time(page: Page) -> None:
    """Let half a minute pass for the page, which has just sent something."""
    page.clock.run_for(1_000)
    page.wait_for_timeout(1_000)
    page.clock.fast_forward(40_000)
    page.clock.resume()


@pytest.mark.sweep
def test_it_fits_a_phone(visit: Visit) -> None:
    page = visit(**PHONE)
    assert page.evaluate("() => document.documentElement.scrollWidth <= innerWidth")
    box = page.locator(".stage > svg").bounding_box()
    assert box is not None
    page.get_by_role("button", name="Walls").tap()
    page.locator("[data-tool=blocked]").tap()
    page.touchscreen.tap(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    expect(page.locator(".file-state")).to_contain_text("not saved")


@pytest.mark.sweep
def test_an_address_that_is_no_code_is_told(visit: Visit) -> None:
    page = visit("#%")
    expect(page.locator(".said")).to_contain_text("%", timeout=START)
    page.locator(".stage").press("2")
    page.locator(".stage").press("Space")
    expect(text_of(page)).to_have_value(re.compile(r"^puddles:", re.M))


@pytest.mark.sweep
def test_firefox_draws_too(server: StaticServer, tmp_path: Path) -> None:
    with firefox(tmp_path) as opened:
        page = opened.page()
        page.open(f"{server.address}#final-maze")
        page.until("() => document.title === 'The final maze – editor'")
        page.click(".stage")
        page.press("2")
        page.until("() => seen('textarea.text')[0].value.includes('puddles')")
        assert opened.faults() == []


# -- the messages ------------------------------------------------------------------------------

REPLIES = """async ([text, messages, isNumeric]) => {
  const worker = new Worker("worker.js", { type: "module" });
  const call = (...given) => new Promise((resolve, reject) => {
    worker.onmessage = ({ data: [number, result, error] }) => {
      // Number 0 tells how much has been loaded.
      if (number === 1 && error === null) resolve(result);
      else if (number === 1) reject(error);
    };
    worker.postMessage([1, ...given]);
  });
  await call("begin", 1, text, "", 0);
  if (isNumeric) await call("load");
  let revision = JSON.parse(await call("reply", 1, '{"do": "state"}')).state.revision;
  const replies = [];
  for (const message of messages) {
    const sent = JSON.stringify({ id: 1, revision, ...message });
    const reply = JSON.parse(await call("reply", 1, sent));
    revision = reply.state?.revision ?? revision;
    replies.push(reply);
  }
  worker.terminate();
  return replies;
}"""


@pytest.fixture(scope="module")
def numeric_runtime(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder of Python for browsers that has NumPy and SciPy as well."""
    wheels = tmp_path_factory.mktemp("numeric")
    command = [sys.executable, *DOWNLOAD, *LIBRARIES]
    done = subprocess.run(command, cwd=wheels, capture_output=True, text=True, check=False)
    if done.returncode:
        reason = done.stderr.strip().splitlines()[-1]
        pytest.skip(f"`python {shlex.join(command[1:])}` found no such wheels: {reason}")
    for file in runtime().iterdir():
        shutil.copy(file, wheels)
    return wheels


@pytest.mark.sweep
def test_python_in_the_browser_answers_as_anywhere(visit: Visit, tmp_path: Path) -> None:
    messages = [*MESSAGES, *NUMERIC]
    answered = visit().evaluate(REPLIES, [TEXT, messages, False])
    (expected,) = asked([("replies", [TEXT, messages])], tmp_path)
    for message, one, other in zip(messages, answered, expected, strict=True):
        assert settled(message, one) == settled(message, other)


def test_with_numpy_python_in_the_browser_solves_levels(
    numeric_runtime: Path, page: Page, tmp_path: Path
) -> None:
    write_site(tmp_path / "site", session_of("first-key"), numeric_runtime)
    with hosted(tmp_path / "site") as server:
        page.goto(server.address)
        starts(page)
        messages = [*MESSAGES, *NUMERIC]
        answered = page.evaluate(REPLIES, [TEXT, messages, True])
        expected = json.loads(json.dumps(replies(TEXT, messages)))
        for message, one, other in zip(messages, answered, expected, strict=True):
            assert settled(message, one) == settled(message, other)
        page.locator(".load").click()
        expect(page.locator(".best-return")).to_have_text("−7", timeout=START)
        page.locator(".stage").press("p")
        expect(page.locator(".playing")).to_be_visible()


# -- the folder --------------------------------------------------------------------------------


def test_the_same_site_has_the_same_bytes(folder: Path, tmp_path: Path) -> None:
    write_site(tmp_path / "again", session_of(None), runtime())
    names = sorted(path.relative_to(folder) for path in folder.rglob("*") if path.is_file())
    assert len(names) == 12
    for name in names:
        assert (tmp_path / "again" / name).read_bytes() == (folder / name).read_bytes(), name


def test_a_site_begins_with_a_level_and_is_written_again(folder: Path, tmp_path: Path) -> None:
    site = tmp_path / "site"
    write_site(site, session_of("final-maze"), runtime())
    write_site(site, session_of("first-key"), runtime())
    page = (site / "index.html").read_text("utf-8")
    begin = json.loads(re.findall(r'id="begin">(.*?)</script>', page)[0])
    assert (begin["name"], "The first key" in begin["text"]) == ("first-key", True)
    # It is seen before Python is there.
    assert (
        begin["picture"] == brl.load("first-key").replace(display={"side_panel": "none"}).to_svg()
    )
    megabytes = re.findall(r"this loads (\d+) MB", (site / "editor.js").read_text("utf-8"))
    assert int(megabytes[0]) in range(10, 25)


def test_a_site_has_numpy_if_the_folder_has_it(tmp_path: Path) -> None:
    given, site = tmp_path / "given", tmp_path / "site"
    shutil.copytree(runtime(), given)
    (given / f"numpy-2.4.6-cp314-cp314-{PLATFORM}.whl").write_bytes(b"a" * 2_000_000)
    write_site(site, session_of(None), given)
    assert "cdn.jsdelivr.net" in (site / "editor.js").read_text("utf-8")
    scipy = given / f"scipy-1.18.0-cp314-cp314-{PLATFORM}.whl"
    scipy.write_bytes(b"b" * 3_000_000)
    write_site(site, session_of(None), given)
    assert 'from:"5 MB"' in (site / "editor.js").read_text("utf-8")
    for name in ("editor.js", "worker.js"):
        assert "cdn.jsdelivr.net" not in (site / name).read_text("utf-8")
    entry = json.loads((site / "python" / "pyodide-lock.json").read_bytes())["packages"]["scipy"]
    assert entry["file_name"] == scipy.name
    assert entry["sha256"] == hashlib.sha256(scipy.read_bytes()).hexdigest()
    assert (site / "python" / scipy.name).read_bytes() == scipy.read_bytes()


@pytest.mark.sweep
def test_numpy_is_loaded_from_the_site_that_has_it(page: Page, tmp_path: Path) -> None:
    given = tmp_path / "given"
    shutil.copytree(runtime(), given)
    wheels = [f"{name}-1-cp314-cp314-{PLATFORM}.whl" for name in LIBRARIES]
    for wheel in wheels:
        (given / wheel).write_bytes(stand_in(wheel.partition("-")[0]))
    write_site(tmp_path / "site", session_of(None), given)
    with hosted(tmp_path / "site") as server:
        page.goto(server.address)
        starts(page)
        with (
            page.expect_request(f"**/python/{wheels[0]}"),
            page.expect_request(f"**/python/{wheels[1]}"),
        ):
            page.locator(".load").click()


def test_a_folder_of_other_files_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "thesis.tex").write_text("", "utf-8")
    with pytest.raises(SiteFolderError, match="has files already"):
        write_site(tmp_path, session_of(None), runtime())
    assert [path.name for path in tmp_path.iterdir()] == ["thesis.tex"]


def test_only_the_files_that_are_published_are_taken(tmp_path: Path) -> None:
    with pytest.raises(RuntimeFileError, match=r"pyodide-.*\.tgz cannot be read"):
        runtime_file(TARBALL, tmp_path)
    (tmp_path / TARBALL.name).write_bytes(b"something else")
    with pytest.raises(RuntimeFileError, match="is not the file that its project has published"):
        runtime_file(TARBALL, tmp_path)


def test_without_npm_the_files_must_be_given(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", "")
    with pytest.raises(RuntimeFileError, match="there is no npm"), runtime_folder(None):
        pass


def test_what_cannot_be_fetched_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "npm").write_text("#!/bin/sh\necho no such package >&2\nexit 1\n", "utf-8")
    (tmp_path / "npm").chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path), prepend=":")
    with (
        pytest.raises(
            RuntimeFileError, match=r"^pyodide@\S+ cannot be fetched \(no such package\)$"
        ),
        runtime_folder(None),
    ):
        pass
