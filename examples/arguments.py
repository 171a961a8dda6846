"""The command line that the examples share: which level, how many steps, which seed."""

from __future__ import annotations

import argparse
from collections.abc import Callable

import babyrobot_levels as brl


def parser_of(
    description: str | None, steps: int, steps_help: str = "steps of all robots together"
) -> argparse.ArgumentParser:
    """Return a parser of `--level`, `--steps` and `--seed`.

    Args:
        description: what the example does.
        steps: how many steps there are by default.
        steps_help: what steps are.
    """
    parser = argparse.ArgumentParser(
        description=description, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "--level", type=level_of, default="final-maze", help="a name, a path or a share code"
    )
    parser.add_argument("--steps", type=at_least(1), default=steps, help=steps_help)
    parser.add_argument("--seed", type=at_least(0), default=0)
    return parser


def parsed(parser: argparse.ArgumentParser) -> argparse.Namespace:
    """Return what was told. Of a level that grows its mazes, the maze of the seed is learned."""
    told = parser.parse_args()
    if told.level.has_random_maze:
        told.level = told.level.with_maze_seed(told.seed)
    return told


def level_of(text: str) -> brl.Level:
    """Return the level that somebody names."""
    try:
        return brl.load(text)
    except brl.BabyRobotError as fault:
        raise argparse.ArgumentTypeError(str(fault)) from fault


def at_least(least: int) -> Callable[[str], int]:
    """Return a function that reads a whole number, which must not be below another one."""

    def number_of(text: str) -> int:
        number = int(text) if text.lstrip("-").isdecimal() else least - 1
        if number < least:
            raise argparse.ArgumentTypeError(
                f"{text!r} is no whole number that is at least {least}"
            )
        return number

    return number_of
