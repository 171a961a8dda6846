"""What is where, what cells do, and how pictures show it: ends, rewards, glass, wind, warps."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
from support.scenes import VAULT

from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.actions import Action
from babyrobot_levels.mdp.states import configuration_with
from babyrobot_levels.mdp.tables import hits_of
from babyrobot_levels.render.colors import contrast
from babyrobot_levels.render.raster import polylines
from babyrobot_levels.render.scene import marks
from babyrobot_levels.render.scene.build import build_scene
from babyrobot_levels.render.scene.icons import INK, RIM
from babyrobot_levels.render.scene.layout import CELL, Overlay
from babyrobot_levels.render.scene.shapes import Path, Shape, Text
from babyrobot_levels.render.situation import End, GoodEnds, effects_of

MARGIN = 3
"""The default theme's free space: half of its outer wall, in whole pixels."""


def level(**fields: Any) -> Any:
    display = {"start_text": False, "exit_text": False}
    return Level.from_fields({"version": 1, "size": [5, 5], "display": display, **fields})


def texts(world: Any) -> dict[str, tuple[float, float]]:
    """Return the texts of a picture, and the cell coordinates where they are, with fractions."""
    return {
        shape.text: ((shape.x - MARGIN) / CELL, (shape.y - MARGIN) / CELL)
        for shape in build_scene(world, robot=False).shapes
        if isinstance(shape, Text)
    }


def added(world: Any, plain: Any) -> list[Shape]:
    """Return the shapes that only the first of two pictures has."""
    known = set(build_scene(plain, robot=False).shapes)
    return [shape for shape in build_scene(world, robot=False).shapes if shape not in known]


# -- glass ---------------------------------------------------------------------------------


@pytest.mark.parametrize(("chance", "text"), [(0.004, "<1%"), (0.996, ">99%"), (1 / 3, "33%")])
def test_rounded_chances_are_never_told_as_certain(chance: float, text: str) -> None:
    assert set(texts(level(walls=[{"at": [1, 1], "side": "S", "pass": chance}]))) == {text}


# -- ends ----------------------------------------------------------------------------------


def ends(**fields: Any) -> dict[tuple[int, int], End]:
    return effects_of(level(**fields)).ends


def test_an_end_is_good_if_it_pays() -> None:
    areas = [
        {"at": [1, 1], "reward": 20, "ends": True},
        {"at": [2, 2], "reward": 3, "ends": True},
        {"at": [3, 3], "reward": -10, "ends": True},
    ]
    assert ends(areas=areas, exit="none") == {
        (1, 1): End(is_good=True, costs=False, strength=3),
        (2, 2): End(is_good=True, costs=False, strength=1),
        (3, 3): End(is_good=False, costs=True, strength=2),
    }


@pytest.mark.parametrize(
    ("reward", "step", "exit_reward", "is_good"),
    [
        # A frozen lake: the hole pays nothing, the exit something.
        (0, 0, 1, False),
        # It is not what the exit is for.
        (0, -1, 0, False),
        # There is no better end.
        (0, -1, None, True),
        (-1, -1, None, True),
    ],
)
def test_an_end_that_pays_nothing_is_good_only_if_there_are_no_exits_and_none_pays_more(
    reward: float, step: float, exit_reward: float | None, is_good: bool
) -> None:
    fields: dict[str, Any] = {"areas": [{"at": [1, 1], "reward": reward, "ends": True}]}
    if exit_reward is None:
        fields |= {"exit": "none", "rewards": {"step": step}}
    else:
        fields |= {"rewards": {"step": step, "exit": exit_reward}}
    (end,) = ends(**fields).values()
    assert end.is_good == is_good


def test_exits_blocked_cells_and_warps_are_no_ends_of_areas() -> None:
    fields = {
        "areas": [{"at": [1, 1], "size": [4, 4], "ends": True}],
        "blocked": [{"at": [1, 1], "size": [4, 3]}],
        "warps": [{"at": [1, 4], "to": [0, 0]}],
    }
    assert set(ends(**fields)) == {(2, 4), (3, 4)}


# -- rewards -------------------------------------------------------------------------------


def test_areas_pay_or_cost_beside_a_plain_step() -> None:
    areas = [
        {"at": [1, 0], "reward": 9},
        {"at": [2, 0], "reward": -3},
        {"at": [3, 0], "reward": -21},
        {"at": [1, 1], "reward": -1},
        {"at": [2, 1], "reward": -0.5},
    ]
    found = effects_of(level(areas=areas))
    # That of (2, 1) is only cheaper than other cells.
    assert found.pays == {(1, 0): 2}
    assert found.costs == {(2, 0): 1, (3, 0): 3}


def test_a_price_that_is_the_same_everywhere_is_not_shown() -> None:
    areas = [{"at": [0, 0], "size": [5, 5], "reward": -4}, {"at": [2, 2], "reward": -7}]
    found = effects_of(level(areas=areas))
    assert (found.pays, set(found.costs)) == ({}, {(2, 2)})


