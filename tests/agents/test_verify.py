"""Plays are verified by tables and seed; what is forged is refused, and chance is exact."""

from __future__ import annotations

import itertools
import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.plays import forged, recorded

import babyrobot_levels as brl
from babyrobot_levels.agents.verify import verify_play

SLIPPERY = {
    "version": 1,
    "size": [3, 2],
    "puddles": [{"at": [1, 0], "size": "small"}, {"at": [1, 1], "size": "large"}],
    "max_steps": 6,
}


@pytest.fixture
def play(tmp_path: Path) -> brl.Play:
    return recorded(tmp_path, "treasure-chests")


def changed(values: list[Any], index: int, value: Any) -> list[Any]:
    return [*values[:index], value, *values[index + 1 :]]


def test_a_forged_play_is_refused(play: brl.Play) -> None:
    other = brl.load("first-key")
    cases: list[tuple[dict[str, Any], str]] = [
        ({"rewards": changed(play.rewards, 1, 5.0)}, "step 2 is not possible: "),
        ({"states": changed(play.states, 2, play.states[2] + 3)}, "step 2 is not possible: "),
        ({"states": changed(play.states, 0, 10**9)}, "it has a state 1,000,000,000, and the"),
        ({"states": changed(play.states, 0, play.states[-1])}, "no episode of the level starts"),
        ({"return": play.return_ + 1}, "its rewards add up to a return of"),
        ({"digest": other.digest}, "its digest is not that of the level of its share code"),
        ({"code": other.share_code()}, "its digest is not that of the level"),
        ({"code": play.code[:-1]}, "its level cannot be read: the share code is cut off"),
        ({"end": "unfinished"}, f"step {play.steps} is not possible"),
        ({"max_steps": play.steps - 1}, "more than its time limit"),
        (
            {
                "states": [*play.states, play.states[-1]],
                "actions": [*play.actions, 0],
                "rewards": [*play.rewards, 0.0],
            },
            f"step {play.steps} is not possible",
        ),
    ]
    assert play.end == "terminated"
    assert verify_play(play).is_valid
    for changes, message in cases:
        verification = verify_play(forged(play, **changes))
        assert not verification.is_valid
        assert verification.fault is not None
        assert message in verification.fault
        assert (verification.probability, verification.chance) == (0.0, None)


@pytest.mark.parametrize("kind", ["environment", "page"])
@pytest.mark.parametrize("actions", ["all", "turns"])
def test_the_seed_must_give_the_episode(tmp_path: Path, kind: str, actions: str) -> None:
    played = recorded(tmp_path, "frozen-lake", actions, seed=3)
    played = forged(played, seed_kind=kind)
    assert verify_play(played).is_valid
    fault = verify_play(forged(played, seed="4")).fault
    assert fault is not None
    assert re.match(r"with its seed 4, step \d+ leads to \[", fault)
    # Without a seed, what is possible is all that can be known.
    assert verify_play(forged(played, seed=None)).is_valid


def test_the_seed_must_give_the_start(tmp_path: Path) -> None:
    level = brl.load({"version": 1, "size": [4, 4], "start": [[0, 0], [2, 2]], "max_steps": 2})
    played = recorded(tmp_path, level)
    faults = [verify_play(forged(played, seed=str(seed))).fault for seed in range(9)]
    assert faults[0] is None
    assert any("an episode starts in [" in str(fault) for fault in faults)
    env = brl.RecordPlay(brl.load("frozen-lake").make(), tmp_path / "chosen.brlplay")
    env.reset(seed=5, options={"start": [2, 1]})
    env.step(2)
    env.close()
    (chosen,) = brl.read_plays(tmp_path / "chosen.brlplay")
    assert (chosen.seed, chosen.start) == ("5", "chosen")
    assert verify_play(chosen).is_valid


def test_the_end_must_be_the_one_told(tmp_path: Path) -> None:
    late = recorded(tmp_path, brl.load("final-maze").replace(max_steps=20))
    assert late.end == "truncated"
    assert "it is not unfinished" in str(verify_play(forged(late, end="unfinished")).fault)
    early = verify_play(forged(late, max_steps=30))
    assert "it did not reach its time limit" in str(early.fault)
    assert verify_play(forged(late, max_steps=30, end="unfinished")).is_valid


