"""Draw the pictures of things in `docs/pictures.md` anew.

From the top of the repository: `PYTHONPATH=tests python -m renew.thing_pictures`
"""

from __future__ import annotations

from support.thing_pictures import FOLDER, pictures

if __name__ == "__main__":
    for name, picture in pictures().items():
        (FOLDER / name).write_text(picture, encoding="utf-8", newline="\n")
    print(f"{len(pictures())} pictures")
