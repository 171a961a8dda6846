"""MiniGrid's text: two characters a cell, with doors, keys and the heading."""

from __future__ import annotations

import pytest
from support.conversions import level_of_world, lost_fields, sample, world_of

import babyrobot_levels as brl
from babyrobot_levels.convert.conversion import ConversionError, level_of
from babyrobot_levels.convert.formats import export

MINIGRIDS = sample("minigrid")


@pytest.mark.parametrize("name", MINIGRIDS)
def test_it_has_its_walls_agent_and_goal(name: str) -> None:
    text = MINIGRIDS[name]
    level = level_of_world(world_of(text, "minigrid"))
    drawn = text.strip("\n").splitlines()
    rows = [line for line in drawn if line.strip()]
    pairs = [[row[x : x + 2] for x in range(0, len(row), 2)] for row in rows]
    agents = [
        (x, y, "ESWN"[(">>", "VV", "<<", "^^").index(pair)])
        for y, row in enumerate(pairs)
        for x, pair in enumerate(row)
        if pair in (">>", "<<", "^^", "VV")
    ]
    # The ring around all of it is the level's outer wall.
    assert [(x + 1, y + 1, level.heading) for x, y in level.starts] == agents
    assert [pairs[y + 1][x + 1] for x, y in level.exits] == ["GG"] * text.count("GG")
    inner = [row[1:-1] for row in pairs[1:-1]]
    walls = sum(pair == "WG" for row in inner for pair in row)
    blocked = int(level.grid().blocked.sum())
    # What is outside of the rooms, as only MultiRoom has it, is blocked as well.
    assert blocked > walls if name.startswith("MultiRoom") else blocked == walls


@pytest.mark.parametrize("name", ["Empty-5x5", "FourRooms", "LavaCrossingS9N2", "DistShift1"])
def test_it_comes_back(name: str) -> None:
    world = world_of(MINIGRIDS[name], "minigrid")
    conversion = export(level_of_world(world), "minigrid")
    assert world.lost == ()
    assert conversion.text.splitlines() == MINIGRIDS[name].splitlines()
    assert {lost.field for lost in conversion.warnings} <= {"areas.color"}


def test_lava_ends_the_episode_with_nothing() -> None:
    level = level_of_world(world_of(MINIGRIDS["LavaCrossingS9N2"], "minigrid"))
    mdp = level.compile()
    cell = 5  # The first lava of the first row: `VR` stands in column 6, behind the ring.
    assert mdp.is_terminal[cell]
    east = [(s, r, over) for p, s, r, over in mdp.outcomes(cell - 1, brl.Action.EAST) if p]
    assert east == [(cell, 0.0, True)]


def test_keys_and_locked_doors_are_read() -> None:
    world = world_of(MINIGRIDS["DoorKey-8x8"], "minigrid")
    level = level_of_world(world)
    (key,), (door,) = level.items, level.doors
    assert (key.name, key.at, key.picture) == ("yellow-key", (1, 3), "key")
    assert (door.at, door.side, door.needs) == ((4, 4), "W", "yellow-key")
    assert lost_fields(world) == ["pickup", "toggle"]


def test_what_differs_is_listed() -> None:
    world = world_of(MINIGRIDS["KeyCorridorS3R2"], "minigrid")
    assert [str(lost) for lost in world.lost] == [
        "goal: none is drawn, so the level has no exit and no reward",
        "pickup: a key is taken by stepping onto it, and kept; in MiniGrid, by an action",
        "toggle: holding its key opens a door; in MiniGrid, an action does",
        "doors: 3 closed, not locked: open; in MiniGrid, an action opens it",
        "objects: 1 ball left out; in MiniGrid, in the way until moved",
    ]
    assert level_of_world(world).exits == ()


def test_making_a_level_of_a_world_warns_of_what_is_lost() -> None:
    world = world_of(MINIGRIDS["DoorKey-8x8"], "minigrid")
    with pytest.warns(brl.ConversionWarning) as caught:
        assert level_of(world).exits
    assert [str(each.message).partition(":")[0] for each in caught] == ["pickup", "toggle"]
    assert caught[0].filename == __file__


def test_an_open_door_is_a_free_cell() -> None:
    world = world_of("WGWGWGWG\nWG>>__WG\nWGWGWGWG", "minigrid")
    assert level_of_world(world).size == (2, 1)
    assert lost_fields(world) == ["goal"]


def test_a_locked_door_without_a_key_is_a_wall() -> None:
    world = world_of("WGWGWGWGWG\nWG>>LRKBWG\nWGWGWGWGWG", "minigrid")
    level = level_of_world(world)
    assert level.grid().blocked.tolist() == [[False, True, False]]
    assert lost_fields(world) == ["goal", "doors", "objects"]
    assert "1 locked, without a key: a wall" in world.lost[1].message


def test_of_several_keys_for_a_door_the_nearest_that_can_be_reached_is_kept() -> None:
    # From the agent, the first in reading order is behind the door.
    text = "WGWGWGWGWGWGWG\nWGKRLR  >>KRWG\nWGWGWGWGWGWGWG"
    world = world_of(text, "minigrid")
    assert [item.at for item in level_of_world(world).items] == [(4, 0)]
    assert "1 key left out" in world.lost[-1].message


def test_a_door_that_can_be_come_to_from_both_sides_is_closed_on_both() -> None:
    text = """
WGWGWGWGWG
WG>>  KBWG
WG  WG  WG
WG  LB  WG
WG  WG  WG
WG      WG
WGWGWGWGWG
"""
    level = level_of_world(world_of(text, "minigrid"))
    assert {(door.at, door.side) for door in level.doors} == {((1, 2), "W"), ((1, 2), "E")}


@pytest.mark.parametrize(
    ("text", "place"), [("WGWGWG\nWG>>QG", "2:5"), ("WGW\nWG>>", "1:3"), ("\nWG>>WX", "2:5")]
)
def test_unknown_cells_are_refused_with_their_place(text: str, place: str) -> None:
    with pytest.raises(ConversionError, match=f"world.txt:{place}: error:"):
        world_of(text, "minigrid")
