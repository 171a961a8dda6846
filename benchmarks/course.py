"""A class that hands in plays or code, some of it forged, wrong or hostile: what grading finds.

    python benchmarks/course.py plays [--students 200] [--plays 3] [--keep FOLDER]
    python benchmarks/course.py code [--students 30] [--seconds 10] [--keep FOLDER]

Of plays, each student has a folder with a file for each of 12 levels. Every tenth one forges in a
way of a list. Of code, each has three functions of the example course, in one of the forms in which
they are handed in; every fifth one makes a mistake of a list, and every tenth one is hostile, in
harmless ways. The script ends with an error if one is not named, or an honest mark is wrong.
"""

from __future__ import annotations

import argparse
import json
import math
import resource
import tempfile
import time
import zlib
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

import babyrobot_levels as brl
from babyrobot_levels.agents.plays import play_of

LEVELS = ("coin-run", "maze", "puddle-test", "final-maze", "frozen-lake", "first-key",
          "treasure-chests", "night-watch", "two-levers", "four-rooms", "teleport-pads",
          "drawbridge")  # fmt: skip


def line_of(play: dict[str, Any]) -> str:
    """Return a play as a line with a checksum that fits."""
    body = json.dumps({key: play[key] for key in play if key != "checksum"})[:-1]
    return f'{body},"checksum":"{zlib.crc32(body.encode()):08x}"}}\n'


class Player:
    """Plays levels nearly optimally, as pages record it."""

    def __init__(self, levels: list[brl.Level]) -> None:
        self.levels = levels
        self.policies = [brl.solve(level).policy.ravel() for level in levels]
        self.codes = [level.share_code() for level in levels]
        self.envs: list[Any] = [level.make(observation="index") for level in levels]

    def play(self, number: int, name: str, luck: int, random: np.random.Generator) -> str:
        """Return an episode of the seed that the page gives to a name."""
        env, policy = self.envs[number], self.policies[number]
        seed = zlib.crc32(name.encode()) + luck
        state, _ = env.reset(seed=seed)
        states: list[int] = [env.unwrapped.state]
        actions: list[int] = []
        rewards: list[float] = []
        is_over = terminated = truncated = False
        while not is_over and len(actions) < 2000:
            action = int(policy[state]) if random.random() < 0.8 else int(random.integers(5))
            state, reward, terminated, truncated, _ = env.step(action)
            is_over = terminated or truncated
            states.append(env.unwrapped.state)
            actions.append(action)
            rewards.append(float(reward))
        level = self.levels[number]
        end = "terminated" if terminated else "truncated" if truncated else "unfinished"
        found = play_of(
            level, self.codes[number], rewards=rewards, action_set="all", seed=str(seed),
            max_steps=level.max_steps, start="drawn", states=states, actions=actions, end=end,
            player=name,
        )  # fmt: skip
        return found.to_line() + "\n"


def changed(**changes: Any) -> Callable[[str, str], str]:
    """Return a forger who changes fields of a play."""
    return lambda line, _: line_of({**json.loads(line), **changes})


def lucky(line: str, _: str) -> str:
    """Claim a seed that draws other outcomes."""
    play = json.loads(line)
    return line_of({**play, "seed": str(int(play["seed"]) + 7), "seed_kind": "environment"})


