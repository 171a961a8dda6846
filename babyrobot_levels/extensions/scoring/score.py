"""Scoring: the expected return of an agent in each level, beside the optimum and chance."""

import math
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from babyrobot_levels.agents.agents import Chooser, Table, read_agent
from babyrobot_levels.agents.policy_tables import policy_of
from babyrobot_levels.analysis.solver.average import is_average
from babyrobot_levels.analysis.solver.distribution import distribution_of
from babyrobot_levels.analysis.solver.evaluation import MAX_STEPS, evaluation_of
from babyrobot_levels.analysis.solver.horizon import Worth, best_returns_within, worth_within
from babyrobot_levels.analysis.solver.optimum import solve
from babyrobot_levels.analysis.solver.policies import StateSpace, space_of
from babyrobot_levels.analysis.solver.results import (
    check_count,
    check_discount,
    check_share,
    check_within,
)
from babyrobot_levels.analysis.solver.within import ByStep, evaluate_within, weights_by_step
from babyrobot_levels.envs.arguments import checked_observation
from babyrobot_levels.envs.observations import make_observer
from babyrobot_levels.envs.observations.base import Extent, Observation
from babyrobot_levels.envs.remembering import Player
from babyrobot_levels.envs.single import LevelEnv
from babyrobot_levels.envs.spaces import ACTION_SETS
from babyrobot_levels.envs.suite import extent_of
from babyrobot_levels.envs.team import TeamEnv
from babyrobot_levels.extensions.scoring.advantage import mean_positive_advantage
from babyrobot_levels.extensions.scoring.averages import average_scores
from babyrobot_levels.extensions.scoring.conversations import converse
from babyrobot_levels.extensions.scoring.results import LevelScore, Played, Scores, extremes, share
from babyrobot_levels.library.catalogue import load
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.tables import Floats
from babyrobot_levels.render.sights import PICTURE, SIGHTS
from babyrobot_levels.suites.suite import Suite, named_levels
from babyrobot_levels.text.errors import warn
from babyrobot_levels.text.words import check_choice


@dataclass(frozen=True, eq=False)
class _Problem:
    """A level with the conditions of its episodes."""

    level: Level
    space: StateSpace
    limit: int | None
    discount: float


