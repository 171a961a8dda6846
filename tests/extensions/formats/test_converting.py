"""`import` and `export`: what becomes of files, and hostile ones."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest
from support import sessions
from support.conversions import SAMPLES, sample
from support.minigrids import recorded
from support.sessions import Result

import babyrobot_levels as brl

ESCAPE = "\x1b]0;owned\x07\x1b[31m\u202e"


pytestmark = pytest.mark.usefixtures("here")


def babyrobot(*arguments: str, given: bytes = b"") -> Result:
    result = sessions.babyrobot(*arguments, given=given)
    assert all(c.isprintable() or c == "\n" for c in result.out + result.err)
    return result


def test_strict_writes_nothing_if_anything_is_lost() -> None:
    Path("grid.txt").write_text(sample("minigrid")["KeyCorridorS3R2"], encoding="utf-8")
    result = babyrobot("import", "grid.txt", "-o", "level.yaml", "--strict")
    assert (result.status, result.out) == (1, "")
    assert "error: objects: 1 ball left out; in MiniGrid, in the way until moved" in result.err
    assert not Path("level.yaml").exists()
    assert babyrobot("import", "grid.txt", "-o", "level.yaml").status == 0
    assert brl.load("level.yaml").starts == ((2, 2),)


# -- environments of MiniGrid --------------------------------------------------------------------


@pytest.fixture
def without_minigrid(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let MiniGrid's environments be those that were recorded."""

    def made(env_id: str, seed: int, kwargs: dict[str, object] | None) -> object:
        assert (seed, kwargs) == (3, None)
        return recorded(env_id.removeprefix("minigrid:"))

    # The first imports the module: it must not find the other one replaced already.
    monkeypatch.setattr("babyrobot_levels.analysis.compare.made_minigrid", made)
    monkeypatch.setattr("babyrobot_levels.analysis.environments.made_minigrid", made)


@pytest.mark.usefixtures("without_minigrid")
@pytest.mark.parametrize("call", ["--from minigrid MiniGrid-DoorKey-8x8-v0",
                                  "minigrid:MiniGrid-DoorKey-8x8-v0"])  # fmt: skip
def test_an_environment_is_imported_by_its_id(call: str) -> None:
    result = babyrobot("import", *call.split(), "--seed", "3", "-o", "door-key.yaml")
    assert (result.status, result.out) == (0, "")
    assert result.err.splitlines() == [
        "warning: pickup: a key is taken by stepping onto it, and kept; in MiniGrid, by an action",
        "warning: toggle: holding its key opens a door; in MiniGrid, an action does",
        "wrote door-key.yaml (928 bytes)",
    ]
    level = brl.load("door-key.yaml")
    assert level.title == "MiniGrid-DoorKey-8x8, seed 3"
    assert [item.name for item in level.items] == ["yellow-key"]


@pytest.mark.usefixtures("without_minigrid")
def test_a_task_that_a_level_cannot_have_is_refused() -> None:
    result = babyrobot("import", "MiniGrid-PutNear-6x6-N2-v0", "--seed", "3")
    assert (result.status, result.out) == (1, "")
    assert result.err == (
        "MiniGrid-PutNear-6x6-N2-v0: error: `put the blue box near the red key`: in a level, "
        "nothing is put down\n"
    )


@pytest.mark.beside("compare")
def test_without_minigrid_it_says_how_to_get_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "minigrid", None)
    Path("level.yaml").write_text("version: 1\n", encoding="utf-8")
    for call in (
        ["import", "MiniGrid-DoorKey-8x8-v0"],
        ["compare", "level.yaml", "minigrid:MiniGrid-Empty-5x5-v0"],
    ):
        result = babyrobot(*call)
        assert (result.status, result.err) == (
            2,
            "error: the package `minigrid` is not installed; add it with `pip install minigrid`\n",
        )


def test_seeds_and_arguments_are_for_environments() -> None:
    Path("lake.txt").write_text("SF\nFG\n", encoding="utf-8")
    result = babyrobot("import", "lake.txt", "--kwargs", "{}")
    assert result.status == 2
    assert "--seed and --kwargs are for environments" in result.err
    assert babyrobot("import", "MiniGrid-Empty-5x5-v0", "--kwargs", "[").status == 2
    assert babyrobot("import", "MiniGrid-Empty-5x5-v0", "--slippery").status == 2
    assert babyrobot("import", "MiniGrid-Empty-5x5-v0", "--from", "tiled").status == 2


