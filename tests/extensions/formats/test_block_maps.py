"""Maps in blocks: Gymnasium-Robotics, Sokoban, MiniGrid, and maze-dataset's lattices."""

from __future__ import annotations

import json

import pytest
from support.conversions import level_of_world, lost_fields, sample, world_of

import babyrobot_levels as brl
from babyrobot_levels.extensions.formats.conversion import ConversionError, level_of
from babyrobot_levels.extensions.formats.formats import export
from babyrobot_levels.extensions.formats.reading import guess
from babyrobot_levels.text.source import SourceFile

MAZE_MAPS = sample("gymnasium-robotics")
DATASET = sample("maze-dataset")
MAZELIB = sample("mazelib")


# -- Gymnasium-Robotics ----------------------------------------------------------------------


@pytest.mark.parametrize("name", MAZE_MAPS)
def test_a_maze_map_has_the_same_walls_starts_and_goals(name: str) -> None:
    rows = MAZE_MAPS[name]
    level = level_of_world(world_of(json.dumps(rows), "maze-map"))
    inner = [row[1:-1] for row in rows[1:-1]]
    assert level.grid().blocked.tolist() == [[cell == 1 for cell in row] for row in inner]
    for value, cells in (("r", level.starts), ("g", level.exits)):
        marked = {
            (x, y) for y, row in enumerate(inner) for x, cell in enumerate(row) if cell == value
        }
        assert set(cells) == marked or (not marked and len(cells) == 1)
    assert (level.rewards.step, level.rewards.exit) == (0, 1)


@pytest.mark.parametrize("name", MAZE_MAPS)
def test_a_maze_map_comes_back(name: str) -> None:
    world = world_of(json.dumps(MAZE_MAPS[name]), "maze-map")
    conversion = export(level_of_world(world), "maze-map")
    assert conversion.warnings == ()
    rows = json.loads(conversion.text)
    if not {"r", "c"}.intersection(lost_fields(world)):
        assert rows == MAZE_MAPS[name]
    assert [[cell == 1 for cell in row] for row in rows] == [
        [cell == 1 for cell in row] for row in MAZE_MAPS[name]
    ]


def test_where_any_cell_may_be_start_or_goal_the_choice_is_reported() -> None:
    world = world_of(json.dumps(MAZE_MAPS["MEDIUM_MAZE_DIVERSE_GR"]), "maze-map")
    level = level_of_world(world)
    assert (level.starts, level.exits) == (((0, 0),), ((4, 5),))
    assert [*map(str, world.lost)] == [
        "c: 4 of them, each of which may be start or goal there, the start is row 1, column 1, "
        "the goal is row 6, column 5; the others are free"
    ]


@pytest.mark.parametrize(
    ("rows", "starts", "exits", "lost"),
    [
        ([["c", 0, "c", "c"]], [(0, 0)], [(3, 0)], ["c"]),
        ([["r", "c", "c"]], [(0, 0)], [(2, 0)], ["c"]),
        ([["c", "g", "c"]], [(0, 0)], [(1, 0)], ["c"]),
        ([["c", 0, 0]], [(0, 0)], [(2, 0)], ["c"]),
        ([[0, 0, 0]], [(0, 0)], [(2, 0)], ["r", "g"]),
        ([["r", "c", "g"]], [(0, 0)], [(2, 0)], ["c"]),
    ],
    ids=str,
)
def test_each_cell_that_may_be_start_or_goal_is_told(
    rows: list[list[object]], starts: object, exits: object, lost: list[str]
) -> None:
    world = world_of(json.dumps(rows), "maze-map")
    level = level_of_world(world)
    assert ([*level.starts], [*level.exits], lost_fields(world)) == (starts, exits, lost)


def test_several_goals_are_reported() -> None:
    world = world_of(json.dumps(MAZE_MAPS["MEDIUM_MAZE_DIVERSE_G"]), "maze-map")
    assert len(level_of_world(world).exits) == 3
    assert lost_fields(world) == ["g"]
    assert lost_fields(world_of('[["r", "g", "g"]]', "maze-map")) == ["g"]
    assert lost_fields(world_of('[["r", "g"]]', "maze-map")) == []


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('[[1, 0], ["r"]]', "row 1 has 1 cells, the first has 2"),
        ('[[1, 0], ["r", 2]]', "row 1, column 1: expected .* not 2"),
        ("[[True, 0]]", "row 0, column 0: expected .* not True"),
        ("[[1, 1], [1, 1]]", "no start"),
        ("[]", "no rows"),
        ("[[]]", "row 0 has 0 cells"),
        ("{}", "must be a list"),
        ('[[0, "\x1b[31m"]]', "row 0, column 1"),
    ],
)
def test_invalid_maze_maps_are_refused(text: str, message: str) -> None:
    with pytest.raises(ConversionError, match=message) as caught:
        world_of(text, "maze-map")
    assert str(caught.value).replace("\n", "").isprintable()


