"""Functions of a course, run and graded in a browser, where answers are known as hashes alone.

Nothing is needed but Python, and NumPy where it can be had; nothing here knows an answer. What is
wrong with one is found in the tables, by what its values say of each other.
"""

import io
import json
import math
import traceback
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import redirect_stderr, redirect_stdout, suppress
from hashlib import sha256
from random import Random
from types import SimpleNamespace
from typing import Any

STEP = 4e-3
"""The width of the cells to which values are rounded. Those that differ by a quarter are right."""

ROUNDS = 1_000
"""How often a hash is hashed again, so that guesses take longer."""

MAX_PRINTED = 10_000
"""The most characters of what a function prints that are shown."""

SWEEPS = 2_000
"""The most sweeps by which a policy is evaluated."""

_OUTCOMES = ("probability", "reward", "next_state", "terminal")

ACTIONS = ("stay", "north", "east", "south", "west")


class AnswerError(Exception):
    """Why an answer is none, or is wrong, as a sentence."""


def shifts_of(values: Sequence[float]) -> str:
    """Return for each value in which of two grids it is in the middle of a cell, as 0 or 1."""
    return "".join("01"[not 0.25 <= value / STEP % 1 <= 0.75] for value in values)


def digest(values: Sequence[float], shifts: str, salt: str) -> str:
    """Return the hash of values that are rounded to cells, all of them together."""
    pairs = zip(values, shifts, strict=True)
    cells = [math.floor(value / STEP + int(shift) / 2) for value, shift in pairs]
    found = f"{salt} {cells}".encode()
    for _ in range(ROUNDS):
        found = sha256(found).digest()
    return found.hex()


class Rows(list[Any]):
    """A table without NumPy: `table[state, action]` and `table[state][action]` are the same."""

    def __getitem__(self, key: Any) -> Any:
        found: Any = self
        for each in key if isinstance(key, tuple) else (key,):
            found = list.__getitem__(found, each)
        return Rows(found) if isinstance(found, list) else found


class Tables:
    """The tables of a level, as `level.compile()` has them."""

    num_actions = len(ACTIONS)

    def __init__(self, level: Mapping[str, Any]) -> None:
        self.shape = tuple(level["shape"])
        self.num_states = len(level["tables"]["is_terminal"])
        for name, table in level["tables"].items():
            setattr(self, name, Rows(table))
            with suppress(ImportError):
                import numpy as np

                array = np.array(table)
                array.flags.writeable = False
                setattr(self, name, array)


class Env:
    """Episodes in a level, as Gymnasium has them. An observation is the cell `(x, y)`."""

    def __init__(self, level: Mapping[str, Any]) -> None:
        self._tables, self._limit = level["tables"], level["max_steps"]
        *_, self._height, self._width = level["shape"]
        self.unwrapped, self.state, self._steps = self, 0, 0
        self._random = Random()
        self.action_space = SimpleNamespace(
            n=len(ACTIONS), sample=lambda: self._random.randrange(len(ACTIONS))
        )

    def reset(self, *, seed: int | None = None) -> tuple[tuple[int, int], dict[str, Any]]:
        """Begin an episode, and return the observation and what else is told."""
        if seed is not None:
            self._random = Random(seed)
        self._steps, self.state = 0, self._drawn(self._tables["start"])
        return self._seen()

    def step(self, action: int) -> tuple[tuple[int, int], float, bool, bool, dict[str, Any]]:
        """Take an action, and return Gymnasium's five values."""
        row = {each: self._tables[each][self.state][action] for each in _OUTCOMES}
        at = self._drawn(row["probability"])
        self.state, self._steps = row["next_state"][at], self._steps + 1
        ends = row["terminal"][at] or self._tables["is_terminal"][self.state]
        is_late = not ends and self._steps == self._limit
        observation, info = self._seen()
        return observation, row["reward"][at], ends, is_late, info

    def close(self) -> None:
        """Do nothing: there is nothing to close."""

    def _drawn(self, chances: Sequence[float]) -> int:
        return self._random.choices(range(len(chances)), chances)[0]

    def _seen(self) -> tuple[tuple[int, int], dict[str, Any]]:
        y, x = divmod(self.state % (self._height * self._width), self._width)
        return (x, y), {"action_mask": self._tables["action_mask"][self.state]}


