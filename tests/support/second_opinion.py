"""What the model checker Storm says of levels, beside what this package says.

    PYTHONPATH=tests python -m support.second_opinion

reads the files that `babyrobot export` writes with Storm (PyPI `stormpy`), asks of each the
questions of `QUESTIONS`, and prints the table of docs/exact-answers.md. It fails if an answer
differs by more than Storm's own bound. `--every 20` asks about each twentieth level only.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property
from multiprocessing import get_context
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
import stormpy
from oracles.random_things import random_level

import babyrobot_levels as brl
from babyrobot_levels.analysis.solver.horizon import after
from babyrobot_levels.analysis.solver.model import Model
from babyrobot_levels.analysis.solver.optimum import most_expected
from babyrobot_levels.analysis.solver.policies import StateSpace, space_of
from babyrobot_levels.extensions.formats.processes import Process, process_of
from babyrobot_levels.mdp.tables import Floats

BOUND = 1e-9
"""By which share of a value Storm's answers may be wrong; values below 1 by as much as of 1."""

ROUNDING = 1e-12
"""The same for both sides' floats."""

MOST_STEPS = 50
"""The limit of steps, where that of the level is not smaller."""

DISCOUNT = 0.95

SUITES = {
    "small-mazes": 1600,
    "wet-mazes": 600,
    "bench-easy": 600,
    "long-ways": 150,
    "bench-hard": 40,
    "locked-mazes": 10,
}
"""How many levels of each suite are asked about: 3,000, spread evenly over it."""

RANDOM = 150
"""How many random levels are: small ones, with all there is in the language, which seldom end."""


@dataclass(frozen=True)
class Asked:
    """A level, the files of it, and what the answers are to be compared with."""

    level: brl.Level

    @cached_property
    def process(self) -> Process:
        return process_of(self.level)

    @cached_property
    def space(self) -> StateSpace:
        return space_of(self.level, "all")

    @cached_property
    def model(self) -> Model:
        return self.space.model()

    @cached_property
    def steps(self) -> int:
        return min(self.level.max_steps or MOST_STEPS, MOST_STEPS)

    @cached_property
    def first(self) -> int:
        """The steps before the first: one in which a start is drawn, or none."""
        return int(bool(self.process.starts))

    @cached_property
    def rewards(self) -> Floats:
        """The rewards of what can happen."""
        mdp, acting = self.process.mdp, self.process.acting
        expected = np.einsum("sao,sao->sa", mdp.probability[acting], mdp.reward[acting])
        return np.append(expected, 0.0)

    @cached_property
    def solution(self) -> brl.Solution | None:
        """The optimum without a discount; None where there is none."""
        try:
            return brl.solve(self.level, 1.0)
        except (brl.UndefinedReturnError, brl.EpisodeTooLongError):
            return None

    @property
    def expected_return(self) -> float | None:
        """The optimal return without a discount; None where there is none."""
        return None if self.solution is None else self.solution.expected_return

    def within(self) -> float:
        """Return the best probability of an exit within the limit of steps."""
        rewarded = self.model.with_rewards(self.model.success)

        def step(values: Floats) -> Floats:
            best: Floats = rewarded.action_values(values, 1.0).max(axis=1)
            return best

        start = np.zeros(self.model.size)
        found = after(step, start, self.steps, self.model.probability.size)
        return self.space.at_start(self.model, found)

    def success(self) -> float:
        """Return the best probability of an exit."""
        best = most_expected(self.model, self.model.success, self.space)
        return self.space.at_start(self.model, best)


@dataclass(frozen=True)
class Question:
    """A property for Storm, and what this package says.

    Attributes:
        text: the property.
        ours: what is computed here, None if the question cannot be compared.
        bound: by how much the answers may differ.
        is_exact: whether Storm shall compute over the rationals.
    """

    text: Callable[[Asked], str]
    ours: Callable[[Asked], float | None]
    bound: float = BOUND
    is_exact: bool = False


def _return_of_costs(asked: Asked) -> float | None:
    ours = asked.expected_return
    return None if ours is None or asked.rewards.max() > 0 else -ours


def _return_of_gains(asked: Asked) -> float | None:
    gains = asked.rewards.min() >= 0 and asked.rewards.max() > 0
    return asked.expected_return if gains else None


def _return_of_both(asked: Asked) -> float | None:
    """Storm asks for policies that surely end; here, they may also stay where nothing is paid."""
    mixed = asked.rewards.min() < 0 < asked.rewards.max()
    if not mixed or asked.solution is None or np.isinf(asked.solution.expected_steps):
        return None
    return -asked.solution.expected_return


QUESTIONS = {
    "return, costs only": Question(lambda _: 'R{"cost"}min=? [C]', _return_of_costs),
    "return, gains only": Question(lambda _: 'R{"reward"}max=? [C]', _return_of_gains),
    "return, both": Question(
        lambda _: 'R{"cost"}min=? [F "end"]', _return_of_both, ROUNDING, is_exact=True
    ),
    "return, discount 0.95": Question(
        lambda _: f'R{{"reward"}}max=? [Cdiscount={DISCOUNT}]',
        lambda a: brl.solve(a.level, DISCOUNT).expected_return * DISCOUNT**a.first,
    ),
    "return within a limit": Question(
        lambda a: f'R{{"reward"}}max=? [C<={a.steps + a.first}]',
        lambda a: brl.solve(a.level, 1.0, within=a.steps).expected_return,
        ROUNDING,
    ),
    "success": Question(lambda _: 'Pmax=? [F "exit"]', Asked.success),
    "success within a limit": Question(
        lambda a: f'Pmax=? [F<={a.steps + a.first} "exit"]', Asked.within, ROUNDING
    ),
}


