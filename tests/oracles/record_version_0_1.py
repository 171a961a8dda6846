"""Record what a version of the package offers and makes, to hold later versions against it.

The files in `version-0.1` were made at commit 8abb92b, from the top of the repository, by

    PYTHONPATH=CHECKOUT python tests/oracles/record_version_0_1.py

where CHECKOUT is a copy of the repository at that commit. `tests/e2e/test_compatibility.py` calls
the same functions with the code of today. Only public names are used here.
"""

from __future__ import annotations

import ast
import enum
import inspect
import json
import os
import pickle
import subprocess
import sys
import tempfile
import warnings
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np

import babyrobot_levels as brl

FOLDER = Path(__file__).with_name("version-0.1")

Runner = Callable[[list[str], Path], tuple[int, str]]
"""Runs the command in a folder and returns its status and its output."""

LEVEL = """\
version: 1
name: kept
size: [4, 3]
start: [0, 0]
exit: [3, 2]
walls: [{at: [1, 0], side: E}, {at: [2, 1], side: S, pass: 0.3}]
puddles: [{at: [1, 1], size: large}]
areas: [{at: [2, 0], color: gold, reward: -3}]
rewards: {exit: 5}
theme: {colors: {base: "#fff0e0"}}
"""
BROKEN = "version: 1\nsize: [3, 3]\nstart: [9, 9]\nwalls: [{at: [1, 1], side: right}]\n"

PACK = {
    "pack.yaml": "name: kept\nversion: 1.0.0\ndescription: Levels of an old pack.\n",
    "first.yaml": "version: 1\ntitle: First\ndescription: A first level.\n"
    "size: [3, 2]\nexit: [2, 1]\n",
}
"""The files of a small pack."""

SHARED = ("final-maze", "default", "glasshouse", "windy-gridworld", "teleport-pads", "areas")
PLAYED = (*SHARED[:4], "frozen-lake", "random-maze", "two-doors", "ice-rink")
STEPS = 20


# -- objects that are pickled ----------------------------------------------------------------


def objects() -> dict[str, Any]:
    """Return an object of each kind that one may keep in a pickle, by name."""
    level = brl.loads(LEVEL)
    env = gymnasium.make("babyrobot/final-maze-v0", observation="walls")
    values, policy = brl.solve(level).values, brl.solve(level).policy
    found = {
        "level": level,
        "gallery-level": brl.load("final-maze"),
        "suite": brl.load_suite("small-mazes"),
        "mdp": level.compile(),
        "grid": level.grid(),
        "solution": brl.solve(level),
        "evaluation": brl.evaluate(level, "random"),
        "simulation": brl.simulate(level, "random", episodes=10, seed=3),
        "metrics": brl.metrics(level),
        "certificate": brl.compare(level, level),
        "difference": brl.diff(level, brl.load("default").replace(max_steps=None)),
        "sweep": next(iter(brl.value_iteration(level))),
        "trials": next(iter(brl.q_learning(level, episodes=5, seed=1))),
        "level-info": brl.levels()[0],
        "action": brl.Action.EAST,
        "severity": brl.Severity.ERROR,
        "observation-space": env.observation_space,
        "action-space": env.action_space,
        "env-spec": env.spec,
        "arrays": (values, policy),
    }
    try:
        brl.loads(BROKEN)
    except brl.LevelError as error:
        found |= {"level-error": error, "diagnostic": error.diagnostics[0]}
    return found


# -- modules ---------------------------------------------------------------------------------


def modules() -> dict[str, list[str]]:
    """Return the names that each module of the package defines, by reading the sources."""
    home = Path(brl.__file__).parent
    found = {}
    for path in sorted(home.rglob("*.py")):
        parts = path.relative_to(home.parent).with_suffix("").parts
        name = ".".join(parts).removesuffix(".__init__")
        if "__main__" not in parts:
            found[name] = sorted(_defined(ast.parse(path.read_text(encoding="utf-8"))))
    return found


