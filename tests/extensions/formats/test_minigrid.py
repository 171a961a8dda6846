"""Environments of MiniGrid as levels, as recorded after a reset; the package is not needed."""

from __future__ import annotations

import sys
from typing import Any

import pytest
from support.conversions import level_of_world, lost_fields, sample
from support.minigrids import recorded

import babyrobot_levels as brl
from babyrobot_levels.analysis import environments
from babyrobot_levels.extensions.formats import minigrid
from babyrobot_levels.extensions.formats.conversion import ConversionError, World, file_text
from babyrobot_levels.extensions.formats.minigrid import world_of_environment
from babyrobot_levels.library.level import Level

REFUSED = {
    "MiniGrid-PutNear-6x6-N2-v0": "`put the blue box near the red key`: in a level, nothing is put",
    "BabyAI-PutNextS4N1-v0": "in a level, nothing is put down",
    "BabyAI-OpenTwoDoors-v0": "is a sequence of tasks; a level has one",
    "MiniGrid-Dynamic-Obstacles-6x6-v0": "3 obstacles that walk at random have 125 ways to go",
}
READ = sorted(sample("minigrid-environments").keys() - REFUSED.keys())


def world_of(name: str) -> World:
    return world_of_environment(recorded(name), name, 3)


def level_of(name: str) -> Level:
    return level_of_world(world_of(name))


def rows_of(level: Level) -> list[str]:
    """Return the middle characters of the level's drawing."""
    return [line[2::4] for line in level.draw().splitlines()[1::2]]


@pytest.mark.parametrize("name", READ)
def test_the_level_has_the_grid_of_the_environment(name: str) -> None:
    env, level = recorded(name), level_of(name)
    left, top = (int(a) - b for a, b in zip(env.agent_pos, level.starts[0], strict=True))
    blocked = level.grid().blocked
    locked = {door.at for door in level.doors}
    for y in range(env.grid.height):
        for x in range(env.grid.width):
            thing = env.grid.get(x, y)
            cell = (x - left, y - top)
            inside = 0 <= cell[0] < level.size[0] and 0 <= cell[1] < level.size[1]
            is_free = inside and not blocked[cell[1], cell[0]]
            if thing is not None and thing.type == "wall":
                assert not is_free
            elif thing is not None and thing.type == "door" and thing.is_locked:
                # One without a key is a wall, unless the task is to go to it.
                assert is_free == (cell in locked or cell in level.exits)
            elif thing is not None:
                assert is_free
    assert level.heading == "ESWN"[env.agent_dir]
    assert level.max_steps == env.max_steps


@pytest.mark.parametrize("name", READ)
def test_the_task_can_be_done(name: str) -> None:
    level = level_of(name)
    best = brl.solve(level).expected_return
    if name.startswith("MiniGrid-Playground"):
        assert level.exits == ()
    elif name.startswith("MiniGrid-Dynamic"):
        # Whoever stands in the corner may be hit there.
        assert 0.5 < best < 1
    else:
        assert best == 1


def test_door_key_as_a_file() -> None:
    assert file_text(world_of("MiniGrid-DoorKey-8x8-v0"), schema=None, name=None, title="") == (
        """\
# MiniGrid-DoorKey-8x8-v0 of MiniGrid, reset with seed 3.
version: 1
title: MiniGrid-DoorKey-8x8, seed 3
description: Use the key to open the door and then get to the goal.
"""
        f'source: "{minigrid.SOURCE}"\n'
        """\
map: |
  +---+---+---+---+---+---+
  | S              ###    |
  +   +   +   +   +   +   +
  |                ###    |
  +   +   +   +   +   +   +
  |                ###    |
  +   +   +   +   +   +   +
  |     k          ###    |
  +   +   +   +   +   +   +
  |               /       |
  +   +   +   +   +   +   +
  |                ###  E |
  +---+---+---+---+---+---+
legend:
  k: {item: yellow-key, shape: key, color: gold}
heading: N
doors:
  - {at: [4, 4], side: W, needs: yellow-key, color: gold}
# MiniGrid's reward also shrinks with each step.
rewards: {step: 0, exit: 1}
max_steps: 640
"""
    )


