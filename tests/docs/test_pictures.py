"""The document about pictures shows things as they are drawn, and names their characters."""

from __future__ import annotations

import pytest
from support.thing_pictures import DOCUMENT, FOLDER, pictures

from babyrobot_levels.render.text import PLAIN_ROBOTS, ROBOTS
from babyrobot_levels.render.text_plan import ITEMS, LOCKED, MOVER

TEXT = DOCUMENT.read_text(encoding="utf-8")


@pytest.mark.parametrize("name", pictures())
def test_the_picture_is_what_is_drawn(name: str) -> None:
    # `PYTHONPATH=tests python -m renew.thing_pictures` draws them anew.
    assert (FOLDER / name).read_text(encoding="utf-8") == pictures()[name]
    assert f"images/{name}" in TEXT


def test_the_characters_of_things_are_those_of_the_table() -> None:
    unicode, ascii_ = (" ".join(f"`{pair[kind]}`" for pair in ITEMS.values()) for kind in (0, 1))
    assert f"| {', '.join(ITEMS)} | {unicode} | {ascii_} |" in TEXT
    assert f"| mover | `{MOVER[0]}` | `{MOVER[1]}` |" in TEXT
    robots = (" ".join(f"`{robot}`" for robot in robots[:4]) for robots in (ROBOTS, PLAIN_ROBOTS))
    assert f"| robot that turns | {' | '.join(robots)} |" in TEXT
    assert f"| exit whose needs are not met | `{LOCKED}` | `{LOCKED}` |" in TEXT
