"""What learning and strips show of themselves in notebooks."""

from __future__ import annotations

import dataclasses
import re
import xml.etree.ElementTree as ET
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.notebooks import assert_fits, assert_shows_numbers_only, last, shown, svgs, texts

import babyrobot_levels as brl


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
    with pytest.raises(ValueError, match="columns must be a whole number, at least 1, not 0"):
        brl.strip([level], columns=0)
    for wrong in ("maze", 3, np.zeros((4, 4)), dataclasses.replace(brl.solve(level), level=None)):
        with pytest.raises(ValueError, match="no picture can be made of this"):
            brl.strip([wrong])


@pytest.mark.parametrize(
    "make",
    [
        lambda: last(brl.value_iteration("puddles")),
        lambda: last(brl.q_learning("puddles", 20)),
        lambda: last(brl.monte_carlo("first-key", episodes=100)),
        lambda: brl.strip([brl.solve("puddles")]),
        lambda: brl.strip(
            [brl.load("puddles").to_svg(), '<svg viewBox="0 0 9 9"></svg>'], ["", "b"]
        ),
    ],
)
def test_results_show_pictures_that_fit_and_are_short_as_text(make: Any) -> None:
    assert_fits(make())


def test_a_result_whose_level_is_not_known_shows_its_numbers() -> None:
    assert_shows_numbers_only(dataclasses.replace(last(brl.value_iteration("puddles")), run=None))


def test_labels_of_a_strip_are_escaped() -> None:
    html, _ = shown(brl.strip([brl.load("puddles")], ["<script>alert(1)</script>"]))
    assert "<script>" not in html
    assert "&lt;script&gt;" in html


def test_a_sweep_stands_for_its_arrays_in_a_picture() -> None:
    level = brl.Level(version=1, size=(3, 2))
    sweep = last(brl.value_iteration(level))
    whole = level.to_svg(values=sweep, policy=sweep)
    assert whole == level.to_svg(values=sweep.values, policy=sweep.policy)
