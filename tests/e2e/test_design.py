"""The design briefs: what they ask for, how answers are judged, and the runner."""

from __future__ import annotations

import json
import os
import re
import shlex
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
from support.places import ROOT

import babyrobot_levels as brl

sys.path.insert(0, str(ROOT / "benchmarks"))
import design
import design_baselines
import design_judge as judging

if TYPE_CHECKING:
    from design import Message
    from design_judge import Brief, Finding

BRIEFS = {brief.name: brief for brief in judging.load()}
REFERENCES = dict(
    line.split() for line in (judging.FOLDER / "references.txt").read_text("ascii").splitlines()
)

# -- the briefs ------------------------------------------------------------------------------

DIGITS = r"(?<![\w.])-?[0-9]+(?:\.[0-9]+)?"
WORDS = ("zero", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten")
TRIVIAL = {
    0: r"\b(no|not|without|never|none|nothing|avoids|dry|optimum is lost)\b",
    1: r"\b(a|an|one|single|only|all|every|surely|sure)\b",
}
"""How people say these in a text."""

SAID = {
    "loops": "loop",
    "reachable": "reach",
    "path_length": "shortest|path|way|steps",
    "dead_ends": "dead end",
    "junctions": "junction|fork",
    "corridors": "ring|corridor",
    "turns": "turn",
    "cells": "cells",
    "difficulty": "difficulty",
    "wet_share": "puddle|water|wet",
    "best_return": "return",
    "best_steps": "optim|best|average|averaged",
    "random_return": "random policy",
    "random_steps": "random policy",
    "success": "sure|probability|certain",
    "irreversible": "lost for ever",
    "fragility": "fragility",
    "detour": "longer|detour|extra|because of",
    "needs": "need|without the key",
    "dependencies": "chain",
    "distractors": "distractor",
}


def plainly(text: str) -> str:
    """Return a text with numbers as digits, and without names in backquotes."""
    text = re.sub(r"`[^`]*`", "", text)
    text = re.sub(r"\b(\d+)x(\d+)\b", r"\1 by \2", text)
    for number, word in enumerate(WORDS[2:], 2):
        text = re.sub(rf"\b{word}\b", str(number), text, flags=re.IGNORECASE)
    return text


def stated(brief: Brief) -> Iterator[float]:
    """Yield the numbers in the facts, without signs."""

    def numbers(value: Any) -> Iterator[float]:
        if isinstance(value, dict | list):
            for each in value.values() if isinstance(value, dict) else value:
                yield from numbers(each)
        elif isinstance(value, int | float) and not isinstance(value, bool):
            yield abs(float(value))
        elif isinstance(value, str) and ".." in value:
            yield from (abs(float(end)) for end in value.split("..") if end)

    for facts in (brief.fields, brief.counts, brief.each, brief.expect):
        yield from numbers(facts)


def test_there_are_a_hundred_of_many_kinds() -> None:
    assert len(BRIEFS) == len(REFERENCES) == 100
    families = {brief.family for brief in BRIEFS.values()}
    assert len(families) == 12
    facts = {name for brief in BRIEFS.values() for name in brief.expect}
    assert facts >= {"success", "needs", "wet_share", "detour", "irreversible", "fragility"}
    assert len({brief.text for brief in BRIEFS.values()}) == 100


@pytest.mark.parametrize("name", BRIEFS)
def test_text_and_facts_say_the_same(name: str) -> None:
    brief = BRIEFS[name]
    text = plainly(brief.text).lower()
    told = {abs(float(number)) for number in re.findall(DIGITS, text)}
    facts = set(stated(brief))
    assert told <= facts
    for number in facts - told:
        assert re.search(TRIVIAL[int(number)], text, re.IGNORECASE), number
    ranges = [value for part in (brief.counts, brief.expect) for value in part.values()]
    for least, most in (str(value).split("..") for value in ranges if ".." in str(value)):
        phrase = f"{least} to {most}" if least and most else f"at {'least' if least else 'most'} "
        assert phrase + ("" if least and most else least or most) in text
    for fact in brief.expect:
        assert re.search(SAID[fact], brief.text, re.IGNORECASE), fact
    for thing in brief.expect.get("needs", ()):
        assert f"`{thing}`" in brief.text


@pytest.mark.slow
@pytest.mark.parametrize("name", BRIEFS)
def test_each_can_be_met(name: str) -> None:
    level = brl.load(REFERENCES[name])
    assert BRIEFS[name].judge(level.to_yaml()) == []


@pytest.mark.slow
def test_none_is_met_by_an_empty_room_or_by_what_another_asks_for() -> None:
    names = sorted(BRIEFS)
    for name, other in zip(names, names[1:] + names[:1], strict=True):
        size = BRIEFS[name].fields["size"]
        for level in (brl.load(REFERENCES[other]), brl.Level(version=1, size=size)):
            is_empty = name == "loops/open-room" and level.exit == (5, 5)
            assert is_empty or next(BRIEFS[name].unmet(level), None), name


def test_the_page_shows_a_brief_and_counts() -> None:
    page = (judging.FOLDER / "README.md").read_text("utf-8")
    assert (judging.FOLDER / "coins" / "leave-it.yaml").read_text("utf-8") in page
    assert all(f"`{kind}`" in page for kind in judging.KINDS)
    assert all(f"`{field}`" in page for field in judging.FIXED)
    for family in {brief.family for brief in BRIEFS.values()}:
        count = sum(brief.family == family for brief in BRIEFS.values())
        assert f"| {family} | {count} |" in page


def test_references_are_not_in_the_clear() -> None:
    assert all(code.startswith("brl1.") for code in REFERENCES.values())
    assert set(REFERENCES) == set(BRIEFS)


# -- judging ---------------------------------------------------------------------------------

WET = judging.Brief(
    "puddles/test",
    "A 3x3 level with a puddle.",
    fields={"size": [3, 3]},
    counts={"puddles": 1},
    expect={"path_length": 4, "best_return": -3, "wet_share": 0},
)
GOOD = "version: 1\nsize: [3, 3]\npuddles:\n  - {at: [1, 1]}\n"


def facts(found: list[Finding]) -> dict[str, Any]:
    return {each["fact"]: each["value"] for each in found if "fact" in each}


def test_a_good_answer_is_met_in_or_without_a_fence() -> None:
    assert WET.judge(GOOD) == []
    assert WET.judge(f"Here it is:\n\n```yaml\n{GOOD}```\nEnjoy!") == []


@pytest.mark.parametrize(
    ("answer", "found"),
    [
        ("version: 1\nexpect: {path_length: 4, lint: clean}\n", {"puddles": 0}),
        (GOOD + "exit: [2, 1]\nexpect: {path_length: 3}\n",
         {"path_length": 3, "best_return": -2.0}),
        (GOOD + "rewards: {step: -2, exit: 3}\n",
         {"rewards": None}),
        (GOOD + "puddle_types: {small: {reward: -1, skid: 0}}\n", {"puddle_types": None}),
        (GOOD + "skid: 0.01\n", {"skid": 0.01}),
        (GOOD + "discount: 0.9\n", {"discount": 0.9}),
        (GOOD + "wind: {north: [0, 0, 1]}\n", {"wind": 1}),
        (GOOD + "items: [{name: coin, at: [2, 0], reward: 9}]\n", {"items": 1, "coins": 1}),
        (GOOD + "areas: [{at: [0, 2], reward: -5}]\n", {"areas": 1, "areas.reward": -5.0}),
        (GOOD + "walls: [{at: [0, 2], side: E, pass: 0.9}]\n", {"glass": 1}),
        (GOOD + "warps: [{at: [2, 0], to: [2, 1]}]\n", {"warps": 1}),
        (GOOD + "start: [[0, 0], [2, 0]]\n", {"starts": 2}),
        (GOOD + "max_steps: 50\ntitle: Wet\n", {}),
    ],
)  # fmt: skip
def test_only_the_facts_of_the_brief_count(answer: str, found: dict[str, Any]) -> None:
    told = facts(WET.judge(answer))
    assert found.keys() <= told.keys()
    assert all(told[name] == value for name, value in found.items() if value is not None)
    assert bool(found) is bool(told)


def test_comments_suppress_nothing() -> None:
    walled = GOOD + "walls:\n  - {at: [0, 2], side: N}\n  - {at: [0, 2], side: E}\n"
    suppressed = "# babyrobot: ignore[ALL, BR502, BR509]\n" + walled
    for answer in (walled, suppressed):
        assert "BR502" in [each.get("code") for each in WET.judge(answer)]


@pytest.mark.parametrize(
    "answer",
    ["", "[", "version: 2", "Sorry, I cannot.", "\0", "&a [*a]", "version: 1\ntheme: /etc/passwd\n",
     "version: 1\nmaze: {seed: random}\n", "version: 1\nsize: [1024, 1024]\nsizes: 3\n"],
)  # fmt: skip
def test_what_is_no_level_has_findings(answer: str) -> None:
    found = WET.judge(answer)
    assert found
    assert all(each["message"] for each in json.loads(json.dumps(found)))


def test_facts_about_things_are_told_of_levels_without_things() -> None:
    brief = BRIEFS["keys/first"]
    told = facts(brief.judge("version: 1\nsize: [5, 5]\n"))
    assert told == {"items": 0, "doors": 0, "needs": None, "path_length": 8}


def test_things_have_the_names_of_the_brief() -> None:
    level = brl.load(REFERENCES["keys/first"]).to_yaml().replace("key", "gold")
    (found,) = BRIEFS["keys/first"].judge(level)
    assert (found["fact"], found["expected"]) == ("needs", ["key"])
    assert "['gold']" in found["message"]


@pytest.mark.slow
def test_a_level_that_takes_too_long_is_not_met() -> None:
    with judging.Judge(seconds=2) as judge:
        assert judge(WET, GOOD) == []
        begin = time.monotonic()
        (found,) = judge(WET, "version: 1\nsize: [800, 800]\nskid: 0.4\n")
        assert found["message"] == "the level could not be judged in 2 seconds"
        assert time.monotonic() - begin < 30
        assert judge(WET, GOOD) == []
        assert "more than" in judge(WET, "#" * (judging.MAX_CHARACTERS + 1))[0]["message"]


def test_one_value_may_be_written_in_several_ways() -> None:
    brief = judging.Brief(
        "x/y", "", {"size": [5, 1], "start": [[2, 0], [3, 0]], "exit": [[0, 0], [4, 0]],
        "skid": 0.1}, {"starts": 2, "exits": 2}, {}, {"path_length": 2},
    )  # fmt: skip
    answer = "version: 1\nsize: [5, 1]\nstart: [[3, 0], [2, 0]]\nexit: [[4, 0], [0, 0]]\n"
    assert brief.judge(answer + "skid: {probability: 0.1, to: open}\n") == []
    assert "skid" in facts(brief.judge(answer + "skid: {probability: 0.1, to: sides}\n"))


# -- asking ----------------------------------------------------------------------------------


def judged(brief: Brief, answer: str) -> list[Finding]:
    return brief.judge(answer)


def test_an_author_mends_by_what_was_found() -> None:
    seen: list[list[Message]] = []

    def author(messages: list[Message]) -> str:
        seen.append(messages)
        return "version: 1\n" if len(seen) == 1 else GOOD

    done = design.attempt(WET, author, judged, system="The language.")
    assert (done.solved, done.answers) == (2, ("version: 1\n", GOOD))
    assert facts(done.found[0]).keys() == {"puddles"}
    assert [message["role"] for message in seen[1]] == ["system", "user", "assistant", "user"]
    assert WET.text in seen[0][1]["content"]
    assert '"fact": "puddles"' in seen[1][3]["content"]


def test_failing_slow_and_talkative_authors_go_on_to_the_next_round() -> None:
    def failing(_: list[Message]) -> str:
        raise ValueError("no network")

    done = design.attempt(WET, failing, judged, rounds=1)
    assert done.solved is None
    assert [each[0]["message"] for each in done.found] == ["no network"] * 2

    def slow(_: list[Message]) -> str:
        time.sleep(0.5)
        return GOOD

    assert "within 0.1 seconds" in design.attempt(WET, slow, judged, 0, 0.1).found[0][0]["message"]


@pytest.fixture
def command(tmp_path: Path) -> Any:
    def written(code: str, seconds: float = 20.0) -> design.Author:
        script = tmp_path / "author.py"
        script.write_text(code, "utf-8")
        return design.Command([sys.executable, str(script)], seconds)

    return written


def test_a_command_reads_the_brief_and_writes_a_level(command: Any) -> None:
    author = command(
        "import sys\n"
        "text = sys.stdin.read()\n"
        f"print({GOOD!r} if 'puddles' in text and 'as JSON' in text else 'version: 1')\n"
    )
    done = design.attempt(WET, author, judged)
    assert done.solved == 2


@pytest.mark.slow
@pytest.mark.parametrize(
    ("code", "message"),
    [
        ("import time\nprint('version: 1', flush=True)\ntime.sleep(60)", "no answer within 1"),
        ("while True: print('x' * 100000)", None),
        ("raise SystemExit(3)", None),
    ],
)
def test_commands_are_bounded(code: str, message: str | None, command: Any) -> None:
    begin = time.monotonic()
    author = command(code, 1 if message else 20)
    if message:
        with pytest.raises(design.AuthorError, match=message):
            author([{"role": "user", "content": "x" * 1_000_000}])
    else:
        assert len(author([{"role": "user", "content": "x"}])) <= judging.MAX_CHARACTERS + 1
    assert time.monotonic() - begin < 15


# -- the command -----------------------------------------------------------------------------


@pytest.mark.slow
def test_the_table_counts_by_family(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    codes = iter([REFERENCES["mazes/first"], "brl1.", REFERENCES["mazes/long-way"], "no", "no"])

    def author(_: list[Message]) -> str:
        code = next(codes)
        return brl.load(code).to_yaml() if len(code) > 9 else "version: 1\n"

    file = tmp_path / "answers.jsonl"
    words = ["mazes/first", "mazes/long-way", "mazes/snake", "--rounds", "1", "-o", str(file)]
    design.main(author, words)
    rows = [re.split(r" *\| *", line)[1:-1] for line in capsys.readouterr().out.splitlines()]
    assert [row[:5] for row in rows[2:]] == [
        ["mazes", "3", "0.33", "0.67", "1.7"],
        ["all", "3", "0.33", "0.67", "1.7"],
    ]
    assert [json.loads(line)["solved"] for line in file.read_text("utf-8").splitlines()] == [
        1, 2, None,
    ]  # fmt: skip


@pytest.mark.slow
def test_an_interrupted_run_tells_what_was_judged(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def judge_or_stop(_: judging.Judge, brief: Brief, answer: str) -> list[Finding]:
        if brief.name != "mazes/first":
            raise KeyboardInterrupt
        return brief.judge(answer)

    monkeypatch.setattr(judging.Judge, "__call__", judge_or_stop)
    reference = brl.load(REFERENCES["mazes/first"]).to_yaml()
    design.main(lambda _: reference, ["mazes/first", "mazes/long-way"])
    assert "| all | 1 | 1.00 | 1.00 |" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["mazes"], "give an --author or a --baseline"),
        (["--author", "python", "amazing"], "no such briefs"),
        (["--author", "no-such-command -x", "mazes"], "there is no command no-such-command"),
        (["--author", "'python", "mazes"], "No closing quotation"),
        (["--author", sys.executable, "-o", "/nowhere/answers.jsonl", "mazes"], "/nowhere"),
    ],
)
def test_wrong_options_are_told(
    words: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit):
        design.main(words=words)
    assert message in capsys.readouterr().err


