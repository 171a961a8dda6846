"""The gallery: every level loads, says what it is, can be won, and is the world that it claims."""

from __future__ import annotations

import re
from collections import deque
from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray
from support.each import for_each
from support.places import GALLERY_FOLDER, ROOT

import babyrobot_levels as brl
from babyrobot_levels.analysis.solver.horizon import best_return_within
from babyrobot_levels.analysis.solver.linear import expected_sums
from babyrobot_levels.analysis.solver.optimum import solve
from babyrobot_levels.analysis.solver.policies import space_of
from babyrobot_levels.language.fields import LevelFields
from babyrobot_levels.library.level import Level, load_file
from babyrobot_levels.mdp.actions import Action
from babyrobot_levels.mdp.states import exit_states
from babyrobot_levels.mdp.tables import Mdp

# `themes/NAME.yaml` beside a level is a theme.
PATHS = [
    path
    for path in sorted(GALLERY_FOLDER.rglob("*.yaml"))
    if path.parent.name not in ("themes", "suites")
]
FILES = {path.stem: path for path in PATHS}
MAZE_SEEDS = range(10)

ARTICLE_WORLDS = {
    "default",
    "walls",
    "side-panel",
    "puddle-test",
    "maze",
    "maze-changed",
    "final-maze",
    "areas",
    "blocked-shapes",
    "glass-wall",
}

each_level = for_each("name", FILES)


@cache
def load(name: str) -> Level:
    return load_file(FILES[name])


def games(name: str) -> list[Level]:
    """Return the level, or ten of the levels that it can be where its maze is drawn at reset."""
    level = load(name)
    if not level.has_random_maze:
        return [level]
    return [level.with_maze_seed(seed) for seed in MAZE_SEEDS]


def state(mdp: Mdp, cell: tuple[int, int]) -> int:
    return cell[1] * mdp.width + cell[0]


def starts_at(mdp: Mdp, cell: tuple[int, int]) -> list[int]:
    """Return the states at reset in a cell: one for each draw of its things."""
    return [int(start) for start in np.flatnonzero(mdp.start) if mdp.cell(int(start)) == cell]


def steps_from(mdp: Mdp, start: int) -> dict[int, int]:
    """Return all states that can be reached without being hit, and in how many steps at least."""
    steps, queue = {start: 0}, deque([start])
    while queue:
        here = queue.popleft()
        if mdp.is_terminal[here]:
            continue
        for action in range(mdp.num_actions):
            for _, there, _, ends in mdp.outcomes(here, action):
                if there not in steps and ends == mdp.is_terminal[there]:
                    steps[there] = steps[here] + 1
                    queue.append(there)
    return steps


def steps_to_exit(level: Level, start: tuple[int, int]) -> int | None:
    """Return the fewest steps to an exit, those of the worst draw, None where there is no way."""
    mdp, most = level.compile(), 0
    good = exit_states(level, mdp)
    for first in starts_at(mdp, start):
        steps = steps_from(mdp, first)
        found = [count for there, count in steps.items() if good[there]]
        if not found:
            return None
        most = max(most, min(found))
    return most


def optimal_values(mdp: Mdp, discount: float) -> NDArray[np.float64]:
    values: NDArray[np.float64] = np.zeros(mdp.num_states)
    for _ in range(10_000):
        ahead = mdp.reward + discount * values[mdp.next_state] * ~mdp.terminal
        better: NDArray[np.float64] = (mdp.probability * ahead).sum(axis=2).max(axis=1)
        if np.abs(better - values).max() < 1e-12:
            return better
        values = better
    raise AssertionError("the values do not settle")


# -- every level ---------------------------------------------------------------------------


def test_there_are_enough_levels_and_all_names_differ() -> None:
    assert len(PATHS) == len(FILES) >= 20


@each_level
def test_it_says_what_it_is(name: str) -> None:
    level = load(name)
    for text in (level.title, level.description, level.source):
        assert text
        assert text == text.strip()
    assert level.title is not None
    assert "\n" not in level.title
    assert level.description is not None
    assert len(level.description) > 60
    assert level.description.endswith(".")
    assert level.tags
    assert len(set(level.tags)) == len(level.tags)


def test_no_two_levels_have_the_same_title() -> None:
    titles = [load(name).title for name in FILES]
    assert len(set(titles)) == len(titles)


@each_level
def test_its_name_is_that_of_the_file(name: str) -> None:
    assert re.fullmatch(r"[a-z0-9]+(-[a-z0-9]+)*", name)
    assert load(name).name in (None, name)


@each_level
def test_editors_find_its_schema(name: str) -> None:
    first_line = FILES[name].read_text(encoding="utf-8").splitlines()[0]
    comment = re.fullmatch(r"# yaml-language-server: \$schema=(\S+)", first_line)
    assert comment is not None
    schema = (FILES[name].parent / comment[1]).resolve()
    assert schema == (ROOT / "schemas" / "level.schema.json").resolve()


@pytest.mark.slow
@each_level
def test_it_can_be_won_from_every_start(name: str) -> None:
    for level in games(name):
        mdp = level.compile()
        blocked = np.frombuffer(level.grid().blocked_cells, np.uint8)
        ends = [cell for cell in np.flatnonzero(mdp.is_terminal) if not blocked[cell % mdp.cells]]
        if level.robots:
            assert brl.evaluate(level, "best").exit_probability == 1
            continue
        for start in level.starts:
            if level.has_goal:
                assert steps_to_exit(level, start) is not None
            elif ends:
                assert set(ends) & set(steps_from(mdp, state(mdp, start)))
            else:
                assert "continuing" in level.tags
                assert level.discount < 1


