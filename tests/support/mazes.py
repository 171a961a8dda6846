"""Boards to grow mazes on, and what is found out about mazes."""

from __future__ import annotations

from hypothesis import strategies as st

from babyrobot_levels.language.cells import RECTANGULAR
from babyrobot_levels.mdp.mazes import ALGORITHMS, carve

STEPS = {1: (0, -1), 2: (1, 0), 4: (0, 1), 8: (-1, 0)}
BACK = {1: 4, 2: 8, 4: 1, 8: 2}

Board = tuple[int, int, bytes, int]
"""Width, height, blocked cells, start."""


@st.composite
def boards(draw: st.DrawFn, largest: int = 12, whole: bool = False) -> Board:
    """Random boards; `whole` ones have no blocked cell."""
    width, height = draw(st.integers(1, largest)), draw(st.integers(1, largest))
    share = draw(st.sampled_from([0.0, 0.1, 0.4])) * (not whole)
    rng = draw(st.randoms(use_true_random=False))
    start = rng.randrange(width * height)
    blocked = bytearray(rng.random() < share for _ in range(width * height))
    blocked[start] = 0
    return width, height, bytes(blocked), start


@st.composite
def algorithms_and_boards(draw: st.DrawFn) -> tuple[str, Board]:
    """Random algorithms, each with a board that it can do with."""
    algorithm = draw(st.sampled_from(sorted(ALGORITHMS)))
    return algorithm, draw(boards(whole=algorithm in RECTANGULAR))


def empty(width: int, height: int, start: int = 0) -> Board:
    """Return a board without blocked cells."""
    return width, height, bytes(width * height), start


def neighbours(board: Board, cell: int) -> dict[int, int]:
    """Return the free cells beside a cell, by the bit of the side."""
    width, height, blocked, _ = board
    found = {}
    for bit, (dx, dy) in STEPS.items():
        x, y = cell % width + dx, cell // width + dy
        if 0 <= x < width and 0 <= y < height and not blocked[y * width + x]:
            found[bit] = y * width + x
    return found


def reached(board: Board, sides: bytes) -> set[int]:
    """Return the cells that can be reached from the start through open sides."""
    found, todo = {board[3]}, [board[3]]
    while todo:
        cell = todo.pop()
        for bit, other in neighbours(board, cell).items():
            if sides[cell] & bit and other not in found:
                found.add(other)
                todo.append(other)
    return found


def component(board: Board) -> set[int]:
    """Return the free cells that hang together with the start."""
    return reached(board, bytes([15]) * len(board[2]))


def grow(board: Board, seed: int, algorithm: str = "depth-first", loops: float = 0.0) -> bytes:
    """Return the open sides of a maze on a board."""
    width, height, blocked, start = board
    return carve(width, height, blocked, start, seed, algorithm, loops)


def dead_ends(sides: bytes) -> list[int]:
    """Return the cells with one open side."""
    return [cell for cell, bits in enumerate(sides) if bits.bit_count() == 1]


def hexed(sides: bytes) -> str:
    """Return open sides as one hexadecimal digit a cell."""
    return "".join(f"{bits:x}" for bits in sides)