def score(
    levels: Any,
    agent: Any,
    *,
    split: str | None = None,
    within: int | str | None = None,
    discount: float | None = None,
    observation: str | Sequence[str] = "position",
    actions: str = "all",
    deterministic: bool = True,
    batched: bool = False,
    episodes: int | None = None,
    seed: int = 0,
    sight: str | None = None,
    chat: bool = False,
    record: str | os.PathLike[str] | None = None,
    positive_advantage: bool = False,
    cvar: float | None = None,
    knowable: bool | Literal["suite"] = False,
    criterion: str = "return",
    **options: Any,
) -> Scores:
    """Return the scores of an agent: its expected return in each level, beside the best one.

    An agent without memory is turned into a table of what it does in each state, from which its
    expected return follows exactly, whatever it observes. One with memory plays episodes; if these
    are fewer than 100, a warning says so.

    With a sight, the agent reads and writes: it plays episodes in `brl.TextWorld`s, and its
    returns are told without the luck of the outcomes, which changes no mean.

    Args:
        levels: a level, several, a folder, a pack or a suite: names, paths, mappings, `Level`s.
        agent: one of

            - `"best"`, an optimal policy without a time limit for each level; `"random"` or
              `"uniform"`, as `brl.evaluate` takes them;
            - a `Solution`, an array, as `brl.evaluate` takes them; within a limit also one for
              each step; or a mapping from names or digests of levels to policies;
            - the path of a file that has such a policy (.json, .npy, .npz), or of a Python file,
              which is run, and the name of a function in it: `"agent.py:name"`;
            - a function from an observation to an action (of several robots, to the action of
              each), or to the probabilities of all actions;
              with `batched`, from many observations `[n, …]` at once (of JAX, for example);
            - a model of Stable-Baselines3 or sb3-contrib, or an `RLModule` of RLlib;
            - an object with memory: `reset()` begins an episode, and `act(observation, mask)`
              returns an action;
            - with `sight`, a function from a text to a reply; with `chat`, a chat model: a function
              from messages, dicts with `role` and `content`, to the next reply; with
              `sight="picture"` a function of a text and of pixels, uint8 `[height, width, 3]`, or
              of messages whose `content` is a list of a text and a picture, as OpenAI's has it.
        split: the part of a suite that is scored.
        within: the number of steps after which episodes are truncated, or `"max_steps"`; by
            default that of each level, none where it has none.
        discount: above 0 and at most 1; by default, that of each level.
        observation: what the agent observes, as in environments; `options` are those of it
            (`view_radius`, `channels_last`, …).
        actions: the set of actions, as in environments.
        deterministic: whether a model takes its most likely action instead of sampling.
        batched: whether a function takes many observations at once.
        episodes: the number of episodes in each level, for agents with memory (by default 1,000)
            and for those that read and write (by default 10).
        seed: their seed.
        sight: what an agent sees that reads and writes: `"map"`, `"view"`, `"words"` or
            `"picture"`.
        chat: whether it gets all messages so far, instead of the rules and what is seen now.
        record: a file to which its episodes are appended as plays, such as `model.brlplay`.
        positive_advantage: whether to find the mean positive advantage, of an agent without memory.
        cvar: the share of the worst episodes, such as 0.1, of which to find the mean return, of an
            agent without memory; exact where `brl.return_distribution` is, else that of 10,000
            simulated episodes; this can take a second for each level.
        knowable: whether to find the best that can be expected of any agent that observes what this
            one does, of an agent that observes, reads or has a memory; this can take seconds for
            each level. `"suite"`: of any that is not told in which of the levels it is, as
            `pooled` of the result.
        criterion: `"return"`; or `"average"`, the average reward of a step in the long run, as
            `brl.solve` takes it, of an agent without memory in levels that go on for ever: it
            stands in the place of returns.
        options: the other options of the observation.

    Raises:
        LevelNotFoundError: there is no such level.
        LevelError: a level is not valid, or its maze has no seed yet.
        ValueError: another argument has an invalid value, or there is no limit and the optimum of
            a level is infinite, or the agent reads and writes.
        OSError: the file for plays cannot be written.
        EpisodeTooLongError: the limit of a level is so large that this takes too long.
        TypeError: the agent is none that scoring knows.
    """
    check_choice("actions", actions, ACTION_SETS)
    if sight is not None:
        check_choice("sight", sight, (*SIGHTS, PICTURE))
        _check_reader(agent, actions)
    elif chat or record is not None:
        raise ValueError("chat and record are for agents that read and write: give a sight, too")
    chosen = checked_observation(observation=observation, **options)
    own = {"valid": "all", "valid_moves": "moves"}.get(actions, actions)
    is_for_ever = is_average(
        criterion,
        **{"discount": discount, "within": within, "sight": sight, "cvar": cvar},
        **{"episodes": episodes, "knowable": knowable or None},
        positive_advantage=positive_advantage or None,
    )
    members, extent = _levels(levels, split, turns=ACTION_SETS[actions].turns)
    if is_for_ever:
        taken = _read(agent, members, actions, deterministic=deterministic, batched=batched)
        if isinstance(taken, Player):
            raise ValueError("criterion='average' is for agents without memory: episodes end")
        rows = [*average_scores(taken, members, chosen, extent, own)]
        return Scores(rows, criterion=criterion)
    problems = [_problem(level, within, discount, own) for level in members]
    taken = agent
    if sight is None:
        taken = _read(agent, members, actions, deterministic=deterministic, batched=batched)
        episodes = 1000 if episodes is None else episodes
    else:
        _check_limits(problems)
        episodes = 10 if episodes is None else episodes
    episodes = check_count("episodes", episodes)
    if (positive_advantage or cvar is not None) and (
        sight is not None or isinstance(taken, Player)
    ):
        raise ValueError("positive_advantage and cvar are for agents without memory: tables")
    check_share("cvar", 1.0 if cvar is None else cvar, is_above_0=True)
    if knowable not in (False, True, "suite"):
        raise ValueError(f"knowable must be True, False or 'suite', not {knowable!r}")
    if knowable and sight == PICTURE:
        raise ValueError("knowable is for agents that observe or read, not for sight='picture'")
    if knowable and isinstance(taken, Table):
        raise ValueError("knowable is for agents that observe: this one is a table of all states")
    best = _best(problems)
    chance = _worth(
        problems, [weights_by_step("random", each.space, each.limit) for each in problems]
    )
    played: list[Played] = []
    policies: list[ByStep] = []
    if sight is not None:
        worth, played = _conversed(taken, problems, episodes, seed, sight, chat, record)
    elif isinstance(taken, Player):
        worth, played = _played(taken, problems, chosen, extent, actions, episodes, seed)
    else:
        policies = [_policy(taken, problem, chosen, extent) for problem in problems]
        worth = _worth(problems, policies)
    rows = [
        _row(problem, worth, chance, best, played[number] if played else None, number)
        for number, problem in enumerate(problems)
    ]
    for number, policy in enumerate(policies):
        rows[number] = _with_more(rows[number], problems[number], policy, positive_advantage, cvar)
    together = None
    if knowable:
        seen: dict[str, Any] = {"sight": observation, **options}
        if sight is not None:
            seen = {"sight": f"text-{sight}"}
        if knowable == "suite":
            together = _knowable(problems, discount, seen)
        else:
            pairs = zip(rows, problems, strict=True)
            rows = [replace(row, knowable=_knowable([each], discount, seen)) for row, each in pairs]
    scores = Scores(rows, played, together)
    if scores.notice is not None and sight is None:
        warn(scores.notice)
    return scores


