"""The gallery: every level loads, says what it is, can be won, and is the world that it claims."""

from __future__ import annotations

import re
from collections import deque
from functools import cache
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from pydantic import BaseModel
from support.each import for_each
from support.places import GALLERY_FOLDER, ROOT

from babyrobot_levels.analysis.solver.horizon import best_return_within
from babyrobot_levels.analysis.solver.linear import expected_sums
from babyrobot_levels.analysis.solver.optimum import solve
from babyrobot_levels.analysis.solver.policies import space_of
from babyrobot_levels.language.fields import LevelFields
from babyrobot_levels.language.looks import BUILTIN_THEMES
from babyrobot_levels.language.validation import parse
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.actions import Action
from babyrobot_levels.mdp.tables import Mdp
from babyrobot_levels.text.diagnostics import Diagnostic
from babyrobot_levels.text.files import read_source
from babyrobot_levels.text.reader import read

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
def read_level(name: str) -> tuple[Level | None, list[Diagnostic]]:
    return parse(read_source(FILES[name], f"{name}.yaml"), Level)


def load(name: str) -> Level:
    level, diagnostics = read_level(name)
    assert level is not None, "\n\n".join(map(str, diagnostics))
    return level


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
        for action in Action:
            for _, there, _, ends in mdp.outcomes(here, action):
                if there not in steps and ends == mdp.is_terminal[there]:
                    steps[there] = steps[here] + 1
                    queue.append(there)
    return steps


def steps_to_exit(level: Level, start: tuple[int, int]) -> int | None:
    """Return the fewest steps to an exit, those of the worst draw, None where there is no way."""
    mdp, most = level.compile(), 0
    for first in starts_at(mdp, start):
        steps = steps_from(mdp, first)
        found = [
            count
            for there, count in steps.items()
            if mdp.is_terminal[there] and mdp.cell(there) in level.exits
        ]
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
def test_it_loads_without_a_finding(name: str) -> None:
    level, diagnostics = read_level(name)
    assert not diagnostics, "\n\n".join(map(str, diagnostics))
    assert level is not None


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


@each_level
def test_its_fields_stand_in_canonical_order(name: str) -> None:
    data = read(read_source(FILES[name])).data
    assert list(data) == [field for field in LevelFields.model_fields if field in data]
    assert next(iter(data)) == "version"


@each_level
def test_its_text_is_tidy(name: str) -> None:
    text = FILES[name].read_text(encoding="utf-8")
    assert text.endswith("\n")
    assert not text.endswith("\n\n")
    for line in text.splitlines():
        assert line == line.rstrip()
        assert "\t" not in line
        assert len(line) <= 100


@each_level
def test_it_can_be_won_from_every_start(name: str) -> None:
    for level in games(name):
        mdp = level.compile()
        blocked = np.frombuffer(level.grid().blocked_cells, np.uint8)
        ends = [cell for cell in np.flatnonzero(mdp.is_terminal) if not blocked[cell % mdp.cells]]
        for start in level.starts:
            if level.exits:
                assert steps_to_exit(level, start) is not None
            elif ends:
                assert set(ends) & set(steps_from(mdp, state(mdp, start)))
            else:
                assert "continuing" in level.tags
                assert level.discount < 1


@each_level
def test_its_time_limit_leaves_time_to_win(name: str) -> None:
    for level in games(name):
        if level.max_steps is not None and level.exits:
            needed = [steps_to_exit(level, start) for start in level.starts]
            assert all(steps is not None and steps <= level.max_steps for steps in needed)


@each_level
def test_its_probabilities_sum_to_one(name: str) -> None:
    for level in games(name):
        mdp = level.compile()
        np.testing.assert_allclose(mdp.probability.sum(axis=2), 1, rtol=0, atol=1e-12)
        assert (mdp.probability >= 0).all()
        assert abs(mdp.start.sum() - 1) < 1e-12


