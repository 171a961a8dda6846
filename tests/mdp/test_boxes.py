"""Levels with boxes: their search against the one of other things, bounds, and what is lost."""

from __future__ import annotations

from random import Random
from typing import Any

import numpy as np
import pytest
from oracles.random_things import random_level
from support.each import for_each

import babyrobot_levels as brl
from babyrobot_levels.mdp.compiler.boxes import Boxes
from babyrobot_levels.mdp.configurations import Things
from babyrobot_levels.mdp.pushing import lost_cells


def level(**fields: Any) -> brl.Level:
    return brl.Level.from_fields({"version": 1, **fields})


@pytest.mark.slow
@for_each("seed", range(40))
def test_without_boxes_the_search_finds_what_that_of_other_things_finds(seed: int) -> None:
    fields = random_level(Random(seed))
    fields.pop("boxes", None)
    if not fields.get("exit_needs") and "targets" not in fields:
        world = brl.Level.from_fields(fields)
        if world.has_things:
            mdp, other = (world.compile(), Boxes(world, world.grid(), Things(world)).tables())
            for name, table in vars(mdp).items():
                assert np.array_equal(table, vars(other)[name]), (name, fields)


def test_boxes_are_alike() -> None:
    mdp = level(size=[3, 3], exit="none", boxes=[{"at": [1, 1]}, {"at": [1, 0]}]).compile()
    rows = mdp.configurations.tolist()
    assert all(one < two for one, two in rows)
    assert len(rows) == len({*map(tuple, rows)}) <= 9 * 8 / 2


def test_no_box_is_ever_where_a_box_cannot_be() -> None:
    world = level(
        size=[5, 4],
        start=[2, 0],
        exit="none",
        blocked=[{"at": [4, 0]}],
        warps=[{"at": [0, 3], "to": [4, 3]}],
        boxes=[{"at": [2, 1]}, {"at": [3, 2]}],
    )
    stood = {*world.compile().configurations.ravel().tolist()}
    assert not stood & {4, 19}
    assert 15 in stood


def test_three_pushes_solve_a_level_in_the_fewest_steps() -> None:
    world = level(size=[5, 1], boxes=[{"at": [1, 0]}], targets=[{"at": [4, 0]}])
    solution = brl.solve(world)
    assert (solution.expected_steps, solution.expected_return) == (3, -2)
    assert solution.exit_probability == 1


def test_environments_end_when_all_is_covered() -> None:
    env = level(size=[4, 1], boxes=[{"at": [1, 0]}], targets=[{"at": [3, 0]}]).make()
    env.reset(seed=0)
    steps = [env.step(brl.Action.EAST)[1:4] for _ in range(2)]
    assert steps == [(-1.0, False, False), (0.0, True, False)]


ROW = {(x, 1) for x in range(1, 4)}


@pytest.mark.parametrize(
    ("target", "saved"),
    [
        ([2, 1], ROW),
        ([4, 1], ROW | {(4, 1)}),
        ([4, 0], {(x, y) for x in range(1, 5) for y in range(2)}),
    ],
)
def test_boxes_are_lost_at_walls_without_a_target(
    target: list[int], saved: set[tuple[int, int]]
) -> None:
    world = level(size=[5, 3], targets=[{"at": target}])
    cells = {(x, y) for x in range(5) for y in range(3)}
    assert {(cell % 5, cell // 5) for cell in lost_cells(world)} == cells - saved


def test_without_targets_no_box_is_lost() -> None:
    assert lost_cells(level(size=[5, 3], boxes=[{"at": [1, 1]}])) == frozenset()


@for_each("seed", range(60))
def test_a_box_in_a_lost_cell_never_comes_to_a_target(seed: int) -> None:
    fields = random_level(Random(seed))
    if "boxes" not in fields or "targets" not in fields:
        return
    world = brl.Level.from_fields({**fields, "boxes": fields["boxes"][:1]})
    if world.ends_covered and world.boxes[0].at in {each.at for each in world.targets}:
        return
    lost, mdp = lost_cells(world), world.compile()
    column = world.things().of_kind("box").start
    before = mdp.configurations[np.arange(mdp.num_states) // mdp.cells, column]
    after = mdp.configurations[mdp.next_state // mdp.cells, column]
    is_lost = np.isin(before, [*lost])[:, None, None] & (mdp.probability > 0)
    assert np.isin(after[is_lost], [*lost]).all()


def test_a_level_with_too_many_states_says_what_costs_most() -> None:
    boxes = [{"at": [x, y]} for x in range(2, 20, 3) for y in (2, 5)]
    with pytest.raises(brl.LevelError, match=r"more than 5,000,000 states.*12 boxes"):
        level(size=[20, 8], exit="none", boxes=boxes).compile()


def test_a_level_with_boxes_is_not_too_large() -> None:
    with pytest.raises(brl.LevelError, match="with boxes the limit is 16,384"):
        level(size=[129, 128], boxes=[{"at": [1, 1]}])


def test_configurations_of_many_boxes_are_told_apart() -> None:
    # Sixteen boxes that nobody reaches make keys of configurations longer than a word.
    fields = {"version": 1, "size": [16, 5], "exit": "none", "start": [0, 0]}
    fields |= {"blocked": [{"at": [0, 3], "size": [16, 1]}], "targets": [{"at": [6, 1]}]}
    far = [{"at": [x, 4]} for x in range(16)]
    one, many = (
        brl.load({**fields, "boxes": [{"at": [4, 1]}, *more]}).compile() for more in ([], far)
    )
    assert many.num_configurations == one.num_configurations > 30
    assert np.array_equal(many.next_state, one.next_state)
