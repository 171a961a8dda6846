"""What was made with the version before works: pickles, specs, codes, packs, settings, names.

`tests/oracles/record_version_0_1.py` made the files and says how. A change that is meant is listed
here, in `RENAMED`, `REMOVED_MEMBERS` or `REMOVED_MODULES`; what is not listed has to be as it was.
"""

from __future__ import annotations

import dataclasses
import json
import pickle
import sys
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.envs.registration import EnvSpec
from oracles import record_version_0_1 as version
from support.sessions import environment, run_here
from support.subprocesses import python

import babyrobot_levels as brl
from babyrobot_levels.envs.former_modules import MOVED, new_name
from babyrobot_levels.mdp.tables import FORMER_NAMES

RENAMED: dict[str, dict[str, str]] = {"Mdp": FORMER_NAMES}
"""For functions and classes, parameters that have a new name.

An attribute of an old name has to stay, with a DeprecationWarning.
"""

REMOVED_MEMBERS = {"Level.remember_drawn"}
"""Members of classes that were never meant for users, nor documented."""


def recorded(name: str) -> Any:
    return json.loads((version.FOLDER / name).read_text(encoding="utf-8"))


REMOVED_MODULES = {
    "babyrobot_levels.render.film",
    *(
        f"babyrobot_levels.scene.overlays.{name}"
        for name in ("draw", "heat", "notes", "numbers", "policy", "rooms")
    ),
    # There was one module for each rule.
    *(name for name in recorded("modules.json") if name.startswith("babyrobot_levels.lint.rules.")),
}
"""Internal modules without a successor, by their old full names."""


# -- modules ---------------------------------------------------------------------------------

IMPORT_ALL = """
import importlib, json, sys, warnings

found = {}
for name in json.loads(sys.argv[1]):
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            module = importlib.import_module(name)
        except ModuleNotFoundError as error:
            found[name] = {"missing": str(error)}
            continue
        except ImportError as error:  # it needs a package that is not installed
            found[name] = {"now": str(error).split()[0]}
        else:
            assert sys.modules[module.__name__] is module is sys.modules[name]
            assert module.__spec__.name == module.__name__
            found[name] = {"now": module.__name__}
    found[name]["warnings"] = [
        str(each.message) for each in caught if each.category is DeprecationWarning
    ]
print(json.dumps(found))
"""


def test_modules_can_be_imported_by_their_old_names(tmp_path: Path) -> None:
    names = [name for name in recorded("modules.json") if name not in REMOVED_MODULES]
    done = python("-c", IMPORT_ALL, json.dumps(names), cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    missing = [name for name, each in found.items() if "missing" in each]
    assert not missing, (
        "These modules have moved. Add them to MOVED in envs/former_modules.py (the entries below "
        "name the modules that have most of their names now), or to REMOVED_MODULES here.\n"
        + "".join(map(entry_for, missing))
    )
    for name, each in found.items():
        moved = each["now"] != name
        expected = f"the module {name} is now {each['now']}"
        assert (expected in each["warnings"]) == moved, name


def entry_for(name: str) -> str:
    """Return an entry of `MOVED` for a module: to the one that defines most of its names."""
    names = set(recorded("modules.json")[name])
    today = version.modules()
    best = max(today, key=lambda module: len(names & set(today[module])))
    return "    " + ": ".join(f'"{each.partition(".")[2]}"' for each in (name, best)) + ",\n"


def test_the_table_of_moved_modules_has_no_name_that_is_taken() -> None:
    package = Path(brl.__file__).parent
    for old, new in MOVED.items():
        path = package.joinpath(*old.split("."))
        assert not path.with_suffix(".py").exists(), old
        assert not path.joinpath("__init__.py").exists(), old
        target = package.joinpath(*new.split("."))
        assert target.is_dir() or target.with_suffix(".py").is_file(), new


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("babyrobot_levels.solver.results", "babyrobot_levels.analysis.solver.results"),
        ("babyrobot_levels.lint.reach", "babyrobot_levels.mdp.reachability"),
        ("babyrobot_levels.lint.check", "babyrobot_levels.lint.runner"),
        ("babyrobot_levels", None),
        ("numpy.level", None),
    ],
)
def test_new_names_are_found_by_the_longest_entry(old: str, new: str | None) -> None:
    assert new_name(old) == new


def test_the_warning_names_the_users_line(tmp_path: Path) -> None:
    path = tmp_path / "script.py"
    path.write_text("\nfrom babyrobot_levels.learning import q_learning\n", encoding="utf-8")
    done = python("-W", "always", path, cwd=tmp_path)
    assert "script.py:2: DeprecationWarning" in done.stderr
    assert "babyrobot_levels.learning is now babyrobot_levels.analysis.learning" in done.stderr