FORGERIES: dict[str, Callable[[str, str], str]] = {
    "a higher return": changed(**{"return": 1e6}),
    "a flipped byte": lambda line, _: line.replace('"rewards"', '"rewarbs"'),
    "a seed of other outcomes": lucky,
    "another version of the level": lambda line, _: line_of(
        {**json.loads(line), "digest": "sha256:" + "0" * 64}
    ),
    "another time limit": changed(max_steps=99_999),
    "an empty file": lambda *_: "",
    "a cut line": lambda line, _: line[: len(line) // 2],
    "the play of a neighbour": lambda _, neighbour: neighbour,
    "the play of a neighbour under one's own name": lambda line, neighbour: line_of(
        {**json.loads(neighbour), "player": json.loads(line)["player"]}
    ),
    "another's name": lambda line, neighbour: line_of(
        {**json.loads(line), "player": json.loads(neighbour)["player"]}
    ),
}


# -- code ----------------------------------------------------------------------------------

SOLUTIONS = Path(__file__).parent.parent / "tests" / "extensions" / "scoring" / "solutions"
FUNCTIONS = {"value_iteration": 32.0, "policy_iteration": 32.0, "q_learning": 18.0}
"""What students write, and what it is worth."""

MISTAKES: dict[str, str] = {
    "return None": "it returns nothing",
    "return 1.0": "must be an array",
    "return {}": "it returns a dict",
    "return [[1], [1, 2]]": "rows that differ in length",
    "return [['north']]": "the values are not numbers",
    "return np.zeros((3, 3, 3))": "not one of shape [3, 3, 3]",
    "return np.full(level.compile().shape, np.nan)": "is not a number (nan)",
    "raise NotImplementedError": "it is not written yet",
    "return levels": "NameError",
    "return 1 / 0": "ZeroDivisionError",
    "import sklearn_of_mine": "ModuleNotFoundError",
    "return level.probability": "AttributeError",
    "return open('values.txt').read()": "FileNotFoundError",
    "return input()": "EOFError",
    "return sys.exit(0)": "NameError",
    "import sys; sys.exit(0)": "SystemExit",
    "return value_iteration(level)": "RecursionError",
    "return [value for": "SyntaxError",
}
"""Bodies of the first function, and what students read."""

HOSTILE: dict[str, str] = {
    "while True: pass": "it took longer than",
    "return bytearray(8 << 30)": "GiB of memory",
    "return np.ones(1 << 32)": "GiB of memory",
    "return np.zeros((1 << 26, 0))": "its answer is too large",
    "return np.zeros(1 << 25)": "its answer is too large",
    "import os; os._exit(0)": "its process ended",
    "import os, signal; os.kill(os.getpid(), signal.SIGSEGV)": "its process ended",
    "import os, time; os.fork() or time.sleep(600)": "",
    "import subprocess; subprocess.Popen(['sleep', '600'], start_new_session=True)": "nothing",
    "import subprocess; [subprocess.Popen(['sleep', '600']) for _ in range(80)]; "
    "__import__('time').sleep(600)": "more than 64 processes",
    "import os, signal; os.kill(os.getppid(), signal.SIGKILL)": "it returns nothing",
    "print('\\x1b[2J\\n' * 10 ** 6)": "it returns nothing",
    "raise ValueError('</td><script>alert(1)</script>' + '\\x1b[2J' * 10 ** 5)": "ValueError",
    "open('big', 'wb').write(bytes(1 << 30))": "",
    "import mmap; m = mmap.mmap(-1, 8 << 30)\n    while True: m.write(bytes(1 << 26))": "GiB",
    "def g(n): return g(n)\n    g(1)": "RecursionError",
    "import threading; threading.Thread(target=lambda: 1 / 0).start(); threading.Event().wait()":
        "it took longer than",
    "class A(np.ndarray): __array__ = None\n    return A(3)": "",
    "import socket, gc; [each.close() for each in gc.get_objects() "
    "if isinstance(each, socket.socket)]": "",
    "import babyrobot_levels.extensions.scoring.student as s; s._table = lambda _: 1 / 0": "",
}  # fmt: skip
"""Bodies of the first function that harm nobody here, and what is said of them."""


def written(body: str) -> str:
    """Return a file with the first function."""
    return f"import numpy as np\n\n\ndef value_iteration(level):\n    {body}\n"


def notebook(texts: Iterable[str]) -> str:
    """Return a notebook with a cell for each text, and some that cannot run."""
    cells = ["%matplotlib inline\nimport nowhere", *texts, "value_iteration(None)"]
    kinds = [{"cell_type": "code", "source": each} for each in cells]
    return json.dumps({"cells": kinds, "nbformat": 4})


def forms(texts: Mapping[str, str], number: int) -> dict[str, str]:
    """Return the files of a student, in one of several forms."""
    if number % 5 == 1:
        return {f"robots/answers/{name}.py": text for name, text in texts.items()}
    if number % 5 == 2:
        return {f"{name}.py.txt": "\ufeff" + text for name, text in texts.items()}
    if number % 5 == 3:
        return {"homework.ipynb": notebook(text.partition("annotations\n")[2].replace(
            "from value_iteration import ahead\n", "") for text in texts.values())}  # fmt: skip
    return {f"{name}.py": text for name, text in texts.items()}


def grade_code(students: int, seconds: float, folder: Path) -> None:
    """Hand in code, grade it, and compare."""
    right = {name: (SOLUTIONS / f"{name}.py").read_text("utf-8") for name in FUNCTIONS}
    expected: dict[str, tuple[str, str]] = {}
    for number in range(students):
        name, texts = f"Student {number:03}", dict(right)
        kind = HOSTILE if number % 10 == 9 else MISTAKES if number % 5 == 2 else {}
        if kind:
            body = [*kind][number // (10 if kind is HOSTILE else 5) % len(kind)]
            expected[name] = body, kind[body]
            # The others import what the right one has.
            texts = {"value_iteration": written(body)}
        unit = folder / f"{name}_{number}_assignsubmission_file_"
        for path, text in forms(texts, number).items():
            (unit / path).parent.mkdir(parents=True, exist_ok=True)
            (unit / path).write_text(text, "utf-8")
    course = Path(__file__).parent.parent / "course"
    started = time.perf_counter()
    found = brl.grade(folder, course, functions=[*FUNCTIONS], seconds=seconds, memory=2)
    took = time.perf_counter() - started
    wrong: list[str] = []
    for name, totals in found.totals.items():
        first = found.submissions[name][0]
        body, told = expected.get(name, ("", "all 4 values are right"))
        worth = 0.0 if body else math.fsum(FUNCTIONS.values())
        print(f"{name}  {totals['total']:5.4g}  {body[:50]!r:55}{first.message[:100]}")
        if told not in first.message or abs(totals["total"] - worth) > 1e-9:
            wrong.append(name)
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20
    print(f"{students} students: {took:.0f} s, {memory:.2f} GiB in the process that grades")
    if wrong:
        raise SystemExit(f"graded wrongly: {wrong}")


def main() -> None:
    """Hand in, grade, and compare."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("what", choices=["plays", "code"])
    parser.add_argument("--students", type=int)
    parser.add_argument("--plays", type=int, default=3)
    parser.add_argument("--seconds", type=float, default=10)
    parser.add_argument("--keep", type=Path)
    given = parser.parse_args()
    if given.what == "code":
        with tempfile.TemporaryDirectory() as temporary:
            grade_code(given.students or 30, given.seconds, given.keep or Path(temporary))
        return
    given.students = given.students or 200
    levels = [brl.load(name) for name in LEVELS]
    player, random = Player(levels), np.random.default_rng(0)
    forgers: dict[str, str] = {}
    neighbour: list[str] = []
    with tempfile.TemporaryDirectory() as temporary:
        folder = given.keep or Path(temporary)
        for student in range(given.students):
            name = f"Student {student:03}"
            (folder / name).mkdir(parents=True)
            own: list[str] = []
            for number, level in enumerate(levels):
                lines = [player.play(number, name, luck, random) for luck in range(given.plays)]
                own.append(lines[0])
                if student % 10 == 5 and number == 4:
                    way = list(FORGERIES)[len(forgers) % len(FORGERIES)]
                    forgers[name] = way
                    lines[0] = FORGERIES[way](lines[0], neighbour[4])
                    lines = lines[:1] if way == "an empty file" else lines
                (folder / name / f"{level.name}.brlplay").write_text("".join(lines))
            neighbour = own
        started = time.perf_counter(), time.process_time()
        grades = brl.grade([folder], levels)
        seconds, processor = time.perf_counter() - started[0], time.process_time() - started[1]
    named = {defect.player: defect.reason for defect in grades.defects}
    for name, way in forgers.items():
        print(f"{way}: {named.get(name, 'NOT NAMED')}")
    plays = given.students * len(levels) * given.plays
    print(
        f"{plays:,} plays of {given.students} students: graded in {seconds:.1f} s, "
        f"{processor:.1f} s of a processor"
    )
    if set(named) != set(forgers):
        raise SystemExit(f"not named, or named wrongly: {set(named) ^ set(forgers)}")


if __name__ == "__main__":
    main()
