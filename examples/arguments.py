"""The command line options that the examples share: level, steps and seed."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence

import babyrobot_levels as brl


def parser_of(
    description: str | None,
    steps: int,
    steps_help: str = "steps of all environments together",
    level: str | None = "final-maze",
) -> argparse.ArgumentParser:
    """Return a parser of `--level`, `--steps` and `--seed`.

    Args:
        description: what the example does.
        steps: the default of `--steps`.
        steps_help: the help of `--steps`.
        level: the default of `--level`; None for no such option.
    """
    parser = argparse.ArgumentParser(
        description=description, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    if level is not None:
        parser.add_argument(
            "--level", type=level_of, default=level, help="a name, a path or a share code"
        )
    parser.add_argument("--steps", type=at_least(1), default=steps, help=steps_help)
    parser.add_argument("--seed", type=at_least(0), default=0)
    return parser


def parsed(parser: argparse.ArgumentParser) -> argparse.Namespace:
    """Return the arguments. For a level with random mazes, the seed also selects the maze."""
    args = parser.parse_args()
    if args.level.has_random_maze:
        args.level = args.level.with_maze_seed(args.seed)
    return args


def level_of(text: str) -> brl.Level:
    """Return the level with a name, path or share code."""
    try:
        return brl.load(text)
    except brl.BabyRobotError as fault:
        raise argparse.ArgumentTypeError(str(fault)) from fault


def suite_of(text: str, splits: Sequence[str] = ()) -> brl.Suite:
    """Return the suite with a name or path, which must have some splits."""
    try:
        suite = brl.load_suite(text)
        for name in splits:
            suite.split(name)
    except (brl.BabyRobotError, ValueError) as fault:
        raise argparse.ArgumentTypeError(str(fault)) from fault
    return suite


def at_least(least: int) -> Callable[[str], int]:
    """Return a function that reads a whole number and checks its minimum."""

    def number_of(text: str) -> int:
        number = int(text) if text.lstrip("-").isdecimal() else least - 1
        if number < least:
            raise argparse.ArgumentTypeError(f"{text!r} is not a whole number of at least {least}")
        return number

    return number_of
