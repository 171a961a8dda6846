"""Write the expected SVG texts of `golden` anew. Look at the pictures before you keep them.

From the top of the repository: `python tests/render/renew_golden.py`
"""

from __future__ import annotations

from pathlib import Path

from babyrobot_levels.catalogue import load
from babyrobot_levels.render.svg import to_svg
from babyrobot_levels.scene.build import build_scene

GOLDEN = sorted((Path(__file__).parent / "golden").glob("*.yaml"))


def svg(path: Path) -> str:
    """Return the picture of the level in a file."""
    return to_svg(build_scene(load(str(path))))


if __name__ == "__main__":
    for path in GOLDEN:
        path.with_suffix(".svg").write_text(svg(path), encoding="utf-8", newline="\n")
    print(f"{len(GOLDEN)} pictures")