DRAWN: dict[str, tuple[list[str], list[str]]] = {
    "MiniGrid-LavaGapS5-v0": (["S~ ", " ~ ", "  E"], []),
    "MiniGrid-KeyCorridorS3R2-v0": (
        ["k    ", " # ##", " #S E"],
        ["task", "pickup", "toggle", "doors"],
    ),
    "MiniGrid-Unlock-v0": (
        ["k   #    ", "    #    ", "    #    ", "S   E    "],
        ["task", "pickup", "toggle"],
    ),
    "MiniGrid-MultiRoom-N2-S4-v0": (["###E ", "S    ", "  ###"], ["doors"]),
    "MiniGrid-RedBlueDoors-6x6-v0": (
        ["  #S   #  ", "  #    #  ", "  #    #  ", "  r    E  "],
        ["task"],
    ),
    "MiniGrid-MemoryS7-v0": (["####b", "k  #x", "   S ", "   #E", "####g"], ["task", "objects"]),
    "MiniGrid-Fetch-6x6-N2-v0": (["E   ", "x S ", "    ", "    "], ["task"]),
    "BabyAI-GoToLocalS5N2-v0": (["   ", "S  ", "  E"], ["task", "objects"]),
}


@pytest.mark.parametrize("name", DRAWN)
def test_families(name: str) -> None:
    world = world_of(name)
    assert (rows_of(level_of_world(world)), lost_fields(world)) == DRAWN[name]


def test_a_key_in_a_box_lies_open() -> None:
    world = world_of("MiniGrid-ObstructedMaze-1Dlhb-v0")
    assert lost_fields(world) == ["task", "pickup", "toggle", "box", "objects"]
    assert [item.picture for item in level_of_world(world).items] == ["key"]


def test_the_red_door_comes_before_the_blue_one() -> None:
    level = level_of("MiniGrid-RedBlueDoors-6x6-v0")
    (switch,) = level.switches
    assert (switch.name, switch.once, level.exit_needs) == ("red-door", True, "red-door")
    # Coming to the blue door first is a failure, as in MiniGrid.
    mdp = level.compile()
    (x, y), width = level.exits[0], level.size[0]
    outcomes = [
        mdp.outcomes(number * mdp.cells + y * width + x - 1, brl.Action.EAST)
        for number in range(mdp.num_configurations)
    ]
    ends = [[(reward, over) for _, _, reward, over in each] for each in outcomes]
    assert ends == [[(0.0, True)], [(1.0, True)]]


def test_obstacles_walk_at_random() -> None:
    world = world_of("MiniGrid-Dynamic-Obstacles-5x5-v0")
    told = "walls: walking into one changes nothing; in MiniGrid, it ends the episode"
    assert told in map(str, world.lost)
    level = level_of_world(world)
    assert [mover.start for mover in level.movers] == [(0, 1), (2, 1)]
    assert all(mover.within and mover.within.size == (3, 3) for mover in level.movers)
    assert (level.hit.reward, level.hit.ends) == (-1, True)


@pytest.mark.parametrize("name", REFUSED)
def test_tasks_that_a_level_cannot_have(name: str) -> None:
    with pytest.raises(ConversionError) as caught:
        world_of(name)
    assert REFUSED[name] in str(caught.value)


# -- making them -----------------------------------------------------------------------------


def test_a_level_in_one_call(monkeypatch: pytest.MonkeyPatch) -> None:
    calls: list[Any] = []

    def made(*arguments: Any) -> Any:
        calls.append(arguments)
        return recorded("MiniGrid-DoorKey-8x8-v0")

    monkeypatch.setattr(environments, "made_minigrid", made)
    with pytest.warns(brl.ConversionWarning) as caught:
        level = brl.import_("MiniGrid-DoorKey-8x8-v0", seed=3, kwargs={"size": 8})
    assert calls == [("MiniGrid-DoorKey-8x8-v0", 3, {"size": 8})]
    assert level.digest == level_of("MiniGrid-DoorKey-8x8-v0").digest
    assert caught[0].filename == __file__


def test_without_the_package_it_says_how_to_get_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "minigrid", None)
    with pytest.raises(ConversionError, match="pip install minigrid"):
        brl.import_("MiniGrid-DoorKey-8x8-v0")
