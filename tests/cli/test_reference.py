"""`cli.md`: generated, complete, and every example in it works."""

from __future__ import annotations

import inspect
import re
import shlex
import shutil
from pathlib import Path
from types import SimpleNamespace
from typing import Any
from zipfile import ZipFile

import numpy as np
import pytest
import typer
from command_reference import reference
from support.folders import write_files
from support.packs import zoo
from support.places import ROOT
from support.sessions import FILES, environment, run_here

import babyrobot_levels as brl
from babyrobot_levels.cli.commands import app
from babyrobot_levels.extensions.editor.server import EditorServer

TEXT = (ROOT / "cli.md").read_text(encoding="utf-8")
GROUP: Any = typer.main.get_command(app)
COMMANDS: dict[str, Any] = dict(GROUP.commands)


def section(name: str) -> str:
    found = re.search(rf"^## {re.escape(name)}\n(.*?)(?=^## |\Z)", TEXT, re.MULTILINE | re.DOTALL)
    assert found, f"cli.md says nothing of `babyrobot {name}`"
    return found[1]


WORLDS = {
    "setup.py": "setup = {'width': 4, 'walls': [((1, 1), 'E')]}",
    "lake.txt": "SFF\nFHG\n",
    "maze.txt": "#####\n#S E#\n#####\n",
    "collection.txt": "####\n#@.#\n####\n\n" * 7,
}
"""What the examples of `import` read."""


def prepare_zoo(arguments: list[str], variables: dict[str, str]) -> None:
    """Make what the examples of packs speak of: a pack, which is there as a file and installed."""
    folder = Path("zoo") if arguments != ["pack"] else Path()
    write_files(folder, zoo())
    calls = [["pack", "zoo"], ["install", "zoo-1.0.0.brlpack"]]
    for call in calls[: {"pack": 0, "install": 1}.get(arguments[0], 2)]:
        assert run_here(call, variables).status == 0


def prepare_plays(arguments: list[str]) -> list[str]:
    """Make the files of which the examples of recorded episodes and of agents speak."""
    shutil.copytree(FILES / "plays", "plays")
    for name in ("eve", "zoe"):
        Path("plays", f"{name}.brlplay").unlink()
    shutil.copy("plays/ada.brlplay", "ada.brlplay")
    shutil.copy(FILES / "agents.py", "agents.py")
    shutil.make_archive("class", "zip", "plays")
    Path("robots").mkdir()
    brl.load("frozen-lake").save("robots/frozen-lake.yaml")
    np.save("policy.npy", brl.solve("frozen-lake").policy)
    if "ppo.zip" in arguments:
        library = pytest.importorskip("stable_baselines3", reason="it is not installed")
        env = brl.load("frozen-lake").make(observation="vector")
        library.PPO("MlpPolicy", env).save("ppo.zip")
    files = [str(path) for path in Path("plays").glob("*")]
    at = arguments.index("plays/*.brlplay") if "plays/*.brlplay" in arguments else None
    return arguments if at is None else [*arguments[:at], *files, *arguments[at + 1 :]]


def prepare_class() -> None:
    """Make the files of which the examples of what a class hands in speak."""
    shutil.copytree(FILES / "plays", "plays", ignore=shutil.ignore_patterns("eve*", "zoe*"))
    shutil.copytree(FILES / "course", "robots")
    shutil.copytree(FILES / "handed-in", "handed-in")
    for name in ("moodle", "canvas"):
        shutil.make_archive(name, "zip", "handed-in")
    Path("gradebook.csv").write_text('Student,ID\nAda,1\nBen,2\n"Moe, Cid",77\n', "utf-8")


def examples() -> list[str]:
    blocks = re.findall(r"^```sh\n(.*?)^```", TEXT, re.MULTILINE | re.DOTALL)
    return [line for block in blocks for line in block.splitlines() if line]


def test_it_is_up_to_date() -> None:
    assert reference() == TEXT, "python scripts/renew.py cli.md"


def test_every_command_is_in_it_and_no_other() -> None:
    assert re.findall(r"^## (.+)$", TEXT, re.MULTILINE) == list(COMMANDS)
    for name in COMMANDS:
        assert f"| [`{name}`](#{name}) |" in TEXT


