"""Renew the table of keys and the picture of `docs/editor.md`.

From the top of the repository: `PYTHONPATH=tests python -m renew.editor`
"""

from __future__ import annotations

import shutil

from playwright.sync_api import sync_playwright
from support.editor_docs import PAGE, PICTURE, TABLE, key_rows
from support.editors import is_shown, served

from babyrobot_levels.editor.sources import session_of

if __name__ == "__main__":
    rows = key_rows()
    PAGE.write_text(TABLE.sub(lambda _: rows, PAGE.read_text("utf-8")), "utf-8", newline="\n")
    with sync_playwright() as playwright, served(session_of("gallery/first-key")) as address:
        system = shutil.which("chromium") or shutil.which("chromium-browser")
        browser = playwright.chromium.launch(executable_path=system, args=["--no-sandbox"])
        page = browser.new_page(viewport={"width": 1200, "height": 760})
        page.goto(address)
        is_shown(page)
        page.get_by_role("button", name="Values").click()
        page.wait_for_timeout(1000)
        page.screenshot(path=PICTURE)
        browser.close()
    print(f"{rows.count(chr(10))} keys and {PICTURE.name}")
