"""The page in which students write functions without installing: hashes, and a real browser."""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from playwright.sync_api import Browser, Page, expect
from support.combinations import swept
from support.places import ROOT, TESTS
from support.sites import hosted, runtime, stand_in

import babyrobot_levels as brl
from babyrobot_levels.extensions.editor.runtime import PLATFORM, RuntimeFileError
from babyrobot_levels.extensions.packs.build import read_course
from babyrobot_levels.extensions.publish import desk, hashed

SOLUTIONS = TESTS / "extensions" / "scoring" / "solutions"
LEVELS = ("frozen-lake", "first-key", "puddle-test", "treasure-chests")
DATA: dict[str, dict[str, Any]] = {
    name: json.loads(json.dumps(desk.level_data(brl.load(name)))) for name in LEVELS
}
START = 60_000
"""How long Python may take to start on a busy machine, in milliseconds."""

PLAIN = """\
def value_iteration(level):
    mdp = level.compile()
    values = [0.0] * mdp.num_states
    for _ in range(500):
        for state in range(mdp.num_states):
            if not mdp.is_terminal[state]:
                values[state] = max(ahead(level, mdp, values, state, action) for action in range(5))
    return values


def ahead(level, mdp, values, state, action):
    row = mdp.probability[state, action], mdp.reward[state][action]
    more = mdp.next_state[state, action], mdp.terminal[state, action]
    return sum(
        chance * (reward + (0 if ends else level.discount * values[following]))
        for chance, reward, following, ends in zip(*row, *more)
    )
"""


def asked(text: str, name: str, kind: str, level: str = "frozen-lake") -> tuple[bool, str]:
    """Return whether a function is right in a level, and the sentence."""
    found = json.loads(hashed.run(text, name, kind, json.dumps(DATA[level])))
    return found["passed"], found["message"]


@pytest.mark.slow
@given(st.sampled_from(LEVELS), st.data())
def test_values_are_right_if_each_is_near_the_right_one(name: str, data: st.DataObject) -> None:
    level = DATA[name]
    right = brl.solve(name).values.ravel()
    off = data.draw(st.lists(st.floats(-1e-3, 1e-3), min_size=right.size, max_size=right.size))
    near = right + np.array(off)
    count = len(level["graded"])
    assert hashed.graded(near, "values", level) == f"all {count} values are right"
    state = data.draw(st.sampled_from(level["graded"]))
    near[state] += data.draw(st.sampled_from([-1, 1])) * data.draw(st.floats(5e-3, 10))
    with pytest.raises(hashed.AnswerError):
        hashed.graded(near.reshape(level["shape"]).tolist(), "values", level)


@pytest.mark.slow
@pytest.mark.parametrize("name", swept(LEVELS[1:2], LEVELS))
def test_policies_are_right_as_elsewhere(name: str) -> None:
    best = brl.solve(name).policy
    assert hashed.graded(best, "policy", DATA[name]) == "the policy is optimal"
    random = np.random.default_rng(0)
    for _ in range(20):
        changed = best.copy()
        changed[tuple(random.integers(0, best.shape))] = random.integers(0, 5)
        is_right = bool(brl.grade_policy(name, changed))
        if is_right:
            hashed.graded(changed, "policy", DATA[name])
        else:
            with pytest.raises(hashed.AnswerError):
                hashed.graded(changed, "policy", DATA[name])


@pytest.mark.slow
def test_agents_learn_in_episodes_of_the_page() -> None:
    learned = (SOLUTIONS / "q_learning.py").read_text("utf-8")
    passed, message = asked(learned, "q_learning", "agent", "puddle-test")
    needed = DATA["puddle-test"]["needed"]
    assert (passed, message.endswith(f"{needed:.4g} is enough")) == (True, True), message
    best = brl.solve("puddle-test").expected_return
    random = brl.evaluate("puddle-test", "random", within="max_steps").expected_return
    assert needed == pytest.approx(random + 0.95 * (best - random), rel=1e-6)
    masked = """
def q_learning(level):
    return [max(range(5), key=lambda action: -mask[action]) for mask in level.compile().action_mask]
"""
    _, message = asked(masked, "q_learning", "agent", "puddle-test")
    assert message.startswith("from ")
    assert message.endswith("; leave impossible actions out of the maximum")