@pytest.mark.slow
@pytest.mark.skipif(os.name == "nt", reason="needs signals of POSIX")
def test_ctrl_c_ends_the_command_that_answers(tmp_path: Path) -> None:
    pid = tmp_path / "pid"
    script = f"import os, time; open({str(pid)!r}, 'w').write(str(os.getpid())); time.sleep(60)"
    author = f"{shlex.quote(sys.executable)} -c {shlex.quote(script)}"
    command = [sys.executable, str(ROOT / "benchmarks" / "design.py"), "mazes", "--author", author]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        for _ in range(600):
            if pid.exists() and pid.read_text():
                break
            time.sleep(0.1)
        process.send_signal(signal.SIGINT)
        out, _ = process.communicate(timeout=60)
    assert out.startswith("| family |")
    with pytest.raises(ProcessLookupError):
        os.kill(int(pid.read_text()), 0)


# -- baselines -------------------------------------------------------------------------------


def test_search_finds_a_maze() -> None:
    brief = BRIEFS["mazes/first"]
    done = design.attempt(brief, design_baselines.by_search(brief), judged, 0)
    assert done.solved == 1


def test_random_levels_have_what_is_counted() -> None:
    brief = BRIEFS["guards/two"]
    told = facts(brief.judge(design_baselines.at_random(brief)([])))
    assert not told.keys() & judging.KINDS.keys()


@pytest.mark.slow
def test_repair_learns_what_is_wanted() -> None:
    brief = judging.Brief(
        "x/y", "", {"size": [4, 3]}, {"holes": 2}, {"holes": {"reward": -9}}, {"path_length": 5}
    )
    author = design_baselines.by_repair(brief, tries=100)
    done = design.attempt(brief, author, judged)
    assert done.answers[0] == "version: 1\n"
    assert done.solved is not None
