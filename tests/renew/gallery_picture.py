"""Renew the picture of a gallery in README and `docs/gallery.md`.

From the top of the repository: `PYTHONPATH=tests python -m renew.gallery_picture`
"""

from __future__ import annotations

import io
import shutil
import tempfile
from pathlib import Path

from PIL import Image
from playwright.sync_api import sync_playwright
from support.places import DOCS

import babyrobot_levels as brl

PICTURE = DOCS / "images" / "gallery.png"

if __name__ == "__main__":
    levels = [level.name for level in brl.levels()]
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        title = "The babyrobot gallery"
        made = brl.gallery(levels, Path(folder) / "gallery", title=title, jobs=2)
        system = shutil.which("chromium") or shutil.which("chromium-browser")
        browser = playwright.chromium.launch(executable_path=system, args=["--no-sandbox"])
        page = browser.new_page(viewport={"width": 1280, "height": 840})
        page.goto((made.folder / "index.html").as_uri())
        page.wait_for_load_state("networkidle")
        shot = Image.open(io.BytesIO(page.screenshot()))
        browser.close()
    # 256 colours are enough, in a third of the bytes.
    shot.convert("RGB").quantize(256).save(PICTURE, optimize=True)
    print(f"{PICTURE.name}: {len(levels)} levels")