@each_level
def test_its_drawing_reads_back(name: str) -> None:
    for level in games(name):
        drawn = level.draw()
        legend = {key: entry for key, entry in level.legend.items() if f" {key} " in drawn}
        fields: dict[str, Any] = {"version": 1, "map": drawn}
        fields |= {"legend": legend} if legend else {}
        if level.doors:
            needed: dict[str, list[Any]] = {
                "items": [*level.items],
                "switches": [*level.switches],
            }
            shown = {entry.item or entry.switch for entry in legend.values()}
            for field, things in needed.items():
                fields[field] = [thing for thing in things if thing.name not in shown]
            fields["doors"] = level.doors
        assert Level.model_validate(fields).draw() == drawn


# -- the language --------------------------------------------------------------------------


def fields_of(model: type[BaseModel]) -> set[tuple[str, str]]:
    """Return all fields of a model and of the models in it: (class that declares it, name)."""
    found: set[tuple[str, str]] = set()
    for name, info in model.model_fields.items():
        found.add((_owner(model, name), name))
        for inner in _models_in(info.annotation):
            found |= fields_of(inner)
    return found


def used_fields(value: Any) -> set[tuple[str, str]]:
    if isinstance(value, BaseModel):
        found = {(_owner(type(value), name), name) for name in value.model_fields_set}
        return found.union(*(used_fields(getattr(value, name)) for _, name in found))
    if isinstance(value, dict):
        return set().union(*map(used_fields, value.values()))
    if isinstance(value, list | tuple):
        return set().union(*map(used_fields, value))
    return set()


def _owner(model: type[BaseModel], field: str) -> str:
    return next(base.__name__ for base in reversed(model.__mro__) if field in _own_names(base))


def _own_names(base: type) -> dict[str, Any]:
    return getattr(base, "__annotations__", {}) if issubclass(base, BaseModel) else {}


def _models_in(annotation: Any) -> list[type[BaseModel]]:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    return [model for part in getattr(annotation, "__args__", ()) for model in _models_in(part)]


def test_every_field_of_the_language_is_shown_somewhere() -> None:
    # A level's name is that of its file, so no file of the gallery needs the field.
    wanted = fields_of(LevelFields) - {("LevelFields", "name")}
    shown = set().union(*(used_fields(load(name)) for name in FILES))
    assert wanted - shown == set()


def test_every_choice_of_the_language_is_shown_somewhere() -> None:
    text = "\n".join(path.read_text(encoding="utf-8") for path in FILES.values())
    choices = ["to: sides", "to: others", "skid: 0.1", "when: leave", "to: start"]
    choices += ["seed: random", "exit: none", "size: small", "size: large", "|### ", " : "]
    assert [choice for choice in choices if choice not in text] == []
    themes = {load(name).theme for name in FILES if isinstance(load(name).theme, str)}
    assert themes == {"default", *BUILTIN_THEMES}


# -- levels with things ----------------------------------------------------------------------

OPTIMA = {
    "bat-cave": -7.58,
    "coin-run": 10.0,
    "drawbridge": -17.0,
    "first-key": -7.0,
    "ice-vault": -3.976083591265,
    "night-watch": -9.0,
    "postman": -15.0,
    "shell-game": -14 / 3,
    "three-gems": -15.5,
    "two-levers": -9.0,
}
"""The expected return of the best policy."""


@pytest.mark.parametrize("name", OPTIMA)
def test_the_optimum_of_a_level_with_things(name: str) -> None:
    level = load(name)
    mdp = level.compile()
    assert "things" in level.tags
    assert mdp.start @ optimal_values(mdp, 1) == pytest.approx(OPTIMA[name], abs=1e-9)


def test_every_level_with_things_has_its_optimum_here() -> None:
    things = {name for name in FILES if FILES[name].parent.name == "things"}
    assert set(OPTIMA) == things
    assert len(things) >= 10


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

MAZE = """\
+---+---+---+---+---+---+---+---+
| S         |               |   |
+---+---+   +---+---+   +   +   +
|           |           |   |   |
+   +---+---+   +---+---+   +   +
|           |   |           |   |
+---+---+   +   +---+   +---+   +
|           |       |           |
+   +---+---+---+   +---+---+   +
|                   | E         |
+---+---+---+---+---+---+---+---+
"""

