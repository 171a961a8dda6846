"""`babyrobot play` in a terminal: its keys, its screen, and the terminal as it is left."""

from __future__ import annotations

import os
import re
import select
import signal
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from support.combinations import swept
from support.games import COMMAND, DOWN, LEFT, RIGHT, UP, Game, pty, termios
from support.sessions import environment

import babyrobot_levels as brl
from babyrobot_levels.agents.verify import verify_play

WAY_OUT = b"\x1b[C" * 3 + b"\x1b[B" * 3

LEVEL = """
version: 1
title: The yard
size: [4, 4]
walls: [{at: [0, 0], side: S}, {at: [1, 0], side: S, pass: 0.0001}]
"""


@pytest.fixture
def yard(tmp_path: Path) -> Iterator[Game]:
    (tmp_path / "yard.yaml").write_text(LEVEL, encoding="utf-8")
    with Game(tmp_path, "yard.yaml", "--seed", "1") as game:
        game.until("Move the robot to the exit.")
        yield game


def place(screen: str) -> tuple[int, int]:
    """Return the cell in which the robot is on a screen."""
    lines = screen.splitlines()
    top = next(row for row, line in enumerate(lines) if "┌" in line)
    row = next(row for row, line in enumerate(lines) if "☻" in line)
    return (lines[row].index("☻") - 3) // 4, (row - top - 1) // 2


def test_the_first_screen(yard: Game) -> None:
    lines = [line.strip() for line in yard.screen.splitlines()]
    assert lines[0] == "The yard"
    assert "step 0   reward 0   return 0" in lines
    assert lines[-1] == (
        "←↑↓→ or WASD move · space stays · h hints · u undoes · r restarts · q quits"
    )
    assert place(yard.screen) == (0, 0)


def test_arrows_and_letters_move_the_robot(yard: Game) -> None:
    keys = [(RIGHT, LEFT), (b"d", b"a"), (b"D", b"A"), (b"\x1bOC", b"\x1bOD"),
            (b"\x1b[1;5C", b"\x1b[1;5D")]  # fmt: skip
    for number, (right, left) in enumerate(keys):
        yard.press(right)
        assert place(yard.until(f"step {2 * number + 1} ")) == (1, 0)
        yard.press(left)
        assert place(yard.until(f"step {2 * number + 2} ")) == (0, 0)
    # He can stay, and other keys do nothing.
    yard.press(b"x\x1b[5~\x1b[200~\xc3\xa4\x1a\t\r" + b" ." + RIGHT + RIGHT + b"s")
    assert place(yard.until("step 15 ")) == (2, 1)
    yard.press(UP)
    screen = yard.until("step 16 ")
    assert place(screen) == (2, 0)
    assert "reward -1   return -16" in screen


def test_a_wall_is_a_bump_and_glass_throws_back(yard: Game) -> None:
    yard.press(DOWN)
    assert place(yard.until("Bump! A wall in the south.")) == (0, 0)
    yard.press(RIGHT)
    assert "Bump" not in yard.until("step 2 ")
    yard.press(DOWN)
    assert place(yard.until("The glass throws the robot back.")) == (1, 0)


def test_the_exit_ends_the_game_and_it_can_begin_anew(yard: Game) -> None:
    yard.press(WAY_OUT)
    screen = yard.until("The exit! Well done.")
    assert place(screen) == (3, 3)
    assert "move" not in screen
    yard.press(LEFT + b"r" + RIGHT)
    assert place(yard.until("step 1 ")) == (1, 0)
    yard.press(b"r" + WAY_OUT + b"q")
    assert yard.ended() == (0, "yard: reached the exit after 6 steps, return -5, best average -5\n")
    assert yard.is_restored


def test_hints_and_undo_are_told_with_the_best_average(tmp_path: Path) -> None:
    with Game(tmp_path, "frozen-lake", "--seed", "4") as game:
        game.until("step 0 of 100")
        game.press(b"uh?")
        assert "help: 1 hint" in game.until("Hint: move west.")
        game.press(b"s" * 30)
        ended = game.until("The episode is over.")
        assert "best average 0.74 within 100 steps   help: 1 hint" in ended
        game.press(b"h")
        game.until("There is no hint: the episode has ended.")
        # What is taken back comes again by the same actions, and can be played in another way.
        game.press(b"u")
        game.until("Undone: back at [")
        game.press(b"s")
        assert game.until("The episode is over.") == ended.replace("1 hint", "1 hint, 1 undo")
        game.press(b"q")
        assert game.ended()[1].endswith(
            "best average 0.74 within 100 steps, help: 1 hint, 1 undo\n"
        )


