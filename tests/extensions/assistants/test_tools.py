"""The tools for assistants, without the protocol: what they return, refuse, and leave alone."""

from __future__ import annotations

import inspect
import os
from pathlib import Path

import numpy as np
import pytest
from support.hostile import BROKEN

import babyrobot_levels as brl
from babyrobot_levels.extensions.assistants.skill import language_page
from babyrobot_levels.extensions.assistants.tools import (
    MAX_FINDINGS,
    MAX_PLAYS,
    RefusedError,
    Tools,
)
from babyrobot_levels.render.templates import static
from babyrobot_levels.text.budget import COMMAND, within
from babyrobot_levels.text.errors import BabyRobotError

EXAMPLE = static("extensions/assistants/example.yaml")
TOOLS = Tools()


# -- what they return ------------------------------------------------------------------------


@pytest.mark.slow
def test_a_level_is_checked_and_mended() -> None:
    text = EXAMPLE.replace("best_steps: 12..16", "best_steps: 20")
    found = TOOLS.check(text)
    (finding,) = found.findings
    assert not found.is_clean
    assert (finding.code, finding.severity, finding.line) == ("BR540", "error", 21)
    assert "^^" in finding.excerpt in found.told
    assert TOOLS.check(EXAMPLE).is_clean
    assert TOOLS.check(EXAMPLE).told == "no findings"


def test_fixes_are_applied_to_the_text() -> None:
    found = TOOLS.check("version: 1\nwalls:\n- {at: [0, 0], side: east}\n", fix=True)
    assert found.fixed is not None
    assert "side: E" in found.fixed
    assert found.told.endswith(found.fixed)


def test_notes_are_not_to_be_mended() -> None:
    # The exit cuts off cells.
    notes = TOOLS.check("version: 1\nsize: [8, 5]\nmaze: {seed: 3}\n")
    assert [(each.code, each.severity) for each in notes.findings] == [("BR502", "info")]
    assert notes.is_clean


def test_of_many_findings_the_first_are_told() -> None:
    found = TOOLS.check("version: 1\n" + "".join(f"f{number}: 1\n" for number in range(90)))
    assert len(found.findings) == MAX_FINDINGS
    assert found.left_out == 90 - MAX_FINDINGS
    assert f"{found.left_out} more" in found.told


def test_a_level_is_formatted_with_its_comments() -> None:
    page = TOOLS.format("size: [4,1]   # short\nversion: 1\n")
    assert page.text == page.told == brl.format("size: [4,1]   # short\nversion: 1\n")


@pytest.mark.parametrize("name", ["frozen-lake", "first-key", "cliff-walking"])
def test_the_optimum_is_that_of_solve(name: str) -> None:
    solved, best = TOOLS.solve(name), brl.solve(name)
    assert solved.expected_return == best.expected_return
    assert solved.exit_probability == best.exit_probability
    assert solved.policy is not None
    assert solved.policy in solved.told
    drawn = solved.policy.splitlines()
    level = brl.load(name)
    assert len(drawn[0]) == 4 * level.width + 1
    part = best.at(0).policy
    for (y, x), action in np.ndenumerate(part):
        mark = drawn[2 * y + 1][4 * x + 2]
        if action >= 0 and mark in ".^>v<":
            assert mark == ".^>v<"[action + best.first_action]


def test_limits_and_endings_are_told() -> None:
    solved = TOOLS.solve("frozen-lake", within=100)
    assert solved.expected_return == brl.solve("frozen-lake", within=100).expected_return
    assert solved.ending is not None
    assert solved.ending in solved.told
    assert TOOLS.solve("final-maze", discount=0.5).expected_return == pytest.approx(
        brl.solve("final-maze", 0.5).expected_return
    )


def test_infinities_are_texts() -> None:
    text = "version: 1\nsize: [3, 1]\nareas: [{at: [1, 0], reward: 2}]\n"
    assert TOOLS.solve(text).expected_return == "inf"
    assert TOOLS.metrics(text).metrics["best_return"] == "inf"


def test_a_level_is_drawn_and_painted_within_limits() -> None:
    drawn = TOOLS.preview(EXAMPLE)
    assert drawn.told == brl.loads(EXAMPLE).draw()
    assert drawn.picture.startswith(b"\x89PNG")
    wide = TOOLS.preview("version: 1\nsize: [512, 8]\n").picture
    assert 0 < int.from_bytes(wide[16:20], "big") <= 810
    with pytest.raises(RefusedError, match="4,096 cells"):
        TOOLS.preview("version: 1\nsize: [513, 8]\n")


