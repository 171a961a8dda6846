"""What results show of themselves in notebooks, and as text elsewhere."""

from __future__ import annotations

import base64
import dataclasses
import re
import xml.etree.ElementTree as ET
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from IPython.core.formatters import DisplayFormatter

import babyrobot_levels as brl
from babyrobot_levels.library.catalogue import LevelList
from babyrobot_levels.render.scene.marks import MARK

HOSTILE = "<script>alert(1)</script>&"


def shown(result: Any) -> tuple[str, str]:
    """Return what IPython makes of a result: HTML, and text."""
    bundle, _ = DisplayFormatter().format(result)  # type: ignore[no-untyped-call]
    assert set(bundle) == {"text/html", "text/plain"}
    return bundle["text/html"], bundle["text/plain"]


def svgs(html: str) -> list[str]:
    """Return the SVG pictures in HTML."""
    found = re.findall(r'src="data:image/svg\+xml;base64,([^"]+)"', html)
    return [base64.b64decode(each).decode() for each in found]


def texts(html: str) -> str:
    """Return the text of HTML, in which there must be no script."""
    root = ET.fromstring(f"<body>{re.sub('<img [^>]*>', '', html)}</body>")
    assert not [element for element in root.iter() if element.tag == "script"]
    return " ".join(" ".join(root.itertext()).split())


def last(items: Any) -> Any:
    *_, item = items
    return item


# -- values and policies -------------------------------------------------------------------


def test_a_solution_shows_its_picture_and_its_numbers() -> None:
    best = brl.solve("puddles")
    html, text = shown(best)
    assert svgs(html) == [brl.load("puddles").to_svg(values=best, policy=best)]
    number = f"{best.expected_return:.6g}".replace("-", "\N{MINUS SIGN}")
    assert f"Expected return {number}" in texts(html)
    assert text == repr(best)
    assert text.startswith("<Solution expected_return=")


@pytest.mark.parametrize(
    "make",
    [
        lambda: brl.evaluate("frozen-lake", "random"),
        lambda: brl.solve("two-levers").at(1),
        lambda: brl.solve("door-key", actions="turns"),
        lambda: last(brl.value_iteration("puddles")),
        lambda: last(brl.q_learning("puddles", 20)),
        lambda: last(brl.monte_carlo("first-key", episodes=100)),
        lambda: brl.metrics("two-levers"),
        lambda: brl.diff("puddles", "maze"),
        lambda: brl.strip([brl.solve("puddles")]),
        lambda: brl.strip(
            [brl.load("puddles").to_svg(), '<svg viewBox="0 0 9 9"></svg>'], ["", "b"]
        ),
    ],
)
def test_results_show_pictures_that_fit_and_are_short_as_text(make: Any) -> None:
    html, text = shown(make())
    assert svgs(html)
    for picture in svgs(html):
        ET.fromstring(picture)
    images = re.findall("<img [^>]*>", html)
    assert all("max-width: 100%" in image and re.search(' alt="[^"]+"', image) for image in images)
    assert len(text) < 400
    assert "array(" not in text


def test_a_result_whose_level_is_not_known_shows_its_numbers() -> None:
    for result in (
        dataclasses.replace(brl.solve("puddles"), level=None),
        dataclasses.replace(last(brl.value_iteration("puddles")), run=None),
        dataclasses.replace(brl.diff("puddles", "maze"), levels=None),
        brl.solve("door-key", actions="turns").at(0),
    ):
        html, _ = shown(result)
        assert svgs(html) == []
        assert len(texts(html)) > 40


def test_an_infinite_return_is_explained() -> None:
    level = brl.loads("version: 1\nsize: [3, 1]\nexit: none\n")
    assert "costs add up without bound" in texts(shown(brl.solve(level))[0])


# -- learning ------------------------------------------------------------------------------


