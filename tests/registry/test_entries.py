"""Extensions of other distributions: what they add is used, and what is broken in them is told."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from support.places import DOCS, ROOT

PAGE = (DOCS / "extending.md").read_text(encoding="utf-8")
FILES = dict(re.findall(r"^<!-- file: (\S+) -->\n```\w+\n(.*?)^```", PAGE, re.M | re.S))

BROKEN = """\
from babyrobot_levels.registry.manifest import Command, Extension

WRONG = {"formats": {}}
UNTYPED = Extension(summary="", rules={"XX101": 3})
LISTED = Extension(summary="", formats=["dungeon"])
TAKEN = Extension(
    summary="Takes what is taken.",
    commands={"play": Command("Create", "nowhere:play", "Play."),
              "dig": Command("Create", "nowhere:dig", "Dig."),
              "away": Command("Create", "nowhere:away", "Go away.")},
    formats={"gone": "nowhere:GONE", "odd": "json:dumps"},
    pictures={"svg": "nowhere:SVG"},
    observations={"view": "nowhere:View"},
    methods={"solve": "nowhere:solve", "title": "nowhere:title"},
)
OWN = Extension(summary="", rules={"BR503": "nowhere:rule"})


def __getattr__(name):
    raise SystemExit(3)
"""

DRAWN = """\
from pathlib import Path

from babyrobot_levels.analysis.picture_options import StillOptions
from babyrobot_levels.analysis.picture_formats import STILL, PictureFormat
from babyrobot_levels.envs.observations.base import Observer
from babyrobot_levels.registry.manifest import Extension
from gymnasium import spaces

EXTENSION = Extension(
    summary="Dots, and a parity.",
    pictures={"dots": "drawn:DOTS"},
    observations={"parity": "drawn:Parity"},
)


def to_dots(level, path=None, *, scale=None, **shown):
    made = "." * level.width * int(scale or 1)
    if path is not None:
        Path(path).write_text(made)
    return made


DOTS = PictureFormat("dots", "dots", STILL, "text/plain", (".dots",), StillOptions, to_dots)


class Parity(Observer):
    @classmethod
    def space_of(cls, extent, observation):
        return spaces.Discrete(2)

    def at(self, state):
        return lambda: state % 2
"""

ENTRIES = """\
[babyrobot_levels.extensions]
missing = nowhere:EXTENSION
exits = broken_things:LEAVES
wrong = broken_things:WRONG
untyped = broken_things:UNTYPED
listed = broken_things:LISTED
taken = broken_things:TAKEN
own = broken_things:OWN
"""


def install(site: Path, name: str, entries: str, modules: dict[str, str]) -> None:
    """Put modules, and what a distribution says of itself, where Python finds packages."""
    for module, text in modules.items():
        (site / module).write_text(text, encoding="utf-8")
    info = site / f"{name}-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text(entries)


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder of packages: the one of the documentation, and broken ones."""
    site = tmp_path_factory.mktemp("site")
    entry = "[babyrobot_levels.extensions]\ndungeons = dungeons:EXTENSION\n"
    install(site, "dungeons", entry, {"dungeons.py": FILES["dungeons/dungeons.py"]})
    install(site, "drawn", entry.replace("dungeons", "drawn"), {"drawn.py": DRAWN})
    install(site, "things", ENTRIES, {"broken_things.py": BROKEN})
    (site / "cave.txt").write_text("<%..\n...>\n")
    return site