def _levels(levels: Any, split: str | None, *, turns: bool) -> tuple[list[Level], Extent]:
    """Return the levels that are scored, and the extent of their observations."""
    named = named_levels(levels)
    if isinstance(named, Suite):
        part = named if split is None else named.split(split)
        return list(part), extent_of(named.bounds, turns=turns)
    if split is not None:
        raise ValueError("split is a part of a suite; these are levels")
    found = [load(level) for level in named]
    if not found:
        raise ValueError("there are no levels to score")
    return found, Extent.of(found, turns=turns)


def _read(agent: Any, levels: Sequence[Level], actions: str, **how: bool) -> Any:
    """Return an agent as it is scored; `how` are whether it is deterministic, and batched."""
    return read_agent(agent, _num_actions(levels, actions), robots=_robots(levels), **how)


def _num_actions(levels: Sequence[Level], actions: str) -> int:
    """Return how many actions a robot has.

    Raises:
        ValueError: not the same number in all levels.
    """
    counts = sorted({ACTION_SETS[actions].with_moves(level.moves).num_actions for level in levels})
    if len(counts) > 1:
        raise ValueError(
            f"an agent has as many actions in all levels, and these have {counts[0]} and "
            f"{counts[-1]}"
        )
    return counts[0]


def _robots(levels: Sequence[Level]) -> int:
    """Return how many robots an agent moves.

    Raises:
        ValueError: not the same number in all levels.
    """
    counts = sorted({max(len(level.robots), 1) for level in levels})
    if len(counts) > 1:
        raise ValueError(
            f"an agent moves as many robots in all levels, and these have {counts[0]} to "
            f"{counts[-1]}"
        )
    return counts[0]


def _problem(
    level: Level, within: int | str | None, discount: float | None, actions: str
) -> _Problem:
    limit = level.max_steps if within is None else check_within(within, level.max_steps)
    discount = check_discount(discount, level.discount)
    return _Problem(level, space_of(level, actions, discount), limit, discount)


def _policy(
    agent: Table | Chooser, problem: _Problem, observation: Observation, extent: Extent
) -> ByStep:
    observer = make_observer(problem.level, observation, extent)
    return policy_of(agent, problem.space, observer, problem.limit)


def _limited(problems: Sequence[_Problem]) -> list[int]:
    return [number for number, each in enumerate(problems) if each.limit is not None]


