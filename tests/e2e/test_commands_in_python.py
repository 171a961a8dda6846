"""Each command in Python: the function of its name gives what the command writes."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from support.sessions import environment, run_here

import babyrobot_levels as brl

pytestmark = pytest.mark.usefixtures("here")


def babyrobot(*arguments: str) -> str:
    done = run_here([*arguments], environment(Path.cwd()))
    assert done.status == 0, done.err
    return done.out


@pytest.mark.slow
def test_schema() -> None:
    for name in ("level", "suite", "theme", "pack", "play"):
        assert brl.schema(name) == json.loads(babyrobot("schema", name))
    brl.schema(path="schemas/level.schema.json")
    assert Path("schemas/level.schema.json").read_text("utf-8") == babyrobot("schema")
    with pytest.raises(FileExistsError, match="already exists"):
        brl.schema("level", "schemas/level.schema.json")
    brl.schema("theme", "schemas/level.schema.json", force=True)
    with pytest.raises(ValueError, match="not 'levels'; did you mean `level`"):
        brl.schema("levels")


def test_rule() -> None:
    found = brl.rule("BR503")
    assert found == brl.rule("inescapable-state")
    assert repr(found).startswith("<Rule BR503 inescapable-state: ")
    assert found.page in found._repr_markdown_()
    rules = json.loads(babyrobot("rule", "--format", "json"))
    assert [each.code for each in brl.rule()] == [each["code"] for each in rules]
    with pytest.raises(ValueError, match="unknown rule 'inescapable'"):
        brl.rule("inescapable")


@pytest.mark.slow
def test_share() -> None:
    assert brl.share("final-maze") + "\n" == babyrobot("share", "final-maze")
    page = "https://example.org/play.html"
    for answers in (True, False):
        options = () if answers else ("--no-answers",)
        shown = babyrobot("share", "frozen-lake", "--link", page, *options)
        assert brl.share("frozen-lake", page, answers=answers) + "\n" == shown
    with pytest.raises(ValueError, match="without blanks"):
        brl.share("final-maze", "my page")
    with pytest.warns(UserWarning, match="the maze is random"):
        brl.share("random-maze", page)


def test_resolve() -> None:
    assert brl.resolve("final-maze").maze is None
    level = brl.resolve("random-maze", "seven.yaml", maze_seed=7)
    babyrobot("resolve", "random-maze", "--maze-seed", "7", "-o", "there.yaml")
    assert Path("seven.yaml").read_text("utf-8") == Path("there.yaml").read_text("utf-8")
    assert brl.load("seven.yaml").digest == level.digest
    with pytest.raises(FileExistsError):
        brl.resolve("random-maze", "seven.yaml", maze_seed=7)
    with pytest.raises(ValueError, match="is not random"):
        brl.resolve("final-maze", maze_seed=7)
    with pytest.raises(brl.LevelError, match="random"):
        brl.resolve("random-maze")


def test_new_level() -> None:
    level = brl.new_level("vault", maze_seed=7, key=True, coins=3)
    made = Path("levels/vault.yaml").read_text("utf-8")
    babyrobot("new-level", "vault", "--maze-seed", "7", "--key", "--coins", "3", "--force")
    assert Path("levels/vault.yaml").read_text("utf-8") == made
    assert brl.load("vault") == level
    with pytest.raises(FileExistsError):
        brl.new_level("vault")
    with pytest.raises(ValueError, match="lower-case letters"):
        brl.new_level("My level")
    with pytest.raises(ValueError, match="template must be one of 'grid'"):
        brl.new_level("other", template="circle")
    with pytest.raises(brl.LevelError, match="unknown theme"):
        brl.new_level("other", theme="sea")
    with pytest.raises(brl.LevelError, match="must be at least 1"):
        brl.new_level("other", size=(0, 3))
    assert not Path("levels/other.yaml").exists()


def test_export_and_import() -> None:
    found = brl.export("frozen-lake", "frozen-lake")
    assert found.text == babyrobot("export", "frozen-lake", "--to", "frozen-lake")
    brl.export("glass-wall", path="wall.tmj")
    assert Path("wall.tmj").is_file()
    with pytest.raises(FileExistsError):
        brl.export("glass-wall", path="wall.tmj")
    with pytest.raises(ValueError, match="give the format"):
        brl.export("final-maze")
    Path("lake.txt").write_text(brl.export("frozen-lake", "frozen-lake").text, "utf-8")
    level = brl.import_("lake.txt", "lake.yaml")
    babyrobot("import", "lake.txt", "-o", "there.yaml")
    assert brl.load("lake.yaml").digest == brl.load("there.yaml").digest == level.digest
    assert Path("lake.yaml").read_text("utf-8") == Path("there.yaml").read_text("utf-8")
    with pytest.raises(ValueError, match="there is no format 'lake'"):
        brl.import_("lake.txt", format="lake")


def test_pack_install_uninstall() -> None:
    with pytest.raises(brl.PackError, match="there is no folder zoo"):
        brl.pack("zoo")
    Path("zoo").mkdir()
    with pytest.raises(brl.PackError, match=r"zoo cannot be packed: it has no pack\.yaml"):
        brl.pack("zoo")
    Path("zoo/lion.yaml").write_text("version: 1\nsize: [4, 3]\n", encoding="utf-8")
    about = "name: zoo\nversion: 1.0.0\ndescription: Animals.\n"
    Path("zoo/pack.yaml").write_text(about, encoding="utf-8")
    packed = brl.pack("zoo")
    assert packed.path == Path("zoo-1.0.0.brlpack")
    assert repr(packed) == "<Packed zoo-1.0.0.brlpack: 1 level>"
    with pytest.raises(FileExistsError):
        brl.pack("zoo")
    babyrobot("pack", "zoo", "-o", "there.brlpack")
    assert packed.path.read_bytes() == Path("there.brlpack").read_bytes() == packed.data
    done = brl.install(packed.path)
    assert repr(done) == "<Installation of zoo 1.0.0: 1 level>"
    assert brl.load("zoo/lion").size == (4, 3)
    assert brl.install("zoo-1.0.0.brlpack").contents is None
    assert brl.uninstall("zoo").name == "zoo"
    with pytest.raises(brl.LevelNotFoundError):
        brl.load("zoo/lion")
    Path("zoo/lion.yaml").write_text("version: 1\nsiz: [4, 3]\n", encoding="utf-8")
    with pytest.raises(brl.LevelError, match="BR201"):
        brl.pack("zoo", "other.brlpack")
