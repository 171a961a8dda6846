"""`babyrobot preview`: as large as asked, films of episodes, pages to play, answers."""

from __future__ import annotations

import io
import json
import re
import shlex
import xml.etree.ElementTree as ET
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pypdfium2 as pdfium
import pytest
from PIL import Image, ImageSequence
from support.places import DOCS
from support.plays import record
from support.sessions import babyrobot

from babyrobot_levels.agents.plays import read_plays
from babyrobot_levels.agents.policy_tables import policy_table
from babyrobot_levels.analysis.pictures import MAX_STEPS
from babyrobot_levels.analysis.solver.optimum import solve
from babyrobot_levels.library.catalogue import load
from babyrobot_levels.render.gif import Step, to_gif
from babyrobot_levels.render.scene.build import build_scene
from babyrobot_levels.render.svg import to_svg
from babyrobot_levels.render.words.rules import rules_of

CHESTS = load("treasure-chests")
HEAD = "version: 1\nsize: [3, 1]\n"
ENDLESS = HEAD + "exit: none\n"
WITHOUT_ANSWER = (
    HEAD + "start: [1, 0]\nexit: none\nblocked: [{at: [2, 0]}]\nrewards: {stay: -9, bump: -9}\n"
    "areas: [{at: [0, 0], reward: 1}, {at: [1, 0], reward: -1}]\n"
)


pytestmark = pytest.mark.usefixtures("here")
preview = partial(babyrobot, "preview")


def made(*arguments: str) -> bytes:
    """Return the file that a call writes; it must not have anything else to say."""
    *options, output = arguments
    result = preview(*options, "-o", output)
    assert (result.status, result.out) == (0, "")
    assert re.fullmatch(rf"wrote {re.escape(output)} \(.*\)\n", result.err)
    return Path(output).read_bytes()


def written(text: str) -> str:
    Path("mine.yaml").write_text(text, encoding="utf-8")
    return "mine.yaml"


def film(data: bytes) -> Any:
    with Image.open(io.BytesIO(data)) as image:
        return np.array([np.array(frame.convert("RGB")) for frame in ImageSequence.Iterator(image)])


def data_of(page: bytes) -> Any:
    found = re.search(r'<script type="application/json" id="data">(.*?)</script>', page.decode())
    assert found
    return json.loads(found[1])


MINUS = "\N{MINUS SIGN}"

# -- as large as asked -------------------------------------------------------------------------


def test_a_pdf_is_as_large_as_asked_and_shows_what_is_asked() -> None:
    scene = build_scene(load("maze"))
    twice = pdfium.PdfDocument(made("maze", "--scale", "2", "b.pdf"))
    assert twice[0].get_size() == pytest.approx((1.5 * scene.width, 1.5 * scene.height), abs=0.01)
    answers = pdfium.PdfDocument(made("maze", "--values", "--rules", "c.pdf"))
    text = answers[0].get_textpage().get_text_bounded()
    assert f"{solve(load('maze')).expected_return:.0f}".replace("-", MINUS) in text
    assert "each step: costs 1" in text
    assert load("maze").to_pdf(values=True).startswith(b"%PDF")


def test_an_svg_is_shown_larger_and_is_the_same_otherwise() -> None:
    scene = build_scene(load("maze"))
    usual, twice = made("maze", "a.svg").decode(), made("maze", "--scale", "2", "b.svg").decode()
    assert usual == to_svg(scene)
    root = ET.fromstring(twice)
    assert float(root.attrib["width"]) == 2 * scene.width
    assert float(root.attrib["height"]) == 2 * scene.height
    assert root.attrib["viewBox"] == ET.fromstring(usual).attrib["viewBox"]
    assert usual.splitlines()[1:] == twice.splitlines()[1:]


@pytest.mark.slow
def test_pictures_of_pixels_are_as_large_as_asked() -> None:
    scene = build_scene(load("maze"))
    for options, name in ((("--scale", "0.5"), "a.png"), (("--cell", "32"), "a.gif")):
        with Image.open(io.BytesIO(made("maze", *options, name))) as image:
            assert image.size == (round(scene.width / 2), round(scene.height / 2))


# -- films -------------------------------------------------------------------------------------


