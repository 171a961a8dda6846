"""Frames: the robot on a ground that is painted once."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
from support.scenes import without_legend
from support.worlds import level

from babyrobot_levels.mdp.actions import Action
from babyrobot_levels.render import frames
from babyrobot_levels.render.frames import FramePainter, default_image_size
from babyrobot_levels.render.raster import to_rgb
from babyrobot_levels.render.scene.layout import Note, Overlay
from babyrobot_levels.render.situation import Mood, Pose

WORLD = level(
    size=[5, 4],
    maze={"seed": 2},
    puddles=[{"at": [2, 1], "size": "large"}, {"at": [1, 3]}],
    warps=[{"at": [3, 0], "to": [0, 2]}],
    theme="blue_green",
)


POSES = [
    Pose(),
    Pose(Action.EAST, phase=0.25),
    Pose(Action.NORTH, Mood.SLIP),
    Pose(mood=Mood.CHEER),
]
OVERLAY = Overlay(
    values=[[1.5] * 5] * 4,
    actions=[[(Action.EAST,)] * 5] * 4,
    visits=[[3] * 5] * 4,
    notes=[Note(1.5, 2, "a note on two cells")],
    side_panel=["beside"],
    bottom_panel=["below"],
)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("size", "overlay"), [(None, OVERLAY), ((160, 128), None), ((160, 128), OVERLAY)]
)
@pytest.mark.parametrize("pose", POSES[1:3], ids=str)
def test_poses_and_overlays_are_what_painting_everything_gives(
    pose: Pose, size: tuple[int, int] | None, overlay: Overlay | None
) -> None:
    painter = FramePainter(WORLD, size, overlay=overlay)
    cells_only = size is not None
    for state in (0, 7, 11, 19):
        scene = without_legend(
            WORLD, state=state, pose=pose, cells_only=cells_only, overlay=overlay
        )
        expected = to_rgb(scene, (painter.width, painter.height)).astype(int)
        difference = np.abs(painter.frame(state, pose) - expected)
        # Edges below and edges above are smoothed apart from each other.
        assert difference.mean() < 0.15
        assert (difference > 24).mean() < 0.001


def test_what_is_remembered_is_bounded(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(frames, "_POSES", 3)
    monkeypatch.setattr(frames, "_PATCH_BYTES", 20 * 3 * 16 * 16)
    painter = FramePainter(WORLD, (80, 64))
    fresh = FramePainter(WORLD, (80, 64))
    told = [(state, Pose(phase=step / 8)) for step in range(8) for state in range(20)]
    for state, pose in told:
        painter.frame(state, pose)
    assert len(painter._patches) == 20
    assert len(painter._robots) == 3
    for state, pose in told[::7]:
        assert np.array_equal(painter.frame(state, pose), fresh.frame(state, pose))


def test_a_painter_can_be_copied_with_what_it_remembers() -> None:
    painter = FramePainter(WORLD, (80, 64))
    kept = painter.frame(3)
    assert np.array_equal(pickle.loads(pickle.dumps(painter)).frame(3), kept)


def test_equal_states_give_equal_frames_that_are_the_caller_s_own() -> None:
    painter = FramePainter(WORLD)
    before = painter.frame(3)
    kept = before.copy()
    before[:] = 0
    assert np.array_equal(painter.frame(3), kept)
    assert np.array_equal(FramePainter(WORLD).frame(3), kept)


def test_grayscale_is_one_channel_of_brightness() -> None:
    gray = FramePainter(WORLD, (80, 64), grayscale=True).frame(4)
    color = FramePainter(WORLD, (80, 64)).frame(4)
    assert gray.shape == (64, 80, 1)
    assert gray.dtype == color.dtype == np.uint8
    assert np.abs(gray[..., 0] - color @ np.array([0.299, 0.587, 0.114])).max() < 4


def test_a_frame_without_a_size_is_the_whole_picture_at_64_pixels_a_cell() -> None:
    painter = FramePainter(level(size=[8, 5], display={"side_panel": 100}))
    assert (painter.width, painter.height) == (8 * 64 + 6 + 100, 5 * 64 + 6)
    assert painter.frame(0).shape == (painter.height, painter.width, 3)


@pytest.mark.parametrize("size", [[40, 3], [3, 100], [1024, 2]])
def test_frames_of_large_levels_are_bounded(size: list[int]) -> None:
    world = level(size=size)
    painter = FramePainter(world)
    assert max(painter.width, painter.height) <= 2048
    assert painter.width >= size[0]
    assert painter.height >= size[1]
    last = size[0] * size[1] - 1
    assert (painter.frame(last) != painter.frame(last - 1)).any()


@pytest.mark.parametrize(
    ("cells", "expected"),
    [
        ((8, 5), (80, 128)),
        ((3, 3), (48, 48)),
        ((1, 1), (36, 36)),
        ((2, 5), (90, 36)),
        ((100, 100), (1000, 1000)),
        ((64, 1), (36, 1024)),
        ((1024, 1024), (1024, 1024)),
        ((1, 1024), (1024, 36)),
    ],
)
def test_image_observations_have_square_cells_and_sides_that_networks_take(
    cells: tuple[int, int], expected: tuple[int, int]
) -> None:
    assert default_image_size(*cells) == expected
