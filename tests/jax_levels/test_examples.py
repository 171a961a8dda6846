"""The examples in JAX, run as users run them: they learn, and report exact returns."""

from __future__ import annotations

import argparse
import re
from pathlib import Path

import pytest
from support.places import EXAMPLES
from support.subprocesses import python

import babyrobot_levels as brl

SUITE = """
version: 1
kind: suite
name: three-by-three
seed: 2
count: 120
splits: {train: 0.8, test: 0.2}
size: [3, 3]
maze: {algorithm: wilson, loops: {max: 0.5}}
rewards: {step: -1, exit: 100}
max_steps: 30
"""


@pytest.fixture
def suite(tmp_path: Path) -> Path:
    file = tmp_path / "suite.yaml"
    file.write_text(SUITE, encoding="utf-8")
    return file


@pytest.fixture
def quickly_compiled(monkeypatch: pytest.MonkeyPatch) -> None:
    """Compile in half the time what then runs more slowly."""
    flags = "--xla_backend_optimization_level=0 --xla_llvm_disable_expensive_passes=true"
    monkeypatch.setenv("XLA_FLAGS", flags)


def printed_by(example: str, *arguments: object, cwd: Path) -> str:
    done = python(EXAMPLES / f"{example}.py", *map(str, arguments), cwd=cwd, timeout=300)
    assert (done.returncode, done.stderr) == (0, "")
    return done.stdout


def rows_of(text: str) -> list[list[float]]:
    """The lines of numbers, without separators and signs of per cent."""
    lines = [line.replace(",", "").replace("%", "") for line in text.splitlines()]
    return [list(map(float, line.split())) for line in lines if re.fullmatch(r"[-\d. ]+", line)]


@pytest.mark.sweep
def test_ppo_learns_mazes_that_it_has_not_seen(suite: Path, tmp_path: Path) -> None:
    text = printed_by("ppo_jax", "--suite", suite, "--steps", 163_840, "--every", 10,
                      "--seeds", 1, cwd=tmp_path)  # fmt: skip
    rows = rows_of(text)
    assert [row[:2] for row in rows] == [[10, 81_920], [20, 163_840]]
    *_, in_train, in_test, regret = rows[-1]
    assert 0.9 < in_test <= 1
    assert 0.9 < in_train <= 1
    assert f"seeds 0: share in test {in_test:.3f}\n" in text
    # What is lost is measured from the exact optimum; the mean of shares weighs it otherwise.
    chance = brl.score(suite, "random", split="test", actions="moves")
    assert 0 < regret < 0.1 * chance.summary.regret


@pytest.mark.sweep
def test_q_learning_finds_an_optimal_policy_in_each_level(suite: Path, tmp_path: Path) -> None:
    # 120 levels with 16 environments each.
    text = printed_by("q_learning_jax", "--suite", suite, "--steps", 76_800,
                      "--every", 4, cwd=tmp_path)  # fmt: skip
    states = sum(level.compile().num_states for level in brl.load_suite(suite))
    assert text.startswith(f"120 levels, {states:,} states\n")
    rows = rows_of(text)
    assert [row[0] for row in rows] == [4 * 120 * 16 * stage for stage in range(1, 11)]
    assert rows[0][1] < 0.9
    _, mean, least, optimal, regret = rows[-1]
    assert mean > 0.99
    assert least > 0.9
    assert optimal > 95
    assert 0 <= regret < 1


@pytest.mark.sweep
def test_levels_are_replayed_by_their_regret(suite: Path, tmp_path: Path) -> None:
    text = printed_by("level_replay_jax", "--suite", suite, "--steps", 65_536, "--every", 4,
                      "--seeds", 2, cwd=tmp_path)  # fmt: skip
    rows = rows_of(text)
    assert [row[0] for row in rows] == [32_768, 65_536]
    for _, *shares in rows:
        assert all(-1 < share <= 1 for share in shares)
    # The same seeds, drawn in two ways: each learns, and not the same.
    assert rows[0][1:4] != rows[0][4:]
    assert all(last > first for first, last in zip(rows[0][1::3], rows[1][1::3], strict=True))
    found = re.findall(r"share in test (\S+)  (\S+)$", text, re.MULTILINE)
    for seeds, column in zip(found, (2, 5), strict=True):
        assert sum(map(float, seeds)) / 2 == pytest.approx(rows[-1][column], abs=0.001)


@pytest.mark.sweep
@pytest.mark.usefixtures("quickly_compiled")
def test_evolved_levels_are_files_that_lint_and_replay(tmp_path: Path) -> None:
    text = printed_by("accel_jax", "--steps", 32_768, "--every", 2, "--score", "maxmc",
                      "-o", "evolved", cwd=tmp_path)  # fmt: skip
    rows = rows_of(text)
    assert [row[0] for row in rows] == [16_384, 32_768]
    assert all(row[share] < 1 and row[share + 1] > 0 for row in rows for share in (1, 3))
    levels = [*map(brl.load, sorted((tmp_path / "evolved").iterdir()))]
    assert f"wrote {len(levels)} levels to evolved\n" in text
    # The exit stays in the corner, and can be reached.
    assert {level.exits for level in levels} == {((4, 4),)}
    assert len({level.digest for level in levels}) > len(levels) / 2
    told = {finding.code for finding in brl.lint(tmp_path / "evolved")}
    # What cannot be reached, and how far it is, is not up to the mutants.
    assert told <= {"BR502", "BR514", "BR515"}


@pytest.mark.sweep
@pytest.mark.usefixtures("quickly_compiled")
def test_levels_are_in_the_buffer_of_jaxued(tmp_path: Path) -> None:
    pytest.importorskip("jaxued")
    text = printed_by("jaxued_levels", "--steps", 65_536, "--every", 8, cwd=tmp_path)
    [[updates, learned, *_]] = rows_of(text)
    # Four batches fill the buffer; after that, half of the updates replay.
    assert updates == 8
    assert 0 < learned < 5
    told, _, rest = text.partition("in the buffer; that with the highest score:\n")
    level = brl.loads(rest[: rest.rindex("\n", 0, -1)])
    assert level.exits == ((4, 4),)
    assert int(told.split()[-2]) > 200


def test_priorities_are_those_of_the_sampler(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(EXAMPLES)
    import jax.numpy as jnp
    import level_replay_jax

    # Ranks 2, 1, 3; the first one was played just now, the others one and three updates ago.
    found = level_replay_jax.priorities(jnp.array([5.0, 9.0, 1.0]), jnp.array([0.0, 1.0, 3.0]))
    by_rank = [rank ** (-1 / 3) for rank in (2, 1, 3)]
    by_age = [0, 1 / 4, 3 / 4]
    expected = [
        0.9 * one / sum(by_rank) + 0.1 * other for one, other in zip(by_rank, by_age, strict=True)
    ]
    assert found.tolist() == pytest.approx(expected)


@pytest.mark.parametrize(
    ("name", "splits", "message"),
    [("no-suite", (), "no-suite"), ("small-mazes", ("train", "exam"), "there is no split 'exam'")],
)
def test_what_cannot_be_is_refused(
    name: str, splits: tuple[str, ...], message: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.syspath_prepend(EXAMPLES)
    import arguments

    with pytest.raises(argparse.ArgumentTypeError, match=message):
        arguments.suite_of(name, splits)
