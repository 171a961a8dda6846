"""Functions that tests run for many items, in other processes as well."""

from __future__ import annotations

import os
import time
from collections.abc import Iterator


class UnreadableError(Exception):
    """An error that pickle writes, but cannot read."""

    def __init__(self, one: int, two: int):
        super().__init__(f"{one} and {two}")


def square(number: int) -> int:
    return number * number


def process_of(number: int) -> int:
    time.sleep(0.01)
    return os.getpid()


def slow(number: int) -> int:
    """Take a time that differs between numbers."""
    time.sleep(0.02 if number % 7 == 0 else 0.001)
    return number


def no_sevens(number: int) -> int:
    if number % 7 == 0:
        raise ValueError(f"{number} is a multiple of 7")
    return number


def unreadable(number: int) -> int:
    raise UnreadableError(number, number)


def deadly(numbers: tuple[int, ...], number: int) -> int:
    """End the process for some numbers."""
    if number in numbers:
        os._exit(1)
    return number


class Counted:
    """The numbers below a limit, and how many of them have been taken."""

    def __init__(self, count: int):
        self.count, self.taken = count, 0

    def __iter__(self) -> Iterator[int]:
        for number in range(self.count):
            self.taken += 1
            yield number