def episode(name: str, seed: int, policy: Any) -> list[Step]:
    """Play an episode in the environment; without a policy, at random."""
    env = load(name).make(observation="index")
    state, _ = env.reset(seed=seed)
    env.action_space.seed(seed)
    steps, is_over = [], False
    while not is_over:
        action = int(env.action_space.sample() if policy is None else policy[state])
        following, reward, is_over, _, info = env.step(action)
        steps.append(Step(int(state), action, int(following), float(reward), info["skidded"]))
        state = following
    return steps


@pytest.mark.parametrize("options", [(), ("--policy", "best")])
def test_a_film_shows_the_best_policys_episode(options: tuple[str, ...]) -> None:
    steps = episode("puddles", 5, solve("puddles").policy.ravel())
    expected = to_gif(load("puddles"), steps)
    assert made("puddles", *options, "--seed", "5", "walk.gif") == expected


@pytest.mark.slow
def test_a_random_walk_is_the_environments() -> None:
    expected = to_gif(load("frozen-lake"), episode("frozen-lake", 2, None))
    assert made("frozen-lake", "--policy", "random", "--seed", "2", "walk.gif") == expected


@pytest.mark.slow
def test_the_seed_is_0_if_none_is_given() -> None:
    first, again = made("frozen-lake", "a.gif"), made("frozen-lake", "--seed", "0", "b.gif")
    assert first == again != made("frozen-lake", "--seed", "1", "c.gif")


@pytest.mark.sweep
def test_a_film_shows_values_and_coordinates() -> None:
    plain, values, coordinates = (
        film(made("maze", "--cell", "64", *options, f"{number}.gif"))[0].astype(int)
        for number, options in enumerate([(), ("--values",), ("--coordinates",)])
    )
    # Below the grid is the legend of the values.
    assert len(values) > len(plain)
    assert (plain != values[: len(plain)]).any()
    assert (plain != coordinates).any()


@pytest.mark.slow
def test_an_episode_without_an_end_is_cut() -> None:
    result = preview(written(ENDLESS), "--policy", "random", "--cell", "8", "-o", "walk.gif")
    assert result.status == 0
    assert result.err.startswith(
        f"the episode does not end within {MAX_STEPS} steps; the GIF shows those\nwrote "
    )
    assert len(film(Path("walk.gif").read_bytes())) > 100


def test_a_levels_time_limit_ends_the_film() -> None:
    frames = film(made(written(ENDLESS + "max_steps: 2\n"), "--policy", "random", "walk.gif"))
    assert 1 <= len(frames) <= 11


@pytest.mark.slow
def test_too_large_a_film_is_refused() -> None:
    name = written("version: 1\nsize: [99, 99]\nmaze: {seed: 1}\n")
    result = preview(name, "--scale", "1", "-o", "walk.gif")
    assert result.status == 2
    assert "too large" in result.err
    assert not Path("walk.gif").exists()


# -- pages -------------------------------------------------------------------------------------


def test_a_page_holds_the_answers() -> None:
    page = made("final-maze", "--seed", "4", "play.html")
    data = data_of(page)
    assert data["policy"] == solve("final-maze").policy.ravel().tolist()
    assert (data["walker"], data["seed"]) == ("best", "4")
    assert data["best"] == "\N{MINUS SIGN}36.58 within 500 steps"


@pytest.mark.slow
def test_a_page_shows_at_once_what_was_asked_for() -> None:
    def shown(*options: str) -> list[str]:
        names: list[str] = data_of(made("maze", *options, "play.html"))["shown"]
        return names

    assert shown() == []
    assert shown("--values") == ["values"]
    assert shown("--policy") == ["policy"]
    assert shown("--values", "--policy", "random") == ["values"]


def test_a_random_maze_is_the_one_of_its_seed() -> None:
    pages = [
        made("random-maze", "--maze-seed", seed, f"{number}.html")
        for number, seed in enumerate(["3", "3", "4"])
    ]
    digest = load("random-maze").with_maze_seed(3).digest
    assert digest.encode() in pages[0]
    assert pages[0] == pages[1] != pages[2]


