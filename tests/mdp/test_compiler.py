"""The exact tables: their laws, and the rules of the language case by case."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
from hypothesis import given
from support.worlds import World, level_of, worlds

from babyrobot_levels import Action
from babyrobot_levels.mdp.tables import FREE, GLASS, REFUSED, Mdp

Cell = tuple[int, int]
Outcomes = dict[tuple[Cell, float, bool], float]
"""Probability by (next cell, reward, terminal)."""

STAY, NORTH, EAST, SOUTH, WEST, *_ = Action


def outcomes(world: World, cell: Cell, action: int) -> Outcomes:
    """Return what the compiled level leads to, by cell."""
    mdp = level_of(world).compile()
    found = mdp.outcomes(cell[1] * mdp.width + cell[0], action)
    return {
        ((state % mdp.width, state // mdp.width), reward, terminal): probability
        for probability, state, reward, terminal in found
    }


def chances(world: World, cell: Cell, action: int) -> dict[Cell, float]:
    """Return the probability of each next cell, rounded."""
    result: dict[Cell, float] = {}
    for (after, _, _), probability in outcomes(world, cell, action).items():
        result[after] = round(result.get(after, 0) + probability, 12)
    return result


def only(world: World, cell: Cell, action: int) -> tuple[Cell, float, bool]:
    """Return the one outcome of an action."""
    ((outcome, probability),) = outcomes(world, cell, action).items()
    assert probability == 1.0
    return outcome


def corridor(width: int, **fields: object) -> World:
    """Return a level of one row with the exit at its eastern end."""
    return {"version": 1, "size": [width, 1], **fields}


def field(size: int = 3, **fields: object) -> World:
    """Return an empty square without an exit."""
    return {"version": 1, "size": [size, size], "exit": "none", **fields}


# -- laws ------------------------------------------------------------------------------------


@given(worlds())
def test_target_is_where_an_action_leads_without_chance(world: World) -> None:
    warps = [
        {k: v for k, v in warp.items() if k != "probability"} for warp in world.get("warps", [])
    ]
    calm = {**world, "skid": None, "puddles": [], "areas": [], "warps": warps}
    if "wind" in calm:
        calm["wind"] = {**calm["wind"], "varies": False, "probability": 1}
    level = level_of({name: value for name, value in calm.items() if value is not None})
    mdp = level.compile()
    anywhere = sorted(int(state) for state in np.flatnonzero(mdp.start))
    for state in range(mdp.num_states):
        for action in range(5):
            found = mdp.outcomes(state, action)
            target = int(mdp.intended_next_state[state, action])
            if mdp.obstruction[state, action] == GLASS:
                assert target == mdp.num_states or target in {after for _, after, _, _ in found}
            elif target == mdp.num_states:
                assert sorted({after for _, after, _, _ in found}) == anywhere
            else:
                assert {after for _, after, _, _ in found} == {target}


def test_arrays_are_as_documented_and_read_only() -> None:
    mdp = level_of(field(skid=0.5)).compile()
    states, actions = mdp.width * mdp.height, 5
    most = mdp.probability.shape[2]
    shapes = {
        "probability": ((states, actions, most), np.float64),
        "next_state": ((states, actions, most), np.int32),
        "reward": ((states, actions, most), np.float64),
        "terminal": ((states, actions, most), np.bool_),
        "start": ((states,), np.float64),
        "is_terminal": ((states,), np.bool_),
        "action_mask": ((states, actions), np.int8),
        "intended_next_state": ((states, actions), np.int32),
        "obstruction": ((states, actions), np.int8),
    }
    for name, (shape, dtype) in shapes.items():
        array = getattr(mdp, name)
        assert (array.shape, array.dtype) == (shape, dtype), name
        with pytest.raises(ValueError, match="read-only"):
            array[...] = 0

    copy: Mdp = pickle.loads(pickle.dumps(mdp))
    assert (copy.next_state == mdp.next_state).all()
    with pytest.raises(ValueError, match="read-only"):
        copy.next_state[...] = 0


def test_tables_are_made_once_and_shared() -> None:
    level = level_of(field())
    assert level.compile() is level.compile()
    assert level.grid() is level.grid()


# -- skidding ----------------------------------------------------------------------------------


def test_open_shares_the_skid_among_the_other_open_directions() -> None:
    world = field(skid=0.3, walls=[{"at": [1, 1], "side": "W"}])
    assert chances(world, (1, 1), NORTH) == {(1, 0): 0.7, (2, 1): 0.15, (1, 2): 0.15}


def test_open_does_not_skid_when_a_wall_refuses_the_move() -> None:
    assert chances(field(skid=0.3), (0, 0), NORTH) == {(0, 0): 1.0}


def test_open_stays_where_no_other_direction_is_open() -> None:
    world = corridor(2, skid=0.3, rewards={"bump": -9})
    assert outcomes(world, (0, 0), EAST) == {((1, 0), 0.0, True): 0.7, ((0, 0), -1.0, False): 0.3}


def test_open_never_skids_into_glass() -> None:
    world = field(skid=0.3, walls=[{"at": [1, 1], "side": "W", "pass": 1}])
    assert chances(world, (1, 1), NORTH) == {(1, 0): 0.7, (2, 1): 0.15, (1, 2): 0.15}


def test_sides_skids_left_and_right_and_stays_at_walls() -> None:
    world = field(skid={"probability": 0.5, "to": "sides"}, walls=[{"at": [1, 1], "side": "W"}])
    assert chances(world, (1, 1), NORTH) == {(1, 0): 0.5, (2, 1): 0.25, (1, 1): 0.25}
    assert chances(world, (0, 0), NORTH) == {(0, 0): 0.75, (1, 0): 0.25}


def test_others_skids_in_all_three_other_directions() -> None:
    world = field(skid={"probability": 0.75, "to": "others"}, walls=[{"at": [1, 1], "side": "S"}])
    expected = {(1, 0): 0.25, (2, 1): 0.25, (0, 1): 0.25, (1, 1): 0.25}
    assert chances(world, (1, 1), NORTH) == expected


@pytest.mark.parametrize("rule", ["sides", "others"])
def test_glass_is_a_wall_to_a_skid(rule: str) -> None:
    world = field(
        skid={"probability": 1, "to": rule}, walls=[{"at": [1, 1], "side": "E", "pass": 1}]
    )
    assert (2, 1) not in chances(world, (1, 1), NORTH)


# -- glass -------------------------------------------------------------------------------------


def glass(**fields: object) -> World:
    """Return a corridor of three with glass on the east of its middle cell."""
    wall = {"at": [1, 0], "side": "E", "pass": 0.25}
    return corridor(4, walls=[wall], **fields)


def test_glass_lets_through_or_bounces_the_robot_back() -> None:
    assert outcomes(glass(), (1, 0), EAST) == {
        ((0, 0), -2.0, False): 0.75,
        ((2, 0), -1.0, False): 0.25,
    }


def test_a_bounce_stays_where_a_wall_is_behind() -> None:
    world = corridor(3, walls=[{"at": [0, 0], "side": "E", "pass": 0.25}], rewards={"bump": -50})
    assert outcomes(world, (0, 0), EAST) == {
        ((0, 0), -2.0, False): 0.75,
        ((1, 0), -1.0, False): 0.25,
    }


def test_a_bounce_stays_where_glass_is_behind() -> None:
    wall = {"at": [1, 0], "pass": 0.25}
    world = corridor(3, walls=[{**wall, "side": "E"}, {**wall, "side": "W"}], exit="none")
    assert chances(world, (1, 0), EAST) == {(1, 0): 0.75, (2, 0): 0.25}


def test_skidding_makes_glass_harder_and_nothing_else() -> None:
    for rule in ("open", "sides", "others"):
        world = glass(skid={"probability": 0.5, "to": rule})
        assert chances(world, (1, 0), EAST) == {(2, 0): 0.125, (0, 0): 0.875}


def test_glass_that_always_lets_through_is_still_glass() -> None:
    world = corridor(3, walls=[{"at": [0, 0], "side": "E", "pass": 1}])
    assert only(world, (0, 0), EAST) == ((1, 0), -1.0, False)
    assert level_of(world).compile().obstruction[0, EAST] == GLASS
    assert level_of(world).compile().action_mask[0].tolist() == [1, 0, 1, 0, 0]


def test_glass_beside_a_blocked_cell_is_a_wall() -> None:
    world = corridor(
        3, start=[1, 0], blocked=[{"at": [0, 0]}], walls=[{"at": [1, 0], "side": "W", "pass": 1}]
    )
    assert only(world, (1, 0), WEST)[0] == (1, 0)
    assert level_of(world).compile().obstruction[1, WEST] == REFUSED


# -- warps -------------------------------------------------------------------------------------


def test_a_chain_of_warps_is_followed_and_its_first_reward_counts() -> None:
    warps = [
        {"at": [1, 0], "to": [2, 0]},
        {"at": [2, 0], "to": [4, 0], "reward": 5},
        {"at": [4, 0], "to": [3, 0], "reward": 7},
    ]
    assert only(corridor(6, warps=warps), (0, 0), EAST) == ((3, 0), 5.0, False)


def test_a_warp_to_an_exit_gives_the_exits_reward_unless_it_has_its_own() -> None:
    warp = {"at": [1, 0], "to": [3, 0]}
    rewards = {"exit": 10}
    assert only(corridor(4, warps=[warp], rewards=rewards), (0, 0), EAST) == ((3, 0), 10.0, True)
    warped = corridor(4, warps=[{**warp, "reward": 2}], rewards=rewards)
    assert only(warped, (0, 0), EAST) == ((3, 0), 2.0, True)


def test_a_warp_to_start_leads_to_each_start_evenly() -> None:
    world = corridor(4, start=[[0, 0], [1, 0]], warps=[{"at": [2, 0], "to": "start", "reward": -9}])
    assert outcomes(world, (1, 0), EAST) == {((0, 0), -9.0, False): 0.5, ((1, 0), -9.0, False): 0.5}


def test_moves_from_a_warp_that_is_refused_are_warped() -> None:
    """Nobody can stand on the warp, but the tables follow the rules there as well."""
    world = field(warps=[{"at": [2, 0], "to": [1, 1], "reward": 3}])
    assert only(world, (2, 0), NORTH) == ((1, 1), 3.0, False)
    assert only(world, (2, 0), STAY) == ((2, 0), -1.0, False)


def test_a_bounce_onto_a_warp_is_warped_and_costs_as_well() -> None:
    world = glass(start=[1, 0], warps=[{"at": [0, 0], "to": [1, 0], "reward": 3}])
    assert outcomes(world, (1, 0), EAST)[(1, 0), 2.0, False] == 0.75


def test_leave_acts_on_every_move_and_on_no_stay() -> None:
    world = field(
        start=[0, 0],
        skid=1.0,
        wind={"south": [1, 1, 1]},
        warps=[{"at": [1, 0], "to": [2, 2], "when": "leave", "reward": 4}],
        rewards={"bump": -5},
    )
    for action in (NORTH, EAST, SOUTH, WEST):
        assert only(world, (1, 0), action) == ((2, 2), 4.0, False)
    assert only(world, (1, 0), STAY) == ((1, 0), -1.0, False)
    assert level_of(world).compile().action_mask[1].tolist() == [1, 1, 1, 1, 1]
    assert (level_of(world).compile().obstruction[1] == FREE).all()


@pytest.mark.parametrize("when", ["enter", "leave"])
def test_where_the_episode_is_over_a_warp_does_nothing(when: str) -> None:
    world = corridor(
        4, areas=[{"at": [1, 0], "ends": True}], warps=[{"at": [1, 0], "to": [2, 0], "when": when}]
    )
    for action in (STAY, NORTH, EAST, SOUTH, WEST):
        assert only(world, (1, 0), action) == ((1, 0), 0.0, True)


# -- wind --------------------------------------------------------------------------------------


def test_wind_is_that_of_the_cell_that_is_left() -> None:
    world = field(5, wind={"north": [0, 2, 0, 0, 0]})
    assert only(world, (1, 4), EAST)[0] == (2, 2)
    assert only(world, (0, 4), EAST)[0] == (1, 4)


def test_the_moves_own_axis_comes_first() -> None:
    """East first and then north: the wall over (1, 2) is in the way, the one over (2, 2) not."""
    world = field(wind={"north": [0, 1, 0]}, walls=[{"at": [1, 2], "side": "N"}])
    assert only(world, (1, 2), EAST)[0] == (2, 1)
    world = field(wind={"north": [0, 1, 0]}, walls=[{"at": [2, 2], "side": "N"}])
    assert only(world, (1, 2), EAST)[0] == (2, 2)


def test_wind_stops_at_walls_and_at_glass() -> None:
    for chance in (0, 1):
        wall = {"at": [0, 1], "side": "N", "pass": chance}
        world = field(4, wind={"north": [3, 0, 0, 0]}, walls=[wall])
        assert only(world, (0, 3), NORTH)[0] == (0, 1)


def test_a_move_that_the_wind_cancels_is_not_refused() -> None:
    world = field(wind={"south": [1, 0, 0]}, rewards={"bump": -5})
    for cell in ((0, 0), (0, 1)):
        assert only(world, cell, NORTH) == (cell, -1.0, False)
        assert level_of(world).compile().action_mask[cell[1] * 3, NORTH] == 1


def test_a_refused_move_still_drifts_and_bumps() -> None:
    world = field(wind={"east": [1, 0, 0]}, rewards={"bump": -5})
    assert only(world, (0, 0), NORTH) == ((1, 0), -5.0, False)


def test_a_move_that_the_wind_cancels_may_skid() -> None:
    """The wind keeps the robot off the wall, so that the wall does not refuse the move."""
    world = field(skid=0.5, wind={"south": [1, 0, 0]})
    assert chances(world, (0, 0), NORTH) == {(0, 0): 0.5, (1, 1): 0.25, (0, 2): 0.25}


def test_a_bounce_is_not_moved_by_wind() -> None:
    world = field(wind={"south": [0, 1, 0]}, walls=[{"at": [1, 0], "side": "E", "pass": 0.25}])
    assert chances(world, (1, 0), EAST) == {(0, 0): 0.75, (2, 1): 0.25}


def test_glass_is_not_tried_when_the_wind_cancels_the_move() -> None:
    world = corridor(
        3, exit="none", wind={"west": [1]}, walls=[{"at": [1, 0], "side": "E", "pass": 1}]
    )
    assert only(world, (1, 0), EAST) == ((1, 0), -1.0, False)


# -- rewards and ends --------------------------------------------------------------------------


def test_rewards_come_in_the_order_of_the_language() -> None:
    area = {"at": [0, 0], "size": [3, 1], "reward": -3}
    world = corridor(4, start=[1, 0], areas=[area])
    assert only(world, (1, 0), WEST)[1] == -3
    closer = {**world, "rewards": {"closer": 2, "farther": -7}}
    assert only(closer, (1, 0), WEST)[1] == -7
    assert only(closer, (1, 0), EAST)[1] == 2
    assert only(closer, (2, 0), EAST)[1] == 0
    assert only(closer, (1, 0), NORTH)[1] == -3
    bump = {**world, "rewards": {"closer": 2, "farther": -7, "bump": -5}}
    assert only(bump, (1, 0), NORTH)[1] == -5
    assert only(bump, (1, 0), STAY)[1] == -3


def test_a_puddle_wins_over_an_area_and_an_area_over_step() -> None:
    world = corridor(
        5,
        areas=[{"at": [1, 0], "size": [2, 1], "reward": -3}],
        puddles=[{"at": [1, 0], "size": "large"}],
        rewards={"step": -7},
    )
    assert only(world, (0, 0), EAST)[1] == -4
    assert only(world, (3, 0), WEST)[1] == -3
    assert outcomes(world, (2, 0), EAST) == {((3, 0), -7.0, False): 1.0}


def test_later_areas_win_property_by_property() -> None:
    areas = [
        {"at": [1, 0], "reward": -3, "ends": True},
        {"at": [1, 0], "skid": 0.5},
        {"at": [1, 0], "reward": -4},
    ]
    assert only(corridor(3, areas=areas), (0, 0), EAST) == ((1, 0), -4.0, True)
    areas.append({"at": [1, 0], "ends": False})
    assert only(corridor(3, areas=areas), (0, 0), EAST) == ((1, 0), -4.0, False)
    assert chances(corridor(3, areas=areas), (1, 0), EAST) == {(2, 0): 0.5, (0, 0): 0.5}


def test_a_number_means_the_rule_open_whatever_the_level_says() -> None:
    world = field(skid={"probability": 0.5, "to": "others"}, areas=[{"at": [0, 0], "skid": 0.5}])
    assert chances(world, (0, 0), NORTH) == {(0, 0): 1.0}


def test_puddle_types_keep_what_is_not_given() -> None:
    world = corridor(4, puddles=[{"at": [1, 0]}], puddle_types={"small": {"reward": -9}})
    assert only(world, (0, 0), EAST)[1] == -9
    assert chances(world, (1, 0), EAST) == {(2, 0): 0.6, (0, 0): 0.4}


def test_stay_gives_the_reward_of_the_own_cell_or_its_own() -> None:
    world = corridor(3, puddles=[{"at": [1, 0]}])
    assert only(world, (1, 0), STAY) == ((1, 0), -2.0, False)
    assert only({**world, "rewards": {"stay": 0.5}}, (1, 0), STAY) == ((1, 0), 0.5, False)


def test_closer_and_farther_speak_of_the_nearest_exit_as_the_crow_flies() -> None:
    rewards = {"closer": 1, "farther": -2, "step": 0}
    world = {
        "version": 1,
        "size": [7, 1],
        "start": [3, 0],
        "exit": [[0, 0], [6, 0]],
        "rewards": rewards,
    }
    assert only(world, (3, 0), WEST)[1] == 1
    assert only(world, (3, 0), EAST)[1] == 1
    assert only(world, (2, 0), EAST)[1] == -2
    level = {"version": 1, "size": [4, 1], "start": [0, 0], "exit": [[0, 0], [3, 0]]}
    level |= {"start": [1, 0], "rewards": rewards, "walls": [{"at": [1, 0], "side": "W"}]}
    assert only(level, (1, 0), EAST)[1] == 0, "as far from the one as from the other"


def test_the_tables_can_be_had_as_gymnasium_has_them() -> None:
    mdp = level_of(corridor(2)).compile()
    with_stay, moves = mdp.to_toy_text(), mdp.to_toy_text(first_action=1)
    assert with_stay[0][EAST] == moves[0][EAST - 1] == [(1.0, 1, 0.0, True)]
    assert sorted(with_stay[0]) == [0, 1, 2, 3, 4]
    assert sorted(moves[0]) == [0, 1, 2, 3]
