"""The document about pictures shows things as they are drawn, and names their characters."""

from __future__ import annotations

from support.places import DOCS

from babyrobot_levels.render.text import PLAIN_ROBOTS, ROBOTS
from babyrobot_levels.render.text_plan import ITEMS, LOCKED, MOVER

TEXT = (DOCS / "pictures.md").read_text(encoding="utf-8")


def test_the_pictures_of_things_are_shown() -> None:
    assert all(f"images/{name}.svg" in TEXT for name in ("things", "things-held"))


def test_the_characters_of_things_are_those_of_the_table() -> None:
    unicode, ascii_ = (" ".join(f"`{pair[kind]}`" for pair in ITEMS.values()) for kind in (0, 1))
    assert f"| {', '.join(ITEMS)} | {unicode} | {ascii_} |" in TEXT
    assert f"| mover | `{MOVER[0]}` | `{MOVER[1]}` |" in TEXT
    robots = (" ".join(f"`{robot}`" for robot in robots[:4]) for robots in (ROBOTS, PLAIN_ROBOTS))
    assert f"| robot that turns | {' | '.join(robots)} |" in TEXT
    assert f"| exit whose needs are not met | `{LOCKED}` | `{LOCKED}` |" in TEXT