def test_metrics_are_those_of_the_level_with_reasons() -> None:
    measured = TOOLS.metrics("first-key")
    assert measured.metrics == brl.show("first-key")["metrics"]
    assert measured.digest == brl.load("first-key").digest
    assert "needs: ['key']" in measured.told
    closed = TOOLS.metrics("version: 1\nexit: none\nmax_steps: 9\n")
    assert "there is no exit" in closed.reasons["path_length"]
    assert TOOLS.metrics("version: 1\nmaze: {seed: random}\n").metrics == {}


@pytest.mark.slow
def test_levels_are_generated_by_conditions() -> None:
    made = TOOLS.generate(size="7x6", count=2, seed=4, keys=1, coins="1..2", detour="4..")
    levels = [brl.loads(text) for text in made.levels]
    assert len({level.digest for level in levels}) == 2
    for level in levels:
        assert level.size == (7, 6)
        assert (brl.metrics(level).detour or 0) >= 4
        assert brl.metrics(level).needs
    assert made == TOOLS.generate(size="7x6", count=2, seed=4, keys=1, coins="1..2", detour="4..")
    with pytest.raises(brl.LevelError, match="`keys` must be"):
        TOOLS.generate(keys="many")


def test_the_legend_of_a_policy_tells_what_cannot_occur() -> None:
    policy = TOOLS.solve("first-key").policy
    assert policy is not None
    assert "-        cannot occur while nothing is held" in policy.splitlines()


@pytest.mark.slow
def test_rules_and_the_language_are_explained() -> None:
    assert TOOLS.explain_rule("BR503").text == brl.rule("BR503").page
    assert TOOLS.language_reference().text == language_page()
    assert language_page().startswith("## Drawings")
    with pytest.raises(brl.UnknownRuleError):
        TOOLS.explain_rule("BR999")


# -- plays -----------------------------------------------------------------------------------


def test_a_play_is_that_of_the_text_world() -> None:
    begun = TOOLS.play_start("first-key", seed=3)
    world = brl.TextWorld("first-key")
    assert begun.text == world.reset(seed=3)
    for move in ("north", "east", "wait", "look"):
        told = TOOLS.play_move(begun.play, move)
        call = {"wait": world.wait, "look": world.look}.get(move)
        assert told.text == (call() if call else world.move(move))
        assert (told.total, told.regret) == (world.return_, None)
    assert begun.play in told.told


def test_regret_is_told_after_the_end() -> None:
    begun = TOOLS.play_start("version: 1\nsize: [3, 1]\n", within=2)
    TOOLS.play_move(begun.play, "north")
    over = TOOLS.play_move(begun.play, "east")
    assert over.is_over
    assert over.regret is not None
    assert "regret" in over.told


def test_a_level_that_is_too_large_for_a_sight_is_refused_before_it_is_compiled() -> None:
    # Its tables would be too large, which is not asked.
    wide = "version: 1\nsize: [1024, 1024]\nskid: 0.3\n"
    with within(COMMAND), pytest.raises(ValueError, match="too large for sight='map'"):
        TOOLS.play_start(wide)


def test_the_last_plays_are_kept() -> None:
    tools = Tools()
    names = [tools.play_start("version: 1\n").play for _ in range(MAX_PLAYS + 1)]
    assert tools.play_move(names[-1], "look").text
    assert tools.play_move(names[1], "look").text
    with pytest.raises(RefusedError, match=r"no such play.* play_start"):
        tools.play_move(names[0], "look")