FINAL_MAZE = """\
+---+---+---+---+---+---+---+---+
| S       o                 |   |
+---+---+   +---+---+   +   +   +
|           |         O |   |   |
+   +---+---+   +---+---+   +   +
|         o   O         |   |   |
+---+---+   +   +---+   +---+   +
|           |       |         o |
+   +---+---+---+   +---+---+   +
|                   | E         |
+---+---+---+---+---+---+---+---+
"""


def test_all_worlds_of_the_articles_are_there() -> None:
    assert set(FILES) >= ARTICLE_WORLDS
    for name in ARTICLE_WORLDS:
        level = load(name)
        assert "baby-robot" in level.tags
        assert level.source is not None
        assert "Steve Roberts" in level.source
        assert "babyrobot" in level.source


def test_default_says_nothing_but_what_it_is() -> None:
    level = load("default")
    assert level.model_fields_set == {
        *("version", "title", "description", "source", "tags", "max_steps"),
    }
    assert (level.size, level.start, level.exit) == ((3, 3), (0, 0), (2, 2))
    assert level.draw() == Level(version=1).draw()
    assert optimal_values(level.compile(), 1)[0] == -3


def test_side_panel_is_the_default_game_with_a_panel() -> None:
    level = load("side-panel")
    assert level.digest == load("default").digest
    assert level.display.side_panel != "none"


def test_puddle_test() -> None:
    level = load("puddle-test")
    assert (level.size, level.start, level.exit) == ((3, 3), (0, 1), (2, 1))
    assert {(wall.at, wall.side) for wall in level.walls} == {((0, 1), "N"), ((0, 1), "S")}
    assert [(puddle.at, puddle.size) for puddle in level.puddles] == [((1, 1), "large")]
    mdp = level.compile()
    outcomes = mdp.outcomes(state(mdp, (1, 1)), Action.EAST)
    assert [(there, round(chance, 10)) for chance, there, _, _ in outcomes] == [
        (state(mdp, (1, 0)), 0.2),
        (state(mdp, (0, 1)), 0.2),
        (state(mdp, (2, 1)), 0.4),
        (state(mdp, (1, 2)), 0.2),
    ]


def test_maze() -> None:
    level = load("maze")
    assert (level.size, level.start, level.exit) == ((8, 5), (0, 0), (5, 4))
    assert level.maze is not None
    assert level.maze.seed == 42
    assert level.draw() == MAZE


def test_maze_changed() -> None:
    before, after = load("maze").grid().open, load("maze-changed").grid().open
    east = 1
    removed = {(int(x), int(y)) for y, x in np.argwhere(after[..., east] & ~before[..., east])}
    added = {(int(x), int(y)) for y, x in np.argwhere(before[..., east] & ~after[..., east])}
    assert removed == {(2, 0), (2, 2), (3, 2)}
    assert added == {(5, 2)}
    assert (before[..., 2] == after[..., 2]).all()
    assert not load("maze-changed").puddles


def test_final_maze() -> None:
    level = load("final-maze")
    assert (level.grid().open == load("maze-changed").grid().open).all()
    assert {(puddle.at, puddle.size) for puddle in level.puddles} == {
        ((2, 2), "small"),
        ((2, 0), "small"),
        ((7, 3), "small"),
        ((3, 2), "large"),
        ((5, 1), "large"),
    }
    assert level.theme == "black_orange"
    assert level.draw() == FINAL_MAZE


def test_last_area_wins() -> None:
    level = load("areas")
    mdp = level.compile()
    rewards = {mdp.outcomes(state(mdp, (x, y)), Action.STAY)[0][2] for x in range(3) for y in (1,)}
    assert rewards == {-1, -7, -6}
    assert mdp.outcomes(state(mdp, (2, 2)), Action.STAY)[0][2] == -8
    assert mdp.outcomes(state(mdp, (2, 3)), Action.EAST)[0][2] == 0


def test_glass_wall_bounces_into_the_puddle() -> None:
    level = load("glass-wall")
    assert level.draw() == (
        "+---+---+---+\n|###  O  ###|\n+   +   +   +\n| S         |\n+   +- -+   +\n"
        "|###        |\n+   +   +   +\n|###  E  ###|\n+---+---+---+\n"
    )
    mdp = level.compile()
    puddle, behind = state(mdp, (1, 0)), state(mdp, (1, 2))
    assert mdp.outcomes(state(mdp, (1, 1)), Action.SOUTH) == [
        (0.9, puddle, -5, False),
        (0.1, behind, -1, False),
    ]


