"""The line between the halves: what the editor does without NumPy, and what it says of the rest."""

from __future__ import annotations

import re
from collections import defaultdict
from typing import Any

import pytest
from playwright.sync_api import expect
from support.editors import OpenEditor
from support.numberless import asked, replies, state_of_level, texts_after
from support.places import ROOT

from babyrobot_levels.editor.protocol import QUESTIONS
from babyrobot_levels.editor.sources import session_of
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
TEXT = "version: 1\nsize: [4, 3]\nstart: [0, 0]\nexit: [3, 2]\n"
MESSAGES: list[dict[str, Any]] = [
    {"do": "state"},
    {"do": "answers"},
    {"do": "levels"},
    {"do": "filled", "brush": "small", "at": [1, 1]},
    *({"do": "copy", "form": form} for form in ("yaml", "drawing", "python", "code")),
    {"do": "text", "text": TEXT + "puddles: [[1, 1]]\nexits: [3, 2]\n"},
    {"do": "undo"},
    {"do": "redo"},
    {"do": "text", "text": TEXT + "maze: {seed: 1}\nareas: []\n"},
    {"do": "resize", "size": [5, 3], "shift": [0, 0]},
    {"do": "keep_maze"},
    {"do": "open", "source": "final-maze"},
    {"do": "open", "source": "SFFF\nFHFH\nFFFH\nHFFG\n"},
    {"do": "open", "source": "nothing-has-this-name"},
    {"do": "open", "source": "version: 1\nsize: [400, 400]\n" * 2},
    {"do": "open", "source": TEXT + "items: [{name: key, at: [1, 1]}]\nexit_needs: key\n"},
    {"do": "save"},
    {"do": "reload"},
    {"do": "downloaded"},
    {"do": "quit"},
]
NUMERIC: list[dict[str, Any]] = [
    {"do": "policy", "actions": [1] * 12},
    {"do": "copy", "form": "link"},
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
        **{f"{name}, drawn": ("texts_after", [name, 7, 25]) for name in LEVELS},
    }
    answers = asked([*questions.values()], tmp_path_factory.mktemp("numberless"))
    return dict(zip(questions, answers, strict=True))


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


@pytest.mark.parametrize("name", LEVELS)
def test_gestures_make_the_same_texts(told: dict[str, Any], name: str) -> None:
    assert told[f"{name}, drawn"] == texts_after(name, 7, 25)


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


def test_what_needs_numpy_says_so_in_a_sentence(told: dict[str, Any]) -> None:
    assert [reply["error"] for reply in told["numeric"]] == [NEEDS_NUMPY] * len(NUMERIC)
    state = told["messages"][0]["state"]
    assert (state["lacks"], state["answers"]["reason"]) == (NEEDS_NUMPY, NEEDS_NUMPY)
    assert "table" not in state["level"]


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
