"""Maps of programs with other tasks: in letters, of Karel, and of gym-maze."""

from __future__ import annotations

import json
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.conversions import level_of_world, lost_fields, world_of

import babyrobot_levels as brl
from babyrobot_levels.extensions.formats.conversion import ConversionError
from babyrobot_levels.extensions.formats.formats import FORMATS, export
from babyrobot_levels.extensions.formats.micromouse import decode_gym_maze
from babyrobot_levels.extensions.formats.reading import guess
from babyrobot_levels.text.source import SourceFile

OCTILE = "type octile\nheight 3\nwidth 5\nmap\n@.GS@\n@T..@\n@W.@.\n"
SCENARIOS = """version 1
0\tmaps/a.map\t5\t3\t1\t0\t2\t2\t2.41
1\tmaps/a.map\t5\t3\t3\t1\t1\t0\t2.41
"""
METTA = """type: mettagrid.map_builder.ascii.AsciiMapBuilder.Config
map_data: |-
  #####
  #@.c#
  #..@#
  #####
char_to_map_name:
  "#": wall
  ".": empty
  "@": agent.agent
  c: chest
"""
KITCHEN = '''{
  "grid": """XXPXX
             O1 2O
             X   X
             XDXSX""",
  "x": None
}
'''
WAREHOUSE = "....\n.xx.\n.gg.\n"
DUNGEON = "-----WWWW\nWWWWWWFSW\nWWFMFDDFW\nWWFBFDDFW\nWWWWWWWWW\n"
KAREL = """Dimension: (4, 3)
Wall: (2, 1); west
Wall: (3, 2); north
Wall: (4, 1); east
Beeper: (4, 3); 1
Beeper: (1, 3); 0
Karel: (1, 1); north
BeeperBag: INFINITY
Speed: 0.75
"""

ALL = {
    "movingai": OCTILE,
    "mettagrid": METTA,
    "overcooked": KITCHEN,
    "rware": WAREHOUSE,
    "vglc": DUNGEON,
    "karel": KAREL,
}


@pytest.mark.parametrize("name", ALL)
def test_each_is_recognised_by_its_content(name: str) -> None:
    assert guess(SourceFile("world.txt", ALL[name])) == [name]


def test_scenarios_are_recognised_and_a_legend_of_letters_is_no_dungeon() -> None:
    assert guess(SourceFile("a.map.scen", SCENARIOS)) == ["movingai"]
    assert guess(SourceFile("README.txt", "F = FLOOR\nW = WALL\n- = VOID\n")) == []


@pytest.mark.parametrize(
    ("name", "starts", "exits", "blocked"),
    [
        ("movingai", ((1, 0),), ((2, 2),), 8),
        ("mettagrid", ((0, 0), (2, 1)), (), 1),
        ("overcooked", ((0, 0), (2, 0)), (), 0),
        ("rware", ((0, 0),), ((1, 2), (2, 2)), 0),
        ("vglc", ((5, 0),), ((6, 0),), 8),
    ],
)
def test_the_geometry_is_that_of_the_letters(
    name: str, starts: object, exits: object, blocked: int
) -> None:
    level = level_of_world(world_of(ALL[name], name))
    assert (level.starts, level.exits) == (starts, exits)
    assert int(level.grid().blocked.sum()) == blocked


def test_what_is_not_kept_is_told_with_how_often_it_is_there() -> None:
    assert [*map(str, world_of(METTA, "mettagrid").lost)] == [
        "objects: their tasks are left out: the level has no exit",
        "`c`: 1 objects 'chest' become blocked cells",
        "start: 2 are drawn: each reset draws one of them",
    ]
    assert lost_fields(world_of(OCTILE, "movingai")) == ["diagonal moves", "start, exit", "`W`"]
    assert lost_fields(world_of(DUNGEON, "vglc")) == ["`D`", "`M`", "start"]


def test_an_unknown_letter_is_pointed_at() -> None:
    with pytest.raises(ConversionError, match=r"world.txt:6:3: error: unknown character `\?`"):
        world_of(OCTILE.replace("@T..@", "@T?.@"), "movingai")
    with pytest.raises(ConversionError, match=r"world.txt:4:5: error: unknown character `\?`"):
        world_of(METTA.replace("#@.c#", "#@?c#"), "mettagrid")


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("height 3", "height 4", "3 rows of 5 cells, not 4 of 5"),
        ("height 3", "height 999999", "not 999999 of 5"),
        ("type octile\n", "", "is not a map of MovingAI"),
        ("type octile", "type octile-corner", "type is 'octile-corner', not octile or tile"),
    ],
)
def test_a_map_that_is_not_as_it_says_is_refused(old: str, new: str, message: str) -> None:
    with pytest.raises(ConversionError, match=message):
        world_of(OCTILE.replace(old, new), "movingai")