def test_image_maze() -> None:
    level = load("image-maze")
    assert level.size == (4, 4)
    assert level.maze is not None
    rewards = level.rewards
    assert (rewards.closer, rewards.farther, rewards.bump, rewards.exit) == (1, -1, -10, 100)
    assert level.max_steps == 200
    assert level.description is not None
    assert 'observation="image"' in level.description
    # It is not one of the Baby Robot articles' worlds.
    assert level.source is not None
    assert "Thanakorn Panyapiang" in level.source
    assert "baby-robot" not in level.tags


# -- the other worlds ------------------------------------------------------------------------


def test_random_maze_differs_from_seed_to_seed() -> None:
    drawings = {level.draw() for level in games("random-maze")}
    assert len(drawings) == len(MAZE_SEEDS)


def test_braided_maze_has_no_dead_ends() -> None:
    assert (load("braided-maze").grid().open.sum(axis=2) >= 2).all()


def test_teleport_pads_are_the_only_way_across() -> None:
    level = load("teleport-pads")
    assert level.warps
    assert steps_to_exit(level, (0, 2)) == 8
    assert steps_to_exit(Level.model_validate(level.to_dict() | {"warps": []}), (0, 2)) is None
    mdp = level.compile()
    # A pad that leads onto a pad is followed to the end, with the first reward on the way.
    assert mdp.outcomes(state(mdp, (4, 4)), Action.EAST) == [(1, state(mdp, (0, 2)), -3, False)]


def test_four_corners_are_equally_far_from_the_middle() -> None:
    level = load("four-corners")
    assert len(level.starts) == 4
    assert {steps_to_exit(level, start) for start in level.starts} == {4}


def test_the_farther_of_the_two_doors_is_better() -> None:
    level = load("two-doors")
    mdp = level.compile()
    best = optimal_values(mdp, 1)
    assert best[state(mdp, (2, 1))] == -3
    assert mdp.outcomes(state(mdp, (2, 1)), Action.WEST)[0][2] == -4


@pytest.mark.parametrize(("bounce", "way"), [(-3, Action.SOUTH), (-1, Action.EAST)])
def test_the_glass_doors_pay_if_bounces_are_cheap(bounce: float, way: Action) -> None:
    level = load("glasshouse").replace(rewards={"bounce": bounce})
    assert load("glasshouse").rewards.bounce == -3
    mdp = level.compile()
    values = optimal_values(mdp, 1)
    ahead = mdp.reward[0] + values[mdp.next_state[0]] * ~mdp.terminal[0]
    assert (mdp.probability[0] * ahead).sum(axis=1).argmax() == way


def test_each_chest_has_a_reward_of_its_own() -> None:
    level = load("treasure-chests")
    mdp = level.compile()
    into = mdp.terminal & ~mdp.is_terminal[:, None, None]
    assert set(mdp.reward[into].tolist()) == {3.0, 20.0, -10.0}


# -- time limits -----------------------------------------------------------------------------

OTHER_LIMITS = {"frozen-lake": 100, "frozen-lake-8x8": 200}
"""Gymnasium's limits, which are shorter than the optimal policy needs in some episodes."""

FROM_THEIR_SOURCES = {"test-mazes", "minigrid"}
"""The folders of levels whose limits are those of their sources."""


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
    if FILES[name].parent.name not in FROM_THEIR_SOURCES:
        space = space_of(level, "all")
        model = space.model()
        chain = model.under(solution.policy.ravel()[model.states])
        steps = expected_sums(chain, np.ones(chain.size), 1.0)
        assert level.max_steps >= 10 * steps[space.mdp.start[model.states] > 0].max()


def test_test_mazes_have_the_limit_of_their_source() -> None:
    for name, path in FILES.items():
        if path.parent.name == "test-mazes":
            assert load(name).max_steps == 250
