"""The examples, run as users run them: they learn, and report exact returns."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from support.places import EXAMPLES
from support.subprocesses import python

import babyrobot_levels as brl

Table = dict[str, tuple[float, float]]
"""The worth and the share of the optimum in per cent, by the policy's name."""


def printed_by(example: str, *arguments: object, cwd: Path) -> str:
    done = python(EXAMPLES / f"{example}.py", *map(str, arguments), cwd=cwd, timeout=600)
    assert (done.returncode, done.stderr) == (0, "")
    return done.stdout


def table_of(text: str) -> Table:
    rows = re.findall(r"^(.+?) +(-?[\d.]+) +(-?[\d.]+)%$", text, re.MULTILINE)
    return {name: (float(worth), float(share)) for name, worth, share in rows}


def check_figures(table: Table, level: str, actions: str) -> None:
    """The ends of the scale are the exact ones, and shares are measured between them."""
    worst = brl.evaluate(level, "random", actions=actions).expected_return
    best = brl.solve(level, actions=actions).expected_return
    assert table["random moves"] == (round(worst, 4), 0)
    assert table["optimum"] == (round(best, 4), 100)
    for worth, share in table.values():
        assert share == pytest.approx(100 * (worth - worst) / (best - worst), abs=0.01)


def check_mean(text: str, table: Table) -> None:
    """What trials showed agrees with the exact worth of the greedy policy."""
    found = re.search(r"^evaluate_policy: (\S+) ± (\S+) in (\d+) episodes$", text, re.MULTILINE)
    assert found
    mean, deviation, episodes = map(float, found.groups())
    assert abs(mean - table["learned, greedy"][0]) < 5 * deviation / episodes**0.5


# -- in NumPy --------------------------------------------------------------------------------


def test_value_iteration_on_data_finds_the_best_policy(tmp_path: Path) -> None:
    table = table_of(printed_by("offline", "--steps", 200_000, cwd=tmp_path))
    check_figures(table, "final-maze", actions="moves")
    assert table["learned, greedy"][1] > 99.9


@pytest.mark.sweep
def test_learned_values_are_shown_above_exact_ones(tmp_path: Path) -> None:
    text = printed_by("q_learning", "--num-envs", 512, "--steps", 1_000_000, cwd=tmp_path)
    table = table_of(text)
    check_figures(table, "final-maze", actions="moves")
    assert table["learned, greedy"][1] > 99.9
    grids = re.search(r"values, learned:\n(.*)values, exactly:\n(.*?)\n\n", text, re.DOTALL)
    assert grids
    learned, exact = (
        np.array([line.split() for line in grid.splitlines()], float) for grid in grids.groups()
    )
    best = brl.solve("final-maze", actions="moves")
    assert np.abs(exact - best.values).max() <= 0.005
    # The robots start in the upper left corner, and learn most about the way from there.
    assert np.abs(learned - exact).max() < 5
    assert abs(learned[0, 0] - exact[0, 0]) < 1