def test_a_random_maze_needs_its_seed(tmp_path: Path) -> None:
    play = recorded(tmp_path, "random-maze")
    assert not play.level.has_random_maze
    random = brl.load("random-maze").share_code()
    assert "random maze" in str(verify_play(forged(play, code=random)).fault)


def walks(level: brl.Level, actions: list[int], state: int, discount: float) -> dict[float, float]:
    """Return the probability of each return by listing every sequence of outcomes."""
    mdp, found = level.compile(), dict[float, float]()

    def go(state: int, step: int, total: float, chance: float) -> None:
        if step == len(actions):
            found[round(total, 9)] = found.get(round(total, 9), 0.0) + chance
            return
        for probability, after, reward, terminal in mdp.outcomes(state, actions[step]):
            gained = total + discount**step * reward
            go(after, len(actions) if terminal else step + 1, gained, chance * probability)

    go(state, 0, 0.0, 1.0)
    return found


@pytest.mark.parametrize("discount", [1.0, 0.9])
def test_the_chance_equals_that_of_all_sequences_of_outcomes(
    tmp_path: Path, discount: float
) -> None:
    level = brl.load({**SLIPPERY, "discount": discount})
    for seed in range(12):
        play = recorded(tmp_path, level, seed=seed)
        verification = verify_play(play)
        every = walks(level, play.actions, play.states[0], discount)
        expected = sum(chance for total, chance in every.items() if total >= play.return_ - 1e-6)
        assert verification.chance == pytest.approx(expected, abs=1e-12)
        mean = sum(total * chance for total, chance in every.items())
        assert verification.expected_return == pytest.approx(mean)
        product = 1.0
        for step, (before, after) in enumerate(itertools.pairwise(play.states)):
            outcomes = level.compile().outcomes(before, play.actions[step])
            product *= sum(each[0] for each in outcomes if each[1] == after)
        assert verification.probability == pytest.approx(product)


def test_without_chance_a_return_is_certain(tmp_path: Path) -> None:
    verification = verify_play(recorded(tmp_path, "first-key"))
    assert (verification.probability, verification.chance) == (1.0, 1.0)


def test_a_chance_that_would_take_too_long_is_not_computed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from babyrobot_levels.analysis.solver import distribution

    monkeypatch.setattr(distribution, "MAX_OUTCOMES", 10)
    verification = verify_play(recorded(tmp_path, "final-maze"))
    assert verification.is_valid
    assert verification.chance is None
    assert math.isfinite(verification.log_probability)


@pytest.mark.slow
@pytest.mark.parametrize(("level", "actions"), [("final-maze", "all"), ("first-key", "turns")])
def test_the_film_shows_the_steps(tmp_path: Path, level: str, actions: str) -> None:
    from babyrobot_levels.agents.verify import steps_of

    play = recorded(tmp_path, brl.load(level).replace(max_steps=30), actions)
    steps = steps_of(play)
    mdp = play.level.compile()
    for step in steps:
        outcomes = [each[1] for each in mdp.outcomes(step.state, step.action)]
        assert step.next_state in outcomes
        # What can only happen to a robot that skids is told as that.
        assert not step.skidded or len(outcomes) > 1
    assert [step.reward for step in steps] == play.rewards
    film = verify_play(play).to_gif(tmp_path / "film.gif", scale=0.25)
    assert film.startswith(b"GIF89a")
    assert (tmp_path / "film.gif").read_bytes() == film


def test_what_did_not_happen_has_no_film(play: brl.Play) -> None:
    with pytest.raises(brl.PlayError, match="the play is not valid: its rewards add up"):
        verify_play(forged(play, **{"return": 0.5})).to_gif()


# -- decisions -----------------------------------------------------------------------------------


def played(level: brl.Level, path: Path, choose: Any, actions: str = "all", **reset: Any) -> Any:
    """Record an episode, and verify it; `choose` returns an action from a state and a step."""
    env = brl.RecordPlay(level.make(observation="index", actions=actions), path)
    state, _ = env.reset(**reset)
    is_over, step = False, 0
    while not is_over:
        state, _, terminated, truncated, _ = env.step(int(choose(state, step)))
        is_over, step = terminated or truncated, step + 1
    env.close()
    return brl.replay(path)[-1]