def test_puddles_and_exits_have_no_signs() -> None:
    fields = {
        "areas": [{"at": [3, 4], "size": [2, 1], "reward": -4}],
        "puddles": [{"at": [3, 4]}],
        "skid": 0.3,
    }
    found = effects_of(level(**fields))
    assert found.costs == {}
    assert not {(3, 4), (4, 4)} & set(found.skids)


def test_the_reward_of_a_warp_replaces_that_of_its_cell() -> None:
    fields = {
        "areas": [{"at": [1, 0], "size": [3, 1], "reward": -4}],
        "warps": [
            {"at": [1, 0], "to": "start", "reward": -100},
            {"at": [2, 0], "to": [4, 0]},
            {"at": [3, 0], "to": [4, 0], "when": "leave", "reward": 10},
        ],
    }
    found = effects_of(level(**fields))
    assert found.costs == {(1, 0): 3}
    assert found.pays == {(3, 0): 1}


# -- slippery cells and wind ---------------------------------------------------------------


def test_glints_tell_the_chance_to_skid_coarsely() -> None:
    areas = [
        {"at": [0, 0], "size": [5, 1], "skid": 0},
        {"at": [0, 1], "size": [5, 1], "skid": 0.3},
        {"at": [0, 2], "size": [5, 1], "skid": 0.9},
    ]
    found = effects_of(level(areas=areas, skid={"probability": 0.1, "to": "sides"})).skids
    assert {y: {found.get((x, y)) for x in range(4)} for y in range(5)} == {
        0: {None},
        1: {2},
        2: {3},
        3: {1},
        4: {1},
    }


def test_wind_is_not_shown_where_the_robot_is_not_left_to_it() -> None:
    fields = {
        "wind": {"north": [1] * 5, "east": [0, 0, 2, 0, 0]},
        "areas": [{"at": [0, 2], "ends": True}],
        "blocked": [{"at": [1, 2]}],
        "warps": [{"at": [2, 2], "to": [0, 0]}],
    }
    found = effects_of(level(**fields)).winds
    assert {cell: push for cell, push in found.items() if cell[1] == 2} == {
        (3, 2): (2, -1),
        (4, 2): (2, -1),
    }
    assert (4, 4) not in found


# -- pictures ------------------------------------------------------------------------------

MARKS = {
    "chest": {"ends": True, "reward": 5},
    "hole": {"ends": True, "reward": 0},
    "trap": {"ends": True, "reward": -5},
}


def marked(kind: str, size: list[int]) -> Any:
    rewards = {"step": -1, "exit": 1}
    return level(rewards=rewards, areas=[{"at": [1, 1], "size": size, **MARKS[kind]}])


@pytest.mark.parametrize("kind", MARKS)
def test_marks_have_a_rim_and_an_outline_of_which_one_stands_out_on_any_ground(kind: str) -> None:
    rim, outline, *_ = added(marked(kind, [1, 1]), level(rewards={"step": -1, "exit": 1}))
    assert isinstance(rim, Path)
    assert isinstance(outline, Path)
    assert (rim.stroke, outline.stroke or outline.fill) == (RIM, INK)
    grays = [f"#{gray:02x}{gray:02x}{gray:02x}" for gray in range(256)]
    assert all(max(contrast(RIM, ground), contrast(INK, ground)) >= 3 for ground in grays)


