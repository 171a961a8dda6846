"""The ids of packs: registered from file names alone, and otherwise like those of the gallery."""

from __future__ import annotations

import copy
import dataclasses
import os
import pickle
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import gymnasium
import pytest
from gymnasium.envs.registration import EnvSpec, registry
from gymnasium.wrappers import TimeLimit
from support.carriers import LEVEL, carry, write
from support.subprocesses import run

import babyrobot_levels as brl
from babyrobot_levels.envs.registration import register_levels

LIMITED = f"{LEVEL}max_steps: 9\n"
RANDOM = f"{LEVEL}maze: {{seed: random}}\n"
SUITE = "version: 1\nkind: suite\nseed: 1\ncount: 5\nsize: [4, 4]\nmaze: {}\n"


@pytest.fixture(autouse=True)
def fresh_registry() -> Iterator[None]:
    """What a test registers is gone after it."""
    before = dict(registry)
    yield
    registry.clear()
    registry.update(before)


def ids() -> list[str]:
    return [name for name in registry if name.startswith("babyrobot/zoo.")]


# -- which ids there are ---------------------------------------------------------------------


@pytest.mark.slow
def test_each_level_has_its_id_in_a_fresh_process(users_pack: Path, site: Path) -> None:
    write(users_pack / "lion.yaml", LIMITED)
    write(users_pack / "apes" / "Old Gorilla.yml")
    write(users_pack / "suites" / "monkeys.yaml", SUITE)
    write(users_pack / "suites" / "cage.yaml")
    write(users_pack / "themes" / "sea.yaml", "colors: {base: red}\n")
    carry(site, "brl_ark", "ark = brl_ark")
    write(site / "brl_ark" / "dove.yaml")
    code = """
import gymnasium, babyrobot_levels
names = [name for name in gymnasium.registry if "." in name and name.startswith("babyrobot/")]
shown = gymnasium.pprint_registry(disable_print=True).split()
for name in names:
    print(name, name in shown, gymnasium.make(name).unwrapped.level.name)
"""
    assert run(code, users_pack, site).splitlines() == [
        "babyrobot/zoo.lion-v0 True lion",
        "babyrobot/zoo.old-gorilla-v0 True old-gorilla",
        "babyrobot/zoo.cage-v0 True cage",
        "babyrobot/ark.dove-v0 True dove",
    ]


@pytest.mark.slow
def test_no_level_is_read_before_somebody_asks(users_pack: Path) -> None:
    if not hasattr(os, "mkfifo"):
        pytest.skip("this system has no named pipes")
    for number in range(20):
        write(users_pack / f"{number}.yaml", "[" * 9000)
    # Whoever opened this one would wait for ever.
    os.mkfifo(users_pack / "pipe.yaml")
    opened = """
import sys
paths = []
sys.addaudithook(lambda event, args: event == "open" and paths.append(str(args[0])))
import gymnasium, babyrobot_levels
print("babyrobot/zoo.7-v0" in gymnasium.registry, "babyrobot/zoo.pipe-v0" in gymnasium.registry)
print([path for path in paths if path.endswith(".yaml") and "suites" not in path])
"""
    assert run(opened, users_pack).splitlines() == ["True True", "[]"]


@pytest.mark.parametrize("name", ["my zoo", "動 物"])
def test_a_folder_whose_name_no_id_can_have(name: str, users_pack: Path) -> None:
    write(users_pack.parent / name / "lion.yaml")
    write(users_pack / "lion.yaml")
    before = set(registry)
    register_levels()
    assert set(registry) - before == {"babyrobot/zoo.lion-v0"}
    assert gymnasium.make("babyrobot/Level-v0", level=f"{name}/lion").reset()[0].tolist() == [0, 0]


def test_a_pack_that_comes_later_is_registered_then(users_pack: Path) -> None:
    assert ids() == []
    write(users_pack / "lion.yaml")
    # `Level-v0` looks for it at once.
    assert gymnasium.make("babyrobot/Level-v0", level="zoo/lion").spec is not None
    with pytest.raises(gymnasium.error.NameNotFound):
        gymnasium.make("babyrobot/zoo.lion-v0")
    register_levels()
    known = registry["babyrobot/zoo.lion-v0"]
    register_levels()
    assert registry["babyrobot/zoo.lion-v0"] is known
    assert gymnasium.make("babyrobot/zoo.lion-v0").reset()[0].tolist() == [0, 0]


def test_an_id_that_somebody_else_has_taken_stays_theirs(users_pack: Path) -> None:
    gymnasium.register("babyrobot/zoo.lion-v0", entry_point="mine:Env")
    write(users_pack / "lion.yaml")
    register_levels()
    assert registry["babyrobot/zoo.lion-v0"].entry_point == "mine:Env"


