"""FrozenLake: levels have the transition tables of Gymnasium's environment."""

from __future__ import annotations

import json
from typing import Any

import gymnasium
import pytest
from gymnasium.envs.toy_text.frozen_lake import MAPS, generate_random_map
from support.conversions import level_of_world, world_of

import babyrobot_levels as brl
from babyrobot_levels.extensions.formats.conversion import ConversionError
from babyrobot_levels.extensions.formats.formats import export
from babyrobot_levels.extensions.formats.frozen_lake import read_frozen_lake
from babyrobot_levels.extensions.formats.reading import guess
from babyrobot_levels.text.source import SourceFile

LAKES: dict[str, list[str]] = {
    **MAPS,
    **{f"random-{seed}": generate_random_map(size=6, p=0.8, seed=seed) for seed in range(6)},
    "one row": ["SFHFG"],
    "two starts": ["SFS", "HFG"],
    "two goals": ["GFS", "FFG"],
}


def environment(**keywords: Any) -> Any:
    return gymnasium.make("FrozenLake-v1", **keywords)


@pytest.mark.parametrize("is_slippery", [True, False])
@pytest.mark.parametrize("name", LAKES)
def test_a_map_has_the_tables_of_gymnasium(name: str, is_slippery: bool) -> None:
    text = "\n".join(LAKES[name])
    world = read_frozen_lake(SourceFile("lake", text), slippery=is_slippery)
    env = environment(desc=LAKES[name], is_slippery=is_slippery)
    certificate = brl.compare(level_of_world(world), env)
    assert certificate.difference is None
    assert certificate.everywhere


@pytest.mark.parametrize(
    "keywords",
    [
        {},
        {"is_slippery": False},
        {"success_rate": 0.8},
        {"success_rate": 1.0},
        {"success_rate": 0.25, "reward_schedule": [5, -1, -0.1]},
        {"is_slippery": False, "reward_schedule": [0, -5, 0]},
    ],
    ids=str,
)
def test_keywords_have_the_tables_of_gymnasium(keywords: dict[str, Any]) -> None:
    whole = {"desc": MAPS["4x4"], **keywords}
    world = world_of(json.dumps(whole), "frozen-lake")
    certificate = brl.compare(level_of_world(world), environment(**whole))
    assert certificate.difference is None
    assert world.lost == ()


@pytest.mark.parametrize("name", LAKES)
@pytest.mark.parametrize("is_slippery", [True, False])
def test_a_map_comes_back(name: str, is_slippery: bool) -> None:
    keywords = {"desc": LAKES[name], "is_slippery": is_slippery}
    level = level_of_world(world_of(json.dumps(keywords), "frozen-lake"))
    conversion = export(level, "frozen-lake")
    assert conversion.warnings == ()
    assert json.loads(conversion.text) == keywords


@pytest.mark.parametrize("schedule", [[1, -1, 0], [10, -5, -0.5], [0, 0, 10]], ids=str)
def test_the_reward_of_a_hole_comes_back(schedule: list[float]) -> None:
    keywords = {"desc": LAKES["4x4"], "is_slippery": True, "reward_schedule": schedule}
    conversion = export(
        level_of_world(world_of(json.dumps(keywords), "frozen-lake")), "frozen-lake"
    )
    assert conversion.warnings == ()
    assert json.loads(conversion.text) == keywords


def test_holes_of_different_rewards_are_reported() -> None:
    hole = {"size": [1, 1], "ends": True}
    areas = [{"at": [1, 0], "reward": -1, **hole}, {"at": [2, 1], "reward": -2, **hole}]
    level = brl.load({"version": 1, "areas": areas, "skid": {"probability": 0.5, "to": "sides"}})
    told = [lost.field for lost in export(level, "frozen-lake").warnings]
    assert told == ["areas.reward"]


@pytest.mark.parametrize(
    ("fields", "told"),
    [
        *(({"rewards": {n: -3}}, f"rewards.{n}") for n in ("bump", "stay", "closer", "farther")),
        ({"skid": {"probability": 0.5, "to": "others"}}, "skid.to"),
        ({"blocked": [{"at": [1, 1]}]}, "blocked"),
        ({"walls": [{"at": [0, 0], "side": "E"}]}, "walls"),
    ],
    ids=str,
)
def test_losses_are_reported_by_the_name_of_the_property(fields: dict[str, Any], told: str) -> None:
    level = brl.load({"version": 1, **fields})
    assert [lost.field for lost in export(level, "frozen-lake").warnings] == [told]


def test_a_list_of_lists_of_letters_is_a_map_too() -> None:
    text = repr([list(row) for row in MAPS["4x4"]])
    assert level_of_world(world_of(text, "frozen-lake")).exits == ((3, 3),)


