"""Levels of Boxoban beside gym-sokoban: whether each step is the same there.

    python benchmarks/sokoban.py [FILE...] [--count N] [--drawn N] [--states N]

The files are those of `boxoban.py`; of each, the first N levels are taken. `--drawn` adds levels of
gym-sokoban's own generator, with seeds from 0 on. In each level, the states nearest to the start
are tried with all nine actions of gym-sokoban; then come plays from the start: five of random
actions, and an optimal one, which covers all targets. Robot, boxes, reward and end of each step
must be equal.
"""

from __future__ import annotations

import argparse
import random
import sys
from collections.abc import Iterator
from itertools import chain, islice
from pathlib import Path
from typing import Any

from boxoban import fields_of, maps
from peers import Peer

import babyrobot_levels as brl
from babyrobot_levels import Action

REWARDS = {"step": -0.1, "exit": 9.9, "covered": 1, "uncovered": -1}
"""The rewards of gym-sokoban. It adds 10 for the end to that of a step; `exit` is both."""

PUSHES = (Action.STAY, Action.NORTH, Action.SOUTH, Action.WEST, Action.EAST)
"""Its actions 0 to 4: these push a box, or move; 5 to 8 are moves alike, but push nothing."""

PLAYS, STEPS = 5, 200

Outcome = list[Any]
"""The cell of the robot, those of the boxes, the reward, and whether the episode is over."""


class Yard:
    """A level of boxes, asked as gym-sokoban is."""

    def __init__(self, fields: dict[str, Any]) -> None:
        self.level = brl.load({**fields, "rewards": REWARDS})
        self.mdp, self._boxes = self.level.compile(), self.level.things().of_kind("box")

    def situation(self, state: int) -> list[Any]:
        """Return the cells of the robot and of the boxes."""
        boxes = self.mdp.configurations[self.mdp.configuration(state), self._boxes].tolist()
        return [[*self.mdp.cell(state)], sorted([*self.mdp.cell(box)] for box in boxes)]

    def step(self, state: int, action: int) -> tuple[int, Outcome]:
        """Return what one of the nine actions does: the next state, and the outcome."""
        taken = PUSHES[action if action < len(PUSHES) else action - len(PUSHES) + 1]
        after = int(self.mdp.next_state[state, taken, 0])
        if action >= len(PUSHES) and self.mdp.configuration(after) != self.mdp.configuration(state):
            # A move that pushes nothing is refused.
            return state, [*self.situation(state), REWARDS["step"], False]
        reward, ends = self.mdp.reward[state, taken, 0], self.mdp.terminal[state, taken, 0]
        return after, [*self.situation(after), float(reward), bool(ends)]

    def nearest(self) -> Iterator[int]:
        """Yield the states in which an episode goes on, those nearest to the start first."""
        found = dict.fromkeys(self.mdp.starts.tolist())
        waiting = [*found]
        for state in waiting:
            yield state
            for after in self.mdp.next_state[state, :, 0].tolist():
                if after not in found and not self.mdp.is_terminal[after]:
                    found[after] = None
                    waiting.append(after)

    def best(self) -> Iterator[int]:
        """Yield the actions of an optimal play, by their numbers in gym-sokoban."""
        policy = brl.solve(self.level).policy.ravel()
        state = int(self.mdp.starts[0])
        while not self.mdp.is_terminal[state]:
            action = PUSHES.index(policy[state])
            yield action
            state, _ = self.step(state, action)


def compared(peer: Peer, fields: dict[str, Any], states: int, seed: int) -> tuple[int, int]:
    """Return how many steps of a level are compared, and how many of these differ."""
    yard, rng = Yard(fields), random.Random(seed)
    plays = [(state, [action]) for state in islice(yard.nearest(), states) for action in range(9)]
    start = plays[0][0]
    plays += [(start, [rng.randrange(9) for _ in range(STEPS)]) for _ in range(PLAYS)]
    plays.append((start, [*yard.best()]))
    asked = [[*yard.situation(state), actions] for state, actions in plays]
    steps = differ = 0
    for (state, actions), theirs in zip(plays, peer.ask(fields=fields, plays=asked), strict=True):
        for action, told in zip(actions, theirs, strict=True):
            state, ours = yard.step(state, action)
            steps += 1
            differ += ours[:2] + ours[3:] != told[:2] + told[3:] or abs(ours[2] - told[2]) > 1e-9
            if ours[3]:
                break
    return steps, differ


def main() -> None:
    """Compare, and print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("files", nargs="*", type=Path)
    parser.add_argument("--count", type=int, default=7)
    parser.add_argument("--drawn", type=int, default=0)
    parser.add_argument("--states", type=int, default=500)
    options = parser.parse_args()
    peer = Peer("gym-sokoban", "peer_sokoban.py")
    print("| level | steps | differ |\n|---|---|---|")
    total: list[tuple[int, int]] = []
    read = (level for path in options.files for level in islice(maps(path), options.count))
    own = ((f"seed {seed}", peer.ask(seed=seed)) for seed in range(options.drawn))
    for name, rows in chain(read, own):
        total.append(compared(peer, fields_of(rows), options.states, len(total)))
        print(f"| {name} | {total[-1][0]:,} | {total[-1][1]} |", flush=True)
    peer.close()
    steps, differ = map(sum, zip(*total, strict=True))
    print(f"\n{len(total)} levels, {steps:,} steps; {differ} differ; {peer.version}")
    sys.exit(differ > 0)


if __name__ == "__main__":
    main()
