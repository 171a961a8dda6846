"""A class that hands in plays, some of them forged: how long grading takes, and what it finds.

    python benchmarks/course.py [--students 200] [--plays 3] [--keep FOLDER]

Each student has a folder with a file for each of 12 levels. Every tenth one forges in a way of a
list; the script ends with an error if a forgery is not named, or an honest play does not count.
"""

from __future__ import annotations

import argparse
import json
import tempfile
import time
import zlib
from collections.abc import Callable
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


def main() -> None:
    """Hand in, grade, and compare."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--students", type=int, default=200)
    parser.add_argument("--plays", type=int, default=3)
    parser.add_argument("--keep", type=Path)
    given = parser.parse_args()
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
