"""Galleries as folders: what is in them, what replaces what, and what students do not get."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest
from PIL import Image
from support.sessions import run_here

import babyrobot_levels as brl
from babyrobot_levels.extensions.publish import gallery as writing
from babyrobot_levels.library import search_path
from babyrobot_levels.library.catalogue import files_in, is_suite_file
from babyrobot_levels.library.search_path import gallery_order, gallery_place
from babyrobot_levels.render.page_format import rounded

LEVELS = ["final-maze", "treasure-chests", "first-key"]
SUITE: dict[str, Any] = {
    "version": 1,
    "kind": "suite",
    "name": "few",
    "title": "A few",
    "count": 4,
    "size": [3, 3],
    "splits": {"train": 0.5, "test": 0.5},
}


def contents(folder: Path) -> dict[str, bytes]:
    """Return all files in a folder."""
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }


def listed(folder: Path) -> dict[str, Any]:
    def refuse(constant: str) -> None:
        raise AssertionError(f"{constant} is not JSON")

    data: dict[str, Any] = json.loads(
        (folder / "gallery.json").read_text("utf-8"), parse_constant=refuse
    )
    return data


def level(**fields: Any) -> brl.Level:
    return brl.Level.from_fields({"version": 1, "size": [3, 3], **fields})


SMALL = level(name="small", size=[2, 1], max_steps=9)


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("gallery") / "site"
    brl.gallery(LEVELS, folder)
    return folder


@pytest.mark.slow
def test_it_has_the_files_that_its_list_names_and_no_others(site: Path) -> None:
    data = listed(site)
    assert (data["format"], data["title"]) == (1, "Levels")
    named = set[str]()
    for each in data["levels"]:
        named.update(each["files"].pop("sets"), filter(None, each["files"].values()))
    shared = {name for name in contents(site) if name.startswith("assets/")}
    assert set(contents(site)) == {"index.html", "gallery.json"} | named | shared
    assert [each["id"] for each in data["levels"]] == LEVELS


@pytest.mark.slow
def test_the_packages_levels_come_in_their_chosen_order(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert sorted(gallery_order()) == sorted(
        file.name for file in files_in(gallery_place()) if not is_suite_file(file.path)
    )
    folder = tmp_path / "levels"
    folder.mkdir()
    for name in ("a", "b", "c"):
        SMALL.save(folder / f"{name}.yaml")
    (folder / "order.txt").write_text("# the best first\nc a\n", "utf-8")
    for module in (search_path, writing):
        monkeypatch.setattr(module, "gallery_folder", lambda: folder)
    found = brl.gallery(folder, tmp_path / "site", answers=False).levels
    assert [each["id"] for each in found] == ["c", "a", "b"]
    told = ["gallery", str(folder), "--count", "2", "-o", str(tmp_path / "told")]
    assert run_here(told, {}).status == 0
    data = listed(tmp_path / "told")
    assert [each["id"] for each in data["levels"]] == ["c", "a"]
    assert data["title"] == "The babyrobot gallery"


@pytest.mark.slow
@pytest.mark.parametrize("name", LEVELS)
def test_its_files_are_those_of_the_level(site: Path, name: str) -> None:
    own, loaded = site / name, brl.load(name)
    assert brl.load(own / "level.yaml").digest == loaded.digest
    assert (own / "picture.svg").read_text("utf-8") == loaded.to_svg()
    assert (own / "picture.png").read_bytes() == loaded.to_png()
    for file in ("tile.png", "film.gif"):
        with Image.open(own / file) as image:
            assert max(image.size) <= 400


@pytest.mark.slow
def test_small_pictures_leave_out_the_panels(site: Path) -> None:
    width, height = brl.load("final-maze").size
    for file in ("tile.png", "film.gif"):
        with Image.open(site / "final-maze" / file) as image:
            assert image.width / image.height == pytest.approx(width / height, rel=0.02)


@pytest.mark.slow
def test_it_does_not_depend_on_the_number_of_processes(tmp_path: Path) -> None:
    made = [brl.gallery([SMALL, level()], tmp_path / str(jobs), jobs=jobs) for jobs in (1, 2)]
    assert contents(made[0].folder) == contents(made[1].folder)


# -- names ---------------------------------------------------------------------------------


@pytest.mark.slow
def test_ids_are_unique_slugs_that_no_name_can_lead_out_of_the_folder(tmp_path: Path) -> None:
    names = ["a", "A", "a-2", "assets", "CON", "ä ö", "..", "a/../../b", "x" * 300, "", "a"]
    ids = [*writing._ids(names)]
    assert ids[:6] == ["a", "a-2", "a-2-2", "assets-2", "con-2", "level"]
    assert len({*ids}) == len(ids)
    assert all(re.fullmatch(r"[a-z0-9]+(-[a-z0-9]+)*", each) and len(each) < 80 for each in ids)
    tiny = {"size": [2, 1]}
    same = [level(**tiny), level(name="level", **tiny), level(**tiny)]
    made = brl.gallery(same, tmp_path / "site")
    assert [each["id"] for each in made.levels] == ["level", "level-2", "level-3"]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("editor", "link"),
    [
        ("../editor/", "../../editor/#"),
        ("https://example.org/editor/", "https://example.org/editor/#"),
    ],
)
def test_each_level_can_be_edited_in_a_site(tmp_path: Path, editor: str, link: str) -> None:
    made = brl.gallery(["first-key"], tmp_path / "site", editor=editor)
    page = tmp_path / "site" / made.levels[0]["files"]["page"]
    assert f'href="{link}{brl.share("first-key")}">Edit</a>' in page.read_text("utf-8")
    with pytest.raises(ValueError, match="editor must be the address of a page"):
        brl.gallery(["first-key"], tmp_path / "other", editor="javascript:alert(1)")


@pytest.mark.parametrize("home", ["javascript:alert(1)", " JavaScript:x", "data:text/html,x"])
def test_the_link_back_is_no_program(tmp_path: Path, home: str) -> None:
    with pytest.raises(ValueError, match="home must be the address of a page"):
        brl.gallery(["maze"], tmp_path / "site", home=home)
    assert not (tmp_path / "site").exists()


# -- suites and random mazes ---------------------------------------------------------------


@pytest.mark.slow
def test_a_suite_gives_title_names_and_splits(tmp_path: Path) -> None:
    suite = brl.load_suite(SUITE)
    made = brl.gallery(suite, tmp_path / "site")
    assert made.title == "A few"
    assert [each["id"] for each in made.levels] == [f"few-{n}" for n in range(4)]
    assert [each["digest"] for each in made.levels] == [each.digest for each in suite]
    for split in suite.splits:
        digests = [each["digest"] for each in made.levels if each["split"] == split]
        assert digests == [each.digest for each in suite.split(split)]
    part = brl.gallery(suite.split("test"), tmp_path / "part")
    assert {each["split"] for each in part.levels} == {"test"}


@pytest.mark.slow
def test_a_random_maze_is_that_of_seed_0(tmp_path: Path) -> None:
    made = brl.gallery(["random-maze"], tmp_path / "site")
    found, loaded = made.levels[0], brl.load("random-maze")
    assert (found["maze_seed"], found["digest"]) == (0, loaded.with_maze_seed(0).digest)
    assert brl.load(tmp_path / "site" / found["files"]["level"]).has_random_maze
    assert "seed 0" in (tmp_path / "site" / found["files"]["page"]).read_text("utf-8")


# -- levels that cannot be solved, or are too large ----------------------------------------

PAYS, COSTS = ({"at": [x, 0], "reward": 1 - 2 * x} for x in (0, 1))
ODD: dict[str, dict[str, Any]] = {
    "endless": {"size": [2, 1], "rewards": {"step": 1}},
    "undefined": {"size": [2, 1], "exit": "none", "rewards": {"step": 0}, "areas": [PAYS, COSTS]},
    "large": {"size": [130, 130]},
}


@pytest.mark.slow
def test_any_level_has_a_page_and_pictures(tmp_path: Path) -> None:
    odd = [level(name=name, max_steps=9, **fields) for name, fields in ODD.items()]
    made = brl.gallery(odd, tmp_path / "site")
    assert [each["files"]["film"] for each in made.levels] == [None] * len(ODD)
    there = {f"{name}/{file}" for name in ODD for file in ("index.html", "picture.png", "tile.png")}
    assert there <= set(contents(made.folder))
    assert listed(made.folder)["levels"] == [*made.levels]


# -- without answers -----------------------------------------------------------------------


@pytest.mark.slow
def test_a_gallery_without_answers_is_written_without_solving(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_: object, **__: object) -> None:
        raise AssertionError("a gallery without answers needs no solution")

    for place in (
        "solver.optimum.solve",
        "solver.evaluation.evaluation_of",
        "solver.distribution.distribution_of",
        "solver.horizon.worth_within",
    ):
        monkeypatch.setattr(f"babyrobot_levels.analysis.{place}", refuse)
    assert len(brl.gallery(LEVELS, tmp_path / "site", answers=False).levels) == len(LEVELS)


@pytest.mark.slow
def test_no_file_of_a_gallery_without_answers_contains_the_optimum(
    site: Path, tmp_path: Path
) -> None:
    path = tmp_path / "level.yaml"
    path.write_text(f"# The optimum is -5.2517.\n{brl.load('final-maze').to_yaml()}", "utf-8")
    made = brl.gallery([path, *LEVELS], tmp_path / "students", answers=False)
    for each in made.levels:
        answers = ("best_return", "best_steps", "random_return", "difficulty")
        assert [each[name] for name in answers] == [None] * 4
        assert each["hardness"] == {}
        assert each["files"]["film"] is None
        assert each["files"]["values"] is None
    best = brl.solve("final-maze").expected_return
    told = [f"{best:.2f}", f"{best:.4g}", rounded(best), "5.2517"]
    with_answers, without = (
        {
            name: data.decode("utf-8")
            for name, data in contents(folder).items()
            if not name.endswith((".png", ".gif")) and not name.startswith("assets/")
        }
        for folder in (site, made.folder)
    )
    assert any(rounded(best) in text for text in with_answers.values())
    for name, text in without.items():
        assert not [each for each in told if each in text], name
    assert not [name for name in contents(made.folder) if name.endswith(".gif")]


@pytest.mark.slow
@pytest.mark.parametrize("answers", [True, False])
def test_comments_which_may_tell_the_way_are_for_galleries_with_answers(
    tmp_path: Path, answers: bool
) -> None:
    path = tmp_path / "own.yaml"
    path.write_text("version: 1\n# through the lower row\nsize: [4, 2]\n", "utf-8")
    brl.gallery([path], tmp_path / "site", answers=answers)
    told = [
        name for name, data in contents(tmp_path / "site").items() if b"through the lower" in data
    ]
    assert sorted(told) == (["own/index.html", "own/level.yaml"] if answers else [])


@pytest.mark.slow
def test_the_key_shows_values_and_policy_in_its_pictures(tmp_path: Path) -> None:
    made = brl.gallery([SMALL], tmp_path / "site", key=True)
    shown = (made.folder / "small" / "picture.svg").read_text("utf-8")
    assert shown == SMALL.to_svg(values=True, policy="best")
    with pytest.raises(ValueError, match="leave out answers=False"):
        brl.gallery([SMALL], tmp_path / "other", key=True, answers=False)


# -- the folder ----------------------------------------------------------------------------


def beside(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


@pytest.mark.slow
def test_a_gallery_is_replaced_by_the_next_one(tmp_path: Path) -> None:
    brl.gallery([level(name="before")], tmp_path / "site")
    brl.gallery([SMALL], tmp_path / "site")
    assert [each["id"] for each in listed(tmp_path / "site")["levels"]] == ["small"]
    assert not (tmp_path / "site" / "before").exists()
    assert beside(tmp_path) == ["site"]


@pytest.mark.slow
def test_what_is_no_gallery_is_refused(tmp_path: Path) -> None:
    for number, text in enumerate(
        ["", "{", "[]", '{"format": 1}', '{"format": 1, "made_by": "other", "levels": []}']
    ):
        folder = tmp_path / str(number)
        folder.mkdir()
        (folder / "gallery.json").write_text(text)
        before = contents(folder)
        for force in (False, True):
            with pytest.raises(brl.FolderError, match="is a folder that is not a gallery"):
                brl.gallery([SMALL], folder, force=force)
        assert contents(folder) == before
    file = tmp_path / "file"
    file.write_text("mine")
    with pytest.raises(brl.FolderError, match="is not a folder"):
        brl.gallery([SMALL], file, force=True)
    assert file.read_text() == "mine"
    (tmp_path / "empty").mkdir()
    assert brl.gallery([SMALL], tmp_path / "empty").levels


@pytest.mark.slow
@pytest.mark.parametrize("added", ["notes.txt", "small/notes.txt", "assets/notes.txt", "other/a"])
def test_files_that_were_added_are_deleted_only_if_that_is_asked_for(
    tmp_path: Path, added: str
) -> None:
    site = tmp_path / "site"
    brl.gallery([SMALL], site)
    (site / added).parent.mkdir(exist_ok=True)
    (site / added).write_text("mine")
    before = contents(site)
    with pytest.raises(brl.FolderError, match="there are other files") as error:
        brl.gallery([SMALL], site)
    assert "--force" in (error.value.help or "")
    assert contents(site) == before
    brl.gallery([SMALL], site, force=True)
    assert not (site / added).exists()


@pytest.mark.slow
def test_an_error_leaves_what_was_there(tmp_path: Path) -> None:
    site, bad = tmp_path / "site", tmp_path / "bad.yaml"
    bad.write_text("version: 1\nsize: [3, 3]\nexit: [9, 9]\n")
    brl.gallery([SMALL], site)
    before = contents(site)
    with pytest.raises(brl.LevelError, match="is off the grid") as error:
        brl.gallery([SMALL, bad], site)
    assert error.value.__notes__ == ["in level 1"]
    with pytest.raises(ValueError, match="there are no levels"):
        brl.gallery([], site)
    assert contents(site) == before
    assert beside(tmp_path) == ["bad.yaml", "site"]


@pytest.mark.slow
def test_levels_with_errors_can_be_left_out(tmp_path: Path) -> None:
    bad = tmp_path / "bad.yaml"
    bad.write_text("version: 1\nsize: [3, 3]\nexit: [9, 9]\n")
    told: list[tuple[int, int]] = []
    made = brl.gallery(
        [SMALL, bad, "no-such-level", level()],
        tmp_path / "site",
        keep_going=True,
        progress=lambda done, total: told.append((done, total)),
    )
    assert [each["id"] for each in made.levels] == ["small", "level"]
    assert {index: type(error) for index, error in made.left_out.items()} == {
        1: brl.LevelError,
        2: brl.LevelNotFoundError,
    }
    assert told == [(1, 4), (2, 4), (3, 4), (4, 4)]
    with pytest.raises(ValueError, match="there are no levels"):
        brl.gallery([bad], tmp_path / "none", keep_going=True)
    assert not (tmp_path / "none").exists()