def test_episodes_are_those_of_the_tables() -> None:
    level = hashed.Level(DATA["frozen-lake"])
    env, mdp = level.make(), brl.load("frozen-lake").compile()
    told = [(env.reset(seed=3), *(env.step(2) for _ in range(3))) for _ in range(2)]
    assert told[0] == told[1]
    ends = 0
    for _ in range(50):
        env.reset()
        for _ in range(level.make()._limit):
            state, action = env.state, env.action_space.sample()
            (x, y), reward, over, late, info = env.step(action)
            outcomes = mdp.next_state[state, action], mdp.reward[state, action]
            assert (env.state, reward) in [*zip(*(each.tolist() for each in outcomes), strict=True)]
            assert (x + 4 * y, info["action_mask"]) == (
                env.state,
                mdp.action_mask[env.state].tolist(),
            )
            if over or late:
                ends += over
                break
    assert ends > 40


@pytest.mark.slow
def test_solutions_are_right_and_skeletons_are_not_written() -> None:
    told = desk._told(read_course(ROOT / "course"), "Robots")
    for function in told["functions"][:2]:
        right = (SOLUTIONS / f"{function['name']}.py").read_text("utf-8")
        for level in told["levels"]:
            given = function["name"], function["kind"], json.dumps(level)
            text = right.replace("from value_iteration import ahead", PLAIN_AHEAD)
            assert json.loads(hashed.run(text, *given))["passed"], (function, level["name"])
            assert "not written yet" in hashed.run(function["text"], *given)
    text = json.dumps(told)
    assert "exam" not in [level["name"] for level in told["levels"]]
    vault = brl.solve(ROOT / "course" / "levels" / "vault.yaml").values
    long = [str(value) for value in vault[np.isfinite(vault)] if len(str(value)) > 8]
    assert long
    assert not [value for value in long if value in text]


PLAIN_AHEAD = """
def ahead(level, values):
    mdp = level.compile()
    following = np.where(mdp.terminal, 0.0, level.discount * values[mdp.next_state])
    return (mdp.probability * (mdp.reward + following)).sum(axis=2)
"""

WRONG = {
    "return [0.0] * 16": "at [2, 3] it is not what its best action gives with your values "
                         "of the next states",
    "return [[1, 2], [3]]": "it returns rows that differ in length",
    "return 3": "the values must be an array [4, 4] or [16], not a int",
    "return ['east'] * 16": "the values are not numbers",
    "return [float('nan')] * 16": "the value of [0, 0] is nan",
    "pass": "it returns nothing: it has to end with `return`",
    "return level.size": "AttributeError in line 2: here, a level has compile(), make(), discount, "
                         "name and title, but no 'size'",
    "return 1 /": "SyntaxError: invalid syntax (value_iteration.py, line 2)",
    "level.compile().probability[0, 0] = 1": "ValueError in line 2: assignment destination is "
                                             "read-only",
}  # fmt: skip


@pytest.mark.parametrize("body", WRONG)
def test_what_is_wrong_is_told(body: str) -> None:
    text = f"def value_iteration(level):\n    {body}\n"
    assert asked(text, "value_iteration", "values") == (False, WRONG[body])


@pytest.mark.slow
def test_mistakes_have_names() -> None:
    text = PLAIN.replace("level.discount", "0.9")
    told = "these are the values for the discount 0.9, not 1"
    assert asked(text, "value_iteration", "values") == (False, told)
    text = "def policy_iteration(level): return ['stay'] * 16"
    told = "at [2, 3], stay is not best, by the values of your policy itself"
    assert asked(text, "policy_iteration", "policy") == (False, told)
    told = "from [1, 1] its episodes do not end, or too late to evaluate it here"
    costly = text.replace("16", "9")
    assert asked(costly, "policy_iteration", "policy", "puddle-test") == (False, told)
    text = text.replace("stay", "right")
    told = "the action at [0, 0] is 'right': it can be 0 stay, 1 north, 2 east, 3 south, 4 west"
    assert asked(text, "policy_iteration", "policy") == (False, told)


