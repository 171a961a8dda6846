"""Totals without a discount: loops that pay, cost, cost nothing or cancel out, and risky ends."""

from __future__ import annotations

import pickle
from typing import Any

import numpy as np
import pytest
from support.chains import world
from support.worlds import World

from babyrobot_levels.analysis.solver import model
from babyrobot_levels.analysis.solver.evaluation import evaluate, evaluation_of
from babyrobot_levels.analysis.solver.optimum import solve
from babyrobot_levels.analysis.solver.results import EpisodeTooLongError, UndefinedReturnError
from babyrobot_levels.text.errors import BabyRobotError

INF = float("inf")


def test_an_exit_that_cannot_be_reached() -> None:
    solution = solve(world(rows=["S#E"]))
    assert solution.values[0, 0] == -INF
    assert np.isnan(solution.values[0, 1])
    assert solution.values[0, 2] == 0
    assert solution.endless.tolist() == [[True, False, False]]
    assert not solution.unbounded.any()
    assert (solution.expected_return, solution.expected_steps) == (-INF, INF)
    assert solution.exit_probability == 0
    assert solution.greedy[0, 0].all()


def test_an_infinite_return_is_explained() -> None:
    shut = world(rows=["S#E"])
    solution = solve(shut)
    assert solution.diverging_cells == ((0, 0),)
    assert solution.explanation == (
        "the expected return is -inf, because an episode may go on for ever around [0, 0], where "
        "costs add up without bound; a discount below 1, such as 0.99, or a limit of steps, such "
        "as within=200, makes it finite"
    )
    assert solve(shut, 0.99).explanation is None
    gold = world(rows=["S    E"], areas=[{"at": [3, 0], "reward": 5}])
    solution = solve(gold)
    assert (3, 0) in solution.diverging_cells
    assert solution.explanation is not None
    assert "around [3, 0], where" in solution.explanation
    assert "(rule BR504, unbounded-return)" in solution.explanation
    # Of many cells, the first few are listed.
    corridor = evaluation_of(world(rows=["S" + " " * 9]), "random")
    assert len(corridor.diverging_cells) == 10
    assert "[4, 0], …, where" in str(corridor.explanation)


def test_no_loop_is_named_that_cannot_be_reached() -> None:
    # The robot falls to the left or to the right, and into the pit on one side only.
    level = world(rows=["  S E"], areas=[{"at": [0, 0], "reward": -3}])
    found = evaluation_of(level, np.array([[2, 4, 4, 4, -1]]))
    assert found.diverging_cells == ((0, 0), (1, 0))
    right = evaluation_of(level, np.array([[0, 0, 2, 2, -1]]))
    assert (right.diverging_cells, right.explanation) == ((), None)
    assert np.isneginf(right.values[0, :2]).all()


def test_a_cell_that_is_a_trap() -> None:
    trap = [{"at": [1, 0], "to": [1, 0], "when": "leave"}]
    level = world(rows=["S  E", "   #"], warps=trap)
    solution = solve(level)
    assert solution.values[0, 0] == -4
    assert solution.endless.tolist() == [[False, True, False, False], [False] * 4]
    level["walls"] = [{"at": [1, 1], "side": "E"}]
    solution = solve(level)
    assert solution.endless.tolist() == [[True, True, False, False], [True, True, False, False]]


def test_where_the_end_can_only_be_reached_with_a_risk() -> None:
    # The way to the exit leads over ice, where one step in six or more ends in the trap, for good.
    level = world(
        rows=["S E", "X X"],
        areas=[{"at": [1, 0], "skid": {"probability": 0.5, "to": "others"}}],
        warps=[{"at": [1, 1], "to": [1, 1], "when": "leave"}],
        rewards={"exit": 10},
    )
    solution = solve(level)
    # It can end for sure at the X, and should not risk an endless loop.
    assert solution.endless.tolist() == [[False, True, False], [False, True, False]]
    assert solution.expected_return == -1
    assert solution.policy[0, 0] == 3
    level["walls"] = [{"at": [0, 0], "side": "S"}]
    solution = solve(level)
    assert solution.expected_return == -INF
    # Nothing helps, but it tries.
    assert solution.policy[0, :2].tolist() == [2, 2]
    assert solution.exit_probability == pytest.approx(0.75)
    assert solution.expected_steps == INF


def test_a_loop_that_pays() -> None:
    level = world(rows=["S  E"], areas=[{"at": [1, 0], "reward": 1.5}])
    solution = solve(level, actions="moves")
    assert solution.values.tolist() == [[INF, INF, INF, 0]]
    assert solution.unbounded.tolist() == [[True, True, True, False]]
    assert (solution.expected_return, solution.expected_steps) == (INF, INF)
    with pytest.warns(RuntimeWarning, match="rewards add up without bound .*BR504"):
        assert evaluate(level, solution).expected_return == INF
    # The last move onto the exit is the only one that ends it.
    assert solution.action_values[0, 2, 1] == 0
    assert not solution.greedy[0, 2, 1]
    # With a discount, all is finite.
    assert np.isfinite(solve(level, 0.9).values).all()


def test_a_loop_that_pays_behind_a_door_of_luck() -> None:
    level = world(
        rows=["S E", "  #"],
        walls=[{"at": [0, 0], "side": "S", "pass": 0.001}],
        areas=[{"at": [0, 1], "reward": 1}],
        rewards={"bounce": -1000},
    )
    assert solve(level).values[0, 0] == INF
    level["areas"] = []
    assert solve(level).values[0, 0] == -1


