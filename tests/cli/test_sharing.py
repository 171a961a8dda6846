"""Codes that are printed, and files that are written from them and from mazes."""

from __future__ import annotations

import re
from functools import partial
from pathlib import Path
from unittest.mock import patch

import pytest
from support import sessions
from support.codes import play_data
from support.folders import write_files
from support.sessions import Result

import babyrobot_levels as brl
from babyrobot_levels.analysis import sharing
from babyrobot_levels.analysis.sharing import link_fault
from babyrobot_levels.library.catalogue import load
from babyrobot_levels.library.level import Level, load_file
from babyrobot_levels.render import page

babyrobot = partial(sessions.babyrobot, status=0)


@pytest.fixture(autouse=True)
def folder(here: Path) -> Path:
    text = "version: 1\nsize: [3, 2]\nmaze: {seed: 1}  # small\ntheme: mine  # see themes/\n"
    files = {"levels/ours.yaml": text, "levels/themes/mine.yaml": "colors: {base: navy}\n"}
    return write_files(here, files)


@pytest.mark.parametrize(
    "base", ["https://example.org/play.html?speed=2", "file:///home/play.html"]
)
def test_a_link_is_a_code_and_what_a_page_plays(base: str) -> None:
    code = load("two-doors").share_code()
    link = babyrobot("share", "two-doors", "--link", base)
    assert re.fullmatch(rf"{re.escape(base)}#{re.escape(code)}~1\.\d+\.[\w-]+\n", link.out)
    assert link.err == ""
    assert babyrobot("share", link.out).out == f"{code}\n"


@pytest.mark.slow
@pytest.mark.parametrize("name", ["final-maze", "door-key"])
def test_a_link_without_answers_has_none(name: str) -> None:
    full = play_data(babyrobot("share", name, "--link", "p.html").out.strip())
    link = babyrobot("share", name, "--link", "p.html", "--no-answers")
    data = play_data(link.out.strip())
    assert link.err == ""
    assert {key for key in full if full[key] != data.get(key)} >= {"policy", "walker", "returns"}
    assert (data["policy"], data["walker"], data["best"]) == (None, None, "")
    assert not {"returns", "marks"} & set(data)
    assert "marks" not in data["picture"]
    layers = data["picture"]["layers"]
    assert not any(layers.get(name) for name in ("heat", "policy", "values", "beside"))
    refused = babyrobot("share", name, "--no-answers", status=2)
    assert "--no-answers is for links" in refused.err


@pytest.mark.parametrize("base", ["", "my page.html", "page.html\n", "page.html#"])
def test_what_cannot_begin_a_link_is_refused(base: str) -> None:
    refused = babyrobot("share", "two-doors", "--link", base, status=2)
    assert refused.out == ""
    assert "invalid --link" in refused.err


@pytest.mark.parametrize("base", ["example.org", "example.org/play.html", "localhost:8000/p/"])
def test_an_address_without_its_scheme_is_told_how_to_write_it(base: str) -> None:
    refused = babyrobot("share", "two-doors", "--link", base, status=2)
    assert f"browsers take that for a file; write https://{base}" in refused.err
    with pytest.raises(ValueError, match=f"link cannot be '{base}': browsers"):
        brl.share("two-doors", link=base)


@pytest.mark.parametrize("base", ["play.html", "pages/play.html", "../a.b/play", "play", "/p.html"])
def test_pages_beside_others_need_no_scheme(base: str) -> None:
    assert link_fault(base) is None


def test_what_is_too_long_for_a_link_is_not_solved(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sharing, "guide_of", None)
    monkeypatch.setattr(page, "page_data", None)
    level = {"version": 1, "description": " ".join(map(hex, range(99_999)))}
    with pytest.raises(ValueError, match="too large for a link: it would have"):
        brl.share(level, link="play.html")


def test_a_link_to_a_random_maze_says_which_one_the_page_plays() -> None:
    link = babyrobot("share", "random-maze", "--link", "play.html")
    assert link.err == (
        "the maze is random: the page plays the one of seed 0 (see `babyrobot resolve`)\n"
    )
    assert babyrobot("share", link.out).out == f"{load('random-maze').share_code()}\n"


@pytest.mark.sweep
def test_large_levels_have_links_without_best_moves_or_none(folder: Path) -> None:
    for side in (75, 125, 200):
        text = f"version: 1\nsize: [{side}, {side}]\nmaze: {{seed: 1}}\n"
        (folder / f"{side}.yaml").write_text(text, "utf-8")
    link = babyrobot("share", "75.yaml", "--link", "play.html")
    assert link.err == "the page shows no optimal moves: the link would be too long with them\n"
    assert len(link.out) < 30_000
    for side, what in ((125, "too large for a link"), (200, "too large for a page")):
        refused = babyrobot("share", f"{side}.yaml", "--link", "play.html", status=2)
        assert what in refused.err
        assert "no optimal moves" not in refused.err
        assert "help: send the level file" in refused.err
        assert refused.out == ""


