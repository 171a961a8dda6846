"""Environments as the last line of a notebook's cell, bare and in Gymnasium's wrappers."""

from __future__ import annotations

from pathlib import Path

import pytest
from support.subprocesses import run

SHELL = """
from IPython.core.interactiveshell import InteractiveShell
shell = InteractiveShell.instance()
shell.history_manager.enabled = False
def shown(thing):
    return shell.display_formatter.format(thing)[0]
import babyrobot_levels as brl
"""
SVG, TEXT = "image/svg+xml", "text/plain"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder that is IPython's as well."""
    monkeypatch.setenv("IPYTHONDIR", str(tmp_path))
    return tmp_path


@pytest.mark.slow
def test_bare_and_wrapped_environments_show_what_they_see_and_others_what_they_did(
    folder: Path,
) -> None:
    code = f"""{SHELL}
from pathlib import Path
import gymnasium
from gymnasium.wrappers import TimeAwareObservation
before = shown(gymnasium.make("FrozenLake-v1"))
env = brl.load("frozen-lake").make(observation="index")
env.reset(seed=0)
env.step(2)
env.unwrapped.show_info({{"side_panel": ["so far"]}})
env.unwrapped.save("a.svg")
env.unwrapped.save("a.txt")
for each in (env, env.unwrapped, TimeAwareObservation(env)):
    bundle = shown(each)
    assert bundle["{SVG}"] == Path("a.svg").read_text()
    assert bundle["{TEXT}"] == Path("a.txt").read_text().rstrip()
    assert bundle["image/png"]
assert shown(gymnasium.make("FrozenLake-v1")) == before
class Own(gymnasium.Wrapper):
    def _repr_mimebundle_(self, include=None, exclude=None):
        return {{"text/plain": "my own"}}
for each in (gymnasium.make("FrozenLake-v1"), env):
    assert shown(Own(each)) == {{"text/plain": "my own"}}
"""
    run(code, folder)


@pytest.mark.slow
def test_a_formatter_of_the_users_own_stays(folder: Path) -> None:
    code = f"""{SHELL}
import gymnasium
formatter = shell.display_formatter.mimebundle_formatter
formatter.for_type(gymnasium.Wrapper, lambda env: {{"text/plain": "users"}})
assert shown(brl.load("default").make()) == {{"text/plain": "users"}}
"""
    run(code, folder)


@pytest.mark.slow
def test_without_ipython_nothing_of_it_is_imported(tmp_path: Path) -> None:
    code = """
import sys, babyrobot_levels as brl
env = brl.load("default").make(render_mode="rgb_array")
env.reset(), env.step(2), env.render()
print([name for name in ("IPython", "ipycanvas", "ipywidgets") if name in sys.modules])
"""
    assert run(code, tmp_path) == "[]\n"