def test_loops_that_cost_nothing() -> None:
    # Rest is free: at a price, the exit is not worth the way, and the way not worth the exit.
    level = world(rows=["S  E"], rewards={"step": -1, "stay": 0, "exit": 1.5})
    solution = solve(level)
    assert solution.values.tolist() == [[0, 0.5, 1.5, 0]]
    assert solution.policy.tolist() == [[0, 2, 2, -1]]
    assert solution.expected_steps == INF
    assert evaluate(level, solution).values.tolist() == solution.values.tolist()


def test_who_can_end_for_nothing_does() -> None:
    solution = solve(world(rows=["S   E", "     "], rewards={"step": 0}))
    assert (solution.values == 0).all()
    assert solution.greedy[:, :4].all()
    assert solution.policy[0].tolist() == [2, 2, 2, 2, -1]
    assert (solution.expected_steps, solution.exit_probability) == (4, 1)


def test_the_lake_whose_safest_moves_go_round_in_circles() -> None:
    solution = solve("frozen-lake")
    # At the side, driving into the wall is safe, and as good as whatever comes next.
    assert solution.greedy[0, 0].sum() > 1
    assert solution.expected_steps == pytest.approx(48.705882352941)
    assert evaluate("frozen-lake", solution).expected_return == pytest.approx(14 / 17)


def test_rewards_that_cancel_out() -> None:
    level = world(rows=["S   "], rewards={"closer": 1, "farther": -1, "stay": -1, "bump": -1})
    level |= {"exit": [3, 0], "walls": [{"at": [2, 0], "side": "E"}]}
    with pytest.raises(
        UndefinedReturnError, match=r"around \[0, 0\] .* a discount below 1"
    ) as caught:
        solve(level)
    assert isinstance(caught.value, BabyRobotError)
    assert caught.value.cell == (0, 0)
    copy = pickle.loads(pickle.dumps(caught.value))
    assert (str(copy), copy.cell) == (str(caught.value), (0, 0))
    assert np.isfinite(solve(level, 0.9).values).all()
    there_and_back = np.array([[2, 4, 4, 4]])
    with pytest.raises(UndefinedReturnError):
        evaluate(level, there_and_back)
    assert np.isfinite(evaluate(level, there_and_back, 0.9).values).all()


def test_rewards_that_cancel_out_but_for_rounding() -> None:
    # 0.1 + 0.2 - 0.3 is not 0 in floating point.
    areas = [{"at": [x, 0], "reward": r} for x, r in enumerate((-0.3, 0.1, 0.2))]
    level = world(rows=["S  "], areas=areas, warps=[{"at": [2, 0], "to": [0, 0], "when": "leave"}])
    level["rewards"] = {"bump": -1, "stay": -1}
    with pytest.raises(UndefinedReturnError):
        evaluate(level, np.array([[2, 2, 2]]))
    with pytest.raises(UndefinedReturnError):
        solve(level)


def test_what_cancels_out_does_not_matter_where_ending_is_better() -> None:
    # Back and forth is worth no more than 1 at any time, and the exit is worth 5.
    rewards = {"closer": 1, "farther": -1, "stay": -1, "bump": -1, "exit": 5}
    level = world(rows=["S   E"], rewards=rewards)
    assert solve(level).values.tolist() == [[8, 7, 6, 5, 0]]
    level["rewards"] = {**rewards, "exit": -5}
    with pytest.raises(UndefinedReturnError):
        solve(level)
    # The same rewards, with a hundred for the exit.
    assert solve("image-maze").exit_probability == 1


def icy_ridge(width: int, top: int, step: float) -> World:
    """Return a level with a ridge of ice: one step in two slips off it, back to the start.

    It takes some 2^width steps to get across. At the top, if it is far enough from the ridge,
    there is a safe way round.
    """
    middle = range(1, width - 1)
    return {
        "version": 1,
        "size": [width, top + 2],
        "start": [0, top],
        "exit": [width - 1, top],
        "areas": [
            {"at": [1, top], "size": [width - 2, 1], "skid": {"probability": 0.5, "to": "sides"}}
        ],
        "warps": [{"at": [x, y], "to": "start"} for x in middle for y in (top - 1, top + 1)],
        "rewards": {"step": step, "exit": 1},
    }


@pytest.mark.parametrize(("width", "step"), [(20, -1), (80, -1), (80, 0)])
def test_a_way_that_is_short_only_with_a_lot_of_luck(width: int, step: float) -> None:
    solution = solve(icy_ridge(width, 2, step))
    assert solution.expected_return == pytest.approx(1 + step * (width + 2), abs=1e-10)
    assert solution.expected_steps == pytest.approx(width + 3, abs=1e-10)
    assert solution.policy[2, 0] == 1
    assert solution.residual < 1e-10


def test_ways_that_are_too_long_for_floating_point() -> None:
    level = icy_ridge(80, 1, -1)
    for policy in ("random", np.full((3, 80), 2)):
        with pytest.raises(EpisodeTooLongError, match="a discount below 1"):
            evaluate(level, policy)
        # With a discount all is well; only how it ends cannot be told.
        found = evaluate(level, policy, 0.9)
        assert found.expected_return == pytest.approx(-10, abs=0.1)
        assert found.expected_steps == INF
        assert np.isnan(found.exit_probability)
    with pytest.raises(EpisodeTooLongError):
        solve(level)
    assert solve(level, 0.9).residual < 1e-10


def test_layers_around_the_end_are_not_peeled_off_one_by_one(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Where steps cost nothing, whoever moves on may end: there is no loop but to stay."""
    found = []

    def counted(*given: Any) -> Any:
        found.append(given)
        return strong_components(*given)

    strong_components = model.strong_components
    monkeypatch.setattr(model, "strong_components", counted)
    free = {"version": 1, "size": [12, 12], "skid": 0.4, "rewards": {"step": 0, "exit": 1}}
    assert solve(free).expected_return == pytest.approx(1)
    assert len(found) <= 4