def test_a_level_without_an_answer_can_be_played_but_not_watched() -> None:
    name = written(WITHOUT_ANSWER)
    result = preview(name, "-o", "play.html")
    assert result.status == 0
    assert "no optimal moves" in result.err
    data = data_of(Path("play.html").read_bytes())
    assert (data["walker"], data["policy"]) == (None, None)
    for options in (["--policy"], ["--values"]):
        refused = preview(name, *options, "-o", "answers.html")
        assert refused.status == 1
        assert not Path("answers.html").exists()


def test_too_large_a_level_is_no_page() -> None:
    result = preview(written("version: 1\nsize: [200, 200]\n"), "-o", "play.html")
    assert result.status == 2
    assert "too large for a page" in result.err


# -- the page on pictures ----------------------------------------------------------------------


@pytest.mark.sweep
def test_the_film_of_the_docs_is_what_is_made_now() -> None:
    # Its frames are compared, not its bytes: these depend on the version of Pillow.
    there = (DOCS / "images" / "final-maze.gif").read_bytes()
    assert len(there) < 300_000
    now = film(made("final-maze", "--seed", "3", "walk.gif"))
    then = film(there)
    assert then.shape == now.shape
    assert np.abs(then.astype(int) - now).mean() < 1


# -- without answers ---------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("name", ["final-maze", "door-key"])
def test_without_answers_nothing_of_them_is_in_the_page(name: str) -> None:
    full, plain = made(name, "full.html"), made(name, "--no-answers", "plain.html")
    known, data = data_of(full), data_of(plain)
    assert (data["policy"], data["walker"], data["best"]) == (None, None, "")
    assert "returns" not in data
    assert "marks" not in data
    assert "marks" not in data["picture"]
    layers = data["picture"]["layers"]
    assert not any(layers.get(name) for name in ("heat", "policy", "values", "beside"))
    # Whatever is an answer can be found in the other page, and not in this one.
    answers = [
        json.dumps(each, separators=(",", ":"))
        for each in (
            known["policy"],
            known["returns"],
            known["picture"].get("marks") or known["picture"]["layers"]["values"],
            known.get("marks") or known["picture"]["layers"]["policy"],
            known["picture"]["layers"]["heat"],
        )
    ]
    assert all(answer.encode() in full for answer in answers)
    assert not any(answer.encode() in plain for answer in answers)
    best = known["best"].removeprefix("\N{MINUS SIGN}")
    assert best.encode() in full
    assert not re.search(rf"(?<![\w.]){re.escape(best)}(?!\w)", plain.decode())
    turns = data.pop("turns", {"policy": None, "best": ""})
    assert (turns["policy"], turns["best"], "returns" in turns) == (None, "", False)
    # What shapes need more room beside answers is elsewhere.
    same = set(data) - {"policy", "walker", "best", "picture", "things"}
    assert {key: known[key] for key in same} == {key: data[key] for key in same}


@pytest.mark.parametrize(
    ("arguments", "wrong"),
    [
        ("-o a.html --values", "--no-answers cannot be combined with --values"),
        ("-o a.html --policy", "--no-answers cannot be combined with --values and --policy best"),
        ("-o a.svg", "--no-answers is for HTML output"),
    ],
)
def test_no_answers_is_for_pages_that_show_none(arguments: str, wrong: str) -> None:
    refused = preview("maze", "--no-answers", *shlex.split(arguments))
    assert (refused.status, wrong in refused.err) == (2, True)


def test_without_answers_the_random_policy_is_watched() -> None:
    page = made("maze", "--no-answers", "--policy", "random", "a.html")
    assert data_of(page)["walker"] == "random"


# -- agents ------------------------------------------------------------------------------------


@pytest.mark.slow
def test_an_agent_is_shown_in_pages_pictures_and_films() -> None:
    level = load("frozen-lake")
    policy = np.array(solve(level, actions="moves").policy)
    policy[3, 2] = 0
    np.save("policy.npy", policy)
    options = ("frozen-lake", "--agent", "policy.npy", "--actions", "moves")
    page = made(*options, "--values", "a.html").decode()
    told = re.findall(r"<t[hd][^>]*>([^<]*)</t[hd]>", page.partition("<tbody>")[2])
    assert told[:3] == ["[2, 3]", "north", "south"]
    table = np.eye(5)[1 + np.maximum(policy, 0)]
    assert page == level.to_html(policy=table, values=True)
    assert made(*options, "a.svg").decode() == level.to_svg(policy=table)
    assert made(*options, "--seed", "3", "a.gif") == level.to_gif(policy=table, seed=3)