@pytest.mark.parametrize("name", ["Mdp", "Outcome", "FREE", "REFUSED", "GLASS"])
def test_the_former_module_of_tables_is_a_package_with_its_names(name: str) -> None:
    from babyrobot_levels import mdp
    from babyrobot_levels.mdp import tables

    with pytest.warns(DeprecationWarning, match=f"{name} has moved to babyrobot_levels.mdp.table"):
        assert getattr(mdp, name) is getattr(tables, name)


def test_the_package_of_tables_has_no_other_names() -> None:
    from babyrobot_levels import mdp

    with pytest.raises(AttributeError, match="has no attribute 'Mpd'"):
        _ = mdp.Mpd


# -- pickles ---------------------------------------------------------------------------------


@pytest.fixture
def _no_old_modules_afterwards() -> Iterator[None]:
    yield
    for name in [name for name in sys.modules if new_name(name)]:
        parent, _, last = name.rpartition(".")
        module = sys.modules.pop(name)
        if vars(sys.modules.get(parent, module)).get(last) is module != brl:
            delattr(sys.modules[parent], last)


PICKLES = sorted(path.stem for path in (version.FOLDER / "pickles").iterdir())


@pytest.fixture(scope="module")
def objects_today() -> dict[str, Any]:
    return version.objects()


@pytest.mark.usefixtures("_no_old_modules_afterwards")
@pytest.mark.parametrize("name", PICKLES)
def test_pickles_load(name: str, objects_today: dict[str, Any]) -> None:
    data = (version.FOLDER / "pickles" / f"{name}.pkl").read_bytes()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)
        assert_same(pickle.loads(data), objects_today[name])


def assert_same(old: Any, new: Any) -> None:
    """Assert that two objects have one type and equal values, whatever their messages say."""
    # An array of actions carries more today: which set of actions it is from.
    assert isinstance(new, type(old))
    if isinstance(old, np.ndarray):
        np.testing.assert_allclose(old, new, rtol=1e-12, atol=1e-12)
    elif isinstance(old, brl.Diagnostic):
        assert (old.code, old.line, old.column) == (new.code, new.line, new.column)
    elif isinstance(old, brl.LevelError):
        assert_same(old.diagnostics, new.diagnostics)
    elif isinstance(old, brl.Level):
        # Levels of the gallery have got time limits since.
        assert (old.digest, old.replace(max_steps=new.max_steps).to_dict()) == (
            new.digest,
            new.to_dict(),
        )
    elif isinstance(old, brl.Suite):
        assert [old[n].digest for n in range(3)] == [new[n].digest for n in range(3)]
    elif isinstance(old, list | tuple):
        assert len(old) == len(new)
        for one, other in zip(old, new, strict=True):
            assert_same(one, other)
    elif isinstance(old, dict):
        assert old.keys() == new.keys()
        for key, value in old.items():
            assert_same(value, new[key])
    elif isinstance(old, EnvSpec):
        # A level of a project may have the name of one of the gallery.
        others = {"kwargs": old.kwargs, "max_episode_steps": old.max_episode_steps}
        assert told(old) == told(new) | others
        assert old.kwargs == {**new.kwargs, "level": new.kwargs["level"].removeprefix("gallery/")}
    elif dataclasses.is_dataclass(old):
        for field in dataclasses.fields(old):
            # Version 0.1 did not know where a level was found, nor results their level.
            if field.name not in ("path", "origin", "level", "levels", "run"):
                assert_same(getattr(old, field.name), getattr(new, field.name))
    elif isinstance(old, float):
        assert old == pytest.approx(new, rel=1e-12, nan_ok=True)
    elif not isinstance(old, Path):
        assert old == new


def told(spec: EnvSpec) -> dict[str, Any]:
    """Return what version 0.1 told about an environment: it knew no thresholds."""
    given: dict[str, Any] = json.loads(spec.to_json())
    functions = ("reward_threshold", "entry_point", "vector_entry_point")
    return {name: value for name, value in given.items() if name not in functions}


# -- environments ----------------------------------------------------------------------------


