"""Mazes: perfect, braided, the same for ever."""

from __future__ import annotations

import random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from babyrobot_levels.maze import ALGORITHMS, carve
from babyrobot_levels.maze.lattice import below

STEPS = {1: (0, -1), 2: (1, 0), 4: (0, 1), 8: (-1, 0)}
BACK = {1: 4, 2: 8, 4: 1, 8: 2}

Board = tuple[int, int, bytes, int]
"""Width, height, blocked cells, start."""


@st.composite
def boards(draw: st.DrawFn, largest: int = 12) -> Board:
    width, height = draw(st.integers(1, largest)), draw(st.integers(1, largest))
    share = draw(st.sampled_from([0.0, 0.1, 0.4]))
    rng = draw(st.randoms(use_true_random=False))
    start = rng.randrange(width * height)
    blocked = bytearray(rng.random() < share for _ in range(width * height))
    blocked[start] = 0
    return width, height, bytes(blocked), start


def neighbours(board: Board, cell: int) -> dict[int, int]:
    """Return the free cells beside a cell, by the bit of the side."""
    width, height, blocked, _ = board
    found = {}
    for bit, (dx, dy) in STEPS.items():
        x, y = cell % width + dx, cell // width + dy
        if 0 <= x < width and 0 <= y < height and not blocked[y * width + x]:
            found[bit] = y * width + x
    return found


def component(board: Board) -> set[int]:
    """Return the free cells that hang together with the start."""
    found, todo = {board[3]}, [board[3]]
    while todo:
        for other in neighbours(board, todo.pop()).values():
            if other not in found:
                found.add(other)
                todo.append(other)
    return found


def reached(board: Board, sides: bytes) -> set[int]:
    """Return the cells that can be reached through open sides."""
    found, todo = {board[3]}, [board[3]]
    while todo:
        cell = todo.pop()
        for bit, other in neighbours(board, cell).items():
            if sides[cell] & bit and other not in found:
                found.add(other)
                todo.append(other)
    return found


def grow(board: Board, seed: int, algorithm: str = "depth-first", loops: float = 0.0) -> bytes:
    width, height, blocked, start = board
    return carve(width, height, blocked, start, seed, algorithm, loops)


def dead_ends(sides: bytes) -> list[int]:
    return [cell for cell, bits in enumerate(sides) if bits.bit_count() == 1]


@pytest.mark.parametrize("algorithm", sorted(ALGORITHMS))
@settings(deadline=None, max_examples=150)
@given(board=boards(), seed=st.integers())
def test_mazes_are_perfect(algorithm: str, board: Board, seed: int) -> None:
    """A spanning tree of the cells that hang together with the start; all others stay walled in."""
    sides = grow(board, seed, algorithm)
    cells = component(board)
    assert reached(board, sides) == cells
    assert sum(bits.bit_count() for bits in sides) == 2 * (len(cells) - 1)
    assert not any(sides[cell] for cell in range(len(sides)) if cell not in cells)


@pytest.mark.parametrize("algorithm", sorted(ALGORITHMS))
@settings(deadline=None, max_examples=150)
@given(board=boards(), seed=st.integers(), loops=st.sampled_from([0.0, 0.3, 1.0]))
def test_sides_are_open_from_both_cells_and_lead_to_free_ones(
    algorithm: str, board: Board, seed: int, loops: float
) -> None:
    sides = grow(board, seed, algorithm, loops)
    for cell, bits in enumerate(sides):
        beside = {} if board[2][cell] else neighbours(board, cell)
        for bit in STEPS:
            if bits & bit:
                assert bit in beside
                assert sides[beside[bit]] & BACK[bit]


@settings(deadline=None, max_examples=150)
@given(board=boards(), seed=st.integers(), share=st.sampled_from([0.1, 0.5, 0.9]))
def test_loops_only_take_walls_away_and_open_dead_ends(
    board: Board, seed: int, share: float
) -> None:
    perfect, braided = grow(board, seed), grow(board, seed, loops=share)
    assert all(after & before == before for before, after in zip(perfect, braided, strict=True))
    before, after = dead_ends(perfect), dead_ends(braided)
    assert set(after) <= set(before)
    wanted = round(share * len(before) + 1e-9)
    movable = [cell for cell in before if len(neighbours(board, cell)) > 1]
    if len(movable) == len(before):
        # Each opening joins the dead end with one other cell, which may be a dead end too.
        assert wanted <= len(before) - len(after) <= 2 * wanted


@settings(deadline=None, max_examples=150)
@given(board=boards(), seed=st.integers())
def test_all_loops_leave_no_dead_end_that_can_be_opened(board: Board, seed: int) -> None:
    for cell in dead_ends(grow(board, seed, loops=1.0)):
        assert len(neighbours(board, cell)) == 1


def hexed(sides: bytes) -> str:
    return "".join(f"{bits:x}" for bits in sides)


@pytest.mark.parametrize(
    ("size", "seed", "loops", "expected"),
    [
        ((4, 3), 0, 0.0, "46c455553939"),
        ((4, 3), 0, 0.5, "6ec455553939"),
        ((4, 3), -1, 0.0, "2ac446953ba9"),
        ((7, 2), 2024, 0.0, "46c2ec4393a939"),
        ((7, 2), 2024, 1.0, "6eeaeec393a939"),
        ((1, 5), 3, 1.0, "45551"),
        ((5, 5), 10**30, 0.25, "42c6c3c555697957c16d3ba91"),
    ],
)
def test_the_same_seed_gives_the_same_maze_for_ever(
    size: tuple[int, int], seed: int, loops: float, expected: str
) -> None:
    board = (*size, bytes(size[0] * size[1]), 0)
    assert hexed(grow(board, seed, loops=loops)) == expected


def test_a_maze_around_blocked_cells_is_the_same_for_ever() -> None:
    blocked = bytes([0, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 0])
    assert hexed(grow((4, 3, blocked, 9), 5)) == "6aac500512a9"


def test_seeds_and_starts_give_different_mazes() -> None:
    board = (8, 8, bytes(64), 0)
    assert len({grow(board, seed) for seed in range(20)}) == 20
    assert len({grow((8, 8, bytes(64), start), 1) for start in range(20)}) == 20


def test_the_global_generator_is_left_alone() -> None:
    random.seed(1)
    state = random.getstate()
    grow((9, 9, bytes(81), 0), 4, loops=1.0)
    assert random.getstate() == state


def test_below_draws_as_choice_does() -> None:
    ours, pythons = random.Random(5), random.Random(5)
    for count in [1, 2, 3, 4, 5, 8, 100] * 20:
        assert below(ours, count) == pythons.choice(range(count))
