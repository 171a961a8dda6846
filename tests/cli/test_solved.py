"""Answers in `babyrobot preview`: in pictures, and of levels that are hard to answer."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from pathlib import Path

import pytest
from support.sessions import Result, environment, run_here

from babyrobot_levels.analysis.solver.optimum import solve
from babyrobot_levels.library.catalogue import load

HEAD = "version: 1\nsize: [3, 1]\n"
CANCELLING = (
    HEAD + "start: [1, 0]\nexit: none\nblocked: [{at: [2, 0]}]\nrewards: {stay: -9, bump: -9}\n"
    "areas: [{at: [0, 0], reward: 1}, {at: [1, 0], reward: -1}]\n"
)
SVG = "{http://www.w3.org/2000/svg}"


def babyrobot(folder: Path, *arguments: str) -> Result:
    return run_here(list(arguments), environment(folder))


def written(folder: Path, text: str) -> str:
    path = folder / "mine.yaml"
    path.write_text(text, encoding="utf-8")
    return str(path)


def texts(svg: str) -> list[str]:
    return [element.text or "" for element in ET.fromstring(svg).iter(f"{SVG}text")]


def test_a_picture_says_what_the_cells_are_worth(tmp_path: Path) -> None:
    done = babyrobot(tmp_path, "preview", "frozen-lake", "--values", "--format", "svg")
    assert done.status == 0
    solution = solve("frozen-lake")
    worth = solution.values[solution.policy >= 0]
    shown = [f"{value:.2f}" for value in worth]
    legend = [f"{worth.min():.2f}", f"{worth.max():.2f}"]
    assert sorted(texts(done.out)) == sorted([*shown, *legend, "START", "EXIT"])


def test_a_picture_shows_policy_and_values_only_as_asked(tmp_path: Path) -> None:
    def picture(*options: str) -> str:
        return babyrobot(tmp_path, "preview", "frozen-lake", "--format", "svg", *options).out

    arrows = f'stroke="{load("frozen-lake").resolved_theme.colors.arrows}"'
    assert arrows not in picture("--values")
    assert arrows in picture("--policy")
    assert sorted(texts(picture("--policy"))) == ["EXIT", "START"]
    assert arrows in picture("--values", "--policy")
    assert "0.82" in texts(picture("--values", "--policy"))


def test_a_random_maze_is_solved_as_it_is_shown(tmp_path: Path) -> None:
    call = ("preview", "random-maze", "--maze-seed", "7", "--values", "--format", "svg")
    level = load("random-maze").with_maze_seed(7)
    shown = texts(babyrobot(tmp_path, *call).out)
    assert f"{solve(level).expected_return:g}" in shown


def test_what_pays_for_ever_is_shown(tmp_path: Path) -> None:
    name = written(tmp_path, HEAD + "areas: [{at: [0, 0], reward: 2}]\n")
    told = babyrobot(tmp_path, "preview", name, "--values", "--policy")
    assert (told.status, told.err) == (0, "")
    assert told.out.splitlines()[-1].split() == ["inf", "inf", "0.00"]
    picture = babyrobot(tmp_path, "preview", name, "--values", "--policy", "--format", "svg")
    assert picture.status == 0
    # The sign of infinity is drawn, so the legend alone has a number.
    assert sorted(texts(picture.out)) == ["0", "EXIT", "START"]


def test_an_unbounded_return_names_its_rule_and_cells(tmp_path: Path) -> None:
    name = written(tmp_path, HEAD + "areas: [{at: [0, 0], reward: 2}]\n")
    done = babyrobot(tmp_path, "solve", name)
    assert (done.status, "expected return: inf" in done.out) == (0, True)
    assert "around [0, 0], where rewards add up without bound (rule BR504" in done.err
    assert babyrobot(tmp_path, "solve", name, "--discount", "0.9").err == ""
    assert babyrobot(tmp_path, "solve", name, "--format", "json").err == ""


@pytest.mark.parametrize("command", ["preview --values", "preview --policy --format svg", "solve"])
def test_a_level_without_an_answer_says_why(command: str, tmp_path: Path) -> None:
    name, *options = command.split()
    done = babyrobot(tmp_path, name, written(tmp_path, CANCELLING), *options)
    assert (done.status, done.out) == (1, "")
    assert "a discount below 1" in done.err
    assert len(done.err.splitlines()) == 1


def test_values_of_wide_levels_are_left_to_pictures(tmp_path: Path) -> None:
    name = written(tmp_path, "version: 1\nsize: [17, 1]\n")
    done = babyrobot(tmp_path, "preview", name, "--values")
    assert (done.status, done.out) == (0, load(name).draw())
    assert "16 columns" in done.err
    assert "-15" in texts(babyrobot(tmp_path, "preview", name, "--values", "--format", "svg").out)
