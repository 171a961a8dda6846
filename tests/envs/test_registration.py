"""Gymnasium knows the levels, whichever package is imported first, and at no cost till then."""

from __future__ import annotations

import importlib
import re
import sys
from pathlib import Path

import gymnasium
import pytest
from gymnasium import error
from gymnasium.envs.registration import registry
from support.combinations import swept
from support.playing import GALLERY, level_named
from support.subprocesses import python, run

from babyrobot_levels.envs.single import LevelEnv

OWN_IDS = ("babyrobot/Level-v0", "babyrobot/Suite-v0")
HEAVY = ("gymnasium", "numpy", "ipycanvas", "PIL", "rich", "pydantic", "yaml", "typer")

SHOW_IDS = """
from gymnasium.envs.registration import registry
print(*sorted(i for i in registry if i.startswith('babyrobot/')))
"""


# -- what is imported, and when --------------------------------------------------------------


def test_importing_the_package_and_looking_at_its_names_imports_nothing_heavy(
    tmp_path: Path,
) -> None:
    code = f"""
import sys, babyrobot_levels as brl
dir(brl), brl.__all__, brl.__version__, brl.LevelError, brl.LevelNotFoundError
print([n for n in {HEAVY} if n in sys.modules])
"""
    assert run(code, tmp_path) == "[]\n"


@pytest.mark.slow
def test_gymnasium_is_imported_when_something_is_played_and_not_before(tmp_path: Path) -> None:
    code = """
import sys, babyrobot_levels as brl
level = brl.load("default")
level.digest, level.compile(), level.draw(), brl.levels()
print("gymnasium" in sys.modules, "PIL" in sys.modules, "ipycanvas" in sys.modules)
level.make().reset()
print("gymnasium" in sys.modules, "PIL" in sys.modules, "ipycanvas" in sys.modules)
"""
    assert run(code, tmp_path) == "False False False\nTrue False False\n"


def test_the_adapter_of_stable_baselines_says_how_to_install_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setitem(sys.modules, "stable_baselines3", None)
    monkeypatch.delitem(sys.modules, "babyrobot_levels.envs.sb3", raising=False)
    with pytest.raises(ImportError, match="install the extra `sb3`: pip install"):
        importlib.import_module("babyrobot_levels.envs.sb3")


# -- the order of imports --------------------------------------------------------------------


IMPORTS = ("import babyrobot_levels, gymnasium",)
FURTHER_IMPORTS = (
    "import gymnasium, babyrobot_levels",
    "import babyrobot_levels, importlib.util as u; u.find_spec('gymnasium.envs')",
    "import babyrobot_levels; from gymnasium.envs.registration import registry",
    "import babyrobot_levels.envs.single",
    "import babyrobot_levels.envs.registration",
    "import babyrobot_levels, gymnasium.envs",
    "import gymnasium.envs, babyrobot_levels",
    "from gymnasium.envs.registration import registry; import babyrobot_levels",
    "import babyrobot_levels; from gymnasium import spaces",
    "import babyrobot_levels; from gymnasium.wrappers import TimeLimit",
    "from babyrobot_levels.library.level import Level; import gymnasium.vector",
    "import babyrobot_levels, importlib; importlib.import_module('gymnasium.envs')",
    "import babyrobot_levels, importlib.util as u; u.find_spec('gymnasium'); import gymnasium",
)


@pytest.mark.slow
@pytest.mark.parametrize("imports", swept(IMPORTS, FURTHER_IMPORTS))
def test_the_ids_are_known_after(imports: str, tmp_path: Path) -> None:
    known = run(imports + SHOW_IDS, tmp_path).split()
    assert known == sorted([*OWN_IDS, *(f"babyrobot/{n}-v0" for n in GALLERY)])