def test_of_two_files_of_one_name_the_first_is_meant(users_pack: Path) -> None:
    write(users_pack / "a" / "lion.yaml", f"{LEVEL}max_steps: 1\n")
    write(users_pack / "b" / "lion.yaml", f"{LEVEL}max_steps: 2\n")
    register_levels()
    assert ids() == ["babyrobot/zoo.lion-v0"]
    assert gymnasium.make("babyrobot/zoo.lion-v0").get_wrapper_attr("level").max_steps == 1
    assert registry["babyrobot/zoo.lion-v0"].max_episode_steps == 1


# -- what is broken or gone ------------------------------------------------------------------


def test_levels_that_cannot_be_played_say_why_when_they_are_made(users_pack: Path) -> None:
    write(users_pack / "torn.yaml", "version: [\n")
    write(users_pack / "faulty.yaml", f"{LEVEL}max_steps: many\n")
    write(users_pack / "list.yaml", "- 1\n")
    write(users_pack / "suite.yaml", SUITE)
    write(users_pack / "gone.yaml", LIMITED)
    register_levels()
    (users_pack / "gone.yaml").unlink()
    assert [registry[name].max_episode_steps for name in ids()] == [None] * 5
    for name in ("torn", "faulty", "list"):
        with pytest.raises(brl.LevelError):
            gymnasium.make(f"babyrobot/zoo.{name}-v0")
    with pytest.raises(brl.LevelError, match="this is a suite of levels, not a level"):
        gymnasium.make("babyrobot/zoo.suite-v0")
    with pytest.raises(brl.LevelNotFoundError):
        gymnasium.make("babyrobot/zoo.gone-v0")


# -- limits ----------------------------------------------------------------------------------


@pytest.fixture
def limited(users_pack: Path) -> str:
    """The id of a level of a pack with `max_steps: 9`."""
    write(users_pack / "lion.yaml", LIMITED)
    register_levels()
    return "babyrobot/zoo.lion-v0"


def steps_until_cut_off(env: gymnasium.Env[Any, Any]) -> int:
    env.reset(seed=1)
    for number in range(1, 40):
        *_, truncated, _ = env.step(0)
        if truncated:
            return number
    return -1


@pytest.mark.parametrize(
    ("given", "steps"), [({}, 9), ({"max_episode_steps": 3}, 3), ({"max_episode_steps": 20}, 20),
                         ({"max_episode_steps": -1}, -1)]
)  # fmt: skip
def test_the_limit_is_the_levels_or_what_is_asked_for(
    given: dict[str, Any], steps: int, limited: str
) -> None:
    env = gymnasium.make(limited, **given)
    assert env.spec is not None
    assert env.spec.max_episode_steps == (None if steps < 0 else steps)
    assert steps_until_cut_off(env) == steps
    assert isinstance(env, TimeLimit) is (steps > 0)
    again = gymnasium.make(EnvSpec.from_json(env.spec.to_json()))
    assert steps_until_cut_off(again) == steps


def test_the_spec_can_be_copied_and_written_down(limited: str) -> None:
    spec = gymnasium.spec(limited)
    assert (spec.namespace, spec.name, spec.version) == ("babyrobot", "zoo.lion", 0)
    for same in (copy.deepcopy(spec), pickle.loads(pickle.dumps(spec)), dataclasses.replace(spec),
                 EnvSpec.from_json(spec.to_json())):  # fmt: skip
        assert same.max_episode_steps == 9
        assert steps_until_cut_off(gymnasium.make(same)) == 9
    assert "max_episode_steps=9" in str(spec.pprint(disable_print=True))
    assert steps_until_cut_off(gymnasium.make(dataclasses.replace(spec, max_episode_steps=2))) == 2
    spec.max_episode_steps = 4
    assert steps_until_cut_off(gymnasium.make(limited)) == 4


@pytest.mark.slow
@pytest.mark.parametrize("mode", ["vector_entry_point", "sync", None])
def test_the_limit_of_many_robots(mode: str | None, limited: str) -> None:
    envs = gymnasium.make_vec(limited, num_envs=2, vectorization_mode=mode)
    envs.reset(seed=1)
    for number in range(1, 10):
        *_, truncated, _ = envs.step([0, 0])
        assert truncated.tolist() == [number == 9] * 2


@pytest.mark.slow
def test_a_random_maze(users_pack: Path) -> None:
    write(users_pack / "lion.yaml", RANDOM)
    register_levels()
    env = gymnasium.make("babyrobot/zoo.lion-v0")
    assert env.reset(seed=1)[1]["maze_seed"] != env.reset()[1]["maze_seed"]
    envs = gymnasium.make_vec("babyrobot/zoo.lion-v0", num_envs=3)
    assert envs.reset(seed=1)[0].shape == (3, 2)