@pytest.mark.slow
@pytest.mark.parametrize("name", ["frozen-lake", "final-maze"])
def test_the_optimum_within_the_limit_costs_nothing_whatever_chance_does(
    tmp_path: Path, name: str
) -> None:
    level = brl.load(name)
    best = brl.solve(level, within="max_steps")
    assert best.policies is not None
    policies = best.policies.reshape(len(best.policies), -1)
    path = tmp_path / "a.brlplay"
    returns = set()
    for seed in range(20):
        found = played(level, path, lambda state, step: policies[step, state], seed=seed)
        returns.add(found.play.return_)
        assert found.regret == 0
        assert found.luck == pytest.approx(found.play.return_ - best.expected_return)
    assert len(returns) > 1


@pytest.mark.parametrize("actions", ["all", "moves", "turns"])
@pytest.mark.parametrize("limit", [None, 12])
def test_regret_and_luck_add_up_to_what_a_return_lacks(
    tmp_path: Path, actions: str, limit: int | None
) -> None:
    level = brl.load({**SLIPPERY, "size": [3, 3], "max_steps": limit, "discount": 0.9})
    random = np.random.default_rng(1)
    optimum = brl.solve(level, within=limit, actions=actions).expected_return
    count = {"all": 5, "moves": 4, "turns": 3}[actions]
    for seed in range(3):
        found = played(level, tmp_path / "a", lambda *_: random.integers(count), actions, seed=seed)
        assert found.regret > 0
        assert found.play.return_ == pytest.approx(optimum - found.regret + found.luck)


def test_a_blunder_is_no_bad_luck_and_a_chosen_start_is_none(tmp_path: Path) -> None:
    level = brl.load({"version": 1, "size": [4, 1], "start": [1, 0]})
    found = played(level, tmp_path / "a", lambda _, step: [4, 2, 2, 2, 2][step])
    assert (found.regret, found.luck) == (2, 0)
    found = played(level, tmp_path / "b", lambda *_: 2, options={"start": (0, 0)})
    assert (found.regret, found.luck) == (0, 0)


def test_where_nothing_can_be_won_any_more_nothing_more_is_lost(tmp_path: Path) -> None:
    shut_in = {"walls": [{"at": [2, 0], "side": "E"}], "warps": [{"at": [0, 0], "to": [4, 0]}]}
    level = brl.load({"version": 1, "size": [5, 1], "start": [1, 0], "exit": [2, 0], **shut_in})
    env = brl.RecordPlay(level.make(), tmp_path / "a")
    env.reset()
    for action in (4, 4, 2):
        env.step(action)
    env.close()
    (found,) = brl.replay(tmp_path / "a")
    assert (found.is_valid, found.regret) == (True, math.inf)


def test_plays_of_several_robots_have_joint_actions(tmp_path: Path) -> None:
    robots = [{"name": "red", "start": [0, 0]}, {"name": "blue", "start": [3, 0]}]
    level = brl.load(
        {
            "version": 1,
            "size": [4, 2],
            "robots": robots,
            "exit": [2, 1],
            "puddles": [{"at": [1, 0], "size": "large"}],
            "max_steps": 9,
        }
    )
    path = tmp_path / "team.brlplay"
    with brl.RecordPlay(level.make(), path) as env:
        env.reset(seed=5)
        for actions in ([2, 0], [3, 4], [0, 3], [2, 1], [3, 3]):
            env.step(actions)
    (play,) = brl.read_plays(path)
    assert play.actions == [10, 19, 3, 11, 18]
    assert verify_play(play).is_valid
    fault = verify_play(forged(play, actions=changed(play.actions, 0, 15))).fault
    assert fault is not None
    assert "step 1 is not possible: south_stay from " in fault
    beyond = verify_play(forged(play, actions=changed(play.actions, 0, 25))).fault
    assert beyond is not None
    assert "step 1 is not possible: action 25 from " in beyond
    chosen = verify_play(forged(play, start="chosen")).fault
    assert chosen == "no episode can be told to start in its first state"