def test_without_answers_an_agent_has_neither_costs_nor_values() -> None:
    np.save("policy.npy", np.full((5, 8), 2))
    plain = made("final-maze", "--agent", "policy.npy", "--no-answers", "a.html")
    data = data_of(plain)
    assert (data["policy"], data["walker"], data["best"]) == (None, "agent", "")
    assert not {"marks", "returns"} & set(data)
    assert set(data["agent"]) == {"choices", "policy", "marks", "legend"}
    assert set(data["agent"]["marks"]["values"]) == {-1}
    assert data["agent"]["legend"] == []
    assert not re.search(rb"<table|[Rr]egret", plain.partition(b"<script")[0])


def test_several_levels_have_the_agents_policy_of_each() -> None:
    best: dict[str, Any] = {name: solve(name).policy for name in ("maze", "frozen-lake")}
    np.savez("best.npz", **best)
    assert preview("maze", "frozen-lake", "--agent", "best.npz", "-o", "pictures").status == 0
    for name, policy in best.items():
        picture = Path("pictures", f"{name}.svg").read_text("utf-8")
        assert picture == load(name).to_svg(policy=np.eye(5)[np.maximum(policy, 0)])


@pytest.mark.slow
def test_what_a_python_file_calls_by_a_name_is_an_agent() -> None:
    lines = ("def east(position):", "    return 2", "def bad(position):", "    1 / 0", "")
    Path("mine.py").write_text("\n".join(lines))
    page = made("frozen-lake", "--agent", "mine.py:east", "a.html").decode()
    assert page == load("frozen-lake").to_html(policy=np.full((4, 4), 2))
    refused = preview("frozen-lake", "--agent", "mine.py:bad", "-o", "a.html")
    assert refused.status == 2
    assert refused.err.startswith("error: mine.py:4: the agent failed: ZeroDivisionError")


@pytest.mark.slow
def test_recorded_episodes_are_an_agent() -> None:
    record(Path("ada.brlplay"), "frozen-lake", episodes=2)
    page = made("frozen-lake", "--agent", "ada.brlplay", "a.html").decode()
    table = policy_table("frozen-lake", read_plays("ada.brlplay"))
    assert page == load("frozen-lake").to_html(policy=table)


@pytest.mark.parametrize(
    ("arguments", "wrong"),
    [
        ("--agent p.npy", "--agent is for pictures, films and pages"),
        ("--agent p.npy --policy best -o a.html", "--agent and --policy cannot be combined"),
        ("--agent p.txt -o a.html", "there is no agent 'p.txt'"),
        ("--agent none.npy -o a.html", "none.npy cannot be read (No such file or directory)"),
        ("--agent p.npy -o a.html", "a policy for this level and actions='all' is an array [4, 4]"),
        ("--agent ada.brlplay -o a.gif", "this policy has no action in some states"),
        ("--agent bob.brlplay -o a.html", "episode 1: it is one of another level"),
        ("--agent by-step.npy -o a.html", "the policy changes with the step"),
        ("--agent m.zip -o a.html", "m.zip is a model, and loading a model can run any code"),
    ],
)
def test_what_is_no_agent_of_a_level_is_told(arguments: str, wrong: str) -> None:
    np.save("p.npy", np.zeros((2, 2), int))
    np.save("by-step.npy", np.array(solve("frozen-lake", within=100).policies))
    record(Path("ada.brlplay"), "frozen-lake")
    record(Path("bob.brlplay"), "maze")
    Path("m.zip").write_bytes(b"")
    refused = preview("frozen-lake", *shlex.split(arguments))
    assert (refused.status, wrong in refused.err, "Traceback" in refused.err) == (2, True, False)


def test_a_page_without_answers_learns_where_it_is_allowed() -> None:
    assert "learn" not in data_of(made("maze", "--no-answers", "a.html"))
    assert data_of(made("maze", "--no-answers", "--learn", "b.html"))["learn"] is True
    refused = preview("maze", "--learn", "-o", "a.svg")
    assert (refused.status, "--learn is for HTML output" in refused.err) == (2, True)