def test_where_episodes_are_cut_off_what_was_to_come_counts(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.syspath_prepend(EXAMPLES)
    import offline
    import q_learning

    # From the first start, nobody comes to the exit in time.
    level = brl.load({"version": 1, "size": [7, 1], "start": [[0, 0], [3, 0]], "max_steps": 3})
    best = brl.solve(level, actions="moves").values
    data = brl.rollout(level, "uniform", 64, 500, seed=1, actions="moves")
    assert offline.learn(data, 7, 1.0).max(axis=1) == pytest.approx(best[0])
    values = q_learning.q_learning(level, 64, 500, seed=1).max(axis=2)
    assert values[0] == pytest.approx(best[0], abs=0.2)


def test_where_no_policy_is_better_there_are_no_shares(tmp_path: Path) -> None:
    text = printed_by("offline", "--level", "image-maze", "--steps", 20_000, cwd=tmp_path)
    rows = [line.split() for line in text.splitlines()[-3:]]
    assert [row[-1] for row in rows] == ["-"] * 3
    assert rows[0][-2] == rows[2][-2] == "105.0000"


@pytest.mark.parametrize(
    ("example", "arguments", "message"),
    [
        ("q_learning", ["--level", "final-maz"], "did you mean 'final-maze'"),
        ("q_learning", ["--seed", "-1"], "'-1' is not a whole number of at least 0"),
        ("offline", ["--level", "small-mazes"], "this is a suite of levels, not a level"),
        ("offline", ["--robots", "x"], "'x' is not a whole number of at least 1"),
    ],
)
def test_what_cannot_be_is_refused(
    example: str, arguments: list[str], message: str, tmp_path: Path
) -> None:
    done = python(EXAMPLES / f"{example}.py", *arguments, cwd=tmp_path)
    assert (done.returncode, done.stdout) == (2, "")
    assert message in done.stderr
    assert "Traceback" not in done.stderr


def test_every_other_episode_is_filmed(tmp_path: Path) -> None:
    text = printed_by("record_video", "--level", "default", "--episodes", 3, cwd=tmp_path)
    films = sorted((tmp_path / "videos").iterdir())
    assert [film.name for film in films] == ["rl-video-episode-0.mp4", "rl-video-episode-2.mp4"]
    assert all(film.stat().st_size > 1000 for film in films)
    assert re.findall(r"(\d+) steps, return (\S+)", text) == [("4", "-3")] * 3
    assert "mean return -3.00\nexpected    -3.00, exactly\n" in text


# -- in PyTorch ------------------------------------------------------------------------------


@pytest.mark.libraries
@pytest.mark.parametrize(
    "example",
    # The page on training has the first program, and runs it.
    [
        pytest.param("ppo_sb3", marks=pytest.mark.sweep),
        "maskable_ppo",
        pytest.param("ppo_cleanrl", marks=pytest.mark.sweep),
    ],
)
def test_networks_come_close_to_the_best_policy(example: str, tmp_path: Path) -> None:
    text = printed_by(example, "--steps", 100_000, cwd=tmp_path)
    table = table_of(text)
    check_figures(table, "final-maze", actions="all")
    assert table["learned, as it explores"][1] > 98
    assert table["learned, greedy"][1] > 98
    if example != "ppo_cleanrl":
        check_mean(text, table)


@pytest.mark.libraries
@pytest.mark.parametrize(
    ("example", "steps"),
    [
        # The page on training has the same program, and others learn with RLlib, too.
        pytest.param("ppo_rllib", 130_000, marks=pytest.mark.sweep),
        pytest.param("ppo_torchrl", 102_400, marks=pytest.mark.sweep),
    ],
)
def test_libraries_with_loops_of_their_own_come_close(
    example: str, steps: int, tmp_path: Path
) -> None:
    script = EXAMPLES / f"{example}.py"
    done = python(
        script, "--steps", str(steps), cwd=tmp_path, timeout=600, warnings="ignore"
    )  # they warn of what is deprecated in themselves
    assert done.returncode == 0, done.stderr
    table = table_of(done.stdout)
    check_figures(table, "final-maze", actions="all")
    assert table["learned, as it explores"][1] > 98
    assert table["learned, greedy"][1] > 98


@pytest.mark.libraries
@pytest.mark.flaky(reruns=1)
@pytest.mark.parametrize(
    ("example", "level", "steps", "discount", "least"),
    [
        # Less than half of the default is enough to get far from random moves.
        pytest.param(
            *("ppo_rllib_team", "passing-place", 5_120, 0.95, 20), marks=pytest.mark.sweep
        ),
        # Where one robot leaves the other behind, the share is below 20 %.
        ("mappo_torchrl", "two-pads", 131_072, 0.99, 60),
    ],
)
def test_teams_learn_with_libraries(
    example: str, level: str, steps: int, discount: float, least: float, tmp_path: Path
) -> None:
    script = EXAMPLES / f"{example}.py"
    done = python(script, "--steps", str(steps), cwd=tmp_path, timeout=600, warnings="ignore")
    assert done.returncode == 0, done.stderr
    table, random = table_of(done.stdout), brl.score_team(level, "random", discount)
    assert table["random moves"] == (round(random.expected_return, 4), 0)
    assert table["optimum"] == (round(random.best_return, 4), 100)
    assert least < table["learned, as they explore"][1] <= 100
    regrets = re.findall(r"^regrets, (.+?): red (\S+), blue (\S+)$", done.stdout, re.MULTILINE)
    assert [name for name, *_ in regrets] == ["learned, as they explore", "learned, greedy"]
    assert all(float(each) >= 0 for _, *found in regrets for each in found)


@pytest.mark.sweep
@pytest.mark.libraries
def test_a_network_of_action_values_comes_close_to_the_best_policy(tmp_path: Path) -> None:
    text = printed_by("dqn_sb3", cwd=tmp_path)
    table = table_of(text)
    check_figures(table, "final-maze", actions="all")
    assert table["learned, as it explores"][1] > 98
    assert table["learned, greedy"][1] > 98
    check_mean(text, table)


@pytest.mark.sweep
@pytest.mark.libraries
def test_memory_does_better_than_any_policy_without_it(tmp_path: Path) -> None:
    text = printed_by("recurrent_ppo", "--steps", 30_000, cwd=tmp_path)
    table = table_of(text)
    level = brl.load(EXAMPLES / "t-maze.yaml")
    check_figures(table, str(EXAMPLES / "t-maze.yaml"), actions="moves")
    # At the end of both corridors the same is seen: without memory, any choice is right in one.
    upper, lower = (4, 1), (4, 4)
    env = level.make(observation="view", view_radius=1, actions="moves")
    views = [env.reset(options={"start": end})[0] for end in (upper, lower)]
    assert np.array_equal(*views)
    chances = np.eye(4)[brl.solve(level, actions="moves").policy.clip(0)]
    for x, y in (upper, lower):
        chances[y, x] = [0.5, 0, 0.5, 0]
    forgetful = brl.evaluate(level, chances.reshape(-1, 4), actions="moves").expected_return
    assert forgetful == pytest.approx(-18)
    assert table["learned, in trials"][0] > -6


@pytest.mark.libraries
def test_what_is_cut_off_counts_what_was_to_come(monkeypatch: pytest.MonkeyPatch) -> None:
    import torch

    monkeypatch.syspath_prepend(EXAMPLES)
    import ppo_cleanrl

    # Three steps of three robots: after the second one, the first is cut off, the second at an
    # exit, and the third goes on. Its last step leads to a cell of value 7.
    values = torch.tensor([[1.0] * 3, [2.0] * 3, [5.0] * 3, [7.0] * 3])
    rewards = torch.tensor([[-1.0] * 3, [-2.0] * 3, [-3.0] * 3])
    over = torch.tensor([[False] * 3, [False] * 3, [True, True, False], [False] * 3])
    ended = torch.tensor([[False] * 3, [False, True, False], [False] * 3])
    advantages, returns = ppo_cleanrl.estimate(values, rewards, ended, over, 0.9)

    last = -3 + 0.9 * 7 - 5
    second = [-2 + 0.9 * 5 - 2, -2 - 2, -2 + 0.9 * 5 - 2 + 0.9 * 0.95 * last]
    first = [-1 + 0.9 * 2 - 1 + 0.9 * 0.95 * ahead for ahead in second]
    assert advantages.tolist() == pytest.approx(np.array([first, second, [last] * 3]))
    assert torch.equal(returns, advantages + values[:-1])


# -- with other libraries --------------------------------------------------------------------

OF_LIBRARIES = ["ppo_sb3", "dqn_sb3", "maskable_ppo", "recurrent_ppo", "cleanrl_files", "ppo_rllib",
                "ppo_torchrl", "dqn_tianshou", "imitation_tianshou", "dataset_minari"]  # fmt: skip


@pytest.mark.parametrize("example", OF_LIBRARIES)
def test_these_examples_are_short(example: str) -> None:
    lines = (EXAMPLES / f"{example}.py").read_text(encoding="utf-8").splitlines()
    assert len(lines) <= 60


@pytest.mark.libraries
@pytest.mark.parametrize(
    ("example", "actions"),
    [
        # The page on training has Tianshou's DQN, and others imitate with Tianshou, too.
        pytest.param("dqn_tianshou", "all", marks=pytest.mark.sweep),
        pytest.param("dataset_minari", "moves", marks=pytest.mark.sweep),
    ],
)
def test_other_libraries_come_close_to_the_best_policy(
    example: str, actions: str, tmp_path: Path
) -> None:
    text = printed_by(example, cwd=tmp_path)
    table = table_of(text)
    check_figures(table, "final-maze", actions)
    assert table["learned, greedy"][1] > 98
    if example == "dataset_minari":
        score = re.search(r"^normalized score: (\S+)$", text, re.MULTILINE)
        assert score
        assert 100 * float(score[1]) == pytest.approx(table["learned, greedy"][1], abs=0.01)


@pytest.mark.sweep
@pytest.mark.libraries
def test_imitation_solves_mazes_that_it_has_not_seen(tmp_path: Path) -> None:
    text = printed_by("imitation_tianshou", "--steps", 500, cwd=tmp_path)
    table = table_of(text)
    assert table["random moves"][1] == 0
    assert table["learned, greedy"][1] > 70
    assert table["optimum"][1] == 100
    found = re.search(r"^learned, greedy: optimal in (\S+)% of the levels$", text, re.MULTILINE)
    assert found
    assert float(found[1]) > 70


def test_returns_in_several_levels_are_those_of_their_first_episodes(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.syspath_prepend(EXAMPLES)
    import comparison

    # It takes 1 and 3 steps to the exit; in the time of the second, the first begins again.
    levels = [
        brl.load({"version": 1, "size": [width, 1], "exit": [width - 1, 0]}) for width in (2, 4)
    ]
    best = [brl.solve(each, actions="moves") for each in levels]
    returns = comparison.returns_in(levels, [each.policy for each in best], 10, "moves")
    assert returns.tolist() == [each.expected_return for each in best]
    # An episode that is cut off has the rewards until then.
    assert comparison.returns_in(levels, [each.policy for each in best], 2, "moves")[1] == -2


# -- on a Ray cluster ------------------------------------------------------------------------


@pytest.fixture
def address() -> Iterator[str]:
    """The address of a cluster that runs already, as `ray start --head` begins one."""
    from ray.cluster_utils import Cluster

    cluster = Cluster(initialize_head=True, head_node_args={"num_cpus": 2})
    yield cluster.address
    cluster.shutdown()


@pytest.mark.sweep
@pytest.mark.libraries
@pytest.mark.flaky(reruns=1)
def test_ppo_is_scored_in_each_maze_of_the_other_split(address: str, tmp_path: Path) -> None:
    script = EXAMPLES / "ppo_rllib_suite.py"
    arguments = ["--steps", "4000", "--env-runners", "1", "--address", address]
    done = python(script, *arguments, cwd=tmp_path, timeout=600, warnings="ignore")
    assert done.returncode == 0, done.stderr
    rows = re.findall(r"^(tiny-mazes-\d+)((?: +\S+){4}) +(\S+)%$", done.stdout, re.MULTILINE)
    shares = []
    scores = brl.score(
        brl.load_suite(EXAMPLES / "tiny-mazes.yaml"), "random", split="test", actions="moves"
    )
    for (name, returns, share), score in zip(rows, scores, strict=True):
        random, learned, _, optimum = map(float, returns.split())
        assert name == score.level
        assert (random, optimum) == (round(score.random, 2), round(score.optimum, 2))
        shares.append(100 * (learned - random) / (optimum - random))
        assert shares[-1] == pytest.approx(float(share), abs=0.15)
    found = re.search(r"unseen mazes: (\S+)%, greedy \S+%$", done.stdout, re.MULTILINE)
    assert found
    assert float(found[1]) == pytest.approx(np.mean(shares), abs=0.15)
    # One update is too few to learn the mazes, but its moves are those that the masks allow.
    assert float(found[1]) > -50


@pytest.mark.libraries
def test_where_there_is_no_cluster_it_is_said(tmp_path: Path) -> None:
    script = EXAMPLES / "sweep_tune.py"
    done = python(script, "--address", "localhost:1", cwd=tmp_path, warnings="ignore")
    assert (done.returncode, done.stdout) == (1, "")
    assert "no Ray cluster can be reached at localhost:1" in done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.sweep
@pytest.mark.libraries
@pytest.mark.flaky(reruns=1)
def test_a_sweep_finds_what_each_of_its_trials_finds_alone(tmp_path: Path) -> None:
    sizes, seeds, episodes = [0.1, 1.0], [0, 1], 100
    arguments = ["--step-sizes", *sizes, "--seeds", len(seeds), "--episodes", episodes]
    done = python(
        EXAMPLES / "sweep_tune.py",
        *map(str, ["--levels", "maze", *arguments]),
        cwd=tmp_path,
        timeout=600,
        warnings="ignore",
    )
    assert done.returncode == 0, done.stderr
    rows = re.findall(r"^([\d.]+) +(\S+)% +(\S+)%$", done.stdout, re.MULTILINE)
    for (size, share, mean), expected in zip(rows, sizes, strict=True):
        learned = [
            [*brl.q_learning("maze", episodes, step_size=expected, seed=seed)][-1].policy
            for seed in seeds
        ]
        scores = [brl.score("maze", each, actions="moves")[0].share for each in learned]
        assert float(size) == expected
        assert float(share) == float(mean) == pytest.approx(100 * np.mean(scores), abs=0.051)
    assert (tmp_path / "sweep").is_dir()


# -- files of others -------------------------------------------------------------------------

SINGLE_FILE = """
import sys

import gymnasium as gym
import numpy as np
import torch
from torch import nn

env_id, steps = sys.argv[sys.argv.index("--env-id") + 1], 10_000
torch.manual_seed(int(sys.argv[sys.argv.index("--seed") + 1]))


def make_env():
    env = gym.make(env_id)
    env = gym.wrappers.RecordEpisodeStatistics(env)
    env.action_space.seed(1)
    return env


class Agent(nn.Module):
    def __init__(self, envs):
        super().__init__()
        inputs = int(np.array(envs.single_observation_space.shape).prod())
        self.actor = nn.Linear(inputs, envs.single_action_space.n)


envs = gym.vector.SyncVectorEnv([make_env for _ in range(2)])
assert isinstance(envs.single_action_space, gym.spaces.Discrete)
agent = Agent(envs)
shape = (steps, 2)
stored = torch.zeros(shape + envs.single_observation_space.shape)
actions = torch.zeros(shape + envs.single_action_space.shape)
replayed = np.zeros(stored.shape, envs.single_observation_space.dtype)
next_obs, _ = envs.reset(seed=1)
returns = []
for step in range(steps):
    stored[step] = torch.Tensor(next_obs)
    replayed[step] = next_obs.copy()
    if step % 2:
        logits = agent.actor(torch.Tensor(next_obs))
        action = torch.distributions.Categorical(logits=logits).sample()
    else:
        action = torch.tensor([envs.single_action_space.sample() for _ in range(2)])
    actions[step] = action
    next_obs, reward, terminations, truncations, infos = envs.step(action.cpu().numpy())
    assert torch.tensor(reward).view(-1).shape == (2,)
    assert torch.Tensor(np.logical_or(terminations, truncations)).shape == (2,)
    assert not truncations.any(), "infos have no final_observation any more"
    if "episode" in infos:
        returns += infos["episode"]["r"][infos["_episode"]].tolist()
assert np.array_equal(stored.numpy(), replayed)
print("episodes:", len(returns), "returns:", min(returns), max(returns))
"""
"""What CleanRL's files ask of an environment, without the learning."""


@pytest.mark.libraries
def test_files_in_the_style_of_cleanrl_run_unchanged(tmp_path: Path) -> None:
    file = tmp_path / "single.py"
    file.write_text(SINGLE_FILE, encoding="utf-8")
    text = printed_by("cleanrl_files", file, "--seed", 1, cwd=tmp_path)
    found = re.match(r"episodes: (\d+) returns: (\S+) (\S+)$", text, re.MULTILINE)
    assert found
    assert int(found[1]) > 1
    # Rewards are divided by 10.
    assert -10_000 < float(found[2]) < float(found[3]) < -3
    assert re.search(r"^optimum +-36\.5833 +100\.00%$", text, re.MULTILINE)
