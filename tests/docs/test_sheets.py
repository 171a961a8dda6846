"""The page on exercise sheets shows what is drawn."""

from __future__ import annotations

import io

import numpy as np
from doc_pictures import sheet
from PIL import Image
from support.places import DOCS

TEXT = (DOCS / "sheets.md").read_text("utf-8")


def test_the_picture_is_what_is_drawn() -> None:
    # `python scripts/renew.py docs/images/sheet.png` draws it anew.
    stored, drawn = (
        np.asarray(Image.open(source).convert("L"), int)
        for source in (DOCS / "images" / "sheet.png", io.BytesIO(sheet()))
    )
    assert stored.shape == drawn.shape
    assert (np.abs(stored - drawn) > 64).mean() < 0.002
    assert "](images/sheet.png)" in TEXT
