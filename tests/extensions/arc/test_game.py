"""Levels as games of ARC-AGI-3's engine: transitions, ends and least numbers of actions."""

from __future__ import annotations

import random
import sys
from typing import Any

import numpy as np
import pytest
from support.worlds import level

import babyrobot_levels as brl
from babyrobot_levels.extensions.arc.boards import Color
from babyrobot_levels.extensions.arc.game import ACTIONS

NAMES = [
    *("cellar", "cliff-walking", "drawbridge", "first-key", "frozen-lake-dry", "maze"),
    *("night-watch", "pad-and-door", "sixteen-rooms", "teleport-pads"),
]


def send(game: Any, number: int) -> Any:
    from arcengine import ActionInput, GameAction

    return game.perform_action(ActionInput(id=GameAction.from_id(number)))


def robot_in(frame: Any, size: tuple[int, int]) -> tuple[int, int]:
    """Return the robot's cell, as the 64 x 64 pixels show it."""
    pixels = np.array(frame.frame[-1])
    columns, rows = (2 * side + 1 for side in size)
    scale = min(64 // columns, 64 // rows)
    y, x = np.argwhere(pixels == Color.ROBOT)[0]
    left, top = ((64 - scale * count) // 2 for count in (columns, rows))
    return (x - left) // scale // 2, (y - top) // scale // 2


@pytest.mark.libraries
@pytest.mark.parametrize("name", NAMES)
def test_episodes_are_those_of_the_environment(name: str) -> None:
    from arcengine import GameState

    shorter = brl.load(name).replace(max_steps=50)
    game, env, rng = brl.arc_game(shorter), shorter.make(), random.Random(name)
    base: Any = env.unwrapped
    exits = {*base.level.exits}
    ends = set()
    for _ in range(12):
        frame = send(game, 0)
        env.reset()
        assert frame.state is GameState.NOT_FINISHED
        for _ in range(50):
            number = rng.choice([*ACTIONS])
            frame = send(game, number)
            _, _, terminated, truncated, _ = env.step(ACTIONS[number])
            cell = base.level.compile().cell(base.state)
            assert game.place == base.state
            assert robot_in(frame, base.level.size) == cell
            won = terminated and (cell in exits or base.level.ends_covered)
            expected = GameState.WIN if won else GameState.GAME_OVER
            is_over = terminated or truncated
            assert frame.state is (expected if is_over else GameState.NOT_FINISHED)
            if is_over:
                ends.add(won)
                break
    assert False in ends


@pytest.mark.libraries
def test_a_game_of_several_levels_is_won_in_the_least_number_of_actions() -> None:
    from arcengine import GameState

    names = ["first-key", "maze", "night-watch"]
    game = brl.arc_game(names)
    numbers = {action: number for number, action in ACTIONS.items()}
    frame = send(game, 0)
    assert (frame.win_levels, frame.available_actions) == (3, [1, 2, 3, 4, 5])
    for done, (name, least) in enumerate(zip(names, game.least_actions, strict=True)):
        assert frame.levels_completed == done
        hurried = brl.load(name).replace(rewards={"step": -1, "exit": -1}, max_steps=None)
        best = brl.solve(hurried)
        assert least == round(-best.expected_return)
        for _ in range(least):
            assert frame.state is GameState.NOT_FINISHED
            frame = send(game, numbers[brl.Action(int(best.policy.ravel()[game.place]))])
    assert (frame.state, frame.levels_completed) == (GameState.WIN, 3)


@pytest.mark.libraries
@pytest.mark.parametrize(
    ("given", "message"),
    [
        ("frozen-lake", r"frozen-lake has chance, at \[0, 0\] for example"),
        ("three-gems", "begins in one of 4 states"),
        ("two-pads", "several robots"),
        ("windy-gridworld-king", "diagonal moves"),
        ({"size": [32, 2]}, "32 x 2 cells: arcengine's 64 x 64 pixels hold 31 x 31"),
        ({"size": [4, 1], "exit": [3, 0], "max_steps": 2}, "cannot be won"),
    ],
)
def test_what_the_engine_cannot_hold_is_refused(given: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        brl.arc_game(level(**given) if isinstance(given, dict) else given)


def test_the_package_that_is_missing_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "arcengine", None)
    with pytest.raises(ImportError, match=r"`arcengine`, for Python 3.12"):
        brl.arc_game("first-key")