def test_a_sweep_shows_the_way_to_the_optimum() -> None:
    sweeps = list(brl.value_iteration("puddles"))
    picture, curve = svgs(shown(sweeps[-1])[0])
    assert picture == brl.load("puddles").to_svg(values=sweeps[-1], policy=sweeps[-1])
    assert all(f">{name}<" in curve for name in ("estimate", "optimum", "sweep"))
    points = re.findall(r'points="([^"]+)"', curve)[0].split()
    assert len(points) == len(sweeps)
    # An earlier sweep shows what was known by then.
    early = svgs(shown(sweeps[3])[0])[1]
    assert len(re.findall(r'points="([^"]+)"', early)[0].split()) == 4


def test_trials_show_the_return_of_each_episode_and_a_mean() -> None:
    trials = last(brl.sarsa("puddles", 100))
    curve = svgs(shown(trials)[0])[1]
    assert all(f">{name}<" in curve for name in ("each episode", "mean of 5", "optimum", "episode"))
    lines = [line.split() for line in re.findall(r'points="([^"]+)"', curve)]
    assert [len(line) for line in lines] == [100, 96]


def test_there_is_no_line_to_reach_where_there_is_no_optimum() -> None:
    level = brl.loads(
        "version: 1\nsize: [3, 1]\nstart: [1, 0]\nexit: none\nblocked: [{at: [2, 0]}]\n"
        "rewards: {stay: -9, bump: -9}\nmax_steps: 20\n"
        "areas: [{at: [0, 0], reward: 1}, {at: [1, 0], reward: -1}]\n"
    )
    curve = svgs(shown(last(brl.q_learning(level, 10)))[0])[1]
    assert "optimum" not in curve


# -- metrics, differences, lists -----------------------------------------------------------


def test_metrics_are_a_table() -> None:
    found = brl.metrics("maze")
    text = texts(shown(found)[0])
    for name, value in found.to_dict().items():
        number = f"{value:.6g}".replace("-", "\N{MINUS SIGN}")
        assert f"{name.replace('_', ' ')} {number}" in text


def test_a_difference_marks_what_changed_in_both_pictures() -> None:
    before = brl.loads("version: 1\nsize: [4, 3]\n")
    walls = brl.loads("version: 1\nsize: [4, 3]\nwalls: [{at: [1, 1], side: E}]\n")
    wet = before.replace(puddles=[{"at": [2, 0], "size": "large"}])
    counts = []
    for after in (before, walls, wet):
        html, text = shown(brl.diff(before, after, limit=0))
        counts.append([picture.count(MARK) for picture in svgs(html)])
        assert text.count("\n") == 0
    assert counts == [[0, 0], [1, 1], [1, 1]]
    # Where there is no wall, dots stand for it.
    html = shown(brl.diff(before, walls))[0]
    dotted = [re.search(f'stroke="{MARK}"[^>]*dasharray', picture) for picture in svgs(html)]
    assert [each is not None for each in dotted] == [True, False]


def test_a_moved_exit_is_marked_where_it_is() -> None:
    level = brl.Level(version=1, size=(4, 3))
    one, two = svgs(shown(brl.diff(level, level.replace(exit=(0, 2))))[0])
    assert (one.count(MARK), two.count(MARK)) == (1, 1)
    assert [line for line in one.splitlines() if MARK in line] != [
        line for line in two.splitlines() if MARK in line
    ]


def written(folder: Path, count: int, title: str = "A level") -> None:
    for number in range(count):
        text = f"version: 1\nname: mine-{number:02}\ntitle: {title!r}\n"
        (folder / f"mine-{number:02}.yaml").write_text(text, "utf-8")


@pytest.mark.slow
def test_a_list_of_levels_is_a_table_with_at_most_fifty_pictures(here: Path) -> None:
    (here / "levels").mkdir()
    written(here / "levels", 60, HOSTILE)
    found = brl.levels()
    mine = LevelList(info for info in found if info.name.startswith("mine-"))
    html, text = shown(mine)
    assert html.count("<img ") == 50
    assert texts(html).count("alert(1)") == 60
    assert "<script>" not in html
    assert len(text.splitlines()) == 22
    assert text.splitlines()[0] == "60 levels"
    assert text.splitlines()[-1] == "  … and 40 more"
    # It is a list like any other.
    assert isinstance(found, list)
    assert mine[1:3] == [mine[1], mine[2]]
    assert shown(mine[1:3])[0].count("<img ") == 2


