"""The wall of a gallery as HTML: tiles, filters, and what a page without answers keeps back."""

from __future__ import annotations

import json
import math
import re
from dataclasses import replace
from typing import Any

import pytest
from support.markup import VOID, Reader
from support.walls import facts_of_wall

from babyrobot_levels.extensions.publish.facts import Facts
from babyrobot_levels.extensions.publish.wall import ASSETS, CONTENTS, icons_style, wall_html

HOSTILE = "\"><script>alert('x')</script><img src=x onerror=alert(1)>&amp;$title\u202e"


class Page(Reader):
    """A page, with the texts of the elements that have an id."""

    def __init__(self, page: str) -> None:
        self.ids: list[str | None] = []
        self.text_of: dict[str, str] = {}
        super().__init__(page)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        super().handle_starttag(tag, attrs)
        if tag not in VOID:
            self.ids.append(dict(attrs).get("id"))

    def handle_endtag(self, tag: str) -> None:
        super().handle_endtag(tag)
        self.ids.pop()

    def handle_data(self, data: str) -> None:
        super().handle_data(data)
        for name in filter(None, self.ids):
            self.text_of[name] = self.text_of.get(name, "") + data

    def boxes(self) -> list[tuple[str | None, str | None]]:
        return [(each["name"], each["value"]) for each in self.find("input", type="checkbox")]

    def rows(self) -> list[Any]:
        rows: list[Any] = json.loads(self.text_of["tiles"])
        return rows


def wall(facts: list[Facts], **options: Any) -> Page:
    return Page(wall_of(facts, **options))


def wall_of(facts: list[Facts], **options: Any) -> str:
    plain: Any = {"title": "Levels", "answers": True, "key": False, "home": None}
    return wall_html(facts, **plain | options)


def test_each_tile_is_a_link_with_a_picture_that_is_loaded_late() -> None:
    facts = [facts_of_wall("a", title="First", film=True), facts_of_wall("b", title="Second")]
    page = wall(facts)
    links = [each for each in page.find("a") if "aria-labelledby" in each]
    assert [each["href"] for each in links] == ["a/index.html", "b/index.html"]
    named = [str(each["aria-labelledby"]).split()[0] for each in links]
    assert [page.text_of[name] for name in named] == ["First", "Second"]
    first, second = (each for each in page.find("img") if "loading" in each)
    # The words beside it say more.
    assert (first["src"], first["loading"], first["alt"]) == ("a/tile.png", "lazy", "")
    assert first["data-film"] == "a/film.gif"
    assert "data-film" not in second


def test_a_tile_tells_difficulty_size_and_contents() -> None:
    facts = facts_of_wall("a", size=(12, 4), difficulty=8.94, things=("doors",), features=("wind",))
    page = wall([replace(facts, deterministic=False)])
    assert "Hard 8.9" in page.text_of["f0"]
    assert "12 × 4" in page.text_of["f0"]
    icons = [each["title"] for each in page.find("span", role="img")]
    assert icons == ["Stochastic", "Doors", "Wind"]


@pytest.mark.parametrize(
    ("difficulty", "words"),
    [
        (0.0, "Easy 0.0"),
        (4.94, "Easy 4.9"),
        (4.96, "Medium 5.0"),
        (7.0, "Hard 7.0"),
        (math.inf, "Hard ∞"),
    ],
)
def test_the_word_for_a_difficulty_agrees_with_its_number(difficulty: float, words: str) -> None:
    assert words in wall([facts_of_wall("a", difficulty=difficulty)]).text_of["f0"]


def test_an_undefined_difficulty_is_not_shown_and_sorts_nowhere() -> None:
    page = wall([facts_of_wall("a", difficulty=None), facts_of_wall("b", difficulty=6.0)])
    assert "Medium" not in page.text_of["f0"]
    assert [row[4] for row in page.rows()] == [None, 6.0]


def test_levels_are_filtered_by_what_makes_them_hard() -> None:
    easy = {"irreversible": 0.0, "decisions": 10, "dependencies": 1, "distractors": 0}
    hard = {"irreversible": 0.1, "decisions": 11, "dependencies": 2, "distractors": 1}
    facts = [
        facts_of_wall("a", hardness={**easy, "success": 1.0}),
        facts_of_wall("b", hardness={**hard, "success": 0.9}),
        facts_of_wall("c", hardness=dict.fromkeys([*hard, "success"])),
    ]
    page = wall(facts)
    values = ("mistakes", "decisions", "order", "distractors", "luck")
    assert page.boxes()[:5] == [("hard", value) for value in values]
    assert [row[0] for row in page.rows()] == [[], [0, 1, 2, 3, 4], []]
    assert "hard" not in {name for name, _ in wall(facts, answers=False).boxes()}


def test_filters_are_what_some_levels_have_but_not_all() -> None:
    facts = [
        facts_of_wall("a", size=(3, 3), tags=("maze", "easy"), things=("doors",), split="train"),
        facts_of_wall("b", size=(10, 10), tags=("maze",), things=("doors", "items")),
        facts_of_wall("c", size=(11, 10), tags=("maze", "&"), things=("doors",), split="test"),
    ]
    page = wall(facts)
    assert page.boxes() == [
        *[("size", "small"), ("size", "medium"), ("size", "large")],
        ("has", "items"),
        *[("split", "test"), ("split", "train")],
        *[("tag", "&"), ("tag", "easy")],
        *[("progress", "solved"), ("progress", "open")],
    ]
    # A tile's data names the places of its boxes.
    boxes = page.boxes()
    named = [{boxes[place] for place in row[0]} for row in page.rows()]
    assert named[0] == {("size", "small"), ("split", "train"), ("tag", "easy")}
    assert named[1] == {("size", "medium"), ("has", "items")}


