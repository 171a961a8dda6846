"""Mazes: perfect, braided, the same for ever."""

from __future__ import annotations

import hashlib
import random
from typing import get_args

import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.mazes import (
    BACK,
    STEPS,
    Board,
    algorithms_and_boards,
    boards,
    component,
    dead_ends,
    empty,
    grow,
    hexed,
    neighbours,
    reached,
)

from babyrobot_levels.language.cells import RECTANGULAR, Algorithm
from babyrobot_levels.mdp.mazes import ALGORITHMS, carve_many
from babyrobot_levels.mdp.mazes.lattice import below, quarters, shuffle

each_algorithm = pytest.mark.parametrize("algorithm", ALGORITHMS)


def test_the_language_names_the_algorithms_that_are_implemented() -> None:
    assert list(ALGORITHMS) == list(get_args(Algorithm))
    assert set(ALGORITHMS) > RECTANGULAR


# -- what holds for all ----------------------------------------------------------------------


@given(chosen=algorithms_and_boards(), seed=st.integers())
def test_mazes_are_perfect(chosen: tuple[str, Board], seed: int) -> None:
    """A spanning tree of the cells that hang together with the start; all others stay walled in."""
    algorithm, board = chosen
    sides = grow(board, seed, algorithm)
    cells = component(board)
    assert reached(board, sides) == cells
    assert sum(bits.bit_count() for bits in sides) == 2 * (len(cells) - 1)
    assert not any(sides[cell] for cell in range(len(sides)) if cell not in cells)


@given(chosen=algorithms_and_boards(), seed=st.integers(), loops=st.sampled_from([0.0, 0.3, 1.0]))
def test_sides_are_open_from_both_cells_and_lead_to_free_ones(
    chosen: tuple[str, Board], seed: int, loops: float
) -> None:
    algorithm, board = chosen
    sides = grow(board, seed, algorithm, loops)
    for cell, bits in enumerate(sides):
        beside = {} if board[2][cell] else neighbours(board, cell)
        for bit in STEPS:
            if bits & bit:
                assert bit in beside
                assert sides[beside[bit]] & BACK[bit]


