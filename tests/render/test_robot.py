"""The robot's poses: one rule for all painters, and each of them to be told from the others."""

from __future__ import annotations

from itertools import combinations
from typing import Any

import numpy as np
import pytest
from support.each import for_each
from support.scenes import bounds

from babyrobot_levels.language.looks import BUILTIN_THEMES, Theme
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.actions import MOVES, Action
from babyrobot_levels.render.raster import to_rgb
from babyrobot_levels.render.scene.build import build_scene
from babyrobot_levels.render.scene.layout import CELL
from babyrobot_levels.render.scene.robot import robot_shapes
from babyrobot_levels.render.scene.shapes import Rect, Scene
from babyrobot_levels.render.situation import Mood, Pose, pose_of

FACINGS = (Action.STAY, *MOVES)
POSES = [Pose(facing, mood) for mood in Mood for facing in FACINGS]
WIDTH = 5
HERE = 12
N, E, S, W, STAY = Action.NORTH, Action.EAST, Action.SOUTH, Action.WEST, Action.STAY

Pixels = np.ndarray[Any, np.dtype[np.int64]]


def painted(pose: Pose, side: int, theme: Theme | None = None) -> Pixels:
    theme = theme or Theme()
    ground = Rect(0, 0, CELL, CELL, theme.colors.base)
    scene = Scene(CELL, CELL, (ground, *robot_shapes(theme, 0, 0, pose)))
    return to_rgb(scene, (side, side)).astype(np.int64)


# -- the rule ------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("state", "facing"), [(HERE - WIDTH, N), (HERE + 1, E), (HERE + WIDTH, S), (HERE - 1, W)]
)
@for_each("action", FACINGS)
def test_he_looks_where_he_went_whatever_he_was_told(
    state: int, facing: Action, action: Action
) -> None:
    assert pose_of(HERE, state, action, WIDTH) == Pose(facing)


@pytest.mark.parametrize("state", [HERE, 0, HERE + 2, HERE + WIDTH + 1], ids=str)
@for_each("action", FACINGS)
def test_where_he_stayed_or_came_from_far_he_looks_where_he_wanted_to_go(
    state: int, action: int
) -> None:
    assert pose_of(HERE, state, action, WIDTH) == Pose(Action(action))


def test_the_end_of_a_row_is_no_neighbour_of_the_next_row() -> None:
    assert pose_of(4, 5, N, WIDTH) == Pose(N)


def test_he_slips_when_he_skids_and_cheers_at_a_good_end() -> None:
    assert pose_of(HERE, HERE + 1, N, WIDTH, skidded=True) == Pose(E, Mood.SLIP)
    assert pose_of(HERE, HERE + 1, E, WIDTH, ends_well=True) == Pose(STAY, Mood.CHEER)
    # Whoever slides into the exit has reached it.
    assert pose_of(HERE, HERE + 1, N, WIDTH, skidded=True, ends_well=True).mood is Mood.CHEER


def test_states_of_numpy_are_states() -> None:
    pose = pose_of(np.int64(HERE), np.int64(HERE), np.int64(3), WIDTH)  # type: ignore[arg-type]
    assert pose == Pose(S)
    assert isinstance(pose.facing, Action)


# -- the drawing ---------------------------------------------------------------------------


@for_each("phase", [0.0, 0.1, 0.25, 0.5, 0.75, 0.9])
@for_each("pose", POSES)
def test_he_never_leaves_his_cell(pose: Pose, phase: float) -> None:
    for shape in robot_shapes(Theme(), 0, 0, Pose(pose.facing, pose.mood, phase)):
        assert min(bounds(shape)) >= 1, shape
        assert max(bounds(shape)) <= CELL - 1, shape


@pytest.mark.parametrize(("side", "pixels"), [(64, 80), (16, 8)])
def test_poses_can_be_told_apart(side: int, pixels: int) -> None:
    # Who cheers or slips may look much the same to the south and to the viewer.
    pictures = {
        pose: painted(pose, side)
        for pose in POSES
        if pose.facing is not S or (pose.mood is Mood.CALM and side == 64)
    }
    for (_, first), (_, second) in combinations(pictures.items(), 2):
        changed = (np.abs(first - second).max(axis=2) > 40).sum()
        assert changed >= pixels


@for_each("name", BUILTIN_THEMES)
@pytest.mark.parametrize("facing", FACINGS)
def test_he_stands_out_from_every_ground_even_when_small(name: str, facing: Action) -> None:
    world = Level.from_fields(
        {
            "version": 1,
            "size": [3, 1],
            "puddles": [{"at": [1, 0], "size": "large"}],
            "theme": name,
            "display": {"start_text": False, "exit_text": False},
        }
    )
    without = to_rgb(build_scene(world, cells_only=True, robot=False), (48, 16)).astype(np.int64)
    for state in range(3):
        scene = build_scene(world, state=state, pose=Pose(facing), cells_only=True)
        cell = (slice(0, 16), slice(16 * state, 16 * state + 16))
        change = np.abs(to_rgb(scene, (48, 16)) - without)[cell].max(axis=2)
        assert (change > 40).sum() >= 40, "of 256 pixels"