# -- files -----------------------------------------------------------------------------------


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder beside which a level, a theme and settings lie."""
    monkeypatch.chdir(tmp_path)
    inside = tmp_path / "levels"
    inside.mkdir()
    for place in (inside, tmp_path):
        (place / "mine.yaml").write_text("version: 1\nsize: [4, 1]\n")
    (tmp_path / "pyproject.toml").write_text('[tool.babyrobot.lint]\nselect = ["none such"]\n')
    return inside


def test_without_a_folder_no_file_is_read_or_written(folder: Path) -> None:
    before = sorted(folder.parent.rglob("*"))
    for name in ("levels/mine.yaml", str(folder / "mine.yaml"), "mine", "/dev/zero", "x\0.yaml"):
        for tool in (TOOLS.check, TOOLS.solve, TOOLS.play_start, TOOLS.format):
            with pytest.raises(RefusedError, match="--folder"):
                tool(name)
    with pytest.raises(RefusedError, match="--folder"):
        TOOLS.format("version: 1\n", save="new.yaml")
    assert sorted(folder.parent.rglob("*")) == before


def test_in_a_folder_levels_are_read_and_written(folder: Path) -> None:
    tools = Tools(folder)
    assert tools.check("mine.yaml").is_clean
    assert tools.solve("mine.yaml").expected_return == -2
    page = tools.format("mine.yaml", save="other.yaml")
    assert (folder / "other.yaml").read_text() == page.text
    (folder / "themes").mkdir()
    (folder / "themes" / "own.yaml").write_text("colors: {base: white}\n")
    (folder / "mine.yaml").write_text("version: 1\ntheme: own\n")
    assert tools.check("mine.yaml").is_clean


def test_a_file_is_replaced_on_request_only_and_one_that_is_no_level_never(folder: Path) -> None:
    tools = Tools(folder)
    others = {
        "pack.yaml": "name: zoo\nversion: 1.0.0\ndescription: Levels.\n",
        "suite.yaml": "version: 1\nkind: suite\n",
        "theme.yaml": "colors: {base: white}\n",
        "list.yaml": "- 1\n",
        "torn.yaml": "version: 1\nsize: [4\n",
    }
    for name, text in others.items():
        (folder / name).write_text(text, "utf-8")
        for overwrite in (False, True):
            with pytest.raises(RefusedError, match=f"{name} is there already: it is no level"):
                tools.format("mine.yaml", save=name, overwrite=overwrite)
        assert (folder / name).read_text("utf-8") == text
    broken = "version: 1\nexit: [90, 90]\n"
    (folder / "broken.yaml").write_text(broken, "utf-8")
    with pytest.raises(RefusedError, match=r"broken.yaml is there already: overwrite replaces it"):
        tools.format("mine.yaml", save="broken.yaml")
    assert (folder / "broken.yaml").read_text("utf-8") == broken
    page = tools.format("mine.yaml", save="broken.yaml", overwrite=True)
    assert (folder / "broken.yaml").read_text("utf-8") == page.text


@pytest.mark.parametrize(
    "name", ["../mine.yaml", "link.yaml", "away/mine.yaml", "mine.txt", "x\0.yaml", "", "."]
)
def test_no_file_outside_the_folder_is_read_or_written(name: str, folder: Path) -> None:
    (folder / "link.yaml").symlink_to(folder.parent / "mine.yaml")
    (folder / "away").symlink_to(folder.parent)
    (folder / "mine.txt").write_text("version: 1\n")
    before = (folder.parent / "mine.yaml").read_bytes()
    tools = Tools(folder)
    with pytest.raises(RefusedError, match="below the folder"):
        tools.check(name)
    with pytest.raises(RefusedError, match="below the folder"):
        tools.format("version: 1\n", save=name)
    with pytest.raises(RefusedError, match="below the folder"):
        tools.check(str(folder.parent / "mine.yaml"))
    assert (folder.parent / "mine.yaml").read_bytes() == before


def test_themes_of_a_pack_around_the_folder_are_not_read(folder: Path) -> None:
    (folder.parent / "pack.yaml").write_text("name: zoo\nversion: 1.0.0\n")
    (folder.parent / "themes").mkdir()
    (folder.parent / "themes" / "own.yaml").write_text("colors: {base: white}\n")
    (folder / "mine.yaml").write_text("version: 1\ntheme: own\n")
    assert brl.lint(folder / "mine.yaml", select=["BR5"]) == []
    assert [each.code for each in Tools(folder).check("mine.yaml").findings] == ["BR401"]


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no pipes with names")
def test_a_pipe_is_no_level(folder: Path) -> None:
    os.mkfifo(folder / "pipe.yaml")
    with pytest.raises(brl.LevelError, match="BR101"):
        Tools(folder).check("pipe.yaml")


@pytest.mark.parametrize("tool", [TOOLS.check, TOOLS.format, TOOLS.solve])
def test_a_suite_that_names_files_is_refused(tool: object, folder: Path) -> None:
    text = "version: 1\nkind: suite\nlevels:\n  - {file: levels/mine.yaml}\n"
    with pytest.raises(RefusedError, match="one level"):
        tool(text)  # type: ignore[operator]


# -- strangers -------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "name", ["binary", "two MiB", "a bomb of aliases", "brackets", "a long line", "7 movers"]
)
def test_a_hostile_text_is_answered(name: str) -> None:
    _, made = BROKEN[name]
    text = made().decode("utf-8", "surrogateescape")
    try:
        found = TOOLS.check(text)
    except BabyRobotError:
        return
    assert not found.is_clean
    with pytest.raises(BabyRobotError):
        TOOLS.solve(text)


@pytest.mark.parametrize("text", ["", "\n", "a: b", "[1]\n", "brl1.zzzz", "\ud800\n", "x" * 5000])
def test_nonsense_is_answered(text: str) -> None:
    with pytest.raises(BabyRobotError):
        TOOLS.solve(text)


def test_every_tool_is_described() -> None:
    for name, tool in vars(Tools).items():
        if not name.startswith("_"):
            assert len((inspect.getdoc(tool) or "").split()) > 5