def test_from_a_file_to_a_code_to_a_file(folder: Path) -> None:
    code = babyrobot("share", "levels/ours.yaml").out
    written = Result("", "wrote theirs.yaml (81 bytes)\n", 0)
    assert babyrobot("share", code, "-o", "theirs.yaml") == written
    assert (folder / "theirs.yaml").read_text("utf-8") == (
        "version: 1\nname: ours\nsize: [3, 2]\nmaze: {seed: 1}\ntheme:\n  colors: {base: navy}\n"
    )
    assert babyrobot("share", "levels/ours.yaml", "-o", "at-once.yaml").status == 0
    assert (folder / "at-once.yaml").read_text("utf-8") == (
        (folder / "theirs.yaml").read_text("utf-8")
    )
    assert babyrobot("diff", "levels/ours.yaml", "theirs.yaml").out == (
        "levels/ours.yaml and theirs.yaml are the same MDP\n"
    )


def test_a_resolved_level_finds_its_schema(folder: Path) -> None:
    def first_line() -> str:
        return (folder / "new/walls.yaml").read_text("utf-8").splitlines()[0]

    babyrobot("resolve", "final-maze", "-o", "new/walls.yaml")
    # A path of this machine would be wrong on every other one.
    assert first_line() == "version: 1"
    (folder / "schemas").mkdir()
    (folder / "schemas/level.schema.json").touch()
    babyrobot("resolve", "final-maze", "-o", "new/walls.yaml", "--force")
    assert first_line().endswith("$schema=../schemas/level.schema.json")
    babyrobot("resolve", "new/walls.yaml", "-o", "new/again.yaml")
    (folder / "schemas/level.schema.json").unlink()
    babyrobot("resolve", "new/again.yaml", "-o", "new/walls.yaml", "--force")
    assert "$schema" not in first_line()
    own = "# yaml-language-server: $schema=https://example.org/level.json"
    (folder / "own.yaml").write_text(f"{own}\nversion: 1\nmaze: {{seed: 1}}\n", "utf-8")
    babyrobot("resolve", "own.yaml", "-o", "new/walls.yaml", "--force")
    assert first_line() == own


def test_a_resolved_level_finds_its_theme_or_takes_it_along(folder: Path) -> None:
    (folder / "elsewhere").mkdir()
    walls = "version: 1\nsize: [3, 2]\n# small\nwalls:\n  - {at: [0, 0], side: S, length: 2}\n"
    call = ("resolve", "levels/ours.yaml", "-o")
    for path in ("levels/walls.yaml", "elsewhere/walls.yaml"):
        assert babyrobot(*call, path).out == ""
    here, there = folder / "levels" / "walls.yaml", folder / "elsewhere" / "walls.yaml"
    assert here.read_text("utf-8") == walls + "theme: mine  # see themes/\n"
    assert there.read_text("utf-8") == walls + "# see themes/\ntheme:\n  colors: {base: navy}\n"
    picture = load_file(folder / "levels" / "ours.yaml").to_svg()
    assert load_file(here).to_svg() == load_file(there).to_svg()
    # Their names are their titles, by which the pictures have other ids.
    named = r"<title.*</title>|(title|desc)-\w+"
    assert re.sub(named, "", load_file(here).to_svg()) == re.sub(named, "", picture)


@pytest.mark.slow
def test_walls_that_no_file_could_hold_are_not_written(folder: Path) -> None:
    (folder / "huge.yaml").write_text("version: 1\nsize: [300, 300]\nmaze: {seed: 1}\n", "utf-8")
    with patch.object(Level, "resolve", side_effect=AssertionError):
        # It is refused before all walls are written out.
        result = babyrobot("resolve", "huge.yaml", "-o", "walls.yaml", status=2)
    assert re.match(r"error: this maze has 44,\d{3} straight walls, too many for", result.err)
    assert not (folder / "walls.yaml").exists()


def test_a_level_too_large_for_a_page_is_refused_before_it_is_solved(folder: Path) -> None:
    (folder / "huge.yaml").write_text("version: 1\nsize: [300, 300]\nmaze: {seed: 1}\n", "utf-8")
    for call in (("preview", "-o", "page.html"), ("share", "--link", "https://example.org/p.html")):
        with patch("babyrobot_levels.analysis.solver.optimum.solve", side_effect=AssertionError):
            result = babyrobot(call[0], "huge.yaml", *call[1:], status=2)
        assert "a level of 300 x 300 cells is too large for a page" in result.err


@pytest.mark.parametrize("call", ["preview LEVEL", "compare LEVEL maze", "diff maze LEVEL"])
def test_commands_take_a_code_for_a_level(call: str) -> None:
    code = load("maze").share_code()
    # A code that was broken into lines is whole all the same.
    pasted = f" {code[:60]}\n  {code[60:]}\n"
    told = babyrobot(*[pasted if word == "LEVEL" else word for word in call.split()])
    expected = babyrobot(*call.replace("LEVEL", "maze").split())
    assert told.out
    assert told.out == expected.out or not call.startswith("preview")
