"""What other programs read of POMDPs, and what Storm's engine for them says."""

from __future__ import annotations

from multiprocessing import get_context
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
import pytest
import stormpy
import stormpy.developer
import stormpy.pomdp
from extensions.sight.cases import Fields, levels_of, sight_of, slow_solver, walls
from pomdp_toolkit.parsers import POMDPParser
from support.combinations import swept

import babyrobot_levels as brl
from babyrobot_levels.extensions.sight.solve import SightSolution, solve_sight
from babyrobot_levels.extensions.sight.writers import write_drn, write_pomdp, write_prism

MOST_ALIKE = 12

PATIENCE = 20
"""So many seconds Storm may take for a file."""

ROUNDING = 1e-5
"""By which share of the value Storm's default precision may be wrong."""


def model_of(path: Path) -> Any:
    """Return the model of a file, with the names of actions, which Storm needs of POMDPs."""
    if path.suffix == ".drn":
        parsing = stormpy.developer.DirectEncodingParserOptions()
        parsing.build_choice_labeling = True
        return stormpy.build_model_from_drn(str(path), options=parsing)
    options = stormpy.BuilderOptions()
    options.set_build_choice_labels()
    options.set_build_all_labels()
    options.set_build_all_reward_models()
    return stormpy.build_model(stormpy.parse_prism_program(str(path)), options=options)


def bounds_of(path: Path, alike: int) -> tuple[float, float]:
    """Return what Storm says that a file is worth, at least and at most."""
    model = model_of(path)
    (costs,) = stormpy.parse_properties('R{"cost"}min=? [F "end"]')
    below = stormpy.pomdp.verify_with_belief_unfolding(model, costs, max_exploration_time=1)
    upper = -below.value if below.completed_exploration else np.inf
    # The grid of beliefs grows fast with the states that look alike.
    if alike <= MOST_ALIKE:
        above = stormpy.pomdp.verify_with_belief_discretization(model, costs, resolution=2)
        upper = min(upper, -above.value)
    return -below.value, upper


def send_bounds(connection: Any, path: Path, alike: int) -> None:
    """Send what Storm says to the process that waits for it."""
    connection.send(bounds_of(path, alike))


def check(found: SightSolution, path: Path) -> bool:
    """Compare bounds with Storm's, of levels whose rewards all are costs.

    Returns:
        Whether Storm answers: version 2.0.0 does not come back from some files.
    """
    fork, alike = get_context("fork"), int(np.bincount(found.model.observation).max())
    ours, theirs = fork.Pipe(duplex=False)
    child = fork.Process(target=send_bounds, args=(theirs, path, alike), daemon=True)
    child.start()
    theirs.close()
    answers = ours.poll(PATIENCE)
    lower, upper = ours.recv() if answers else (-np.inf, np.inf)
    child.kill()
    child.join()
    room = ROUNDING * max(1.0, abs(found.upper))
    assert lower <= found.upper + room
    assert upper >= found.lower - room
    return answers


def with_costs(value: Any, *, is_reward: bool = False) -> Any:
    """Return fields of a level whose rewards all are costs."""
    if isinstance(value, dict):
        return {
            key: with_costs(each, is_reward=is_reward or key in ("reward", "rewards"))
            for key, each in value.items()
        }
    if isinstance(value, list):
        return [with_costs(each) for each in value]
    # An exit that pays what its cell does says so by a word.
    return -1 - abs(value) if is_reward and isinstance(value, int | float) else value


def costly(seed: int) -> list[Fields] | None:
    """Return levels in which each step costs something; None if some episodes cannot end."""
    levels = [with_costs({"rewards": {}, **fields}) for fields in levels_of(seed)]
    for fields in levels:
        fields["rewards"].setdefault("step", -1)
    if max(slow_solver(levels, sight_of(seed)).rewards()) >= 0:
        return None
    is_finite = all(np.isfinite(brl.solve(fields, 1).expected_return) for fields in levels)
    return levels if is_finite else None


@pytest.mark.parametrize("cases", swept([20], [100]))
def test_storm_agrees_on_random_levels(cases: int, tmp_path: Path) -> None:
    compared, silent, partial, seed = 0, 0, 0, 0
    while compared < cases:
        seed += 1
        if (levels := costly(seed)) is None:
            continue
        found = solve_sight(levels, discount=1, beliefs=300, **sight_of(seed))
        if not np.isfinite(found.lower):
            continue
        writing, name = Random(seed).choice(((write_prism, "a.prism"), (write_drn, "a.drn")))
        path = tmp_path / name
        path.write_text(writing(found.model))
        if check(found, path):
            compared += 1
            partial += found.upper < found.full - 1e-6
        else:
            silent += 1
    assert silent <= cases / 20
    assert partial >= cases / 10


@pytest.mark.parametrize("name", ["shell-game", "bat-cave", "ice-rink"])
def test_storm_agrees_on_the_gallery(name: str, tmp_path: Path) -> None:
    found = solve_sight(name, "view", view_radius=1, beliefs=500)
    for writing, file in ((write_prism, "a.prism"), (write_drn, "a.drn")):
        path = tmp_path / file
        path.write_text(writing(found.model))
        assert check(found, path)


@pytest.mark.parametrize(
    ("level", "sight"), [("shell-game", "view"), ("russell-norvig-4x3", walls), ("ice-rink", walls)]
)
def test_pomdp_toolkit_reads_the_same_tables(level: str, sight: Any, tmp_path: Path) -> None:
    model = solve_sight(level, sight, beliefs=10).model
    path = tmp_path / "a.pomdp"
    path.write_text(write_pomdp(model))
    read = POMDPParser.parse(str(path))
    size, actions = model.size, model.num_actions
    chances = np.zeros((size, actions, size))
    rows = np.repeat(np.arange(size * actions), np.diff(model.rows))
    np.add.at(chances, (*np.divmod(rows, actions), model.target), model.probability)
    table = np.asarray(read.transition_table)
    np.testing.assert_allclose(table[:size, :, :size], chances, atol=1e-12)
    np.testing.assert_allclose(table.sum(axis=2), 1, atol=1e-12)
    np.testing.assert_allclose(read.start_probabilities[:size], model.start, atol=1e-12)
    seen = np.asarray(read.observation_table)[:size, 0].argmax(axis=1)
    np.testing.assert_array_equal(seen, model.observation)
    rewards = np.asarray(read.immediate_reward_table)[:size, :, 0, 0]
    np.testing.assert_allclose(rewards, model.reward, atol=1e-12)
