"""Draw the picture of `docs/sheets.md` anew.

From the top of the repository: `PYTHONPATH=tests python -m renew.sheet_picture`
"""

from __future__ import annotations

from support.sheet_picture import PICTURE, picture

if __name__ == "__main__":
    PICTURE.write_bytes(picture())
    print(PICTURE.name)