def test_a_file_comes_before_an_environment_of_its_name() -> None:
    Path("MiniGrid-Empty-5x5-v0").write_text("WGWGWG\nWG>>WG\nWGWGWG\n", encoding="utf-8")
    result = babyrobot("import", "MiniGrid-Empty-5x5-v0")
    assert result.out.startswith("# A text of MiniGrid's pprint_grid.\n")


@pytest.mark.usefixtures("without_minigrid")
@pytest.mark.beside("compare")
def test_a_level_is_compared_with_an_environment() -> None:
    babyrobot("import", "MiniGrid-LavaGapS5-v0", "--seed", "3", "-o", "gap.yaml")
    call = ["minigrid:MiniGrid-LavaGapS5-v0", "--seed", "3"]
    result = babyrobot("compare", "gap.yaml", *call)
    assert (result.status, result.out) == (
        0,
        f"""\
gap.yaml and minigrid:MiniGrid-LavaGapS5-v0 are the same MDP

states:      16 of 36 are reachable, all equal
transitions: 48, all equal
actions:     0 = left, 1 = right, 2 = forward
rewards:     not compared: MiniGrid's shrink with each step
digest:      {brl.load("gap.yaml").digest}
""",
    )
    other = brl.load("gap.yaml").replace(heading="S")
    other.save("south.yaml")
    result = babyrobot("compare", "south.yaml", *call)
    assert (result.status, result.out) == (
        1,
        """\
south.yaml and minigrid:MiniGrid-LavaGapS5-v0 are different MDPs

episodes start looking S in this level, looking E in MiniGrid
""",
    )


@pytest.mark.usefixtures("without_minigrid")
@pytest.mark.beside("compare")
def test_a_grid_with_objects_is_not_compared() -> None:
    Path("level.yaml").write_text("version: 1\n", encoding="utf-8")
    result = babyrobot("compare", "level.yaml", "minigrid:MiniGrid-DoorKey-8x8-v0", "--seed", "3")
    assert result.status == 2
    assert "the grid has objects (key, door)" in result.err


def test_the_schema_line_leads_to_the_schema_of_the_project() -> None:
    Path("schemas").mkdir()
    Path("schemas/level.schema.json").touch()
    Path("lake.txt").write_text("SF\nHG\n", encoding="utf-8")
    babyrobot("import", "lake.txt", "-o", "levels/lake.yaml")
    first = Path("levels/lake.yaml").read_text(encoding="utf-8").splitlines()[0]
    assert first == "# yaml-language-server: $schema=../schemas/level.schema.json"


def test_a_map_of_tiled_is_known_by_its_suffix() -> None:
    Path("glass.tmj").write_bytes((SAMPLES / "saved-by-tiled.tmj").read_bytes())
    assert babyrobot("import", "glass.tmj", "-o", "glass.yaml").err == (
        "wrote glass.yaml (649 bytes)\n"
    )
    assert brl.load("glass.yaml").digest == brl.load("glass-wall").digest
    assert babyrobot("lint", "glass.yaml").out == "1 file checked, clean\n"


def test_a_world_may_come_from_standard_input() -> None:
    exported = babyrobot("export", "frozen-lake", "--to", "frozen-lake").out
    call = ["import", "-", "--name", "lake", "-o", "lake.yaml"]
    result = babyrobot(*call, given=exported.encode())
    assert (result.status, result.err) == (0, "wrote lake.yaml (483 bytes)\n")
    assert brl.load("lake.yaml").digest == brl.load("frozen-lake").digest
    result = babyrobot("import", "-", given=b"SF\nFG\nF")
    assert (result.status, result.err) == (
        1,
        "<stdin>: error: row 3 of the map has 1 letters, the first has 2\n",
    )


def test_a_level_file_is_no_world_of_another_program() -> None:
    Path("lake.yaml").write_text("version: 1\n", encoding="utf-8")
    result = babyrobot("import", "lake.yaml")
    assert (result.status, result.err.splitlines()[0]) == (
        2,
        "error: lake.yaml is already a level file",
    )


