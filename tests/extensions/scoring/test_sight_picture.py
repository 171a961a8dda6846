"""Agents that see: they get the picture that environments render, and a text that tells no map."""

from __future__ import annotations

import base64
import io
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image
from support.worlds import level

import babyrobot_levels as brl

DOOR = {"at": [0, 0], "side": "east", "needs": ["key"]}


def pixels_of(png: bytes) -> NDArray[np.uint8]:
    with Image.open(io.BytesIO(png)) as image:
        return np.array(image.convert("RGB"))


@pytest.mark.slow
def test_the_picture_is_that_of_the_environment() -> None:
    world = brl.TextWorld("night-watch", sight="picture")
    assert (world.pixels, world.picture, world.data_url) == (None, None, None)
    env: Any = brl.load("night-watch").make(render_mode="rgb_array")
    env.reset(seed=5)
    world.reset(seed=5)
    for action in (brl.Action.NORTH, brl.Action.WEST, brl.Action.STAY, brl.Action.SOUTH):
        env.step(action)
        _ = world.wait() if action is brl.Action.STAY else world.move(str(action))
        assert world.pixels is not None
        assert world.picture is not None
        assert world.data_url is not None
        assert np.array_equal(world.pixels, env.render())
        assert np.array_equal(pixels_of(world.picture), world.pixels)
        assert base64.b64decode(world.data_url.partition("base64,")[2]) == world.picture


def test_other_sights_have_no_picture() -> None:
    world = brl.TextWorld("first-key")
    world.reset(seed=1)
    assert (world.pixels, world.picture, world.data_url) == (None, None, None)


def told(**fields: Any) -> list[str]:
    """Return the texts of an episode in a level whose exit needs a key."""
    given = {"size": [4, 3], "exit": [3, 2], "exit_needs": ["key"], "max_steps": 9, **fields}
    world = brl.TextWorld(level(**given), sight="picture")
    return [world.reset(seed=1), world.move("south"), world.move("north"), world.look()]


def test_the_text_does_not_tell_what_is_where() -> None:
    """So levels with the same rules have the same texts."""
    items = [{"name": "key", "at": [0, 1]}]
    one = told(items=items, doors=[DOOR], movers=[{"path": [[2, 2], [3, 2]]}])
    walls = [{"at": [1, 1], "side": "south"}]
    doors = [{**DOOR, "at": [1, 2]}]
    movers = [{"path": [[2, 0], [2, 1]]}]
    other = told(items=items, doors=doors, walls=walls, movers=movers, exit=[3, 0])
    assert one == other
    assert "Took the key. A door opens. The exit is open." in one[1]
    assert one[-1] == "The picture shows what is where.\nheld: key"


@pytest.mark.slow
def test_an_agent_is_scored_by_what_it_sees() -> None:
    """It sees on which of two starts the robot stands, which no text tells."""
    corridor = level(size=[3, 1], start=[[0, 0], [2, 0]], exit=[1, 0], max_steps=5)

    def agent(text: str, pixels: NDArray[np.uint8]) -> str:
        assert pixels.dtype == np.uint8
        third = pixels.shape[1] // 3
        left, right = pixels[:, :third], pixels[:, -third:]
        colors = [len(np.unique(part.reshape(-1, 3), axis=0)) for part in (left, right)]
        return "east" if colors[0] > colors[1] else "west"

    (score,) = brl.score(corridor, agent, sight="picture", episodes=8)
    assert (score.success, score.regret, score.invalid) == (1, 0, 0)
    (east,) = brl.score(corridor, lambda *_: "east", sight="picture", episodes=8)
    assert east.success < 1


def test_a_chat_model_gets_text_and_picture_in_each_message() -> None:
    heard: list[list[dict[str, Any]]] = []

    def model(messages: list[dict[str, Any]]) -> str:
        heard.append(messages)
        return "east"

    brl.score("first-key", model, sight="picture", chat=True, episodes=1, within=2, seed=3)
    first, answer, second = heard[-1]
    assert answer == {"role": "assistant", "content": "east"}
    for message in (first, second):
        text, picture = message["content"]
        assert text["type"] == "text"
        png = base64.b64decode(picture["image_url"]["url"].removeprefix("data:image/png;base64,"))
        assert pixels_of(png).shape == (240, 326, 3)
    assert first["content"][1] != second["content"][1]


def test_each_robot_is_told_of_its_own_moves_alone() -> None:
    team = brl.TextTeam("passing-place", sight="picture")
    team.reset(seed=1)
    env: Any = brl.make("passing-place", render_mode="rgb_array")
    env.reset(seed=1)
    told = team.step({})
    assert team.pixels is not None
    assert team.pixels.shape == np.shape(env.render())
    for name, text in told.items():
        assert text.casefold().count(" waits.") == 1, name


def test_what_a_picture_cannot_show_is_refused() -> None:
    large = level(size=[65, 2], max_steps=9)
    with pytest.raises(ValueError, match=r"65 x 2 cells is too large .* up to 64 a side"):
        brl.TextWorld(large, sight="picture")
    with pytest.raises(ValueError, match="tell_sure"):
        brl.TextWorld("first-key", sight="picture", tell_sure=True)
    with pytest.raises(ValueError, match="knowable"):
        brl.score("first-key", lambda *_: "east", sight="picture", knowable=True)