def test_a_play_without_what_was_undone_is_valid(tmp_path: Path) -> None:
    with Game(tmp_path, "frozen-lake", "--seed", "4", "--record", "a.brlplay") as game:
        game.until("step 0 of 100")
        game.press(b"hs" + b"auaau" + b"s" * 30)
        game.until("The exit! Well done.")
        game.press(b"u")
        assert "u undo" not in game.until("The episode is recorded as it ended.")
        # The next episode has no seed, and goes on with the same random numbers.
        game.press(b"r" + b"aaauuwq")
        assert game.ended()[0] == 0
    plays = brl.read_plays(tmp_path / "a.brlplay")
    assert [(play.hints, play.undone, play.seed) for play in plays] == [(1, 2, "4"), (0, 2, None)]
    # Down, west, and down until the end: what was undone is not in it.
    assert plays[0].actions[:2] == [3, 4]
    assert {*plays[0].actions[2:]} == {3}
    assert plays[1].actions == [4, 1]
    assert all(verify_play(play).is_valid for play in plays)


@pytest.mark.parametrize(
    ("leave", "status"), [pytest.param(b"q", 0, marks=pytest.mark.sweep), (b"\x03", 130)]
)
def test_each_episode_is_recorded(tmp_path: Path, leave: bytes, status: int) -> None:
    (tmp_path / "yard.yaml").write_text(LEVEL, encoding="utf-8")
    with Game(tmp_path, "yard.yaml", "--seed", "1", "--record", "ada.brlplay") as game:
        game.until("Move the robot to the exit.")
        game.press(WAY_OUT)
        game.until("The exit! Well done.")
        # Before the game is over: nothing of the episode can be lost any more.
        assert len(brl.read_plays(tmp_path / "ada.brlplay")) == 1
        game.press(b"r" + RIGHT)
        game.until("step 1 ")
        game.press(leave)
        assert game.ended()[0] == status
        assert game.is_restored
    first, last = brl.read_plays(tmp_path / "ada.brlplay")
    assert (first.end, first.steps, first.seed, first.return_) == ("terminated", 6, "1", -5)
    assert (last.end, last.steps, last.seed) == ("unfinished", 1, None)
    assert all(verify_play(play).is_valid for play in (first, last))


def test_a_file_that_cannot_be_recorded_into_is_told_at_once(tmp_path: Path) -> None:
    (tmp_path / "yard.yaml").write_text(LEVEL, encoding="utf-8")
    (tmp_path / "half.brlplay").write_text("{", encoding="utf-8")
    for file, message in (
        ("half.brlplay", "half.brlplay: the last line is cut off"),
        (".", ". cannot be written"),
    ):
        with Game(tmp_path, "yard.yaml", "--record", file) as game:
            status, told = game.ended()
        assert status == 2
        assert f"error: {message}" in re.sub(r"\x1b\[[0-9;]*m", "", told)


@pytest.mark.parametrize(
    ("key", "status"),
    [
        pytest.param(b"Q", 0, marks=pytest.mark.sweep),
        pytest.param(b"\x04", 0, marks=pytest.mark.sweep),
        (b"\x03", 130),
    ],
)
def test_keys_that_quit(yard: Game, key: bytes, status: int) -> None:
    yard.press(key)
    found, told = yard.ended()
    assert found == status
    assert "Traceback" not in told
    assert yard.is_restored


@pytest.mark.parametrize("name", swept(["SIGTERM"], ["SIGHUP", "SIGINT"]))
def test_signals_restore_the_terminal(yard: Game, name: str) -> None:
    number = getattr(signal, name)
    yard.process.send_signal(number)
    status, told = yard.ended()
    assert status == 128 + number
    assert "Traceback" not in told
    assert yard.is_restored


def test_a_terminal_that_goes_away_ends_the_game(yard: Game) -> None:
    os.close(yard.inner)
    os.close(yard.outer)
    yard.inner = yard.outer = -1
    assert yard.process.wait(timeout=30) >= 0


def test_a_fault_restores_the_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    from babyrobot_levels.extensions.play.keyboard import keyboard

    outer, inner = pty.openpty()
    with os.fdopen(inner, "r") as terminal:
        monkeypatch.setattr("sys.stdin", terminal)
        before = termios.tcgetattr(terminal)

        def play() -> None:
            with keyboard():
                assert termios.tcgetattr(terminal) != before
                raise RuntimeError("torn cable")

        with pytest.raises(RuntimeError, match="torn cable"):
            play()
        assert termios.tcgetattr(terminal) == before
    os.close(outer)


