"""Scores of agents: exact where an agent has no memory, and within an interval where it has."""

from __future__ import annotations

import csv
import io
import json
import math
from typing import Any

import numpy as np
import pytest

import babyrobot_levels as brl

NAMES = ["frozen-lake", "first-key", "four-rooms", "treasure-chests"]


@pytest.mark.sweep
def test_the_optimal_policy_has_no_regret_in_any_level_of_the_gallery() -> None:
    for info in brl.levels():
        level = brl.load(info.name)
        if not level.has_random_maze:
            # What is optimal at each step depends on the time: it is evaluated by step.
            found = brl.evaluate(level, brl.solve(level, within="max_steps"))
            best = brl.score(level, "random")[0].optimum
            assert abs(best - found.expected_return) <= 1e-12 * max(1.0, abs(best))


@pytest.mark.slow
def test_chance_has_a_share_of_zero() -> None:
    scores = brl.score(NAMES, "random")
    assert [score.level for score in scores] == NAMES
    assert scores.is_exact
    for score in scores:
        assert score.share == pytest.approx(0.0)
        assert score.expected_return == score.low == score.high == score.random
        assert score.regret == pytest.approx(score.optimum - score.random)
        within = brl.evaluate(score.level, "random", within="max_steps")
        assert score.expected_return == pytest.approx(within.expected_return)
        assert score.success == pytest.approx(within.exit_probability)
        assert score.steps == pytest.approx(within.expected_steps)


@pytest.mark.slow
def test_a_policy_by_level() -> None:
    policies = {name: brl.solve(name) for name in NAMES}
    scores = brl.score(NAMES, policies)
    assert scores[1].share == pytest.approx(1.0)
    assert scores[1].regret == pytest.approx(0.0, abs=1e-12)
    # The best policy without a limit is not the best one within 100 steps.
    assert 0.99 < scores[0].share < 1.0
    by_digest = {brl.load(name).digest: policy for name, policy in policies.items()}
    assert [score.share for score in brl.score(NAMES, by_digest)] == [s.share for s in scores]
    with pytest.raises(ValueError, match="no policy for the level 'maze'"):
        brl.score("maze", policies)