def test_every_field_of_the_language_is_shown_somewhere() -> None:
    # A level's name is that of its file, so no file of the gallery needs the field.
    levels = [load(name) for name in FILES]
    shown = {field for level in levels for field in level.model_fields_set}
    # Boxes and targets are drawn.
    shown |= {field for level in levels for field in ("boxes", "targets") if getattr(level, field)}
    # How robots meet is mostly left as it is.
    assert {*LevelFields.model_fields} - {"name", "team"} <= shown


# -- levels with things ----------------------------------------------------------------------


# The fewest moves and the fewest turning actions to the goal.
MINIGRID = {
    "door-key": (10, 14),
    "key-corridor": (16, 24),
    "locked-room": (45, 55),
    "red-blue-doors": (13, 19),
}


@pytest.mark.parametrize("name", MINIGRID)
def test_the_optimum_of_a_layout_of_minigrid(name: str) -> None:
    level = load(name)
    mdp, (moves, turns) = level.compile(), MINIGRID[name]
    assert {"minigrid", "things"} <= {*level.tags}
    for tables, steps in ((mdp, moves), (mdp.turning(level.heading), turns)):
        optimum = tables.start @ optimal_values(tables, level.discount)
        # A reward of 1 for the last step alone.
        assert optimum == pytest.approx(level.discount ** (steps - 1), abs=1e-9)


# The free cells, the fewest moves and the fewest turning actions, as published.
TEST_MAZES = {
    "sixteen-rooms": (123, 20, 26),
    "sixteen-rooms-fewer-doors": (116, 22, 28),
    "labyrinth": (97, 96, 113),
    "labyrinth-flipped": (97, 96, 113),
    "labyrinth-2": (97, 96, 113),
    "standard-maze": (96, 40, 54),
    "standard-maze-2": (97, 56, 73),
    "standard-maze-3": (98, 39, 54),
}


@pytest.mark.parametrize("name", TEST_MAZES)
def test_a_test_maze_is_as_long_as_published(name: str) -> None:
    level = load(name)
    free, moves, turns = TEST_MAZES[name]
    mdp, turning = level.compile(), level.compile().turning(level.heading)
    assert int((~level.grid().blocked).sum()) == free
    assert mdp.start @ optimal_values(mdp, 1) == -moves
    assert turning.start @ optimal_values(turning, 1) == -turns


@pytest.mark.parametrize(
    ("name", "exits", "fewest", "most"),
    [("small-corridor", 10, 16, 24), ("large-corridor", 16, 22, 36)],
)
def test_a_corridor_maze_draws_its_exit(name: str, exits: int, fewest: int, most: int) -> None:
    level = load(name)
    turning = level.compile().turning(level.heading)
    values = optimal_values(turning, 1)[turning.start > 0]
    assert len(values) == len(level.exits) == exits
    assert (-values.max(), -values.min()) == (fewest, most)


# -- the worlds of the articles --------------------------------------------------------------


def test_all_worlds_of_the_articles_are_there() -> None:
    assert set(FILES) >= ARTICLE_WORLDS
    for name in ARTICLE_WORLDS:
        level = load(name)
        assert "baby-robot" in level.tags
        assert level.source is not None
        assert "Steve Roberts" in level.source
        assert "babyrobot" in level.source


# -- the other worlds ------------------------------------------------------------------------


@pytest.mark.parametrize(("bounce", "way"), [(-3, Action.SOUTH), (-1, Action.EAST)])
def test_the_glass_doors_pay_if_bounces_are_cheap(bounce: float, way: Action) -> None:
    level = load("glasshouse").replace(rewards={"bounce": bounce})
    assert load("glasshouse").rewards.bounce == -3
    mdp = level.compile()
    values = optimal_values(mdp, 1)
    ahead = mdp.reward[0] + values[mdp.next_state[0]] * ~mdp.terminal[0]
    assert (mdp.probability[0] * ahead).sum(axis=1).argmax() == way


# -- time limits -----------------------------------------------------------------------------

OTHER_LIMITS = {"frozen-lake": 100, "frozen-lake-8x8": 200}
"""Gymnasium's limits, which are shorter than the optimal policy needs in some episodes."""

FROM_THEIR_SOURCES = {"test-mazes", "minigrid"}
"""The folders of levels whose limits are those of their sources."""


@pytest.mark.slow
@each_level
def test_the_time_limit_leaves_the_optimum_as_it_is(name: str) -> None:
    level = load(name)
    assert level.max_steps is not None
    if level.has_random_maze or level.exit == "none" or name in OTHER_LIMITS:
        assert level.max_steps == OTHER_LIMITS.get(name, level.max_steps)
        return
    solution = solve(level, discount=1.0)
    within = best_return_within(level, level.max_steps)
    assert within == pytest.approx(solution.expected_return, abs=1e-6)
    if level.boxes or level.robots:
        # Pushes, and robots that are gone, may lose the level: some states never lead to an end.
        assert level.max_steps >= 10 * solution.expected_steps
    elif FILES[name].parent.name not in FROM_THEIR_SOURCES:
        space = space_of(level, "all")
        model = space.model()
        chain = model.under(solution.policy.ravel()[model.states])
        steps = expected_sums(chain, np.ones(chain.size), 1.0)
        assert level.max_steps >= 10 * steps[space.mdp.start[model.states] > 0].max()