def test_keys_that_come_in_pieces(monkeypatch: pytest.MonkeyPatch) -> None:
    from babyrobot_levels.extensions.play.keyboard import keyboard

    outer, inner = pty.openpty()
    with os.fdopen(inner, "r") as terminal:
        monkeypatch.setattr("sys.stdin", terminal)
        with keyboard() as next_key:
            os.write(outer, b"\x1b[Aw\x1b\xc3")
            found = [next_key(1.0), next_key(1.0), next_key(1.0), next_key(0.0)]
            os.write(outer, b"\xa4")
            assert [*found, next_key(1.0), next_key(0.0)] == ["up", "w", "\x1b", None, "ä", None]
    os.close(outer)


def test_the_screen_follows_the_window(yard: Game) -> None:
    yard.resize(12, 8)
    yard.until("Mov")
    yard.listen(0.6)
    lines = yard.screen.splitlines()
    assert max(map(len, lines)) <= 12
    assert len(lines) <= 8
    assert "☻" in yard.screen
    yard.resize(80, 24)
    assert place(yard.until("WASD")) == (0, 0)


def test_a_large_level_is_seen_through_a_window(tmp_path: Path) -> None:
    text = "version: 1\nsize: [100, 60]\nstart: [50, 30]\n"
    (tmp_path / "large.yaml").write_text(text, encoding="utf-8")
    with Game(tmp_path, "large.yaml", size=(40, 15)) as game:
        lines = game.until("Move the").splitlines()
        assert lines[-1].strip() == "h hint · u undo · r restart · q quits"
        assert len(lines) <= 15
        assert max(map(len, lines)) <= 40
        row = next(n for n, line in enumerate(lines) if "☻" in line)
        assert 4 <= row <= 9
        assert 15 <= lines[row].index("☻") <= 25
        game.press(RIGHT * 20)
        screen = game.until("step 20 ")
        assert 15 <= next(line for line in screen.splitlines() if "☻" in line).index("☻") <= 25


@pytest.mark.sweep
def test_the_seed_decides_about_luck(tmp_path: Path) -> None:
    seen = []
    for seed in ("3", "3", "5"):
        with Game(tmp_path, "frozen-lake", "--seed", seed) as game:
            game.until("step 0 of 100")
            game.press(b"w" * 4)
            game.until("step 4 ")
            seen.append(game.screen)
    assert seen[0] == seen[1] != seen[2]
    with Game(tmp_path, "random-maze", "--maze-seed", "5") as game:
        first = game.until("maze 5")
        game.press(b".")
        game.until("step 1 ")
        game.press(b"r")
        assert game.until("step 0 ") == first


def test_time_is_up(tmp_path: Path) -> None:
    text = "version: 1\nsize: [3, 1]\nmax_steps: 2\n"
    (tmp_path / "short.yaml").write_text(text, encoding="utf-8")
    with Game(tmp_path, "short.yaml") as game:
        game.until("step 0 of 2")
        game.press(b"..")
        game.until("No steps left.")
        game.press(b"q")
        assert game.ended() == (
            0,
            ("short: ran out of steps after 2 steps, return -2, best average -1 within 2 steps\n"),
        )


def test_without_colour_and_without_box_characters(tmp_path: Path) -> None:
    variables = {"NO_COLOR": "1", "PYTHONUTF8": "0", "PYTHONIOENCODING": "ascii"}
    with Game(tmp_path, "final-maze", size=(80, 24), given=None, **variables) as game:
        screen = game.until("WASD")
        assert screen.isascii()
        assert "| @ " in screen
        assert not re.search(r"\x1b\[[0-9;]*m", game.sent)


def test_what_marks_mean_stands_below_where_there_is_room(tmp_path: Path) -> None:
    with Game(tmp_path, "first-key", size=(80, 40), given=None) as game:
        game.until("not drawn: each step: costs 1")
        assert "key: opens the door east of [2, 1]" in game.screen
    with Game(tmp_path, "first-key", size=(80, 16), given=None) as game:
        assert "not drawn" not in game.until("WASD")


def test_a_level_from_standard_input_is_played_with_the_terminals_keys(tmp_path: Path) -> None:
    with Game(tmp_path, "-", "--seed", "1", given=LEVEL.encode()) as game:
        assert place(game.until("Move the robot to the exit.")) == (0, 0)
        game.press(RIGHT)
        assert place(game.until("step 1 ")) == (1, 0)
        game.press(b"q")
        status, told = game.ended()
        assert status == 0
        assert "The yard" in game.sent
        assert game.is_restored
        assert "return -1" in told