@pytest.mark.parametrize(
    ("observation", "read"),
    [
        ("position", lambda seen: (int(seen[0]), int(seen[1]))),
        ("index", lambda seen: (int(seen) % 4, int(seen) // 4)),
        (("position", "view"), lambda seen: tuple(map(int, seen["position"]))),
    ],
)
def test_a_function_of_observations(observation: Any, read: Any) -> None:
    solution = brl.solve("frozen-lake")

    def agent(seen: Any) -> int:
        x, y = read(seen)
        return int(solution.policy[y, x])

    score = brl.score("frozen-lake", agent, observation=observation)[0]
    expected = brl.evaluate("frozen-lake", solution, within="max_steps")
    assert score.expected_return == pytest.approx(expected.expected_return, abs=1e-12)


def test_a_function_of_many_observations_may_give_probabilities() -> None:
    def agent(seen: Any) -> Any:
        assert seen.ndim == 4
        return np.full((len(seen), 4), 0.25)

    score = brl.score("final-maze", agent, observation="view", actions="moves", batched=True)[0]
    expected = brl.evaluate("final-maze", "uniform", actions="moves", within="max_steps")
    assert score.expected_return == pytest.approx(expected.expected_return)


class Turner:
    """Walks along a wall on its left; what it did last is its memory."""

    def reset(self) -> None:
        self.heading = 1

    def act(self, observation: Any, mask: Any) -> int:
        for turn in (-1, 0, 1, 2):
            heading = (self.heading + turn) % 4
            if mask[heading]:
                break
        self.heading = heading
        return heading


@pytest.mark.slow
def test_an_agent_with_memory_plays_episodes() -> None:
    scores = brl.score(["maze", "final-maze"], Turner(), actions="moves", episodes=200, seed=3)
    maze, wet = scores
    assert not scores.is_exact
    assert maze.episodes == 200
    # All episodes are the same, but an agent might behave otherwise in one of a hundred.
    assert maze.low == pytest.approx(-50, abs=1)
    assert maze.expected_return == -42
    assert -42 < maze.high < -41.5
    assert maze.success == 1.0
    assert wet.low < wet.expected_return < wet.high
    again = brl.score(["maze", "final-maze"], Turner(), actions="moves", episodes=200, seed=3)
    assert again[1] == wet


class Drawer:
    """Takes any action, as the random policy does, but may remember."""

    def __init__(self, seed: int) -> None:
        self.random = np.random.default_rng(seed)

    def reset(self) -> None:
        pass

    def act(self, observation: Any, mask: Any) -> int:
        return int(self.random.choice(np.flatnonzero(mask)))


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:of an agent with memory")
def test_few_episodes_do_not_hide_what_is_rare() -> None:
    (exact,) = brl.score("frozen-lake", "random")
    found = [brl.score("frozen-lake", Drawer(n), episodes=30, seed=n) for n in range(20)]
    assert sum(each[0].expected_return == 0 for each in found) > 8
    held = [each[0].low <= exact.expected_return <= each[0].high for each in found]
    assert sum(held) >= 19
    assert all(each[0].high - each[0].low < 0.25 for each in found)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:of an agent with memory")
def test_the_interval_of_a_summary() -> None:
    names = ["frozen-lake", "final-maze", "maze", "first-key"]
    (few, all_) = (brl.score(names, Drawer(1), episodes=n, actions="moves") for n in (5, 50))
    for scores in (few, all_):
        assert scores.summary.low < 0 < scores.summary.high
        assert scores[:2].summary.low < scores[:2].summary.high
    assert all_.summary.high - all_.summary.low < few.summary.high - few.summary.low
    assert f"high={few.summary.high:.4g}" in repr(few)
    # The same level has the same episodes whatever else is scored.
    assert brl.score(names[0], Drawer(1), episodes=5, actions="moves")[0] == few[0]
    exact = brl.score(names, "random").summary
    assert exact.low == exact.mean == exact.high


def test_few_episodes_are_warned_of() -> None:
    with pytest.warns(UserWarning, match="99 episodes in each level tell little") as caught:
        scores = brl.score("maze", Turner(), actions="moves", episodes=99)
    assert scores.notice is not None
    assert brl.score("maze", "random").notice is None
    assert brl.score("maze", Turner(), actions="moves", episodes=100).notice is None
    with pytest.raises(ValueError, match="episodes must be a whole number, at least 1, not 0"):
        brl.score("maze", Turner(), actions="moves", episodes=0)
    assert caught[0].filename == __file__


def test_parts_of_suites_share_the_space_of_the_suite() -> None:
    suite = brl.load_suite("classics")
    shapes = set()

    def agent(seen: Any) -> int:
        shapes.add(seen.shape)
        return 0

    brl.score(suite[:2], agent, observation="planes")
    assert len(shapes) == 1


@pytest.mark.slow
def test_a_summary_in_the_terms_of_the_field() -> None:
    scores = brl.score(NAMES, {name: brl.solve(name) for name in NAMES})
    shares = sorted(score.share for score in scores)
    summary = scores.summary
    assert summary.levels == 4
    assert summary.mean == pytest.approx(sum(shares) / 4)
    assert summary.median == pytest.approx((shares[1] + shares[2]) / 2)
    assert summary.iqm == pytest.approx((shares[1] + shares[2]) / 2)
    assert summary.worst_tenth == shares[0]
    assert summary.solved == 1.0
    assert repr(scores).startswith("<Scores of 4 levels: mean=0.99")


def test_levels_in_which_chance_is_optimal_have_no_share() -> None:
    level = {"version": 1, "size": [2, 1], "start": [0, 0], "max_steps": 5, "rewards": {"step": 0}}
    scores = brl.score([level, "maze"], "random")
    assert math.isnan(scores[0].share)
    assert scores.summary.mean == pytest.approx(0.0)
    assert json.loads(scores.to_json())["levels"][0]["share"] is None


@pytest.mark.slow
def test_scores_are_tables_for_other_programs(tmp_path: Any) -> None:
    scores = brl.score(NAMES, "random")
    path = tmp_path / "scores.csv"
    assert scores.to_csv(path) == path.read_text("utf-8")
    rows = list(csv.DictReader(io.StringIO(path.read_text("utf-8"))))
    assert [row["level"] for row in rows] == NAMES
    assert float(rows[0]["optimum"]) == scores[0].optimum
    data = json.loads(scores.to_json())
    assert data["levels"][1]["expected_return"] == scores[1].expected_return
    assert data["summary"]["levels"] == 4


@pytest.mark.parametrize(
    ("agent", "message"),
    [
        (lambda seen: 7, "an action from 0 to 4, or 5 probabilities, not 7"),
        (lambda seen: "north", "an action from 0 to 4, or 5 probabilities, not 'north'"),
        (lambda seen: [0.5, 0.5, 0.5, 0.0, 0.0], "add up to 1"),
    ],
)
def test_answers_that_are_no_actions(agent: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        brl.score("maze", agent)


def test_what_is_no_agent() -> None:
    with pytest.raises(TypeError, match="int is no agent"):
        brl.score("maze", 3)
    with pytest.raises(TypeError, match=r"with the observation alone, and this one takes .x, y."):
        brl.score("maze", lambda x, y: 0)
    with pytest.raises(ValueError, match=r"no agent 'bets'; did you mean `best`; an agent is"):
        brl.score("maze", "bets")
    with pytest.raises(ValueError, match="split is a part of a suite"):
        brl.score("maze", "random", split="test")
    with pytest.raises(ValueError, match="there are no levels to score"):
        brl.score([], "random")


def test_without_a_limit_an_infinite_optimum_is_explained() -> None:
    wall = {"at": [0, 0], "side": "E"}
    level = {"version": 1, "name": "pit", "size": [2, 1], "start": [0, 0], "walls": [wall]}
    with pytest.raises(ValueError, match=r"pit has no score: .*within=200"):
        brl.score(level, "random")


def test_the_best_agent_is_solved_in_each_level() -> None:
    scores = brl.score(["maze", "final-maze"], "best")
    assert [score.regret for score in scores] == pytest.approx([0, 0], abs=1e-9)


@pytest.mark.slow
def test_the_optimum_within_a_limit_has_no_regret() -> None:
    best = brl.solve("frozen-lake", within="max_steps")
    for agent in (best, best.policies, {"frozen-lake": best}):
        (found,) = brl.score("frozen-lake", agent)
        assert found.regret == pytest.approx(0, abs=1e-12)
        assert found.success == pytest.approx(best.exit_probability)
    assert brl.success_within("frozen-lake", best) == pytest.approx(best.exit_probability)
    with pytest.raises(ValueError, match="one for episodes of 100 steps; give within=100"):
        brl.score("frozen-lake", best, within=99)


def test_learnability_is_highest_where_success_is_a_coin_toss() -> None:
    for score in brl.score(NAMES, "random"):
        assert score.learnability == pytest.approx(score.success * (1 - score.success))


@pytest.mark.slow
def test_more_is_found_if_it_is_asked_for() -> None:
    policies = {name: brl.solve(name, within="max_steps") for name in NAMES}
    for agent in ("random", policies):
        for score in brl.score(NAMES, agent, positive_advantage=True, cvar=0.2):
            policy = agent if isinstance(agent, str) else agent[score.level]
            returns = brl.return_distribution(score.level, policy)
            assert score.cvar is not None
            assert score.positive_advantage is not None
            assert score.cvar == pytest.approx(returns.cvar(0.2))
            assert score.cvar <= score.expected_return + 1e-9
            assert (score.positive_advantage > 0) == (agent == "random")
    (plain,) = brl.score("frozen-lake", "random")
    assert plain.positive_advantage is plain.cvar is None
    endless = brl.load("frozen-lake").replace(max_steps=None)
    (found,) = brl.score(endless, "random", positive_advantage=True, cvar=0.5)
    assert found.positive_advantage == pytest.approx(0.0016, abs=1e-4)
    assert found.cvar == 0.0


def test_more_needs_an_agent_without_memory_and_a_share() -> None:
    class Forgetful:
        def reset(self) -> None: ...

        def act(self, observation: Any, mask: Any) -> int:
            return int(np.flatnonzero(mask)[0])

    with pytest.raises(
        ValueError, match=r"^positive_advantage and cvar are for agents without memory"
    ):
        brl.score("maze", Forgetful(), cvar=0.1)
    with pytest.raises(ValueError, match=r"^cvar must be above 0 and at most 1, not 5$"):
        brl.score("maze", "random", cvar=5)


def test_an_option_that_there_is_not_is_refused() -> None:
    with pytest.raises(TypeError, match="option 'see_trough'; did you mean `see_through`"):
        brl.score("maze", "random", see_trough=True)


def east_or_south(position: Any) -> int:
    return 2 if position[0] < 3 else 3


@pytest.mark.parametrize("agent", ["random", "uniform", east_or_south, brl.solve("frozen-lake")])
def test_a_table_earns_what_its_agent_earns(agent: Any) -> None:
    table = brl.policy_table("frozen-lake", agent)
    assert table.shape == (4, 4, 5)
    one, other = (brl.score(["frozen-lake"], each)[0] for each in (agent, table))
    assert one.expected_return == pytest.approx(other.expected_return)


# -- the average reward ----------------------------------------------------------------------


def test_agents_are_compared_by_the_average_reward_of_a_step() -> None:
    def score(agent: Any, **options: Any) -> brl.Scores:
        how = {"actions": "moves", "criterion": "average", **options}
        return brl.score("gridworld-3-5", agent, **how)

    (best,) = score("best")
    # From A to A' and back, 10 in five steps.
    assert (best.expected_return, best.optimum, best.share) == pytest.approx((2, 2, 1))
    random = brl.evaluate("gridworld-3-5", "random", actions="moves", criterion="average")
    assert best.random == pytest.approx(random.expected_gain)
    # North for ever costs 1 a step at the edge, but from A, whence it leads back for 10.
    (north,) = score(lambda position: 0)
    always = np.zeros((5, 5), int)
    found = brl.evaluate("gridworld-3-5", always, actions="moves", criterion="average")
    assert north.expected_return == pytest.approx(found.expected_gain)
    assert north.regret == pytest.approx(2 - found.expected_gain)
    assert (north.success, north.steps) == (0, math.inf)
    assert score("best").to_dict()["criterion"] == "average"


def test_the_average_reward_is_not_for_all_questions_and_agents() -> None:
    class Remembering:
        def reset(self) -> None: ...

        def act(self, observation: Any, mask: Any) -> int:
            return 1

    with pytest.raises(ValueError, match="`within` is for returns"):
        brl.score("gridworld-3-5", "best", within=3, criterion="average")
    with pytest.raises(ValueError, match="without memory"):
        brl.score("gridworld-3-5", Remembering(), criterion="average")
