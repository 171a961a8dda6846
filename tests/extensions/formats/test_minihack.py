"""Levels of MiniHack."""

from __future__ import annotations

import pytest
from support.conversions import level_of_world, lost_fields, world_of

from babyrobot_levels.extensions.formats.conversion import ConversionError
from babyrobot_levels.extensions.formats.reading import guess
from babyrobot_levels.text.source import SourceFile

LEVEL = """MAZE: "mylevel",' '
# A river of lava.
GEOMETRY:center,center
MAP
-------
|..L..|
|..L..|
-------
ENDMAP
$right = selection:fillrect (4,1,5,2)
OBJECT:('/',"cold"),(1,1)
BRANCH:(1,1,2,1),(0,0,0,0)
STAIR:rndcoord($right),down
"""


def test_starts_exits_and_lava_are_those_of_the_drawing() -> None:
    assert guess(SourceFile("level.des", LEVEL)) == ["minihack"]
    world = world_of(LEVEL, "minihack")
    level = level_of_world(world)
    assert (level.size, level.starts) == ((7, 4), ((1, 1), (2, 1)))
    assert level.exit_one_of == ((4, 1), (5, 1), (4, 2), (5, 2))
    assert [(area.at, area.ends) for area in level.areas] == [((3, 1), True), ((3, 2), True)]
    assert int(level.grid().blocked.sum()) == 18
    assert lost_fields(world) == ["OBJECT"]


def test_a_stair_in_one_place_is_the_exit() -> None:
    world = world_of(LEVEL.replace("rndcoord($right)", "(5,2)"), "minihack")
    assert level_of_world(world).exits == ((5, 2),)


def test_what_would_take_long_is_bounded() -> None:
    with pytest.raises(ConversionError, match="the map is 99 by 4; NetHack's are 80 by 21"):
        world_of(LEVEL.replace("-------", "-" * 99), "minihack")
    many = LEVEL + "BRANCH:(0,1,2,999),(0,0,0,0)\n" * 9999
    assert len(level_of_world(world_of(many, "minihack")).starts) == 4


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("BRANCH", "MAZEWALK:(1,1),east\nBRANCH", "NetHack digs its maze"),
        ("ENDMAP", "END", "places its rooms at random"),
        ("BRANCH", "REGION", "no start"),
        (",down", ",up", "no stair down"),
        ("$right)", "$left)", "no stair down"),
        ("..L..", "..?..", r"the map has `\?`"),
    ],
)
def test_what_nethack_makes_itself_is_refused(old: str, new: str, message: str) -> None:
    with pytest.raises(ConversionError, match=message):
        world_of(LEVEL.replace(old, new), "minihack")