# -- the page ----------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Give the page of a small course, and the files of the course."""
    folder = tmp_path_factory.mktemp("desk")
    course = folder / "course"
    shutil.copytree(TESTS / "cli" / "files" / "course", course)
    for name in ("value_iteration", "policy_iteration"):
        shutil.copy(ROOT / "course" / f"{name}.py", course)
    desk.write_desk(read_course(course), "Two levels", folder / "page", runtime())
    return folder / "page"


@pytest.fixture
def page(browser: Browser, built: Path) -> Iterator[Page]:
    """Give the page in a browser, without a network, and without errors."""
    errors: list[str] = []
    with hosted(built) as server:
        context = browser.new_context(accept_downloads=True)
        found = context.new_page()
        found.set_default_timeout(20_000)
        found.on("pageerror", lambda error: errors.append(str(error)))
        found.goto(server.address)
        yield found
        context.close()
    assert errors == []


@pytest.mark.slow
def test_functions_are_written_run_kept_and_saved(page: Page, tmp_path: Path) -> None:
    text, notice, rows = (page.locator(each) for each in ("#text", "#notice", "#found tr"))
    run = page.get_by_role("button", name="Run")
    expect(text).to_have_value((ROOT / "course" / "value_iteration.py").read_text("utf-8"))
    run.click()
    expect(notice).to_contain_text("NumPy is not in this page's folder", timeout=START)
    text.fill(f"print('hello')\n{PLAIN}")
    run.click()
    expect(notice).to_have_text("2 of 2 levels are right.", timeout=START)
    expect(rows).to_have_text([f"{name}rightall {n} values are right"
                               for name, n in (("row", 4), ("bend", 6))])  # fmt: skip
    expect(page.locator("#printed")).to_have_text("hello")
    text.fill("def value_iteration(level):\n    while True: pass\n")
    run.click()
    expect(notice).to_have_text("Running …")
    page.get_by_role("button", name="Stop").click()
    expect(notice).to_have_text("Stopped.")
    page.reload()
    expect(text).to_have_value("def value_iteration(level):\n    while True: pass\n")
    text.fill("")
    text.press_sequentially("def value_iteration(level):\nreturn 3\n")
    expect(text).to_have_value("def value_iteration(level):\n    return 3\n    ")
    text.press("Control+Enter")
    expect(notice).to_have_text("0 of 2 levels are right.", timeout=START)
    with page.expect_download() as download:
        page.get_by_role("button", name="Save the file").click()
    assert download.value.suggested_filename == "value_iteration.py"
    page.get_by_role("tab", name="value_iteration.py").press("ArrowRight")
    expect(page.get_by_role("tab", name="policy_iteration.py")).to_be_focused()
    expect(text).to_have_value((ROOT / "course" / "policy_iteration.py").read_text("utf-8"))


@pytest.mark.sweep
def test_numpy_is_served_by_the_page_if_it_is_given(
    built: Path, browser: Browser, tmp_path: Path
) -> None:
    given, page = tmp_path / "given", tmp_path / "page"
    shutil.copytree(runtime(), given)
    name = f"numpy-2.4.6-cp314-cp314-{PLATFORM}.whl"
    (given / name).write_bytes(stand_in("numpy"))
    desk.write_desk(read_course(ROOT / "course"), "Robots", page, given)
    for each in ("index.html", "worker.js"):
        assert "cdn.jsdelivr.net" in (built / each).read_text("utf-8")
        assert "cdn.jsdelivr.net" not in (page / each).read_text("utf-8")
    with hosted(page) as server:
        opened = browser.new_page()
        opened.goto(server.address)
        opened.locator("#text").fill(f"import numpy\nprint(numpy.__version__)\n{PLAIN}")
        with opened.expect_request(f"**/python/{name}", timeout=START):
            opened.get_by_role("button", name="Run").click()
        expect(opened.locator("#printed")).to_have_text("a stand-in", timeout=START)
        expect(opened.locator("#notice")).to_have_text("10 of 10 levels are right.", timeout=START)
        opened.close()


@pytest.mark.slow
def test_a_folder_without_python_for_browsers_is_told(tmp_path: Path) -> None:
    with pytest.raises(RuntimeFileError, match="cannot be read"):
        brl.course(ROOT / "course", tmp_path / "built", runtime=tmp_path)
    assert not (tmp_path / "built").exists()
