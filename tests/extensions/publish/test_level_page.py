"""The page of a level in a gallery: what is on it, and what no text of a level can do to it."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from support.folders import babyrobot
from support.markup import Reader
from support.packs import level as pack_level
from support.packs import pack_text, packed
from support.worlds import level

import babyrobot_levels as brl
from babyrobot_levels.analysis.guides import guide_of
from babyrobot_levels.extensions.publish.facts import Facts, Files, facts_of, measured
from babyrobot_levels.extensions.publish.level_page import (
    MAX_SHOWN,
    level_html,
    load_name,
    programs,
    python_html,
    with_neighbours,
    yaml_html,
)
from babyrobot_levels.library.catalogue import load
from babyrobot_levels.library.citation import bibtex, citation
from babyrobot_levels.library.level import Level
from babyrobot_levels.render.page import MAX_CELLS

EVIL = "</title></script><!--<script>alert(1)</script><img src=x onerror=alert(2)>&amp;\"'$title"
FILES = Files(
    page="own/index.html",
    level="own/level.yaml",
    svg="own/picture.svg",
    png="own/picture.png",
    tile="own/tile.png",
    film="own/film.gif",
    values="own/values.svg",
    sets=[f"own/values-{number}.svg" for number in range(2, 9)],
)
SIZES = dict.fromkeys((FILES.level, FILES.svg, FILES.png, FILES.film, FILES.values), 12_345)


def page_of(
    world: Level, *, answers: bool = True, key: bool = False, text: str | None = None, **told: Any
) -> Reader:
    """Return the page of a level whose files are in the folder `own`."""
    files = FILES if answers else replace(FILES, film=None, values=None)
    facts = facts_of(world, "own", files, metrics=measured(world) if answers else None)
    html = level_html(
        world,
        replace(facts, **told),
        text=text if text is not None else world.to_yaml(),
        guide=guide_of(world) if answers else None,
        answers=answers,
        key=key,
        title="Gallery",
        sizes={str(path): size for path, size in SIZES.items()},
    )
    return Reader(html)


def tabs(page: Reader) -> list[str]:
    return [str(tab["id"]) for tab in page.find("button", role="tab")]


def facts_on(page: Reader) -> dict[str, str]:
    """Return the facts: the last terms and their texts."""
    names = page.texts["dt"]
    at = names.index("Size")
    return dict(zip(names[at:], page.texts["bdi"][-len(names[at:]) :], strict=True))


# -- what is there -----------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["final-maze", "first-key", "gridworld-3-5"])
def test_every_element_is_closed_and_every_id_is_there_once(name: str) -> None:
    page = page_of(load(name))
    assert page.open == []
    ids = [each["id"] for _, each in page.elements if "id" in each]
    assert len(ids) == len(set(ids))
    for attribute in ("aria-controls", "aria-labelledby", "data-copy"):
        for _, each in page.elements:
            # The description of the picture is part of it.
            assert each.get(attribute, "stage") in ids


def test_each_tab_has_its_part_and_a_heading() -> None:
    page = page_of(load("final-maze"))
    assert tabs(page) == ["tab-play", "tab-values", "tab-yaml", "tab-python", "tab-cite"]
    panels = [each["id"] for each in page.find("section") if "panel" in str(each.get("class"))]
    assert panels == [tab.replace("tab", "panel") for tab in tabs(page)]
    # Without scripts the parts stand below one another, and there are no tabs.
    assert "hidden" in page.find("div", role="tablist")[0]


def test_it_loads_only_files_of_the_gallery() -> None:
    page = page_of(load("final-maze"))
    (policy,) = page.find("meta", **{"http-equiv": "Content-Security-Policy"})
    rules = dict(rule.split(" ", 1) for rule in str(policy["content"]).split("; "))
    assert (rules["default-src"], rules["script-src"]) == ("'none'", "'self'")
    assert rules["style-src"] == "'self'"
    for tag, attributes in page.elements:
        assert not [name for name in attributes if name == "style" or name.startswith("on")]
        assert tag not in ("style", "iframe")
    own = [each for each in page.find("script") if "src" not in each]
    assert own == [{"type": "application/json", "id": "data"}]


def test_a_page_is_small_because_scripts_and_styles_are_shared() -> None:
    page = page_of(load("final-maze"))
    assert sum(map(len, page.texts["script"])) < 20_000


def test_facts_are_those_of_the_level_as_the_game_writes_them() -> None:
    facts = facts_on(page_of(load("final-maze")))
    assert facts["Size"] == "8 × 5"
    assert (facts["States"], facts["Time limit"]) == ("40", "500 steps")
    assert (facts["Discount"], facts["Deterministic"]) == ("1", "no")
    assert facts["Optimal return"] == "\N{MINUS SIGN}36.58"
    assert facts["Digest"] == load("final-maze").digest


@pytest.mark.slow
def test_the_optimum_within_the_time_limit_is_told_where_it_differs() -> None:
    facts = facts_on(page_of(load("frozen-lake")))
    assert (facts["Optimal return within 100 steps"], facts["Optimal return without a limit"]) == (
        "0.74",
        "0.82",
    )
    assert facts["Steps of the optimal policy without a limit"] == "48.71"
    assert facts["Return of random actions without a limit"] == "0.011"
    assert facts["Ending"].endswith("in 82.4 % of the episodes; 17.6 % end at [3, 1]")
    assert "Ending" not in facts_on(page_of(load("final-maze")))
    assert not [name for name in facts_on(page_of(load("final-maze"))) if "within" in name]


@pytest.mark.slow
def test_values_of_things_are_there_for_all_that_can_be_held() -> None:
    def told(name: str) -> str:
        return page_of(load(name)).texts["figcaption"][0]

    assert "the items that are held, the doors that are open" in told("first-key")
    assert "They change" not in told("final-maze")
    assert page_of(load("first-key")).texts["label"][-2:] == ["Nothing", "key"]
    left_out = [text for text in page_of(load("three-gems")).texts["span"] if "more" in text]
    assert left_out == ["and 8 more, which the game shows when one comes to them"]


def test_what_a_book_prints_stands_beside_what_is_computed() -> None:
    page = page_of(load("gridworld-3-5"))
    assert any("Figure 3.2" in text for text in page.texts["p"])
    assert {"24.4", "\N{MINUS SIGN}0.4"} <= set(page.texts["td"])
    assert "24.419" in page.texts["small"]
    assert all("equal when rounded" in caption for caption in page.texts["caption"])


def test_downloads_have_names_and_sizes() -> None:
    links = [each for each in page_of(load("final-maze")).find("a") if "download" in each]
    named = {str(each["href"]): each["download"] for each in links}
    assert named == {
        "level.yaml": "own.yaml",
        "picture.svg": "own.svg",
        "values.svg": "own.values.svg",
        "picture.png": "own.png",
        "film.gif": "own.gif",
    }
    assert "12.3 KB" in page_of(load("final-maze")).texts["small"]


def test_neighbours_are_linked_once_they_are_known() -> None:
    world = load("final-maze")
    facts = facts_of(world, "own", FILES)
    html = level_html(
        world, facts, text="", guide=None, answers=False, key=False, title="",
        sizes={str(path): 1 for path in SIZES},
    )  # fmt: skip
    other = replace(facts, title='"quoted" <b>', files=replace(FILES, page="other/index.html"))
    page = Reader(with_neighbours(html, None, other))
    assert page.find("a", rel="prev") == []
    (link,) = page.find("a", rel="next")
    assert (link["href"], link["title"]) == ("../other/index.html", '"quoted" <b>')
    assert page.open == page.comments == []


# -- answers -----------------------------------------------------------------------------------


def test_a_page_without_answers_tells_nothing_of_them() -> None:
    assert "Ending" not in facts_on(page_of(load("frozen-lake"), answers=False))
    page = page_of(load("final-maze"), answers=False)
    assert "tab-values" not in tabs(page)
    data = json.loads(page.texts["script"][0])
    assert (data["policy"], data["best"], data["walker"]) == (None, "", None)
    assert not {"returns", "marks"} & data.keys()
    told = {*facts_on(page)}
    assert not [
        name for name in told if "eturn" in name or name == "Difficulty" or "policy" in name
    ]
    assert "brl.solve" not in " ".join(page.texts["pre"])
    assert not [each for each in page.find("a") if "values" in str(each.get("href"))]


def test_the_key_begins_with_the_values_and_shows_them_in_the_game() -> None:
    page = page_of(load("final-maze"), key=True)
    assert tabs(page)[0] == "tab-values"
    assert sorted(json.loads(page.texts["script"][0])["shown"]) == ["policy", "values"]
    assert page.texts["title"] == ["The final maze – Gallery (key)"]


def test_a_level_that_is_too_large_says_so_and_has_the_rest() -> None:
    side = 1 + int(MAX_CELLS**0.5)
    page = page_of(level(size=[side, side]), answers=False)
    assert any("too large for a page" in text for text in page.texts["p"])
    assert tabs(page) == ["tab-play", "tab-yaml", "tab-python", "tab-cite"]
    assert [each.get("src") for each in page.find("script")] == ["../assets/level.js"]


# -- hostile texts -----------------------------------------------------------------------------


def test_no_text_of_a_level_becomes_a_part_of_the_page() -> None:
    told = dict.fromkeys(("title", "description", "author", "source", "license"), EVIL)
    areas = [{"at": [1, 0], "label": EVIL}]
    plain = page_of(level(size=[3, 1], areas=[{"at": [1, 0], "label": "a"}]))
    page = page_of(level(size=[3, 1], areas=areas, tags=["a"], **told), name=EVIL, split=EVIL)
    assert page.open == []
    assert page.comments == ["neighbours"]
    for tag in ("script", "img", "a", "iframe"):
        assert len(page.find(tag)) == len(plain.find(tag))
    assert page.texts["h1"] == [""]
    assert page.texts["bdi"].count(EVIL) >= 6
    assert EVIL in page.texts["title"][0]


@pytest.mark.parametrize("text", ["a: </pre><script>", "a: |\n  <b>\n# <i>&amp;", "\"<b>\": '<i>'"])
def test_a_text_in_colours_is_still_the_text(text: str) -> None:
    for html in (yaml_html(text), python_html(text)):
        page = Reader(f"<pre>{html}</pre>")
        assert {tag for tag, _ in page.elements} <= {"pre", "span"}
        assert re.sub(r"</?span[^>]*>", "", html).count("<") == 0


def test_yaml_has_its_colours() -> None:
    html = yaml_html("size: [3, -1.5]  # two\nmap: |\n  key: 1\n\n  # x\non: 'it''s' \nend: true")
    for kind, text in (
        ("k", "size"), ("n", "-1.5"), ("c", "# two"), ("t", "  key: 1"), ("t", "  # x"),
        ("t", "'it''s'"), ("k", "end"), ("w", "true"),
    ):  # fmt: skip
        assert f'<span class="{kind}">{text}</span>' in html


def test_a_long_text_is_cut_on_the_page() -> None:
    page = page_of(level(size=[3, 1]), text="# " + "x" * MAX_SHOWN)
    assert any(f"of {MAX_SHOWN + 2:,} characters" in text for text in page.texts["p"])


# -- programs and citations --------------------------------------------------------------------


def own_facts(world: Level) -> Facts:
    return facts_of(world, "own", FILES)


def test_only_levels_of_the_package_are_loaded_by_name() -> None:
    assert load_name(own_facts(load("final-maze"))) == "final-maze"
    other = load("final-maze").replace(rewards={"step": -2})
    assert load_name(own_facts(other)) == "own.yaml"


@pytest.mark.sweep
@pytest.mark.parametrize("in_package", [True, False])
@pytest.mark.parametrize("answers", [True, False])
def test_the_programs_run(in_package: bool, answers: bool, tmp_path: Path) -> None:
    world = load("first-key") if in_package else level(size=[3, 2], max_steps=20, name="mine")
    facts = own_facts(world)
    (tmp_path / f"{facts.id}.yaml").write_text(world.to_yaml(), "utf-8")
    for program in programs(facts, answers=answers):
        done = subprocess.run(
            [sys.executable, "-c", program], cwd=tmp_path, capture_output=True, text=True
        )
        assert (done.returncode, done.stderr) == (0, "")
        assert done.stdout


def test_a_citation_names_the_level_and_its_digest() -> None:
    world = load("final-maze")
    assert citation(world).startswith("final-maze (babyrobot-levels ")
    assert citation(world).endswith(world.digest)
    texts = page_of(world).texts["pre"]
    assert {citation(world), bibtex(world), world.digest, world.share_code()} <= set(texts)


@pytest.mark.usefixtures("here")
def test_a_citation_of_a_level_of_a_pack_names_that_pack_and_its_version() -> None:
    farm = {"pack.yaml": pack_text("farm", "3.0.0"), "levels/lion.yaml": pack_level()}
    for archive in (packed("1.0.0"), packed("3.0.0", farm)):
        assert babyrobot("install", archive).status == 0
    for name, version in (("farm/lion", "farm 3.0.0"), ("zoo/lion", "zoo 1.0.0")):
        assert citation(load(name), name).startswith(f"{name} (pack {version}, babyrobot-levels ")


def test_bibtex_escapes_what_latex_would_read() -> None:
    entry = bibtex(level(size=[3, 1], title="50% \\input{x} & more_$1", author="A~B^C"))
    assert r"title = {{50\% \textbackslash{}input\{x\} \& more\_\$1}}" in entry
    assert r"author = {{A\textasciitilde{}B\textasciicircum{}C}}" in entry
    assert entry.count("{") == entry.count("}")


@pytest.mark.slow
def test_the_file_keeps_comments_but_not_the_way_to_a_schema(tmp_path: Path) -> None:
    brl.gallery(["lookout"], tmp_path / "site")
    text = (tmp_path / "site" / "lookout" / "level.yaml").read_text("utf-8")
    assert "# A bottom panel" in text
    assert "$schema" not in text