@pytest.mark.parametrize("name", recorded("env-specs.json"))
def test_specs_make_their_environments(name: str) -> None:
    brl.register_babyrobot()
    spec = EnvSpec.from_json(recorded("env-specs.json")[name])
    if name.endswith("(vector)"):
        del spec.kwargs["vectorization_mode"]
        envs: Any = gymnasium.make_vec(spec, num_envs=spec.kwargs.pop("num_envs"))
        assert envs.reset(seed=1)[0].shape == (2, 2)
    else:
        env: Any = gymnasium.make(spec)
        assert env.observation_space.contains(env.reset(seed=1)[0])
        assert told(env.spec) == told(spec)
    gymnasium.registry.pop("BabyRobot-v0")


def test_seeds_give_the_episodes_that_they_gave() -> None:
    found = version.episodes()
    for name, episode in recorded("episodes.json").items():
        assert found[name] == episode, name


# -- levels ----------------------------------------------------------------------------------


def test_digests_are_what_they_were() -> None:
    digests = recorded("digests.json")
    assert version.digests().items() >= digests["levels"].items()
    assert version.suite_digests() == digests["suites"]


def test_share_codes_are_what_they_were() -> None:
    for name, code in recorded("share-codes.json").items():
        old, new = brl.load(code), brl.load(name)
        assert old.share_code() == code
        assert old.digest == new.digest
        # Levels of the gallery have got time limits since.
        assert old.replace(max_steps=new.max_steps).share_code() == new.share_code()


# -- names and signatures --------------------------------------------------------------------


@pytest.mark.parametrize(("name", "old"), recorded("names.json").items())
def test_public_names_take_what_they_took(name: str, old: Any) -> None:
    new = version.described(name)
    renamed = RENAMED.get(name, {})
    if not isinstance(old, dict):
        assert_takes(old, new, renamed, name)
        return
    assert_takes(old["class"], new["class"], renamed, name)
    for member, parameters in old["members"].items():
        place = f"{name}.{member}"
        if place in REMOVED_MEMBERS:
            continue
        assert member in new["members"], f"{place} is gone"
        assert_takes(parameters, new["members"][member], RENAMED.get(place, {}), place)


def assert_takes(old: Any, new: Any, renamed: dict[str, str], place: str) -> None:
    """Assert that what could be called with some arguments can be called with them still."""
    if not isinstance(old, list):
        assert new == old, place
        return
    wanted = [[renamed.get(name, name), kind, default] for name, kind, default in old]
    positional = [each[0] for each in new if each[1] == "POSITIONAL_OR_KEYWORD"]
    assert (
        positional[: len(wanted)]
        == [name for name, kind, _ in wanted if kind == "POSITIONAL_OR_KEYWORD"][: len(positional)]
    ), place
    for parameter in wanted:
        assert parameter in new, f"{place}: {parameter[0]}"
    added = [each for each in new if each not in wanted]
    assert all(default is not None for _, kind, default in added if "VAR_" not in kind), place


# -- the command -----------------------------------------------------------------------------


@pytest.mark.parametrize(("name", "old"), recorded("commands.json").items())
def test_commands_take_what_they_took(name: str, old: Any) -> None:
    new = version.commands()[name]
    assert len(new["arguments"]) == len(old["arguments"])
    for (required, count, _), (now_required, now_count, _) in zip(
        old["arguments"], new["arguments"], strict=True
    ):
        assert now_required <= required
        assert now_count in (count, -1)
    words = {word: choices for words, choices in new["options"].items() for word in words.split()}
    for option, choices in old["options"].items():
        for word in option.split():
            assert word in words, f"babyrobot {name} {word}"
            assert not words[word] or set(words[word]) >= set(choices), f"babyrobot {name} {word}"


@pytest.fixture
def call(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> version.Runner:
    def call(arguments: list[str], folder: Path) -> tuple[int, str]:
        monkeypatch.chdir(folder)
        result = run_here(arguments, environment(tmp_path))
        return result.status, result.out

    return call


def test_calls_end_as_they_did_and_give_the_same_json(tmp_path: Path, call: version.Runner) -> None:
    found = version.calls(tmp_path, call)
    for name, old in recorded("calls.json").items():
        assert found[name]["status"] == old["status"], name
        assert set(found[name].get("json", ())) >= set(old.get("json", ())), name


def test_old_names_of_rules_are_known(tmp_path: Path, call: version.Runner) -> None:
    # The call "lint settings" above has them in a settings file.
    for name in recorded("rules.json").values():
        assert call(["rule", name], tmp_path)[0] == 0, name


def test_a_pack_can_be_installed(tmp_path: Path, call: version.Runner) -> None:
    assert call(["install", str(version.FOLDER / "kept.brlpack")], tmp_path)[0] == 0
    _, shown = call(["show", "kept/first", "--format", "json"], tmp_path)
    assert json.loads(shown)["title"] == "First"