@dataclass(frozen=True)
class Answer:
    """What both say."""

    question: str
    file: str
    storm: float
    ours: float

    @property
    def difference(self) -> float:
        """By which share of the value they differ, of 1 where it is smaller."""
        if self.storm == self.ours:
            return 0.0
        found = abs(self.storm - self.ours) / max(1.0, abs(self.ours))
        return found if np.isfinite(found) else np.inf

    @property
    def is_agreed(self) -> bool:
        """Whether the difference is within the bound, which may be rounded."""
        return self.difference <= QUESTIONS[self.question].bound + ROUNDING


# -- asking ------------------------------------------------------------------------------------


def value(model: Any, text: str, *, exact: bool = False) -> Any:
    """Return what Storm says to a property in the initial state."""
    environment = stormpy.environments.exact() if exact else stormpy.environments.sound()
    if not exact:
        environment.solver().min_max().precision = stormpy.Rational(f"1/{round(1 / BOUND)}")
    (asked,) = stormpy.parse_properties(text)
    found = stormpy.model_checking(model, asked, environment=environment)
    return found.get_value(model.initial_states[0])


def read(path: Path, *, exact: bool = False) -> Any:
    """Return the model of a file, as Storm's own readers read it; exactly only of PRISM."""
    if path.suffix == ".umb":
        options = stormpy.developer.storage.UmbImportOptions()
        options.build_state_valuations = False
        return stormpy.build_model_from_umb(str(path), options=options)
    build = stormpy.build_model[stormpy.Rational] if exact else stormpy.build_model
    return build(stormpy.parse_prism_program(str(path)))


def written(level: brl.Level, folder: Path) -> list[Path]:
    """Write both files of a level, and return their paths."""
    paths = [folder / "level.prism", folder / "level.umb"]
    for path in paths:
        content = brl.export(level, path.suffix[1:]).content
        path.write_bytes(content.encode() if isinstance(content, str) else content)
    return paths


def answers(level: brl.Level, files: Iterable[Path]) -> Iterator[Answer]:
    """Yield what Storm says of the files of a level, and what this package says."""
    asked = Asked(level)
    wanted = {name: question.ours(asked) for name, question in QUESTIONS.items()}
    for file in files:
        model = read(file)
        for name, question in QUESTIONS.items():
            ours = wanted[name]
            if ours is None or (question.is_exact and file.suffix == ".umb"):
                continue
            of = read(file, exact=True) if question.is_exact else model
            storm = float(value(of, question.text(asked), exact=question.is_exact))
            yield Answer(name, file.suffix[1:], storm, ours)


# -- all levels --------------------------------------------------------------------------------


def places() -> list[tuple[str, int]]:
    """Return which levels are asked about: a suite and a number, a name, or a random one."""
    found = [(info.name, -1) for info in brl.levels()]
    for suite, count in SUITES.items():
        size = len(brl.load_suite(suite))
        found += [(suite, number * size // count) for number in range(count)]
    return [*found, *(("random", number) for number in range(RANDOM))]


def level_at(place: tuple[str, int]) -> brl.Level:
    """Return the level of a place."""
    name, number = place
    if name == "random":
        return brl.Level.from_fields(random_level(Random(number)))
    if number >= 0:
        return brl.load_suite(name)[number]
    level = brl.load(name)
    return level.with_maze_seed(1) if level.has_random_maze else level


def asked_at(place: tuple[str, int]) -> tuple[tuple[str, int], list[Answer]]:
    """Return the answers about the level of a place."""
    with tempfile.TemporaryDirectory() as folder:
        level = level_at(place)
        return place, [*answers(level, written(level, Path(folder)))]


def main() -> int:
    """Ask about levels in two processes, and print what came of it."""
    parser = argparse.ArgumentParser()
    parser.add_argument(
        "--every", type=int, default=1, metavar="N", help="ask about each Nth level"
    )
    asked = places()[:: parser.parse_args().every]
    count: Counter[str] = Counter()
    largest: dict[tuple[str, str], float] = defaultdict(float)
    levels: dict[tuple[str, str], int] = defaultdict(int)
    differ = 0
    with get_context("spawn").Pool(2) as pool:
        for place, found in pool.imap_unordered(asked_at, asked, chunksize=8):
            count[
                "random" if place[0] == "random" else "suites" if place[1] >= 0 else "gallery"
            ] += 1
            for answer in found:
                key = answer.question, answer.file
                largest[key], levels[key] = max(largest[key], answer.difference), levels[key] + 1
                if not answer.is_agreed:
                    differ += 1
                    print(f"{place}: {answer}", flush=True)
    print(", ".join(f"{number:,} levels of {name}" for name, number in count.items()))
    print("| question | file | levels | largest difference | bound |\n|---|---|---|---|---|")
    for name, question in QUESTIONS.items():
        for file in ("prism", "umb"):
            if levels[name, file]:
                row = f"{levels[name, file]:,} | {largest[name, file]:.1e} | {question.bound:g}"
                print(f"| {name} | {file} | {row} |")
    return int(differ > 0)


if __name__ == "__main__":
    sys.exit(main())
