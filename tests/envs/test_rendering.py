"""What environments show: every render mode, what is written on pictures, pictures in files."""

from __future__ import annotations

import copy
import pickle
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from PIL import Image
from support.combinations import combined
from support.playing import level_named, plain

import babyrobot_levels as brl
from babyrobot_levels.envs.rendering import Pictures
from babyrobot_levels.render.frames import FramePainter
from babyrobot_levels.render.scene.build import build_scene
from babyrobot_levels.render.scene.info import overlay_from
from babyrobot_levels.render.situation import Mood, Pose
from babyrobot_levels.render.svg import to_svg
from babyrobot_levels.render.text import TextPainter

N, E, S, W = brl.Action.NORTH, brl.Action.EAST, brl.Action.SOUTH, brl.Action.WEST

INFOS: dict[str, dict[str, Any]] = {
    "values": {"values": np.arange(9.0).reshape(3, 3)},
    "policy": {"policy": np.full((3, 3), E)},
    "visits": {"visits": [[0, 1, 2], [3, 4, 5], [6, 7, 8]]},
    "text": {"text": [((1, 1), "here")]},
    "side panel": {"side_panel": ["reward: -1"]},
    "bottom panel": {"bottom_panel": "episode 7"},
}

RETURNING = ("rgb_array", "ansi", "svg")


def make(mode: str | None, level: Any = "default") -> Any:
    """Return a bare environment, whose robot stands at the start."""
    env = brl.load(level).make(render_mode=mode).unwrapped
    env.reset(seed=0)
    return env


# -- the picture ------------------------------------------------------------------------------


def test_the_modes_are_told() -> None:
    env = make(None)
    assert env.metadata["render_modes"] == ["human", "rgb_array", "ansi", "svg", "canvas"]
    assert type(env.metadata["render_fps"]) is int
    spec = gymnasium.spec("babyrobot/Level-v0")
    assert isinstance(spec.entry_point, str)