def grains(*rewards: float) -> Iterator[list[Any]]:
    """Yield the lines of the grain of each cell of a row with these rewards."""
    areas = [{"at": [x, 1], "label": " "} for x in range(len(rewards))]
    paid = [{**area, "reward": reward} for area, reward in zip(areas, rewards, strict=True)]
    rules: Any = {"size": [len(rewards), 3], "rewards": {"step": -1, "exit": 1}}
    (grain,) = (
        shape
        for shape in added(level(areas=paid, **rules), level(areas=areas, **rules))
        if isinstance(shape, Path)
    )
    assert contrast(grain.stroke or "", level().resolved_theme.colors.base) >= 3
    lines = [line for line, _ in polylines(grain.commands)]
    for x in range(len(rewards)):
        yield [line for line in lines if (line[0][0] - MARGIN) // CELL == x]


def test_ground_that_costs_has_a_grain_of_dashes_more_of_them_for_more() -> None:
    cells = [*grains(-50, -150, -300)]
    assert all(first[1] == last[1] for lines in cells for first, last in lines)
    counts = [len(lines) for lines in cells]
    assert counts == sorted({*counts}), counts


def test_ground_that_pays_has_a_grain_of_crosses() -> None:
    (lines,) = grains(5)
    assert {first[0] == last[0] for first, last in lines} == {True, False}


def test_beside_answers_ground_that_costs_has_a_sign() -> None:
    world = level(areas=[{"at": [1, 1], "reward": -5}])
    answers = Overlay(actions=[[(Action.EAST,)] * 5] * 5)
    known = {*build_scene(level(), overlay=answers, robot=False).shapes}
    shapes = build_scene(world, overlay=answers, robot=False).shapes
    rim, outline, *_ = (each for each in shapes if each not in known)
    assert isinstance(rim, Path)
    assert isinstance(outline, Path)
    assert (rim.stroke, outline.stroke) == (RIM, INK)


def test_marks_and_wind_leave_the_middle_of_a_cell_to_answers() -> None:
    fields = {
        "areas": [{"at": [1, 1], "reward": -5}],
        "wind": {"north": [0, 0, 2, 0, 0]},
        "warps": [{"at": [3, 1], "to": "start", "when": "leave"}],
    }
    answers = Overlay(actions=[[(Action.EAST,)] * 5] * 5)
    shapes = set(build_scene(level(**fields), overlay=answers, robot=False).shapes)
    shapes -= set(build_scene(level(), overlay=answers, robot=False).shapes)
    points = [
        ((x - MARGIN) % CELL, (y - MARGIN) % CELL)
        for shape in shapes
        if isinstance(shape, Path)
        for line, _ in polylines(shape.commands)
        for x, y in line
    ]
    assert points
    assert not [(x, y) for x, y in points if 24 < x < 40 and 24 < y < 40]


def test_wind_has_a_chevron_for_each_cell_it_pushes_and_in_large_levels_one(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    world = level(wind={"north": [1, 2, 3, 4, 5]})

    def chevrons() -> int:
        wind = next(shape for shape in added(world, level()) if isinstance(shape, Path))
        return len([*polylines(wind.commands)])

    winds = effects_of(world).winds
    assert chevrons() == sum(min(-south, 3) for _, south in winds.values()) > len(winds)
    monkeypatch.setattr(marks, "_MANY", len(winds))
    assert chevrons() == len(winds)


# -- warps ---------------------------------------------------------------------------------


def shaft(world: Any) -> list[tuple[float, float]]:
    """Return the line of the only arrow."""
    color = world.resolved_theme.colors.arrows
    shapes = build_scene(world, robot=False).shapes
    (path,) = [s for s in shapes if isinstance(s, Path) and s.stroke == color]
    ((points, _),) = polylines(path.commands)
    return points


@pytest.mark.parametrize(
    ("at", "to"), [([1, 0], [1, 4]), ([3, 4], [3, 0]), ([0, 4], [4, 4]), ([4, 4], [0, 1])]
)
@pytest.mark.parametrize("text", ["A", "label"])
def test_arrows_of_warps_go_around_the_labels_of_their_targets(
    at: list[int], to: list[int], text: str
) -> None:
    label = {"at": to, "label": text, "color": "gold"}
    world = level(warps=[{"at": at, "to": to}], areas=[label], exit="none", start=[2, 2])
    (name,) = [
        s for s in build_scene(world, robot=False).shapes if isinstance(s, Text) and s.text == text
    ]
    half = name.size * 0.3 * len(text)
    for x, y in shaft(world):
        assert not (abs(x - name.x) < half and name.y - name.size < y < name.y)
        assert MARGIN < x < MARGIN + 5 * CELL
        assert MARGIN < y < MARGIN + 5 * CELL


# -- states and good ends --------------------------------------------------------------------------


def test_a_configuration_that_the_level_does_not_have_is_refused() -> None:
    for number in (-1, VAULT.compile().num_configurations):
        with pytest.raises(ValueError, match=f"configuration {number} is not one of the level's"):
            build_scene(VAULT, configuration=number)
    with pytest.raises(ValueError, match="no things"):
        build_scene(level(size=[2, 2]), configuration=1)


def test_an_episode_ends_well_at_an_exit_when_its_needs_are_met() -> None:
    world = level(size=[3, 1], exit_needs=["gem"], items=[{"name": "gem", "at": [1, 0]}])
    before, after = (3 * configuration_with(world, names) for names in ([], ["gem"]))
    ends = GoodEnds(world)
    assert not ends.are_reached(before + 1, before + 2)
    assert ends.are_reached(after + 1, after + 2)
    assert not ends.are_reached(before, after + 1)
    assert GoodEnds(level(size=[3, 1])).are_reached(1, 2)


def test_an_episode_ends_well_where_areas_end_it_and_pay() -> None:
    areas = [{"at": [x, 0], "ends": True, "reward": reward} for x, reward in ((0, 5), (2, -5))]
    ends = GoodEnds(level(size=[4, 1], start=[1, 0], areas=areas))
    assert [ends.are_reached(1, cell) for cell in range(4)] == [True, False, False, True]


@pytest.mark.parametrize(
    ("path", "is_hit"),
    [([[2, 0], [1, 0]], True), ([[2, 1], [2, 0]], True), ([[2, 0], [2, 1]], False)],
)
def test_a_hit_at_the_exit_is_no_good_end(path: list[list[int]], is_hit: bool) -> None:
    """The guard comes from the exit to where the robot was, or comes to the exit as well."""
    world = level(size=[3, 2], start=[1, 0], exit=[2, 0], movers=[{"path": path}])
    mdp = world.compile()
    state = int(mdp.start.argmax())
    assert hits_of(world, mdp)[state, Action.EAST, 0] == is_hit
    after = int(mdp.next_state[state, Action.EAST, 0])
    assert GoodEnds(world).are_reached(state, after) == (not is_hit)