class Level:
    """What a function gets: the name, the title, the discount, the tables, and episodes."""

    def __init__(self, level: Mapping[str, Any]) -> None:
        self.name, self.title = level["name"], level["title"]
        self.discount, self._level, self._tables = level["discount"], level, Tables(level)

    def compile(self) -> Tables:
        """Return the tables."""
        return self._tables

    def make(self) -> Env:
        """Return an environment of its own."""
        return Env(self._level)

    def __getattr__(self, name: str) -> Any:
        told = "compile(), make(), discount, name and title"
        raise AttributeError(f"here, a level has {told}, but no {name!r}")


def run(text: str, name: str, kind: str, given: str) -> str:
    """Run the function of a student in a level, and grade what it returns.

    Args:
        text: Python with the function.
        name: the name of the function.
        kind: whether it returns `values`, a `policy`, or that of an `agent`.
        given: the level, as JSON.

    Returns:
        As JSON whether it `passed`, the `message`, and what was `printed`.
    """
    level, printed = json.loads(given), io.StringIO()
    passed, message = False, ""
    try:
        with redirect_stdout(printed), redirect_stderr(printed):
            answer = _function(text, name)(Level(level))
        passed, message = True, graded(answer, kind, level)
    except NotImplementedError:
        message = "it is not written yet"
    except AnswerError as error:
        message = str(error)
    except BaseException as error:
        lines = [each.lineno for each in traceback.extract_tb(error.__traceback__)
                 if each.filename == f"{name}.py"]  # fmt: skip
        place = f" in line {lines[-1]}" if lines else ""
        message = f"{type(error).__name__}{place}: {error}"
    shown = printed.getvalue()
    shown = shown[:MAX_PRINTED] + "\n…" * (len(shown) > MAX_PRINTED)
    return json.dumps({"passed": passed, "message": message[:500], "printed": shown})


def _function(text: str, name: str) -> Callable[[Level], Any]:
    module: dict[str, Any] = {"__name__": name}
    exec(compile(text, f"{name}.py", "exec"), module)
    function = module.get(name)
    if not callable(function):
        raise AnswerError(f"there is no function {name}: write `def {name}(level):`")
    return function  # type: ignore[no-any-return]


def graded(answer: Any, kind: str, level: Mapping[str, Any]) -> str:
    """Return what is right about an answer.

    Raises:
        AnswerError: it is wrong.
    """
    values = _flat(answer, level, kind)
    actions = None if kind == "values" else _actions(values, level)
    if actions is not None and kind == "agent":
        return _earned(actions, level)
    values = values if actions is None else _evaluated(level, actions, level["graded"])
    counted = [values[state] for state in level["graded"]]
    for state, value in zip(level["graded"], counted, strict=True):
        if not math.isfinite(value):
            raise AnswerError(f"the value of {level['places'][state]} is {value}")
    for known in level["known"]:
        if digest(counted, known["shifts"], level["name"]) == known["digest"]:
            if known["mistake"]:
                raise AnswerError(known["mistake"])
            count = len(counted)
            return f"all {count} values are right" if actions is None else "the policy is optimal"
    raise AnswerError(_first_wrong(values, actions, level))


def _flat(answer: Any, level: Mapping[str, Any], kind: str) -> list[Any]:
    """Return an answer as a flat list, an entry for each state."""
    if answer is None:
        raise AnswerError("it returns nothing: it has to end with `return`")
    answer = answer.tolist() if hasattr(answer, "tolist") else answer
    shape, count = _shape(answer), len(level["tables"]["is_terminal"])
    if list(shape) not in (level["shape"], [count]):
        given = f"one of shape {[*shape]}" if shape else f"a {type(answer).__name__}"
        turned = "; rows come first: [y][x]" * (list(shape) == level["shape"][::-1])
        raise AnswerError(
            f"the {kind} must be an array {level['shape']} or [{count}], not {given}{turned}"
        )
    flat = [*_leaves(answer)]
    if kind == "values" and not all(isinstance(each, int | float) for each in flat):
        raise AnswerError("the values are not numbers")
    return flat