# -- things ------------------------------------------------------------------------------------

HALL = """
version: 1
title: The hall
size: [4, 2]
exit: [3, 0]
exit_needs: [key, lever]
items: [{name: key, at: [1, 0], reward: 3}]
doors: [{at: [2, 0], side: E, needs: key, unless: lever}]
switches: [{name: lever, at: [0, 1]}]
movers: [{name: guard, path: [[2, 1], [3, 1]], back: true}]
hit: {ends: false}
heading: S
"""


@pytest.fixture
def hall(tmp_path: Path) -> Iterator[Game]:
    (tmp_path / "hall.yaml").write_text(HALL, encoding="utf-8")
    with Game(tmp_path, "hall.yaml", "--seed", "1") as game:
        game.until("Fetch the key and switch on the lever, then go to the exit.")
        yield game


def test_the_status_line_tells_what_is_held_and_on(hall: Game) -> None:
    assert " held: nothing   on: nothing" in hall.screen
    hall.press(RIGHT)
    screen = hall.until("Took the key. The door east of [2, 0] opens.")
    assert "reward 3   return 3" in screen
    assert " held: key   on: nothing" in screen
    hall.press(DOWN + LEFT)
    screen = hall.until("The lever is on. The door east of [2, 0] closes. The exit is open.")
    assert " held: key   on: lever" in screen
    hall.press(b"r")
    hall.until(" held: nothing   on: nothing")


def test_a_closed_door_is_not_a_wall(hall: Game) -> None:
    hall.press(RIGHT + DOWN + LEFT + UP + RIGHT + RIGHT)
    hall.until("step 6 ")
    hall.press(RIGHT)
    hall.until("Bump! The door in the east is closed.")
    hall.press(UP)
    hall.until("Bump! A wall in the north.")


def test_a_hit_is_told_with_the_name_of_the_mover(hall: Game) -> None:
    hall.press(b"." + DOWN + RIGHT + RIGHT)
    hall.until("The guard hits the robot!")
    assert "The episode is over" not in hall.screen
    hall.press(b"q")
    assert hall.ended() == (0, "hall: stopped after 4 steps, return -4\n")


def test_a_hit_that_ends_the_episode(tmp_path: Path) -> None:
    text = HALL.replace("ends: false", "reward: -9")
    (tmp_path / "hall.yaml").write_text(text, encoding="utf-8")
    with Game(tmp_path, "hall.yaml") as game:
        game.until("Move the robot to the exit.")
        game.press(b"." + DOWN + RIGHT + RIGHT)
        game.until("The guard hits the robot! The episode is over.")
        game.press(b"q")
        assert game.ended() == (0, "hall: ended after 4 steps, return -12, best average -8\n")


def test_a_robot_that_turns(tmp_path: Path) -> None:
    (tmp_path / "hall.yaml").write_text(HALL, encoding="utf-8")
    with Game(tmp_path, "hall.yaml", "--actions", "turns") as game:
        screen = game.until(
            "←→ or AD turn · ↑ or W moves · h hints · u undoes · r restarts · q quits"
        )
        assert "▼" in screen
        # Keys without a meaning for this robot do nothing.
        game.press(b" " + DOWN + b"s" + LEFT)
        assert "►" in game.until("step 1 ")
        game.press(UP)
        assert "held: key" in game.until("Took the key.")
        game.press(b"aw")
        game.until("Bump! A wall in the north.")
        game.press(b"d" + RIGHT)
        assert "▼" in game.until("step 6 ")


@pytest.mark.parametrize(
    ("variables", "stdin"), [({"TERM": "dumb"}, None), ({}, subprocess.DEVNULL)]
)
def test_without_a_terminal_it_says_so(
    tmp_path: Path, variables: dict[str, str], stdin: Any
) -> None:
    outer, inner = pty.openpty()
    done = subprocess.run(
        [*COMMAND, "final-maze"],
        env=environment(tmp_path, TERM="xterm") | variables,
        stdin=inner if stdin is None else stdin,
        stdout=inner,
        stderr=subprocess.PIPE,
        timeout=60,
        check=False,
    )
    assert done.returncode == 2
    assert done.stderr.decode() == (
        "error: `babyrobot play` needs a terminal\n"
        "  help: use `babyrobot preview` to look at a level\n"
    )
    assert not select.select([outer], [], [], 0.1)[0]
    os.close(outer)
    os.close(inner)