@each_algorithm
def test_large_mazes_need_no_recursion(algorithm: str) -> None:
    size = 120
    sides = grow(empty(size, size, size * size // 2), 1, algorithm)
    assert sum(bits.bit_count() for bits in sides) == 2 * (size * size - 1)


@each_algorithm
def test_many_mazes_are_those_that_are_grown_one_by_one(algorithm: str) -> None:
    seeds = [5, -5, 0, 2**32, 2**70]
    many = carve_many(6, 4, bytes(24), 7, seeds, algorithm, 0.5)
    assert many == [grow(empty(6, 4, 7), seed, algorithm, 0.5) for seed in seeds]
    assert carve_many(6, 4, bytes(24), 7, [], algorithm, 0.5) == []


@each_algorithm
def test_the_global_generator_is_left_alone(algorithm: str) -> None:
    random.seed(1)
    state = random.getstate()
    grow(empty(9, 9), 4, algorithm, loops=1.0)
    assert random.getstate() == state


# -- loops -----------------------------------------------------------------------------------


@given(chosen=algorithms_and_boards(), seed=st.integers(), share=st.sampled_from([0.1, 0.5, 0.9]))
def test_loops_only_take_walls_away_and_open_dead_ends(
    chosen: tuple[str, Board], seed: int, share: float
) -> None:
    algorithm, board = chosen
    perfect, braided = (grow(board, seed, algorithm, loops=loops) for loops in (0.0, share))
    assert all(after & before == before for before, after in zip(perfect, braided, strict=True))
    before, after = dead_ends(perfect), dead_ends(braided)
    assert set(after) <= set(before)
    wanted = round(share * len(before) + 1e-9)
    movable = [cell for cell in before if len(neighbours(board, cell)) > 1]
    if len(movable) == len(before):
        # Each opening joins the dead end with one other cell, which may be a dead end too.
        assert wanted <= len(before) - len(after) <= 2 * wanted


@given(chosen=algorithms_and_boards(), seed=st.integers())
def test_all_loops_leave_no_dead_end_that_can_be_opened(
    chosen: tuple[str, Board], seed: int
) -> None:
    algorithm, board = chosen
    for cell in dead_ends(grow(board, seed, algorithm, loops=1.0)):
        assert len(neighbours(board, cell)) == 1


# -- the shapes that single algorithms promise -----------------------------------------------


@given(board=boards(whole=True), seed=st.integers())
def test_binary_trees_open_each_cell_either_to_the_north_or_to_the_west(
    board: Board, seed: int
) -> None:
    sides = grow(board, seed, "binary-tree")
    assert [(bits & 1) + (bits >> 3) for bits in sides] == [0] + [1] * (len(sides) - 1)


@given(board=boards(whole=True), seed=st.integers())
def test_sidewinders_open_one_cell_of_each_run_to_the_north(board: Board, seed: int) -> None:
    width = board[0]
    sides = grow(board, seed, "sidewinder")
    openings = 0
    for cell, bits in enumerate(sides):
        openings += bits & 1
        if not bits & 2:
            assert openings == (cell >= width)
            openings = 0


@given(board=boards(whole=True), seed=st.integers())
def test_recursive_division_begins_with_a_wall_across_the_longer_side_with_one_gap(
    board: Board, seed: int
) -> None:
    width, height = board[:2]
    sides = grow(board, seed, "recursive-division")
    rows = [sides[y * width : (y + 1) * width] for y in range(height)]
    across = [sum(bits >> 2 & 1 for bits in row) for row in rows[:-1]]
    along = [sum(row[x] >> 1 & 1 for row in rows) for x in range(width - 1)]
    if width < 2 or height < 2:
        assert set(across + along) <= {1}
    elif width != height:
        assert 1 in (along if width > height else across)
    else:
        assert 1 in along + across


# -- for ever --------------------------------------------------------------------------------


FOREVER = {
    "depth-first": ("2ac686a93c3aaa9", "e9ef35e357c54631"),
    "wilson": ("42ee856d7839138", "ece22c85dafba0c1"),
    "aldous-broder": ("2aee8445383bba8", "a9998d5734d657fd"),
    "kruskal": ("42ea83c7e82b938", "b4079970f577b903"),
    "prim": ("2eaac2d4412bbb8", "556bc507c4b1cdb3"),
    "growing-tree": ("6ac683c554293b9", "399df8055dd03ae9"),
    "hunt-and-kill": ("2ac686a93c3aaa9", "631da0ac22d197f1"),
    "recursive-division": ("6ee84557ad11381", "18757dfb222945d2"),
    "binary-tree": ("6eaac53a813aaa8", "ff8fb35c9b13065d"),
    "sidewinder": ("6aee852d7c38111", "8762d75b3f24853e"),
    "eller": ("2c46c43b953aaa9", "86097f34119d05b6"),
}


def fingerprint(algorithm: str) -> str:
    """Return a digest of mazes of many sizes, starts and seeds, with loops and blocked cells."""
    rng = random.Random(7)
    found = hashlib.sha256()
    for number in range(60):
        width, height = 1 + rng.getrandbits(4), 1 + rng.getrandbits(4)
        seed = rng.getrandbits((1, 8, 31, 32, 33, 64, 200)[number % 7]) * (-1) ** number
        blocked = bytearray(rng.getrandbits(8) < 60 for _ in range(width * height))
        if number % 2 or algorithm in RECTANGULAR:
            blocked = bytearray(width * height)
        start = below(rng, width * height)
        blocked[start] = 0
        board = (width, height, bytes(blocked), start)
        found.update(grow(board, seed, algorithm, loops=(0.0, 0.0, 0.4)[number % 3]))
    return found.hexdigest()[:16]


@each_algorithm
def test_every_algorithm_gives_the_same_mazes_for_ever(algorithm: str) -> None:
    assert (hexed(grow(empty(5, 3), 42, algorithm)), fingerprint(algorithm)) == FOREVER[algorithm]


# -- draws -----------------------------------------------------------------------------------


def test_below_draws_as_choice_does() -> None:
    ours, pythons = random.Random(5), random.Random(5)
    for count in [1, 2, 3, 4, 5, 8, 100] * 20:
        assert below(ours, count) == pythons.choice(range(count))


def test_quarters_are_all_that_there_is_and_even() -> None:
    rng = random.Random(5)
    drawn = [way for way, _ in zip(quarters(rng), range(40_000), strict=False)]
    assert set(drawn) == {0, 1, 2, 3}
    assert all(abs(drawn.count(way) - 10_000) < 400 for way in range(4))


def test_shuffling_gives_all_orders_evenly() -> None:
    rng, counts = random.Random(5), dict[tuple[int, ...], int]()
    for _ in range(6_000):
        items = [1, 2, 3]
        shuffle(rng, items)
        counts[tuple(items)] = counts.get(tuple(items), 0) + 1
    assert len(counts) == 6
    assert all(abs(count - 1_000) < 150 for count in counts.values())