def _shape(answer: Any) -> tuple[int, ...]:
    if not isinstance(answer, list | tuple):
        return ()
    shapes = {_shape(each) for each in answer}
    if len(shapes) > 1:
        raise AnswerError("it returns rows that differ in length")
    return (len(answer), *(shapes.pop() if shapes else ()))


def _leaves(answer: Any) -> Iterator[Any]:
    for each in answer:
        if isinstance(each, list | tuple):
            yield from _leaves(each)
        else:
            yield each


def _actions(answer: Sequence[Any], level: Mapping[str, Any]) -> list[int]:
    """Return actions, which are numbers or names, as numbers."""
    known: dict[Any, int] = {each: n for n, name in enumerate(ACTIONS) for each in (n, name)}
    for state, each in enumerate(answer):
        if not level["tables"]["is_terminal"][state] and each not in known:
            wanted = ", ".join(f"{number} {name}" for number, name in enumerate(ACTIONS))
            raise AnswerError(
                f"the action at {level['places'][state]} is {each!r}: it can be {wanted}"
            )
    return [known.get(each, 0) for each in answer]


def _ahead(level: Mapping[str, Any], values: Sequence[float], state: int, action: int) -> float:
    """Return the value of an action, by values of the next states."""
    tables, discount = level["tables"], level["discount"]
    rows = (tables[each][state][action] for each in _OUTCOMES)
    return math.fsum(
        chance * (reward + (0.0 if ends else discount * values[following]))
        for chance, reward, following, ends in zip(*rows, strict=True)
        if chance
    )


def _evaluated(
    level: Mapping[str, Any], actions: Sequence[int], states: Sequence[int]
) -> list[float]:
    """Return the values of a policy, of some states that it does not leave."""
    going_on = [state for state in states if not level["tables"]["is_terminal"][state]]
    values = [0.0] * len(actions)
    for _ in range(SWEEPS):
        change = 0.0
        for state in going_on:
            before, values[state] = values[state], _ahead(level, values, state, actions[state])
            change = max(change, abs(values[state] - before))
        if change < STEP / 1e6:
            return values
    worst = level["places"][values.index(min(values))]
    raise AnswerError(f"from {worst} its episodes do not end, or too late to evaluate it here")


def _earned(actions: Sequence[int], level: Mapping[str, Any]) -> str:
    """Return what the policy of an agent earns from the starts, if that is enough."""
    tables, needed = level["tables"], level["needed"]
    reached = [state for state, chance in enumerate(tables["start"]) if chance]
    refused = 0
    for state in reached:
        if not tables["is_terminal"][state]:
            action = actions[state]
            refused += not tables["action_mask"][state][action]
            outcomes = zip(*(tables[each][state][action] for each in _OUTCOMES), strict=True)
            new = {following for chance, _, following, _ in outcomes if chance} - {*reached}
            reached += sorted(new)
    told = "; leave impossible actions out of the maximum" * (refused > 0)
    try:
        values = _evaluated(level, actions, reached)
    except AnswerError as error:
        raise AnswerError(f"{error}{told}") from None
    earned = math.fsum(
        chance * value for chance, value in zip(tables["start"], values, strict=True)
    )
    if earned < needed - 1e-9:
        raise AnswerError(f"the expected return is {earned:.4g}, and {needed:.4g} is needed{told}")
    return f"the expected return is {earned:.4g}, and {needed:.4g} is enough"


def _first_wrong(
    values: Sequence[float], actions: Sequence[int] | None, level: Mapping[str, Any]
) -> str:
    """Return the first state whose value, or whose action, does not follow from other values."""
    for state in level["graded"]:
        place, value = level["places"][state], values[state]
        if level["tables"]["is_terminal"][state]:
            if abs(value) > STEP / 4:
                return f"no step follows in {place}: its value is 0"
            continue
        best = max(_ahead(level, values, state, action) for action in range(len(ACTIONS)))
        if abs(best - value) > STEP / 8:
            if actions is not None:
                name = ACTIONS[actions[state]]
                return f"at {place}, {name} is not best, by the values of your policy itself"
            told = "it is not what its best action gives with your values of the next states"
            return f"at {place} {told}"
    return f"it follows from itself, but is another one: is the discount {level['discount']:g}?"
