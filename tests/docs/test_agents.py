"""The page on language agents: its splits, its tables, and the script that makes them."""

from __future__ import annotations

import re
from hashlib import sha256
from typing import Any
from xml.etree.ElementTree import fromstring

import pytest
from support.places import DOCS, ROOT

import babyrobot_levels as brl

PAGE = (DOCS / "agents.md").read_text("utf-8")


@pytest.fixture
def script(monkeypatch: pytest.MonkeyPatch) -> Any:
    monkeypatch.syspath_prepend(ROOT / "benchmarks")
    import text_agents

    return text_agents


def digest_of(levels: Any) -> str:
    return sha256("\n".join(level.digest for level in levels).encode()).hexdigest()[:16]


@pytest.mark.parametrize(
    ("name", "column"),
    [
        pytest.param("text-easy", 1, marks=pytest.mark.sweep),
        pytest.param("text-hard", 2, marks=pytest.mark.sweep),
    ],
)
def test_the_splits_are_fixed(name: str, column: int) -> None:
    rows = re.findall(r"^\| `(\w+)` \| `(\w{16})` \| `(\w{16})` \|$", PAGE, re.MULTILINE)
    suite = brl.load_suite(name)
    assert {row[0]: row[column] for row in rows} == {
        split: digest_of(suite.split(split)) for split in suite.splits
    }
    sizes = ", ".join(str(len(suite.split(split))) for split in suite.splits)
    assert re.search(rf"^\| `{name}` \| .* \| {suite.max_steps} \| {sizes} \|$", PAGE, re.MULTILINE)


@pytest.mark.parametrize(
    ("name", "digest"), [("text-easy", "7ccaebc6ef704b2b"), ("text-hard", "f6630ccaf74c54d9")]
)
def test_the_splits_are_fixed_in_their_first_levels(name: str, digest: str) -> None:
    # The whole suites are compared in other steps.
    assert digest_of(brl.load_suite(name).split("test")[:3]) == digest


@pytest.mark.slow
def test_baselines_are_in_order(script: Any) -> None:
    rows = {}
    levels = list(brl.load_suite("text-easy").split("test")[:8])
    for line in script.table("text-easy", levels).splitlines()[2:]:
        name, share, *_ = (cell.strip() for cell in line.strip("|").split("|"))
        rows[name] = float(share)
        assert f"| {name} |" in PAGE
    assert rows["random"] == 0
    assert rows["optimal"] == 1
    assert rows["random"] < rows["perfect, but deaf to skids"] <= 1
    assert max(rows["greedy"], rows["wall follower"]) < rows["perfect, but deaf to skids"]


def test_a_policy_that_is_deaf_to_skids_is_optimal_where_nothing_skids(script: Any) -> None:
    for name in ("first-key", "night-watch", "two-levers"):
        level = brl.load(name)
        (score,) = brl.score(level, script.deaf_to_skids(level))
        assert score.regret == pytest.approx(0)
    level = brl.load("final-maze")
    (score,) = brl.score(level, script.deaf_to_skids(level))
    assert score.regret > 0.1


def test_the_wall_follower_gets_through_any_maze_without_loops(script: Any) -> None:
    maze = brl.Level(version=1, size=[6, 6], maze={"seed": 3}, exit=[5, 5], max_steps=200)
    (score,) = brl.score(maze, script.wall_follower(), sight="words", episodes=2)
    assert (score.success, score.invalid) == (1, 0)


@pytest.mark.slow
def test_mean_regrets_come_to_the_exact_ones(script: Any) -> None:
    level = brl.load(script.LEVEL)
    picture = (DOCS / "images" / "regret.svg").read_text("utf-8")
    for name, policy in script.policies(level).items():
        (score,) = brl.score(level, policy.reshape(*level.compile().shape, 5))
        assert f">{score.regret:.2f}  {name}<" in picture
        regrets, lacks = script.lost(level, policy, 60)
        assert abs(regrets.mean() - score.regret) <= 3 * regrets.std() / 60**0.5
        assert regrets.std() < lacks.std() / 2
    assert regrets.max() == 0, "the optimal agent's"


def test_the_figure_has_a_curve_for_each_mean(script: Any) -> None:
    picture = fromstring(script.figure(4))
    assert len(picture.findall("{*}polyline")) == 6


def test_moves_and_labels_are_counted(script: Any) -> None:
    graded, labels = script.speed([brl.load("frozen-lake")])
    assert graded > 100
    assert labels > 100


def test_the_page_has_the_agent_of_the_script(script: Any) -> None:
    import inspect

    body = inspect.getsource(script.greedy).split('"""\n')[-1]
    assert body in PAGE