def _defined(tree: ast.Module) -> Iterator[str]:
    for node in tree.body:
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            yield node.name
        elif isinstance(node, ast.Assign | ast.AnnAssign):
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            yield from (target.id for target in targets if isinstance(target, ast.Name))


# -- names, signatures, commands -------------------------------------------------------------


def public_names() -> dict[str, Any]:
    """Return all public names: for what can be called its parameters, for classes their members."""
    return {name: described(name) for name in sorted(dir(brl))}


def described(name: str) -> Any:
    """Return what `public_names` has for a name."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)
        return _described(getattr(brl, name))


def _described(value: Any) -> Any:
    if not inspect.isclass(value):
        return _parameters(value) if callable(value) else type(value).__name__
    members = {
        name: _parameters(inspect.getattr_static(value, name))
        for name in sorted(dir(value))
        if not name.startswith("_") and not hasattr(_foreign_base(value), name)
    }
    return {"class": _parameters(value), "members": members}


def _foreign_base(value: type) -> type:
    """Return the nearest base class that is not of this package."""
    own = brl.__name__
    return next(base for base in value.__mro__ if not base.__module__.startswith(own))


def _parameters(value: Any) -> Any:
    value = getattr(value, "__func__", value)
    if not callable(value):
        return "attribute"
    try:
        parameters = inspect.signature(value).parameters.values()
    except (TypeError, ValueError):
        return "callable"
    return [
        [each.name, each.kind.name, None if each.default is each.empty else _default(each.default)]
        for each in parameters
    ]


def _default(value: Any) -> str:
    return repr(value) if isinstance(value, bool | int | float | str | None) else "object"


def commands() -> dict[str, Any]:
    """Return for each command its options, with the values that they take, and its arguments."""
    import typer

    from babyrobot_levels.cli.commands import app

    group: Any = typer.main.get_command(app)
    found = {}
    for name, command in group.commands.items():
        options, arguments = {}, []
        for parameter in command.params:
            kind = parameter.type_descriptor.annotation
            is_enum = inspect.isclass(kind) and issubclass(kind, enum.Enum)
            choices = [str(each.value) for each in kind] if is_enum else []
            if parameter.param_type_name == "argument":
                arguments.append([parameter.required, parameter.nargs, choices])
            else:
                words = sorted([*parameter.opts, *parameter.secondary_opts])
                options[" ".join(words)] = choices
        found[name] = {"options": options, "arguments": arguments}
    return found


CALLS: dict[str, list[str]] = {
    "version": ["--version"],
    "unknown command": ["fly"],
    "unknown option": ["list", "--wings"],
    "list": ["list", "--format", "json"],
    "list packs": ["list", "--packs", "--format", "json"],
    "show": ["show", "final-maze", "--format", "json"],
    "show unknown": ["show", "nowhere"],
    "solve": ["solve", "frozen-lake", "--format", "json"],
    "lint clean": ["lint", "clean.yaml", "--format", "json"],
    "lint": ["lint", "smelly.yaml", "--format", "json"],
    "lint unknown rule": ["lint", "clean.yaml", "--select", "BR999"],
    "lint settings": ["lint", "settings/level.yaml", "--format", "json"],
    "validate": ["validate", "clean.yaml", "--format", "json"],
    "validate broken": ["validate", "broken.yaml", "--format", "json"],
    "validate sarif": ["validate", "broken.yaml", "--format", "sarif"],
    "validate missing": ["validate", "missing.yaml"],
    "compare equal": ["compare", "final-maze", "final-maze", "--format", "json"],
    "compare different": ["compare", "final-maze", "default", "--format", "json"],
    "diff": ["diff", "maze", "maze-changed", "--format", "json"],
    "diff equal": ["diff", "maze", "maze", "--format", "json"],
    "format check": ["format", "--check", "broken.yaml"],
    "rule": ["rule", "--format", "json"],
    "rule of a code": ["rule", "BR503", "--format", "json"],
    "share": ["share", "final-maze"],
    "schema": ["schema"],
    "export": ["export", "frozen-lake", "--to", "frozen-lake"],
    "export strict": ["export", "final-maze", "--to", "sokoban", "--strict"],
    "resolve": ["resolve", "maze"],
    "preview": ["preview", "final-maze", "--format", "ascii"],
}


def calls(folder: Path, run: Runner) -> dict[str, Any]:
    """Return for each call of the command its status, and what its JSON is made of."""
    (folder / "settings").mkdir()
    (folder / "settings" / "pyproject.toml").write_text(_settings_text(), encoding="utf-8")
    (folder / "clean.yaml").write_text(PACK["first.yaml"], encoding="utf-8")
    for path in ("smelly.yaml", "settings/level.yaml"):
        (folder / path).write_text("size: [3, 2]\nversion: 1\nskid: 0.2\n", encoding="utf-8")
    (folder / "broken.yaml").write_text(BROKEN, encoding="utf-8")
    found: dict[str, Any] = {}
    for name, arguments in CALLS.items():
        status, out = run(arguments, folder)
        found[name] = {"status": status}
        if "json" in arguments:
            found[name]["json"] = keys_of(json.loads(out))
    return found


def _settings_text() -> str:
    return (FOLDER / "pyproject.toml").read_text(encoding="utf-8")


def run(arguments: list[str], folder: Path) -> tuple[int, str]:
    """Run the command in a folder, as a user who has nothing; return its status and its output."""
    package = str(Path(brl.__file__).parents[1])
    variables = {**os.environ, "HOME": str(folder), "XDG_DATA_HOME": str(folder)}
    done = subprocess.run(
        [sys.executable, "-m", "babyrobot_levels", *arguments],
        cwd=folder,
        env={**variables, "PYTHONPATH": package, "PYTHONUTF8": "1", "COLUMNS": "80"},
        capture_output=True,
        encoding="utf-8",
        check=False,
    )
    return done.returncode, done.stdout


def keys_of(value: Any, path: str = "") -> list[str]:
    """Return the paths of all keys in JSON; all entries of a list share one path."""
    found = set()
    if isinstance(value, Mapping):
        for key, each in value.items():
            found |= {f"{path}/{key}", *keys_of(each, f"{path}/{key}")}
    elif isinstance(value, list):
        for each in value:
            found |= set(keys_of(each, f"{path}[]"))
    return sorted(found)


# -- what levels come to ---------------------------------------------------------------------


def digests() -> dict[str, str]:
    """Return the digest of each level of the gallery."""
    found = {info.name: brl.load(info.name) for info in brl.levels()}
    seeded = {n: level.with_maze_seed(7) for n, level in found.items() if level.has_random_maze}
    return {name: level.digest for name, level in (found | seeded).items()}


def suite_digests() -> dict[str, list[str]]:
    """Return the digests of some levels of each suite of the gallery."""
    names = ("long-ways", "small-mazes", "wet-mazes")
    return {name: [brl.load_suite(name)[i].digest for i in (0, 1, 99)] for name in names}


def share_codes() -> dict[str, str]:
    """Return share codes of some levels."""
    return {name: brl.load(name).share_code() for name in SHARED}


def episodes() -> dict[str, Any]:
    """Return the first steps of seeded episodes of some levels, alone and as vectors."""
    found: dict[str, Any] = {}
    for name in PLAYED:
        env = gymnasium.make("babyrobot/Level-v0", level=name)
        found[name] = _steps(env)
        vector = gymnasium.make_vec("babyrobot/Level-v0", num_envs=3, level=name)
        found[f"{name} (vector)"] = _vector_steps(vector)
    found["small-mazes"] = _steps(gymnasium.make("babyrobot/Suite-v0", suite="small-mazes"))
    suite = gymnasium.make_vec("babyrobot/Suite-v0", num_envs=3, suite="small-mazes")
    found["small-mazes (vector)"] = _vector_steps(suite)
    return found


def _steps(env: Any) -> list[Any]:
    observation, info = env.reset(seed=11)
    found: list[Any] = [_plain(observation)]
    for step in range(STEPS):
        actions = np.flatnonzero(info["action_mask"])
        result = env.step(actions[step * 7 % len(actions)])
        info = result[4]
        found.append(_plain(result[:4]))
        if result[2] or result[3]:
            observation, info = env.reset()
            found.append(_plain(observation))
    env.close()
    return found


def _vector_steps(envs: Any) -> list[Any]:
    observation, info = envs.reset(seed=11)
    found: list[Any] = [_plain(observation)]
    for step in range(STEPS):
        rows = [np.flatnonzero(row) for row in info["action_mask"]]
        actions = [row[step * 7 % len(row)] if len(row) else 0 for row in rows]
        *result, info = envs.step(np.array(actions))
        found.append(_plain(result))
    envs.close()
    return found


def _plain(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {key: _plain(each) for key, each in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(each) for each in value]
    return value.tolist() if isinstance(value, np.ndarray | np.generic) else value


def env_specs() -> dict[str, str]:
    """Return the specs of some environments as JSON."""
    brl.register_babyrobot()
    made: dict[str, dict[str, Any]] = {
        "babyrobot/Level-v0": {"level": "final-maze"},
        "babyrobot/Level-v0 seeded": {"level": "random-maze", "max_episode_steps": 50},
        "babyrobot/final-maze-v0": {"observation": "index"},
        "babyrobot/frozen-lake-v0": {},
        "babyrobot/Suite-v0": {"suite": "small-mazes"},
        "BabyRobot-v0": {"width": 4, "height": 4},
    }
    found = {}
    for name, keywords in made.items():
        env: Any = gymnasium.make(name.split()[0], **keywords)
        found[name] = env.spec.to_json()
    vectors: dict[str, dict[str, Any]] = {
        "babyrobot/final-maze-v0": {},
        "babyrobot/Level-v0": {"level": "final-maze"},
        "babyrobot/Suite-v0": {"suite": "small-mazes"},
    }
    for env_id, keywords in vectors.items():
        envs: Any = gymnasium.make_vec(env_id, num_envs=2, **keywords)
        found[f"{env_id} (vector)"] = envs.spec.to_json()
    gymnasium.registry.pop("BabyRobot-v0")
    return found


# -- recording -------------------------------------------------------------------------------


def _write(name: str, value: Any) -> None:
    text = json.dumps(value, separators=(",", ":")).replace('},"', '},\n"').replace('],"', '],\n"')
    assert json.loads(text) == value
    FOLDER.joinpath(name).write_text(text + "\n", encoding="utf-8")


def record() -> None:
    """Write all files."""
    (FOLDER / "pickles").mkdir(exist_ok=True)
    for name, value in objects().items():
        (FOLDER / "pickles" / f"{name}.pkl").write_bytes(pickle.dumps(value, protocol=4))
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        rules = json.loads(run(["rule", "--format", "json"], folder)[1])
        names = [rule["name"] for rule in rules if rule["code"][:3] in ("BR5", "BR6")]
        lines = "".join(f'  "{rule}",\n' for rule in names)
        FOLDER.joinpath("pyproject.toml").write_text(
            f'[tool.babyrobot.lint]\nselect = ["ALL"]\nignore = [\n{lines}]\n', encoding="utf-8"
        )
        for file, text in PACK.items():
            (folder / "pack" / file).parent.mkdir(exist_ok=True)
            (folder / "pack" / file).write_text(text, encoding="utf-8")
        status, out = run(["pack", "pack", "-o", "kept.brlpack"], folder)
        assert status == 0, out
        FOLDER.joinpath("kept.brlpack").write_bytes((folder / "kept.brlpack").read_bytes())
        _write("calls.json", calls(folder, run))
        _write("rules.json", {rule["code"]: rule["name"] for rule in rules})
    _write("modules.json", modules())
    _write("names.json", public_names())
    _write("commands.json", commands())
    _write("digests.json", {"levels": digests(), "suites": suite_digests()})
    _write("share-codes.json", share_codes())
    _write("episodes.json", episodes())
    _write("env-specs.json", env_specs())


if __name__ == "__main__":
    record()