# -- what it has written before ----------------------------------------------------------------


def test_pictures_are_overwritten_and_a_line_says_how_large_they_are() -> None:
    for name, facts in (("a.png", r"198 × 198, \d.* KB"), ("a.txt", "239 bytes")):
        Path(name).write_text("before")
        assert re.fullmatch(rf"wrote {name} \({facts}\)\n", preview("default", "-o", name).err)
        assert Path(name).read_bytes() != b"before"


def test_rules_stand_below_drawings_and_pictures() -> None:
    told = " ".join(preview("treasure-chests", "--rules").out.split())
    assert all(rule.text in told for rule in rules_of(CHESTS))
    picture = made("treasure-chests", "--rules", "--values", "one.svg").decode()
    assert all(rule.text in picture for rule in rules_of(CHESTS))
    assert picture.startswith(CHESTS.to_svg(rules=True, values=True).removesuffix("</svg>\n"))


def test_all_rules_are_told_below_a_drawing_that_are_asked_for() -> None:
    areas = "\n".join(f"  - {{at: [{x}, 1], reward: {-2 - x}}}" for x in range(25))
    name = written(f"version: 1\nsize: [26, 2]\nareas:\n{areas}\n")
    some, every = preview(name).out, preview(name, "--rules").out
    assert "further rules, which `babyrobot preview --rules` tells" in " ".join(some.split())
    assert [*re.findall(r"^\w +some cells: costs (\d+)$", every, re.M)] == [
        *map(str, range(26, 1, -1))
    ]
    assert "further" not in every


@pytest.mark.slow
def test_films_with_rules_keep_the_score_in_the_panel() -> None:
    film, plain = (made("final-maze", *words, "one.gif") for words in (["--rules"], []))
    with Image.open(io.BytesIO(film)) as one, Image.open(io.BytesIO(plain)) as other:
        assert one.width == other.width
        assert one.height > other.height
        above = one.convert("RGB").crop((0, 0, *other.size))
        differs = np.array(above, int) - np.array(other.convert("RGB"), int)
        # The two have palettes of their own.
        assert (abs(differs).max(axis=2) > 24).mean() < 0.01


def test_pictures_of_several_levels_have_names_that_every_system_allows() -> None:
    for folder in ("one", "two"):
        Path(folder).mkdir()
        for name in ("con", "ready"):
            text = f"version: 1\nname: {name}\n"
            Path(folder, f"a-{name}.yaml").write_text(text, encoding="utf-8")
    assert preview("one", "two", "-o", "pictures").status == 0
    names = {path.name for path in Path("pictures").iterdir()}
    assert names == {"con-2.svg", "con-3.svg", "ready.svg", "ready-2.svg"}


@pytest.mark.slow
def test_pages_of_several_levels_lead_from_one_to_the_next() -> None:
    assert preview("maze", "first-key", "maze", "--format", "html", "-o", "pages").status == 0
    links = {
        path.name: dict(re.findall(r'<a rel="(\w+)" href="([^"]*)"', path.read_text("utf-8")))
        for path in Path("pages").iterdir()
    }
    assert links == {
        "maze.html": {"next": "first-key.html"},
        "first-key.html": {"prev": "maze.html", "next": "maze-2.html"},
        "maze-2.html": {"prev": "first-key.html"},
    }
    assert made("maze", "alone.html").decode() == load("maze").to_html()


def test_other_files_are_not_overwritten_by_pictures() -> None:
    Path("level.yaml").write_text("version: 1\n")
    refused = preview("puddles", "--format", "svg", "-o", "level.yaml")
    assert (refused.status, Path("level.yaml").read_text()) == (2, "version: 1\n")
    assert "level.yaml already exists, and is not a picture" in refused.err


# -- answers -----------------------------------------------------------------------------------


def texts(svg: str) -> list[str]:
    return [
        element.text or ""
        for element in ET.fromstring(svg).iter("{http://www.w3.org/2000/svg}text")
    ]


def test_a_picture_says_what_the_cells_are_worth() -> None:
    done = babyrobot("preview", "frozen-lake", "--values", "--format", "svg")
    assert done.status == 0
    solution = solve("frozen-lake")
    worth = solution.values[solution.policy >= 0]
    shown = [f"{value:.2f}" for value in worth]
    legend = [f"{worth.min():.2f}", f"{worth.max():.2f}"]
    assert sorted(texts(done.out)) == sorted([*shown, *legend, "START", "EXIT"])


