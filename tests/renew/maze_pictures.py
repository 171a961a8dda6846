"""Draw the pictures of `docs/mazes.md` anew. From the top: `PYTHONPATH=tests python FILE`."""

from __future__ import annotations

from support.maze_pictures import FOLDER, pictures

if __name__ == "__main__":
    FOLDER.mkdir(parents=True, exist_ok=True)
    for name, picture in pictures().items():
        (FOLDER / name).write_text(picture, encoding="utf-8", newline="\n")
    print(f"{len(pictures())} pictures")