def test_every_option_and_argument_is_in_it_and_explained() -> None:
    for name, command in COMMANDS.items():
        rows = [line for line in section(name).splitlines() if line.startswith("| `")]
        labels = [row.split("` | ")[0][3:] for row in rows]
        assert all(len(row.split("` | ")[1]) > len("x |") for row in rows)
        parameters = [each for each in command.params if "--help" not in each.opts]
        assert len(labels) == len(parameters)
        for parameter in parameters:
            if parameter.param_type_name == "argument":
                assert f"[OPTIONS] {labels[0]}" in section(name)
                continue
            for flag in parameter.opts:
                assert any(flag in re.findall(r"--?[a-z-]+", label) for label in labels), flag
        first = (inspect.getdoc(command.callback) or "").split("\n\n")[0]
        assert " ".join(first.split()) in section(name)


SLOW = (
    "babyrobot compare four-rooms.yaml",
    "babyrobot dataset levels",
    "babyrobot course build",
    "babyrobot gallery final-maze",
    "babyrobot gallery levels --key",
    "babyrobot gallery levels -o site",
    "babyrobot gallery small-mazes",
    "babyrobot generate",
    "babyrobot sheet classics",
    "babyrobot solve classics",
)
"""How the examples begin that search or draw for long; of each command there are others."""


def slow_or_not(line: str) -> Any:
    is_slow = line.startswith(SLOW) or "-o walk.gif" in line
    return pytest.param(line, marks=[pytest.mark.sweep] if is_slow else [])


@pytest.mark.slow
@pytest.mark.parametrize("line", [slow_or_not(line) for line in examples()])
def test_every_example_runs(line: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    variables = environment(tmp_path)
    *before, last = line.split(" | ")
    given = b""
    for each in before:
        given = run_here(shlex.split(each)[1:], variables, given).out.encode()
        assert given
    program, *arguments = shlex.split(last)
    assert program == "babyrobot"
    if arguments[0] not in ("new-level", "pack"):
        # The others speak of the level that `new-level first` makes.
        assert run_here(["new-level", "first"], variables).status == 0
    if "MiniGrid-" in last:
        pytest.importorskip("minigrid", reason="the package minigrid is not installed")
    if arguments[0] == "compare" and "--seed" in arguments:
        _, level, other, *seed = arguments
        call = ["import", other, *seed, "-o", level]
        assert run_here(call, variables).status == 0
    if arguments[0] == "import" and not before and arguments[1] in WORLDS:
        Path(arguments[1]).write_text(WORLDS[arguments[1]], encoding="utf-8")
    if "mazes.zip" in arguments:
        with ZipFile("mazes.zip", "w") as archive:
            archive.writestr("maze.txt", "o---o---o\n| S   G |\no---o---o\n")
    if arguments[0] in ("pack", "install", "uninstall") or {"zoo/lion", "--packs"} & {*arguments}:
        prepare_zoo(arguments, variables)
    if arguments[:2] == ["course", "build"]:
        assert run_here(["course", "new", arguments[2]], variables).status == 0
    if arguments[0] in ("replay", "score") or "policy.npy" in arguments:
        arguments = prepare_plays(arguments)
    if arguments[0] == "check-plan":
        shutil.copytree(FILES / "agents-on-maps", ".", dirs_exist_ok=True)
    if arguments[0] == "grade":
        prepare_class()
    if "--watch" in arguments:
        # As if the level was never saved again.
        for module in ("lint", "preview"):
            each = f"babyrobot_levels.cli.{module}.each_change"
            monkeypatch.setattr(each, lambda files: [files()])
    if arguments[0] == "mcp":
        # As if its input ended at once, and whether its library is there or not.
        ended = SimpleNamespace(run=lambda: None)
        monkeypatch.setattr(brl, "mcp", lambda *_, **__: ended)
        monkeypatch.setattr("signal.signal", lambda *_: None)
    if arguments[0] == "edit":
        # As if the page was closed at once.
        monkeypatch.setattr(EditorServer, "run", EditorServer.close)
        monkeypatch.setattr("webbrowser.open", lambda address: True)
        # As if Python for browsers was downloaded.
        monkeypatch.setattr(
            "babyrobot_levels.extensions.editor.site.write_site", lambda *_: 18_000_000
        )
    result = run_here(arguments, variables, given)
    if arguments[0] == "play":
        # The call is right, but here is no terminal.
        assert result.err.startswith("error: `babyrobot play` needs a terminal")
        return
    assert result.status == 0, result
    told = result.err.splitlines()
    if arguments[0] in ("export", "import"):
        # What another format, or ours, has no place for.
        told = [line for line in told if not line.startswith("warning: ")]
    # Where files are, and how episodes end that do not reach an exit.
    meant = ("wrote ", "editing ", "the optimal policy ")
    assert [line for line in told if not line.startswith(meant)] == []


def test_there_are_examples_for_every_command() -> None:
    assert {line.split()[1] for line in examples()} == set(COMMANDS)
