"""The editor in a browser: what it does without NumPy and what it says then, and all with it."""

from __future__ import annotations

import json
import re
from collections import defaultdict
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import expect
from support.editors import OpenEditor
from support.numberless import (
    MESSAGES,
    NUMERIC,
    TEXT,
    asked,
    replies,
    settled,
    state_of_level,
    texts_after,
)
from support.places import ROOT

from babyrobot_levels.extensions.editor import browser
from babyrobot_levels.extensions.editor.protocol import QUESTIONS
from babyrobot_levels.extensions.editor.sources import session_of
from babyrobot_levels.linter.rules import find
from babyrobot_levels.mdp import numeric
from babyrobot_levels.mdp.numeric import NEEDS_NUMPY

# Each has something that others lack.
LEVELS = [
    "areas",
    "bat-cave",
    "blocked-shapes",
    "drawbridge",
    "final-maze",
    "first-key",
    "glass-wall",
    "moonlight",
    "random-maze",
    "shell-game",
    "teleport-pads",
    "windy-gridworld",
]
# What the exact tables tell beside what the level itself does.
COMPUTED = {"answers", "findings", "findings_pending", "lacks", "level", "number", "unreachable"}


@pytest.fixture(scope="module")
def told(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """What is answered without NumPy, all of it by one interpreter."""
    questions: dict[str, tuple[str, list[Any]]] = {
        "modules": ("modules_that_fail", []),
        "messages": ("replies", [TEXT, MESSAGES]),
        "numeric": ("replies", [TEXT, NUMERIC]),
        **{name: ("state_of_level", [name]) for name in LEVELS},
    }
    answers = asked([*questions.values()], tmp_path_factory.mktemp("numberless"))
    return dict(zip(questions, answers, strict=True))


@pytest.mark.slow
def test_the_architecture_names_the_modules_that_need_numpy(told: dict[str, Any]) -> None:
    section = (ROOT / "ARCHITECTURE.md").read_text("utf-8").partition("## Without NumPy\n")[2]
    table = re.findall(r"^\| `(\w+)` \| (.*)\|$", section.partition("\n## ")[0], re.M)
    named = {room: {*re.findall(r"`([\w.]+)`", modules)} for room, modules in table}
    failed = defaultdict(set)
    for module in told["modules"]:
        room, _, name = module.partition(".")
        failed[room].add(name)
    assert named == {room: failed[room] for room in named}
    assert {"text", "language", "library"} <= named.keys()


@pytest.mark.slow
@pytest.mark.parametrize("name", LEVELS)
def test_a_level_is_read_drawn_and_copied_alike(told: dict[str, Any], name: str) -> None:
    without, solved = told[name], state_of_level(name)
    assert without["lacks"]
    assert not solved["lacks"]
    for key in without.keys() - COMPUTED - {"copies", "revision"}:
        assert without[key] == solved[key], key
    layers = (each["level"]["picture"]["layers"] for each in (without, solved))
    drawn, expected = ({name: each[name] for name in ("base", "grid", "signs")} for each in layers)
    assert drawn == expected
    things = (each["level"].get("things", []) for each in (without, solved))
    names, others = ([thing["name"] for thing in each] for each in things)
    assert names == others
    assert [rule[1] for rule in without["level"]["rules"]] == [
        rule[1] for rule in solved["level"]["rules"]
    ]
    assert without["copies"] == solved["copies"]
    findings = (
        {(each["code"], each["line"]) for each in of["findings"]} for of in (without, solved)
    )
    some, all_ = findings
    assert some <= all_


@pytest.mark.slow
@pytest.mark.parametrize("names", [LEVELS[:3], pytest.param(LEVELS[3:], marks=pytest.mark.sweep)])
def test_gestures_make_the_same_texts(names: list[str], tmp_path: Path) -> None:
    questions = [("texts_after", [name, 7, 25]) for name in names]
    for name, drawn in zip(names, asked(questions, tmp_path), strict=True):
        assert drawn == texts_after(name, 7, 25), name


@pytest.mark.slow
def test_every_message_has_the_same_answer(told: dict[str, Any]) -> None:
    for message, without, solved in zip(
        MESSAGES, told["messages"], replies(TEXT, MESSAGES), strict=True
    ):
        assert without.keys() == solved.keys(), message
        assert without.get("error") == solved.get("error"), message
        if "state" in solved:
            assert without["state"]["text"] == solved["state"]["text"], message
            assert without["state"]["is_valid"] == solved["state"]["is_valid"], message
    assert {*QUESTIONS} <= {message["do"] for message in [*MESSAGES, *NUMERIC]}


@pytest.mark.slow
def test_what_needs_numpy_says_so_in_a_sentence(told: dict[str, Any]) -> None:
    assert [reply["error"] for reply in told["numeric"]] == [NEEDS_NUMPY] * len(NUMERIC)
    state = told["messages"][0]["state"]
    assert (state["lacks"], state["answers"]["reason"]) == (NEEDS_NUMPY, NEEDS_NUMPY)
    assert "table" not in state["level"]


# -- with NumPy ----------------------------------------------------------------------------------


@pytest.mark.sweep
def test_with_numpy_a_site_answers_all_that_the_server_does(tmp_path: Path) -> None:
    questions: list[tuple[str, list[Any]]] = [("replies", [TEXT, [*MESSAGES, *NUMERIC]])]
    for name in LEVELS:
        asks = [{"do": "answers"}, {"do": "policy", "actions": []}, {"do": "copy", "form": "link"}]
        questions.append(("replies", [session_of(name).text, asks]))
    answers = asked(questions, tmp_path, is_numeric=True)
    for (_, arguments), answered in zip(questions, answers, strict=True):
        served = json.loads(json.dumps(replies(*arguments)))
        for message, one, other in zip(arguments[1], answered, served, strict=True):
            assert settled(message, one) == settled(message, other)


def test_what_is_found_by_proof_comes_once_numpy_is_there(monkeypatch: pytest.MonkeyPatch) -> None:
    def asked_here(question: str) -> Any:
        (state,) = [json.loads(browser.reply(7, json.dumps({"do": question, **at})))["state"]]
        at["revision"] = state["revision"]
        return state

    shut_in = "walls:\n  - {at: [0, 0], side: E}\n  - {at: [0, 0], side: S}\n"
    at: dict[str, Any] = {}
    with monkeypatch.context() as patch:
        patch.setattr(numeric, "_is_at_hand", lambda name: False)
        browser.begin(7, TEXT + shut_in, "", 0)
        state = asked_here("state")
        assert (state["lacks"], state["findings"]) == (NEEDS_NUMPY, [])
    browser.read_again()
    asked_here("state")
    state = asked_here("answers")
    rule = find("exit-unreachable-from-start")
    assert rule is not None
    assert rule.code in {each["code"] for each in state["findings"]}
    assert state["lacks"] == ""
    assert state["answers"]["status"] == "done"


@pytest.mark.slow
def test_the_page_draws_and_does_not_play(
    editor_page: OpenEditor, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(numeric, "_is_at_hand", lambda name: False)
    editor = editor_page(session_of("first-key"))
    stage, said = editor.page.locator(".stage"), editor.page.locator(".said")
    expect(stage.locator("svg > g[id]").first).to_be_attached()
    for key, mode in (("p", "Play"), ("", "Policy")):
        if key:
            stage.press(key)
        else:
            editor.page.get_by_role("button", name=mode).click()
        expect(said).to_have_text(NEEDS_NUMPY[0].upper() + NEEDS_NUMPY[1:] + ".")
        expect(editor.page.locator(".playing")).to_be_hidden()
        for pressed in ("2", "ArrowRight", "Space"):
            stage.press(pressed)
    expect(editor.page.locator(".findings .lacking")).to_have_count(1)
    expect(editor.page.get_by_role("button", name="Undo")).to_be_enabled()