def run(site: Path, *words: str) -> tuple[int, str, str]:
    done = subprocess.run(
        [sys.executable, *words],
        cwd=site,
        env={**os.environ, "PYTHONPATH": f"{site}{os.pathsep}{ROOT}"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert "Traceback" not in done.stderr
    return done.returncode, done.stdout, done.stderr


def babyrobot(site: Path, *words: str) -> tuple[int, str, str]:
    return run(site, "-m", "babyrobot_levels", *words)


@pytest.mark.slow
def test_lists_say_what_there_is_from_where_and_what_cannot_be_used(site: Path) -> None:
    status, listed, told = babyrobot(site, "list", "--extensions")
    assert status == 0
    assert "command dig; format dungeon; rule DU101; method rock" in listed
    assert told.splitlines() == [
        "extension exits (things 1.0): SystemExit: 3",
        "extension listed (things 1.0): TypeError: formats must be a mapping of names, "
        "not ['dungeon']",
        "extension missing (things 1.0): ModuleNotFoundError: No module named 'nowhere'",
        "extension own (things 1.0): ValueError: rules has BR503: the package itself has BR…",
        "extension taken (things 1.0): play, one of its commands, is taken",
        "extension taken (things 1.0): dig, one of its commands, is taken",
        "extension taken (things 1.0): svg, one of its pictures, is taken",
        "extension taken (things 1.0): view, one of its observations, is taken",
        "extension taken (things 1.0): solve, one of its methods, is taken",
        "extension taken (things 1.0): title, one of its methods, is taken",
        "extension untyped (things 1.0): TypeError: rules has 'XX101': 3, which is no str",
        "extension wrong (things 1.0): TypeError: the entry point is no Extension, "
        "but of type dict",
    ]
    rows = json.loads(babyrobot(site, "list", "--extensions", "--format", "json")[1])
    others = [row for row in rows if not row["from"].startswith("babyrobot-levels ")]
    assert [row["name"] for row in others if row["fault"] is None] == ["drawn", "dungeons", "taken"]
    assert others[1]["adds"] == {
        "commands": ["dig"],
        "formats": ["dungeon"],
        "rules": ["DU101"],
        "methods": ["rock"],
    }


@pytest.mark.slow
def test_commands_are_run_listed_and_meant(site: Path) -> None:
    status, printed, _ = babyrobot(site, "dig", "--width", "3", "--height", "1", "--seed", "1")
    assert (status, printed) == (0, "<.>\n")
    overview = babyrobot(site, "--help")[1]
    assert re.search(r"^  dig +Print the map of a dungeon\.$", overview, re.M)
    assert "Did you mean 'dig' (print the map of a dungeon)?" in babyrobot(site, "digg")[2]
    # What the package has is not replaced, and what is broken breaks nothing else.
    assert (
        "Play a level in the terminal with the arrow keys." in babyrobot(site, "play", "--help")[1]
    )
    status, _, told = babyrobot(site, "away")
    assert status == 2
    assert told == (
        "error: away, one of the commands of the extension taken (things 1.0), cannot be used: "
        "ModuleNotFoundError: No module named 'nowhere'\n"
    )


@pytest.mark.sweep
def test_formats_are_recognised_and_chosen_by_name_and_by_suffix(site: Path) -> None:
    status, level, _ = babyrobot(site, "import", "cave.txt")
    assert status == 0
    assert "blocked:\n  - {at: [1, 0]}\n" in level
    (site / "cave.yaml").write_text(level)
    assert babyrobot(site, "import", "cave.txt", "--from", "dungeon")[1] == level
    assert babyrobot(site, "export", "cave.yaml", "--to", "dungeon")[1] == "<%..\n...>\n"
    babyrobot(site, "export", "cave.yaml", "-o", "other.dungeon", "--force")
    assert (site / "other.dungeon").read_text() == "<%..\n...>\n"
    assert babyrobot(site, "import", "other.dungeon")[1].count("\n") == level.count("\n")
    assert "'tiled', 'dungeon'" in babyrobot(site, "import", "cave.txt", "--from", "cave")[2]
    told = babyrobot(site, "import", "cave.txt", "--from", "odd")[2]
    assert told == (
        "error: odd, one of the formats of the extension taken (things 1.0), cannot be used: "
        "what is there is of type function\n"
    )


@pytest.mark.slow
def test_rules_run_where_they_are_selected(site: Path) -> None:
    (site / "rock.yaml").write_text(
        "version: 1\nsize: [3, 1]\nblocked: [{at: [0, 0]}, {at: [1, 0]}]\n"
        "start: [2, 0]\nexit: none\n"
    )
    found = "rock.yaml:3:10: warning DU101: more than half of the dungeon is rock"
    for words in (["--select", "DU101"], ["--select", "DU"], ["--select", "cramped-dungeon"]):
        status, report, _ = babyrobot(site, "lint", "rock.yaml", *words)
        assert status == 1
        assert found in report
    assert found in babyrobot(site, "lint", "rock.yaml", "--select", "ALL")[1]
    assert "DU101" not in babyrobot(site, "lint", "rock.yaml")[1]
    assert "More than half of the cells are blocked" in babyrobot(site, "rule", "DU101")[1]
    assert "unknown rule `DX`" in babyrobot(site, "lint", "rock.yaml", "--select", "DX")[2]


@pytest.mark.sweep
def test_pictures_are_made_by_name_and_by_suffix(site: Path) -> None:
    (site / "row.yaml").write_text("version: 1\nsize: [3, 1]\n")
    assert babyrobot(site, "preview", "row.yaml", "--format", "dots")[1] == "..."
    status, _, told = babyrobot(site, "preview", "row.yaml", "-o", "row.dots", "--scale", "2")
    assert (status, (site / "row.dots").read_text()) == (0, "......")
    assert told.startswith("wrote row.dots")
    assert "'html', 'dots'" in babyrobot(site, "preview", "row.yaml", "--format", "dot")[2]
    code = "import babyrobot_levels as brl; print(brl.preview('maze', format='dots').data)"
    assert run(site, "-c", code)[1] == "." * 8 + "\n"


@pytest.mark.sweep
def test_observations_are_those_of_environments(site: Path) -> None:
    code = (
        "import babyrobot_levels as brl; "
        "seen = brl.make('maze', observation='parity'); print(seen.reset()[0]); "
        "many = brl.LevelVectorEnv('maze', num_envs=2, observation=('parity', 'index')); "
        "print(many.reset()[0]['parity'])"
    )
    status, printed, told = run(site, "-c", code)
    assert (status, printed) == (0, "0\n[0 0]\n"), told
    wrong = "import babyrobot_levels as brl; brl.make('maze', observation='paritty')"
    told = subprocess.run(
        [sys.executable, "-c", wrong],
        env={**os.environ, "PYTHONPATH": f"{site}{os.pathsep}{ROOT}"},
        capture_output=True,
        text=True,
        check=False,
    ).stderr
    assert "'view', 'parity', not 'paritty'; did you mean `parity`?" in told


@pytest.mark.slow
def test_levels_have_the_methods(site: Path) -> None:
    code = "import babyrobot_levels as brl; print(brl.load('maze').rock(), hasattr(brl.Level, 'x'))"
    assert run(site, "-c", code)[:2] == (0, "0.0 False\n")


@pytest.mark.slow
def test_no_level_names_an_extension_to_be_loaded(site: Path) -> None:
    """Whatever a level says, and whatever is done with it, nobody's extension is imported."""
    (site / "named.yaml").write_text(
        "version: 1\ntitle: dig  # babyrobot: ignore[DU101]\nsize: [3, 1]\ntags: [dungeon, rock]\n"
    )
    code = (
        "import sys, babyrobot_levels as brl; level = brl.load('named.yaml'); brl.lint(level); "
        "level.to_svg(); level.solve(); brl.export(level, 'sokoban'); level.share_code(); "
        "print('dungeons' in sys.modules)"
    )
    assert run(site, "-c", code)[1] == "False\n"


@pytest.mark.slow
def test_the_package_of_the_page_is_installed_by_pip(tmp_path: Path) -> None:
    """As the page tells, in a fresh environment that has the package's dependencies at hand."""
    for name, text in FILES.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(text, encoding="utf-8")
    pip = [sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--no-build-isolation"]
    subprocess.run([*pip, "--target", tmp_path / "site", tmp_path / "dungeons"], check=True)
    site = tmp_path / "site"
    (console,) = re.findall(r"^```console\n(.*?)^```", PAGE, re.M | re.S)
    _, listed, *_ = re.split(r"^\$ .*\n", console, flags=re.M)[1:]
    rows = babyrobot(site, "list", "--extensions")[1].splitlines()
    assert [row for row in rows if row.startswith("dungeons")] == listed.splitlines()
    (site / "cave.txt").write_text(babyrobot(site, "dig", "--width", "6", "--height", "3")[1])
    assert babyrobot(site, "import", "cave.txt", "-o", "cave.yaml")[0] == 0
    assert babyrobot(site, "lint", "cave.yaml", "--select", "DU")[1] == "1 file checked, clean\n"
    babyrobot(site, "export", "cave.yaml", "-o", "cave.dungeon")
    assert (site / "cave.dungeon").read_text() == (site / "cave.txt").read_text()
