"""Compiled mazes: the same bits as in plain Python, and only where they are worth loading."""

from __future__ import annotations

import random
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from support.mazes import Board, empty, grow
from support.subprocesses import run

from babyrobot_levels.mdp.mazes import carve_many, compiled, kernel

SEEDS = (0, 1, -1, 7, 2**31, 2**32 - 1, 2**32, -(2**32), 2**63, 2**64 - 1, 2**64, 10**6000)

KERNEL = "babyrobot_levels.mdp.mazes.kernel"


@pytest.fixture(autouse=True)
def fresh(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Begin as a new process does, and leave nothing behind."""
    monkeypatch.setattr(compiled, "_asked_for", 0)
    compiled.load.cache_clear()
    yield
    compiled.load.cache_clear()


def plain(board: Board, seed: int, loops: float, monkeypatch: pytest.MonkeyPatch) -> bytes:
    with monkeypatch.context() as patch:
        patch.setattr(compiled, "load", lambda _: None)
        return grow(board, seed, "depth-first", loops)


def random_board(rng: random.Random, largest: int) -> Board:
    width, height = rng.randint(1, largest), rng.randint(1, largest)
    share, start = rng.choice((0, 0, 0.1, 0.4)), rng.randrange(width * height)
    blocked = bytearray(rng.random() < share for _ in range(width * height))
    blocked[start] = 0
    return width, height, bytes(blocked), start


@pytest.mark.slow
def test_the_bits_are_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(compiled, "WORTH_LOADING", 0)
    assert compiled.load(KERNEL) is kernel
    rng = random.Random(3)
    seeds = [*SEEDS, *(rng.getrandbits(rng.choice((31, 32, 33, 64, 700))) for _ in range(100))]
    for seed in seeds:
        board, loops = random_board(rng, 12), rng.choice((0.0, 0.4))
        assert grow(board, seed, "depth-first", loops) == plain(board, seed, loops, monkeypatch)


@pytest.mark.slow
def test_many_at_a_time_are_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(compiled, "WORTH_LOADING", 0)
    rng = random.Random(4)
    for count in (0, 1, 7, 8, 9, 30):
        board = random_board(rng, 12)
        seeds = [
            rng.getrandbits(rng.choice((8, 32, 64))) * rng.choice((1, -1)) for _ in range(count)
        ]
        if count > 20:
            seeds[:10] = SEEDS[:10]
        wanted = [plain(board, seed, 0.0, monkeypatch) for seed in seeds]
        assert compiled.depth_first_many(*board, seeds) == wanted
        assert carve_many(*board, seeds, "depth-first", 0.0) == wanted


INTERPRETED = """
import random

import numpy as np

from babyrobot_levels.mdp.mazes import carve_many, kernel

rng = random.Random(5)
for bits in (8, 32, 64, 90) * 4:
    width, height = rng.randint(1, 6), rng.randint(1, 6)
    start, size, seed = rng.randrange(width * height), width * height, rng.getrandbits(bits)
    blocked = bytearray(cell != start and rng.random() < 0.2 for cell in range(size))
    board = width, height, bytes(blocked), start
    (wanted,) = carve_many(*board, [seed], "depth-first", 0.0)
    one, many = bytearray(size), bytearray(2 * size)
    key = seed.to_bytes(4 * max(1, (seed.bit_length() + 31) // 32), "little")
    with np.errstate(over="ignore"):
        kernel.depth_first(*board, key, one)
        kernel.depth_first_many(*board, np.array([seed % 2**64] * 2, np.uint64), many)
    assert bytes(one) == wanted, (board, seed)
    assert bytes(many) == wanted * 2 or bits > 64, (board, seed)
print("the same")
"""


def test_the_bits_are_the_same_where_python_runs_the_kernel(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("NUMBA_DISABLE_JIT", "1")
    assert run(INTERPRETED, tmp_path) == "the same\n"


@pytest.mark.sweep
def test_a_large_maze_is_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(compiled, "WORTH_LOADING", 0)
    board = empty(300, 200, 30_100)
    assert grow(board, 8) == plain(board, 8, 0.0, monkeypatch)


@pytest.mark.slow
def test_it_is_loaded_when_so_many_cells_are_asked_for_that_it_pays() -> None:
    assert compiled.WORTH_LOADING == 500_000
    assert compiled.depth_first(500, 500, bytes(250_000), 0, 1) is None
    assert compiled.depth_first_many(100, 100, bytes(10_000), 0, range(24)) is None
    assert compiled.load.cache_info().currsize == 0
    assert compiled.depth_first(100, 100, bytes(10_000), 0, 1) is not None
    assert compiled.depth_first(2, 2, bytes(4), 0, 1) is not None


def test_without_numba_plain_python_does_it(monkeypatch: pytest.MonkeyPatch) -> None:
    wanted = grow(empty(9, 9), 4)
    monkeypatch.setattr(compiled, "WORTH_LOADING", 0)
    monkeypatch.setitem(sys.modules, "numba", None)
    assert compiled.load(KERNEL) is None
    assert compiled.depth_first(9, 9, bytes(81), 0, 4) is None
    assert compiled.depth_first_many(9, 9, bytes(81), 0, [4]) is None
    assert grow(empty(9, 9), 4) == wanted
    assert carve_many(9, 9, bytes(81), 0, [4], "depth-first", 0.0) == [wanted]


def test_where_numba_is_told_not_to_compile_plain_python_does_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    import numba

    config: Any = numba.config
    monkeypatch.setattr(config, "DISABLE_JIT", 1)
    assert compiled.load(KERNEL) is None


def test_where_numba_can_keep_nothing_plain_python_does_it(monkeypatch: pytest.MonkeyPatch) -> None:
    class Refusing:
        """In the place of the module: Numba raises this where no folder is writable."""

        def find_spec(self, name: str, path: object, target: object = None) -> None:
            if name == KERNEL:
                raise RuntimeError("cannot cache function")

    monkeypatch.delitem(sys.modules, KERNEL)
    monkeypatch.delattr(KERNEL)
    monkeypatch.setattr(sys, "meta_path", [Refusing(), *sys.meta_path])
    assert compiled.load(KERNEL) is None