def test_everything_that_levels_contain_has_an_icon() -> None:
    drawn = {*re.findall(r"\.i-(\w+) ", icons_style())}
    assert drawn >= {*CONTENTS, "easy", "medium", "hard", "deterministic", "stochastic"}


def test_levels_with_a_key_can_be_asked_for() -> None:
    coin, key = (facts_of_wall(name, things=("items",)) for name in ("a", "b"))
    page = wall([coin, replace(key, words=("items", "key"))])
    assert ("has", "keys") in page.boxes()
    assert ("has", "items") not in page.boxes()
    assert [len(row[0]) for row in page.rows()] == [0, 1]


def test_only_the_most_common_tags_are_offered_and_few_are_seen_at_once() -> None:
    common = [facts_of_wall(f"a{n}", tags=("common",)) for n in range(2)]
    rare = [facts_of_wall(f"b{n}", tags=(f"rare-{n}",)) for n in range(200)]
    html = wall_of([*common, *rare])
    tags = [value for name, value in Page(html).boxes() if name == "tag"]
    assert len(tags) == 60
    assert tags[0] == "common"
    assert html.index('value="common"') < html.index("<summary>More") < html.index('"rare-150"')


def test_texts_of_levels_are_not_markup() -> None:
    names = ("title", "description", "author", "name", "split")
    texts: Any = dict.fromkeys(names, HOSTILE)
    facts = replace(facts_of_wall("a"), **texts, tags=(HOSTILE,))
    page = wall([facts, facts_of_wall("b")], title=HOSTILE, home=HOSTILE)
    assert [each.get("src") for each in page.find("script")] == [None, "assets/wall.js"]
    assert all("onerror" not in attributes for _, attributes in page.elements)
    assert page.text_of["t0"] == HOSTILE
    assert HOSTILE in page.rows()[0][1]
    assert ("tag", HOSTILE) in page.boxes()
    assert page.find("a", href=HOSTILE)


def test_the_title_of_a_level_keeps_its_direction_to_itself() -> None:
    assert "<bdi>שלום</bdi>" in wall_of([facts_of_wall("a", title="שלום")])


def test_without_answers_nothing_tells_of_them() -> None:
    known = facts_of_wall("a", difficulty=6.125, best_return=-17.375, best_steps=41.625)
    other = facts_of_wall("b", difficulty=1.0, best_return=1.0, best_steps=1.0)
    unknown: Any = {
        "difficulty": None,
        "best_return": None,
        "best_steps": None,
        "random_return": None,
    }
    html = wall_of([known, other], answers=False)
    without = [replace(each, **unknown) for each in (known, other)]
    assert html == wall_of(without, answers=False)
    assert not {"difficulty", "steps", "return"} & {name for name, _ in Page(html).boxes()}
    orders = [each["value"] for each in Page(html).find("option")]
    assert orders == ["", "title", "size", "-size"]
    assert "-17.375" in wall_of([known, other])


def test_the_teachers_copy_says_that_it_is_one() -> None:
    html = wall_of([facts_of_wall("a")], title="Exercise 3", key=True)
    assert "<title>Exercise 3 (key)</title>" in html
    assert any("teacher's copy" in text for text in Page(html).texts["p"])
    assert "(key)" not in wall_of([facts_of_wall("a")], title="Exercise 3")


def test_the_way_home_is_there_only_if_there_is_one() -> None:
    assert wall([facts_of_wall("a")], home="../index.html").find("a", href="../index.html")
    assert ">Home</a>" not in wall_of([facts_of_wall("a")])


def test_a_tile_takes_no_more_than_a_kilobyte_and_a_half() -> None:
    facts = facts_of_wall(
        "a-level-of-a-suite-00000",
        title="A level with a title of usual length",
        description="word " * 40,
        tags=("maze", "puddles", "things"),
        things=("items", "doors", "switches", "movers"),
        features=("areas", "maze", "puddles", "wind"),
        film=True,
    )
    one, many = (len(wall_of([facts] * count).encode()) for count in (1, 101))
    assert (many - one) / 100 < 1500


def test_what_is_in_a_level_is_searched() -> None:
    html = wall_of([replace(facts_of_wall("a", features=("wind",)), words=("guard",))])
    assert "wind guard" in html


def test_a_long_description_is_searched_only_at_its_beginning() -> None:
    facts = facts_of_wall("a", description="x" * 1_000_000)
    assert len(wall_of([facts])) < 10_000


def test_the_page_loads_only_its_own_files_and_all_of_them_exist() -> None:
    page = wall([facts_of_wall("a")])
    (policy,) = (each["content"] for each in page.find("meta") if "http-equiv" in each)
    assert str(policy).startswith("default-src 'none';")
    assert "unsafe" not in str(policy)
    loaded = [each["href"] for each in page.find("link")]
    loaded += [each["src"] for each in page.find("script") if "src" in each]
    assert {str(each).removeprefix("assets/") for each in loaded} <= set(ASSETS)


def test_every_icon_of_the_page_is_drawn() -> None:
    everything: Any = {
        "things": ("items", "doors", "switches", "movers"),
        "features": ("areas", "ends", "glass", "maze", "puddles", "warps", "wind"),
    }
    facts = [
        facts_of_wall("a", difficulty=1.0, **everything),
        replace(facts_of_wall("b", difficulty=6.0), deterministic=False),
        facts_of_wall("c", difficulty=9.0),
    ]
    classes = [str(each["class"]).split() for each in wall(facts).find("span") if "class" in each]
    icons = {each[1] for each in classes if each[0] == "icon"}
    assert len(icons) == 18
    assert all(f".{name} {{" in icons_style() for name in icons)
