"""Learners that do not know of each other, and one that moves all robots of a team.

Run python examples/robots/learners.py. Each of several Q-learners moves a robot and takes the
others for a part of the world; a joint one chooses the actions of all. `brl.score_team` tells how
far each team is from its optimum, exactly, and whose loss it is. Without names of levels, there are
four: two of the gallery, two agents of a file of scenarios, and, with the package `overcooked-ai`,
a kitchen of Overcooked-AI, in which the players change places.
"""

from __future__ import annotations

import argparse
import warnings
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import babyrobot_levels as brl

Actions = NDArray[np.int64]


def learn(
    level: brl.Level, steps: int, seed: int, *, joint: bool, step_size: float = 0.2
) -> list[Actions]:
    """Return a policy of each learner, `[states]`: of a joint one, the joint actions."""
    env = brl.TeamEnv(level, observation="index")
    mdp, rng = level.compile(), np.random.default_rng(seed)
    limit = level.max_steps or 200
    count, actions = (1, mdp.num_actions) if joint else (mdp.num_robots, 5)
    values = np.zeros((count, mdp.num_states, actions))
    # What a wall refuses is never chosen.
    masks = mdp.action_mask.reshape(mdp.num_states, *[5] * mdp.num_robots)
    allowed = [mdp.action_mask > 0]
    if not joint:
        axes = range(1, masks.ndim)
        allowed = [
            masks.max(axis=tuple(other for other in axes if other != axis)) > 0 for axis in axes
        ]
    values[~np.stack(allowed)] = -np.inf
    state, taken = env.reset(seed=seed)[0], 0
    for step in range(steps):
        explores = max(0.05, 1 - 2 * step / steps)
        chosen = [
            int(rng.choice(np.flatnonzero(known[state])))
            if rng.random() < explores
            else int(rng.choice(np.flatnonzero(table[state] == table[state].max())))
            for table, known in zip(values, allowed, strict=True)
        ]
        robots = mdp.robot_actions(chosen[0]) if joint else np.array(chosen)
        after, reward, over, _, info = env.step(robots)
        rewards = [reward] if joint else info["rewards"]
        for table, action, share in zip(values, chosen, rewards, strict=True):
            ahead = 0.0 if over else table[after].max()
            table[state, action] += step_size * (share + ahead - table[state, action])
        state, taken = after, taken + 1
        if over or taken >= limit:
            state, taken = env.reset()[0], 0
    return [table.argmax(axis=1) for table in values]


def teams() -> Iterator[brl.Level]:
    """Yield the levels that are played if none are named."""
    # Diagonal moves and the cooking are no part of a level, which warnings tell.
    warnings.simplefilter("ignore", brl.ConversionWarning)
    yield from map(brl.load, ("passing-place", "two-pads"))
    yield brl.import_(Path(__file__).with_name("crossing.scen"), robots=2)
    package = find_spec("overcooked_ai_py")
    if package is not None and package.origin is not None:
        layouts = Path(package.origin).parent / "data" / "layouts"
        kitchen = brl.import_(layouts / "coordination_ring.layout", name="coordination-ring")
        ways = zip(kitchen.robots, reversed(kitchen.starts), strict=True)
        robots = [{"name": robot.name, "exit": goal} for robot, goal in ways]
        yield kitchen.replace(robots=robots, max_steps=100)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("levels", nargs="*")
    parser.add_argument("--steps", type=int, default=60_000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--discount", type=float, default=0.95)
    given = parser.parse_args()
    print(f"{'level':17} {'who':12} {'return':>8} {'best':>8}  regret of each robot")
    for level in map(brl.load, given.levels or teams()):
        alone = learn(level, given.steps, given.seed, joint=False)
        (together,) = learn(level, given.steps, given.seed, joint=True)
        together = together.reshape(level.compile().shape)
        for who, policies in (("independent", alone), ("joint", together)):
            team = brl.score_team(level, policies, discount=given.discount)
            regrets = ", ".join(f"{each.name} {each.regret:.3f}" for each in team.robots)
            row = f"{team.expected_return:8.3f} {team.best_return:8.3f}"
            print(f"{level.name:17} {who:12} {row}  {regrets}")


if __name__ == "__main__":
    main()
