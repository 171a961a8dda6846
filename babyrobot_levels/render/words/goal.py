"""What there is to do in a level: one sentence."""

from __future__ import annotations

from typing import TYPE_CHECKING

from babyrobot_levels.language.kinds import NEEDED
from babyrobot_levels.render.words import phrases
from babyrobot_levels.render.words.grounds import grounds_of
from babyrobot_levels.render.words.things import spoken
from babyrobot_levels.text.words import listed

if TYPE_CHECKING:
    from babyrobot_levels.mdp.gridworld import GridWorld

_MOST_NAMES = 3
"""The most things that the sentence names."""


def goal_of(level: GridWorld) -> str:
    """Return what there is to do as one sentence, such as "Fetch the key, then go to the exit.".

    What has to be fetched or switched on is what is held or on in every episode that ends at an
    exit. Of other good ends, the one that pays most is named if it pays more than the exit.

    Raises:
        LevelError: the maze has no seed yet (`seed: random`).
    """
    good = [ground for ground in grounds_of(level) if ground.end is not None and ground.end.is_good]
    best = max((ground.reward for ground in good), default=level.rewards.exit)
    if good and (best > level.rewards.exit or not level.exits):
        return _reach({ground.name for ground in good if ground.reward == best}, best)
    if not level.exits:
        limit = level.max_steps
        within = "" if limit is None else f" in {phrases.counted(limit, 'step')}"
        return f"Collect as much reward as you can{within}."
    several = len(level.exits) > 1 and level.exit_one_of is None
    exit_ = "an exit" if several else "the exit"
    errands = _errands(level)
    return f"{errands}, then go to {exit_}." if errands else f"Move the robot to {exit_}."


def _reach(names: set[str], reward: float) -> str:
    """Return the sentence for the ends that pay most."""
    if len(names) == 1:
        return f"Reach the {names.pop()}."
    return f"Reach a cell that ends the episode and {phrases.reward(reward)}."


def _errands(level: GridWorld) -> str:
    """Return what has to be done before the exit; empty for nothing."""
    needed = _needed(level)
    errands: dict[str, list[str]] = {}
    for kind in NEEDED:
        names = [thing.name for thing in kind.of(level) if thing.name in needed]
        if names and kind.need is not None:
            errands[kind.need.get] = names
    if sum(map(len, errands.values())) > _MOST_NAMES:
        return f"{listed([*errands])} what is needed".capitalize()
    told = [f"{get} the {spoken(names)}" for get, names in errands.items()]
    return " and ".join(told).capitalize()


def _needed(level: GridWorld) -> frozenset[str]:
    """Return what is held or on in each configuration in which an episode ends at an exit."""
    if not any(kind.of(level) for kind in NEEDED):
        return frozenset()
    import numpy as np

    mdp, things = level.compile(), level.things()
    is_exit = np.zeros(mdp.cells, bool)
    is_exit[[y * mdp.width + x for x, y in level.exits]] = True
    # Episodes do not go on from terminal states, among which are all that none reaches.
    happens = (mdp.probability > 0) & mdp.terminal & ~mdp.is_terminal[:, None, None]
    reached = np.unique(mdp.next_state[happens & is_exit[mdp.next_state % mdp.cells]])
    numbers = np.unique(reached // mdp.cells)
    values = mdp.configurations[numbers].tolist()
    met = [things.met(each) for each in values if things.exit_is_open(each)]
    begins = [things.met(each) for each in things.draws()]
    always = frozenset.intersection(*met) if met else frozenset()
    return always - frozenset.intersection(*begins)
