"""Agents as tables of what they do in each state of a level."""

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from babyrobot_levels.agents.agents import AnswerError, Chooser, Table, read_agent
from babyrobot_levels.agents.plays import Play
from babyrobot_levels.agents.verify import verify_play
from babyrobot_levels.analysis.solver.policies import StateSpace, space_of
from babyrobot_levels.analysis.solver.results import ACTION_SETS as FIRST_ACTIONS
from babyrobot_levels.analysis.solver.results import TURNS
from babyrobot_levels.analysis.solver.within import ByStep, weights_by_step
from babyrobot_levels.envs.arguments import checked_observation
from babyrobot_levels.envs.observations import make_observer
from babyrobot_levels.envs.observations.base import Extent, Observer
from babyrobot_levels.envs.remembering import Player
from babyrobot_levels.envs.spaces import ACTION_SETS
from babyrobot_levels.library.catalogue import LevelLike, load
from babyrobot_levels.mdp.tables import Floats
from babyrobot_levels.text.words import check_choice


def policy_table(
    level: LevelLike,
    agent: Any,
    *,
    observation: str | Sequence[str] = "position",
    actions: str = "all",
    deterministic: bool = True,
    batched: bool = False,
    **options: Any,
) -> Floats:
    """Return what an agent does in each state of a level: the probability of each action.

    Everything that takes a policy takes it: `brl.evaluate`, `level.to_html(policy=…)`.

    Args:
        level: a name, a path, a share code, a mapping, or a level.
        agent: as `brl.score` takes it, without memory; or recorded episodes, as `brl.read_plays`
            returns them: then a probability is how often the action was taken there.
        observation: what the agent observes, as in environments; `options` are those of it.
        actions: the set of actions, as in environments. Of recorded episodes it is `"all"`.
        deterministic: whether a model takes its most likely action instead of sampling.
        batched: whether a function takes many observations at once.
        options: the other options of the observation.

    Returns:
        Probabilities, float64 `[height, width, actions]`, with an axis of configurations first in a
        level with things, and one of headings before height for a robot that turns. Of recorded
        episodes, nan in states in which no action was taken.

    Raises:
        LevelNotFoundError: there is no such level.
        LevelError: the level is not valid, or its maze has no seed yet.
        ValueError: another argument has an invalid value, the agent does not fit the level or
            changes with the step, or a recorded episode is not valid, or of another level.
        TypeError: the agent is none that scoring knows, or has a memory.
    """
    check_choice("actions", actions, ACTION_SETS)
    chosen = checked_observation(observation=observation, **options)
    level = load(level)
    if isinstance(agent, list) and agent and all(isinstance(each, Play) for each in agent):
        return _shares(agent, space_of(level, "all"))
    own = ACTION_SETS[actions].with_moves(level.moves)
    robots = max(len(level.robots), 1)
    taken = read_agent(
        agent, own.num_actions, deterministic=deterministic, batched=batched, robots=robots
    )
    if isinstance(taken, Player):
        raise TypeError("an agent with memory does not always do the same in a state")
    space = space_of(level, {"valid": "all", "valid_moves": "moves"}.get(actions, actions))
    observer = make_observer(level, chosen, Extent.of([level], turns=own.turns))
    found = policy_of(taken, space, observer, level.max_steps)
    if len(found.runs) > 1:
        raise ValueError("the policy changes with the step; a table has one for all steps")
    return found(0).reshape(*space.mdp.shape, -1)


def _shares(plays: Iterable[Play], space: StateSpace) -> Floats:
    """Return how often actions were taken in each state, `[*states, 5]`; nan where none was."""
    counts = np.zeros((space.mdp.num_states, space.mdp.num_actions))
    for number, play in enumerate(plays, 1):
        fault = verify_play(play).fault
        if fault is None and play.digest != space.level.digest:
            fault = "it is one of another level"
        elif fault is None and play.action_set == TURNS:
            fault = "its robot turns"
        if fault is not None:
            raise ValueError(f"episode {number}: {fault}")
        for state, action in zip(play.states, play.actions, strict=False):
            counts[state, action + FIRST_ACTIONS[play.action_set]] += 1
    with np.errstate(invalid="ignore"):
        shares: Floats = counts / counts.sum(axis=1, keepdims=True)
    return shares.reshape(*space.mdp.shape, -1)


BATCH = 4096
"""The most observations that an agent is asked about at once."""


def policy_of(
    agent: Table | Chooser, space: StateSpace, observer: Observer, limit: int | None
) -> ByStep:
    """Return what an agent does in each state, and in each step if it takes that into account.

    Args:
        agent: an agent without memory.
        space: the states of the level.
        observer: makes the observations of the level.
        limit: the number of steps after which episodes are truncated; None for no limit.

    Raises:
        ValueError: its answers are no actions, or no probabilities that add up to 1; or it is a
            policy for another limit.
    """
    if isinstance(agent, Table):
        return weights_by_step(agent.of(space.level.name, space.level.digest), space, limit)
    mdp, first = space.mdp, space.first_action
    states = np.flatnonzero(~mdp.is_terminal & ~space.without_value)
    table = np.zeros((mdp.num_states, mdp.num_actions - first))
    # Where no episode comes, any action will do.
    table[:, 0] = 1.0
    for begin in range(0, states.size, BATCH):
        part = states[begin : begin + BATCH]
        seen = observer.rows(part)
        try:
            table[part] = agent(seen, mdp.action_mask[part, first:].astype(np.int8))
        except AnswerError as error:
            raise ValueError(f"at {space.text(part[error.index])}: {error}") from None
    return weights_by_step(table, space, limit)