def _best(problems: Sequence[_Problem]) -> Floats:
    """Return the optimal expected returns.

    Raises:
        ValueError: one of them is infinite.
    """
    found, limited = np.zeros(len(problems)), _limited(problems)
    found[limited] = best_returns_within(*_arguments(problems, limited))
    for number, each in enumerate(problems):
        if each.limit is None:
            solution = solve(each.level, each.discount, actions=each.space.actions)
            found[number] = solution.expected_return
            if not math.isfinite(solution.expected_return):
                name = each.level.name or each.level.digest
                raise ValueError(f"{name} has no score: {solution.explanation}")
    return found


def _worth(problems: Sequence[_Problem], policies: Sequence[ByStep]) -> Worth:
    """Return what policies are worth, each in its level."""
    found = np.zeros((3, len(problems)))
    together = [number for number in _limited(problems) if len(policies[number].runs) == 1]
    tables = [policies[number](0) for number in together]
    worth = worth_within(*_arguments(problems, together), tables)
    found[:, together] = worth.returns, worth.success, worth.steps
    for number in sorted({*range(len(problems))} - {*together}):
        each, policy = problems[number], policies[number]
        if each.limit is None:
            alone = evaluation_of(each.level, policy(0), each.discount, each.space.actions)
        else:
            alone = evaluate_within(each.space, policy, each.discount, each.limit)
        found[:, number] = alone.expected_return, alone.exit_probability, alone.expected_steps
    return Worth(*found)


def _with_more(
    row: LevelScore, problem: _Problem, policy: Any, advantage: bool, cvar: float | None
) -> LevelScore:
    """Return a row with what is found of a policy if it is asked for."""
    space, discount, limit = problem.space, problem.discount, problem.limit
    if advantage:
        own = policy if limit else policy(0)
        row = replace(row, positive_advantage=mean_positive_advantage(space, own, discount, limit))
    if cvar is not None:
        returns = distribution_of(space, policy, discount, limit or MAX_STEPS)
        row = replace(row, cvar=returns.cvar(cvar))
    return row


MOST_BELIEFS = 10_000
"""So many beliefs are explored for what can be known of a level."""


def _knowable(problems: Sequence[_Problem], discount: float | None, seen: dict[str, Any]) -> float:
    """Return what can be expected at most of an agent that observes something, in one of levels.

    Raises:
        ValueError: the levels have several limits.
    """
    limits = {each.limit for each in problems}
    if len(limits) > 1:
        raise ValueError("the levels have several max_steps; give a number of steps: `within`")
    levels, how = [each.level for each in problems], {"actions": problems[0].space.actions}
    found = solve(levels, discount, within=limits.pop(), beliefs=MOST_BELIEFS, **how, **seen)
    return float(found.upper)


def _arguments(
    problems: Sequence[_Problem], numbers: Sequence[int]
) -> tuple[list[StateSpace], list[int], list[float]]:
    chosen = [problems[number] for number in numbers]
    return (
        [each.space for each in chosen],
        [each.limit or 0 for each in chosen],
        [each.discount for each in chosen],
    )


def _played(
    agent: Player,
    problems: Sequence[_Problem],
    observation: Observation,
    extent: Extent,
    actions: str,
    episodes: int,
    seed: int,
) -> tuple[Worth, list[Played]]:
    """Return what an agent with memory earned on average, and in each episode."""
    rows, played = np.zeros((3, len(problems))), []
    for number, problem in enumerate(problems):
        env = _scored_env(problem.level, observation, extent, actions)
        # Seeded once: all episodes of a level are from one stream of random numbers.
        seeds = [*_seeds(problem, seed, 1), *[None] * (episodes - 1)]
        runs = np.array([_episode(agent, env, problem, each) for each in seeds])
        rows[:, number] = runs.mean(axis=0)
        limits = extremes(problem.space, problem.limit or MAX_STEPS, problem.discount)
        played.append(Played(runs[:, 0], *limits))
    return Worth(*rows), played


