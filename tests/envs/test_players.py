"""Gymnasium's own ways of watching and playing: videos, windows, keys, lists of frames."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from gymnasium.wrappers import HumanRendering, RecordVideo, RenderCollection
from support.playing import level_named

import babyrobot_levels as brl

EAST, SOUTH = brl.Action.EAST, brl.Action.SOUTH


@pytest.fixture
def pygame(monkeypatch: pytest.MonkeyPatch) -> Iterator[Any]:
    """Pygame without a screen."""
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    monkeypatch.setenv("SDL_AUDIODRIVER", "dummy")
    monkeypatch.setenv("PYGAME_HIDE_SUPPORT_PROMPT", "1")
    with warnings.catch_warnings():
        # What pygame itself does when it is imported is not ours.
        warnings.simplefilter("ignore")
        import pygame
    yield pygame
    pygame.quit()


@pytest.fixture
def play(pygame: Any) -> Any:
    """Gymnasium's player, which warns when it is imported without matplotlib."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        from gymnasium.utils.play import play
    pygame.init()
    return play


@pytest.mark.parametrize("mode", ["rgb_array", "ansi", "svg"])
def test_frames_are_collected(mode: str) -> None:
    by_name = level_named("default").make(render_mode=f"{mode}_list")
    by_hand = RenderCollection(level_named("default").make(render_mode=mode))
    single = level_named("default").make(render_mode=mode)
    frames: list[Any] = []
    for env in (by_name, by_hand, single):
        env.reset(seed=0)
    frames.append(single.render())
    for action in (EAST, SOUTH):
        for env in (by_name, by_hand, single):
            env.step(action)
        frames.append(single.render())
    for env in (by_name, by_hand):
        collected: Any = env.render()
        assert [np.array_equal(*pair) for pair in zip(collected, frames, strict=True)] == [True] * 3
        assert env.render() == []


@pytest.mark.slow
def test_a_video_is_recorded(tmp_path: Path) -> None:
    env: Any = RecordVideo(
        level_named("final-maze").make(render_mode="rgb_array", max_episode_steps=12),
        str(tmp_path / "videos"),
        episode_trigger=lambda _: True,
    )
    assert env.frames_per_sec == 4
    env.reset(seed=0)
    env.unwrapped.show_info({"values": np.ones((5, 8))})
    while not env.step(env.action_space.sample())[3]:
        pass
    env.close()
    env.close()
    (video,) = (tmp_path / "videos").iterdir()
    from moviepy import VideoFileClip  # type: ignore[import-untyped]

    with warnings.catch_warnings():
        # It sets shapes of arrays, which NumPy 2.5 deprecates.
        warnings.simplefilter("ignore", DeprecationWarning)
        clip = VideoFileClip(str(video))
    with clip:
        assert clip.fps == 4
        assert clip.n_frames == 13
        # Encoders round sizes to even numbers at most.
        height, width = env.unwrapped._pictures._frame().shape[:2]
        assert abs(clip.size[0] - width) <= 1
        assert abs(clip.size[1] - height) <= 1


@pytest.mark.slow
def test_a_window_shows_the_frames(pygame: Any) -> None:
    env: Any = HumanRendering(level_named("default").make(render_mode="rgb_array"))
    env.reset(seed=0)
    env.step(EAST)
    seen = pygame.surfarray.array3d(pygame.display.get_surface()).transpose(1, 0, 2)
    assert (seen == env.unwrapped.render()).all()
    env.close()
    env.close()


def keys(pygame: Any) -> dict[str, int]:
    return {"north": pygame.K_UP, "east": pygame.K_RIGHT, "south": pygame.K_DOWN,
            "west": pygame.K_LEFT}  # fmt: skip


@pytest.mark.parametrize("actions", ["valid", "all", "moves"])
def test_keys_mean_actions(actions: str, pygame: Any) -> None:
    env: Any = level_named("default").make(actions=actions).unwrapped
    found = env.get_keys_to_action()
    first = 1 if actions == "moves" else 0
    for direction, key in keys(pygame).items():
        assert found[(key,)] == brl.Action[direction.upper()] - first
    letters = {chr(key): action for (key,), action in found.items() if key < 128}
    expected = {"w": 1, "d": 2, "s": 3, "a": 4, " ": 0}
    assert letters == {
        letter: action - first for letter, action in expected.items() if action >= first
    }


@pytest.mark.parametrize("actions", ["valid", "moves"])
def test_it_can_be_played(actions: str, pygame: Any, play: Any) -> None:
    """Each key is pressed for a step, as a person would; then the window is closed."""
    todo = [pygame.K_RIGHT, pygame.K_d, pygame.K_DOWN, pygame.K_s]
    told: list[tuple[list[int], int, bool]] = []

    def press(before: Any, after: Any, action: Any, *result: Any) -> None:
        told.append((after.tolist(), int(action), result[1]))
        pygame.event.post(pygame.event.Event(pygame.KEYUP, key=todo.pop(0)))
        if todo:
            pygame.event.post(pygame.event.Event(pygame.KEYDOWN, key=todo[0]))
        else:
            pygame.event.post(pygame.event.Event(pygame.QUIT))

    env = level_named("default").make(render_mode="rgb_array", actions=actions)
    pygame.event.post(pygame.event.Event(pygame.KEYDOWN, key=todo[0]))
    play(env, callback=press, wait_on_player=True, fps=100)
    first = 1 if actions == "moves" else 0
    moves = [2 - first, 2 - first, 3 - first, 3 - first]
    cells = [[1, 0], [2, 0], [2, 1], [2, 2]]
    assert told == list(zip(cells, moves, [False, False, False, True], strict=True))
