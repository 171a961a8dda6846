"""Films: an episode as a GIF file."""

from __future__ import annotations

import io
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image, ImageSequence
from support.scenes import CORRIDOR
from support.worlds import level

from babyrobot_levels.library.catalogue import load
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.actions import Action
from babyrobot_levels.render.colors import rgba
from babyrobot_levels.render.gif import MAX_SIDE, Frame, Patch, Step, encoded, to_gif
from babyrobot_levels.render.raster import to_rgb
from babyrobot_levels.render.scene.build import build_scene
from babyrobot_levels.render.situation import STANDING, Pose, pose_of

PER_STEP = 5
"""Frames of a step: four on the way, and the arrival."""


ROW = level(size=[4, 1])
WALK = [Step(x, Action.EAST, x + 1, -1.0) for x in range(3)]


def shown(film: bytes) -> tuple[NDArray[np.uint8], list[int]]:
    """Return the frames, `[frames, height, width, 3]`, and the milliseconds that each is shown."""
    with Image.open(io.BytesIO(film)) as image:
        frames, times = [], []
        for frame in ImageSequence.Iterator(image):
            frames.append(np.array(frame.convert("RGB")))
            times.append(frame.info["duration"])
        return np.array(frames), times


def test_it_plays_for_ever_and_rests_at_the_end() -> None:
    film = to_gif(ROW, WALK)
    with Image.open(io.BytesIO(film)) as image:
        assert image.format == "GIF"
        assert image.info["loop"] == 0
    frames, times = shown(film)
    assert len(frames) == 1 + PER_STEP * len(WALK)
    assert times[-1] == 1500
    assert max(times[1:-1]) <= 120
    assert min(times) >= 20


def test_it_is_as_large_as_the_picture_and_what_it_shows_is_the_picture() -> None:
    frames, _ = shown(to_gif(ROW, WALK))
    scene = build_scene(ROW, state=0)
    assert frames[0].shape == (round(scene.height), round(scene.width), 3)
    poses = [STANDING, *(pose_of(s.state, s.next_state, s.action, 4) for s in WALK[:2])]
    poses.append(pose_of(2, 3, Action.EAST, 4, ends_well=True))
    for number, (state, pose) in enumerate(zip(range(4), poses, strict=True)):
        expected = to_rgb(build_scene(ROW, state=state, pose=pose)).astype(int)
        difference = np.abs(frames[PER_STEP * number] - expected)
        assert difference.mean() < 0.3
        assert (difference > 40).mean() < 0.002


def test_large_even_grounds_keep_their_exact_colours() -> None:
    frames, _ = shown(to_gif(ROW, WALK))
    colors = ROW.resolved_theme.colors
    for color in (colors.base, colors.start, colors.exit):
        assert (frames[0] == rgba(color)[:3]).all(axis=2).sum() > 500


def test_of_few_colours_all_frames_are_exact() -> None:
    ground = np.zeros((9, 12, 3), np.uint8)
    red = np.full((3, 4, 3), (255, 0, 0), np.uint8)
    patches = [Patch(1, 2, red), Patch(8, 6, red), Patch(0, 0, ground[:1, :1] + np.uint8(9))]
    frames, times = shown(encoded(ground, [Frame((patch,), 100) for patch in patches]))
    assert times == [100] * 3
    for frame, patch in zip(frames, patches, strict=True):
        expected = ground.copy()
        expected[patch.place] = patch.pixels
        assert np.array_equal(frame, expected)


def test_the_robot_glides() -> None:
    frames, _ = shown(to_gif(ROW, WALK))
    ground = to_rgb(build_scene(ROW, robot=False)).astype(int)
    different = np.abs(frames - ground).max(axis=3) > 60
    middles = [np.flatnonzero(frame.any(axis=0)).mean() for frame in different]
    steps = np.diff(middles[: PER_STEP + 1])
    assert (steps > 2).all()
    assert steps.max() < 32
    assert middles[PER_STEP] - middles[0] == pytest.approx(64, abs=6)


def test_he_bumps_into_a_wall_and_is_back_where_he_was() -> None:
    frames, _ = shown(to_gif(ROW, [Step(0, Action.NORTH, 0, -1.0)]))
    assert (frames[1] != frames[-1]).any()
    expected = to_rgb(build_scene(ROW, state=0, pose=pose_of(0, 0, Action.NORTH, 4))).astype(int)
    assert np.abs(frames[-1] - expected).mean() < 0.5


def test_a_panel_counts() -> None:
    world = level(size=[3, 1], display={"side_panel": 120})
    steps = [Step(0, Action.EAST, 1, -1.0), Step(1, Action.EAST, 2, 0.0)]
    frames, _ = shown(to_gif(world, steps))
    panels = frames[:, :, -110:]
    # As long as he is on his way, the step does not count.
    assert (panels[:PER_STEP] == panels[0]).all()
    assert (panels[PER_STEP] != panels[0]).any()
    assert (panels[-1] != panels[PER_STEP]).any()


def test_the_same_film_is_the_same_file() -> None:
    assert to_gif(ROW, WALK) == to_gif(level(size=[4, 1]), list(WALK))