def test_a_level_of_a_list_shows_its_facts(here: Path) -> None:
    (here / "levels").mkdir()
    written(here / "levels", 1)
    (info,) = (info for info in brl.levels() if info.name == "mine-00")
    html, text = shown(info)
    assert html.count("<img ") == 1
    assert "Name mine-00 Title A level Size 3 × 3" in texts(html)
    assert text == "<LevelInfo 'mine-00': 3x3 'A level'>"
    info.path.unlink()
    assert "<img " not in shown(info)[0]


def test_texts_of_levels_are_escaped() -> None:
    level = brl.load("puddles").replace(title=HOSTILE)
    for result in (brl.solve(level), brl.metrics(level), brl.strip([level], [HOSTILE])):
        html, _ = shown(result)
        assert "<script>" not in html
        assert "&lt;script&gt;" in html
        assert all("<script>" not in picture for picture in svgs(html))


# -- strips --------------------------------------------------------------------------------


def test_a_strip_has_a_label_below_each_picture() -> None:
    sweeps = list(brl.value_iteration("puddles"))
    strip = brl.strip([sweeps[1], sweeps[3]])
    html, text = shown(strip)
    assert texts(html) == "Sweep 1 Sweep 3"
    assert text == "<Strip of 2 pictures: Sweep 1, Sweep 3>"
    rounds = brl.strip(brl.policy_iteration("puddles"))
    assert repr(rounds).endswith("pictures: Round 1, Round 2>")
    assert texts(shown(brl.strip([sweeps[1]], labels=["first"]))[0]) == "first"


def test_the_results_of_a_strip_have_one_scale() -> None:
    sweeps = list(brl.value_iteration("puddles"))
    together = svgs(shown(brl.strip([sweeps[1], sweeps[-1]]))[0])
    alone = [svgs(shown(brl.strip([each]))[0])[0] for each in (sweeps[1], sweeps[-1])]
    assert together[0] != alone[0]
    assert together[1] == alone[1]


def test_a_strip_takes_pictures_of_all_kinds(tmp_path: Path) -> None:
    level = brl.load("maze")
    env = level.make(render_mode="rgb_array")
    env.reset(seed=1)
    frame: Any = env.render()
    given = [level, level.to_svg(values=True), level.to_png(), frame, brl.solve(level)]
    strip = brl.strip(given)
    html, _ = shown(strip)
    assert html.count("<img ") == 5
    assert len(svgs(html)) == 3
    strip.save(tmp_path / "strip.svg")
    root = ET.parse(tmp_path / "strip.svg").getroot()
    images = [each.attrib for each in root.iter("{http://www.w3.org/2000/svg}image")]
    assert [float(each["x"]) > 0 for each in images] == [False, True, False, True, False]
    assert len({each["y"] for each in images}) == 3
    for each in images:
        assert float(each["x"]) + float(each["width"]) <= float(root.attrib["width"])
        assert float(each["y"]) + float(each["height"]) <= float(root.attrib["height"])


def test_the_number_of_columns_can_be_given() -> None:
    picture = brl.load("puddles").to_svg()
    assert "repeat(2, minmax(0, 1fr))" in shown(brl.strip(6 * [picture], columns=2))[0]
    assert "repeat(auto-fit, " in shown(brl.strip(6 * [picture]))[0]


def test_what_is_no_picture_is_refused() -> None:
    level = brl.load("puddles")
    with pytest.raises(ValueError, match="a strip needs at least one picture"):
        brl.strip([])
    with pytest.raises(ValueError, match="2 pictures need as many labels, not 1"):
        brl.strip([level, level], labels=["one"])
    with pytest.raises(ValueError, match="columns must be at least 1, not 0"):
        brl.strip([level], columns=0)
    for wrong in ("maze", 3, np.zeros((4, 4)), dataclasses.replace(brl.solve(level), level=None)):
        with pytest.raises(ValueError, match="no picture can be made of this"):
            brl.strip([wrong])