def test_a_map_with_dots_and_an_exit_has_one_exit() -> None:
    Path("map.txt").write_text("######\n#S...#\n#..#E#\n######\n", encoding="utf-8")
    result = babyrobot("import", "map.txt")
    assert result.status == 0
    assert brl.loads(result.out).exits == ((3, 1),)
    assert result.err.startswith("map.txt:2:3: warning: `.`: read as free, because `E` is the exit")


@pytest.mark.slow
def test_a_map_that_has_no_room_in_a_file_is_told_what_has() -> None:
    Path("lake.txt").write_text("\n".join(["S" * 500] * 500), encoding="utf-8")
    result = babyrobot("import", "lake.txt")
    assert (result.status, result.out) == (1, "")
    assert result.err.startswith("lake.txt: error: the map is 500 by 500, with too much on it")
    assert "at most 30,000 starts" in result.err


def test_many_losses_are_not_all_told() -> None:
    walls = ", ".join("((0, 0), 'N')" for _ in range(100))
    Path("setup.py").write_text(f"{{'walls': [{walls}]}}", encoding="utf-8")
    told = babyrobot("import", "setup.py").err.splitlines()
    assert len(told) == 41
    assert told[-1] == "… and 60 more"


BYTES = {
    "binary": bytes(range(256)) * 20,
    "empty": b"",
    "huge": b"#" * (1 << 20) + b"#",
    "escape": f"SF{ESCAPE}\nFG".encode(),
    "escape in data": f'{{"{ESCAPE}": 1, "width": "{ESCAPE}"}}'.encode(),
    "unknown keywords": f"{{'{ESCAPE!r}': 1}}".replace("'\\x", '"\\x').encode(),
    "deep": b"[" * 100_000,
    "surrogate": b'{"title": "\\ud800", "width": 4, "grid": {"theme": "\\ud800"}}',
}


@pytest.mark.parametrize("form", [None, "babyrobot", "sokoban", "tiled", "minigrid"])
def test_whatever_is_imported_the_answer_is_in_words(form: str | None) -> None:
    for data in BYTES.values():
        Path("world").write_bytes(data)
        result = babyrobot("import", "world", *(["--from", form] if form else []))
        assert result.status == 0 or result.err


def test_a_file_name_cannot_steer_the_terminal() -> None:
    path = Path(f"{ESCAPE}.txt")
    path.write_text("#?", encoding="utf-8")
    assert babyrobot("import", str(path)).status == 2
    assert babyrobot("import", str(path), "--from", "sokoban").status == 1


def test_the_picture_of_tiles_is_not_written_to_standard_output() -> None:
    result = babyrobot("export", "default", "--to", "tiled")
    assert result.out.startswith("{\n")
    assert result.err == (
        "note: default-tiles.png, the picture of the tiles, is only written with -o FILE\n"
    )
    assert list(Path.cwd().iterdir()) == []


def test_pictures_are_those_of_preview() -> None:
    assert babyrobot("export", "default", "--to", "png", "-o", "a.png").status == 0
    assert babyrobot("preview", "default", "-o", "b.png").status == 0
    assert Path("a.png").read_bytes() == Path("b.png").read_bytes()


@pytest.mark.slow
def test_models_are_named_by_their_suffixes_and_need_their_package(
    here: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    result = babyrobot("export", "first-key", "-o", "key.prism")
    assert "max_steps: a PRISM module cannot hold it" in result.err
    assert "mdp\n" in Path("key.prism").read_text("utf-8")
    assert babyrobot("export", "first-key", "-o", "key.umb").status == 0
    assert babyrobot("export", "first-key", "-o", "key.umb").status == 2
    assert babyrobot("export", "first-key", "-o", "new.umb", "--strict").status == 1
    monkeypatch.setitem(sys.modules, "umbi.umb.umb_to_tar", None)
    result = babyrobot("export", "first-key", "--to", "umb", "-o", "new.umb")
    assert result.status == 2
    assert (
        "error: this format needs umbi\n  help: install the extra `umb`: pip install" in result.err
    )
    assert not Path("new.umb").exists()