def _seeds(problem: _Problem, seed: int, count: int) -> list[int]:
    """Return seeds that no other level has: what is common to all would not average out."""
    entropy = [seed, int(problem.level.digest.removeprefix("sha256:"), 16)]
    found: list[int] = np.random.SeedSequence(entropy).generate_state(count).tolist()
    return found


def _check_reader(agent: Any, actions: str) -> None:
    """Check that an agent reads and writes.

    Raises:
        TypeError: it is no function.
        ValueError: the set of actions is another one.
    """
    if not callable(agent):
        given = repr(agent) if isinstance(agent, str) else type(agent).__name__
        raise TypeError(
            f"with a sight, the agent is a function from texts to replies, not {given}; policies "
            "and models see no text, and are scored without a sight"
        )
    if actions != "all":
        raise ValueError(f"agents that read and write have actions='all', not {actions!r}")


def _check_limits(problems: Sequence[_Problem]) -> None:
    """Check that all levels have a limit of steps.

    Raises:
        ValueError: one has none.
    """
    for each in problems:
        if each.limit is None:
            name = each.level.name or each.level.digest
            raise ValueError(f"{name} has no max_steps; give a number of steps, such as within=200")


def _conversed(
    agent: Callable[[Any], Any],
    problems: Sequence[_Problem],
    episodes: int,
    seed: int,
    sight: str,
    chat: bool,
    record: str | os.PathLike[str] | None,
) -> tuple[Worth, list[Played]]:
    """Return what an agent that reads and writes earned on average, and in each episode."""
    rows, played = np.zeros((3, len(problems))), []
    for number, problem in enumerate(problems):
        level = problem.level
        if problem.discount != level.discount:
            level = level.replace(discount=problem.discount)
        assert problem.limit is not None
        seeds = _seeds(problem, seed, episodes)
        rows[:, number], found = converse(
            agent, level, sight, chat=chat, limit=problem.limit, seeds=seeds, record=record
        )
        played.append(found)
    return Worth(*rows), played


class _Shared(LevelEnv):
    """An environment whose observations have the space of all levels that are scored."""

    def share(self, observation: Observation, extent: Extent) -> None:
        """Go over to the observation, in its space for an extent."""
        self._shared, self._observation = extent, observation
        self._enter(self.level)
        self.observation_space = self._observer.space

    def _extent(self) -> Extent:
        return getattr(self, "_shared", None) or super()._extent()


class _SharedTeam(_Shared, TeamEnv):
    """The same for several robots."""


def _scored_env(level: Level, observation: Observation, extent: Extent, actions: str) -> _Shared:
    env = _SharedTeam(level) if level.robots else _Shared(level, actions=actions)
    env.share(observation, extent)
    return env


def _episode(
    agent: Player, env: _Shared, problem: _Problem, seed: int | None
) -> tuple[float, float, float]:
    """Play an episode; return its return, whether it reached an exit, and its steps."""
    observation, info = env.reset(seed=seed)
    agent.reset()
    total, factor, steps = 0.0, 1.0, 0
    for steps in range(1, (problem.limit or MAX_STEPS) + 1):
        action = agent.act(observation, info["action_mask"])
        observation, reward, terminated, _, info = env.step(action)
        total += factor * reward
        factor *= problem.discount
        if terminated:
            return total, float(problem.space.exits[env.state]), steps
    return total, 0.0, steps


def _row(
    problem: _Problem, worth: Worth, chance: Worth, best: Floats, played: Played | None, number: int
) -> LevelScore:
    earned, optimum = float(worth.returns[number]), float(best[number])
    by_chance = float(chance.returns[number])
    low, high = (earned, earned) if played is None else played.interval()
    return LevelScore(
        level=problem.level.name or problem.level.digest,
        digest=problem.level.digest,
        expected_return=earned,
        optimum=optimum,
        random=by_chance,
        share=share(earned, by_chance, optimum),
        regret=optimum - earned,
        success=float(worth.success[number]),
        steps=float(worth.steps[number]),
        within=problem.limit,
        discount=problem.discount,
        episodes=0 if played is None else len(played.returns),
        low=low,
        high=high,
        invalid=0.0 if played is None else played.invalid,
    )