# -- maze-dataset and mazelib ----------------------------------------------------------------


def open_sides(text: str) -> set[tuple[int, int, str]]:
    """Return where one gets through in a lattice: cell and side, by looking at the text alone."""
    rows = text.splitlines()
    return {
        (x // 2, y // 2, side)
        for y in range(1, len(rows), 2)
        for x in range(1, len(rows[0]), 2)
        for side, (dx, dy) in {"N": (0, -1), "E": (1, 0), "S": (0, 1), "W": (-1, 0)}.items()
        if rows[y + dy][x + dx] != "#"
        and 0 < y + dy < len(rows) - 1
        and 0 < x + dx < len(rows[0]) - 1
    }


@pytest.mark.parametrize("name", [*DATASET, *MAZELIB])
def test_a_lattice_becomes_walls_between_cells(name: str) -> None:
    text = (DATASET | MAZELIB)[name]
    level = level_of_world(world_of(text, "maze-dataset"))
    rows = text.splitlines()
    assert level.size == (len(rows[0]) // 2, len(rows) // 2)
    grid = level.grid()
    found = {
        (x, y, side)
        for y in range(grid.height)
        for x in range(grid.width)
        for index, side in enumerate("NESW")
        if grid.open[y, x, index]
    }
    assert found == open_sides(text)
    assert not grid.blocked.any()


@pytest.mark.parametrize("name", DATASET)
def test_a_maze_of_maze_dataset_comes_back(name: str) -> None:
    level = level_of_world(world_of(DATASET[name], "maze-dataset"))
    text = export(level, "maze-dataset").text
    kept = DATASET[name].replace("X", " ")
    assert (
        text.replace("S", " ").replace("E", " ") == kept.replace("S", " ").replace("E", " ") + "\n"
    )
    if "S" in kept:
        assert text == kept + "\n"


@pytest.mark.parametrize("name", MAZELIB)
def test_the_path_of_a_solved_maze_of_mazelib_is_left_out(name: str) -> None:
    """`tostring(True, True)` of mazelib draws the way from S to E by `+`."""
    plain = MAZELIB[name]
    text = plain.replace(" ", "+", 4)
    assert guess(SourceFile("world", text)) == ["maze-dataset"]
    world = world_of(text, "maze-dataset")
    assert world.fields == world_of(plain, "maze-dataset").fields
    assert "+" in lost_fields(world)


def test_start_and_end_are_where_they_are_drawn() -> None:
    text = DATASET["gen_wilson-solved"]
    world = world_of(text, "maze-dataset")
    place = text.replace("\n", "").index("S")
    width = len(text.splitlines()[0])
    assert level_of_world(world).starts == ((place % width // 2, place // width // 2),)
    assert lost_fields(world) == ["X"]


def test_doors_in_the_outer_wall_are_closed() -> None:
    world = world_of(MAZELIB["prims-3"], "maze-dataset")
    level = level_of_world(world)
    assert (level.starts, level.exits) == (((5, 0),), ((0, 3),))
    assert lost_fields(world) == ["S", "E"]


def test_without_marks_the_corners_are_start_and_exit_with_a_warning() -> None:
    world = world_of(DATASET["gen_dfs"], "maze-dataset")
    level = level_of_world(world)
    assert (level.starts, level.exits) == (((0, 0),), ((4, 4),))
    assert lost_fields(world) == ["S", "E"]


def test_walls_that_fill_cells_are_not_a_lattice() -> None:
    with pytest.raises(ConversionError, match="sokoban"):
        world_of("#####\n#S  #\n#  E#\n#####", "maze-dataset")


# -- Sokoban ---------------------------------------------------------------------------------

SOKOBAN = """
   ######
 ###    #
 #   $# ##
 # ## .  #
##  $#.  ####
#  @   *    #
##########  #
         ####
"""

INSIDE = """
###    ####
#   $# ####
# ## .  ###
#  $#.  ###
  S   *
#########
"""


@pytest.mark.slow
def test_a_sokoban_map_keeps_its_walls_player_and_goals() -> None:
    world = world_of(SOKOBAN, "sokoban")
    level = level_of_world(world)
    expected = [line.ljust(11) for line in INSIDE.strip("\n").splitlines()]
    drawn = [line[2::4] for line in level.draw().splitlines()[1::2]]
    assert drawn == expected
    assert lost_fields(world) == []
    again = level_of_world(world_of(export(level, "sokoban").text, "sokoban"))
    assert again.digest == level.digest


def test_a_player_on_a_goal_is_a_start_on_a_target_if_there_are_boxes() -> None:
    text = "#######\n#+ $ .#\n#  *  #\n#######\n"
    level = level_of_world(world_of(text, "sokoban"))
    assert level.starts == ((0, 0),)
    assert {target.at for target in level.targets} == {(0, 0), (4, 0), (2, 1)}
    assert {box.at for box in level.boxes} == {(2, 0), (2, 1)}
    assert export(level, "sokoban").text == text
    assert level_of_world(world_of(export(level, "sokoban").text, "sokoban")).digest == level.digest


def test_boxes_of_levels_that_end_at_an_exit_are_left_out() -> None:
    level = brl.load({"version": 1, "size": [4, 2], "boxes": [{"at": [1, 1]}]})
    found = export(level, "sokoban")
    assert [lost.field for lost in found.warnings] == ["boxes"]
    assert found.text == "######\n#@   #\n#   .#\n######\n"


def test_a_player_on_a_goal_is_a_start_with_a_warning() -> None:
    world = world_of("#####\n#+ .#\n#####", "sokoban")
    level = level_of_world(world)
    assert (level.starts, level.exits) == (((0, 0),), ((2, 0),))
    assert lost_fields(world) == ["+"]


@pytest.mark.parametrize(("start", "goal"), [("@", "."), ("S", "E"), ("S", "X"), ("@", "E")])
def test_the_marks_of_many_programs_are_known(start: str, goal: str) -> None:
    level = level_of_world(world_of(f"######\n#{start}-_{goal}#\n######", "sokoban"))
    assert (level.size, level.starts, level.exits) == ((4, 1), ((0, 0),), ((3, 0),))


@pytest.mark.parametrize("exit_mark", ["E", "X"])
def test_dots_are_free_cells_where_other_marks_are_exits(exit_mark: str) -> None:
    world = world_of(f"######\n#S...#\n#..#{exit_mark}#\n######", "sokoban")
    assert level_of_world(world).exits == ((3, 1),)
    (lost,) = world.lost
    assert lost.field == "`.`"
    assert lost.message == f"read as free, because `{exit_mark}` is the exit"


@pytest.mark.parametrize("way", "*+")
def test_ways_of_other_programs_are_free_cells_where_letters_are_start_and_exit(way: str) -> None:
    world = world_of(f"######\n#S{way}{way}##\n# #{way}{way}E\n######", "sokoban")
    level = level_of_world(world)
    assert (level.starts, level.exits) == (((1, 1),), ((5, 2),))
    ends = {"*": "`E` is the exit", "+": "`S` is the start and `E` is the exit"}
    assert [*map(str, world.lost)] == [f"`{way}`: read as free, because {ends[way]}"]


def test_two_starts_of_a_sokoban_map_are_told() -> None:
    world = world_of("#####\n#@@.#\n#####", "sokoban")
    assert level_of_world(world).starts == ((0, 0), (1, 0))
    assert [*map(str, world.lost)] == ["start: 2 are drawn: each reset draws one of them"]


def test_dots_alone_are_goals() -> None:
    world = world_of("#####\n#@..#\n#####", "sokoban")
    assert level_of_world(world).exits == ((1, 0), (2, 0))
    assert world.lost == ()


LEVEL_FILE = """; the first one

#####
#@ .#
#####
Title: Go east
Author: Nobody
Date: today
; done
"""


@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_texts_around_a_sokoban_map_are_kept(end: str) -> None:
    world = world_of(LEVEL_FILE.replace("\n", end), "sokoban")
    level = level_of_world(world)
    assert (level.title, level.author, level.size) == ("Go east", "Nobody", (3, 1))
    assert level.description == "the first one\nDate: today\ndone"
    assert world.lost == ()


TITLED = """Copyright (c) 2020 Somebody = me
17
Simple Steps
#####
#@ .#
#####
"""


def test_titles_and_numbers_around_a_map_are_no_rows_of_it() -> None:
    source = SourceFile("world.txt", TITLED)
    assert guess(source) == ["sokoban"]
    world = world_of(TITLED, "sokoban")
    level = level_of_world(world)
    assert (level.size, level.starts, level.title) == ((3, 1), ((0, 0),), "Simple Steps")
    assert level.description == "Copyright (c) 2020 Somebody = me"
    assert world.lost == ()


def test_a_row_between_walls_is_no_title() -> None:
    with pytest.raises(ConversionError, match=r"world\.txt:5:3: error: unknown character `\?`"):
        world_of(TITLED.replace("#@ .#", " @? ."), "sokoban")


@pytest.mark.parametrize(
    ("text", "size"),
    [("@  .\n    \n", (4, 2)), ("   \n@ .\n   \n", (3, 3)), ("@.  \n#   \n", (4, 2))],
)
def test_blank_cells_at_the_edge_of_a_map_are_cells(text: str, size: tuple[int, int]) -> None:
    assert level_of_world(world_of(text, "sokoban")).size == size


def test_blank_cells_around_walls_are_no_cells() -> None:
    world = world_of("      \n##### \n#@ .# \n##### \n      \n", "sokoban")
    assert level_of_world(world).size == (3, 1)


def test_several_sokoban_maps_are_refused() -> None:
    with pytest.raises(ConversionError, match="the text has 2 worlds"):
        world_of(f"{LEVEL_FILE}\n{LEVEL_FILE}", "sokoban")


def test_a_place_in_a_sokoban_file_is_that_of_its_line() -> None:
    with pytest.raises(ConversionError, match=r"world\.txt:4:3: error: unknown character `\?`"):
        world_of(LEVEL_FILE.replace("@ ", "@?"), "sokoban")


def test_a_ring_of_walls_is_the_outer_wall() -> None:
    closed = level_of_world(world_of("#####\n#@  #\n# #.#\n#####", "sokoban"))
    opened = level_of_world(world_of("@  \n #.", "sokoban"))
    assert closed.digest == opened.digest


@pytest.mark.parametrize("name", ["blocked-shapes", "glasshouse", "final-maze", "four-corners"])
def test_walls_between_cells_double_the_grid_with_a_warning(name: str) -> None:
    level = brl.load(name)
    for form in ("sokoban", "minigrid", "maze-map"):
        conversion = export(level, form)
        doubled = level_of_world(world_of(conversion.text, form)).size == tuple(
            2 * side - 1 for side in level.size
        )
        assert doubled == ("walls" in [lost.field for lost in conversion.warnings])
        assert doubled == (name != "blocked-shapes")


# -- MiniGrid --------------------------------------------------------------------------------

MINIGRIDS = sample("minigrid")


@pytest.mark.parametrize("name", MINIGRIDS)
def test_a_minigrid_has_its_walls_agent_and_goal(name: str) -> None:
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
def test_a_minigrid_comes_back(name: str) -> None:
    world = world_of(MINIGRIDS[name], "minigrid")
    conversion = export(level_of_world(world), "minigrid")
    assert world.lost == ()
    assert conversion.text.splitlines() == MINIGRIDS[name].splitlines()
    assert {lost.field for lost in conversion.warnings} <= {"areas.color"}


def test_lava_of_minigrid_ends_the_episode_with_nothing() -> None:
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


def test_what_differs_from_minigrid_is_listed() -> None:
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
    told = [str(each.message).split(": ")[:2] for each in caught]
    assert told == [["world.txt:5:5", "pickup"], ["world.txt:6:11", "toggle"]]
    assert caught[0].filename == __file__


def test_blank_rows_and_columns_of_a_minigrid_are_cells() -> None:
    world = world_of(">>  GG  \n        \n        \n", "minigrid")
    assert level_of_world(world).size == (4, 3)
    # Where an editor dropped blanks, they cannot be told from nothing.
    assert level_of_world(world_of(">>  GG  \n\n", "minigrid")).size == (4, 1)


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
def test_unknown_cells_of_minigrid_are_refused_with_their_place(text: str, place: str) -> None:
    with pytest.raises(ConversionError, match=f"world.txt:{place}: error:"):
        world_of(text, "minigrid")
