"""OpenEnv serves levels, and its client plays them for their exact advantages."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from collections.abc import Iterator
from urllib.request import urlopen

import pytest
from openenv import GenericEnvClient
from openenv.cli.__main__ import app
from support.places import EXAMPLES
from typer.testing import CliRunner

import babyrobot_levels as brl


@pytest.fixture(scope="module")
def address() -> Iterator[str]:
    script = EXAMPLES / "serve_openenv.py"
    options = ["--suite", "text-easy", "--sight", "picture", "--port", "0"]
    command = [sys.executable, str(script), *options]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as server:
        assert server.stderr is not None
        found = (re.search(r"running on (http://\S+)", line) for line in server.stderr)
        yield next(match[1] for match in found if match)
        server.terminate()


def test_an_episode_is_played_by_the_client(address: str) -> None:
    level = brl.load_suite("text-easy").split("train")[1]
    world = brl.TextWorld(level, sight="picture", reward="advantage")
    with GenericEnvClient(base_url=address).sync() as client:
        result = client.reset(seed=3, split="train", index=1)
        assert result.observation["text"] == world.reset(seed=3)
        for move in ["east", "west", "south", *["wait"] * 47]:
            assert not result.done
            result = client.step({"move": move})
            text = world.wait() if move == "wait" else world.move(move)
            assert result.observation["text"] == text
            assert result.observation["picture"] == world.data_url
            assert result.reward == pytest.approx(world.moves[-1].advantage)
        assert result.done
        assert client.state()["step_count"] == 50


def test_other_moves_are_refused_and_the_episode_goes_on(address: str) -> None:
    with GenericEnvClient(base_url=address).sync() as client:
        client.reset(seed=3)
        with pytest.raises(RuntimeError, match="VALIDATION_ERROR"):
            client.step({"move": "up"})
        assert client.step({"move": "east"}).reward is not None


def test_its_own_command_validates_the_server_and_the_folder(address: str) -> None:
    for target in (["--url", address], [str(EXAMPLES), "--level", "static"]):
        done = CliRunner().invoke(app, ["validate", *target])
        assert (done.exit_code, "Verdict: PASS" in done.output) == (0, True), done.output


def test_levels_are_its_tasks(address: str) -> None:
    with urlopen(f"{address}/levels/splits") as answer:
        assert [each["name"] for each in json.load(answer)] == ["train", "validation", "test"]