@pytest.mark.parametrize(
    ("action", "pose"),
    [(E, Pose(E)), (S, Pose(S)), (N, Pose(N)), (W, Pose(W)), (brl.Action.STAY, Pose())],
)
def test_he_looks_where_he_goes(action: int, pose: Pose) -> None:
    env = make("rgb_array")
    env.step(action)
    state = env.get_wrapper_attr("_state")
    frame = env.render()
    assert (frame == FramePainter(env.get_wrapper_attr("level")).frame(state, pose)).all()
    env.reset(options={"start": [state % 3, state // 3]})
    # A new episode has him look at the viewer again.
    assert (plain(frame) == plain(env.render())) == (action == brl.Action.STAY)


def test_he_cheers_at_the_exit_and_stands_when_an_episode_begins() -> None:
    level = level_named("default")
    frames, env = FramePainter(level), make("rgb_array")
    for action in (E, E, S, S):
        env.step(action)
    assert (env.render() == frames.frame(8, Pose(mood=Mood.CHEER))).all()
    env.reset()
    assert (env.render() == frames.frame(0)).all()


def test_he_slips() -> None:
    level = {"version": 1, "size": [3, 1], "start": [1, 0], "exit": "none"}
    env = make("rgb_array", {**level, "skid": {"probability": 1.0, "to": "others"}})
    env.step(E)
    state = env.get_wrapper_attr("_state")
    frames = FramePainter(env.get_wrapper_attr("level"))
    slipped = frames.frame(state, Pose(W if state == 0 else E, Mood.SLIP))
    assert (env.render() == slipped).all()


def test_an_svg_is_the_scene() -> None:
    env = make("svg")
    env.step(E)
    assert env.render() == to_svg(build_scene(level_named("default"), state=1, pose=Pose(E)))


def test_a_text_is_the_drawing() -> None:
    env = make("ansi")
    level = level_named("default")
    env.step(S)
    assert env.render() == "\n".join([*TextPainter(level).lines(3), ""])


def test_image_observations_know_nothing_of_poses_and_infos() -> None:
    env = level_named("default").make(observation="image", render_mode="rgb_array").unwrapped
    observation, _ = env.reset()
    env.get_wrapper_attr("show_info")(INFOS["values"])
    for action in (E, W):
        again, *_ = env.step(action)
    assert (again == observation).all()


# -- what is written on it --------------------------------------------------------------------


@combined(1, mode=RETURNING, kind=INFOS)
def test_infos_are_shown_until_they_are_cleared(kind: str, mode: str) -> None:
    env: Any = make(mode)
    before = plain(env.render())
    env.show_info(INFOS[kind])
    shown = plain(env.render())
    assert shown != before
    env.step(brl.Action.STAY)
    assert plain(env.render()) == shown
    env.clear_info()
    assert plain(env.render()) == before


def test_an_info_takes_the_place_of_the_one_before() -> None:
    env: Any = make("svg")
    env.show_info(INFOS["values"])
    env.show_info(INFOS["text"])
    overlay = overlay_from(INFOS["text"], env.level)
    assert env.render() == to_svg(build_scene(env.level, state=0, overlay=overlay))


def test_infos_as_text() -> None:
    env: Any = make("ansi")
    env.show_info(
        {
            "values": [[0, -1.5, None], [1, 2, 3], [4, 5, 6]],
            "policy": [["E", "S", None], [{"N", "E"}, "W", 0], [3, 3, -1]],
            "visits": [[0, 1, 20], [3, 4, 5], [6, 7, 8]],
            "text": [((0.5, 2), "between")],
            "side_panel": ["one", "two"],
            "bottom_panel": "three\x1b[2J",
            "precision": 1,
        }
    )
    drawing, values, visits, *rest = env.render().rstrip("\n").split("\n\n")
    assert drawing.splitlines()[1::2] == ["│☻→   ↓     │", "│ →   ←   · │", "│ ↓   ↓   E │"]
    assert values == " 0.0  -1.5\n 1.0   2.0   3.0\n 4.0   5.0   6.0"
    assert visits == " 0   1  20\n 3   4   5\n 6   7   8"
    assert rest == ["[0.5, 2] between", "one\ntwo", "three\\x1b[2J"]


@pytest.mark.parametrize("mode", [None, "svg"])
@pytest.mark.parametrize(
    "info", [{"valeus": np.ones((3, 3))}, {"values": np.ones((2, 3))}, {"text": "x"}]
)
def test_infos_that_cannot_be_shown_change_nothing(info: Any, mode: str | None) -> None:
    env: Any = make(mode)
    env.show_info(INFOS["values"])
    before = None if mode is None else plain(env.render())
    with pytest.raises(ValueError, match=r"value|text|rows"):
        env.show_info(info)
    assert mode is None or plain(env.render()) == before


# -- files ------------------------------------------------------------------------------------


@pytest.mark.parametrize("mode", [None, "rgb_array", "ansi", "human"])
def test_the_picture_is_saved_as_it_stands(mode: str | None, tmp_path: Path) -> None:
    env: Any = make(mode)
    env.step(E)
    env.show_info(INFOS["text"])
    env.step(S)
    overlay = overlay_from(INFOS["text"], env.level)
    scene = build_scene(env.level, state=4, pose=Pose(S), overlay=overlay)
    env.save(tmp_path / "new" / "a.svg")
    assert (tmp_path / "new" / "a.svg").read_text("utf-8") == to_svg(scene)
    env.save(str(tmp_path / "A.PNG"))
    with Image.open(tmp_path / "A.PNG") as image:
        assert image.size == (round(scene.width), round(scene.height))
        assert image.format == "PNG"
    env.save(tmp_path / "a.txt")
    assert (tmp_path / "a.txt").read_text("utf-8").splitlines()[3] == "│     ☻     │"


@pytest.mark.parametrize(
    ("name", "told"),
    [("a.jpg", r"'\.svg', '\.png', '\.txt'"), ("a", r", not ''"), ("a.pgn", "did you mean `.png`")],
)
def test_other_files_are_refused(name: str, told: str, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=told):
        make(None).get_wrapper_attr("save")(tmp_path / name)
    assert not list(tmp_path.iterdir())


def test_pictures_of_levels(tmp_path: Path) -> None:
    level = brl.load("frozen-lake")
    assert level.to_svg() == to_svg(build_scene(level))
    assert level.to_svg(tmp_path / "a.svg") == (tmp_path / "a.svg").read_text("utf-8")
    picture = level.to_png(str(tmp_path / "a.png"))
    assert picture == (tmp_path / "a.png").read_bytes() == level.to_png()
    assert picture.startswith(b"\x89PNG")


def test_a_maze_without_a_seed_has_no_picture() -> None:
    level = brl.load("random-maze")
    for picture in (level.to_svg, level.to_png):
        with pytest.raises(brl.LevelError, match="seed"):
            picture()


# -- copies and ends --------------------------------------------------------------------------


@pytest.mark.parametrize("mode", [None, "rgb_array", "human"])
def test_copies_keep_pose_and_info(mode: str | None, tmp_path: Path) -> None:
    env: Any = make(mode)
    env.show_info(INFOS["values"])
    env.step(E)
    env.save(tmp_path / "a.svg")
    for number, other in enumerate((copy.deepcopy(env), pickle.loads(pickle.dumps(env)))):
        path = tmp_path / f"{number}.svg"
        other.save(path)
        assert path.read_text("utf-8") == (tmp_path / "a.svg").read_text("utf-8")
        other.step(S)
        env.save(tmp_path / "again.svg")
        assert (tmp_path / "again.svg").read_bytes() == (tmp_path / "a.svg").read_bytes()


@pytest.mark.parametrize("mode", [None, "rgb_array", "human", "canvas"])
def test_closing_twice_and_going_on(mode: str | None) -> None:
    env = level_named("default").make(render_mode=mode)
    env.close()
    env.reset()
    if mode is not None:
        env.render()
    env.close()
    env.close()
    if mode is not None:
        env.render()
    env.step(E)
    env.close()


def test_what_is_not_looked_at_is_not_made() -> None:
    env = make(None)
    env.step(E)
    assert vars(env)["_pictures"] is None


# -- things and headings ---------------------------------------------------------------------


def with_key(columns: int = 4) -> brl.Level:
    fields = {
        "version": 1,
        "size": [columns, 1],
        "items": [{"name": "key", "at": [1, 0]}],
        "doors": [{"at": [2, 0], "side": "E", "needs": "key"}],
    }
    return brl.Level.from_fields(fields)


def test_texts_follow_things_and_headings() -> None:
    env: Any = with_key().make(render_mode="ansi", actions="turns")
    env.reset()
    assert env.render().splitlines()[1:] == [
        "│ ►   ♀     ┃ E │",
        "└───────────────┘",
        "",
        "held: nothing",
    ]
    env.step(brl.Turn.FORWARD)
    env.step(brl.Turn.LEFT)
    assert env.render().splitlines()[1:] == [
        "│ S   ▲     : E │",
        "└───────────────┘",
        "",
        "held: key",
    ]


def test_values_of_configurations_follow_the_episode() -> None:
    env: Any = with_key().make(render_mode="ansi")
    env.reset()
    solution = brl.solve(with_key())
    env.unwrapped.show_info({"values": solution})
    first, _, told = env.render().splitlines()[-3:]
    env.step(E)
    second, _, after = env.render().splitlines()[-3:]
    assert first.split()[0] == "-2.00"
    assert told == "╱ cannot occur while nothing is held"
    assert after == "shown while key is held"
    assert second.split() == ["-2.00", "-1.00", "0.00", "0.00"]


def test_values_of_configurations_do_not_outlast_their_level() -> None:
    first, second = with_key(), with_key().replace(title="another")
    for info, stays in (({"values": brl.solve(first)}, False), ({"values": [[1] * 4]}, True)):
        pictures = Pictures("ansi", first, 0, None)
        pictures.show_info(info)
        assert not pictures.text().endswith("held: nothing\n")
        pictures.reset(second, 0, None)
        assert pictures.text().endswith("held: nothing\n") is not stays
