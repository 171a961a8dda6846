"""The page on exercise sheets shows what is drawn."""

from __future__ import annotations

import io

import numpy as np
from PIL import Image
from support.places import DOCS
from support.sheet_picture import PICTURE, picture

TEXT = (DOCS / "sheets.md").read_text("utf-8")


def test_the_picture_is_what_is_drawn() -> None:
    # `PYTHONPATH=tests python -m renew.sheet_picture` draws it anew.
    stored, drawn = (
        np.asarray(Image.open(source).convert("L"), int)
        for source in (PICTURE, io.BytesIO(picture()))
    )
    assert stored.shape == drawn.shape
    assert (np.abs(stored - drawn) > 64).mean() < 0.002
    assert "](images/sheet.png)" in TEXT