def test_the_map_of_an_environment_is_read_as_it_is() -> None:
    held = repr(environment(map_name="8x8").unwrapped.desc.tolist())
    assert guess(SourceFile("lake", held)) == ["frozen-lake"]
    plain = "\n".join(MAPS["8x8"])
    assert world_of(held, "frozen-lake").fields == world_of(plain, "frozen-lake").fields


@pytest.mark.parametrize("name", ["frozen-lake", "frozen-lake-8x8", "frozen-lake-dry"])
def test_the_gallerys_lakes_are_gymnasiums(name: str) -> None:
    conversion = export(brl.load(name), "frozen-lake")
    keywords = json.loads(conversion.text)
    assert brl.compare(name, environment(**keywords)).equal
    game = [lost.field for lost in conversion.warnings]
    ours = {"title", "description", "source", "tags", "theme", "expect"}
    assert set(game) <= ours


@pytest.mark.parametrize(
    "keywords",
    [{"map_name": "8x8"}, {"map_name": "4x4"}, {"is_slippery": False}, {"desc": None}],
    ids=str,
)
def test_a_map_may_be_named(keywords: dict[str, Any]) -> None:
    text = json.dumps(keywords)
    assert guess(SourceFile("lake", text)) == ["frozen-lake"]
    world = world_of(text, "frozen-lake")
    assert world.lost == ()
    assert brl.compare(level_of_world(world), environment(**keywords)).difference is None


def test_a_map_wins_over_a_name() -> None:
    world = world_of('{"desc": ["SG"], "map_name": "8x8"}', "frozen-lake")
    assert (level_of_world(world).size, world.lost) == ((2, 1), ())


def test_keywords_that_do_not_change_the_mdp_are_reported() -> None:
    text = json.dumps({"desc": ["SG"], "render_mode": "human", "seed": 3})
    assert [*map(str, world_of(text, "frozen-lake").lost)] == [
        "render_mode: it does not change the MDP",
        "seed: FrozenLake has no such keyword, and does not use it",
    ]


@pytest.mark.parametrize(
    ("given", "meant"),
    [
        ("is_slipery", "is_slippery"),
        ("isSlippery", "is_slippery"),
        ("succes_rate", "success_rate"),
        ("reward_shedule", "reward_schedule"),
        ("max_steps", "max_episode_steps"),
    ],
)
def test_misspelt_keywords_are_refused_as_gymnasium_refuses_them(given: str, meant: str) -> None:
    keywords = {"desc": ["SG"], given: False}
    with pytest.raises(ConversionError, match=f"no keyword '{given}'; did you mean `{meant}`?"):
        world_of(json.dumps(keywords), "frozen-lake")
    with pytest.raises(TypeError, match=given):
        environment(**keywords)


@pytest.mark.parametrize(("limit", "steps"), [(30, 30), (-1, None), (None, None)])
def test_the_limit_of_steps_is_kept(limit: int | None, steps: int | None) -> None:
    world = world_of(json.dumps({"desc": ["SFG"], "max_episode_steps": limit}), "frozen-lake")
    level = level_of_world(world)
    assert (level.max_steps, world.lost) == (steps, ())
    written = json.loads(export(level, "frozen-lake").text)
    assert written.get("max_episode_steps") == steps
    assert environment(**written).spec.max_episode_steps == (steps or 100)


def test_a_lake_of_one_column_can_be_made() -> None:
    level = brl.load({"version": 1, "size": [1, 3], "skid": {"probability": 2 / 3, "to": "sides"}})
    keywords = json.loads(export(level, "frozen-lake").text)
    assert brl.compare(level, environment(**keywords)).equal


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("SFF\nFXG", r"world\.txt:2:2: error: unknown character `X`"),
        ("SFF\nFG", "row 2 of the map has 2 letters, the first has 3"),
        ("FFF\nFFG", "no start"),
        ('["SF", 3]', "list of texts"),
        ("[]", "list of texts"),
        ('{"desc": ["SG"], "success_rate": 2}', "success_rate must be a probability"),
        ('{"desc": ["SG"], "reward_schedule": [1]}', "reward_schedule must be three numbers"),
        ('{"desc": ["SG"], "is_slippery": "no"}', "is_slippery must be true or false"),
        ('{"map_name": "9x9"}', "map_name must be 4x4 or 8x8"),
        ('{"map_name": null}', "generates a random lake"),
    ],
)
def test_invalid_maps_are_refused_with_the_place(text: str, message: str) -> None:
    with pytest.raises(ConversionError, match=message):
        world_of(text, "frozen-lake")