def test_a_picture_shows_policy_and_values_only_as_asked() -> None:
    def picture(*options: str) -> str:
        return babyrobot("preview", "frozen-lake", "--format", "svg", *options).out

    arrows = f'stroke="{load("frozen-lake").resolved_theme.colors.arrows}"'
    assert arrows not in picture("--values")
    assert arrows in picture("--policy")
    assert sorted(texts(picture("--policy"))) == ["EXIT", "START"]
    assert arrows in picture("--values", "--policy")
    assert "0.82" in texts(picture("--values", "--policy"))


def test_a_random_maze_is_solved_as_it_is_shown() -> None:
    call = ("preview", "random-maze", "--maze-seed", "7", "--values", "--format", "svg")
    level = load("random-maze").with_maze_seed(7)
    shown = texts(babyrobot(*call).out)
    assert f"{solve(level).expected_return:g}".replace("-", MINUS) in shown


def test_what_pays_for_ever_is_shown() -> None:
    name = written(HEAD + "areas: [{at: [0, 0], reward: 2}]\n")
    told = babyrobot("preview", name, "--values", "--policy")
    assert (told.status, told.err) == (0, "")
    assert ["inf", "inf", "0.00"] in map(str.split, told.out.splitlines())
    picture = babyrobot("preview", name, "--values", "--policy", "--format", "svg")
    assert picture.status == 0
    # The sign of infinity is drawn, so the legend alone has a number.
    assert sorted(texts(picture.out)) == ["0", "EXIT", "START"]


def test_an_unbounded_return_names_its_rule_and_cells() -> None:
    name = written(HEAD + "areas: [{at: [0, 0], reward: 2}]\n")
    done = babyrobot("solve", name)
    assert (done.status, "expected return: inf" in done.out) == (0, True)
    assert "around [0, 0], where rewards add up without bound (rule BR504" in done.err
    assert babyrobot("solve", name, "--discount", "0.9").err == (
        "the optimal policy reaches an exit in 0 % of the episodes; 100 % never end\n"
    )
    assert babyrobot("solve", name, "--format", "json").err == ""


@pytest.mark.parametrize("command", ["preview --values", "preview --policy --format svg", "solve"])
def test_a_level_without_an_answer_says_why(command: str) -> None:
    name, *options = command.split()
    done = babyrobot(name, written(WITHOUT_ANSWER), *options)
    assert (done.status, done.out) == (1, "")
    assert "a discount below 1" in done.err
    assert len(done.err.splitlines()) == 1


def test_values_of_wide_levels_are_left_to_pictures() -> None:
    name = written("version: 1\nsize: [17, 1]\n")
    done = babyrobot("preview", name, "--values")
    assert (done.status, done.out.startswith(load(name).draw())) == (0, True)
    assert "16 columns" in done.err
    assert f"{MINUS}15" in texts(babyrobot("preview", name, "--values", "--format", "svg").out)


def test_cells_from_which_boxes_are_lost_are_marked_in_text() -> None:
    done = babyrobot("preview", "first-box", "--lost")
    assert done.out.splitlines()[1:6:2] == [
        "| Sx   x   x   x| . |",
        "|  x  $             |",
        "|  x   x   x   x   x|",
    ]
    assert "x        from here, a box can reach no target\n" in done.out
    done = babyrobot("preview", "first-box", "--lost", "-o", "box.gif")
    assert (done.status, "--lost is for text, SVG, PDF and PNG output" in done.err) == (2, True)


def test_cells_are_lost_only_in_levels_with_boxes() -> None:
    done = babyrobot("preview", "frozen-lake", "--lost")
    assert (done.status, done.out) == (2, "")
    assert done.err == "error: the level has no boxes\n  help: leave out --lost\n"


def test_visits_without_end_are_refused_with_what_helps() -> None:
    done = babyrobot("preview", written(HEAD + "exit: none\n"), "--visits", "-o", "visits.svg")
    assert done.status == 2
    assert "visits have no picture\n  help: leave out --visits" in done.err