def test_each_line_of_scenarios_is_a_world_on_the_map_beside_it(tmp_path: Path) -> None:
    (tmp_path / "a.map").write_text(OCTILE.replace("W", "@"), encoding="utf-8")
    (tmp_path / "a.map.scen").write_text(SCENARIOS, encoding="utf-8")
    with pytest.warns(brl.ConversionWarning, match="diagonal"):
        levels = brl.read(tmp_path / "a.map.scen")
    assert [(level.starts, level.exits) for level in levels] == [
        (((1, 0),), ((2, 2),)),
        (((3, 1),), ((1, 0),)),
    ]


@pytest.mark.parametrize(
    ("name", "message"), [("maps/b.map", "no such file"), ("..", "outside"), ("a\0.map", "outside")]
)
def test_the_map_of_scenarios_is_in_their_folder(tmp_path: Path, name: str, message: str) -> None:
    source = SourceFile("s.scen", f"version 1\n0 {name} 5 3 1 0 2 2 2.41\n")
    with pytest.raises(ConversionError, match=message):
        FORMATS["movingai"].read(source, folder=tmp_path)


def test_the_first_scenarios_are_a_team_with_exits_of_their_own(tmp_path: Path) -> None:
    (tmp_path / "a.map").write_text(OCTILE, encoding="utf-8")
    path = tmp_path / "a.map.scen"
    path.write_text(SCENARIOS, encoding="utf-8")
    with pytest.warns(brl.ConversionWarning) as told:
        level = brl.import_(path, robots=2)
    assert "a.map.scen:2:1: goals: a robot that has reached its exit stays" in str(told[1].message)
    robots = [(robot.name, start, robot.exit) for robot, start in level.team_starts]
    assert robots == [("agent-1", (1, 0), (2, 2)), ("agent-2", (3, 1), (1, 0))]
    assert (level.team.meet, level.team.arrived, level.exit) == ("block", "stay", "none")
    assert brl.solve(level).expected_steps == 3
    with pytest.raises(ConversionError, match="no scenarios for 3 robots"):
        brl.import_(path, robots=3)
    path.write_text(SCENARIOS.replace("3\t1\t1\t0", "1\t0\t2\t1"), encoding="utf-8")
    with pytest.raises(ConversionError, match="two of the agents begin in one cell"):
        brl.import_(path, robots=2)
    with pytest.raises(ConversionError, match="has no several robots"):
        FORMATS["rware"].read(SourceFile("a", WAREHOUSE), robots=2)


def test_the_players_of_a_kitchen_move_as_they_do_there() -> None:
    level = level_of_world(world_of(KITCHEN.replace("O1 2O", "O 21O"), "overcooked"))
    assert [(robot.name, at) for robot, at in level.team_starts] == [
        ("player-2", (1, 0)),
        ("player-1", (2, 0)),
    ]
    env, random = level.make(), np.random.default_rng(0)
    env.reset(seed=0)
    at = [*level.starts]
    steps = [(0, 0), (0, -1), (1, 0), (0, 1), (-1, 0)]
    met = 0
    for _ in range(300):
        actions = random.integers(5, size=2)
        wanted = [(x + steps[a][0], y + steps[a][1]) for (x, y), a in zip(at, actions, strict=True)]
        wanted = [
            new if 0 <= new[0] < 3 and 0 <= new[1] < 2 else old
            for old, new in zip(at, wanted, strict=True)
        ]
        # Players who would come into one cell, or change places, stay, both of them.
        meets = wanted[0] == wanted[1] or wanted == at[::-1]
        at, met = at if meets else wanted, met + meets
        observation = env.step(actions)[0]
        assert [*map(int, observation[:4])] == [*at[0], *at[1]]
    assert met > 20


def test_a_map_of_movingai_is_written_and_ends_that_are_elsewhere_are_told() -> None:
    conversion = export(brl.load("four-rooms"), "movingai")
    assert conversion.text.startswith("type tile\nheight ")
    again = level_of_world(world_of(conversion.text, "movingai"))
    assert again.grid().blocked.tolist() == brl.load("four-rooms").grid().blocked.tolist()
    assert "exit" in {lost.field for lost in conversion.warnings}
    plain = export(brl.loads("version: 1\nsize: [4, 3]\n"), "movingai")
    assert (plain.text.count("@"), plain.warnings) == (18, ())


@pytest.mark.slow
def test_a_large_map_is_a_list_of_rectangles() -> None:
    rows = "\n".join(["." * 400] * 399 + ["@" * 399 + "."])
    world = world_of(f"type tile\nheight 400\nwidth 400\nmap\n{rows}\n", "movingai")
    assert "map" not in world.fields
    assert world.fields["blocked"] == [{"at": [0, 399], "size": [399, 1]}]
    assert world.fields["exit"] == [399, 399]


@pytest.mark.parametrize("name", ALL)
@given(at=st.integers(0, 300), length=st.integers(0, 40), put=st.text("#.@\n:{9é", max_size=4))
def test_a_damaged_text_is_a_level_or_an_error(name: str, at: int, length: int, put: str) -> None:
    text = ALL[name][:at] + put + ALL[name][at + length :]
    try:
        level_of_world(world_of(text, name))
    except brl.LevelError:
        return


