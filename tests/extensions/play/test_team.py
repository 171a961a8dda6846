"""Two robots in the terminal: two sets of keys, and a step once both have their action."""

from __future__ import annotations

from pathlib import Path

import pytest
from support.games import DOWN, LEFT, RIGHT, UP, Game

import babyrobot_levels as brl
from babyrobot_levels.agents.verify import verify_play

TWO_PADS = "two-pads"


@pytest.mark.slow
def test_two_players_share_the_keyboard(tmp_path: Path) -> None:
    with Game(tmp_path, TWO_PADS, "--seed", "1", "--record", "a.brlplay") as game:
        assert "WASD red · ←↑↓→ blue" in game.until("Move all robots to the exit. And red?")
        game.press(RIGHT)
        game.until("blue: east. And red?")
        # Until both have chosen, a choice can be changed, or taken back.
        game.press(DOWN + b"u")
        game.until("And red?")
        game.press(b"h")
        game.until("Hint: red east, blue east.")
        game.press(b"d" + RIGHT)
        told = game.until("The pad is covered.")
        assert "Red moves east. Blue moves east." in told
        assert "step 1 of 100   reward -2   return -2" in told
        # The space bar is for who is asked.
        game.press(b"d ")
        game.until("Red moves east. Blue waits.")
        game.press(b"s" + b" " + b"d" + b" " + b" " + RIGHT)
        game.until("step 5 ")
        game.press(b"w" + UP + RIGHT)
        screen = game.until("All have arrived! Well done.")
        assert "best average -10 within 100 steps   help: 1 hint" in screen
        game.press(b"q")
        assert game.ended()[1].startswith("two-pads: arrived after 7 steps, return -1")
    (play,) = brl.read_plays(tmp_path / "a.brlplay")
    assert (play.end, play.steps, verify_play(play).fault) == ("terminated", 7, None)


@pytest.mark.slow
def test_a_team_does_not_turn(tmp_path: Path) -> None:
    with Game(tmp_path, TWO_PADS, "--actions", "turns") as game:
        status, told = game.ended()
    assert status == 2
    assert "the robots of a team do not turn" in told


@pytest.mark.slow
def test_a_team_without_tables_is_played_without_an_optimum(tmp_path: Path) -> None:
    corners = [{"name": "red", "start": [0, 0]}, {"name": "blue", "start": [29, 0]}]
    level = brl.load({"version": 1, "size": [30, 30], "exit": [1, 0], "robots": corners})
    level.save(tmp_path / "room.yaml")
    with Game(tmp_path, "room.yaml", "--seed", "1") as game:
        game.until("And red?")
        game.press(b"h")
        game.until("There is no hint: there are too many joint states to know the optimum.")
        game.press(b"d" + LEFT)
        game.until("Red moves east, and has arrived. Blue moves west.")
        game.press(b"u")
        game.until("Undone: back at the step before after 0 steps.")
        game.press(b"q")
        assert game.ended()[1].startswith("room: stopped after 0 steps, return 0, help: 1 undo")
    with Game(tmp_path, "room.yaml", "--record", "a.brlplay") as game:
        status, told = game.ended()
    assert status == 2
    assert "the tables would have more than 25,000,000 outcomes" in told