@pytest.mark.slow
def test_a_film_of_the_final_maze_is_small() -> None:
    world = load("final-maze")
    path = [0, 1, 2, 10, 9, 8, 16, 17, 18, 19, 20, 21, 29, 30, 31, 39, 38, 37]
    moves = {1: Action.EAST, -1: Action.WEST, 8: Action.SOUTH, -8: Action.NORTH}
    steps = [Step(a, moves[b - a], b, -1.0) for a, b in pairwise(path)]
    assert len(to_gif(world, steps)) < 300_000


@pytest.mark.parametrize("scale", [0.25, 0.5, 1.5])
def test_it_is_as_large_as_asked(scale: float) -> None:
    scene = build_scene(ROW)
    frames, _ = shown(to_gif(ROW, WALK, scale=scale))
    assert frames.shape[1:3] == (round(scale * scene.height), round(scale * scene.width))


def test_a_film_of_a_large_level_is_no_larger_than_can_be_shown() -> None:
    world = level(size=[60, 20])
    frames, _ = shown(to_gif(world, [Step(0, Action.EAST, 1, -1.0)]))
    assert max(frames.shape[1:3]) == MAX_SIDE


@pytest.mark.slow
def test_long_films_leave_out_what_is_between_cells() -> None:
    there_and_back = [Step(0, Action.EAST, 1, -1.0), Step(1, Action.WEST, 0, -1.0)]
    world = level(size=[12, 12])
    frames, _ = shown(to_gif(world, there_and_back * 30))
    assert len(frames) == 61


def test_a_faster_robot_takes_less_time() -> None:
    slow, fast = (
        sum(shown(to_gif(level(size=[4, 1], display={"robot": {"speed": speed}}), WALK))[1])
        for speed in (0.5, 2)
    )
    held = 700 + 1500
    assert slow - held > 3 * (fast - held)


def test_what_would_be_too_much_is_refused() -> None:
    with pytest.raises(ValueError, match="has no steps"):
        to_gif(ROW, [])
    with pytest.raises(ValueError, match="too large"):
        to_gif(level(size=[100, 100]), [Step(0, 2, 1, -1.0)] * 10, scale=1.0)


@pytest.mark.slow
def test_the_robot_is_seen_in_a_large_level() -> None:
    maze = Level.from_fields({"version": 1, "size": [64, 64]})
    walk = [Step(0, Action.EAST, 1, -1.0), Step(1, Action.EAST, 2, -1.0)]
    frames, _ = shown(to_gif(maze, walk))
    ground = to_rgb(build_scene(maze, robot=False), frames[0].shape[1::-1]).astype(int)
    for frame in (frames[0], frames[-1]):
        changed = np.abs(frame.astype(int) - ground).max(axis=2) > 40
        assert changed[:40, :60].sum() > 150
        assert not changed[50:].any()


# -- films with things -----------------------------------------------------------------------------


def episode(world: Any, actions: str) -> list[Step]:
    """Return the steps of an episode without chance."""
    mdp = world.compile()
    state, steps = int(mdp.start.argmax()), []
    for letter in actions:
        action = ".NESW".index(letter)
        following = int(mdp.next_state[state, action, 0])
        steps.append(Step(state, action, following, float(mdp.reward[state, action, 0])))
        state = following
    return steps


def film(world: Any, steps: list[Step]) -> list[Any]:
    return [*shown(to_gif(world, steps))[0]]


def test_a_film_ends_with_the_pictures_of_its_states() -> None:
    steps = episode(CORRIDOR, "EE.")
    frames = film(CORRIDOR, steps)
    arrivals = [frames[5 * count] for count in range(1, 4)]
    for step, frame in zip(steps, arrivals, strict=True):
        pose = Pose(Action(step.action))
        expected = to_rgb(build_scene(CORRIDOR, state=step.next_state, pose=pose)).astype(int)
        assert np.abs(frame - expected).mean() < 2.5
    first = to_rgb(build_scene(CORRIDOR, state=steps[0].state)).astype(int)
    assert np.abs(frames[0] - first).mean() < 2.5


def test_a_thing_is_taken_on_arrival_and_movers_glide() -> None:
    frames = film(CORRIDOR, episode(CORRIDOR, "E"))
    key, guard = np.s_[20:50, 75:120], np.s_[10:60, 200:320]
    assert len(frames) == 6
    # The door is still closed while the robot is on its way, and the guard between its cells.
    door = np.s_[24:44, 190:202]
    assert (frames[4][door] == frames[0][door]).all()
    assert (frames[5][door] != frames[0][door]).any()
    places = [
        np.argwhere((frame[guard] == (255, 93, 115)).all(axis=2))[:, 1].mean() for frame in frames
    ]
    assert all(later < earlier for earlier, later in pairwise(places))
    assert (frames[0][key] != frames[5][key]).any()


@pytest.mark.parametrize("display", [{"side_panel": 140}, {"bottom_panel": 44}, {}])
def test_what_is_held_is_seen_in_films(display: dict[str, Any]) -> None:
    world = CORRIDOR.replace(display=display)
    steps = episode(world, "E")
    last = film(world, steps)[-1].astype(int)
    scene = build_scene(world, state=steps[0].next_state, pose=Pose(Action.EAST))
    before = build_scene(world, state=steps[0].state)
    outside = np.ones(last.shape[:2], bool)
    outside[:70, :330] = False
    expected, other = (to_rgb(each).astype(int)[outside] for each in (scene, before))
    # The score is in the film only.
    assert np.abs(last[outside] - expected).mean() < np.abs(last[outside] - other).mean()