def test_maps_that_no_file_has_room_for_are_refused_at_once() -> None:
    board = "\n".join([".@" * 300, "@." * 300] * 150)
    with pytest.raises(ConversionError, match="600 by 300, with too much on it for a level file"):
        world_of(f"type tile\nheight 300\nwidth 600\nmap\n{board}\n", "movingai")
    with pytest.raises(ConversionError, match="2000 by 2; a level is at most 1024"):
        world_of("xg" * 1000 + "\n" + ".." * 1000, "rware")


# -- ARC -------------------------------------------------------------------------------------


def test_each_grid_of_a_task_is_a_level() -> None:
    pair = {"input": [[0, 3], [3, 0]], "output": [[3, 3, 9]]}
    source = SourceFile("a.json", json.dumps({"train": [pair], "test": [{"input": [[5]]}]}))
    assert guess(source) == ["arc"]
    sizes = [(2, 2), (3, 1), (1, 1)]
    levels = [level_of_world(FORMATS["arc"].read(source, number=n)) for n in (1, 2, 3)]
    assert [level.size for level in levels] == sizes
    assert [[area.at, area.color] for area in levels[0].areas] == [
        [(1, 0), "#2ecc40"],
        [(0, 1), "#2ecc40"],
    ]


@pytest.mark.parametrize("grid", ["[]", "[[]]", "[[1], [1, 2]]", "[[10]]", "[[-1]]", "[[true]]"])
def test_other_grids_are_refused(grid: str) -> None:
    with pytest.raises(ConversionError):
        world_of(f'{{"train": [{{"input": {grid}}}], "test": []}}', "arc")


# -- Karel -----------------------------------------------------------------------------------


def test_a_world_of_karel_has_its_walls_between_cells() -> None:
    world = world_of(KAREL, "karel")
    level = level_of_world(world)
    assert (level.size, level.starts, level.heading) == ((4, 3), ((0, 2),), "N")
    assert [item.at for item in level.items] == [(3, 0)]
    is_open = level.grid().open
    assert not is_open[2, 0, 1]
    assert not is_open[1, 2, 0]
    assert lost_fields(world) == ["task", "beeperbag", "beepers"]


def test_many_beepers_are_left_out() -> None:
    beepers = "".join(f"Beeper: ({x}, {y}); 1\n" for x in range(1, 4) for y in range(1, 4))
    world = world_of(KAREL + beepers, "karel")
    assert "items" not in world.fields
    assert "beepers: 10 left out; at most 8 become items" in map(str, world.lost)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("Wall: (3, 2)", "Wall: (5, 2)", "3:1: error: this is no cell of the world"),
        ("; north\nWall", "; up\nWall", "3:1: error: the direction is missing"),
        ("Speed: 0.75", "Run!", "9:1: error: this is no line"),
        ("Dimension: (4, 3)\n", "", "no line `Dimension"),
        ("Dimension: (4, 3)", "Dimension: (99999, 3)", "99999 by 3"),
    ],
)
def test_a_faulty_world_of_karel_is_refused(old: str, new: str, message: str) -> None:
    with pytest.raises(ConversionError, match=message.replace("(", r"\(")):
        world_of(KAREL.replace(old, new), "karel")


# -- gym-maze --------------------------------------------------------------------------------


def _array(cells: Any) -> bytes:
    file = BytesIO()
    np.save(file, cells)
    return file.getvalue()


def test_a_maze_of_gym_maze_has_the_open_sides_of_its_bits(tmp_path: Path) -> None:
    # Of [x, y]: from (0, 0) east to (1, 0), and south to (1, 1); (0, 1) is closed.
    cells = np.array([[2, 0], [12, 1]])
    (tmp_path / "maze.npy").write_bytes(_array(cells))
    level = brl.import_(tmp_path / "maze.npy")
    assert (level.starts, level.exits) == (((0, 0),), ((1, 1),))
    sides = level.grid().open.astype(int)
    for (x, y), bits in np.ndenumerate(cells):
        assert sides[y, x].tolist() == [bits >> side & 1 for side in range(4)]


@pytest.mark.parametrize("cells", [np.zeros(3), np.zeros((2, 2, 3), int), np.zeros((2, 2))])
def test_other_arrays_are_no_mazes(cells: object) -> None:
    assert decode_gym_maze(_array(cells)) is None


@pytest.mark.parametrize("cut", [7, 9, 60, 130])
def test_a_damaged_array_is_refused(cut: int) -> None:
    with pytest.raises(ConversionError, match="no array of NumPy"):
        decode_gym_maze(_array(np.zeros((9, 9), int))[:cut])


def test_an_array_of_objects_runs_no_code() -> None:
    file = BytesIO()
    np.save(file, np.array([print], object), allow_pickle=True)
    with pytest.raises(ConversionError, match="no array of NumPy"):
        decode_gym_maze(file.getvalue())