@pytest.mark.slow
def test_installing_again_and_reloading_change_nothing(tmp_path: Path) -> None:
    code = """
import importlib, sys
import babyrobot_levels
from babyrobot_levels.envs import registration
before = len(sys.meta_path)
registration.install()
importlib.reload(babyrobot_levels)
importlib.reload(registration)
assert len(sys.meta_path) == before
import gymnasium
from gymnasium.envs.registration import registry
count = len(registry)
registration.install()
importlib.reload(babyrobot_levels)
from babyrobot_levels.envs.registration import register_all
register_all()
assert len(registry) == count
print(len(sys.meta_path) - before)
"""
    assert run(code, tmp_path) == "-1\n"


@pytest.mark.slow
def test_gymnasiums_module_looks_as_if_nobody_had_been_there(tmp_path: Path) -> None:
    code = """
import gymnasium.envs as e
print(type(e.__loader__), type(e.__spec__.loader), e.__spec__.name, bool(e.__file__), e.__path__)
import inspect
print(inspect.getsource(e)[:40])
import importlib.resources
print(importlib.resources.files(e).joinpath("registration.py").is_file())
"""
    assert run("import babyrobot_levels\n" + code, tmp_path) == run(code, tmp_path)


def package(folder: Path, name: str, code: str) -> None:
    """Write a package of one module."""
    (folder / name).mkdir(parents=True)
    (folder / name / "__init__.py").write_text(code, "utf-8")


@pytest.mark.parametrize("fault", ["raise RuntimeError('torn cable')", "import torn_cable"])
def test_an_error_while_gymnasium_is_imported_is_told(fault: str, tmp_path: Path) -> None:
    package(tmp_path, "gymnasium", "from gymnasium import envs")
    package(tmp_path / "gymnasium", "envs", fault)
    code = "import babyrobot_levels, gymnasium"
    done = python("-c", code, cwd=tmp_path, path=tmp_path)
    assert done.returncode == 1
    assert "torn" in done.stderr.splitlines()[-1]


@pytest.mark.slow
def test_gymnasium_can_be_imported_after_an_attempt_that_failed(tmp_path: Path) -> None:
    code = """
import sys
import babyrobot_levels
sys.modules["numpy"] = None
try:
    import gymnasium
except ImportError:
    del sys.modules["numpy"]
else:
    raise AssertionError("nothing has failed")
import gymnasium
"""
    assert "babyrobot/Level-v0" in run(code + SHOW_IDS, tmp_path).split()


@pytest.mark.slow
def test_without_gymnasium_levels_are_read_all_the_same(tmp_path: Path) -> None:
    code = """
import sys
sys.modules["gymnasium"] = None
import babyrobot_levels as brl
print(brl.load("default").compile().num_states)
"""
    assert run(code, tmp_path) == "9\n"


# -- the ids ---------------------------------------------------------------------------------


@pytest.mark.slow
def test_each_level_of_the_gallery_has_its_id() -> None:
    for name in GALLERY:
        level = level_named(name)
        spec = gymnasium.spec(f"babyrobot/{name}-v0")
        assert spec.max_episode_steps == level.max_steps, name
        env = gymnasium.make(spec)
        bare = env.unwrapped
        assert isinstance(bare, LevelEnv)
        assert bare.level.name == name
        if not level.has_random_maze:
            assert bare.level.digest == level.digest


def test_no_other_ids_are_taken() -> None:
    ours = {name for name in registry if name.startswith("babyrobot/")}
    assert ours == set(OWN_IDS) | {f"babyrobot/{name}-v0" for name in GALLERY}


@pytest.mark.parametrize(
    ("asked", "told"),
    [
        ("babyrobot/final-maz-v0", "Did you mean: `final-maze`?"),
        ("babyrobot/Levle-v0", "Did you mean: `Level`?"),
        ("babyrobo/final-maze-v0", "Did you mean: `babyrobot`?"),
        ("babyrobot/final-maze-v1", "`v0`"),
    ],
)
def test_an_unknown_id_names_near_ones(asked: str, told: str) -> None:
    with pytest.raises(error.UnregisteredEnv, match=re.escape(told)):
        gymnasium.make(asked)
