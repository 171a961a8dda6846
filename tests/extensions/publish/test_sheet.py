"""Hand-outs: what stands on the pages, where, what the key adds, and the three formats."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from itertools import islice, pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pypdfium2 as pdfium
import pytest
from playwright.sync_api import Page
from support.combinations import combined, selected
from support.markup import Reader
from support.scenes import bounds

import babyrobot_levels as brl
from babyrobot_levels.extensions.publish.sheet_pages import LINE
from babyrobot_levels.render.scene import shapes
from babyrobot_levels.render.scene.shapes import Rect, Scene, Text

NAMES = [
    "final-maze",
    "treasure-chests",
    "frozen-lake",
    "glass-wall",
    "river-crossing",
    "first-key",
]
ENDLESS = {
    "version": 1,
    "size": [2, 1],
    "exit": "none",
    "areas": [{"at": [0, 0], "reward": 1}],
    "rewards": {"stay": -5, "bump": -5},
}
"""A level of which no policy has an expected return."""


def texts(sheet: brl.Sheet) -> list[str]:
    """Return the lines of each page, joined."""
    return [" ".join(each.text for each in lines(page)) for page in sheet.pages]


def lines(page: Scene) -> Iterator[Text]:
    return (shape for shape in page.shapes if isinstance(shape, Text))


# -- what stands on the pages ----------------------------------------------------------------


@pytest.mark.slow
def test_pages_have_so_many_levels_with_number_title_name_and_digest() -> None:
    sheet = brl.sheet(NAMES, per_page=4)
    found = texts(sheet)
    assert len(found) == 2
    for number, name in enumerate(NAMES, 1):
        level, text = brl.load(name), found[number > 4]
        assert f"{number} {level.title}" in text
        assert f"{name}  {level.digest[:19]}" in text
    assert [f"Page {page} of 2" in text for page, text in enumerate(found, 1)] == [True, True]
    assert all("Exercise sheet" in text and "Name" in text and "Date" in text for text in found)


@pytest.mark.slow
def test_a_single_level_and_a_suite_are_levels_too() -> None:
    assert "The final maze" in texts(brl.sheet("final-maze"))[0]
    suite = brl.load_suite("small-mazes")
    assert len(brl.sheet(suite[:6], per_page=4).pages) == 2
    assert len(brl.sheet((brl.load(name) for name in NAMES), per_page=6).pages) == 1


def test_fewer_levels_than_have_room_share_the_whole_page() -> None:
    def width(sheet: brl.Sheet) -> float:
        return max(shape.width for shape in sheet.pages[0].shapes if isinstance(shape, Rect))

    assert width(brl.sheet("frozen-lake")) > 1.2 * width(brl.sheet(["frozen-lake"] * 4))


@pytest.mark.slow
def test_a_key_has_a_picture_for_each_set_of_held_things() -> None:
    (text,) = texts(brl.sheet(["first-key", "three-gems", "final-maze"], key=True))
    # In the order of the level, fewer before more, and no more than four.
    for words in ("nothing", "key", "coin", "sapphire", "ruby"):
        assert f"With {words}" in text
    assert "With emerald" not in text
    assert "12 other sets of held things are left out" in text
    assert "hatched: the robot cannot be there with what is held then (levels 1 and 2)" in text
    # Where there is no room, and on sheets that are no keys, it is one picture.
    for options in ({"values": True}, {"key": True, "per_page": 10}):
        shown = " ".join(texts(brl.sheet("first-key", **options)))
        assert ("With" in shown, "left out" in shown) == (False, False)
        assert "answers are those where episodes begin" in shown


@pytest.mark.slow
@combined(1, per_page=[1, 2, 4, 6, 9, 24], paper=["a4", "letter"], landscape=[False, True])
def test_nothing_leaves_the_page(per_page: int, paper: str, landscape: bool) -> None:
    long = brl.load("final-maze").replace(title="A title of many words " * 7)
    levels: list[Any] = [
        *NAMES,
        long,
        {"version": 1, "size": [20, 20]},
        {"version": 1, "size": [1, 30]},
    ]
    sheet = brl.sheet(levels, per_page=per_page, paper=paper, landscape=landscape, grids=2)
    for page in sheet.pages:
        assert (page.width > page.height) == landscape
        lefts, tops, rights, bottoms = zip(*map(bounds, page.shapes), strict=True)
        room = page.width - max(rights), page.height - max(bottoms)
        assert min(*lefts, *tops, *room) > 40


@pytest.mark.slow
@selected(
    [(6, False, False), (6, True, True)],
    per_page=[2, 6, 24],
    landscape=[False, True],
    key=[False, True],
)
def test_levels_do_not_overlap(per_page: int, landscape: bool, key: bool) -> None:
    """Each ends, with its name, above what is next in its column, the rules and the foot."""
    long = brl.load("glass-wall").replace(title="A title of many words " * 7)
    levels: list[Any] = [*NAMES, long, "maze"] * 3
    sheet = brl.sheet(levels, per_page=per_page, landscape=landscape, key=key)
    for page in sheet.pages:
        found = [*lines(page)]
        marks = [each for each in found if re.search("sha256|…$", each.text) and each.size == 9]
        heads = [each for each in found if each.text.isdigit() and each.fill == "#ffffff"]
        ends = [each.y - 8 for each in found if each.text == "Rules" or "Page" in each.text]
        assert len(marks) == len(heads)
        for head, mark in zip(heads, marks, strict=True):
            assert head.y < mark.y < min(ends)
            below = [each.y - 12 for each in heads if each.x == head.x and each.y > head.y]
            assert all(mark.y < top for top in below)


@pytest.mark.slow
def test_pictures_are_grey_unless_another_theme_is_asked_for() -> None:
    def is_grey(sheet: brl.Sheet) -> bool:
        pixels = pdfium.PdfDocument(sheet.to_pdf())[0].render().to_numpy().astype(int)
        return int((pixels.max(axis=2) - pixels.min(axis=2)).max()) < 8

    levels = ["treasure-chests", "teleport-pads", "final-maze"]
    assert is_grey(brl.sheet(levels))
    assert is_grey(brl.sheet(levels, key=True, grids=1))
    assert not is_grey(brl.sheet(levels, theme="default"))


# -- rules -----------------------------------------------------------------------------------


def test_rules_stand_once_with_the_levels_that_they_are_about() -> None:
    text = texts(brl.sheet(["frozen-lake", "final-maze", "maze"]))[0]
    assert text.count("start: episodes begin here") == 1
    assert "start: episodes begin here (level" not in text
    assert "exit: ends the episode, pays 1 (level 1)" in text
    assert re.search(r"exit: ends the episode, pays 0 \(levels 2\s+and 3\)", text)


def test_rules_of_one_level_need_no_number() -> None:
    text = texts(brl.sheet("frozen-lake"))[0]
    assert "exit: ends the episode, pays 1" in text
    assert "(level" not in text


@pytest.mark.slow
def test_descriptions_are_told_and_cut_where_they_are_long() -> None:
    assert "Cross the ice without falling" in texts(brl.sheet("frozen-lake"))[0]
    level = {"version": 1, "size": [3, 3], "description": "Once upon a time.\n" + "word " * 999}
    text = texts(brl.sheet([level] * 9, per_page=9))[0]
    assert "Once upon a time. word" in text
    assert "…" in text
    assert text.count("word") < 600


def test_rules_can_be_left_out() -> None:
    text = texts(brl.sheet("frozen-lake", rules=False))[0]
    assert "Rules" not in text
    assert "ends the episode" not in text


@pytest.mark.slow
def test_many_rules_stand_on_a_page_of_their_own_and_none_is_lost() -> None:
    levels = [
        {"version": 1, "size": [4, 4], "rewards": {"step": -number, "exit": number},
         "max_steps": number, "puddles": [{"at": [1, 1], "size": "large"}],
         "puddle_types": {"large": {"reward": -number, "skid": number / 50}}}
        for number in range(1, 25)
    ]  # fmt: skip
    sheet = brl.sheet(levels, per_page=24)
    found = texts(sheet)
    assert "Rules" not in found[0]
    assert "Name" not in found[1]
    behind = " ".join(found[1:])
    for number in range(2, 25):
        for rule in (f"each step: costs {number}", f"exit: ends the episode, pays {number}"):
            assert f"{rule} (level {number})" in behind
    assert "…" not in behind
    for page in sheet.pages:
        assert page.height - max(bounds(shape)[3] for shape in page.shapes) > 40


# -- answers ---------------------------------------------------------------------------------


def test_a_sheet_tells_no_answers_and_the_key_all_of_them() -> None:
    level = brl.load("final-maze")
    solution = brl.solve(level)
    [asked], [told] = texts(brl.sheet(level)), texts(brl.sheet(level, key=True))
    value = f"{solution.values[0, 1]:.2f}".replace("-", "\N{MINUS SIGN}")
    assert "Optimal return:" in asked
    assert "KEY" not in asked
    best = f"{solution.expected_return:.4g}".replace("-", "\N{MINUS SIGN}")
    for answer in (best, value):
        assert answer not in asked
        assert answer in told
    assert "KEY" in told
    assert "Name" not in told
    assert f"Optimal return: {best}, in 23.83 steps on average" in told


def test_the_key_says_how_often_the_exit_is_reached() -> None:
    text = texts(brl.sheet("frozen-lake", key=True))[0]
    best = "Optimal return: 0.7442 within 100 steps; 0.8235 without a limit, in 48.71 steps"
    assert best in " ".join(text.split())
    assert "it reaches an exit in 82.4 % of the episodes; 17.6 % end at [3, 1]" in text


def test_values_and_policy_can_be_shown_alone() -> None:
    solution = brl.solve("final-maze")
    value = f"{solution.values[0, 1]:.2f}".replace("-", "\N{MINUS SIGN}")
    plain = brl.sheet("final-maze")
    values, policy = brl.sheet("final-maze", values=True), brl.sheet("final-maze", policy=True)
    assert value in texts(values)[0]
    assert value not in texts(policy)[0]
    assert policy.pages != plain.pages
    assert "Optimal return:" not in texts(values)[0] + texts(policy)[0]


def test_a_level_without_a_solution_does_not_spoil_the_key() -> None:
    text = texts(brl.sheet([ENDLESS, "final-maze"], key=True, grids=1))[0]
    assert "No policy has an expected return." in text
    assert "Optimal return: \N{MINUS SIGN}36.58" in text
    assert "No policy has an expected return." in texts(brl.sheet(ENDLESS, values=True))[0]


def test_an_infinite_return_is_told_in_words() -> None:
    level = {"version": 1, "size": [2, 1], "exit": "none"}
    text = texts(brl.sheet([level], key=True))[0]
    assert "Optimal return: infinite, because costs add up without bound" in text
    forever = "Optimal return: 17.8; episodes go on for ever"
    assert forever in texts(brl.sheet("gridworld-3-5", key=True))[0]


def rules_to_write_on(page: Scene) -> list[float]:
    """Return how far down the lines of a page are on which answers are written, short ones not."""
    lines = [each for each in page.shapes if isinstance(each, shapes.Path) and each.stroke == LINE]
    found = [bounds(each) for each in lines if len(each.commands) == 2]
    return [top for left, top, right, _ in found if right - left > 200 and top > 140]


@pytest.mark.slow
@pytest.mark.parametrize("paper", ["a4", "letter"])
def test_there_are_lines_to_write_on_as_far_as_there_is_room(paper: str) -> None:
    (page,) = brl.sheet(["first-key", "maze"], per_page=2, paper=paper, lines=5).pages
    lines = rules_to_write_on(page)
    assert len(lines) == 10
    assert {round(after - before) for before, after in pairwise(lines[:5])} == {28}
    [alone] = brl.sheet("maze", per_page=1, paper=paper, lines=24).pages
    assert 10 < len(rules_to_write_on(alone)) <= 24
    # Levels keep their pictures and names, and keys have answers instead.
    [full] = brl.sheet(["maze"] * 24, per_page=24, paper=paper, lines=24, rules=False).pages
    assert max(bounds(shape)[3] for shape in full.shapes) < full.height - 40
    key = brl.sheet(["first-key", "maze"], per_page=2, paper=paper, lines=5, key=True)
    assert rules_to_write_on(key.pages[0]) == []


def test_grids_are_empty_and_in_the_key_hold_the_sweeps_of_value_iteration() -> None:
    [asked], [told] = (texts(brl.sheet("frozen-lake", grids=3, key=key)) for key in (False, True))
    sweeps = [*islice(brl.value_iteration("frozen-lake"), 1, 4)]
    for number, sweep in enumerate(sweeps, 1):
        assert f"Sweep {number}" in asked
        found = [f"{value:.2f}" for value in np.unique(sweep.values) if value > 0]
        assert found
        assert all(value in told for value in found)
    assert "0.33" not in asked
    assert "each value becomes that of the best action" in asked


def test_there_are_as_many_grids_when_nothing_changes_any_more() -> None:
    level = {"version": 1, "size": [2, 1], "exit": [1, 0]}
    text = texts(brl.sheet([level], grids=5, key=True))[0]
    assert [f"Sweep {number}" in text for number in range(1, 7)] == [True] * 5 + [False]


def test_grids_of_levels_with_things_are_those_of_the_beginning() -> None:
    text = texts(brl.sheet("first-key", grids=2, key=True))[0]
    sweep = next(islice(brl.value_iteration("first-key"), 2, None))
    assert f"Sweep 2 START EXIT \N{MINUS SIGN}{-np.nanmin(sweep.values[0]):.0f}" in text


# -- formats ---------------------------------------------------------------------------------


@pytest.mark.slow
def test_a_pdf_has_the_pages_with_texts_that_can_be_searched() -> None:
    sheet = brl.sheet(NAMES, title="Week 3", per_page=3)
    file = pdfium.PdfDocument(sheet.to_pdf())
    assert len(file) == 2
    assert file.get_metadata_dict()["Title"] == "Week 3"
    assert file[0].get_size() == pytest.approx((595.28, 841.89), abs=0.01)
    assert "Treasure chests" in file[0].get_textpage().get_text_bounded()
    assert sheet.to_pdf() == brl.sheet(NAMES, title="Week 3", per_page=3).to_pdf()


@pytest.mark.slow
def test_html_is_a_picture_per_page_that_asks_for_nothing() -> None:
    text = brl.sheet(NAMES, per_page=3).to_html()
    found = Reader(text).elements
    assert [tag for tag, _ in found].count("svg") == 2
    assert not {"script", "link", "img", "iframe"} & {tag for tag, _ in found}
    assert not any(key in ("href", "src") or key.startswith("on") for _, at in found for key in at)
    assert "default-src 'none'" in text
    for svg in re.findall(r"<svg.*?</svg>", text, re.DOTALL):
        root = ET.fromstring(svg)
        assert "Exercise sheet, page" in "".join(root.itertext())
    ids = [at["id"] for _, at in found if "id" in at]
    assert len(ids) == len({*ids})


@pytest.mark.slow
@pytest.mark.parametrize("landscape", [False, True])
def test_html_prints_page_by_page(page: Page, tmp_path: Path, landscape: bool) -> None:
    sheet = brl.sheet(NAMES, per_page=2, landscape=landscape, paper="letter")
    sheet.save(tmp_path / "sheet.html")
    page.goto((tmp_path / "sheet.html").as_uri())
    file = pdfium.PdfDocument(page.pdf(prefer_css_page_size=True))
    assert len(file) == len(sheet.pages) == 3
    for number in range(3):
        size = sorted(file[number].get_size())
        assert size == pytest.approx([612, 792], abs=1)
        assert f"Page {number + 1} of 3" in file[number].get_textpage().get_text_bounded()


@pytest.mark.slow
def test_files_are_named_by_their_pages(tmp_path: Path) -> None:
    two = brl.sheet([{"version": 1, "size": [2, 1]}] * 2, per_page=1)
    assert [*two.files(tmp_path / "two.png", "png")] == [tmp_path / f"two-{n}.png" for n in (1, 2)]
    brl.sheet(NAMES[:1]).save(tmp_path / "one.PNG")
    brl.sheet(NAMES[:1]).save(str(tmp_path / "new" / "one.pdf"))
    names = {each.relative_to(tmp_path).as_posix() for each in tmp_path.rglob("*.*")}
    assert names == {"one.PNG", "new/one.pdf"}
    size = b"".join(side.to_bytes(4, "big") for side in (1240, 1754))
    assert (tmp_path / "one.PNG").read_bytes()[16:24] == size


@pytest.mark.slow
def test_a_sheet_shows_itself_in_notebooks() -> None:
    sheet = brl.sheet(NAMES, per_page=3)
    bundle = sheet._repr_mimebundle_()
    assert bundle["text/html"].count("<img") == 2
    assert bundle["text/plain"] == "<Sheet 'Exercise sheet' of 2 pages>"


# -- what is refused, and what is not --------------------------------------------------------


HOSTILE = [
    "<script>alert(1)</script> & </title></svg>",
    "\u202egnp.exe\u202c",
    "(un)balanced) \\ <<",
    "😀 雪 مرحبا é" * 30,
    "x" * 900,
]


@pytest.mark.parametrize(
    "title", ["\U0001f469\u200d\U0001f467", "\u0645\u06cc\u200c\u0631\u0648\u062f"]
)
def test_joined_characters_of_titles_stay_joined(title: str) -> None:
    level = brl.load("frozen-lake").replace(title=title)
    sheet = brl.sheet([level], title=title)
    assert sheet.to_html().count(title) >= 3
    assert sheet.to_pdf()


@pytest.mark.parametrize("title", HOSTILE)
def test_titles_are_texts_whatever_they_say(title: str) -> None:
    level = brl.load("frozen-lake").replace(title=title, name="frozen-lake")
    sheet = brl.sheet([level], title=title)
    assert len(pdfium.PdfDocument(sheet.to_pdf())) == 1
    found = Reader(sheet.to_html()).elements
    assert [tag for tag, _ in found].count("svg") == 1
    assert "script" not in {tag for tag, _ in found}
    (page,) = sheet.pages
    for left, _, right, _ in map(bounds, page.shapes):
        assert min(left, page.width - right) > 40


@pytest.mark.parametrize(
    ("levels", "options", "message"),
    [
        ([], {}, "a sheet needs at least one level"),
        (["frozen-lake"] * 501, {}, "a sheet has at most 500 levels"),
        ([{"version": 1, "size": [101, 100]}], {}, "10,100 cells; a sheet shows levels of at most"),
        (["frozen-lake"], {"paper": "a5"}, "paper must be one of 'a4', 'letter', not 'a5'"),
        (["frozen-lake"], {"per_page": 0}, "per_page must be a whole number from 1 to 24, not 0"),
        (["frozen-lake"], {"per_page": 2.0}, "per_page must be a whole number"),
        (["frozen-lake"], {"lines": 25}, "lines must be a whole number from 0 to 24, not 25"),
        (["frozen-lake"], {"grids": 12}, "grids must be a whole number from 0 to 11, not 12"),
    ],
)  # fmt: skip
def test_wrong_arguments_are_refused(levels: Any, options: Any, message: str) -> None:
    with pytest.raises(ValueError, match=re.escape(message)):
        brl.sheet(levels, **options)


def test_other_errors_are_those_of_levels_and_pictures(tmp_path: Path) -> None:
    with pytest.raises(brl.LevelNotFoundError):
        brl.sheet(["no-such-level"])
    with pytest.raises(brl.LevelError, match="seed"):
        brl.sheet("random-maze")
    with pytest.raises(brl.LevelError, match="nowhere"):
        brl.sheet("final-maze", theme="nowhere")
    with pytest.raises(ValueError, match="must be one of 'pdf', 'html', 'png', not 'docx'"):
        brl.sheet("final-maze").save(tmp_path / "sheet.docx")
    assert not [*tmp_path.iterdir()]


def test_a_course_with_a_level_too_large_for_sheets_is_refused(tmp_path: Path) -> None:
    levels = tmp_path / "course" / "levels"
    levels.mkdir(parents=True)
    (levels / "wide.yaml").write_text("version: 1\nsize: [101, 100]\n")
    fields = (
        "name: c\nversion: 1.0.0\ndescription: One level.\nlevels: [{level: wide, points: 1}]\n"
    )
    (tmp_path / "course" / "pack.yaml").write_text(fields)
    with pytest.raises(brl.PackError, match="level wide has 10,100 cells; sheets show at most 10,"):
        brl.course(tmp_path / "course", tmp_path / "built")
    assert not (tmp_path / "built").exists()


def test_progress_is_told() -> None:
    told: list[tuple[int, int]] = []
    brl.sheet(NAMES[:3], progress=lambda done, total: told.append((done, total)))
    assert told == [(1, 3), (2, 3), (3, 3)]
